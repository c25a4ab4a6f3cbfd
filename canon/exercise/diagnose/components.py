"""Components of a wrong answer repaired one by one: what to change in each, proved of the claim as a whole."""

from __future__ import annotations

from itertools import islice, product
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.diagnose.change import Change, Mistake
from canon.exercise.diagnose.derived_part import (
    acceleration_energy_part,
    generating_part,
    momentum_parts,
    new_hamiltonian_part,
    second_lagrangian_part,
)
from canon.exercise.diagnose.diagnosis import MOST_SENTENCES, Diagnosis
from canon.exercise.diagnose.effort import proved_to_vanish
from canon.exercise.diagnose.repairs.repair import is_wrong, repairs
from canon.exercise.question.question import Part, Same, SameEquations
from canon.mechanics.algebra.linear import SingularMatrixError, solve_affine
from canon.mechanics.algebra.substitution import exchanged, size, substitute, symbols_of
from canon.proof.domain.verdict import Undecided

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr, Symbol

    from canon.exercise.diagnose.diagnosis import WrongAnswer
    from canon.exercise.diagnose.effort import Effort
    from canon.exercise.sheet.reading import Reading
    from canon.proof.domain.domain import Domain

__all__ = [
    "acceleration_energy",
    "generating_function",
    "new_hamiltonian",
    "on_the_motion",
    "part_by_part",
    "point_momenta",
    "second_lagrangian",
]

MOST_TOGETHER = 3
"""Terms that may be missing together."""
MOST_NODES = 200
"""Size of a right answer whose terms are looked at."""
MOST_TRIALS = 4
"""Proved repairs of one component that are tried in the whole claim."""


