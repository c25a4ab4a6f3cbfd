"""Periods of integer symbols: after how many whole numbers angles πn/d and powers of roots of unity come back."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sympy import Expr, Symbol

__all__ = ["period_of"]


def period_of(expr: Expr, n: Symbol) -> int:
    """Return a period of the angles πp(n)/d and of powers of numbers, p whole polynomials; 1 where all is a sign.

    p(n + 2d) − p(n) is a multiple of 2d. Linear angles πn need no period: (−1)ⁿ is a kernel of its own.

    Examples
    --------
    >>> n = sp.Symbol("n", integer=True)
    >>> period_of(sp.I**n, n), period_of(sp.cos(sp.pi*n/3), n), period_of((-1)**n, n)
    (4, 6, 1)
    """
    period = 1
    for turns in _turns(expr):
        slope = turns.diff(n)
        if isinstance(slope, sp.Rational):
            period = int(sp.ilcm(period, 2 * slope.q)) if slope.q > 1 else period
        elif turns.is_polynomial(n):
            coefficients = sp.Poly(turns, n).all_coeffs()[:-1]
            if all(isinstance(c, sp.Rational) for c in coefficients):
                whole = int(sp.ilcm(1, *(c.q for c in coefficients)))
                if whole > 1 or any(c % 2 for c in coefficients[:-1]):
                    period = int(sp.ilcm(period, 2 * whole))
    return period


def _turns(expr: Expr) -> Iterator[Expr]:
    """Yield the angles, in half turns, of sines and cosines and of powers of numbers in an expression."""
    for turned in expr.atoms(sp.sin, sp.cos, sp.tan, sp.cot, sp.sec, sp.csc):
        yield arguments(turned)[0] / sp.pi
    for power in expr.atoms(sp.Pow, sp.exp):
        if isinstance(power, sp.exp):
            yield sp.expand(arguments(power)[0] / (sp.pi * sp.I))
        elif power.base.is_number and not power.base.is_positive and not power.exp.is_number:
            turns = sp.arg(power.base) / sp.pi
            if isinstance(turns, sp.Rational):
                yield sp.expand(power.exp * turns)
