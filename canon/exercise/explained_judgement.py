"""Explained judgement: a claim judged with what a report says of it, and a sheet's claims in turn."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.claim_verdict import InvalidClaim, examine
from canon.exercise.question.deadline import Worked
from canon.exercise.report.derivation_steps import steps
from canon.exercise.report.judgement import MAX_SHOWN, Judgement, invalid, points_of, without_explanation
from canon.expression.symbols.magnitude import written
from canon.proof.rungs.ladder import REFUSALS, refusal

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.exercise.claim_verdict import Finding
    from canon.exercise.diagnose.kept_explanations import Explanation, KeptExplanations
    from canon.exercise.sheet.sheet import Claim
    from canon.proof.domain.verdict import Verdict

__all__ = ["judgements"]


def judgements(claim: Claim, kept: KeptExplanations | None = None) -> Iterator[tuple[Judgement, bool]]:
    """Yield the judgement on a claim, then the same with its steps, then with feedback; the flag marks the last.

    Parameters
    ----------
    claim
        The claim.
    kept
        What was said of wrong answers before, which is said again of the same ones.
    """
    try:
        finding = examine(claim)
        said = finding.reading.warnings
    except InvalidClaim as error:
        yield invalid(claim, error.error.brief), True
        return
    except (RecursionError, MemoryError) as error:
        what = "memory" if isinstance(error, MemoryError) else "depth of its expressions"
        known = f"the {what} that it needs is beyond the limit"
        yield replace(invalid(claim, known), status="undecided"), True
        return
    except REFUSALS as error:
        known = _cut(f"on the way SymPy meets what it can't build: {refusal(error)}")
        yield replace(invalid(claim, known), status="undecided"), True
        return
    assumed = finding.verdict.assumed if finding.verdict.holds else ()
    judgement = replace(_told(claim, finding.verdict), warnings=(*said, *assumed))
    yield judgement, False
    yield from _explained(claim, finding, judgement, kept)


def _explained(
    claim: Claim, finding: Finding, judgement: Judgement, kept: KeptExplanations | None
) -> Iterator[tuple[Judgement, bool]]:
    """Yield the judgement with what explains it; where that can't be built, as it stands."""
    try:
        for step in _explanations(claim, finding, judgement, kept):
            judgement = step[0]
            yield step
    except REFUSALS:
        yield judgement, True


def _explanations(
    claim: Claim, finding: Finding, judgement: Judgement, kept: KeptExplanations | None
) -> Iterator[tuple[Judgement, bool]]:
    judgement = replace(judgement, steps=steps(finding))
    if not finding.verdict.fails:
        left = finding.left_open() if finding.verdict.holds else ()
        yield replace(judgement, warnings=(*judgement.warnings, *left)), True
        return
    from canon.exercise.diagnose.effort import BudgetSpent
    from canon.exercise.diagnose.kept_explanations import meaning
    from canon.exercise.diagnose.right_answer import corrected

    meant = None if kept is None else meaning(finding)
    said = None if kept is None else kept.of(meant)
    try:
        if said is None:
            judgement = replace(judgement, corrected=_cut(corrected(finding)))
            yield judgement, False  # before the diagnosis is looked for, which can be cut off
            said = _explanation(claim, finding, judgement)
            if kept is not None:
                kept.keep(meant, said)
        yield _with(said, judgement), True
    except BudgetSpent:
        yield without_explanation(judgement, claim.budget), True


def _explanation(claim: Claim, finding: Finding, judgement: Judgement) -> Explanation:
    """Return what is said of a wrong answer, with the share of it that is proved to be right where that is asked."""
    from canon.exercise.diagnose.diagnosis_search import OUTER_SECONDS, diagnosis
    from canon.exercise.diagnose.kept_explanations import Explanation
    from canon.exercise.diagnose.proved_share import proved_share
    from canon.exercise.diagnose.right_answer import repaired_answer
    from canon.exercise.report.sentences import sentence

    found = diagnosis(finding, min(OUTER_SECONDS, claim.budget - finding.start.since(Worked.now())))
    share = float(proved_share(finding, found)) if claim.keys.get("partial") else None
    right = judgement.corrected or _cut(repaired_answer(finding, found))
    return Explanation(right, _cut(sentence(found)) if found else "", share)


def _with(said: Explanation, judgement: Judgement) -> Judgement:
    """Return a judgement with an explanation; what the judge said stays where nothing better is found."""
    share = judgement.share if said.share is None else said.share
    feedback = said.feedback or judgement.feedback
    return replace(judgement, corrected=said.corrected, feedback=feedback, share=share)


def _told(claim: Claim, verdict: Verdict) -> Judgement:
    example = verdict.counterexample
    point = {"point": dict(example.point), "left": example.left, "right": example.right} if example else None
    known = "; ".join(evidence.text for evidence in verdict.evidence) if verdict.undecided else ""
    return Judgement(
        claim.id,
        claim.kind,
        verdict.status.value,
        verdict.seconds,
        certificate=verdict.certificate,
        question=verdict.question,
        counterexample=point,
        residual=_short(verdict.residual) if verdict.fails or verdict.undecided else "",
        feedback=_cut(verdict.feedback),
        known=_cut(known),
        title=str(claim.keys.get("title", "")),
        expect=claim.expect,
        points=points_of(claim),
        share=_share(claim, verdict),
    )


def _share(claim: Claim, verdict: Verdict) -> float | None:
    """Return the share of an answer as far as the verdict alone tells it."""
    if points_of(claim) is None or verdict.undecided:
        return None
    if verdict.holds:
        return 1.0
    return None if claim.keys.get("partial") else 0.0


def _short(residual: sp.Basic | sp.MatrixBase | None) -> str:
    """Return an expression as text, unless that would be longer than anyone reads."""
    if residual is None:
        return ""
    if (
        isinstance(residual, sp.Basic)
        and sum(1 for _ in zip(sp.preorder_traversal(residual), range(5000), strict=False)) >= 5000
    ):
        return "(too long to be shown)"
    return _cut(written(residual))


def _cut(text: str) -> str:
    return text if len(text) <= MAX_SHOWN else f"{text[:MAX_SHOWN]} …"
