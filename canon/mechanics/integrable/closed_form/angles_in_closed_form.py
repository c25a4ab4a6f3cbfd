"""Angles in closed form, θ = ∂W/∂J: Kepler's equation, the pendulum's amplitude, and others whose integrals are known.

∂W/∂α is the sum of incomplete integrals ½ ∫ f/p dq with the derivatives of the coefficients of p² for factors, and
θ = (∂J/∂α)⁻ᵀ ∂W/∂α by Cramer's rule (M. Born, Vorlesungen über Atommechanik, section 15). As with actions nothing is
returned on recognition alone: see :func:`closed_angles`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Rational, Symbol

from canon.expression.symbols.user_input import given_kind
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.integrable.actions import ActionVariables, angles
from canon.mechanics.integrable.closed_form.actions_in_closed_form import (
    GUARD_BITS,
    TORI,
    in_reciprocals,
    lies_in,
    neighbouring_tori,
    recognised,
    terms_in,
)
from canon.mechanics.integrable.closed_form.incomplete_integrals import Incomplete, integrals_by_terms
from canon.mechanics.integrable.cycles import CycleKind
from canon.proof.domain.balls import precision

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import arb

    from canon.mechanics.integrable.cycles import Cycle
    from canon.mechanics.integrable.separated_momenta import SeparatedMomentum

__all__ = ["ClosedAngle", "closed_angles"]

PLACES = (Rational(1, 3), Rational(7, 10))
"""Where in each cycle a formula is compared, in parts of it."""


@dataclass(frozen=True)
class ClosedAngle:
    """An angle as a function of the coordinates and the constants, for given signs of the momenta.

    Parameters
    ----------
    theta
        The formula, zero where each libration is at its lower turning point.
    signs
        The signs of p_i less its shift that it is meant for, by coordinate.
    tori
        On how many tori it lies in the certified balls, at two places of each.
    digits
        The digits of those balls.
    """

    theta: Expr
    signs: Mapping[Symbol, int]
    tori: int
    digits: int


def closed_angles(
    torus: ActionVariables, signs: Mapping[Symbol, int] | None = None
) -> tuple[ClosedAngle | None, ...]:
    """Return the angles in closed form where all integrals of the motion are known ones; None for the others.

    Parameters
    ----------
    torus
        What :func:`action_variables` returned.
    signs
        −1 for librations on their way back, by coordinate; 1 for the others.

    Raises
    ------
    ValueError
        For a sign of what is no coordinate, or that is neither 1 nor −1.

    Examples
    --------
    >>> import sympy as sp
    >>> from canon.mechanics import Hamiltonian, action_variables, hamilton_jacobi
    >>> q, p = sp.symbols("q p", real=True)
    >>> w = sp.Symbol("omega", positive=True)
    >>> oscillator = hamilton_jacobi(Hamiltonian(p**2/2 + w**2*q**2/2, q, p))
    >>> torus = action_variables(oscillator, {q: 1, p: 1}, {w: 2})
    >>> [angle.theta for angle in closed_angles(torus)]
    [acos(-sqrt(2)*omega*q/(2*sqrt(E)))]
    """
    given_kind(torus, ActionVariables, "what closed_angles() takes", "action_variables() returns it")
    momenta, n = torus.integral.momenta, len(torus.cycles)
    ways = _ways(torus, signs or {})
    by_alpha = [_derivatives(m, c, torus, ways[m.q]) for m, c in zip(momenta, torus.cycles, strict=True)]
    if any(row is None for row in by_alpha):
        return (None,) * n
    rows = cast("list[list[Incomplete]]", by_alpha)
    formulas = _angles(rows, torus.cycles)
    tori = neighbouring_tori(torus)
    if len(tori) < TORI:
        return (None,) * n
    proved = _agreeing(formulas, tori, ways)
    return tuple(
        ClosedAngle(theta, ways, len(tori), torus.digits) if agrees else None
        for theta, agrees in zip(formulas, proved, strict=True)
    )


def _ways(torus: ActionVariables, signs: Mapping[Symbol, int]) -> dict[Symbol, int]:
    q = torus.integral.H.q
    unknown = [str(s) for s in signs if s not in q]
    if unknown:
        raise ValueError(
            f"signs are given by coordinate, and {', '.join(unknown)} is none of {', '.join(map(str, q))}"
        )
    if not all(sign in (1, -1) for sign in signs.values()):
        raise ValueError("a sign is 1, or -1 for a libration on its way back")
    return {s: signs.get(s, 1) for s in q}


def _derivatives(
    momentum: SeparatedMomentum, cycle: Cycle, torus: ActionVariables, sign: int
) -> list[Incomplete] | None:
    """Return ∂/∂α of ∫ p dq by each constant, or None where an integral is not known."""
    q, constants = momentum.q, torus.integral.constants
    if cycle.kind is CycleKind.IGNORABLE:
        period = cast("Expr", cycle.period)
        return [Incomplete(q, period).times(momentum.shift.diff(c)) for c in constants]
    found = recognised(momentum, cycle, torus.values)
    if found is None or momentum.square is None:
        return None
    coefficients = terms_in(in_reciprocals(momentum.square), q)
    others = {f: c for f, c in coefficients.items() if f != 1}
    A = coefficients.get(sp.S.One, sp.S.Zero)
    integrals = integrals_by_terms(found[1], A, others, q, cycle)
    if integrals is None:
        return None
    slopes = [{f: c.diff(constant) for f, c in coefficients.items()} for constant in constants]
    moving = [{f: slope for f, slope in each.items() if slope != 0} for each in slopes]
    if not all(each.keys() <= integrals.keys() for each in moving):
        return None
    back = cycle.kind is CycleKind.LIBRATION and sign < 0
    return [_total(each, integrals, back) for each in moving]


def _total(slopes: Mapping[Expr, Expr], integrals: Mapping[Expr, Incomplete], back: bool) -> Incomplete:
    """Return the sum of integrals times slopes, on the way back from the upper turning point if need be."""
    total = Incomplete(sp.S.Zero, sp.S.Zero)
    for f, slope in slopes.items():
        total = total.plus(integrals[f].times(slope))
    return Incomplete(2 * total.whole - total.part, total.whole) if back else total


def _angles(rows: Sequence[Sequence[Incomplete]], cycles: Sequence[Cycle]) -> list[Expr]:
    """Return θ_i = Σ_j (∂α_j/∂J_i) ∂W/∂α_j."""
    n = len(rows)
    ways = [sp.pi if c.kind is CycleKind.LIBRATION else 2 * sp.pi for c in cycles]
    slopes = sp.Matrix([[each.whole / way for each in row] for row, way in zip(rows, ways, strict=True)])
    of_W = [sp.Add(*(row[j].part for row in rows)) for j in range(n)]
    determinant = cast("Expr", slopes.det(method="berkowitz"))
    cofactors = [
        [cast("Expr", slopes.cofactor(i, j, method="berkowitz")) if n > 1 else sp.S.One for j in range(n)]
        for i in range(n)
    ]
    of_J = [[_multiplied(cofactor, 1 / determinant) for cofactor in row] for row in cofactors]
    return [
        sp.Add(*(_multiplied(term, row[j]) for j in range(n) for term in sp.Add.make_args(of_W[j])))
        for row in of_J
    ]


def _multiplied(f: sp.Basic, g: Expr) -> Expr:
    """Return a product whose factors are multiplied out once more: √(−E)² is −E there, and −E/E is −1."""
    return sp.Mul(*(sp.Mul(*sp.Mul.make_args(factor)) for factor in sp.Mul.make_args(f * g)))


def _agreeing(
    formulas: Sequence[Expr], tori: Sequence[ActionVariables], ways: Mapping[Symbol, int]
) -> list[bool]:
    """Tell which formulas lie in the certified balls at some places of each torus."""
    agree = [True] * len(formulas)
    for torus in tori:
        for part in PLACES:
            state = _state(torus, part, ways)
            certified = angles(torus, state)
            at = {**torus.values, **{s: state[s] for s in torus.integral.H.q}}
            with precision(int(torus.digits * 3.33) + GUARD_BITS):
                agree = [
                    known and lies_in(theta, at, ball)
                    for known, theta, ball in zip(agree, formulas, certified, strict=True)
                ]
    return agree


def _state(torus: ActionVariables, part: Expr, ways: Mapping[Symbol, int]) -> dict[Symbol, Expr]:
    """Return coordinates at a part of each cycle, and momenta whose signs are those of the formula."""
    state: dict[Symbol, Expr] = {}
    for momentum, cycle in zip(torus.integral.momenta, torus.cycles, strict=True):
        if cycle.kind is CycleKind.LIBRATION:
            low, high = (float(end) for end in cast("tuple[arb, arb]", cycle.turning_points))
            state[momentum.q] = Rational(low) + part * (Rational(high) - Rational(low))
            sign = ways[momentum.q]
        else:
            state[momentum.q], sign = part, cycle.sign
        shift = substitute(momentum.shift, {**torus.values, momentum.q: state[momentum.q]})
        state[momentum.p] = shift + sign
    return state
