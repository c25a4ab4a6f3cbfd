"""Contact: one-sided constraints f(q, t) ≥ 0; where f = 0 the reaction λ ∂f/∂q can push but not pull.

With d/dt ∂L/∂q̇ − ∂L/∂q = Q + λ ∂f/∂q the contact needs λ ≥ 0; it ends where λ becomes negative.
"""

from __future__ import annotations

from operator import index
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.symbol import time_derivative, velocity
from canon.mechanics.algebra.all_vanish import differ, is_quadratic_in
from canon.mechanics.algebra.dynamicsymbols import coordinate_symbols, plain_places
from canon.mechanics.algebra.substitution import exchanged, substitute
from canon.mechanics.reduction.eliminate_constraints import embedded, satisfies
from canon.mechanics.reduction.routh import routhian

if TYPE_CHECKING:
    from collections.abc import Mapping

    from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    from canon.mechanics.lagrange.lagrangian import Lagrangian
    from canon.proof.domain.domain import Domain

__all__ = ["multiplier_along", "multiplier_in_contact"]


def multiplier_in_contact(
    constrained: ConstrainedLagrangian, places: Mapping[Symbol, Expr], q: tuple[Symbol, ...], which: int = 0
) -> Expr:
    """Return the multiplier λ of one constraint as a function of the coordinates that are left in contact.

    Parameters
    ----------
    constrained
        The system in contact, the one-sided constraint written as f = 0 with f ≥ 0 on the free side.
    places
        Positions in contact as functions of fewer coordinates; a coordinate that stays may be left out.
    q
        Those coordinates.
    which
        The number of the constraint, counted from 0, holonomic ones first.

    Raises
    ------
    ValueError
        Where the positions do not satisfy the constraints, or there is no constraint of this number.
    """
    count = constrained.directions.rows
    if index(which) not in range(count):
        raise ValueError(f"no constraint has the number {which}; there are {count}, counted from 0")
    q = coordinate_symbols(q)
    verdict = satisfies(constrained, places, q)
    if not verdict.holds:
        raise ValueError(f"the positions are not in contact: {verdict.feedback or verdict}")
    t = constrained.lagrangian.t
    given = plain_places(places, constrained.lagrangian.q, q, t)
    whole = {s: given.get(s, s) for s in constrained.lagrangian.q}
    rates = {velocity(s): time_derivative(place, q, t) for s, place in whole.items()}
    return substitute(constrained.multipliers[which], {**whole, **rates})


def multiplier_along(
    constrained: ConstrainedLagrangian,
    places: Mapping[Symbol, Expr],
    s: Symbol,
    start: Expr,
    speed: Expr = sp.S.Zero,
    which: int = 0,
    domain: Domain | None = None,
    others: Mapping[Symbol, Expr] | None = None,
) -> Expr:
    """Return λ along a motion as a function of one coordinate, velocities eliminated by energy and momenta.

    The contact of f ≥ 0 ends at the first zero of the result. Beside the coordinate s only ignorable ones may be left
    in contact: their constant momenta give their velocities, and Jacobi's energy of Routh's function gives ṡ².

    Parameters
    ----------
    constrained, places, which
        As for :func:`multiplier_in_contact`.
    s
        The coordinate that the result is to depend on.
    start, speed
        Where and how fast the motion starts.
    domain
        Where the energy is meant.
    others
        The coordinates left in contact besides, and how fast each changes at the start.

    Raises
    ------
    ValueError
        Where Jacobi's energy is not conserved, one of the others is not ignorable, λ depends on the direction of
        motion or is no polynomial in the velocity, or there is no constraint of this number.

    Examples
    --------
    A particle slides off a sphere from rest at the top; it leaves at cos θ = 2/3:

    >>> from canon import Lagrangian, coordinates, parameters
    >>> from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    >>> r, theta = coordinates("r theta")
    >>> m, g, a = parameters("m g a", positive=True)
    >>> L = m*(r.dot**2 + r**2*theta.dot**2)/2 - m*g*r*sp.cos(theta)
    >>> sphere = ConstrainedLagrangian(Lagrangian(L, [r, theta]), holonomic=[r - a])
    >>> multiplier_along(sphere, {r: a}, theta, sp.S(0)).factor()
    g*m*(3*cos(theta) - 2)
    """
    (s,) = coordinate_symbols(s)
    turning = plain_places(others or {}, constrained.lagrangian.q, (s,), constrained.lagrangian.t)
    whole = embedded(constrained.lagrangian, places, [s, *turning])
    started = {s: sp.sympify(start, strict=True), velocity(s): sp.sympify(speed, strict=True)}
    started |= {velocity(x): rate for x, rate in turning.items()}
    reduction = routhian(whole, tuple(turning), domain=domain)
    momenta = (substitute(whole.L.diff(velocity(x)), started) for x in turning)
    conserved = dict(zip(reduction.momenta, momenta, strict=True))
    reduced = reduction.lagrangian
    _conserves_energy(reduced, domain)
    v, E = velocity(s), exchanged(reduced.jacobi_energy, conserved)
    at_rest = exchanged(E, {v: sp.S.Zero})
    quadratic = E.diff(v, 2) / 2
    if not is_quadratic_in(E, [v], domain):
        raise ValueError(
            f"the energy {E} is not quadratic in {v}, so {v}² does not follow from it alone; take multiplier_in_contact"
        )
    squared = (substitute(E, started) - at_rest) / quadratic
    rates = zip(turning, reduction.ignorable_velocities, strict=True)
    through = {velocity(x): exchanged(rate, conserved) for x, rate in rates}
    reaction = exchanged(multiplier_in_contact(constrained, places, (s, *turning), which), through)
    if reaction.has(*turning):
        raise ValueError(
            f"the multiplier {reaction} depends on {', '.join(map(str, turning))}; take multiplier_in_contact"
        )
    multiplier = sp.expand(reaction)
    if differ(multiplier - exchanged(multiplier, {v: -v}), domain):
        raise ValueError(
            f"the multiplier {multiplier} depends on the direction of motion; take multiplier_in_contact"
        )
    if not multiplier.is_polynomial(v):
        raise ValueError(
            f"the multiplier {multiplier} is no polynomial in {v}, so {v}² does not determine it; take "
            "multiplier_in_contact"
        )
    terms = sp.Poly(multiplier, v).terms()  # even in v, as was seen: odd ones vanish
    return sp.factor_terms(sp.Add(*(a * squared ** (k // 2) for (k,), a in terms if k % 2 == 0)))


def _conserves_energy(reduced: Lagrangian, domain: Domain | None) -> None:
    if any(Q != 0 for Q in reduced.forces) or differ(reduced.L.diff(reduced.t), domain):
        raise ValueError(
            "Jacobi's energy is not conserved: forces act, or L depends on time; integrate instead"
        )
