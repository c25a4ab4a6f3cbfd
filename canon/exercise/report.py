"""What a person or a program is told: a table, JSON lines, an exit status."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from canon.exercise.sheet import Claim

__all__ = ["Judgement", "Report", "invalid"]

_MARKS = {"holds": "✓", "fails": "✗", "undecided": "?", "invalid": "!"}
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

    @property
    def as_expected(self) -> bool:
        """Whether the verdict is the one the author expects, or none is expected."""
        return self.expect in ("", self.status)

    def to_dict(self) -> dict[str, Any]:
        """Return what one JSON line says."""
        return {**asdict(self), "seconds": round(self.seconds, 4)}

    @classmethod
    def from_dict(cls, found: Mapping[str, Any]) -> Judgement:
        """Return the judgement that a JSON line says."""
        return cls(**{field.name: found[field.name] for field in fields(cls) if field.name in found})

    def lines(self, width: int = 100) -> list[str]:
        """Return this judgement as lines of a table."""
        unexpected = "" if self.as_expected else f"   (expected: {self.expect})"
        head = f"{_MARKS[self.status]} {self.status:<9} {self.id:<12} {self.title or self.kind}"
        shown = [f"{head[: width - 10]:<{width - 10}} {self.seconds:6.2f} s{unexpected}"]
        shown += [f"    {line}" for line in self._reasons()]
        return shown

    def _reasons(self) -> list[str]:
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


@dataclass(frozen=True)
class Report:
    """The judgements of a sheet."""

    title: str
    judgements: tuple[Judgement, ...]

    def count(self, status: str) -> int:
        """Return how many judgements have a status."""
        return sum(judgement.status == status for judgement in self.judgements)

    @property
    def exit_status(self) -> int:
        """0 where all hold, 1 where some fail, 3 where none fails but some are undecided, 2 where one is invalid."""
        if self.count("invalid"):
            return 2
        if self.count("fails"):
            return 1
        return 3 if self.count("undecided") else 0

    @property
    def unexpected(self) -> tuple[Judgement, ...]:
        """The judgements that differ from what the author expects."""
        return tuple(judgement for judgement in self.judgements if not judgement.as_expected)

    @property
    def summary(self) -> str:
        """One line: how many of each."""
        counts = ", ".join(f"{self.count(status)} {status}" for status in _MARKS if self.count(status))
        seconds = sum(judgement.seconds for judgement in self.judgements)
        return f"{len(self.judgements)} claims: {counts or 'none'} ({seconds:.1f} s)"

    def json_lines(self) -> str:
        """Return one JSON object a line."""
        return "".join(json.dumps(j.to_dict(), ensure_ascii=False) + "\n" for j in self.judgements)

    def __str__(self) -> str:
        lines = [self.title] if self.title else []
        lines += [line for judgement in self.judgements for line in judgement.lines()]
        return "\n".join([*lines, self.summary])


def invalid(claim: Claim, reason: str) -> Judgement:
    """Return the judgement on a claim that does not say something that could be judged."""
    return Judgement(
        claim.id,
        claim.kind,
        "invalid",
        known=reason,
        title=str(claim.keys.get("title", "")),
        expect=claim.expect,
    )
