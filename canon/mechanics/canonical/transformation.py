"""Canonical transformations (q, p) → (Q, P) and the tests that recognize them.

With the Jacobian M = ∂(Q, P)/∂(q, p) and J = ((0, 1), (−1, 0)), a map is canonical with valence c when
M J Mᵀ = c J at each t. The five tests say the same in the words of Poisson, Lagrange, of matrices, of the
bilinear covariant and of the contact form (H. Goldstein, Classical Mechanics, ch. 9; E. T. Whittaker,
Analytical Dynamics, ch. XI).
"""

from __future__ import annotations

import time as clock
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import time
from canon.expression.symbols.user_input import (
    counted,
    given_kind,
    given_seconds,
    given_symbols,
)
from canon.mechanics.algebra.all_vanish import all_vanish, having_values
from canon.mechanics.algebra.dynamicsymbols import check_none_is_the_time, in_own_symbols
from canon.mechanics.algebra.jacobian import jacobian
from canon.mechanics.algebra.linear import solve
from canon.mechanics.algebra.potential import potential
from canon.mechanics.algebra.substitution import as_tuple, carried, entry, substitute
from canon.mechanics.canonical.canonicity_tests import TESTS, Test, disagreement, given_valence, residuals
from canon.mechanics.canonical.repair_hint import constant_value, repair_hint
from canon.mechanics.hamilton.bracket import antisymmetric, lagrange_matrix
from canon.proof.domain.domain import Domain, as_domain
from canon.proof.domain.verdict import Evidence, Status, Verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["CanonicalTransformation", "point_transformation"]


