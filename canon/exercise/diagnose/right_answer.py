"""Right answer of a claim that failed, as a sheet writes it, where canon has it."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from canon.exercise.diagnose.diagnosis import MOST_SENTENCES, judged_to_hold
from canon.exercise.diagnose.effort import PROOF_SECONDS, Effort
from canon.exercise.question.question import Same, SameEquations, Stated
from canon.exercise.sheet.sympy_trees import shown
from canon.proof.domain.verdict import Undecided

if TYPE_CHECKING:
    from sympy import Expr

    from canon.exercise.claim_verdict import Finding

__all__ = ["corrected"]


def corrected(finding: Finding) -> str:
    """Return the right answer as text, where canon has it.

    Raises
    ------
    BudgetSpent
        Where its proof was ended by its seconds.
    """
    question = finding.question
    if not isinstance(question, Same | SameEquations | Stated):
        return ""
    if question.answer is None:
        return _right_parts(finding, question) if isinstance(question, Same) else ""
    try:
        answer = question.answer()
    except (ValueError, Undecided):
        return ""
    if answer is None:
        return ""
    if isinstance(question, Same) and question.answers:
        repaired = finding.reading.with_instead(question.answers, cast("Expr", answer))
        if not judged_to_hold(repaired, Effort(PROOF_SECONDS)):
            return ""
    ending = " = 0" if isinstance(question, SameEquations) else ""
    return "; ".join(f"{shown(e)}{ending}" for e in (answer if isinstance(answer, tuple) else (answer,)))


def _right_parts(finding: Finding, question: Same) -> str:
    """Return what the wrong components should be, where a claim writes them as they are compared."""
    if finding.reading.kind.derived or finding.reading.has("solution") or question.said:
        return ""
    parts = [p for p in question.parts if not p.through and p.residual != 0]
    return "; ".join(f"{p.name} = {shown(p.right)}" for p in parts[:MOST_SENTENCES])
