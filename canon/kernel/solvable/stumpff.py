"""Stumpff's functions c₂ and c₃, and G_k(X) = Xᵏ c_k(βX²) made of them.

c_k(z) = Σ (−z)ʲ/(2j + k)!; c₂(4z) = c₁(z)²/2 and c₃(4z) = (c₂(z) + c₀(z) c₃(z))/4 lead back from arguments that the
series reach, with c₀ = 1 − zc₂ and c₁ = 1 − zc₃.

Source: J. M. A. Danby, Fundamentals of Celestial Mechanics (2nd ed., Willmann-Bell 1988), § 6.9.
"""

from __future__ import annotations

import itertools
import math
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.formulas import LaneFormulas

if TYPE_CHECKING:
    from canon.kernel.llvm.writer import Writer

__all__ = ["REACH", "further_stumpff", "stumpff", "stumpff_series"]

REACH = Fraction(5, 2)
"""Stumpff's functions are summed as power series up to this |z|, and reached from there by quartering z."""

_QUARTERINGS = 30
"""From |z| = 2.5 · 4³⁰ the cosh of √|z| is beyond doubles anyhow."""


def stumpff(w: Writer, v: Writer, beta: str, x: str) -> tuple[str, str]:
    """Write G₂ = X² c₂(βX²) and G₃ = X³ c₃(βX²) for any X."""
    c = LaneFormulas(v)
    square = c.mul(x, x)
    argument, second, third, count = (v.array(1) for _ in range(4))
    v.store(c.mul(beta, square), argument, 0)
    v.store(c.zero, count, 0)
    with w.loop(0, _QUARTERINGS):
        z = v.load(argument, 0)
        small = c.at_most(c.abs(z), c.number(REACH))
        w.leave_if(c.all(small))
        v.store(c.select(small, z, c.mul(z, c.number(Fraction(1, 4)))), argument, 0)
        v.store(c.add(v.load(count, 0), c.select(small, c.zero, c.one)), count, 0)
    z = v.load(argument, 0)
    for value, where in zip(stumpff_series(c, z), (second, third), strict=True):
        v.store(value, where, 0)
    with w.loop(0, _QUARTERINGS):
        left = v.load(count, 0)
        done = c.equal(left, c.zero)
        w.leave_if(c.all(done))
        z, c2, c3 = v.load(argument, 0), v.load(second, 0), v.load(third, 0)
        c0, c1 = c.fma(c.neg(z), c2, c.one), c.fma(c.neg(z), c3, c.one)
        new = (
            (second, c2, c.mul(c.number(Fraction(1, 2)), c.mul(c1, c1))),
            (third, c3, c.mul(c.number(Fraction(1, 4)), c.fma(c0, c3, c2))),
            (argument, z, c.mul(z, c.number(Fraction(4)))),
            (count, left, c.sub(left, c.one)),
        )
        for where, old, quadrupled in new:
            v.store(c.select(done, old, quadrupled), where, 0)
    return c.mul(square, v.load(second, 0)), c.mul(c.mul(square, x), v.load(third, 0))


def stumpff_series(c: LaneFormulas, z: str) -> tuple[str, str]:
    """Write c₂(z) and c₃(z) for |z| ≤ REACH."""
    return _series(c, z, 2), _series(c, z, 3)


def further_stumpff(c: LaneFormulas, beta: str, x: str, g2: str, g3: str) -> tuple[str, str]:
    """Write G₄ and G₅ for any X: by their series up to REACH, and beyond by βG_{k+2} = Xᵏ/k! − G_k."""
    square = c.mul(x, x)
    z = c.mul(beta, square)
    near = c.at_most(c.abs(z), c.number(REACH))
    small, per = c.select(near, z, c.zero), c.div(c.one, c.select(near, c.one, beta))
    fourth = c.mul(c.mul(square, square), _series(c, small, 4))
    fifth = c.mul(c.mul(c.mul(square, square), x), _series(c, small, 5))
    far = c.mul(per, c.fma(c.number(Fraction(1, 2)), square, c.neg(g2)))
    farther = c.mul(per, c.fma(c.number(Fraction(1, 6)), c.mul(square, x), c.neg(g3)))
    return c.select(near, fourth, far), c.select(near, fifth, farther)


def _series(c: LaneFormulas, z: str, first: int) -> str:
    """Write c_first(z), even and odd powers apart: two short chains instead of a long one.

    What the numbers lack of the first coefficients goes in too: always the same, it would make the energy drift.
    """
    kind = c.writer.number
    exact = [Fraction((-1) ** k, math.factorial(2 * k + first)) for k in range(_terms(first, kind.mantissa))]
    lacking = [value - kind.nearest(value) for value in exact[:3]]
    z2 = c.mul(z, z)
    even = c.fma(c.polynomial(z2, exact[2::2]), z2, c.polynomial(z, lacking))
    return c.add(c.number(exact[0]), c.fma(c.polynomial(z2, exact[1::2]), z, even))


def _terms(first: int, mantissa: int) -> int:
    """Return how many terms to sum: the first one left out is so small that the energy does not drift by it.

    It has always the same sign: where it is a fifth of a rounding unit of the sum at REACH, steps of a fifth of a
    period and more make the energy drift, hidden at first by the random walk of the rounding.
    """
    limit = Fraction(1, 200 * 2**mantissa)
    return next(
        n
        for n in itertools.count(4)
        if REACH**n * math.factorial(first) < limit * math.factorial(2 * n + first)
    )
