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

__all__ = ["sine_and_cosine", "turning_functions"]

_QUARTER = Fraction("1.57079632679489661923132169163975144209858469968755291048747229615390820314310449931")
"""π/2."""

_TERMS = 9
"""Terms of both series behind the first."""

_DOUBLE, _MANY_TERMS = 53, 15
"""Bits of doubles, and the terms that wider numbers take."""

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


def turning_functions(w: Writer, beta: str, t: str) -> tuple[str, str, str, str]:
    """Write G₁ = sin ωt/ω and G₂ = (1 − cos ωt)/ω², then their derivatives by β = ω² ≥ 0.

    With G₃ = (t − G₁)/β and G₄ = (t²/2 − G₂)/β, which are summed as series where βt² ≤ 1, ∂G₁/∂β = ½(G₃ − tG₂) and
    ∂G₂/∂β = G₄ − ½tG₃.
    """
    f = LaneFormulas(w)
    square, half = f.mul(t, t), w.constant(Fraction(1, 2))
    z = f.mul(beta, square)
    near = f.at_most(z, f.one)
    safe = f.select(near, f.one, beta)
    speed, per = f.sqrt(safe), f.div(f.one, safe)
    sine, cosine = sine_and_cosine(w, f.mul(speed, t))
    small = f.select(near, z, f.zero)
    terms = _TERMS if w.number.mantissa <= _DOUBLE else _MANY_TERMS
    third = f.mul(f.neg(f.mul(square, t)), f.polynomial(small, _series(3, terms)))
    fourth = f.mul(f.neg(f.mul(square, square)), f.polynomial(small, _series(4, terms)))
    halved, less = f.mul(half, square), f.neg(beta)
    g1 = f.select(near, f.fma(less, third, t), f.div(sine, speed))
    g2 = f.select(near, f.fma(less, fourth, halved), f.mul(per, f.sub(f.one, cosine)))
    g3 = f.select(near, third, f.mul(per, f.sub(t, g1)))
    g4 = f.select(near, fourth, f.mul(per, f.sub(halved, g2)))
    return g1, g2, f.mul(half, f.fma(f.neg(t), g2, g3)), f.fma(f.neg(f.mul(half, t)), g3, g4)


def _series(first: int, terms: int = _TERMS) -> list[Fraction]:
    """Return the factors of z⁰, z¹ … in Σ (−1)ᵏ⁺¹ zᵏ/(2k + first)!."""
    return [Fraction((-1) ** (k + 1), math.factorial(2 * k + first)) for k in range(terms)]
