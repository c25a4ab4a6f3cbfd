"""Sine and cosine of one angle together, inline: no call leaves the loop, and SIMD lanes are worked out side by side.

The angle is brought to |r| ≤ π/4 by whole quarters of a turn, π/2 in two numbers (W. J. Cody, W. Waite, Software Manual
for the Elementary Functions, 1980), where Taylor's series end below rounding. Whatever rounding makes of r, sine and
cosine are those of one angle. Long doubles and pairs take the functions of their own.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.formulas import LaneFormulas

if TYPE_CHECKING:
    from canon.kernel.llvm.writer import Writer

__all__ = ["sine_and_cosine"]

_QUARTER = Fraction("1.57079632679489661923132169163975144209858469968755291048747229615390820314310449931")
"""π/2."""

_TERMS = 9
"""Terms of both series behind the first."""

_INLINE = ("float", "double")


def sine_and_cosine(w: Writer, angle: str) -> tuple[str, str]:
    """Write sin and cos of an angle."""
    number = w.number
    if number.pair or number.scalar not in _INLINE:
        return w.operation("sin", [angle]), w.operation("cos", [angle])
    f = LaneFormulas(w)
    high = number.nearest(_QUARTER)
    k = w.intrinsic("rint", f.mul(angle, w.constant(1 / _QUARTER)))
    r = f.fma(f.neg(k), w.constant(high), angle)
    r = f.fma(f.neg(k), w.constant(_QUARTER - high), r)
    square = f.mul(r, r)
    sine = f.fma(f.mul(r, square), f.polynomial(square, _series(3)), r)
    cosine = f.fma(square, f.polynomial(square, _series(2)), f.one)
    whole = w.intrinsic("floor", f.mul(k, w.constant(Fraction(1, 4))))
    quarters = f.fma(w.constant(Fraction(-4)), whole, k)
    one, two, three = (f.equal(quarters, w.constant(Fraction(n))) for n in (1, 2, 3))
    odd = f.either(one, three)
    first, second = f.select(odd, cosine, sine), f.select(odd, sine, cosine)
    return (
        f.select(f.either(two, three), f.neg(first), first),
        f.select(f.either(one, two), f.neg(second), second),
    )


def _series(first: int) -> list[Fraction]:
    """Return the factors of z⁰, z¹ … in Σ (−1)ᵏ⁺¹ zᵏ/(2k + first)!."""
    return [Fraction((-1) ** (k + 1), math.factorial(2 * k + first)) for k in range(_TERMS)]
