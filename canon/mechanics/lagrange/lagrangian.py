"""Lagrange's equations of the second kind, d/dt ∂L/∂q̇ − ∂L/∂q = Q."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import acceleration, time, time_derivative, velocity
from canon.expression.symbols.user_input import counted
from canon.mechanics.algebra.dynamicsymbols import check_none_reads_as_the_time, coordinate_symbols, plain
from canon.mechanics.algebra.linear import SingularMatrixError, solve
from canon.mechanics.algebra.substitution import as_tuple, entry, exchanged
from canon.proof.domain.verdict import Undecided

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["Lagrangian", "forces_in_order"]


def forces_in_order(given: Any, q: Sequence[Symbol]) -> tuple[Any, ...]:
    """Return the generalized forces, in the order of the coordinates where they are given by coordinate.

    Raises
    ------
    ValueError
        Where one is given for what is no coordinate, or not as many as there are coordinates.

    Examples
    --------
    >>> from canon import coordinates
    >>> x, y = coordinates("x y")
    >>> forces_in_order({y: -2}, [x, y]), forces_in_order(None, [x, y])
    ((0, -2), ())
    """
    if given is None:
        return ()
    if not isinstance(given, Mapping):
        found = as_tuple(given)
        if found and len(found) != len(q):
            raise ValueError(
                f"{counted(len(found), 'generalized force')} for {counted(len(q), 'coordinate')}; give one each, "
                "0 where there is none"
            )
        return found
    forces: dict[Any, Any] = {coordinate_symbols([key])[0]: force for key, force in given.items()}
    if others := [str(key) for key in forces if key not in q]:
        raise ValueError(
            f"forces are given for {', '.join(others)}; the coordinates are {', '.join(map(str, q))}"
        )
    return tuple(forces.get(s, sp.S.Zero) for s in q)


@dataclass(frozen=True)
class Lagrangian:
    """A Lagrangian L(q, q̇, t) and the generalized forces that have no potential.

    Velocities are symbols of their own (``theta.dot``). SymPy's ``dynamicsymbols`` and plain symbols named
    ``theta_dot`` are accepted and rewritten at the door.

    Parameters
    ----------
    L
        The Lagrangian.
    q
        The generalized coordinates, independent of one another.
    forces
        The generalized forces Q(q, q̇, t), one a coordinate; or by coordinate, ``{x: -c*x.dot}``; or nothing.
    t
        The time.
    dissipation
        Rayleigh's dissipation function F(q, q̇, t), whose forces −∂F/∂q̇ are added to the given ones [1]_.

    Raises
    ------
    ValueError
        Where the forces do not match the coordinates, one of these is the symbol of the time (a coordinate that is
        called so, as ``coordinates("t")`` makes it, is another symbol), or L holds accelerations.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from sympy import cos
    >>> theta = coordinates("theta")
    >>> m, l, g = parameters("m l g", positive=True)
    >>> pendulum = Lagrangian(m*l**2*theta.dot**2/2 + m*g*l*cos(theta), [theta])
    >>> pendulum.equations
    (g*l*m*sin(theta) + l**2*m*theta_ddot,)
    >>> pendulum.accelerations
    (-g*sin(theta)/l,)
    >>> c = parameters("c", positive=True)
    >>> Lagrangian(pendulum.L, [theta], dissipation=c*theta.dot**2/2).equations
    (c*theta_dot + g*l*m*sin(theta) + l**2*m*theta_ddot,)

    References
    ----------
    .. [1] H. Goldstein, C. Poole, J. Safko, *Classical Mechanics*, 3rd ed., 2002, section 1.5.
    """

    L: Expr
    q: tuple[Symbol, ...]
    forces: tuple[Expr, ...] = ()
    t: Symbol = time

    def __init__(
        self,
        L: Expr,
        q: Sequence[Expr] | Expr,
        forces: Sequence[Expr] | Mapping[Symbol, Expr] | Expr | None = None,
        t: Symbol = time,
        *,
        dissipation: Expr | None = None,
    ) -> None:
        symbols = coordinate_symbols(q)
        if not symbols:
            raise ValueError("no coordinates given; a system moves in at least one")
        if len({*symbols}) < len(symbols):
            raise ValueError(f"the coordinates {symbols} are not all different; every one moves on its own")
        names = {s.name for s in symbols}
        if both := [s.name for s in symbols if names & {velocity(s).name, acceleration(s).name}]:
            raise ValueError(
                f"of the coordinates {symbols} one has the name of the velocity or acceleration of {', '.join(both)}, "
                "and nothing would tell them apart; call it otherwise"
            )
        check_none_reads_as_the_time(symbols, "Lagrangian(L, q", t)
        given = forces_in_order(forces, symbols)
        expressions = [plain(e, symbols, t) for e in (L, *given)]
        object.__setattr__(self, "L", expressions[0])
        object.__setattr__(self, "q", symbols)
        object.__setattr__(self, "t", t)
        object.__setattr__(self, "forces", tuple(expressions[1:]))
        found = [str(acceleration(s)) for s in symbols if self.L.has(acceleration(s))]
        if found:
            raise ValueError(
                f"L holds the accelerations {', '.join(found)}; a Lagrangian of canon depends on "
                "q, q̇ and t only"
            )
        if dissipation is not None:
            F = plain(dissipation, symbols, t)
            rest = self.forces or (sp.S.Zero,) * len(symbols)
            forces_of_all = tuple(Q - F.diff(velocity(s)) for Q, s in zip(rest, symbols, strict=True))
            object.__setattr__(self, "forces", forces_of_all)

    @cached_property
    def velocities(self) -> tuple[Symbol, ...]:
        """The symbols q̇."""
        return tuple(velocity(s) for s in self.q)

    @cached_property
    def momenta(self) -> tuple[Expr, ...]:
        """The generalized momenta p = ∂L/∂q̇ as functions of q, q̇, t."""
        return tuple(self.L.diff(v) for v in self.velocities)

    @cached_property
    def mass_matrix(self) -> sp.ImmutableDenseMatrix:
        """The velocity Hessian M = ∂²L/∂q̇², symmetric, of shape (n, n)."""
        n = len(self.q)
        upper = {(i, j): self.momenta[i].diff(self.velocities[j]) for i in range(n) for j in range(i, n)}
        return sp.ImmutableDenseMatrix([[upper[min(i, j), max(i, j)] for j in range(n)] for i in range(n)])

    @cached_property
    def bias(self) -> tuple[Expr, ...]:
        """The rest of Lagrange's equations: M q̈ + bias = 0, bias = Σ ∂p/∂q q̇ + ∂p/∂t − ∂L/∂q − Q."""
        still = {acceleration(s): sp.S.Zero for s in self.q}
        return tuple(
            exchanged(time_derivative(p, self.q, self.t), still) - self.L.diff(s) - Q
            for p, s, Q in zip(self.momenta, self.q, self._all_forces, strict=True)
        )

    @cached_property
    def equations(self) -> tuple[Expr, ...]:
        """Lagrange's equations, each expression = 0: d/dt ∂L/∂q̇ − ∂L/∂q − Q."""
        accelerations = [acceleration(s) for s in self.q]
        return tuple(
            sp.Add(*(entry(self.mass_matrix, i, j) * a for j, a in enumerate(accelerations)), self.bias[i])
            for i in range(len(self.q))
        )

    @cached_property
    def inertia(self) -> sp.ImmutableDenseMatrix:
        """What stands before the accelerations in the equations: M, less ∂Q/∂q̈ of forces such as that of added mass.

        Raises
        ------
        Undecided
            Where a force is not affine in the accelerations.
        """
        accelerations = [acceleration(s) for s in self.q]
        if not any(Q.has(*accelerations) for Q in self.forces):
            return self.mass_matrix
        slopes = sp.Matrix([[Q.diff(a) for a in accelerations] for Q in self.forces])
        if slopes.has(*accelerations):
            raise Undecided("a force is not affine in the accelerations, so they were not solved for")
        return sp.ImmutableDenseMatrix(self.mass_matrix - slopes)

    @cached_property
    def accelerations(self) -> tuple[Expr, ...]:
        """The accelerations q̈(q, q̇, t) that solve M q̈ = −bias, those that forces hold on the left.

        Raises
        ------
        SingularMatrixError
            Where M is singular: L does not determine the accelerations along the null direction.
        Undecided
            Where a force is not affine in the accelerations.
        """
        still = {acceleration(s): sp.S.Zero for s in self.q}
        rest = sp.Matrix([-exchanged(b, still) for b in self.bias])
        try:
            found = solve(self.inertia, rest, name="the mass matrix")
        except SingularMatrixError as singular:
            raise SingularMatrixError(
                f"{singular} in the velocities ({', '.join(map(str, self.velocities))}); L does not "
                "determine the accelerations along it. Use fewer coordinates, or treat them by constraints",
                singular.null_direction,
            ) from singular
        return tuple(entry(found, i, 0) for i in range(len(self.q)))

    @cached_property
    def jacobi_energy(self) -> Expr:
        """Jacobi's energy Σ q̇ ∂L/∂q̇ − L; on the motion its rate is −∂L/∂t + Σ Q q̇."""
        return sp.Add(*(v * p for v, p in zip(self.velocities, self.momenta, strict=True)), -self.L)

    @property
    def _all_forces(self) -> tuple[Expr, ...]:
        return self.forces or (sp.S.Zero,) * len(self.q)

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle L = {sp.latex(self.L)}$"
