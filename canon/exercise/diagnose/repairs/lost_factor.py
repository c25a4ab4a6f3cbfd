"""Lost factors: products of powers missing in an answer, found from how its residual scales.

If a residual is c Π sᵉ times few functions, doubling one symbol multiplies it by 2ᵉ. What is found from values
is a candidate, which is proved elsewhere.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import acb
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.cached_property import cached_property
from canon.expression.symbols.symbol import Rate
from canon.mechanics.algebra.substitution import symbols_of
from canon.proof.continuity.smooth import PIECED
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, value

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from canon.exercise.question.question import Part

__all__ = ["Monomials"]

MOST_SYMBOLS = 14
MOST_FACTORS = 16
_TWINS = {sp.sin: sp.cos, sp.cos: sp.sin}
MOST_EXPONENT = 4
MOST_ROOT = 3
"""A factor may hold square and cube roots."""
MOST_FORGOTTEN = 3
MOST_SUMS = 2
_NO_VALUE = (Undefined, NotDecided, Unmodelled, ZeroDivisionError)


class Monomials:
    """The monomials that explain what is wrong with a component of an answer.

    Parameters
    ----------
    part
        The component.
    point
        A point of the domain; None where there is none.
    memo
        Returns the values of symbols and arbitrary functions at a point.
    """

    def __init__(
        self,
        part: Part,
        point: Mapping[Symbol, sp.Rational] | None,
        memo: Callable[[dict[Symbol, sp.Rational], int], dict[sp.Basic, acb] | None],
    ) -> None:
        self._part = part
        self._point = dict(point or {})
        self._memo = memo

    def of_residual(self) -> Iterator[Expr]:
        """Yield the monomials, times at most two functions, that the residual is."""
        yield from (term for term in self._explaining(self._residuals) if not _divides_by_motion(term))

    def of_share(self, term: Expr) -> Iterator[Expr]:
        """Yield the factors that a term lacks: the monomials that 1 − residual/term is."""
        try:
            shares = {s: 1 - r / value(term, {}, self._memos[s]) for s, r in self._residuals.items()}
        except _NO_VALUE:
            return
        yield from (factor for factor in self._explaining(shares) if _forgettable(factor, self._part))

    def of_bracket(self, before: Expr) -> Iterator[Expr]:
        """Yield the monomials that the residual is beside what stands before a bracket."""
        try:
            inside = {s: r / value(before, {}, self._memos[s]) for s, r in self._residuals.items()}
        except _NO_VALUE:
            return
        yield from (term for term in self._explaining(inside) if not _divides_by_motion(term))

    def of_difference(self, node: Expr, should_be: Mapping[Symbol | None, acb]) -> Iterator[Expr]:
        """Yield the monomials that a part of the answer lacks, whose right values are known."""
        now = self.values(node)
        if None not in should_be or now.keys() != should_be.keys():
            return
        missing = {s: v - now[s] for s, v in should_be.items()}
        yield from (term for term in self._explaining(missing) if not _divides_by_motion(term))

    def values(self, expression: Expr) -> dict[Symbol | None, acb]:
        """Return the values of an expression at the point, under None, and where each symbol is doubled."""
        try:
            return {s: value(expression, {}, memo) for s, memo in self._memos.items()}
        except _NO_VALUE:
            return {}

    @cached_property
    def _memos(self) -> dict[Symbol | None, dict[sp.Basic, acb]]:
        """The values at the point, under None, and where each symbol is doubled; empty where one has none."""
        part = self._part
        free = [
            s for s in symbols_of(part.right, part.claimed, *part.through.values()) if s not in part.through
        ]
        if not self._point or len(free) > MOST_SYMBOLS:
            return {}
        found: dict[Symbol | None, dict[sp.Basic, acb]] = {}
        for s in (None, *free):
            memo = self._memo(
                {x: cast("sp.Rational", 2 * v) if x == s else v for x, v in self._point.items()}, 0
            )
            if memo is None:
                return {}
            found[s] = memo
        return found

    @cached_property
    def _residuals(self) -> dict[Symbol | None, acb]:
        part = self._part
        try:
            return {
                s: value(part.claimed, {}, memo) - value(part.right, {}, memo)
                for s, memo in self._memos.items()
            }
        except _NO_VALUE:
            return {}

    @cached_property
    def _divisors(self) -> list[Expr]:
        """1, the replaced symbols and the functions, and products of two of them; those claimed come first."""
        part = self._part
        whole = sp.Tuple(part.claimed, part.right, *part.through.values())
        found = whole.atoms(AppliedUndef, sp.Derivative, sp.Function) - whole.atoms(*PIECED)
        twins: set[Expr] = {_TWINS[f.func](f.args[0]) for f in found if f.func in _TWINS}
        functions: list[Expr] = [*sorted(found, key=str), *sorted(twins - found, key=str)]
        unknown_first = [*reversed([*part.through]), *functions]
        factors = sorted(unknown_first, key=lambda f: (not part.claimed.has(f), not f.is_Symbol))[
            :MOST_FACTORS
        ]
        products = (a * b for i, a in enumerate(factors) for b in factors[i:])
        return [sp.S.One, *factors, *products, *(a * b for a in self._sums for b in (sp.S.One, *factors))]

    @cached_property
    def _sums(self) -> list[Expr]:
        """The shortest sums of symbols in the answer, such as m1 + m2."""
        found: list[Expr] = [f for f in self._part.claimed.atoms(sp.Add) if all(a.is_Symbol for a in f.args)]
        return sorted(found, key=str)[:MOST_SUMS]

    def _explaining(self, values: Mapping[Symbol | None, acb]) -> Iterator[Expr]:
        if not values:
            return
        for divisor in self._divisors:
            try:
                rest = {s: v / value(divisor, {}, self._memos[s]) for s, v in values.items()}
                found = _powers(rest)
                share = None if found is None else _simple(rest[None] / value(found, {}, self._memos[None]))
            except _NO_VALUE:
                continue
            if found is not None and share:
                yield sp.Rational(share.numerator, share.denominator) * found * divisor


def _forgettable(factor: Expr, part: Part) -> bool:
    """Whether a factor is one that a person may have lost: short, and no acceleration."""
    powers = cast("dict[Expr, Expr]", factor.as_powers_dict())
    if factor.is_Number or factor.has(*part.determined) or _divides_by_motion(factor):
        return False
    exponents = [e if e.is_Number else sp.S.One for base, e in powers.items() if not base.is_Number]
    return sum(map(abs, exponents)) <= MOST_FORGOTTEN


def _divides_by_motion(term: Expr) -> bool:
    """Whether a velocity or acceleration is in a denominator, or under a root."""
    powers = cast("dict[Expr, Expr]", term.as_powers_dict())
    return any(isinstance(base, Rate) and not (e.is_Integer and e > 0) for base, e in powers.items())


def _powers(values: Mapping[Symbol | None, acb]) -> Expr | None:
    """Return Π sᵉ from values at a point, under None, and where each symbol is doubled.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> _powers({None: acb(3), x: acb(12), y: acb(3) / 2}), _powers({None: acb(3), x: acb(10)})
    (x**2/y, None)
    """
    base, found = values[None], sp.S.One
    if base.contains(0):
        return None
    for s, at in values.items():
        if s is None:
            continue
        ratio = at / base
        if not ratio.imag.contains(0) or not ratio.real > 0:
            return None
        logarithm = float(ratio.real.log().mid())
        if not abs(logarithm) < MOST_EXPONENT:
            return None
        exponent = Fraction(logarithm / math.log(2)).limit_denominator(MOST_ROOT)
        exact = acb(2) ** (acb(exponent.numerator) / exponent.denominator)
        if not (ratio - exact).contains(0):
            return None
        found *= s ** sp.Rational(exponent.numerator, exponent.denominator)
    return found


def _simple(number: acb) -> Fraction | None:
    """Return the simple rational that a value is."""
    middle = float(number.real.mid())
    if not math.isfinite(middle):
        return None
    guess = Fraction(middle).limit_denominator(64)
    return guess if (number - acb(guess.numerator) / guess.denominator).contains(0) else None
