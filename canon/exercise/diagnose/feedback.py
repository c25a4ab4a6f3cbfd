"""One sentence for a person: where and how an answer is wrong, and what would be right.

A diagnosis is told only when the claim, with the repair it names put in, was judged to hold as a whole.
"""

from __future__ import annotations

import time
from collections import Counter
from itertools import islice
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.exercise.diagnose.asymptotic import right_to_an_order
from canon.exercise.diagnose.changed_claims import (
    another_gauge,
    another_reading,
    one_change,
    only_where,
    right_where,
)
from canon.exercise.diagnose.convention import convention, variable_valence
from canon.exercise.diagnose.derived_part import new_hamiltonian_part, second_lagrangian_part, time_term
from canon.exercise.diagnose.diagnosis import Diagnosis, judged_to_hold
from canon.exercise.diagnose.repair import Screen, repairs
from canon.exercise.question.affine_systems import solved
from canon.exercise.question.question import Part, Same, SameEquations, Stated
from canon.exercise.sheet.sympy_trees import replaced, shown, symbols_of
from canon.mechanics.algebra.linear import SingularMatrixError
from canon.mechanics.algebra.substitution import substitute
from canon.proof.domain.verdict import Undecided
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr, Symbol

    from canon.exercise.judge import Finding
    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = ["corrected", "diagnosis", "feedback"]

MOST_SENTENCES = 3
MOST_TRIALS = 4
"""Proved repairs of one component that are tried in the whole claim."""
WHOLE_SECONDS = 1.0
ANSWER_SECONDS = 0.5
"""Time for the judgement on a repaired claim."""
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
    question, reading = finding.question, finding.reading
    if isinstance(question, SameEquations):
        if "is not affine" in finding.verdict.feedback:
            yield Diagnosis(finding.verdict.feedback)
            return
        parts, domain = _on_the_motion(question), question.domain
    elif isinstance(question, Same):
        parts, domain = question.parts, question.domain
    else:
        if finding.verdict.feedback:
            yield Diagnosis(finding.verdict.feedback)
        else:
            yield from another_reading(reading, deadline)
        return
    yield from convention(reading, parts, domain)
    yield from another_reading(reading, deadline)
    if parts and not reading.has("solution"):
        yield from _part_by_part(reading, parts, domain, deadline, _hints(question))
    if reading.claim.kind == "transformed-hamiltonian-K" and finding.held:
        for part in new_hamiltonian_part(reading):
            yield from _part_by_part(reading, (part,), domain, _partly(deadline, 0.6), [()])
    if reading.claim.kind == "constant-of-motion":
        yield from time_term(reading)
    yield from only_where(reading, deadline)
    two_answers = reading.claim.kind == "lagrangian-equivalence" and reading.has("F")
    until = _partly(deadline, 0.5 if two_answers else 0.75)
    yield from one_change(reading, until, _suspects(parts, domain), finding.held)
    yield from right_to_an_order(parts, domain, deadline)
    yield from variable_valence(reading)
    yield from another_gauge(reading, deadline)
    yield from right_where(reading, deadline)
    if two_answers:
        yield from _part_by_part(reading, (second_lagrangian_part(reading),), domain, deadline, [()])


def _partly(deadline: float, share: float) -> float:
    """Return a deadline that leaves some of the time to what comes after."""
    now = time.monotonic()
    return now + share * (deadline - now)


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
    if not isinstance(question, Same | SameEquations | Stated):
        return ""
    if question.answer is None:
        parts = (
            [p for p in question.parts if not p.through and p.residual != 0]
            if isinstance(question, Same)
            else []
        )
        derived = finding.reading.claim.kind.startswith(_DERIVED) or finding.reading.has("solution")
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


