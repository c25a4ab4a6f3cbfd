"""One sentence for a person: where and how an answer is wrong, and what would be right.

A diagnosis is told only when the repair it names was proved right.
"""

from __future__ import annotations

import time
from collections import Counter
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.affine import solved
from canon.exercise.convention import convention
from canon.exercise.question import Part, Same, SameEquations
from canon.exercise.rejudged import another_gauge, another_reading, one_change, only_where
from canon.exercise.repair import Screen, repair
from canon.mechanics.linear import SingularMatrixError
from canon.proof.vanish import vanishes
from canon.proof.verdict import Undecided

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

    from canon.exercise.judge import Finding
    from canon.proof.domain import Domain

__all__ = ["corrected", "feedback"]

MOST_SENTENCES = 3
_DERIVED = (
    "gibbs-appell",
    "canonicity",
    "generating",
    "transformed",
    "constant-of-motion",
    "lagrangian-equivalence",
)
"""Kinds whose components are derivatives of what was answered, so that a component is no answer to repair."""


def feedback(finding: Finding, seconds: float) -> str:
    """Return a diagnosis whose repair was proved, or nothing.

    Parameters
    ----------
    finding
        A failed judgement with the question on which it turned.
    seconds
        How long may be looked for a repair.
    """
    deadline = time.monotonic() + seconds
    question, reading = finding.question, finding.reading
    if isinstance(question, SameEquations):
        parts, domain = _on_the_motion(question), question.domain
    elif isinstance(question, Same):
        parts, domain = question.parts, question.domain
    else:
        return finding.verdict.feedback or another_reading(reading, deadline)
    sentence = convention(reading, parts, domain) or another_reading(reading, deadline)
    by_part = isinstance(question, SameEquations) or not reading.claim.kind.startswith(_DERIVED)
    if not sentence and by_part and parts and not reading.has("solution"):
        sentence = _part_by_part(parts, domain, deadline, _hints(question))
    return (
        sentence
        or only_where(reading, deadline)
        or one_change(reading, deadline, _suspects(parts, domain), finding.held)
        or another_gauge(reading, deadline)
    )


def _suspects(parts: Sequence[Part], domain: Domain) -> list[str]:
    """Return the names in brackets that are wrong, the most frequent first."""
    counts: Counter[str] = Counter()
    for part in parts:
        if part.name.startswith("{") and _is_wrong(part, domain):
            counts.update(part.name.strip("{}").split(", "))
    return [name for name, _ in counts.most_common()]


def corrected(finding: Finding) -> str:
    """Return the right answer as text, where canon has it."""
    question = finding.question
    if not isinstance(question, Same | SameEquations):
        return ""
    if question.answer is None:
        shown = (
            [p for p in question.parts if not p.through and p.residual != 0]
            if isinstance(question, Same)
            else []
        )
        shown = [] if finding.reading.claim.kind.startswith(_DERIVED) else shown
        return "; ".join(f"{p.name} = {p.right}" for p in shown[:MOST_SENTENCES])
    try:
        answer = question.answer()
    except (ValueError, Undecided):
        return ""
    if answer is None:
        return ""
    ending = " = 0" if isinstance(question, SameEquations) else ""
    return "; ".join(f"{e}{ending}" for e in (answer if isinstance(answer, tuple) else (answer,)))


def _on_the_motion(question: SameEquations) -> tuple[Part, ...]:
    """Return each claimed equation as what should vanish with the right accelerations put in."""
    if len(question.right) != len(question.unknowns):
        return ()
    try:
        through = solved(question.right, question.unknowns, question.domain)
    except (SingularMatrixError, Undecided):
        return ()
    return tuple(Part(f"equation {i}", e, through=through) for i, e in enumerate(question.claimed, 1))


def _hints(question: Same | SameEquations) -> list[tuple[Expr, ...]]:
    """Return for each claimed equation the terms of the right ones, brought to its scale."""
    if isinstance(question, Same):
        return [() for _ in question.parts]
    hints: list[tuple[Expr, ...]] = []
    for claimed in question.claimed:
        terms: dict[Expr, None] = {}
        for right in question.right:
            for u in question.unknowns:
                above, below = claimed.diff(u), right.diff(u)
                if above != 0 and below != 0:
                    small = sp.count_ops(above) + sp.count_ops(below) < 60
                    scale = sp.cancel(above / below) if small else above / below
                    scaled = (
                        scale * t for t in sp.Add.make_args(sp.expand(right)) if not t.has(*question.unknowns)
                    )
                    terms |= dict.fromkeys(scaled)
        hints.append(tuple(terms))
    return hints


def _part_by_part(
    parts: Sequence[Part], domain: Domain, deadline: float, hints: Sequence[tuple[Expr, ...]]
) -> str:
    """Return what is wrong with each component that is wrong."""
    wrong = [(part, hint) for part, hint in zip(parts, hints, strict=True) if _is_wrong(part, domain)]
    if not wrong:
        if not all(part.through and vanishes(part.residual, domain, budget=0.5).holds for part in parts):
            return ""
        return "each equation is right, but together they do not determine the motion: an equation is missing"
    sentences: list[str] = []
    for number, (part, hint) in enumerate(wrong[:MOST_SENTENCES]):
        left = (deadline - time.monotonic()) / (len(wrong) - number)
        found = repair(part, domain, left, hint)
        if found is None:
            return ""
        sentences.append(str(found.change))
    if len(wrong) > MOST_SENTENCES:
        sentences.append(f"{len(wrong) - MOST_SENTENCES} more components are wrong")
    return "; ".join(sentences)


def _is_wrong(part: Part, domain: Domain) -> bool:
    return not Screen(part, domain).passes(part.claimed)
