"""Moving bodies: rigid bodies that move and turn in space, with any potential between them, as one Poisson system.

Each has its centre of mass r and momentum p, a canonical pair, and M and e as :mod:`rotating_body
<canon.mechanics.hamilton.rotating_body>` has them: H = Σ p²/2m + M₁²/2A + M₂²/2B + M₃²/2C + V(r, e). Chains of bodies
are joined by springs between points of theirs.

Source: R. van Zon, J. Schofield, Symplectic algorithms for simulations of rigid-body systems using the exact solution
of free motion, Phys. Rev. E 75 (2007) 056701, doi:10.1103/PhysRevE.75.056701.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.expression.symbols.user_input import all_of, given_expression
from canon.mechanics.algebra.substitution import entry, exchanged
from canon.mechanics.hamilton.poisson_system import PoissonSystem
from canon.mechanics.hamilton.rotating_body import attitude_matrix, rotating_body

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["MovingBody", "moving_bodies"]


@dataclass(frozen=True)
class MovingBody:
    """A rigid body that moves and turns, and the symbols of its state.

    Parameters
    ----------
    name
        Behind its symbols: r is (x_a, y_a, z_a) of a body "a".
    m
        Its mass.
    inertia
        The principal moments of inertia A, B, C about its centre of mass.

    Examples
    --------
    >>> rod = MovingBody("a", 1, [1, 1, 2])
    >>> rod.r, rod.M
    ((x_a, y_a, z_a), (M_1_a, M_2_a, M_3_a))
    >>> rod.place_of([0, 0, 1])[2]
    e_0_a**2 - e_1_a**2 - e_2_a**2 + e_3_a**2 + z_a
    """

    name: str
    m: Expr
    inertia: tuple[Expr, ...]

    def __init__(self, name: str, m: Expr, inertia: Sequence[Expr]) -> None:
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "m", given_expression(m, "m"))
        moments = all_of(inertia, 3, "inertia", "principal axes")
        object.__setattr__(
            self, "inertia", tuple(given_expression(I, "a moment of inertia") for I in moments)
        )

    def _symbols(self, *names: str) -> tuple[Symbol, ...]:
        return tuple(Symbol(f"{each}_{self.name}", real=True) for each in names)

    @property
    def r(self) -> tuple[Symbol, ...]:
        """The centre of mass, along fixed axes."""
        return self._symbols("x", "y", "z")

    @property
    def p(self) -> tuple[Symbol, ...]:
        """The momentum, along fixed axes."""
        return self._symbols("p_x", "p_y", "p_z")

    @property
    def M(self) -> tuple[Symbol, ...]:
        """The angular momentum about the centre of mass, along the body's axes."""
        return self._symbols("M_1", "M_2", "M_3")

    @property
    def e(self) -> tuple[Symbol, ...]:
        """Euler's parameters of the attitude."""
        return self._symbols("e_0", "e_1", "e_2", "e_3")

    @property
    def state(self) -> tuple[Symbol, ...]:
        """All of these, in the order of a state."""
        return (*self.r, *self.p, *self.M, *self.e)

    @property
    def angular_momentum(self) -> tuple[Expr, ...]:
        """The angular momentum about the origin, along fixed axes: r × p + R M."""
        (x, y, z), (a, b, c) = self.r, self.p
        orbital = y * c - z * b, z * a - x * c, x * b - y * a
        return tuple(own + part for own, part in zip(orbital, self._along_fixed_axes(self.M), strict=True))

    def place_of(self, point: Sequence[Expr]) -> tuple[Expr, ...]:
        """Return where a point of the body is, given by its place along the body's axes from the centre of mass."""
        turned = self._along_fixed_axes(all_of(point, 3, "point", "axes of the body"))
        return tuple(centre + part for centre, part in zip(self.r, turned, strict=True))

    def _along_fixed_axes(self, u: Sequence[Expr]) -> list[Expr]:
        R = attitude_matrix(self.e)
        return [sp.Add(*(entry(R, i, j) * u[j] for j in range(3))) for i in range(3)]


def moving_bodies(bodies: Sequence[MovingBody], V: Expr = sp.S.Zero) -> PoissonSystem:
    """Return the equations of bodies with a potential between them, for (r, p, M, e) of one after the other.

    Parameters
    ----------
    bodies
        The bodies, with different names.
    V
        The potential, a function of their r and e.

    Raises
    ------
    ValueError
        There are no bodies, or two of a name.

    Examples
    --------
    Two bodies joined end to end by a spring: what V moves keeps the momentum and the angular momentum of both together.

    >>> a, b = MovingBody("a", 1, [1, 1, 2]), MovingBody("b", 2, [1, 2, 2])
    >>> joint = zip(a.place_of([1, 0, 0]), b.place_of([-1, 0, 0]))
    >>> pair = moving_bodies([a, b], sum((x - y)**2 for x, y in joint))
    >>> len(pair.x), bool(pair.is_constant_of_motion(a.p[0] + b.p[0])), bool(pair.is_constant_of_motion(a.p[0]))
    (26, True, False)
    """
    if not bodies or len({body.name for body in bodies}) < len(bodies):
        raise ValueError(f"{len(bodies)} bodies: give one or more, each with a name of its own")
    terms, blocks = [given_expression(V, "V")], list[sp.Matrix]()
    pair = sp.Matrix(sp.BlockMatrix([[sp.zeros(3, 3), sp.eye(3)], [-sp.eye(3), sp.zeros(3, 3)]]))
    for body in bodies:
        turning = rotating_body(body.inertia)
        own = dict(zip(turning.x, (*body.M, *body.e), strict=True))
        terms += [exchanged(turning.H, own), *(p**2 / (2 * body.m) for p in body.p)]
        blocks += [pair, sp.Matrix(turning.structure.xreplace(own))]
    return PoissonSystem(sp.Add(*terms), [s for body in bodies for s in body.state], sp.diag(*blocks))
