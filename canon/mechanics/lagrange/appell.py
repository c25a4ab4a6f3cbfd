"""The Gibbs–Appell equations ∂S/∂u̇ = U, with the acceleration energy S.

S = Σ ½ m r̈² + ½ α·I α + α·(ω × I ω), α the rate of ω along the body's axes, up to terms without accelerations. The
quasi-velocities u need not be the rates of any coordinates: q̇ = f(q, u, t). The generalized force of u is
U = −Σ ∂V/∂q ∂q̇/∂u plus what has no potential (J. W. Gibbs 1879, P. Appell 1899; L. A. Pars, Analytical Dynamics,
ch. XII).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import time, velocity
from canon.expression.symbols.user_input import given_expression
from canon.mechanics.algebra.linear import solve_affine
from canon.mechanics.algebra.substitution import entry
from canon.mechanics.lagrange.body import bodies_of
from canon.mechanics.lagrange.lagrangian import forces_in_order
from canon.mechanics.lagrange.quasi_velocity import Kinematics

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.mechanics.lagrange.body import Body

__all__ = ["GibbsAppell"]


@dataclass(frozen=True)
class GibbsAppell:
    """Gibbs–Appell function and equations of a system of bodies, in velocities or quasi-velocities.

    Parameters
    ----------
    bodies
        Particles and rigid bodies.
    q
        The coordinates.
    V
        The potential energy V(q, t), or V(q, q̇, t) as −e (A·ṙ − φ) of a charge.
    u, q_dot
        Quasi-velocities and q̇ as functions of q, u, t; the velocities themselves unless given.
    forces
        Generalized forces Q(q, q̇, t) without potential, one a coordinate; or by coordinate, ``{x: -c*x.dot}``.
    t
        The time.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.mechanics.lagrange.body import Particle
    >>> x, y = coordinates("x y")
    >>> m, g = parameters("m g", positive=True)
    >>> GibbsAppell([Particle(m, (x, y))], [x, y], m*g*y).equations
    (m*x_ddot, g*m + m*y_ddot)
    """

    bodies: tuple[Body, ...]
    kinematics: Kinematics
    V: Expr
    Q: tuple[Expr, ...]

    def __init__(
        self,
        bodies: Sequence[Body],
        q: Sequence[Symbol],
        V: Expr = sp.S.Zero,
        u: Sequence[Symbol] | None = None,
        q_dot: Sequence[Expr] | None = None,
        forces: Sequence[Expr] | Mapping[Symbol, Expr] | None = None,
        t: Symbol = time,
    ) -> None:
        object.__setattr__(self, "bodies", bodies_of(bodies))
        object.__setattr__(self, "kinematics", Kinematics(q, u, q_dot, t))
        object.__setattr__(self, "V", self.kinematics.plain(given_expression(V, "V")))
        given = forces_in_order(forces, self.q) or (sp.S.Zero,) * len(self.q)
        object.__setattr__(self, "Q", tuple(self.kinematics.plain(force) for force in given))

    def _repr_latex_(self) -> str:
        rows = [f"S &= {sp.latex(self.gibbs_function)}"]
        for a, U in zip(self.u_dot, self.forces, strict=True):
            rows.append(rf"\partial S/\partial {sp.latex(a)} &= {sp.latex(U)}")
        return "$\\displaystyle \\begin{aligned}" + r" \\ ".join(rows) + "\\end{aligned}$"

    @property
    def q(self) -> tuple[Symbol, ...]:
        """The coordinates."""
        return self.kinematics.q

    @property
    def u_dot(self) -> tuple[Symbol, ...]:
        """The rates of the quasi-velocities, named ``u_dot``; accelerations where u are velocities."""
        return self.kinematics.u_dot

    @cached_property
    def _motion(self) -> tuple[tuple[Expr, Expr, Expr], ...]:
        """What turns and moves: inertia, acceleration, and the gyroscopic part of the torque, a component each."""
        rate = self.kinematics.rate
        found: list[tuple[Expr, Expr, Expr]] = []
        for body in self.bodies:
            found += [(body.m * a, a, sp.S.Zero) for a in (rate(rate(place)) for place in body.r)]
            omega = sp.Matrix(body.angular_velocity(self.kinematics))
            alpha = omega.applyfunc(rate)
            torque = body.inertia * alpha
            spin = omega.cross(body.inertia * omega) if len(omega) == 3 else sp.zeros(len(omega), 1)
            found += zip(torque.flat(), alpha.flat(), spin.flat(), strict=True)
        return tuple(found)

    @cached_property
    def gibbs_function(self) -> Expr:
        """The acceleration energy S as a function of q, u, u̇, t, up to terms without accelerations."""
        return sp.Add(*(force * a / 2 + gyroscopic * a for force, a, gyroscopic in self._motion))

    @cached_property
    def slopes(self) -> tuple[Expr, ...]:
        """The slopes ∂S/∂u̇ = Σ m r̈·∂r̈/∂u̇ + Σ (I α + ω × I ω)·∂α/∂u̇, from shorter expressions than S."""
        return tuple(
            sp.Add(*((force + gyroscopic) * a.diff(b) for force, a, gyroscopic in self._motion))
            for b in self.u_dot
        )

    @cached_property
    def forces(self) -> tuple[Expr, ...]:
        """The generalized forces of the quasi-velocities, Σ (Q + d/dt ∂V/∂q̇ − ∂V/∂q) ∂q̇/∂u."""
        B, along, rate = self.kinematics.basis, self.kinematics.along, self.kinematics.rate
        moving = [rate(along(self.V.diff(velocity(s)))) for s in self.q]
        along_q = [
            along(Q) + a - along(self.V.diff(s)) for s, Q, a in zip(self.q, self.Q, moving, strict=True)
        ]
        return tuple(
            sp.Add(*(force * entry(B, i, j) for i, force in enumerate(along_q))) for j in range(B.cols)
        )

    @cached_property
    def equations(self) -> tuple[Expr, ...]:
        """The Gibbs–Appell equations, each = 0: ∂S/∂u̇ − U."""
        return tuple(slope - U for slope, U in zip(self.slopes, self.forces, strict=True))

    @cached_property
    def quasi_accelerations(self) -> tuple[Expr, ...]:
        """The rates u̇(q, u, t) that solve the equations.

        Raises
        ------
        SingularMatrixError
            Where S does not determine them.
        """
        return tuple(solve_affine(self.equations, self.u_dot, name="the matrix ∂²S/∂u̇²").values())


def cross(a: Sequence[Expr], b: Sequence[Expr]) -> tuple[Expr, Expr, Expr]:
    """Return a × b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
