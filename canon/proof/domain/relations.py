"""Conditions of a domain one by one: taken apart, told to be linear, solved for their one symbol."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from sympy import Abs, And, Ge, Gt, Le, Lt

from canon.proof.domain.declarations import declared_complex
from canon.proof.domain.reality import certainly_real
from canon.proof.trees.affine_form import is_affine
from canon.proof.trees.sympy_types import arguments, free_symbols

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from sympy import Expr
    from sympy.core.relational import Relational
    from sympy.logic.boolalg import Boolean

__all__ = ["isolated", "linear", "parts_of", "unfolded"]


def parts_of(conditions: Iterable[Boolean]) -> Iterator[Boolean]:
    """Yield conditions one by one, what And joins taken apart."""
    for condition in conditions:
        if isinstance(condition, And):
            yield from parts_of(condition.args)
        else:
            yield condition


def linear(condition: Relational) -> bool:
    """Tell whether both sides of a relation differ by something affine in the symbols, all of them together.

    What satisfies the relation is then convex, and a whole hyperplane where it is an equality: that is proved by the
    form of the difference, as steps and atan(tan x) have constant derivatives too.

    Examples
    --------
    >>> from sympy import atan, symbols, tan
    >>> x, y = symbols("x y", real=True)
    >>> linear(x - 2*y > 1), linear(x*y > 1), linear(atan(tan(x)) > y)
    (True, False, False)
    """
    gap = cast("Expr", condition.lhs) - cast("Expr", condition.rhs)
    return is_affine(gap, free_symbols(gap))


def isolated(condition: Boolean) -> Boolean:
    """Write a linear bound on one symbol with the symbol alone on the left, others as they are.

    The bound must be affine by its form: slope·x + rest with numbers, at every x. Then, and only then, has it the same
    solutions as the bound on x alone.

    Examples
    --------
    >>> from sympy import pi, symbols
    >>> x, y = symbols("x y", real=True)
    >>> isolated(pi - 2*x >= 0), isolated(x - y > 0)
    (x <= pi/2, x - y > 0)
    """
    if not isinstance(condition, Lt | Le | Gt | Ge):
        return condition
    gap = cast("Expr", condition.lhs) - cast("Expr", condition.rhs)
    symbols = free_symbols(gap)
    if len(symbols) != 1 or condition.lhs in symbols:
        return condition
    (symbol,) = symbols
    slope = gap.diff(symbol)
    if not is_affine(gap, symbols) or not (slope.is_positive or slope.is_negative):
        return condition
    relation = type(condition) if slope.is_positive else _REVERSED[type(condition)]
    return cast("Boolean", relation(symbol, -gap.subs(symbol, 0) / slope))


_REVERSED = {Lt: Gt, Le: Ge, Gt: Lt, Ge: Le}


def unfolded(condition: Boolean) -> tuple[Boolean, ...]:
    """Return |g| < c as g < c and −g < c, which bound a symbol where g is linear; g must be certainly real."""
    if not isinstance(condition, Lt | Le | Gt | Ge) or any(map(declared_complex, free_symbols(condition))):
        return (condition,)
    less, greater = cast("Expr", condition.lts), cast("Expr", condition.gts)
    if not isinstance(less, Abs):
        return (condition,)
    relation = Lt if isinstance(condition, Lt | Gt) else Le
    (inner,) = arguments(less)
    if not certainly_real(inner):
        return (condition,)
    return cast("tuple[Boolean, ...]", (relation(inner, greater), relation(-inner, greater)))
