"""Constraints and their multipliers: d/dt ∂L/∂q̇ − ∂L/∂q = Q + Σ λₐ aₐ.

For f(q, t) = 0 the direction is a = ∂f/∂q, for g(q, q̇, t) = 0 affine in the velocities it is a = ∂g/∂q̇: the
reactions of ideal constraints do no work in virtual displacements (d'Alembert, not vakonomic). With the
constraints differentiated to A q̈ + b = 0, the multipliers follow from (A M⁻¹ Aᵀ) λ = A M⁻¹ bias − b.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import acceleration, time_derivative, velocity
from canon.expression.symbols.user_input import counted, given_kind
from canon.mechanics.algebra.dynamicsymbols import coordinate_symbols, plain
from canon.mechanics.algebra.linear import SingularMatrixError, solve
from canon.mechanics.algebra.substitution import as_tuple, entry, exchanged
from canon.mechanics.lagrange.dependence import check_independent
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.proof.trees.affine_form import is_affine

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["ConstrainedLagrangian"]


@dataclass(frozen=True)
class ConstrainedLagrangian:
    """A Lagrangian with ideal constraints.

    Parameters
    ----------
    lagrangian
        L and the given forces, in coordinates that need not be independent.
    holonomic
        Expressions f(q, t), each = 0.
    nonholonomic
        Expressions g(q, q̇, t), each = 0 and affine in the velocities.

    Raises
    ------
    ValueError
        Where a holonomic constraint holds velocities, or another is not affine in them.

    Examples
    --------
    A pendulum in Cartesian coordinates, y downwards:

    >>> from canon import Lagrangian, coordinates, parameters
    >>> x, y = coordinates("x y")
    >>> m, l, g = parameters("m l g", positive=True)
    >>> L = Lagrangian(m*(x.dot**2 + y.dot**2)/2 + m*g*y, [x, y])
    >>> pendulum = ConstrainedLagrangian(L, holonomic=[x**2 + y**2 - l**2])
    >>> pendulum.multipliers[0].factor()
    -m*(g*y + x_dot**2 + y_dot**2)/(2*(x**2 + y**2))
    """

    lagrangian: Lagrangian
    holonomic: tuple[Expr, ...]
    nonholonomic: tuple[Expr, ...]

    def __init__(
        self,
        lagrangian: Lagrangian,
        holonomic: Sequence[Expr] = (),
        nonholonomic: Sequence[Expr] = (),
    ) -> None:
        given_kind(lagrangian, Lagrangian, "the system")
        object.__setattr__(self, "lagrangian", lagrangian)
        for name, given in (("holonomic", holonomic), ("nonholonomic", nonholonomic)):
            constraints = tuple(plain(f, lagrangian.q, lagrangian.t) for f in as_tuple(given))
            object.__setattr__(self, name, constraints)
        v = [velocity(s) for s in lagrangian.q]
        for f in (*self.holonomic, *self.nonholonomic):
            if f.is_number:
                said = "is true anyway" if f == 0 else "is never true"
                raise ValueError(
                    f"the constraint {f} = 0 {said}; give a function of {lagrangian.q} that vanishes"
                )
        for f in self.holonomic:
            if f.has(*v):
                raise ValueError(f"{f} = 0 holds velocities; give it as a nonholonomic constraint")
        for g in self.nonholonomic:
            if not is_affine(g, v):
                raise ValueError(
                    f"{g} = 0 is not affine in the velocities, so d'Alembert's principle does not cover it"
                )

    def _repr_latex_(self) -> str:
        kept = [f"0 &= {sp.latex(f)}" for f in (*self.holonomic, *self.nonholonomic)]
        rows = r" \\ ".join([f"L &= {sp.latex(self.lagrangian.L)}", *kept])
        return rf"$\displaystyle \begin{{aligned}}{rows}\end{{aligned}}$"

    @cached_property
    def directions(self) -> sp.ImmutableDenseMatrix:
        """The matrix A of shape (constraints, n): rows ∂f/∂q and ∂g/∂q̇."""
        q = self.lagrangian.q
        rows = [[f.diff(s) for s in q] for f in self.holonomic]
        rows += [[g.diff(velocity(s)) for s in q] for g in self.nonholonomic]
        return sp.ImmutableDenseMatrix(len(rows), len(q), [slope for row in rows for slope in row])

    @cached_property
    def differentiated(self) -> tuple[Expr, ...]:
        """The constraints as equations in the accelerations, each = 0: d²f/dt² and dg/dt."""
        q, t = self.lagrangian.q, self.lagrangian.t
        twice = [time_derivative(time_derivative(f, q, t), q, t) for f in self.holonomic]
        return (*twice, *(time_derivative(g, q, t) for g in self.nonholonomic))

    @cached_property
    def rests(self) -> tuple[Expr, ...]:
        """What the rates A q̇ + a₀ hold beside the velocities: a₀ = ∂f/∂t, or g at q̇ = 0."""
        at_rest = {velocity(s): sp.S.Zero for s in self.lagrangian.q}
        t = self.lagrangian.t
        return (*(f.diff(t) for f in self.holonomic), *(exchanged(g, at_rest) for g in self.nonholonomic))

    @cached_property
    def manifold(self) -> tuple[Expr, ...]:
        """What vanishes in every allowed position and velocity: f, df/dt and g."""
        q, t = self.lagrangian.q, self.lagrangian.t
        return (*self.holonomic, *(time_derivative(f, q, t) for f in self.holonomic), *self.nonholonomic)

    @property
    def rates(self) -> tuple[Expr, ...]:
        """The constraints on the velocities, each A q̇ + a₀ = 0."""
        v = sp.Matrix(self.lagrangian.velocities)
        return tuple(
            entry(row * v, 0, 0) + a0
            for row, a0 in zip(
                (self.directions.row(a) for a in range(len(self.rests))), self.rests, strict=True
            )
        )

    @property
    def degrees_of_freedom(self) -> int:
        """Coordinates less constraints: the number of velocities that stay free at a position.

        Nonholonomic constraints restrict the velocities and not the positions that can be reached.
        """
        self._check_independent()
        return len(self.lagrangian.q) - self.directions.rows

    @cached_property
    def multipliers(self) -> tuple[Expr, ...]:
        """The multipliers λ(q, q̇, t) on the motion.

        Raises
        ------
        DependentConstraintsError
            Where constraints depend on one another; it names them.
        SingularMatrixError
            Where L does not determine the motion that the constraints leave free.
        """
        return self._solved[1]

    @cached_property
    def accelerations(self) -> tuple[Expr, ...]:
        """The accelerations q̈(q, q̇, t) on the motion."""
        return self._solved[0]

    @cached_property
    def reactions(self) -> tuple[Expr, ...]:
        """The generalized forces of constraint Σ λₐ aₐ, one a coordinate."""
        return self.reactions_of(self.multipliers)

    def reactions_of(self, multipliers: Sequence[Expr]) -> tuple[Expr, ...]:
        """Return Σ λₐ aₐ with these multipliers, holonomic constraints first."""
        A = self.directions
        return tuple(
            sp.Add(*(entry(A, a, i) * factor for a, factor in enumerate(multipliers))) for i in range(A.cols)
        )

    def equations_of_motion(self, multipliers: Sequence[Symbol]) -> tuple[Expr, ...]:
        """Return Lagrange's equations with these multipliers, then the constraints differentiated, each = 0.

        They are linear in the accelerations and the multipliers, and determine them.
        """
        return (*self.equations(multipliers)[: len(self.lagrangian.q)], *self.differentiated)

    def equations(self, multipliers: Sequence[Symbol]) -> tuple[Expr, ...]:
        """Return Lagrange's equations with these symbols as multipliers, then the constraints, each = 0."""
        A, multipliers = self.directions, coordinate_symbols(multipliers)
        if len(multipliers) != A.rows:
            raise ValueError(
                f"{counted(len(multipliers), 'multiplier')} for "
                f"{counted(A.rows, 'constraint')}; each needs one"
            )
        with_reactions = (
            sp.Add(equation, *(-entry(A, a, i) * factor for a, factor in enumerate(multipliers)))
            for i, equation in enumerate(self.lagrangian.equations)
        )
        return (*with_reactions, *self.holonomic, *self.nonholonomic)

    @cached_property
    def _solved(self) -> tuple[tuple[Expr, ...], tuple[Expr, ...]]:
        """The accelerations and multipliers from ((M, −Aᵀ), (A, 0)) (q̈, λ) = (−bias, −b)."""
        self._check_independent()
        L, A = self.lagrangian, self.directions
        still = {acceleration(s): sp.S.Zero for s in L.q}
        n, k = len(L.q), A.rows
        upper = sp.Matrix(L.inertia).row_join(-A.T)
        lower = sp.Matrix(A).row_join(sp.zeros(k, k))
        right = sp.Matrix([-exchanged(e, still) for e in (*L.bias, *self.differentiated)])
        try:
            column = solve(upper.col_join(lower), right, name="the matrix of masses and constraints")
        except SingularMatrixError as singular:
            raise SingularMatrixError(
                f"{singular}; L does not determine the motion that the constraints leave free. Use fewer "
                "coordinates",
                singular.null_direction,
            ) from singular
        values = [entry(column, i, 0) for i in range(n + k)]
        return tuple(values[:n]), tuple(values[n:])

    def _check_independent(self) -> None:
        L, constraints = self.lagrangian, (*self.holonomic, *self.nonholonomic)
        moving = (*L.q, L.t)
        check_independent(self.directions, constraints, self.rests, len(self.holonomic), moving)
