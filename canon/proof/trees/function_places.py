"""Places of arbitrary functions: where in an expression which function is taken, derivatives included."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.function import AppliedUndef

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from sympy import Expr

__all__ = ["at_plain_places", "outermost", "places_apart"]


def at_plain_places(expr: Expr) -> Expr:
    """Write f′ at a symbol as the derivative by that symbol: there is one way of writing it then.

    Examples
    --------
    >>> V = sp.Function("V")
    >>> a, x = sp.symbols("a x", real=True)
    >>> at_plain_places(V(x + a).diff(x).subs(a, 0) - V(x).diff(x))
    0
    """
    derived = expr.atoms(sp.Subs)
    plain = {s: s.doit() for s in derived if all(isinstance(place, sp.Symbol) for place in _point(s))}
    return cast("Expr", expr.xreplace(plain)) if plain else expr


def _point(derived: sp.Subs) -> tuple[Expr, ...]:
    return cast("tuple[Expr, ...]", tuple(cast("sp.Tuple", derived.point)))


def outermost(expr: Expr) -> list[Expr]:
    """Return the values of arbitrary functions and their derivatives that stand inside no other one.

    Examples
    --------
    >>> f, g = sp.symbols("f g", cls=sp.Function)
    >>> x = sp.Symbol("x", real=True)
    >>> outermost(x * f(g(x)) + g(x))
    [f(g(x))]
    """
    unknown = [f for f in expr.atoms(sp.Derivative, sp.Subs, AppliedUndef) if f.has(AppliedUndef)]
    return [f for f in unknown if not any(f is not g and g.has(f) for g in unknown)]


def places_apart(exprs: Iterable[Expr]) -> Iterator[tuple[AppliedUndef, AppliedUndef]]:
    """Yield pairs of values of one function that are taken at places written differently, at any depth.

    Examples
    --------
    >>> V = sp.Function("V")
    >>> a, x = sp.symbols("a x", real=True)
    >>> list(places_apart([V(x).diff(x) - V(x + a).diff(x)]))
    [(V(x), V(a + x))]
    """
    found = {value for expr in exprs for value in _values(expr)}
    by_function = sorted(found, key=sp.default_sort_key)
    for f, g in combinations(by_function, 2):
        if f.func == g.func and f.args != g.args:
            yield f, g


def _values(expr: sp.Basic) -> Iterator[AppliedUndef]:
    """Yield the values of functions at the places where they are taken; f′ at u says f(u)."""
    if isinstance(expr, sp.Subs):
        at = dict(zip(cast("tuple[Expr, ...]", expr.variables), _point(expr), strict=True))
        for value in _values(expr.expr):
            yield cast("AppliedUndef", value.subs(list(at.items()), simultaneous=True))
        for place in at.values():
            yield from _values(place)
        return
    if isinstance(expr, AppliedUndef):
        yield expr
    for part in expr.args:
        yield from _values(part)
