"""Marking policy: what a verdict is worth, and who must look at an answer before it is worth anything."""

from __future__ import annotations

import enum
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.exercise.sheet.kinds import KINDS

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from canon.exercise.report.judgement import Judgement

__all__ = ["Mark", "MarkingPolicy", "Outcome"]

_FAULT = re.compile(r"^key ([^\s,:]+)", re.MULTILINE)
"""Where something is wrong in a claim, as its judgement says it: ``key claim[0], column 3: …``."""


class Outcome(enum.Enum):
    """What came of an answer."""

    RIGHT = "right"
    WRONG = "wrong"
    UNREADABLE = "unreadable"
    UNDECIDED = "undecided"

    def __str__(self) -> str:
        return self.value


@dataclass(frozen=True)
class Mark:
    """What an answer is worth.

    Parameters
    ----------
    outcome
        What came of it.
    points
        What it is worth; None where nobody can say yet.
    sentence
        What is said to who answered.
    """

    outcome: Outcome
    points: float | None
    sentence: str

    @property
    def asks_again(self) -> bool:
        """Whether who answered should write it again: it could not be read, which says nothing about what was meant."""
        return self.outcome is Outcome.UNREADABLE

    @property
    def needs_a_person(self) -> bool:
        """Whether a person should look, because canon does not know."""
        return self.outcome is Outcome.UNDECIDED


@dataclass(frozen=True)
class MarkingPolicy:
    """Marks from verdicts: right and wrong have points; unreadable is asked again, undecided is for a person.

    What can't be read is asked again only where it is the answer that can't be: a mistake in the question is for a
    person too. An answer that fails is worth the share of it that is proved to be right, where the claim says
    ``partial = true``.

    Parameters
    ----------
    right, wrong
        Points of an answer that holds, and of one that fails.

    Raises
    ------
    ValueError
        Where a wrong answer would be worth as much as a right one.

    Examples
    --------
    >>> from canon.exercise import Judgement
    >>> policy = MarkingPolicy(right=2.0)
    >>> policy.mark(Judgement("a", "equality-only", "holds")).points
    2.0
    >>> unread = policy.mark(Judgement("a", "equality-only", "invalid", known="key rhs, column 3: a bracket is open"))
    >>> unread.points, unread.asks_again, unread.needs_a_person
    (None, True, False)
    """

    right: float = 1.0
    wrong: float = 0.0

    def __post_init__(self) -> None:
        if not self.wrong < self.right:
            raise ValueError(
                f"a right answer should be worth more than a wrong one, not {self.right} and {self.wrong}"
            )

    def mark(self, judgement: Judgement, answer: Collection[str] = ()) -> Mark:
        """Return the mark of one answer.

        Parameters
        ----------
        judgement
            What canon says of it.
        answer
            The keys of the claim where the answer stands; those of its kind unless given.
        """
        match judgement.status:
            case "holds":
                return Mark(Outcome.RIGHT, self.right, "; ".join(("right", *judgement.warnings)))
            case "fails":
                why = judgement.feedback or judgement.question or "this is not right"
                share = judgement.share or 0.0
                partly = f"; {share:.0%} of it is proved to be right" if share else ""
                return Mark(Outcome.WRONG, self.wrong + share * (self.right - self.wrong), why + partly)
            case "invalid" if _answer_alone_is_at_fault(judgement, answer):
                told = f"this could not be read, please write it again: {judgement.known}"
                return Mark(Outcome.UNREADABLE, None, told)
            case "invalid":
                told = f"the question has a mistake, a person will look: {judgement.known}"
                return Mark(Outcome.UNDECIDED, None, told)
            case _:
                told = f"neither proved nor refuted, a person will look: {judgement.known}"
                return Mark(Outcome.UNDECIDED, None, told)

    def marks(self, judgements: Iterable[Judgement], answer: Collection[str] = ()) -> tuple[Mark, ...]:
        """Return the mark of each answer, such as those of a :class:`canon.exercise.report.report.Report`."""
        return tuple(self.mark(judgement, answer) for judgement in judgements)


def _answer_alone_is_at_fault(judgement: Judgement, answer: Collection[str]) -> bool:
    """Tell whether everything that is wrong stands where the answer does."""
    places = [place.partition(".")[0].partition("[")[0] for place in _FAULT.findall(judgement.known)]
    kind = KINDS.get(judgement.kind)
    return kind is not None and bool(places) and set(places) <= {*(answer or kind.answer)}
