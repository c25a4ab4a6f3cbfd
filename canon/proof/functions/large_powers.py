"""Normal form of powers with large whole exponents, which are not multiplied out.

(x + 1)²⁵⁰(x − 1)²⁵⁰ is told to be (x² − 1)²⁵⁰ by its factors: p^M is a kernel of its own for each factor p, and other
powers of p are taken as whole powers of it times a small power of p.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.proof.domain.limits import Refine, TooLarge
from canon.proof.tower.factors import primes
from canon.proof.tower.tower import Fraction

if TYPE_CHECKING:
    from flint import fmpq_mpoly

    from canon.proof.tower.forms import Forms

__all__ = ["power"]

WRITTEN_OUT = 200
"""Whole powers of any fraction that are multiplied out."""

SHORT_WRITTEN_OUT = 300
"""Whole powers of two terms that are multiplied out."""

LARGEST_MONOMIAL = 2000
"""Whole powers of one generator that stay one."""

LARGEST_EXPONENT = 10**9


def power(n: Forms, f: Fraction, exponent: int) -> Fraction:
    """Return f^exponent, multiplied out for a small whole exponent, else as Π pᵢ^(eᵢ·exponent) over the factors."""
    t = n.tower
    if abs(exponent) <= WRITTEN_OUT:
        return t.power(f, exponent)
    if abs(exponent) > LARGEST_EXPONENT:
        raise TooLarge(f"the exponent {exponent}")
    if exponent < 0:
        return power(n, t.reciprocal(f), -exponent)
    f = t.canonical(f)
    if f.num.is_zero():
        return f
    content, factors = t.factors(f.num)
    parts = factors + [(t.base(i), -e) for i, e in f.den]
    total = t.number(-1 if content < 0 and exponent % 2 else 1)
    for prime, e in primes(abs(content)):
        total = t.times(total, _signed(n, t.constant(prime), e * exponent))
    for p, e in parts:
        total = t.times(total, _signed(n, p, e * exponent))
    return total


def _signed(n: Forms, p: fmpq_mpoly, exponent: int) -> Fraction:
    found = _of_factor(n, p, abs(exponent))
    return found if exponent >= 0 else n.tower.reciprocal(found)


def _of_factor(n: Forms, p: fmpq_mpoly, exponent: int) -> Fraction:
    """Return p^exponent; of a root or a sine the powers that its relation covers are those of the radicand."""
    t = n.tower
    if len(p) == 1 and p.total_degree() == 1:
        k = t.used(p)[0]
        relation = t.relation(k)
        if relation is not None:
            whole, rest = divmod(exponent, relation[0])
            inner = power(n, Fraction(relation[1]), whole)
            return t.times(t.power(Fraction(p), rest), inner)
    if _is_written_out(p, exponent):
        return Fraction(t.polynomial_power(p, exponent))
    return _by_kernel(n, p, exponent)


def _is_written_out(p: fmpq_mpoly, exponent: int) -> bool:
    if exponent <= WRITTEN_OUT:
        return True
    return exponent <= (LARGEST_MONOMIAL if len(p) == 1 else SHORT_WRITTEN_OUT if len(p) == 2 else 0)


def _by_kernel(n: Forms, p: fmpq_mpoly, exponent: int) -> Fraction:
    """Return p^exponent = (p^M)^a·p^b with one M for all powers of p, found as in Euclid's algorithm."""
    t = n.tower
    key = ("large power", t.key(p))
    unit = n.parts.setdefault(key, exponent)
    times, rest = divmod(exponent, unit)
    if times == 0 or not _is_written_out(p, rest):
        n.parts[key] = rest
        raise Refine
    kernel = (*key, unit)
    n.arguments[kernel] = Fraction(p)
    sign = n.signs.of(p)
    if unit % 2 == 0:
        sign = "+" if sign in ("+", "-") else "0+" if n.signs.real(p) else ""
    elif not sign and n.signs.real(p):
        sign = "real"
    generator = n.atom(kernel, sign, lambda: n.expression(p) ** unit)
    return t.times(t.power(generator, times), Fraction(t.polynomial_power(p, rest)))