def _on_the_motion(question: SameEquations) -> tuple[Part, ...]:
    """Return each equation as it was written, as what should vanish with the right accelerations put in."""
    motion = _motion(question, question.unknowns) or _motion(question, _velocities(question))
    if motion is None:
        return ()
    through = {name: substitute(value, motion) for name, value in question.through.items()} | motion
    return tuple(
        Part(f"equation {i + 1}", e, through=through, key=f"claim[{i}]")
        for i, e in enumerate(question.written)
    )


def _motion(question: SameEquations, unknowns: Sequence[Symbol]) -> dict[Symbol, Expr] | None:
    """Return what the right equations determine, None where it is not all the unknowns."""
    if len(question.right) != len(unknowns):
        return None
    try:
        return solved(question.right, unknowns, question.domain)
    except (SingularMatrixError, Undecided):
        return None


def _velocities(question: SameEquations) -> list[Symbol]:
    """Return the velocities that equations without accelerations bind."""
    if any(f.has(*question.unknowns) for f in question.right):
        return []
    names = {u.name.replace("_ddot", "_dot") for u in question.unknowns}
    return [s for s in symbols_of(*question.right) if s.name in names]


def _hints(question: Same | SameEquations) -> list[tuple[Expr, ...]]:
    """Return for each claimed equation the terms of the right ones, brought to its scale."""
    if isinstance(question, Same):
        return [() for _ in question.parts]
    right_equations = _in_the_claims_terms(question)
    hints: list[tuple[Expr, ...]] = []
    for claimed in question.written:
        terms: dict[Expr, None] = {}
        for right in right_equations:
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


def _in_the_claims_terms(question: SameEquations) -> tuple[Expr, ...]:
    """Return the right equations as they are shown: those of Routh in momenta, not in ignorable velocities."""
    if not question.through or question.answer is None:
        return question.right
    try:
        answer = question.answer()
    except (ValueError, Undecided):
        return ()
    return tuple(e for e in answer if isinstance(e, sp.Expr)) if isinstance(answer, tuple) else ()


def _part_by_part(
    reading: Reading,
    parts: Sequence[Part],
    domain: Domain,
    deadline: float,
    hints: Sequence[tuple[Expr, ...]],
) -> Iterator[Diagnosis]:
    """Yield what is wrong with each component that is wrong."""
    wrong = [(part, hint) for part, hint in zip(parts, hints, strict=True) if _is_wrong(part, domain)]
    if not wrong:
        if all(
            part.through and vanishes_off_kinks(part.residual, domain, budget=0.5).holds for part in parts
        ):
            yield Diagnosis(
                "each equation is right, but together they do not determine the motion: an equation is missing"
            )
        return
    if all(part.key for part, _ in wrong):
        yield from _repaired(reading, wrong, domain, deadline)


def _repaired(
    reading: Reading,
    wrong: Sequence[tuple[Part, tuple[Expr, ...]]],
    domain: Domain,
    deadline: float,
    said: tuple[str, ...] = (),
) -> Iterator[Diagnosis]:
    """Yield the claim with one wrong component after the other repaired, and what was changed."""
    if not wrong:
        more = len(said) - MOST_SENTENCES
        told = said[:MOST_SENTENCES] + ((f"{more} more components are wrong",) if more > 0 else ())
        yield Diagnosis("; ".join(told), reading)
        return
    part, hint = wrong[0]
    if len(said) >= MOST_SENTENCES and not part.through:  # it is not told what to change here
        yield from _repaired(_with(reading, part, part.right), wrong[1:], domain, deadline, (*said, ""))
        return
    seconds = (deadline - time.monotonic()) / len(wrong)
    for found in islice(repairs(part, domain, seconds, hint), MOST_TRIALS):
        here = _with(reading, part, found.right)
        yield from _repaired(here, wrong[1:], domain, deadline, (*said, str(found.change)))


def _with(reading: Reading, part: Part, right: Expr) -> Reading:
    return reading.with_instead(part.key, replaced(right, part.written))


def _is_wrong(part: Part, domain: Domain) -> bool:
    return not Screen(part, domain).passes(part.claimed)
