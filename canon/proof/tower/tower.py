"""Tower of generators: fractions of polynomials with triangular relations.

Every generator is a symbol or a kernel (a cosine, a sine, a root …); a relation replaces a power of a
generator by a polynomial in earlier ones, as s² = 1 − c². A fraction keeps its denominator as a product of
powers of numbered bases, so sums need no polynomial gcd. A numerator that reduces to zero proves that the
expression vanishes wherever it is defined, because every relation holds wherever its kernel is defined.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from flint import Ordering, fmpq, fmpq_mpoly, fmpq_mpoly_ctx
from flint.utils.flint_exceptions import DomainError

from canon.proof.domain.limits import THOROUGH, Full, Limits, OutOfTime, TooLarge
from canon.proof.tower.algebraic_numbers import reciprocal
from canon.proof.tower.ideal import Ideal

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable

__all__ = ["Fraction", "Tower"]


LARGEST_POWER = 2000
"""Whole powers that are written out; flint ends the process where a coefficient overflows the memory."""


FEW_DIVISIONS = 8
"""Powers of a generator up to this are cancelled one by one."""


@dataclass(frozen=True)
class Fraction:
    """A numerator over a product of numbered bases: ``num / Π base[i]**e``."""

    num: fmpq_mpoly
    den: tuple[tuple[int, int], ...] = ()


class Tower:
    """Generators, their relations, and the arithmetic of fractions over them.

    Parameters
    ----------
    deadline
        Value of :func:`time.monotonic` after which arithmetic raises :class:`OutOfTime`.
    limits
        Sizes beyond which :class:`TooLarge` is raised.
    capacity
        Number of generators beyond which :class:`Full` is raised.
    """

    def __init__(self, deadline: float = float("inf"), limits: Limits = THOROUGH, capacity: int = 16) -> None:
        self.deadline = deadline
        self.limits = limits
        self.capped = False
        self.generators: list[Any] = []
        self._index: dict[Hashable, int] = {}
        self._relations: dict[int, tuple[int, fmpq_mpoly]] = {}
        self._zeros: list[fmpq_mpoly] = []
        self._ideal: Ideal | None = None
        self._bases: list[fmpq_mpoly] = []
        self._base_index: dict[Hashable, int] = {}
        self._capacity = capacity
        names = tuple(f"g{k}" for k in reversed(range(capacity)))
        self._ctx = fmpq_mpoly_ctx.get(names, Ordering.lex)
        self._gens = list(reversed(self._ctx.gens()))

    # -- generators ------------------------------------------------------------------------------

    def generator(self, kernel: Hashable) -> int:
        """Return the number of the generator that stands for ``kernel``."""
        found = self._index.get(kernel)
        if found is None:
            found = len(self.generators)
            if found >= self._capacity:
                raise Full
            self._index[kernel] = found
            self.generators.append(kernel)
        return found

    def knows(self, kernel: Hashable) -> bool:
        """Tell whether ``kernel`` already is a generator."""
        return kernel in self._index

    def relate(self, generator: int, degree: int, power: fmpq_mpoly) -> None:
        """Declare generator**degree = power, a polynomial in earlier generators."""
        self._relations[generator] = (degree, power)

    def relation(self, generator: int) -> tuple[int, fmpq_mpoly] | None:
        """Return the relation of a generator, if it has one."""
        found = self._relations.get(generator)
        return None if found is None else (found[0], found[1])

    # -- polynomials -----------------------------------------------------------------------------

    def constant(self, number: Any) -> fmpq_mpoly:
        """Return a rational number as a polynomial."""
        return self._ctx.constant(number)

    def monomial(self, generator: int, power: int = 1) -> fmpq_mpoly:
        """Return a power of one generator."""
        return self._gens[generator] ** power

    def terms(self, p: fmpq_mpoly) -> list[tuple[tuple[tuple[int, int], ...], fmpq]]:
        """Return the terms of ``p`` as (((generator, exponent), …), coefficient)."""
        last = p.context().nvars() - 1
        return [
            (tuple((last - k, int(e)) for k, e in enumerate(exponents) if e)[::-1], coefficient)
            for exponents, coefficient in p.terms()
        ]

    def key(self, p: fmpq_mpoly) -> Hashable:
        """Return a hashable value equal exactly for equal polynomials, in kernels rather than numbers."""
        return frozenset(
            (frozenset((self.generators[k], e) for k, e in m), int(c.p), int(c.q)) for m, c in self.terms(p)
        )

    def used(self, p: fmpq_mpoly) -> list[int]:
        """Return the generators that occur in ``p``, ascending."""
        degrees = p.degrees()
        last = len(degrees) - 1
        return sorted(last - k for k, d in enumerate(degrees) if d > 0)

    def reduce(self, p: fmpq_mpoly) -> fmpq_mpoly:
        """Replace every power that a relation covers, highest generator first."""
        if not self._relations or p.is_constant():
            return p
        last = self._capacity - 1
        degrees = p.degrees()
        for k in sorted(self._relations, reverse=True):
            degree, power = self._relations[k]
            if degrees[last - k] >= degree:
                self.check_time()
                p = divmod(p, self._gens[k] ** degree - power)[1]
                if p.is_zero():
                    return p
                degrees = p.degrees()
        return p

    def product(self, a: fmpq_mpoly, b: fmpq_mpoly) -> fmpq_mpoly:
        """Multiply and reduce, after checking time and size."""
        if len(a) * len(b) > self.limits.product:
            raise TooLarge(f"a product of {len(a)} by {len(b)} terms")
        self.check_time()
        return self.reduce(a * b)

    def polynomial_power(self, p: fmpq_mpoly, n: int) -> fmpq_mpoly:
        """Return p**n for n ≥ 0, of a degree and coefficients that can be written out."""
        if n > LARGEST_POWER:
            raise TooLarge(f"the power {n}")
        if len(p) == 1:
            return self.reduce(p**n)
        total = self.constant(1)
        square = p
        while n:
            if n & 1:
                total = self.product(total, square)
            n >>= 1
            if n:
                square = self.product(square, square)
        return total

    def quotient(self, p: fmpq_mpoly, q: fmpq_mpoly) -> fmpq_mpoly | None:
        """Return p/q where q divides p: at the first term that it cannot divide, division ends."""
        self.check_time()
        try:
            return p / q
        except DomainError:
            return None

    def factors(self, p: fmpq_mpoly) -> tuple[fmpq, list[tuple[fmpq_mpoly, int]]]:
        """Write p as a number times powers of irreducible factors; a large p stays one factor."""
        self.check_time()
        if len(p) == 1:
            ((monomial, unit),) = self.terms(p)
            return unit, [(self.monomial(k), e) for k, e in monomial]
        if len(p) <= self.limits.factored_terms and p.total_degree() <= self.limits.factored_degree:
            unit, found = p.factor()
            return unit, [(factor, int(e)) for factor, e in found]
        self.capped = self.capped or len(p) <= THOROUGH.factored_terms
        unit = p.leading_coefficient()
        return unit, [(p * self.constant(1 / unit), 1)]

    def square_root(self, p: fmpq_mpoly) -> fmpq_mpoly | None:
        """Return a polynomial whose square is ``p``, if there is one."""
        try:
            return p.sqrt()
        except DomainError:
            return None

    def coefficients(self, p: fmpq_mpoly, generator: int) -> list[fmpq_mpoly]:
        """Return the coefficients of ``p`` as a polynomial in one generator, constant term first."""
        place = self._capacity - 1 - generator
        parts: dict[int, dict[tuple[int, ...], fmpq]] = {}
        for exponents, coefficient in p.terms():
            e = int(exponents[place])
            if e > LARGEST_POWER:
                raise TooLarge(f"the degree {e}")
            rest = (*exponents[:place], 0, *exponents[place + 1 :])
            parts.setdefault(e, {})[rest] = coefficient
        return [self._ctx.from_dict(parts.get(e, {})) for e in range(max(parts, default=0) + 1)]

    def resultant(self, p: fmpq_mpoly, q: fmpq_mpoly, generator: int) -> fmpq_mpoly:
        """Eliminate one generator from two polynomials."""
        self.check_time()
        return p.resultant(q, f"g{generator}")

    def check_time(self) -> None:
        """Raise :class:`OutOfTime` when the deadline has passed."""
        if time.monotonic() > self.deadline:
            raise OutOfTime

    # -- fractions -------------------------------------------------------------------------------

    def number(self, value: Any) -> Fraction:
        """Return a rational number as a fraction."""
        return Fraction(self.constant(value))

    def base(self, i: int) -> fmpq_mpoly:
        """Return denominator base ``i``."""
        return self._bases[i]

    def _number_base(self, p: fmpq_mpoly) -> int:
        key = self.key(p)
        found = self._base_index.get(key)
        if found is None:
            found = self._base_index[key] = len(self._bases)
            self._bases.append(p)
        return found

    def sum(self, terms: Iterable[Fraction]) -> Fraction:
        """Add fractions over the least common product of bases."""
        groups: dict[tuple[tuple[int, int], ...], fmpq_mpoly] = {}
        for term in terms:
            before = groups.get(term.den)
            num = term.num
            groups[term.den] = num if before is None else before + num
        groups = {den: num for den, num in groups.items() if not num.is_zero()}
        if not groups:
            return self.number(0)
        common: dict[int, int] = {}
        for den in groups:
            for i, e in den:
                common[i] = max(common.get(i, 0), e)
        total = self.constant(0)
        for den, num in groups.items():
            have = dict(den)
            for i, e in common.items():
                missing = e - have.get(i, 0)
                if missing:
                    num = self.product(num, self.polynomial_power(self.base(i), missing))
            total = total + num
        return self._cancelled(total, common)

    def times(self, *factors: Fraction) -> Fraction:
        """Multiply fractions, smallest numerators first."""
        num = self.constant(1)
        den: dict[int, int] = {}
        for factor in sorted(factors, key=lambda f: len(f.num)):
            num = self.product(num, factor.num)
            for i, e in factor.den:
                den[i] = den.get(i, 0) + e
        return self._cancelled(num, den)

    def _cancelled(self, num: fmpq_mpoly, den: dict[int, int]) -> Fraction:
        if num.is_zero():
            return Fraction(num)
        num = num
        left: list[tuple[int, int]] = []
        for i, e in sorted(den.items()):
            base = self.base(i)
            if e > FEW_DIVISIONS and len(base) == 1 and base.total_degree() == 1:
                common = min(e, num.term_content().degrees()[self._capacity - 1 - self.used(base)[0]])
                num, e = divmod(num, base**common)[0], e - common
                left += [(i, e)] if e > 0 else []
                continue
            while e > 0 and len(base) <= len(num) <= 2000 and len(base) * len(num) <= self.limits.product:
                quotient = self.quotient(num, base)
                if quotient is None:
                    break
                num, e = quotient, e - 1
            if e > 0:
                left.append((i, e))
        return Fraction(num, tuple(left))

    def reciprocal(self, f: Fraction) -> Fraction:
        """Return 1/f.

        Raises
        ------
        ZeroDivisionError
            If ``f`` reduces to zero: the expression is then defined nowhere.
        """
        num = self.reduce(f.num)
        if num.is_zero():
            raise ZeroDivisionError("a denominator vanishes identically")
        upper = self.constant(1)
        for i, e in f.den:
            upper = self.product(upper, self.polynomial_power(self.base(i), e))
        unit, factors = self.factors(num)
        den: dict[int, int] = {}
        upper = upper * self.constant(fmpq(1) / unit)
        for factor, e in factors:
            multiplier, base = self._rational_base(factor)
            upper = self.product(upper, self.polynomial_power(multiplier, int(e)))
            if not base.is_constant():
                i = self._number_base(base)
                den[i] = den.get(i, 0) + int(e)
            else:
                upper = upper * self.constant(fmpq(1) / base.leading_coefficient() ** int(e))
        return self._cancelled(upper, den)

    def _rational_base(self, p: fmpq_mpoly) -> tuple[fmpq_mpoly, fmpq_mpoly]:
        """Rewrite 1/p as (multiplier, base) when p is one root ρ with ρⁿ = R: 1/ρ = ρⁿ⁻¹/R, or has a reciprocal."""
        if len(p) == 1 and p.total_degree() == 1:
            (k,) = self.used(p)
            relation = self.relation(k)
            if relation is not None and len(relation[1]) == 1:
                return self.monomial(k, relation[0] - 1), self.reduce(relation[1])
        if len(p) > 1 and (inverse := reciprocal(self, p)) is not None:
            return inverse, self.constant(1)
        return self.constant(1), p

    def power(self, f: Fraction, n: int) -> Fraction:
        """Return f**n for an integer n."""
        if n < 0:
            return self.power(self.reciprocal(f), -n)
        if n == 0:
            return self.number(1)
        return self._cancelled(self.polynomial_power(f.num, n), {i: e * n for i, e in f.den})

    def is_zero(self, f: Fraction) -> bool:
        """Tell whether the numerator reduces to zero, or to a multiple of what is known to be zero."""
        num = self.reduce(f.num)
        for zero in self._zeros:
            if not num.is_zero():
                num = divmod(num, zero)[1]
        return num.is_zero() or (len(self._zeros) > 1 and self._in_ideal(num))

    def learn_zero(self, p: fmpq_mpoly) -> None:
        """Record a polynomial that vanishes identically though it does not reduce to zero."""
        if p.is_zero():
            return
        reduced = self.constant(1)
        for factor, _ in self.factors(p)[1]:
            reduced = reduced * factor
        self._zeros.append(reduced)
        self._ideal = None

    def _in_ideal(self, p: fmpq_mpoly) -> bool:
        """Tell whether a polynomial is a combination of those known to vanish and of the relations."""
        if self._ideal is None:
            related = (self._gens[k] ** degree - power for k, (degree, power) in self._relations.items())
            self._ideal = Ideal.of([*self._zeros, *related])
        self.check_time()
        return self._ideal.holds(p)

    def canonical(self, f: Fraction) -> Fraction:
        """Return ``f`` with the common factors of numerator and denominator cancelled."""
        return self._cancelled(self.reduce(f.num), dict(f.den))
