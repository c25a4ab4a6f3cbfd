"""Claims about variations and differentials: δL by parts, and d of a function whose differential is known in part."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.judges.invariance import is_instead
from canon.exercise.question.question import Part, Question, Same, fails
from canon.expression.symbols.symbol import Coordinate, acceleration, time_derivative, velocity
from canon.proof.trees.affine_form import is_affine

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.exercise.sheet.reading import Reading

__all__ = ["differential", "variation"]


def variation(reading: Reading) -> Iterator[Question]:
    """δL + Σ Q δq = d(boundary)/dt + integrand, the integrand free of δq̇."""
    q, t, L = reading.symbols("q"), reading.time, reading.expression("L")
    if L.has(*(acceleration(x) for x in q)):
        reading.fault("L", "a Lagrangian depends on coordinates, velocities and time only")
    forces = reading.expressions("Qnc", like="q") if reading.has("Qnc") else (sp.S.Zero,) * len(q)
    extended = reading.with_names(
        {d.name: d for x in q if (d := Coordinate(f"delta_{x}", real=True)).name not in reading.scope.names}
    )
    deltas = tuple(extended.scope.names[f"delta_{x}"] for x in q)
    if L.has(*deltas):
        reading.fault("L", f"{deltas[0]} is the variation of {q[0]}; call a parameter otherwise")
    boundary, integrand = extended.expression("boundary"), extended.expression("integrand")
    rates = [velocity(d) for d in deltas]
    if boundary.has(*rates) or integrand.has(*rates):
        where = "boundary term" if boundary.has(*rates) else "integrand"
        yield fails(where, f"the {where} still holds a rate of a variation; integrate it by parts")
        return
    for key, part in (("boundary", boundary), ("integrand", integrand)):
        _check_linear(
            reading, key, part, deltas
        )  # then both are unique: δq and δq̇ are independent at an instant
    pairs = list(zip(q, deltas, forces, strict=True))
    slopes = [L.diff(velocity(x)) for x in q]
    whole = sp.Add(*((L.diff(x) + Q) * d for x, d, Q in pairs))
    right_boundary = sp.Add(*(s * d for s, d in zip(slopes, deltas, strict=True)))
    right_integrand = whole - sp.Add(
        *(time_derivative(s, q, t) * d for s, d in zip(slopes, deltas, strict=True))
    )
    parts = (
        Part("the boundary term", boundary, right_boundary, key="boundary"),
        Part("the integrand", integrand, right_integrand, key="integrand"),
    )
    answer = (f"boundary: {right_boundary}", f"integrand: {right_integrand}")
    yield Same(parts, reading.domain, lambda: answer)


def differential(reading: Reading) -> Iterator[Question]:
    """df = claim, where the differentials of some symbols in f are given in those of the variables."""
    x = (*reading.symbols("x"), reading.time)
    marks = tuple(Symbol(f"d_{s}", real=True) for s in x)
    extended = reading.with_names({s.name: s for s in marks})
    given = extended.table("given") if reading.has("given") else {}
    f, claim = reading.expression("f"), extended.expression("claim")
    rates: dict[Symbol, Expr] = dict(zip(x, marks, strict=True))
    for name, form in given.items():
        symbol = reading.scope.symbol(name)
        if symbol is None or symbol in x:
            reading.fault(f"given.{name}", "should be a declared symbol that is none of the variables")
        _check_linear(reading, f"given.{name}", form, marks)
        if not is_affine(form, marks):
            reading.fault(f"given.{name}", "should be a sum of the differentials with coefficients")
        rates[symbol] = form
    _check_linear(reading, "claim", claim, marks)
    right = sp.Add(*(f.diff(s) * form for s, form in rates.items()))
    parts = tuple(Part(f"the coefficient of {m}", claim.diff(m), sp.expand(right).diff(m)) for m in marks)
    if not is_affine(claim, marks):  # steps, and atan(tan dx), have slopes that do not show them
        parts = (*parts, Part("df", claim, right, key="claim"))
    yield Same(parts, reading.domain, lambda: sp.collect(sp.expand(right), marks), is_instead)


def _check_linear(reading: Reading, key: str, form: Expr, marks: Sequence[Symbol]) -> None:
    slopes = [form.diff(m) for m in marks]
    at_rest = form.xreplace(dict.fromkeys(marks, sp.S.Zero))
    if at_rest != 0 or any(s.has(*marks) for s in slopes):
        reading.fault(key, "should be linear in " + ", ".join(map(str, marks)))
