"""A diagnosis of a wrong answer, the claim repaired as it says, and the judgement on the whole of the repaired claim.

The law of feedback: what a sentence proposes is put into the claim, and the claim is judged anew from its first
question to its last. A sentence whose claim does not hold then is not told.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from itertools import islice
from typing import TYPE_CHECKING

from canon.exercise.judge import questions
from canon.exercise.question.deadline import Deadline
from canon.exercise.question.question import Determines, decide
from canon.proof.domain.verdict import Undecided
from canon.proof.rungs.ladder import REFUSALS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

    from canon.exercise.judge import Finding
    from canon.exercise.question.question import Part
    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = ["MOST_SENTENCES", "Diagnosis", "WrongAnswer", "judged_to_hold", "scaled"]

MOST_SENTENCES = 3
"""Components that a person is told of at once."""


@dataclass(frozen=True)
class Diagnosis:
    """What a person is told, and the claim with that put in.

    Parameters
    ----------
    sentence
        Where and how the claim is wrong.
    repaired
        The claim repaired; None where the sentence states what is so and proposes nothing to put in.
    only_fault
        Whether the sentence is to be told only where all other questions of the claim hold.
    """

    sentence: str
    repaired: Reading | None = None
    only_fault: bool = False


@dataclass(frozen=True)
class WrongAnswer:
    """A claim that fails, with what was compared when it did.

    Parameters
    ----------
    finding
        The judgement with the question on which it turned.
    parts, domain
        The components that were compared, and where they are meant.
    deadline
        When to stop looking for what is wrong.
    """

    finding: Finding
    parts: tuple[Part, ...]
    domain: Domain
    deadline: float

    @property
    def reading(self) -> Reading:
        """The claim."""
        return self.finding.reading

    def within(self, share: float) -> WrongAnswer:
        """Return the same with a share of the time that is left, so that some is left to what comes after."""
        now = time.monotonic()
        return replace(self, deadline=now + share * (self.deadline - now))


def judged_to_hold(reading: Reading, seconds: float, held: int = 0, but: int | None = None) -> bool:
    """Whether a claim is judged to hold.

    Parameters
    ----------
    reading
        The claim.
    seconds
        Time for all its questions together.
    held
        How many questions at the beginning are passed over: a screen only, never the last word.
    but
        The number of a question that was answered otherwise.
    """
    deadline = Deadline.after(seconds)
    try:
        asked = (question for i, question in islice(enumerate(questions(reading)), held, None) if i != but)
        return all(
            decide(question, deadline).holds
            for question in asked
            if not isinstance(question, Determines) or question.wanted
        )
    except (Undecided, *REFUSALS):  # a repair may make no sense: a singular matrix, an empty domain
        return False


def scaled(reading: Reading, parts: Sequence[Part], factor: Expr) -> Reading | None:
    """Return the claim with every component multiplied, None where a component is not itself an answer."""
    for part in parts:
        if not part.key:
            return None
        reading = reading.with_instead(part.key, factor * part.claimed)
    return reading
