"""Signs of trigonometric polynomials in one angle, proved on the range of the angle."""

from __future__ import annotations

from math import comb
from typing import TYPE_CHECKING, Any

import sympy as sp
from flint import fmpq

from canon.proof.trees.sympy_types import rational

if TYPE_CHECKING:
    from flint import fmpq_mpoly
    from sympy import Expr

    from canon.proof.tower.forms import Forms
    from canon.proof.tower.lattice import Angle

__all__ = ["sign_of_polynomial", "sign_of_wave"]

HIGHEST = 64
"""Degree of a polynomial in cosine and sine that is still written in multiples of the angle."""


def sign_of_polynomial(n: Forms, p: fmpq_mpoly) -> str:
    """Return the sign of a polynomial in cos φ and sin φ that is m + a cos kφ + b sin kφ, if it has one.

    With m² ≥ a² + b² it has that of m; with m = 0 that of one wave on the range of φ.
    """
    kernels = [n.tower.generators[k] for k in n.tower.used(p)]
    if not kernels or any(kernel[0] not in ("cos", "sin") for kernel in kernels):
        return ""
    angle = kernels[0][1]
    if any(kernel[1] != angle for kernel in kernels) or angle not in n.ranges or p.total_degree() > HIGHEST:
        return ""
    cosines, sines = _multiples(n, p)
    mean = cosines.pop(0, fmpq(0))
    frequencies = {k for waves in (cosines, sines) for k, c in waves.items() if c != 0}
    if len(frequencies) != 1:
        return ""
    (times,) = frequencies
    a, b = cosines.get(times, fmpq(0)), sines.get(times, fmpq(0))
    if mean == 0:
        return sign_of_wave(n, angle, a, b, times)
    gap = mean * mean - a * a - b * b
    return "" if gap < 0 else ("0" if gap == 0 else "") + ("+" if mean > 0 else "-")


def _multiples(n: Forms, p: fmpq_mpoly) -> tuple[dict[int, fmpq], dict[int, fmpq]]:
    """Return the coefficients of cos kφ and sin kφ: 2ᵐ cosᵐφ = Σ C(m, j) cos (m − 2j)φ, s² = 1 − c² being used up."""
    cosines: dict[int, fmpq] = {}
    sines: dict[int, fmpq] = {}
    for monomial, coefficient in n.tower.terms(n.tower.reduce(p)):
        powers = {n.tower.generators[k][0]: e for k, e in monomial}
        m = powers.get("cos", 0)
        for j in range(m + 1):
            k, c = m - 2 * j, coefficient * fmpq(comb(m, j), 2**m)
            if "sin" not in powers:
                cosines[abs(k)] = cosines.get(abs(k), fmpq(0)) + c
                continue
            for multiple in (k + 1, 1 - k):  # 2 cos kφ sin φ = sin (k + 1)φ + sin (1 − k)φ
                if multiple:
                    signed = c / 2 if multiple > 0 else -c / 2
                    sines[abs(multiple)] = sines.get(abs(multiple), fmpq(0)) + signed
    return cosines, sines


def sign_of_wave(n: Forms, angle: Angle, a: Any, b: Any, times: int = 1) -> str:
    """Return the sign of a cos kφ + b sin kφ = R cos(kφ − δ), R > 0, on the range of φ, if it has one."""
    low, high, strict = n.ranges.get(angle, (-sp.oo, sp.oo, True))
    if not (low.is_finite and high.is_finite):
        return ""
    shift = sp.atan2(_rational(b), _rational(a))
    return _sign_between(times * low - shift, times * high - shift, -sp.pi / 2, strict=strict)


def _rational(number: Any) -> sp.Rational:
    return rational(
        sp.Rational(int(number.p), int(number.q)) if isinstance(number, fmpq) else sp.Rational(number)
    )


def _sign_between(low: Expr, high: Expr, rise: Expr, *, strict: bool) -> str:
    """Return the sign on [low, high] of a function like cos that is positive on (rise, rise + π), then negative."""
    turn = sp.floor((low - rise) / sp.pi)
    start = rise + turn * sp.pi
    end = start + sp.pi
    if not (turn.is_Integer and (low - start).is_nonnegative and (end - high).is_nonnegative):
        return ""
    sign = "+" if turn.is_even else "-"
    inside = (low - start).is_positive and (end - high).is_positive
    return sign if strict or inside else "0" + sign
