"""The Gibbs–Appell equations ∂S/∂u̇ = U, with the acceleration energy S = ½ Σ m r̈² + ½ Σ I α².

The quasi-velocities u need not be the rates of any coordinates: q̇ = f(q, u, t). The generalized force of u is
U = −Σ ∂V/∂q ∂q̇/∂u plus what has no potential (P. Appell 1899; L. A. Pars, Analytical Dynamics, ch. XII).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbol import Rate, acceleration, time, velocity
from canon.mechanics.linear import solve
from canon.mechanics.substitution import as_tuple, entry, exchanged

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["GibbsAppell", "PlanarBody"]


@dataclass(frozen=True)
class PlanarBody:
    """A particle, or a rigid body in the plane.

    Parameters
    ----------
    m
        Mass.
    r
        Position of the centre of mass as a function of q and t.
    inertia, angle
        Central moment of inertia and the angle of rotation (function of q and t), for a body.
    """

    m: Expr
    r: tuple[Expr, ...]
    inertia: Expr = field(default=cast("Expr", sp.S.Zero))
    angle: Expr = field(default=cast("Expr", sp.S.Zero))


@dataclass(frozen=True)
class GibbsAppell:
    """A system in quasi-velocities.

    Parameters
    ----------
    bodies
        Particles and planar bodies.
    q
        The coordinates.
    V
        The potential energy V(q, t).
    u, q_dot
        Quasi-velocities and q̇ as functions of q, u, t; the velocities themselves unless given.
    t
        The time.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from sympy import cos, sin
    >>> (theta,) = coordinates("theta")
    >>> m, l, g = parameters("m l g", positive=True)
    >>> bob = PlanarBody(m, (l*sin(theta), -l*cos(theta)))
    >>> [equation.expand() for equation in GibbsAppell([bob], [theta], -m*g*l*cos(theta)).equations]
    [g*l*m*sin(theta) + l**2*m*theta_ddot*sin(theta)**2 + l**2*m*theta_ddot*cos(theta)**2]
    """

    bodies: tuple[PlanarBody, ...]
    q: tuple[Symbol, ...]
    V: Expr
    u: tuple[Symbol, ...]
    q_dot: tuple[Expr, ...]
    t: Symbol = time

    def __init__(
        self,
        bodies: Sequence[PlanarBody],
        q: Sequence[Symbol],
        V: Expr = sp.S.Zero,
        u: Sequence[Symbol] | None = None,
        q_dot: Sequence[Expr] | None = None,
        t: Symbol = time,
    ) -> None:
        natural = tuple(velocity(s) for s in q)
        object.__setattr__(self, "bodies", tuple(bodies))
        object.__setattr__(self, "q", tuple(q))
        object.__setattr__(self, "V", sp.sympify(V))
        object.__setattr__(self, "u", natural if u is None else tuple(u))
        object.__setattr__(self, "q_dot", self.u if q_dot is None else as_tuple(q_dot))
        object.__setattr__(self, "t", t)
        if len(self.q_dot) != len(self.q):
            raise ValueError(
                f"{len(self.q_dot)} rates for {len(self.q)} coordinates; give q̇ of each as a function of u"
            )

    @cached_property
    def u_dot(self) -> tuple[Symbol, ...]:
        """The rates of the quasi-velocities, named ``u_dot``; accelerations where u are velocities."""
        named = {velocity(s): acceleration(s) for s in self.q}
        return tuple(named.get(u, velocity(u)) if isinstance(u, Rate) else velocity(u) for u in self.u)

    @cached_property
    def gibbs_function(self) -> Expr:
        """The acceleration energy S = ½ Σ m r̈² + ½ Σ I α² as a function of q, u, u̇, t."""
        terms = [b.m * self.rate(self.rate(x)) ** 2 / 2 for b in self.bodies for x in b.r]
        terms += [b.inertia * self.rate(self.rate(b.angle)) ** 2 / 2 for b in self.bodies if b.inertia != 0]
        return sp.Add(*terms)

    @cached_property
    def forces(self) -> tuple[Expr, ...]:
        """The generalized forces of the quasi-velocities, −Σ ∂V/∂q ∂q̇/∂u."""
        return tuple(
            sp.Add(*(-self.V.diff(s) * rate.diff(u) for s, rate in zip(self.q, self.q_dot, strict=True)))
            for u in self.u
        )

    @cached_property
    def equations(self) -> tuple[Expr, ...]:
        """The Gibbs–Appell equations, each = 0: ∂S/∂u̇ − U."""
        return tuple(self.gibbs_function.diff(a) - U for a, U in zip(self.u_dot, self.forces, strict=True))

    @cached_property
    def quasi_accelerations(self) -> tuple[Expr, ...]:
        """The rates u̇(q, u, t) that solve the equations."""
        matrix = sp.Matrix([[e.diff(a) for a in self.u_dot] for e in self.equations])
        still = dict.fromkeys(self.u_dot, sp.S.Zero)
        right = sp.Matrix([-exchanged(e, still) for e in self.equations])
        column = solve(matrix, right, name="the matrix ∂²S/∂u̇²")
        return tuple(entry(column, i, 0) for i in range(len(self.u)))

    def rate(self, f: Expr) -> Expr:
        """Return df/dt of f(q, u, t) along any motion."""
        return sp.Add(
            f.diff(self.t),
            *(f.diff(s) * v for s, v in zip(self.q, self.q_dot, strict=True)),
            *(f.diff(u) * a for u, a in zip(self.u, self.u_dot, strict=True)),
        )
