"""Factors with and without a proven sign, taken out of roots, logarithms and moduli."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from canon.proof.tower.tower import Fraction

if TYPE_CHECKING:
    from flint import fmpq, fmpq_mpoly

    from canon.proof.tower.forms import Forms

__all__ = ["apart", "factors_of", "modulus_of_polynomial", "primes", "split_signs"]

LONGEST_REWRITTEN = 40
"""Terms of a polynomial that is written otherwise in a sine and a cosine to be factored."""
LARGEST_FACTORED_INTEGER = 10**15
"""Integers up to this are split into primes under roots and logarithms."""


def split_signs(n: Forms, f: Fraction) -> tuple[fmpq, list[tuple[Fraction, int]], Fraction]:
    """Write f = content · Π positiveᵢ^eᵢ · rest with content > 0 and positiveᵢ ≥ 0 proven.

    (ab)^r = a^r b^r and log ab = log a + log b hold when a ≥ 0, so every proven factor may be taken
    out; an even power of a real factor is that power of its modulus, and 1/p = p/|p|². The rest keeps
    what has no proven sign.
    """
    t = n.tower
    f = t.canonical(f)
    content, factors = factors_of(n, f.num)
    for i, e in f.den:
        unit, below = factors_of(n, t.base(i))
        content = content / unit**e
        factors = factors + [(p, -e * k) for p, k in below]
    sign = 1 if content > 0 else -1
    outside: list[tuple[Fraction, int]] = []
    rest = t.number(1)
    for p, e in factors:
        known = n.signs.of(p)
        if known.endswith("+"):
            outside.append((Fraction(p), e))
        elif known:
            outside.append((Fraction(-p), e))
            sign *= (-1) ** (e % 2)
        elif n.signs.real(p):
            if e - e % 2:
                outside.append((modulus_of_polynomial(n, p), e - e % 2))
            if e % 2:
                rest = t.times(rest, Fraction(p))
        else:
            rest = t.times(rest, t.power(Fraction(p), e))
    return abs(content), outside, t.canonical(n.scaled(sign, rest))


def factors_of(n: Forms, p: fmpq_mpoly) -> tuple[fmpq, list[tuple[fmpq_mpoly, int]]]:
    """Factor p, also as a form in cosine and sine, 1 − 2sc = (c − s)², or in the sine, 2 + 2s − c² = (1 + s)²."""
    t = n.tower
    for k in t.used(p):
        kernel = t.generators[k]
        if kernel[0] != "cos":
            continue
        sine = t.generator(("sin", kernel[1]))
        for other in (_homogeneous(n, p, k, sine), _in_the_sine(n, p, k, sine)):
            if other is not None:
                unit, factors = t.factors(other)
                if len(factors) > 1 or factors[0][1] > 1:
                    return unit, factors
    return t.factors(p)


def _in_the_sine(n: Forms, p: fmpq_mpoly, c: int, s: int) -> fmpq_mpoly | None:
    """Return p with 1 − s² for c², where it holds odd powers of the sine and even ones of the cosine alone."""
    t = n.tower
    if s not in t.used(p) or len(p) > LONGEST_REWRITTEN:
        return None
    coefficients = t.coefficients(p, c)
    if len(coefficients) > 9 or any(not a.is_zero() for a in coefficients[1::2]):
        return None
    total = t.constant(0)
    for j, coefficient in enumerate(coefficients[::2]):
        total = total + coefficient * (1 - t.monomial(s, 2)) ** j
    return total


def _homogeneous(n: Forms, p: fmpq_mpoly, c: int, s: int) -> fmpq_mpoly | None:
    """Multiply terms by c² + s² = 1 until all have one degree in c and s, if their degrees allow it."""
    t = n.tower
    by_degree: dict[int, fmpq_mpoly] = {}
    for monomial, coefficient in t.terms(p):
        degree = sum(e for k, e in monomial if k in (c, s))
        term = t.constant(coefficient)
        for k, e in monomial:
            term = term * t.monomial(k, e)
        by_degree[degree] = by_degree.get(degree, t.constant(0)) + term
    highest = max(by_degree)
    if highest > 8 or len({degree % 2 for degree in by_degree}) > 1 or len(p) > LONGEST_REWRITTEN:
        return None
    one = t.monomial(c, 2) + t.monomial(s, 2)
    total = t.constant(0)
    for degree, part in by_degree.items():
        total = total + part * one ** ((highest - degree) // 2)
    return total


def primes(number: fmpq) -> list[tuple[int, int]]:
    """Return primes and exponents of a positive rational; large integers stay whole."""
    found: list[tuple[int, int]] = []
    for whole, side in ((int(number.p), 1), (int(number.q), -1)):
        if whole > LARGEST_FACTORED_INTEGER:
            found.append((whole, side))
        elif whole > 1:
            found.extend((int(p), side * int(e)) for p, e in sp.factorint(whole).items())
    return found


def apart(n: Forms, f: Fraction) -> tuple[fmpq, list[tuple[Fraction, int]], Fraction]:
    """Write f = content · Π pᵢ^eᵢ · (±1) with polynomials pᵢ, not negative where their sign is proven."""
    t = n.tower
    f = t.canonical(f)
    content, factors = t.factors(f.num)
    sign = 1 if content > 0 else -1
    powers: list[tuple[Fraction, int]] = []
    for p, e in factors + [(t.base(i), -e) for i, e in f.den]:
        flipped = n.signs.of(p).endswith("-")
        sign = -sign if flipped and e % 2 else sign
        powers.append((Fraction(-p if flipped else p), e))
    return abs(content), powers, t.number(sign)


def modulus_of_polynomial(n: Forms, p: fmpq_mpoly) -> Fraction:
    """Return |p| for a real polynomial: ±p where its sign is proven, else a kernel whose square is p²."""
    known = n.signs.of(p)
    if known:
        return Fraction(p if known.endswith("+") else -p)
    t = n.tower
    if p.leading_coefficient() < 0:
        p = -p
    kernel = ("abs", t.key(p))
    if not t.knows(kernel):
        n.arguments[kernel] = Fraction(p)
        square = t.product(p, p)
        t.relate(t.generator(kernel), 2, square)
    return n.atom(kernel, "0+", lambda: sp.Abs(n.expression(p)))
