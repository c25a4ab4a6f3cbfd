"""A diagnosis of a wrong answer, the claim repaired as it says, and the judgement on the whole of the repaired claim.

The law of feedback: what a diagnosis proposes is put into the claim, and the claim is judged anew from its first
question to its last. A diagnosis whose claim does not hold then is not told.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, replace
from itertools import islice
from typing import TYPE_CHECKING

from canon.exercise.claim_verdict import questions
from canon.exercise.diagnose.change import Change
from canon.exercise.diagnose.effort import JUDGEMENT_STEPS
from canon.exercise.question.deadline import Deadline
from canon.exercise.question.question import Determines, decide
from canon.proof.domain.verdict import Undecided
from canon.proof.rungs.ladder import REFUSALS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

    from canon.exercise.claim_verdict import Finding
    from canon.exercise.diagnose.change import Mistake
    from canon.exercise.diagnose.effort import Effort
    from canon.exercise.question.question import Part
    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = ["MOST_SENTENCES", "Diagnosis", "Proof", "WrongAnswer", "judged_to_hold", "scaled"]

MOST_SENTENCES = 3
"""Components that a person is told of at once."""


class Proof(enum.Enum):
    """How a diagnosis is known to be right."""

    REPAIRED = "the claim with the changes undone is judged to hold"
    COMPARED = "proved of what was compared where the claim failed, and all else in the claim holds"
    JUDGED = "the judgement itself found it"


@dataclass(frozen=True)
class Diagnosis:
    """What is wrong with a claim, and the claim with that put right.

    Parameters
    ----------
    changes
        Where and how the claim is wrong, one thing after the other.
    repaired
        The claim repaired; None where the changes state what is so and propose nothing to put in.
    only_fault
        Whether they are to be told only where all other questions of the claim hold.
    instead
        What may be wrong in another component in place of this: nothing in the claim tells which of them is meant.
    judged
        Whether the whole of the claim repaired was judged to hold when this was found.
    """

    changes: tuple[Change, ...]
    repaired: Reading | None = None
    only_fault: bool = False
    instead: Diagnosis | None = None
    judged: bool = False

    @classmethod
    def of(
        cls, mistake: Mistake, *items: object, repaired: Reading | None = None, place: str = ""
    ) -> Diagnosis:
        """Return the diagnosis of one mistake, with the claim repaired."""
        return cls((Change(mistake, items, place),), repaired)

    @classmethod
    def stated(cls, mistake: Mistake, *items: object, only_fault: bool = True) -> Diagnosis:
        """Return a diagnosis that states what was proved of the claim and proposes no change."""
        return cls((Change(mistake, items),), only_fault=only_fault)

    @property
    def proof(self) -> Proof:
        """How the diagnosis was proved."""
        if self.repaired is not None:
            return Proof.REPAIRED
        return Proof.COMPARED if self.only_fault else Proof.JUDGED


@dataclass(frozen=True)
class WrongAnswer:
    """A claim that fails, with what was compared when it did.

    Parameters
    ----------
    finding
        The judgement with the question on which it turned.
    parts, domain
        The components that were compared, and where they are meant.
    effort
        What may be spent on looking for what is wrong.
    """

    finding: Finding
    parts: tuple[Part, ...]
    domain: Domain
    effort: Effort

    @property
    def reading(self) -> Reading:
        """The claim."""
        return self.finding.reading

    def within(self, share: float) -> WrongAnswer:
        """Return the same with a share of the effort that is left, so that some is left to what comes after."""
        return replace(self, effort=self.effort.share(share))


def judged_to_hold(reading: Reading, effort: Effort, held: int = 0, but: int | None = None) -> bool:
    """Whether a claim is judged to hold.

    Parameters
    ----------
    reading
        The claim.
    effort
        Of what the judgement is spent; it is the outer limit of the time for all its questions together.
    held
        How many questions at the beginning are passed over: a screen only, never the last word.
    but
        The number of a question that was answered otherwise.
    """
    with effort.proof(JUDGEMENT_STEPS) as seconds:
        deadline = Deadline.after(seconds)
        try:
            asked = (
                question for i, question in islice(enumerate(questions(reading)), held, None) if i != but
            )
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