def part_by_part(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield what is wrong with each component that is wrong."""
    if wrong.parts and not wrong.reading.has("solution"):
        yield from _part_by_part(wrong, _answered(wrong), _hints(wrong))


def _answered(wrong: WrongAnswer) -> Sequence[Part]:
    """Return the components; of two sides it is the one that is answered."""
    if not (wrong.reading.kind.two_sided and len(wrong.parts) == 1 and wrong.parts[0].key == "lhs"):
        return wrong.parts
    return (Part("rhs", wrong.parts[0].right, wrong.parts[0].claimed, key="rhs"),)


def acceleration_energy(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield what is wrong with the Gibbs–Appell function S."""
    parts = (acceleration_energy_part(wrong.reading),) if wrong.reading.has("S") else ()
    if any(is_wrong(part, wrong.domain) for part in parts):
        yield from _part_by_part(wrong, parts, [()])


def new_hamiltonian(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield what is wrong with K, where the map is canonical."""
    for part in new_hamiltonian_part(wrong.reading) if wrong.finding.held else ():
        yield from _part_by_part(wrong.within(0.6), (part,), [()])


def point_momenta(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield what is wrong with the new momenta, where the new coordinates depend on the old ones alone."""
    if wrong.reading.has("Q") and wrong.reading.has("P"):
        parts = momentum_parts(wrong.reading)
        yield from _part_by_part(wrong.within(0.6), parts, [() for _ in parts])


def generating_function(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield what is wrong with F beside the one that generates the map, where that is found."""
    for part in generating_part(wrong.finding):
        yield from _part_by_part(wrong.within(0.4), (part,), [()])


def second_lagrangian(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield what is wrong with L₂ beside L₁ + dF/dt."""
    if wrong.reading.has("F"):
        yield from _part_by_part(wrong, (second_lagrangian_part(wrong.reading),), [()])


def on_the_motion(question: SameEquations) -> tuple[Part, ...]:
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
        return solve_affine(question.right, unknowns, question.domain)
    except (SingularMatrixError, Undecided):
        return None


def _velocities(question: SameEquations) -> list[Symbol]:
    """Return the velocities that equations without accelerations bind."""
    if any(f.has(*question.unknowns) for f in question.right):
        return []
    names = {u.name.replace("_ddot", "_dot") for u in question.unknowns}
    return [s for s in symbols_of(*question.right) if s.name in names]


def _hints(wrong: WrongAnswer) -> list[tuple[Expr, ...]]:
    """Return for each claimed equation the terms of the right ones, brought to its scale."""
    question = wrong.finding.question
    if isinstance(question, Same):
        return [
            _terms_of_answer(question) if part.through and part.right != 0 else () for part in wrong.parts
        ]
    if not isinstance(question, SameEquations):
        return [() for _ in wrong.parts]
    right_equations = _in_the_claims_terms(question)
    return [_terms_to_scale(claimed, right_equations, question.unknowns) for claimed in question.written]


def _terms_to_scale(
    claimed: Expr, right_equations: Sequence[Expr], unknowns: Sequence[Symbol]
) -> tuple[Expr, ...]:
    """Return the terms of the right equations, as large as the claimed one has them, and their sums."""
    terms: dict[Expr, None] = {}
    for right, unknown in product(right_equations, unknowns):
        above, below = claimed.diff(unknown), right.diff(unknown)
        if above == 0 or below == 0:
            continue
        small = sp.count_ops(above) + sp.count_ops(below) < 60
        scale = sp.cancel(above / below) if small else above / below
        rest = [scale * t for t in sp.Add.make_args(sp.expand(right)) if not t.has(*unknowns)]
        terms |= dict.fromkeys(rest)
        if 1 < len(rest) <= MOST_TOGETHER:
            terms[sp.Add(*rest)] = None
    return tuple(terms)


def _terms_of_answer(question: Same) -> tuple[Expr, ...]:
    """Return the terms of the right answer in the variables in which it is asked, such as those of H(q, p)."""
    if question.answer is None or len(question.parts) > 1:
        return ()
    try:
        answer = question.answer()
    except (ValueError, Undecided):
        return ()
    if not isinstance(answer, sp.Expr) or size(answer) > MOST_NODES:
        return ()
    return tuple(dict.fromkeys((*sp.Add.make_args(answer), *sp.Add.make_args(sp.expand(answer)))))


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
    answer: WrongAnswer, parts: Sequence[Part], hints: Sequence[tuple[Expr, ...]]
) -> Iterator[Diagnosis]:
    domain = answer.domain
    wrong = [(part, hint) for part, hint in zip(parts, hints, strict=True) if is_wrong(part, domain)]
    if not wrong:
        if parts and all(
            part.through and proved_to_vanish(part.residual, domain, answer.effort) for part in parts
        ):
            yield Diagnosis.stated(Mistake.EQUATION_MISSING, only_fault=False)
        return
    if all(part.key for part, _ in wrong):
        yield from _repaired(answer.reading, wrong, domain, answer.effort)


def _repaired(
    reading: Reading,
    wrong: Sequence[tuple[Part, tuple[Expr, ...]]],
    domain: Domain,
    effort: Effort,
    said: tuple[tuple[Change, ...], ...] = (),
) -> Iterator[Diagnosis]:
    """Yield the claim with one wrong component after the other repaired, and what was changed."""
    if not wrong:
        more = len(said) - MOST_SENTENCES
        told = sum(said[:MOST_SENTENCES], ())
        yield Diagnosis((*told, Change.of(Mistake.MORE_WRONG, more)) if more > 0 else told, reading)
        return
    part, hint = wrong[0]
    if len(said) >= MOST_SENTENCES and not part.through:  # it is not told what to change here
        yield from _repaired(_with(reading, part, part.right), wrong[1:], domain, effort, (*said, ()))
        return
    for found in islice(repairs(part, domain, effort.share(1 / len(wrong)), hint), MOST_TRIALS):
        here = _with(reading, part, found.right)
        yield from _repaired(here, wrong[1:], domain, effort, (*said, found.changes))


def _with(reading: Reading, part: Part, right: Expr) -> Reading:
    return reading.with_instead(part.key, exchanged(right, part.written))
