"""Search for the diagnosis of a claim that failed: what a kind names is tried in turn, and confirmed.

A diagnosis is told only when the claim, with the repair it names put in, was judged to hold as a whole.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from canon.exercise.claim_verdict import InvalidClaim, examined
from canon.exercise.diagnose.change import Change, Mistake
from canon.exercise.diagnose.changed_claims import another_reading
from canon.exercise.diagnose.components import on_the_motion
from canon.exercise.diagnose.diagnosis import MOST_SENTENCES, Diagnosis, WrongAnswer, judged_to_hold
from canon.exercise.diagnose.effort import JUDGEMENT_STEPS, Effort
from canon.exercise.question.deadline import Deadline
from canon.exercise.question.equation_systems import AFFINE
from canon.exercise.question.question import Chain, Same, SameEquations
from canon.exercise.sheet.kind import named_function
from canon.proof.rungs.ladder import REFUSALS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.exercise.claim_verdict import Finding
    from canon.exercise.question.question import Part
    from canon.proof.domain.domain import Domain

__all__ = ["OUTER_SECONDS", "diagnosis"]

OUTER_SECONDS = 120.0
"""Last safety of a search whose steps end it after a second or two, five at most where this was measured."""


def diagnosis(finding: Finding, seconds: float = OUTER_SECONDS) -> Diagnosis | None:
    """Return what is wrong with a claim, and the claim repaired accordingly, which was judged to hold.

    Parameters
    ----------
    finding
        A failed judgement with the question on which it turned.
    seconds
        The last safety; what is looked for is limited by a count of steps.

    Raises
    ------
    BudgetSpent
        Where the seconds are over before the search came to its own end.
    """
    if not isinstance(
        finding.question, Chain
    ):  # the answer itself is wrong: its chain is not repaired with it
        finding = replace(finding, reading=replace(finding.reading, links=()))
    found = _told(finding, Effort(seconds))
    return _with_dimensions(found, finding) if finding.reading.has("dimensions") else found


def _with_dimensions(found: Diagnosis | None, finding: Finding) -> Diagnosis | None:
    """Return a diagnosis with what is dimensionally impossible besides, or that alone."""
    from canon.exercise.diagnose.repairs.impossible_dimension import impossible_dimensions

    if found is not None and found.instead is not None:
        return found
    if not _was_compared(finding):
        return found
    parts, domain = _compared(finding)
    impossible = impossible_dimensions(finding.reading, parts, domain, MOST_SENTENCES)
    if not impossible:
        return found
    told = finding.verdict.feedback
    as_judged = (Change.of(Mistake.AS_JUDGED, told),) if told else ()
    found = found or Diagnosis(as_judged)
    return replace(found, changes=(*found.changes, *impossible))


def _compared(finding: Finding) -> tuple[tuple[Part, ...], Domain]:
    """Return the components on which a judgement turned, as they were compared."""
    question = finding.question
    if isinstance(question, SameEquations):
        return on_the_motion(question), question.domain
    return (question.parts, question.domain) if isinstance(question, Same) else ((), finding.reading.domain)


def _was_compared(finding: Finding) -> bool:
    """Whether a claim failed because an answer was compared with what is right, not for its form."""
    return isinstance(finding.question, Same | SameEquations) and finding.verdict.question != AFFINE


def _told(finding: Finding, effort: Effort, said: int = 0) -> Diagnosis | None:
    for found in _diagnoses(finding, effort):
        if _confirmed(found, finding, effort):
            return found
        both = _with_the_next(found, finding, effort, said) if said < MOST_SENTENCES else None
        if both is not None or effort.spent:
            return both
    return None


def _with_the_next(found: Diagnosis, finding: Finding, effort: Effort, said: int) -> Diagnosis | None:
    """Return what is wrong where a claim was repaired in one question and fails in a later one: both mistakes."""
    if found.repaired is None or effort.spent:
        return None
    try:
        with effort.proof(JUDGEMENT_STEPS) as seconds:
            again = examined(found.repaired, Deadline.after(seconds))
    except (InvalidClaim, *REFUSALS):
        return None
    if not again.verdict.fails or again.held <= finding.held or again.question is None:
        return None
    rest = _told(again, effort, said + len(found.changes))
    if rest is None or rest.repaired is None:
        return None
    return Diagnosis((*found.changes, *rest.changes), rest.repaired)


def _confirmed(found: Diagnosis, finding: Finding, effort: Effort) -> bool:
    """Whether the repaired claim holds; where nothing is repaired, whether all else in the claim does."""
    if found.judged:
        effort.spend(JUDGEMENT_STEPS)
        return True
    if found.repaired is not None:
        return judged_to_hold(found.repaired, effort)
    return not found.only_fault or judged_to_hold(finding.reading, effort, but=finding.held)


def _diagnoses(finding: Finding, effort: Effort) -> Iterator[Diagnosis]:
    question, told = finding.question, finding.verdict.feedback
    if not _was_compared(finding):
        if told or isinstance(question, SameEquations):
            yield Diagnosis.stated(Mistake.AS_JUDGED, told, only_fault=False)
        else:
            yield from another_reading(WrongAnswer(finding, (), finding.reading.domain, effort))
        return
    parts, domain = _compared(finding)
    for name in finding.reading.kind.diagnoses:
        tried = named_function("canon.exercise.diagnose", name)
        yield from tried(WrongAnswer(finding, parts, domain, effort))
