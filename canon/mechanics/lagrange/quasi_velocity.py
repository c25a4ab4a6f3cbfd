"""Quasi-velocities: q̇ as a function of as many u as there are degrees of freedom.

Chosen so that the constraints hold for every u, they take the reactions out of the equations: multiplied by ∂q̇/∂u
and summed, Lagrange's equations hold no multiplier (G. A. Maggi 1896; Ju. I. Neimark & N. A. Fufaev, Dynamics of
Nonholonomic Systems, ch. III).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import Rate, acceleration, time, velocity
from canon.expression.symbols.user_input import counted, given_expression
from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.dynamicsymbols import (
    check_none_reads_as_the_time,
    coordinate,
    coordinate_symbols,
    needs_plain,
    plain,
)
from canon.mechanics.algebra.linear import eliminate, solve, solve_affine
from canon.mechanics.algebra.substitution import as_tuple, entry, exchanged, substitute

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    from canon.mechanics.lagrange.lagrangian import Lagrangian
    from canon.proof.domain.domain import Domain
    from canon.proof.domain.verdict import Verdict

__all__ = ["Kinematics", "independent_velocities", "maggi_accelerations", "maggi_equations"]


@dataclass(frozen=True)
class Kinematics:
    """Velocities q̇ = f(q, u, t) in terms of quasi-velocities.

    Parameters
    ----------
    q
        The coordinates.
    u
        The quasi-velocities; velocities of coordinates may be among them.
    q_dot
        q̇ of each coordinate as a function of q, u, t.
    t
        The time.

    Raises
    ------
    ValueError
        Where coordinates or quasi-velocities repeat, or q̇ is not of each, by q, u and t alone.

    Examples
    --------
    A blade that moves forwards with u and turns with w:

    >>> from canon import coordinates
    >>> from sympy import cos, sin, symbols
    >>> x, y, theta = coordinates("x y theta")
    >>> u, w = symbols("u w", real=True)
    >>> blade = Kinematics([x, y, theta], [u, w], [u*cos(theta), u*sin(theta), w])
    >>> blade.q_ddot[0]
    -u*w*sin(theta) + u_dot*cos(theta)
    """

    q: tuple[Symbol, ...]
    u: tuple[Symbol, ...]
    q_dot: tuple[Expr, ...]
    t: Symbol = time

    def __init__(
        self,
        q: Sequence[Symbol],
        u: Sequence[Symbol] | None = None,
        q_dot: Sequence[Expr] | None = None,
        t: Symbol = time,
    ) -> None:
        object.__setattr__(self, "q", tuple(coordinate(s) for s in q))
        natural = tuple(velocity(s) for s in self.q)
        object.__setattr__(self, "u", natural if u is None else tuple(coordinate(w) for w in u))
        check_none_reads_as_the_time((*self.q, *self.u), "Kinematics(q, u, q_dot", t)
        object.__setattr__(self, "t", t)
        for what, symbols in (("coordinates", self.q), ("quasi-velocities", self.u)):
            if len({*symbols}) < len(symbols):
                raise ValueError(f"the {what} {symbols} are not all different; name each once")
        rates = self.u if q_dot is None else tuple(self.plain(f) for f in as_tuple(q_dot))
        object.__setattr__(self, "q_dot", rates)
        if len(self.q_dot) != len(self.q):
            raise ValueError(
                f"{counted(len(self.q_dot), 'rate')} for {counted(len(self.q), 'coordinate')}; "
                "give q̇ of each as a function of u"
            )
        foreign = {*natural} - {*self.u}
        for s, f in zip(self.q, self.q_dot, strict=True):
            if held := sorted(map(str, foreign & f.free_symbols)):
                raise ValueError(
                    f"the rate {f} of {s} holds {', '.join(held)}, which is no quasi-velocity; give q̇ of each by "
                    f"{', '.join(map(str, self.u))} alone"
                )

    @cached_property
    def u_dot(self) -> tuple[Symbol, ...]:
        """The rates of the quasi-velocities, named ``u_dot``; accelerations where u are velocities."""
        named = {velocity(s): acceleration(s) for s in self.q}
        return tuple(named.get(u, velocity(u)) if isinstance(u, Rate) else velocity(u) for u in self.u)

    @cached_property
    def q_ddot(self) -> tuple[Expr, ...]:
        """The accelerations as functions of q, u, u̇, t."""
        return tuple(self.rate(f) for f in self.q_dot)

    @cached_property
    def basis(self) -> sp.ImmutableDenseMatrix:
        """The matrix B = ∂q̇/∂u of shape (n, quasi-velocities)."""
        return sp.ImmutableDenseMatrix([[f.diff(w) for w in self.u] for f in self.q_dot])

    def rate(self, f: Expr) -> Expr:
        """Return df/dt of f(q, u, t) along any motion."""
        f = self.plain(f)
        return sp.Add(
            f.diff(self.t),
            *(f.diff(s) * v for s, v in zip(self.q, self.q_dot, strict=True)),
            *(f.diff(u) * a for u, a in zip(self.u, self.u_dot, strict=True)),
        )

    def plain(self, f: Expr) -> Expr:
        """Return f with symbols in place of SymPy's dynamicsymbols of q and u."""
        if not (f.has(AppliedUndef) or needs_plain(f.free_symbols, self._named)):
            return f
        others = [w for w in self.u if not isinstance(w, Rate)]
        return plain(f, (*self.q, *others), self.t)

    @cached_property
    def _named(self) -> Mapping[str, Symbol]:
        return {s.name: s for s in (*self.q, *self.u, self.t)}

    def along(self, f: Any) -> Expr:
        """Return f(q, q̇, q̈, t) as a function of q, u, u̇, t."""
        return substitute(self.plain(given_expression(f)), self.through)

    @cached_property
    def through(self) -> Mapping[Symbol, Expr]:
        """What each q̇ and q̈ is in terms of q, u, u̇, t."""
        rates: dict[Symbol, Expr] = {velocity(s): v for s, v in zip(self.q, self.q_dot, strict=True)}
        return rates | {acceleration(s): a for s, a in zip(self.q, self.q_ddot, strict=True)}

    def satisfy(self, constrained: ConstrainedLagrangian, domain: Domain | None = None) -> Verdict:
        """Tell whether every q̇(q, u, t) satisfies the constraints on the velocities, whatever u.

        Raises
        ------
        ValueError
            Where they bind other coordinates.
        """
        _check_same_coordinates(constrained.lagrangian, self)
        claims = [(f"{rate} = 0", self.along(rate)) for rate in constrained.rates]
        return all_vanish(claims, "the quasi-velocities satisfy the constraints", domain)