@dataclass(frozen=True)
class CanonicalTransformation:
    """A transformation Q(q, p, t), P(q, p, t) that claims to be canonical.

    Parameters
    ----------
    q, p
        The old coordinates and momenta, symbols.
    new_q, new_p
        The new ones as expressions in the old ones and t.
    domain
        Where the map is meant.
    t
        The time.

    Raises
    ------
    ValueError
        Where there are not as many of each, variables are not all different, one is the time, or the new variables hold
        another symbol of the name of one.

    Examples
    --------
    >>> from sympy import symbols, sqrt, sin, cos
    >>> q = symbols("q", positive=True); p = symbols("p", real=True)
    >>> T = CanonicalTransformation(q, p, sqrt(2*q)*cos(p), sqrt(2*q)*sin(p))
    >>> T.is_canonical().status.name
    'HOLDS'
    >>> T = CanonicalTransformation(q, p, sqrt(q)*cos(p), sqrt(q)*sin(p))
    >>> T.is_canonical().feedback
    '{Q, P} = 1/2, not 1: canonical with valence 1/2; multiply P by 2 to make it univalent'
    """

    q: tuple[Symbol, ...]
    p: tuple[Symbol, ...]
    new_q: tuple[Expr, ...]
    new_p: tuple[Expr, ...]
    domain: Domain = field(default_factory=Domain)
    t: Symbol = time

    def __init__(
        self,
        q: Sequence[Symbol] | Symbol,
        p: Sequence[Symbol] | Symbol,
        new_q: Sequence[Expr] | Expr,
        new_p: Sequence[Expr] | Expr,
        domain: Domain | None = None,
        t: Symbol = time,
    ) -> None:
        for name, given in (("q", q), ("p", p)):
            object.__setattr__(self, name, given_symbols(given, name))
        object.__setattr__(self, "t", given_kind(t, Symbol, "the time", "the domain comes before it"))
        check_none_is_the_time((*self.q, *self.p), "CanonicalTransformation(q, p, new_q, new_p", t)
        for name, given in (("new_q", new_q), ("new_p", new_p)):
            object.__setattr__(self, name, in_own_symbols(as_tuple(given), (*self.q, *self.p), t))
        object.__setattr__(self, "domain", as_domain(domain))
        lengths = {len(self.q), len(self.p), len(self.new_q), len(self.new_p)}
        if len(lengths) > 1:
            raise ValueError(
                f"{len(self.q)} q, {len(self.p)} p, {len(self.new_q)} new_q, {len(self.new_p)} new_p; "
                "give as many of each"
            )
        if len({*self.q, *self.p}) < 2 * len(self.q):
            raise ValueError(
                f"the variables {(*self.q, *self.p)} are not all different; each needs a symbol of its own"
            )

    @property
    def variables(self) -> tuple[Symbol, ...]:
        """The old variables (q, p), of length 2n."""
        return (*self.q, *self.p)

    @property
    def images(self) -> tuple[Expr, ...]:
        """The new variables (Q, P) as expressions, of length 2n."""
        return (*self.new_q, *self.new_p)

    @cached_property
    def jacobian(self) -> sp.ImmutableDenseMatrix:
        """The Jacobian M = ∂(Q, P)/∂(q, p), of shape (2n, 2n)."""
        return sp.ImmutableDenseMatrix(jacobian(self.images, self.variables))

    @cached_property
    def poisson_brackets(self) -> sp.ImmutableDenseMatrix:
        """The brackets of the new variables, {Q, P} = M J Mᵀ, of shape (2n, 2n)."""
        return sp.ImmutableDenseMatrix(antisymmetric(2 * len(self.q), self.poisson_bracket_of))

    def poisson_bracket_of(self, i: int, j: int) -> Expr:
        """Return the Poisson bracket of the i-th and the j-th of the new variables (Q, P)."""
        M, n = self.jacobian, len(self.q)
        return sp.Add(
            *(entry(M, i, k) * entry(M, j, n + k) - entry(M, i, n + k) * entry(M, j, k) for k in range(n))
        )

    @cached_property
    def lagrange_brackets(self) -> sp.ImmutableDenseMatrix:
        """Lagrange's brackets of the old variables, [q, p] = Mᵀ J M, of shape (2n, 2n)."""
        return sp.ImmutableDenseMatrix(lagrange_matrix(self.variables, self.new_q, self.new_p))

    @cached_property
    def valence(self) -> Expr | None:
        """The constant c with {Q₁, P₁} = c, where that bracket is a nonzero constant; else None.

        :meth:`is_canonical` with ``valence=None`` tells whether the map is canonical with it.
        """
        c = constant_value(
            entry(self.poisson_brackets, 0, len(self.q)), self.variables, self.domain, t=self.t
        )
        return c if c is not None and c != 0 else None

    def contact_form(self, valence: Expr = sp.S.One) -> tuple[Expr, ...]:
        """Return the coefficients of c p dq − P dQ in (dq, dp) at fixed t, of length 2n."""
        return tuple(
            sp.Add(
                valence * self.p[i] if i < len(self.q) else sp.S.Zero,
                *(-P * Q.diff(z) for Q, P in zip(self.new_q, self.new_p, strict=True)),
            )
            for i, z in enumerate(self.variables)
        )

    def contact_function(self, valence: Expr = sp.S.One) -> Expr | None:
        """Return F(q, p, t) with dF = Σ c p dq − Σ P dQ at fixed t, proved; None where none was found.

        Examples
        --------
        >>> from sympy import symbols
        >>> q, p, m, w = symbols("q p m omega", positive=True)
        >>> T = CanonicalTransformation(q, p, sp.atan(m*w*q/p), (p**2 + m**2*w**2*q**2)/(2*m*w))
        >>> T.contact_function()
        p*q/2
        """
        hints = {q * p: q * p for q, p in zip(self.q, self.p, strict=True)}
        hints |= {Q * P: Q * P for Q, P in zip(self.new_q, self.new_p, strict=True)}
        return potential(self.contact_form(valence), self.variables, self.domain, hints)

    def is_canonical(
        self,
        by: Test | Literal["all"] | None = None,
        valence: Expr | int | None = 1,
        budget: float = 10.0,
    ) -> Verdict:
        """Tell whether the map is canonical at each t.

        Parameters
        ----------
        by
            ``"poisson"``: {Q, Q} = {P, P} = 0, {Q, P} = c; ``"lagrange"``: the same for Lagrange's brackets;
            ``"symplectic"``: M J Mᵀ = c J; ``"bilinear"``: Σ (δP dQ − dP δQ) = c Σ (δp dq − dp δq);
            ``"contact"``: c p dq − P dQ is exact; ``"all"``: all five, and whether they agree.
            The cheapest unless given.
        valence
            The constant c; None to find it.
        budget
            Seconds for each test.

        Returns
        -------
        Verdict
            FAILS says in its feedback what would mend the map, where that is simple.
        """
        if by == "all":
            return disagreement({test: self.is_canonical(test, valence, budget) for test in TESTS})
        c = self.valence if valence is None else given_valence(valence, (*self.variables, self.t))
        if c is None:
            return self._without_valence(budget)
        question = f"the map is canonical{'' if c == 1 else f' with valence {c}'}"
        deadline = clock.monotonic() + given_seconds(budget)
        test = by or ("poisson" if self.jacobian.has(*self.variables) else "symplectic")
        left = deadline - clock.monotonic()
        verdict = all_vanish(residuals(self, test, c), question, self.domain, left)
        verdict = having_values(verdict, self._named_images, self.variables, self.domain)
        if verdict.fails and verdict.certificate != "definedness":
            left = deadline - clock.monotonic()
            mended = repair_hint(self, c, left)
            return verdict if mended is None else replace(verdict, feedback=str(mended))
        if verdict.holds and by == "contact":
            F = self.contact_function(c)
            found = "an exact differential, not integrated in closed form" if F is None else str(F)
            return replace(
                verdict, evidence=(*verdict.evidence, Evidence("F with dF = c p dq − P dQ", found))
            )
        return verdict

    @property
    def _named_images(self) -> dict[str, Expr]:
        numbered = [f"{letter}{i}" for letter in "QP" for i in range(1, len(self.q) + 1)]
        return dict(zip(numbered if len(self.q) > 1 else "QP", self.images, strict=True))

    def _without_valence(self, budget: float) -> Verdict:
        """Judge a map whose {Q₁, P₁} is not known to be constant: FAILS if it certainly is not."""
        bracket = entry(self.poisson_brackets, 0, len(self.q))
        question = "the map is canonical with some valence"
        moving = [(f"∂{{Q1, P1}}/∂{z} = 0", bracket.diff(z)) for z in (*self.variables, self.t)]
        still = all_vanish(moving, question, self.domain, budget)
        if still.fails:
            why = f"{{Q1, P1}} = {bracket} is not constant, so no valence makes the map canonical"
            return replace(still, question=question, feedback=why)
        zero = all_vanish([("{Q1, P1} = 0", bracket)], question, self.domain, budget)
        if zero.holds:
            why = "{Q1, P1} = 0, so no valence makes the map canonical"
            return replace(zero, status=Status.FAILS, residual=bracket, feedback=why)
        return Verdict(Status.UNDECIDED, question, residual=bracket, seconds=still.seconds + zero.seconds)

    def then(self, following: CanonicalTransformation) -> CanonicalTransformation:
        """Return the map that applies this one first and ``following`` after it, where both are meant.

        Examples
        --------
        >>> from sympy import symbols
        >>> q, p, Q, P = symbols("q p Q P")
        >>> exchange = CanonicalTransformation(q, p, p, -q)
        >>> exchange.then(CanonicalTransformation(Q, P, P, -Q)).images
        (-q, -p)
        """
        given_kind(following, CanonicalTransformation, "what follows")
        if len(following.q) != len(self.q):
            raise ValueError(
                f"a map of {counted(len(self.q), 'degree')} of "
                f"freedom cannot precede one of {len(following.q)}; give maps of as many"
            )
        here = dict(zip(following.variables, self.images, strict=True))
        if following.t != self.t:
            here[following.t] = self.t
        new_q, new_p = ([substitute(f, here) for f in part] for part in (following.new_q, following.new_p))
        positive = (sp.Gt(z, 0, evaluate=False) for z in following.variables if z.is_positive)
        there = carried((*positive, *following.domain.conditions), here)
        domain = Domain((*self.domain.conditions, *there), self.domain.box)
        return CanonicalTransformation(self.q, self.p, new_q, new_p, domain, self.t)

    def _repr_latex_(self) -> str:
        rows = [
            rf"{letter}{f'_{{{i + 1}}}' if len(self.q) > 1 else ''} &= {sp.latex(f)}"
            for letter, images in (("Q", self.new_q), ("P", self.new_p))
            for i, f in enumerate(images)
        ]
        return "$\\displaystyle \\begin{aligned}" + r" \\ ".join(rows) + "\\end{aligned}$"


