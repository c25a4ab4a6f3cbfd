"""One extreme case as a value: what is tried, with what, and what came of it."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

__all__ = ["Outcome", "Row", "refused", "shown"]


@dataclass(frozen=True)
class Outcome:
    """What a tool answered.

    Parameters
    ----------
    said
        In plain words with figures, one line; no ``|``.
    error
        How far the answer is from the truth, in whatever measure the row names; None where that has no meaning.
    estimate
        What the tool itself says its error is, in the same measure, or the tolerance it was asked for; None where
        it says nothing.
    right
        Whether the answer is right, where ``error`` and ``estimate`` do not already say so.
    refused
        The answer is a clear error or UNDECIDED with its reason (or a warning that says the answer is worthless).
    """

    said: str
    error: float | None = None
    estimate: float | None = None
    right: bool | None = None
    refused: bool = False

    @property
    def kind(self) -> str:
        """``"result"`` within its stated error, ``"said"`` where the tool refused with a reason, ``"wrong"`` silently.

        ``"unknown"``: no error stated, so nobody can know.
        """
        if self.refused:
            return "said"
        if self.right is not None:
            return "result" if self.right else "wrong"
        if self.error is None:
            return "unknown"
        if math.isnan(self.error):
            return "wrong"
        if self.estimate is None:
            return "unknown"
        return "result" if self.error <= self.estimate else "wrong"

    def plain(self) -> dict[str, Any]:
        """Return it as JSON takes it."""
        return asdict(self) | {"kind": self.kind}


@dataclass(frozen=True)
class Row:
    """One extreme case.

    Parameters
    ----------
    name
        Short, unique within its part: letters, digits, hyphens, dots.
    tried
        What was tried, in plain words with figures, and what the truth is known from.
    canon
        Does it with canon.
    ordinary
        Does it with ordinary tools, by their names; an exception that escapes counts as that tool's clear error
        only through :func:`refused`.
    limit
        Seconds of wall time for each of them, then it is killed and counts as hung.
    memory
        GiB of address space for each of them; None for no limit.
    """

    name: str
    tried: str
    canon: Callable[[], Outcome]
    ordinary: Mapping[str, Callable[[], Outcome]] = field(default_factory=lambda: MappingProxyType({}))
    limit: float = 60.0
    memory: float | None = 6.0

    @property
    def pieces(self) -> list[tuple[str, Callable[[], Outcome]]]:
        """The tools in their order, canon first."""
        return [("canon", self.canon), *self.ordinary.items()]


def refused(run: Callable[[], Any], *errors: type[BaseException], holds: str = "") -> Outcome:
    """Return the outcome of a run that should end with one of these errors, whose message holds a text.

    A run that ends without an error, or with another, is wrong.
    """
    try:
        answer = run()
    except errors as error:
        said = shown(f"{type(error).__name__}: {error}")
        return Outcome(said, refused=holds in str(error), right=None if holds in str(error) else False)
    return Outcome(shown(f"no error: {answer}"), right=False)


def shown(text: object, width: int = 200) -> str:
    """Return a text as one line that fits a cell of a table."""
    line = " ".join(str(text).split()).replace("|", "¦").replace("\0", r"\0")
    return line if len(line) <= width else line[: width - 1] + "…"
