"""Affine expressions: told by their form, as a constant derivative does not show it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

if TYPE_CHECKING:
    from collections.abc import Iterable

    from sympy import Expr, Symbol

__all__ = ["has_affine_form", "is_affine"]


def is_affine(expr: Expr, symbols: Iterable[Symbol]) -> bool:
    """Tell whether an expression is affine in some symbols as it is written, or once it is multiplied out.

    Its value is then Σ slope·s + rest at *all* values of the symbols, with slopes and a rest that are free of them.
    That its derivatives are constant would not do: atan(tan x) has the slope 1 and a step the slope 0 wherever they
    have any.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> is_affine(2 * x + y**2, [x]), is_affine(x * (1 + y) - x * y, [x, y])
    (True, True)
    >>> is_affine(sp.atan(sp.tan(x)), [x]), is_affine(x + sp.Piecewise((2, x > 1), (0, True)), [x])
    (False, False)
    """
    varying = {s for s in symbols if expr.has(s)}
    if has_affine_form(expr, varying):
        return True
    if not expr.is_polynomial(*varying) or any(expr.diff(s).diff(s) != 0 for s in varying):
        return False
    return has_affine_form(sp.expand(expr), varying)


def has_affine_form(expr: sp.Basic, symbols: set[Symbol]) -> bool:
    """Tell whether the form of an expression shows that it is affine: sums of what holds a symbol in one factor.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> has_affine_form(y * (x + 1), {x}), has_affine_form(x * (x + 1) - x**2, {x})
    (True, False)
    """
    if not expr.free_symbols & symbols or expr in symbols:
        return True
    if isinstance(expr, sp.Mul):
        moving = [factor for factor in expr.args if factor.free_symbols & symbols]
        return len(moving) == 1 and has_affine_form(moving[0], symbols)
    return isinstance(expr, sp.Add) and all(has_affine_form(term, symbols) for term in expr.args)