_BY_CRAMER = 3
"""Coordinates up to which the momenta are written by Cramer's rule, whose one denominator is the determinant:
elimination divides by pivots as well, such as the cosine of a turn, and a motion would end where one vanishes."""


def point_transformation(
    q: Sequence[Symbol] | Symbol,
    p: Sequence[Symbol] | Symbol,
    new_q: Sequence[Expr] | Expr,
    domain: Domain | None = None,
    t: Symbol = time,
) -> CanonicalTransformation:
    """Lift new coordinates Q(q, t) to a canonical transformation, with P = (∂Q/∂q)⁻ᵀ p.

    Parameters
    ----------
    q, p
        The old coordinates and momenta.
    new_q
        The new coordinates as functions of the old ones and t.
    domain
        Where the new coordinates are regular.
    t
        The time.

    Raises
    ------
    SingularMatrixError
        Where the new coordinates are not independent, with the null direction.

    Examples
    --------
    >>> from sympy import symbols
    >>> q = symbols("q", positive=True); p = symbols("p", real=True)
    >>> point_transformation(q, p, q**2).new_p
    (p/(2*q),)
    """
    old, momenta, new = given_symbols(q, "q"), given_symbols(p, "p"), as_tuple(new_q)
    if not len(old) == len(momenta) == len(new):
        raise ValueError(
            f"{counted(len(old), 'coordinate')}, {counted(len(momenta), 'momentum', 'momenta')}, "
            f"{counted(len(new), 'new coordinate')}; give as many of each"
        )
    new = in_own_symbols(new, (*old, *momenta), t)
    if any(f.has(*momenta) for f in new):
        raise ValueError("the new coordinates of a point transformation depend on q and t only, not on p")
    transposed = sp.Matrix([[f.diff(x) for f in new] for x in old])
    solved = solve(transposed, sp.Matrix(momenta), domain, "the Jacobian of the new coordinates")
    if 1 < len(old) <= _BY_CRAMER:
        found = cast("Expr", transposed.det(method="berkowitz"))
        constant = constant_value(found, old, as_domain(domain), 1.0, t)  # cos² + sin² of a turn is 1
        solved = transposed.adjugate() * sp.Matrix(momenta) / (found if constant is None else constant)
    new_p = [entry(solved, i, 0) for i in range(len(old))]
    return CanonicalTransformation(old, momenta, new, new_p, domain, t)
