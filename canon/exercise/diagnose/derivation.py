"""Slips in the derivation of an answer: multipliers of the other sign, a partial derivative for the total one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.diagnose.change import Change, Mistake
from canon.exercise.diagnose.diagnosis import Diagnosis
from canon.exercise.question.question import SameEquations
from canon.expression.symbols.symbol import acceleration, velocity
from canon.mechanics.algebra.substitution import exchanged

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.exercise.diagnose.diagnosis import WrongAnswer

__all__ = ["multipliers", "total_derivative"]


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
    yield Diagnosis((Change.of(Mistake.MULTIPLIERS_OPPOSITE, tuple(opposite)),), trial)


def total_derivative(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield that d/dt ∂L/∂q̇ was taken at fixed coordinates: the terms of its change with them are missing."""
    reading, question = wrong.reading, wrong.finding.question
    if not (isinstance(question, SameEquations) and question.written) or reading.has("cyclic"):
        return
    if not (reading.has("L") and len(question.written) <= len(reading.symbols("q"))):
        return
    L, q, trial = reading.expression("L"), reading.symbols("q"), reading
    changes: list[Change] = []
    for i, claimed in enumerate(question.written):
        for x in q:
            p = L.diff(velocity(x))
            above, below = claimed.diff(acceleration(x)), p.diff(velocity(x))
            lost = sp.Add(*(p.diff(y) * velocity(y) for y in q), p.diff(reading.time))
            if above == 0 or below == 0 or lost == 0 or sp.count_ops(lost) > 80:
                continue
            lost = sp.expand(sp.cancel(above / below) * lost)
            there = {term.as_coeff_Mul()[1] for term in sp.Add.make_args(sp.expand(claimed))}
            terms = list(sp.Add.make_args(lost))
            if (
                len(terms) > 1 or terms[0].as_coeff_Mul()[1] in there
            ):  # one term alone is named as what is missing
                trial = trial.with_instead(f"claim[{i}]", claimed + lost)
                place = f"equation {i + 1}"
                changes.append(Change(Mistake.DERIVATIVE_NOT_TOTAL, tuple(terms), place))
            break
    if changes:
        yield Diagnosis(tuple(changes), trial)
