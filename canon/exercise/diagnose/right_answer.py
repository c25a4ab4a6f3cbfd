"""Right answer of a claim that failed, as a sheet writes it, where canon has it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, cast

from sympy import Expr

from canon.exercise.diagnose.diagnosis import MOST_SENTENCES, judged_to_hold
from canon.exercise.diagnose.effort import PROOF_SECONDS, PROOF_STEPS, Effort, proved_to_vanish
from canon.exercise.diagnose.proved_share import EQUATIONS, repaired_components
from canon.exercise.question.book_form import book_forms
from canon.exercise.question.question import Same, SameEquations, Stated
from canon.exercise.sheet.sympy_trees import shown
from canon.proof.domain.verdict import Undecided

if TYPE_CHECKING:
    from canon.exercise.claim_verdict import Finding
    from canon.exercise.diagnose.diagnosis import Diagnosis
    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = ["corrected", "repaired_answer"]

MOST_PROOFS = 12
"""Proofs of forms in which a right answer is shown."""


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
    domain = finding.reading.domain if isinstance(question, Stated) else question.domain
    forms = _Forms(domain)
    return "; ".join(
        f"{shown(forms.best(e))}{ending}" for e in (answer if isinstance(answer, tuple) else (answer,))
    )


def _right_parts(finding: Finding, question: Same) -> str:
    """Return what the wrong components should be, where a claim writes them as they are compared."""
    if finding.reading.kind.derived or finding.reading.has("solution") or question.said:
        return ""
    forms = _Forms(question.domain)
    parts = [p for p in question.parts if not p.through and p.residual != 0]
    if finding.reading.kind.two_sided:  # the left side is given, the right side is the answer
        return "; ".join(f"rhs = {shown(forms.best(p.claimed))}" for p in parts)
    return "; ".join(f"{p.name} = {shown(forms.best(p.right))}" for p in parts[:MOST_SENTENCES])


def repaired_answer(finding: Finding, found: Diagnosis | None) -> str:
    """Return what was repaired in an answer as text, which was judged to hold; nothing where another claim was meant.

    Raises
    ------
    BudgetSpent
        Where the proof of a form was ended by its seconds.
    """
    if found is None or found.repaired is None:
        return ""
    changed, forms = repaired_components(finding.reading, found.repaired), _Forms(finding.reading.domain)
    return "; ".join(_of_component(key, shown(forms.best(f)), finding.reading) for key, f in changed.items())


def _of_component(key: str, text: str, reading: Reading) -> str:
    """Return a component with its name: ``P2 = …`` for P[1], an equation for what should vanish."""
    whole, _, number = key.removesuffix("]").partition("[")
    if whole in EQUATIONS and whole not in reading.kind.components:
        return f"{text} = 0"
    name = whole.rpartition(".")[2]
    key, _, part = whole.partition(".")
    value = reading.claim.keys.get(key)
    entries = value[part] if part and isinstance(value, Mapping) else value
    alone = not number or not isinstance(entries, list) or len(entries) == 1
    return f"{name if alone else f'{name}{int(number) + 1}'} = {text}"


class _Forms:
    """The choice among plain forms of right answers, all of them together limited by a count of steps."""

    def __init__(self, domain: Domain) -> None:
        self.domain, self.effort = domain, Effort(PROOF_SECONDS, MOST_PROOFS * PROOF_STEPS)

    def best(self, item: object) -> object:
        """Return the shortest form that is proved to be the same, or what is given as it stands."""
        for form in book_forms(item) if isinstance(item, Expr) and not self.effort.spent else ():
            if self.effort.spent:
                break
            if proved_to_vanish(form - item, self.domain, self.effort):
                return form
        return item
