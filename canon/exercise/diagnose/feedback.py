"""Feedback for a person in one sentence: where and how an answer is wrong, and what would be right.

A diagnosis is told only when the claim, with the repair it names put in, was judged to hold as a whole.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, cast

from canon.exercise.diagnose.changed_claims import another_reading
from canon.exercise.diagnose.components import on_the_motion
from canon.exercise.diagnose.diagnosis import MOST_SENTENCES, Diagnosis, WrongAnswer, judged_to_hold
from canon.exercise.question.equation_systems import AFFINE
from canon.exercise.question.question import Same, SameEquations, Stated
from canon.exercise.sheet.kind import named_function
from canon.exercise.sheet.sympy_trees import shown
from canon.proof.domain.verdict import Undecided

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sympy import Expr

    from canon.exercise.judge import Finding

__all__ = ["corrected", "diagnosis", "feedback"]

WHOLE_SECONDS = 1.0
ANSWER_SECONDS = 0.5
"""Time for the judgement on a repaired claim."""


def feedback(finding: Finding, seconds: float) -> str:
    """Return in one sentence what is wrong with a claim, or nothing.

    Parameters
    ----------
    finding
        A failed judgement with the question on which it turned.
    seconds
        How long may be looked for a repair.
    """
    found = diagnosis(finding, seconds)
    return "" if found is None else found.sentence


def diagnosis(finding: Finding, seconds: float) -> Diagnosis | None:
    """Return what is wrong with a claim, and the claim repaired accordingly, which was judged to hold.

    Parameters
    ----------
    finding
        A failed judgement with the question on which it turned.
    seconds
        How long may be looked for a repair.
    """
    deadline = time.monotonic() + seconds
    for found in _diagnoses(finding, deadline):
        if _confirmed(found, finding):
            return found
    return None


def _confirmed(found: Diagnosis, finding: Finding) -> bool:
    """Whether the repaired claim holds; where nothing is repaired, whether all else in the claim does."""
    if found.repaired is not None:
        return judged_to_hold(found.repaired, WHOLE_SECONDS)
    return not found.only_fault or judged_to_hold(finding.reading, WHOLE_SECONDS, but=finding.held)


def _diagnoses(finding: Finding, deadline: float) -> Iterator[Diagnosis]:
    question, told = finding.question, finding.verdict.feedback
    if isinstance(question, SameEquations):
        if finding.verdict.question == AFFINE:
            yield Diagnosis(told)
            return
        parts, domain = on_the_motion(question), question.domain
    elif isinstance(question, Same):
        parts, domain = question.parts, question.domain
    else:
        if told:
            yield Diagnosis(told)
        else:
            yield from another_reading(WrongAnswer(finding, (), finding.reading.domain, deadline))
        return
    for name in finding.reading.kind.diagnoses:
        tried = named_function("canon.exercise.diagnose", name)
        yield from tried(WrongAnswer(finding, parts, domain, deadline))


def corrected(finding: Finding) -> str:
    """Return the right answer as text, where canon has it."""
    question = finding.question
    if not isinstance(question, Same | SameEquations | Stated):
        return ""
    if question.answer is None:
        parts = (
            [p for p in question.parts if not p.through and p.residual != 0]
            if isinstance(question, Same)
            else []
        )
        derived = finding.reading.kind.derived or finding.reading.has("solution")
        parts = [] if derived or (isinstance(question, Same) and question.said) else parts
        return "; ".join(f"{p.name} = {shown(p.right)}" for p in parts[:MOST_SENTENCES])
    try:
        answer = question.answer()
    except (ValueError, Undecided):
        return ""
    if answer is None:
        return ""
    if isinstance(question, Same) and question.answers:
        repaired = finding.reading.with_instead(question.answers, cast("Expr", answer))
        if not judged_to_hold(repaired, ANSWER_SECONDS):
            return ""
    ending = " = 0" if isinstance(question, SameEquations) else ""
    return "; ".join(f"{shown(e)}{ending}" for e in (answer if isinstance(answer, tuple) else (answer,)))
