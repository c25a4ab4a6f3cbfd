"""Poisson systems ẋ = Π(x) ∇H: brackets given by a matrix, with Casimir functions, as rotating bodies have them.

{f, g} = Σ ∂f/∂xᵢ Πᵢⱼ ∂g/∂xⱼ with Πᵢⱼ = {xᵢ, xⱼ}. It is a Poisson bracket where Π is antisymmetric and Jacobi's identity
holds, Σₗ (Πᵢₗ ∂ₗΠⱼₖ + Πⱼₗ ∂ₗΠₖᵢ + Πₖₗ ∂ₗΠᵢⱼ) = 0; where Π is linear it is a Lie–Poisson bracket.

Source: J. E. Marsden, T. S. Ratiu, Introduction to Mechanics and Symmetry (2nd ed., Springer 1999), ch. 10,
doi:10.1007/978-0-387-21792-5.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import time
from canon.expression.symbols.user_input import counted, given_expression, given_symbols
from canon.mechanics.algebra.all_vanish import all_vanish, having_values
from canon.mechanics.algebra.dynamicsymbols import check_none_is_the_time, in_own_symbols
from canon.mechanics.algebra.substitution import entry
from canon.proof.continuity.turns_of_angles import continuity_but_for_turns
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.domain.verdict import Verdict, all_hold

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["PoissonSystem"]


@dataclass(frozen=True)
class PoissonSystem:
    """The motion ẋ = Π(x) ∇H of variables whose brackets {xᵢ, xⱼ} = Πᵢⱼ(x) are given.

    Parameters
    ----------
    H
        The Hamiltonian, a function of x and t.
    x
        The variables.
    structure
        The matrix Π(x) of the brackets of the variables.
    t
        The time.

    Raises
    ------
    ValueError
        The matrix has another shape, or holds the time; a variable is the time; or another symbol has the name of one.

    Examples
    --------
    Euler's equations of a free body, with their Casimir function:

    >>> from sympy import symbols, Matrix
    >>> a, b, c, A, B, C = symbols("a b c A B C", positive=True)
    >>> brackets = Matrix([[0, -c, b], [c, 0, -a], [-b, a, 0]])
    >>> body = PoissonSystem(a**2 / (2 * A) + b**2 / (2 * B) + c**2 / (2 * C), [a, b, c], brackets)
    >>> body.vector_field[0]
    b*c/C - b*c/B
    >>> bool(body.is_poisson()), bool(body.is_casimir(a**2 + b**2 + c**2)), bool(body.is_casimir(a**2 + b**2))
    (True, True, False)
    """

    H: Expr
    x: tuple[Symbol, ...]
    structure: sp.ImmutableDenseMatrix
    t: Symbol = time

    def __init__(
        self,
        H: Expr,
        x: Sequence[Symbol],
        structure: sp.MatrixBase | Sequence[Sequence[Expr]],
        t: Symbol = time,
    ) -> None:
        object.__setattr__(self, "x", given_symbols(x, "x"))
        object.__setattr__(self, "structure", sp.ImmutableDenseMatrix(structure))
        object.__setattr__(self, "t", t)
        check_none_is_the_time(self.x, "PoissonSystem(H, x, structure", t)
        object.__setattr__(self, "H", self._in_own_symbols(H, "H"))
        size = len(self.x)
        if self.structure.shape != (size, size):
            rows, columns = self.structure.shape
            raise ValueError(
                f"a matrix of {rows} × {columns} brackets for {counted(size, 'variable')}: give all {{xᵢ, xⱼ}}"
            )
        brackets = in_own_symbols({*self.structure.flat()}, self.x, t)
        if any(t in f.free_symbols for f in brackets):
            raise ValueError(
                f"the brackets of the variables hold {t}: they are functions of the variables alone"
            )

    def _in_own_symbols(self, f: Any, name: str = "") -> Expr:
        return in_own_symbols([given_expression(f, name)], self.x, self.t)[0]

    @property
    def brackets(self) -> tuple[Expr, ...]:
        """The brackets {xᵢ, xⱼ}, row by row."""
        size = range(len(self.x))
        return tuple(entry(self.structure, i, j) for i in size for j in size)

    @cached_property
    def vector_field(self) -> tuple[Expr, ...]:
        """The right-hand side ẋ = Π ∇H."""
        return tuple(self._bracket(x, self.H) for x in self.x)

    def bracket(self, f: Expr, g: Expr) -> Expr:
        """Return {f, g} = Σ ∂f/∂xᵢ Πᵢⱼ ∂g/∂xⱼ."""
        return self._bracket(self._in_own_symbols(f), self._in_own_symbols(g))

    def _bracket(self, f: Expr, g: Expr) -> Expr:
        first, second = self._slopes(f), self._slopes(g)
        return sp.Add(
            *(a * entry(self.structure, i, j) * b for i, a in first.items() for j, b in second.items())
        )

    def _slopes(self, f: Expr) -> dict[int, Expr]:
        return {i: f.diff(x) for i, x in enumerate(self.x) if x in f.free_symbols}

    def rate(self, u: Expr) -> Expr:
        """Return du/dt = {u, H} + ∂u/∂t."""
        u = self._in_own_symbols(u)
        return self._bracket(u, self.H) + u.diff(self.t)

    def is_poisson(self, domain: Domain | None = None) -> Verdict:
        """Tell whether the bracket is one: antisymmetric, and Jacobi's identity holds for all functions.

        It holds for all functions where it does for the variables.

        Examples
        --------
        >>> from sympy import symbols
        >>> x, y, z = symbols("x y z", real=True)
        >>> PoissonSystem(x, [x, y, z], [[0, x, 1], [-x, 0, 0], [-1, 0, 0]]).is_poisson().status.name
        'FAILS'
        """
        return all_vanish(self._claims(), "this is a Poisson bracket", domain)

    def _claims(self) -> Iterator[tuple[str, Expr]]:
        x, P, size = self.x, self.structure, len(self.x)
        for i in range(size):
            for j in range(i, size):
                yield f"{{{x[i]}, {x[j]}}} = −{{{x[j]}, {x[i]}}}", entry(P, i, j) + entry(P, j, i)
        for i, j, k in combinations(range(size), 3):
            cyclic = ((i, j, k), (j, k, i), (k, i, j))
            nested = sp.Add(*(self._bracket(x[a], entry(P, b, c)) for a, b, c in cyclic))
            yield f"Jacobi's identity of {x[i]}, {x[j]}, {x[k]}", nested

    def is_casimir(self, C: Expr, domain: Domain | None = None) -> Verdict:
        """Tell whether {C, f} = 0 for all functions f, so that C is conserved whatever H is."""
        claims = [(f"{{C, {x}}} = 0", self.bracket(C, x)) for x in self.x]
        return self._without_jumps(C, all_vanish(claims, f"{C} is a Casimir function", domain), domain)

    def is_constant_of_motion(self, I: Expr, domain: Domain | None = None) -> Verdict:
        """Tell whether dI/dt = {I, H} + ∂I/∂t = 0 along every motion."""
        question = f"{I} is a constant of motion"
        return self._without_jumps(I, all_vanish([("dI/dt = 0", self.rate(I))], question, domain), domain)

    def _without_jumps(self, f: Expr, verdict: Verdict, domain: Domain | None) -> Verdict:
        """Return the verdict on a function that was tested by its slopes, once it is seen that it does not jump."""
        given, everywhere, function = (self.H, *self.brackets), as_domain(domain), self._in_own_symbols(f)
        verdict = having_values(verdict, {str(f): function}, given, domain)
        if not verdict.holds:
            return verdict
        moving = (*self.x, self.t)
        steady = continuity_but_for_turns(function, moving, everywhere, name=str(f), given=given)
        return all_hold([verdict, steady], verdict.question)

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle H = {sp.latex(self.H)},\\quad \\Pi = {sp.latex(self.structure)}$"
