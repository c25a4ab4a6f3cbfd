"""Steps of time: floors and remainders of the time, written over a span as sums of single steps.

Square waves and strokes that come back, as ``t % T < T/2``, are of this kind.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, cast

import sympy as sp

from canon.expression.symbols.symbol import time

if TYPE_CHECKING:
    from sympy import Expr

__all__ = ["with_single_steps"]

MOST_STEPS = 300


def with_single_steps(rate: Expr, begin: float, end: float) -> Expr:
    """Return a function in which floors and remainders of the time are sums of steps between two times.

    Parameters
    ----------
    rate
        The function.
    begin, end
        The times, in any order.

    Raises
    ------
    TypeError
        There are very many steps.

    Examples
    --------
    >>> with_single_steps(sp.floor(time), 0.5, 2.5)
    Heaviside(t - 2) + Heaviside(t - 1)
    """
    if not rate.has(sp.floor, sp.ceiling, sp.Mod):
        return rate
    first, last = sorted((begin, end))
    found: Any = rate
    for function, written in (
        (sp.Mod, lambda a, b: a - b * sp.floor(a / b)),
        (sp.ceiling, lambda a: -sp.floor(-a)),
        (sp.floor, _unnested),
        (sp.floor, lambda u: _steps(u, first, last)),
    ):
        found = found.replace(function, written)
    return found


def _unnested(u: Expr) -> Expr:
    """Return floor(u) where u may be floor(x)/n: that is floor(x/n)."""
    n, inner = u.as_coeff_Mul()
    if isinstance(inner, sp.floor) and n.is_Rational and (1 / n).is_integer and n.is_positive:
        return sp.floor(n * inner.args[0])
    return sp.floor(u)


def _steps(u: Expr, first: float, last: float) -> Expr:
    slope = cast("Expr", u.diff(time))
    if u.free_symbols - {time} or not slope.is_Rational or slope == 0:
        return sp.floor(u)
    lowest, highest = (float(u.subs(time, t)) for t in (first, last))
    count = abs(math.floor(highest) - math.floor(lowest))
    if count > MOST_STEPS:
        raise TypeError(
            f"floor({u}) has {count} steps from t = {first:g} to {last:g}, of which {MOST_STEPS} are written out; "
            "take a shorter span, and go on from its end"
        )
    begun = math.floor(min(lowest, highest))
    levels = range(begun + 1, math.ceil(max(lowest, highest)))  # a step at the very end is beyond
    return sp.Add(begun, *(sp.Heaviside((u - k) / abs(slope)) for k in levels))
