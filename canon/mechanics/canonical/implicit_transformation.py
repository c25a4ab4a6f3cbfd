"""Implicit canonical maps, given by equations between old and new variables, such as an implicit integrator's step.

With E(z, Z, t) = 0, A = ∂E/∂z and B = ∂E/∂Z, the Jacobian is M = −B⁻¹A, and M J Mᵀ = c J says
A J Aᵀ = c B J Bᵀ where E = 0: nothing has to be inverted (E. Hairer, C. Lubich, G. Wanner, Geometric
Numerical Integration, VI.4).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import time
from canon.expression.symbols.user_input import counted, given_kind, given_symbols
from canon.mechanics.algebra.all_vanish import all_vanish, having_values
from canon.mechanics.algebra.dynamicsymbols import in_own_symbols
from canon.mechanics.algebra.linear import SingularMatrixError, is_regular, solve
from canon.mechanics.algebra.substitution import as_tuple, entry, exchanged, substitute
from canon.mechanics.canonical.canonicity_tests import given_valence
from canon.mechanics.hamilton.bracket import symplectic_unit
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Status, Undecided, Verdict, all_hold

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

__all__ = ["ImplicitTransformation"]


@dataclass(frozen=True)
class ImplicitTransformation:
    """A map (q, p) → (Q, P) that equations define near the identity.

    Parameters
    ----------
    q, p, new_q, new_p
        Symbols of the old and of the new variables.
    equations
        2n expressions in all of them, each = 0.
    domain
        Where the equations are meant; its box marks the step sizes for which the solution near the identity
        is meant.
    t
        The time.

    Raises
    ------
    ValueError
        Where there are not as many equations as variables, these are not all different, or an equation holds another
        symbol of the name of one.

    Examples
    --------
    The implicit midpoint rule is canonical for every potential:

    >>> from sympy import Function, symbols
    >>> q, p, Q, P, h = symbols("q p Q P h", real=True)
    >>> force = Function("f")((q + Q)/2)
    >>> midpoint = ImplicitTransformation((q,), (p,), (Q,), (P,), (Q - q - h*(p + P)/2, P - p - h*force))
    >>> midpoint.is_canonical().status.name
    'HOLDS'
    """

    q: tuple[Symbol, ...]
    p: tuple[Symbol, ...]
    new_q: tuple[Symbol, ...]
    new_p: tuple[Symbol, ...]
    equations: tuple[Expr, ...]
    domain: Domain = field(default_factory=Domain)
    t: Symbol = time

    def __post_init__(self) -> None:
        for name in ("q", "p", "new_q", "new_p"):
            object.__setattr__(self, name, given_symbols(getattr(self, name), name))
        object.__setattr__(self, "equations", as_tuple(self.equations))
        given_kind(self.domain, Domain, "the domain")
        variables = (*self.q, *self.p, *self.new_q, *self.new_p)
        object.__setattr__(self, "equations", in_own_symbols(self.equations, variables, self.t))
        n = len(self.q)
        if len(self.equations) != 2 * n:
            raise ValueError(
                f"{counted(len(self.equations), 'equation')} for a "
                f"map of {2 * n} variables; give as many as variables"
            )
        if len({*variables}) != 4 * n:
            raise ValueError("old and new variables need different symbols, as many of each")

    def _repr_latex_(self) -> str:
        rows = r" \\ ".join(f"0 &= {sp.latex(E)}" for E in self.equations)
        return rf"$\displaystyle \begin{{aligned}}{rows}\end{{aligned}}$"

    @cached_property
    def old_jacobian(self) -> sp.ImmutableDenseMatrix:
        """The matrix A = ∂E/∂(q, p)."""
        return sp.ImmutableDenseMatrix([[E.diff(z) for z in (*self.q, *self.p)] for E in self.equations])

    @cached_property
    def new_jacobian(self) -> sp.ImmutableDenseMatrix:
        """The matrix B = ∂E/∂(Q, P)."""
        return sp.ImmutableDenseMatrix(
            [[E.diff(z) for z in (*self.new_q, *self.new_p)] for E in self.equations]
        )

    def is_canonical(self, valence: Expr | int = 1, budget: float = 10.0) -> Verdict:
        """Tell whether A J Aᵀ = c B J Bᵀ wherever the equations hold, with B regular.

        Raises
        ------
        ValueError
            Where the valence is no constant other than 0.
        """
        J = symplectic_unit(len(self.q))
        A, B = self.old_jacobian, self.new_jacobian
        c = given_valence(valence, (*self.q, *self.p, *self.new_q, *self.new_p, self.t))
        difference = A * J * A.T - c * B * J * B.T
        size = 2 * len(self.q)
        entries = [
            (f"(A J Aᵀ − c B J Bᵀ)[{i + 1}, {j + 1}] = 0", entry(difference, i, j))
            for i in range(size)
            for j in range(i + 1, size)
        ]
        question = f"the implicit map is canonical{'' if c == 1 else f' with valence {c}'}"

        def verdicts() -> Iterator[Verdict]:
            yield is_regular(B, self.domain, "∂E/∂(Q, P)")
            plain = all_vanish(entries, question, self.domain, budget)
            if plain.holds:
                yield plain
                return
            explicit = self.on_solutions()
            if explicit is None:
                yield Verdict(
                    Status.UNDECIDED,
                    question,
                    residual=plain.residual,
                    feedback="the equations could not be solved for a set of variables that would decide it",
                )
                return
            yield all_vanish(
                ((part, substitute(f, explicit)) for part, f in entries), question, self.domain, budget
            )

        answers = {f"equation {i}": E for i, E in enumerate(self.equations, 1)}
        return having_values(all_hold(verdicts(), question), answers, (), self.domain)

    def evaluate(
        self, values: Mapping[Symbol, float], start: Mapping[Symbol, float], digits: int = 20
    ) -> dict[Symbol, float]:
        """Return numbers for 2n of the variables, by Newton's method from a first guess.

        Parameters
        ----------
        values
            Numbers for the other 2n variables, the time and the parameters.
        start
            A first guess for each variable that is wanted.
        digits
            Working precision.

        Examples
        --------
        >>> from sympy import sin, symbols
        >>> q, p, Q, P = symbols("q p Q P", real=True)
        >>> step = ImplicitTransformation((q,), (p,), (Q,), (P,), (Q - q - P/10, P - p + sin(Q)/10))
        >>> new = step.evaluate({q: 1, p: 0}, {Q: 1, P: 0})
        >>> abs(new[Q] - 1 - new[P]/10) < 1e-15, abs(new[P] + sin(new[Q])/10) < 1e-15
        (True, True)
        """
        unknowns = list(start)
        known = {s: sp.Float(value, digits) for s, value in values.items()}
        equations = [exchanged(E, known) for E in self.equations]
        root = sp.Matrix(sp.nsolve(equations, unknowns, [start[s] for s in unknowns], prec=digits))
        return {s: float(entry(root, i, 0)) for i, s in enumerate(unknowns)}

    def on_solutions(self) -> dict[Symbol, Expr] | None:
        """Return 2n of the variables as functions of the others on all solutions, or None.

        Sets of variables are tried in which the equations are linear together.
        """
        groups = (self.new_q, self.new_p, self.q, self.p)
        for i, j in ((0, 1), (2, 3), (1, 3), (0, 2), (0, 3), (1, 2)):
            unknowns = (*groups[i], *groups[j])
            matrix = sp.Matrix([[E.diff(x) for x in unknowns] for E in self.equations])
            if matrix.has(*unknowns):
                continue
            rest = [-exchanged(E, dict.fromkeys(unknowns, sp.S.Zero)) for E in self.equations]
            try:
                column = solve(matrix, sp.Matrix(rest), self.domain)
            except (SingularMatrixError, Undecided):
                continue
            return {x: entry(column, k, 0) for k, x in enumerate(unknowns)}
        return None
