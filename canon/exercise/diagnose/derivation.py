"""Slips in the derivation of an answer: multipliers of the other sign, a partial derivative for the total one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.diagnose.change import Change, Mistake
from canon.exercise.diagnose.diagnosis import Diagnosis
from canon.exercise.diagnose.repairs.repair import is_wrong
from canon.exercise.question.question import SameEquations
from canon.expression.symbols.symbol import acceleration, velocity
from canon.mechanics.algebra.substitution import exchanged

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sympy import Expr

    from canon.exercise.diagnose.diagnosis import WrongAnswer
    from canon.exercise.sheet.reading import Reading

__all__ = ["multipliers", "total_derivative"]

MOST_OPERATIONS = 80
"""Operations of the terms that are told at most."""


def multipliers(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield that all multipliers have the opposite sign, as under −Σ λ ∂f/∂q on the right."""
    reading = wrong.reading
    if not reading.has("multipliers"):
        return
    opposite = {s: -s for s in reading.symbols("multipliers")}
    answers = (
        {f"claim[{i}]": f for i, f in enumerate(reading.equations("claim"))} if reading.has("claim") else {}
    )
    changed = {key: exchanged(f, opposite) for key, f in answers.items() if f.has(*opposite)}
    if reading.has("values"):
        changed |= {f"values.{name}": -f for name, f in reading.table("values").items()}
    if not changed or not wrong.effort.spend(1):
        return
    trial = reading
    for key, f in changed.items():
        trial = trial.with_instead(key, f)
    velocities = [velocity(x) for x in reading.symbols("q")]
    on_velocities = any(g.has(*velocities) for g in reading.equations("constraints"))
    mistake = Mistake.REACTIONS_OPPOSITE if on_velocities else Mistake.MULTIPLIERS_OPPOSITE
    yield Diagnosis((Change.of(mistake, tuple(opposite)),), trial)


def total_derivative(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield that d/dt ∂L/∂q̇ was taken at fixed coordinates: the terms of its change with them are missing."""
    reading, question = wrong.reading, wrong.finding.question
    if not (isinstance(question, SameEquations) and question.written) or reading.has("cyclic"):
        return
    if not (reading.has("L") and len(question.written) <= len(reading.symbols("q"))):
        return
    trial, changes = reading, list[Change]()
    for i, claimed in enumerate(question.written):
        key = f"claim[{i}]"
        lost = _lost_of(claimed, reading)
        if lost == 0 or any(part.key == key and not is_wrong(part, wrong.domain) for part in wrong.parts):
            continue
        change = _at_fixed_coordinates(claimed, lost)
        if change is not None:
            trial = trial.with_instead(key, claimed + lost)
            changes.append(change.at(f"equation {i + 1}"))
    if changes:
        yield Diagnosis(tuple(changes), trial)


def _lost_of(claimed: Expr, reading: Reading) -> Expr:
    """Return Σ ∂²L/∂q̇∂q q̇ + ∂²L/∂q̇∂t of the coordinate whose equation this is, in the claim's scale; else 0."""
    L, q = reading.expression("L"), reading.symbols("q")
    for x in q:
        p = L.diff(velocity(x))
        above, below = claimed.diff(acceleration(x)), p.diff(velocity(x))
        lost = sp.Add(*(p.diff(y) * velocity(y) for y in q), p.diff(reading.time))
        if above != 0 and below != 0 and lost != 0 and sp.count_ops(lost) <= MOST_OPERATIONS:
            return sp.expand(sp.cancel(above / below) * lost)
    return sp.S.Zero


def _at_fixed_coordinates(claimed: Expr, lost: Expr) -> Change | None:
    """Return which terms are missing; of one that stands there with another number, which number is right."""
    there: dict[Expr, Expr] = {}
    for term in sp.Add.make_args(sp.expand(claimed)):
        number, bare = term.as_coeff_Mul()
        there[bare] = number
    terms = sp.Add.make_args(lost)
    if len(terms) > 1:
        return Change.of(Mistake.DERIVATIVE_NOT_TOTAL, *terms)
    number, bare = lost.as_coeff_Mul()
    if bare not in there:
        return None  # one term alone is named as what is missing
    factor = 1 + number / there[bare]
    return Change.of(Mistake.DERIVATIVE_NOT_TOTAL_IN, there[bare] * bare, factor) if factor != 0 else None