def independent_velocities(
    constrained: ConstrainedLagrangian, free: Sequence[Symbol] | None = None
) -> Kinematics:
    """Return kinematics whose quasi-velocities are velocities that the constraints leave free.

    Parameters
    ----------
    constrained
        The system.
    free
        The coordinates whose velocities to keep; chosen by elimination unless given.

    Raises
    ------
    ValueError
        Where the constraints do not determine the other velocities by these.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
    >>> x, y, z = coordinates("x y z")
    >>> L = Lagrangian((x.dot**2 + y.dot**2 + z.dot**2)/2, [x, y, z])
    >>> independent_velocities(ConstrainedLagrangian(L, nonholonomic=[z.dot - y*x.dot]), [x, y]).q_dot
    (x_dot, y_dot, x_dot*y)
    """
    q = constrained.lagrangian.q
    if free is None:
        pivots = eliminate(constrained.directions).pivots
        free = [s for j, s in enumerate(q) if j not in pivots]
    free = coordinate_symbols(free)
    dependent = [j for j, s in enumerate(q) if s not in free]
    A = constrained.directions
    if len(dependent) != A.rows:
        raise ValueError(
            f"{A.rows} constraints leave {len(q) - A.rows} of {len(q)} velocities free, not {len(free)}; name as many"
        )
    kept = {velocity(s): velocity(s) for s in free}
    still = dict.fromkeys((velocity(q[j]) for j in dependent), sp.S.Zero)
    right = [-exchanged(rate, still) for rate in constrained.rates]
    matrix = sp.Matrix([[entry(A, a, j) for j in dependent] for a in range(A.rows)])
    found = solve(matrix, sp.Matrix(right), name="the matrix of the dependent velocities")
    rates = {velocity(q[j]): sp.cancel(entry(found, a, 0)) for a, j in enumerate(dependent)}
    return Kinematics(q, list(kept), [{**kept, **rates}[velocity(s)] for s in q], constrained.lagrangian.t)


def _check_same_coordinates(lagrangian: Lagrangian, kinematics: Kinematics) -> None:
    if {*lagrangian.q} != {*kinematics.q}:
        raise ValueError(
            f"the Lagrangian is of the coordinates {lagrangian.q}, the kinematics of {kinematics.q}; write both in "
            "the same"
        )


def maggi_equations(lagrangian: Lagrangian, kinematics: Kinematics) -> tuple[Expr, ...]:
    """Return Maggi's equations, each expression = 0: Σ (d/dt ∂L/∂q̇ − ∂L/∂q − Q) ∂q̇/∂u.

    They hold no reaction of constraints that the kinematics satisfies.

    Raises
    ------
    ValueError
        Where the kinematics is of other coordinates; their order may differ.
    """
    _check_same_coordinates(lagrangian, kinematics)
    equations = dict(zip(lagrangian.q, lagrangian.equations, strict=True))
    lagrange = [kinematics.along(equations[s]) for s in kinematics.q]
    B = kinematics.basis
    return tuple(
        sp.Add(*(e * entry(B, i, j) for i, e in enumerate(lagrange))) for j in range(len(kinematics.u))
    )


def maggi_accelerations(lagrangian: Lagrangian, kinematics: Kinematics) -> tuple[Expr, ...]:
    """Return u̇(q, u, t) from Maggi's equations.

    Raises
    ------
    SingularMatrixError
        Where L does not determine them.
    ValueError
        Where the kinematics is of other coordinates.
    """
    equations = maggi_equations(lagrangian, kinematics)
    return tuple(
        solve_affine(equations, kinematics.u_dot, name="the matrix Bᵀ M B of Maggi's equations").values()
    )
