"""Judgements: the verdict on one claim as text, and what a report of many needs."""

from __future__ import annotations

import json
from copy import deepcopy
from dataclasses import dataclass, fields, replace
from decimal import Decimal
from typing import TYPE_CHECKING, Any, Protocol

from canon.display import preformatted
from canon.printable import in_one_line, is_printable, printable

if TYPE_CHECKING:
    from collections.abc import Mapping

    from canon.exercise.sheet.sheet import Claim

__all__ = ["MARKS", "MAX_SHOWN", "Judged", "Judgement", "invalid", "points_of", "without_explanation"]

MARKS = {"holds": "✓", "fails": "✗", "undecided": "?", "invalid": "!"}
MAX_SHOWN = 2_000
"""Characters of an expression that are shown; the rest is cut."""


@dataclass(frozen=True)
class Judgement:
    """The verdict on one claim, in text only: what a report says of it.

    Parameters
    ----------
    id, kind, title, expect, file
        As the claim says, and where it stands.
    status
        ``holds``, ``fails``, ``undecided`` or ``invalid``.
    seconds
        Time the judgement took.
    certificate
        How it was decided.
    question
        The part of the claim on which the verdict turned.
    counterexample
        ``{"point": {name: value}, "left": …, "right": …}`` where it fails, else None.
    residual
        What should have vanished.
    feedback
        One sentence for a person.
    corrected
        The right answer, where canon has it.
    known
        What is known of an undecided claim, or what is wrong with an invalid one.
    steps
        How it was judged: pairs of a sentence and a formula, either of which may be empty.
    warnings
        What was passed over in reading the claim, such as units, and what a claim that holds leaves open.
    points
        What the claim is worth, where its sheet says so.
    share
        The share of the answer that is proved to be right, where points or a share are asked for; None where
        nobody can say yet.
    """

    id: str
    kind: str
    status: str
    seconds: float = 0.0
    certificate: str = ""
    question: str = ""
    counterexample: Mapping[str, Any] | None = None
    residual: str = ""
    feedback: str = ""
    corrected: str = ""
    known: str = ""
    title: str = ""
    expect: str = ""
    file: str = ""
    steps: tuple[tuple[str, str], ...] = ()
    warnings: tuple[str, ...] = ()
    points: float | None = None
    share: float | None = None

    def __repr__(self) -> str:
        return f"<Judgement {self.id!r}: {self.kind}, {self.status}>"

    def _repr_html_(self) -> str:
        return preformatted("\n".join(self.lines()))

    @property
    def earned(self) -> float | None:
        """The points of the share that is proved; None where there are none or nobody can say yet."""
        return None if self.points is None or self.share is None else self.points * self.share

    @property
    def as_expected(self) -> bool:
        """Whether the verdict is the one the author expects, or none is expected."""
        return self.expect in ("", self.status)

    def to_dict(self) -> dict[str, Any]:
        """Return what one JSON line says."""
        said = {field.name: getattr(self, field.name) for field in fields(self)}
        example = deepcopy(self.counterexample)  # everything else can't be changed
        return {
            **said,
            "counterexample": example,
            "seconds": round(self.seconds, 4),
            "earned": self.earned,
        }

    @classmethod
    def from_dict(cls, found: Mapping[str, Any]) -> Judgement:
        """Return the judgement that a JSON line says."""
        said = {field.name: found[field.name] for field in fields(cls) if field.name in found}
        said["steps"] = tuple((str(text), str(formula)) for text, formula in said.get("steps", ()))
        said["warnings"] = tuple(map(str, said.get("warnings", ())))
        return cls(**said)

    @property
    def json_line(self) -> str:
        """One line of JSON; in ASCII where the claim holds characters that a terminal should not see."""
        said = json.dumps(self.to_dict(), ensure_ascii=False)
        return said if is_printable(said) else json.dumps(self.to_dict())

    def lines(self, width: int = 100) -> list[str]:
        """Return this judgement as lines of a table."""
        unexpected = "" if self.as_expected else f"   (expected: {self.expect})"
        name = self.title or self.kind
        head = in_one_line(f"{MARKS[self.status]} {self.status:<9} {self.id:<12} {name}")
        shown = [f"{head[: width - 10]:<{width - 10}} {self.seconds:6.2f} s{unexpected}"]
        told = (line for each in (*self.reasons, *self.warnings) for line in each.split("\n"))
        shown += [f"    {line}" for line in told]
        shown += [f"    {self._points_in_words}"] if self.points is not None else []
        return [printable(line) for line in shown]

    @property
    def _points_in_words(self) -> str:
        if self.earned is None:
            return f"of {self.points:g} points, not known how many"
        partly = self.share not in (0, 1)
        told = f": {self.share:.0%} of the answer is proved to be right" if partly else ""
        return f"{self.earned:.3g} of {self.points:g} points{told}"

    @property
    def reasons(self) -> list[str]:
        """What a person is told besides the verdict, line by line."""
        reasons: list[str] = []
        if self.status == "fails":
            reasons.append(self.feedback or f"{self.question or 'the claim'} is wrong")
            example = self.counterexample
            if example is not None:
                point = ", ".join(f"{name} = {value}" for name, value in example["point"].items())
                reasons.append(f"at {point or 'every point'}: {example['left']} against {example['right']}")
            if self.corrected:
                reasons.append(f"right would be: {self.corrected}")
        elif self.status != "holds":
            reasons += self.known.splitlines()
            if self.status == "invalid" and self.file:
                reasons[0] = f"{self.file}: {reasons[0]}"
        return reasons


class Judged(Protocol):
    """What a page or an XML file shows of a sheet, such as :class:`canon.exercise.report.report.Report`."""

    @property
    def title(self) -> str:
        """Of the sheet."""
        ...

    @property
    def judgements(self) -> tuple[Judgement, ...]:
        """One for each claim."""
        ...

    @property
    def claims(self) -> tuple[Claim, ...]:
        """The claims themselves; may be missing."""
        ...

    @property
    def counts(self) -> dict[str, int]:
        """How many judgements have each status."""
        ...

    @property
    def summary(self) -> str:
        """One line: how many of each."""
        ...


def without_explanation(judgement: Judgement, budget: float) -> Judgement:
    """Return the judgement on a wrong answer that says why it is not explained: its seconds ended the search.

    Examples
    --------
    >>> without_explanation(Judgement("a", "equality-only", "fails"), 10).feedback
    'what is wrong is undecided: the budget of 10 s was spent before the search came to its end'
    """
    if judgement.status != "fails":
        return judgement
    told = (
        f"what is wrong is undecided: the budget of {budget:g} s was spent before the search came to its end"
    )
    return replace(judgement, feedback=f"{judgement.feedback}; {told}" if judgement.feedback else told)


def invalid(claim: Claim, reason: str) -> Judgement:
    """Return the judgement on a claim that does not say something that could be judged."""
    return Judgement(
        claim.id,
        claim.kind,
        "invalid",
        known=reason,
        title=str(claim.keys.get("title", "")),
        expect=claim.expect,
        points=points_of(claim),
    )


def points_of(claim: Claim) -> float | None:
    """Return what a claim is worth; one that has a share, but no points of its own, is worth one."""
    points = claim.keys.get("points", 1 if claim.keys.get("partial") is True else None)
    usable = isinstance(points, int | float | Decimal) and not isinstance(points, bool)
    return float(points) if usable else None
