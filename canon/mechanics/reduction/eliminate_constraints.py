"""Elimination of constraints: fewer coordinates, which satisfy them whatever their values."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.symbol import acceleration, time_derivative, velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.dynamicsymbols import coordinate_symbols, plain_places
from canon.mechanics.algebra.linear import eliminate, solve
from canon.mechanics.algebra.substitution import entry, exchanged, substitute
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.trees.affine_form import is_affine

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    from canon.proof.domain.domain import Domain
    from canon.proof.domain.verdict import Verdict

__all__ = ["eliminated", "embedded", "satisfies"]


def embedded(lagrangian: Lagrangian, places: Mapping[Symbol, Expr], q: Sequence[Symbol]) -> Lagrangian:
    """Return L in fewer coordinates, its forces pulled back: Q′ = Σ Q ∂(old)/∂(new).

    Parameters
    ----------
    lagrangian
        L in coordinates bound by holonomic constraints.
    places
        Each old coordinate as a function of the new ones and t; one that keeps its name may be left out.
    q
        The new coordinates, independent of one another.

    Raises
    ------
    ValueError
        Where a coordinate has no place, or the places leave a new coordinate without effect.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates, parameters
    >>> x, y = coordinates("x y")
    >>> m, M, l, g = parameters("m M l g", positive=True)
    >>> free = Lagrangian((m*x.dot**2 + M*y.dot**2)/2 + m*g*x + M*g*y, [x, y])
    >>> embedded(free, {y: l - x}, [x]).accelerations[0].factor()
    g*(-M + m)/(M + m)
    """
    q = coordinate_symbols(q)
    whole = _whole(lagrangian, places, q)
    jacobian = sp.Matrix([[whole[s].diff(x) for x in q] for s in lagrangian.q])
    flat = eliminate(jacobian).null_direction
    if flat is not None:
        raise ValueError(
            f"the positions do not change along ({', '.join(map(str, flat))}) in the new coordinates "
            f"({', '.join(map(str, q))}); leave out the redundant one"
        )
    through = _through(lagrangian, whole, q)
    L = substitute(lagrangian.L, through)
    forces = [substitute(Q, through) for Q in lagrangian.forces]
    pulled = [sp.Add(*(Q * entry(jacobian, i, j) for i, Q in enumerate(forces))) for j in range(len(q))]
    return Lagrangian(L, q, pulled if forces else None, lagrangian.t)


def satisfies(
    constrained: ConstrainedLagrangian,
    places: Mapping[Symbol, Expr],
    q: Sequence[Symbol],
    domain: Domain | None = None,
) -> Verdict:
    """Tell whether positions given by fewer coordinates satisfy every constraint, whatever their values."""
    q = coordinate_symbols(q)
    whole = _whole(constrained.lagrangian, places, q)
    through = _through(constrained.lagrangian, whole, q)
    constraints = (*constrained.holonomic, *constrained.nonholonomic)
    claims = [(f"{f} = 0", substitute(f, through)) for f in constraints]
    return all_vanish(claims, "the new coordinates satisfy the constraints", domain)


def eliminated(
    constrained: ConstrainedLagrangian, dependent: Sequence[Symbol]
) -> tuple[Lagrangian, dict[Symbol, Expr]]:
    """Return L without dependent coordinates, and what these are, where the constraints are affine in them.

    Parameters
    ----------
    constrained
        A system with holonomic constraints only.
    dependent
        As many coordinates as constraints.

    Raises
    ------
    ValueError
        Where that cannot be done; give the positions to :func:`embedded` then.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates, parameters
    >>> from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    >>> s, theta = coordinates("s theta")
    >>> m, I, R = parameters("m I R", positive=True)
    >>> L = Lagrangian(m*s.dot**2/2 + I*theta.dot**2/2, [s, theta])
    >>> eliminated(ConstrainedLagrangian(L, holonomic=[R*theta - s]), [theta])[1]
    {theta: s/R}
    """
    if constrained.nonholonomic:
        raise ValueError(
            "velocities are constrained besides; a nonholonomic constraint takes no coordinate away. Use "
            "quasi-velocities, or the integral of the constraint where frobenius.integrals finds it"
        )
    dependent = coordinate_symbols(dependent)
    if len(dependent) != len(constrained.holonomic):
        raise ValueError(
            f"{counted(len(constrained.holonomic), 'constraint')} cannot determine "
            f"{counted(len(dependent), 'coordinate')}; name as many as there are constraints"
        )
    matrix = sp.Matrix([[f.diff(s) for s in dependent] for f in constrained.holonomic])
    if not all(is_affine(f, dependent) for f in constrained.holonomic):
        raise ValueError(
            f"the constraints are not affine in {', '.join(map(str, dependent))}; choose other coordinates, "
            "or give the positions in new coordinates to embedded()"
        )
    at_zero = dict.fromkeys(dependent, sp.S.Zero)
    right = sp.Matrix([-exchanged(f, at_zero) for f in constrained.holonomic])
    found = solve(matrix, right, name="the matrix of the dependent coordinates")
    places = {s: sp.cancel(entry(found, i, 0)) for i, s in enumerate(dependent)}
    rest = [s for s in constrained.lagrangian.q if s not in dependent]
    return embedded(constrained.lagrangian, places, rest), places


def _whole(lagrangian: Lagrangian, places: Mapping[Symbol, Expr], q: Sequence[Symbol]) -> dict[Symbol, Expr]:
    given = plain_places(places, lagrangian.q, q, lagrangian.t)
    missing = [s for s in lagrangian.q if s not in given and s not in q]
    if missing:
        raise ValueError(
            f"no place is given for {', '.join(map(str, missing))}; say what it is in the new coordinates"
        )
    return {s: given.get(s, s) for s in lagrangian.q}


def _through(lagrangian: Lagrangian, whole: Mapping[Symbol, Expr], q: Sequence[Symbol]) -> dict[Symbol, Expr]:
    """Return what each old coordinate, velocity and acceleration is."""
    t = lagrangian.t
    rates = {s: time_derivative(place, q, t) for s, place in whole.items()}
    return {
        **whole,
        **{velocity(s): rate for s, rate in rates.items()},
        **{acceleration(s): time_derivative(rate, q, t) for s, rate in rates.items()},
    }
