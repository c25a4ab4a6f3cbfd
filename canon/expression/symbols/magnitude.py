"""Magnitude bounds of numbers without computing them: too large for SymPy is known before SymPy tries."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import sympy as sp
from sympy.concrete.expr_with_limits import ExprWithLimits

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sympy import Expr

__all__ = ["MOST_DIGITS", "digits", "has_huge_number", "written"]

MOST_DIGITS = 1e5
"""Digits before or behind the point of a number that is still computed with."""

MOST_WRITTEN = 4200
"""Digits of a fraction that are written out; Python writes numbers of up to 4300."""

BINDING = (sp.Subs, sp.Lambda, ExprWithLimits)
"""What has symbols of its own, which are not free."""

_TEN = math.log(10.0)
_GROWING = (sp.exp, sp.sinh, sp.cosh, sp.csch, sp.sech)
_SLOW = (sp.log, sp.asinh, sp.acosh, sp.LambertW)


def digits(number: Expr) -> float:
    """Return about how many digits a number has before or behind the point, infinity where that is beyond floats.

    Parameters
    ----------
    number
        An expression without symbols; one with symbols is taken as if they were of order one.

    Examples
    --------
    >>> digits(sp.exp(1000) / 7)
    435.1...
    >>> digits(sp.exp(sp.exp(sp.exp(10)))), digits(sp.sin(10**50)), digits(sp.exp(sp.exp(1) / 10**9)) < 1
    (inf, 0.0, True)
    """
    return _digits(number, {})


def has_huge_number(f: sp.Basic) -> bool:
    """Tell whether a number in an expression has too many digits to be computed with.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> has_huge_number(x + sp.sin(sp.exp(sp.exp(20)))), has_huge_number(x + sp.exp(20))
    (True, False)
    """
    known: dict[sp.Basic, float] = {}
    return any(_digits(part, known) > MOST_DIGITS for part in _numbers_in(f))


def _numbers_in(f: sp.Basic) -> Iterator[sp.Expr]:
    """Yield the distinct parts without free symbols, but for those that are written as one sign."""
    free: dict[sp.Basic, bool] = {}
    stack = [(f, False)]
    while stack:
        part, ready = stack.pop()
        if part in free:
            continue
        if not part.args:
            free[part] = not part.free_symbols
        elif ready:
            bound = isinstance(part, BINDING) and not part.free_symbols
            free[part] = bound or all(map(free.__getitem__, part.args))
            if free[part] and isinstance(part, sp.Expr):
                yield part
        else:
            stack.append((part, True))
            stack.extend((inner, False) for inner in part.args)


def written(item: object) -> str:
    """Return an expression as text; the terms of a sum stay unsorted where SymPy would have to evaluate a huge number.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> written(x - 7 + sp.exp(sp.exp(sp.exp(sp.exp(10)))))
    '-7 + x + exp(exp(exp(exp(10))))'
    """
    if not isinstance(item, sp.Basic):
        return str(item)
    longest = max(map(digits, item.atoms(sp.Rational)), default=0.0)
    if longest > MOST_WRITTEN:
        return f"an expression with a number of {longest:.0f} digits"
    return str(sp.sstr(item, order="none")) if has_huge_number(item) else str(item)


def _digits(f: sp.Basic, known: dict[sp.Basic, float]) -> float:
    found = known.get(f)
    if found is None:
        found = known[f] = _fresh(f, known)
    return found


def _fresh(f: sp.Basic, known: dict[sp.Basic, float]) -> float:
    if isinstance(f, sp.Rational):
        return math.log10(max(1, abs(int(f.p)), int(f.q)))
    inside = [_digits(part, known) for part in f.args]
    if not inside:
        return 0.0
    if isinstance(f, _GROWING) or (isinstance(f, sp.Pow) and f.base is sp.E):
        return _power_of_ten(_magnitude(f.args[-1], known)) / _TEN
    if isinstance(f, sp.Pow):
        return max(inside[0], 1.0) * _size(f.exp, inside[1])
    if isinstance(f, sp.Mul):
        return sum(inside)
    if isinstance(f, _SLOW):
        return math.log10(max(1.0, inside[0] * _TEN)) if inside[0] < math.inf else 0.0
    if isinstance(f, sp.sin | sp.cos | sp.tanh | sp.atan | sp.acot | sp.sign | sp.arg):
        return 0.0
    return max(inside)


def _magnitude(f: sp.Basic, known: dict[sp.Basic, float]) -> float:
    """Return about the decimal logarithm of a number, or more; below zero only where a rational factor makes it so."""
    if isinstance(f, sp.Rational):
        return math.log10(abs(int(f.p))) - math.log10(int(f.q)) if f.p else 0.0
    return sum(_magnitude(part, known) for part in f.args) if isinstance(f, sp.Mul) else _digits(f, known)


def _size(exponent: Expr, its_digits: float) -> float:
    """Return the absolute value of an exponent."""
    return (
        abs(float(exponent))
        if isinstance(exponent, sp.Rational) and its_digits < 300
        else _power_of_ten(its_digits)
    )


def _power_of_ten(exponent: float) -> float:
    return 10.0**exponent if exponent < 300 else math.inf
