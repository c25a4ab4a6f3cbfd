"""Expressions as a sheet writes them, derivatives at a place among them."""

from __future__ import annotations

from typing import cast

import sympy as sp
from sympy import Expr

from canon.expression.symbols.magnitude import written
from canon.proof.trees.sympy_types import by_name

__all__ = ["shown"]


def shown(item: object) -> str:
    """Return an expression as a sheet writes it: the derivative of V at the place q − X(t) as one by q.

    What SymPy writes for the derivative of sign(u) at u = 0, where it has none, is left out.

    Examples
    --------
    >>> q, t = sp.symbols("q t")
    >>> V, X = sp.Function("V"), sp.Function("X")
    >>> force = -V(q - X(t)).diff(q)
    >>> print(force)
    -Subs(Derivative(V(_xi_1), _xi_1), _xi_1, q - X(t))
    >>> shown(force)
    '-Derivative(V(q - X(t)), q)'
    """
    if not (isinstance(item, sp.Basic) and item.has(sp.Subs, sp.DiracDelta)):
        return written(item)
    off_the_kinks = item.replace(lambda e: isinstance(e, sp.DiracDelta), lambda _: sp.S.Zero)
    return written(off_the_kinks.replace(lambda e: isinstance(e, sp.Subs), _by_a_symbol))


def _by_a_symbol(there: sp.Subs) -> Expr:
    """Return a derivative at a place as one by a symbol on which the place depends with slope ±1, if it does."""
    derivative, places, values = there.args
    if (
        isinstance(derivative, sp.Derivative)
        and len(places.args) == 1
        and derivative.variables == places.args
    ):
        place = cast("Expr", values.args[0])
        for s in by_name(place):
            slope = place.diff(s)
            if abs(slope) == 1 and not derivative.expr.has(s):
                return slope * sp.Derivative(derivative.expr.xreplace({places.args[0]: place}), s)
    return there


def size(f: Expr) -> int:
    """Return the number of nodes of an expression, equal ones counted again.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> size(2 * x + x**2)
    7
    """
    return sum(1 for _ in sp.preorder_traversal(f))
