"""Simultaneous substitution, also in derivatives of arbitrary functions."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Mapping, Set
from typing import TYPE_CHECKING, Any, cast

import sympy as sp
from sympy import Expr

from canon.expression.symbols.user_input import given_expression

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy.logic.boolalg import Boolean

__all__ = [
    "MOST_TERMS",
    "as_tuple",
    "carried",
    "entry",
    "exchanged",
    "refuse_unordered",
    "shortened",
    "size",
    "substitute",
    "symbols_of",
    "symbols_within",
    "terms_if_expanded",
]

MOST_TERMS = 150
"""How many terms, multiplied out, SymPy's polynomials are asked for: gcd and resultant of larger ones take minutes."""

_LOG_OF_MANY = 40.0
"""The logarithm of a number of terms that no memory holds."""


def substitute(f: Expr, values: Mapping[sp.Symbol, Expr]) -> Expr:
    """Return f with every symbol replaced at once.

    Where f holds a derivative V′(x) of an arbitrary function and x is replaced by an expression, the
    derivative becomes SymPy's ``Subs``: V′ at that place, not the derivative by that place.

    Examples
    --------
    >>> from sympy import symbols
    >>> q, p = symbols("q p")
    >>> substitute(q - 2*p, {q: p, p: q})
    p - 2*q
    """
    mapping = [(old, new) for old, new in values.items() if old != new]
    if f.has(sp.Derivative, sp.Subs, sp.Integral):
        return f.subs(mapping, simultaneous=True)
    return cast("Expr", f.xreplace(dict(mapping)))


def exchanged(f: Expr, values: Mapping[Any, Expr]) -> Expr:
    """Return f with whole subexpressions exchanged for others, as they stand."""
    return cast("Expr", f.xreplace(values))


def carried(conditions: Sequence[Boolean], values: Mapping[Any, Expr]) -> tuple[Boolean, ...]:
    """Return what conditions say where symbols have these values, without those that say nothing there.

    Examples
    --------
    >>> from sympy import symbols
    >>> Q, q = symbols("Q", real=True), symbols("q", positive=True)
    >>> carried([Q > 0, Q < 1], {Q: 2*q})
    (2*q < 1,)
    """
    there = (cast("Boolean", c.xreplace(values)) for c in conditions)
    return tuple(c for c in there if c != sp.true)


def entry(matrix: sp.MatrixBase, i: int, j: int) -> Expr:
    """Return one entry of a matrix as an expression."""
    return cast("Expr", matrix[i, j])


def as_tuple(given: Sequence[Expr] | sp.MatrixBase | Expr) -> tuple[Expr, ...]:
    """Return one expression, or several, in a list or a matrix of one row or column, as a tuple of expressions."""
    if isinstance(given, sp.MatrixBase):  # an immutable one is an Expr as well
        return (
            tuple(given_expression(f) for f in given.flat())
            if 1 in given.shape
            else (given_expression(given),)
        )
    if isinstance(given, Expr):
        return (given,)
    refuse_unordered(given)
    if not hasattr(given, "__iter__") or isinstance(given, str):
        return (given_expression(given),)
    return tuple(given_expression(f) for f in given)


def refuse_unordered(given: object) -> None:
    """Refuse a dictionary or a set in the place of a list: by its keys or members nothing is known to be meant.

    Raises
    ------
    TypeError
        It is one.

    Examples
    --------
    >>> refuse_unordered([1, 2])
    >>> refuse_unordered({1, 2})
    Traceback (most recent call last):
        ...
    TypeError: {1, 2}: members of a set have no order that says which is whose; give a list, in the order of the co...
    """
    if isinstance(given, Mapping | Set):
        kind = "keys of a dictionary" if isinstance(given, Mapping) else "members of a set"
        raise TypeError(
            f"{reprlib.repr(given)}: {kind} have no order that says which is whose; give a list, in the order of the "
            "coordinates"
        )


def terms_if_expanded(f: sp.Basic) -> float:
    """Return how many terms there are at most where an expression is multiplied out, here or in one of its parts.

    Examples
    --------
    >>> from sympy.abc import x, y
    >>> terms_if_expanded((x + y) ** 3 * (x + 1)), terms_if_expanded((x + y) ** 900)
    (16.0, inf)
    """
    return _terms(f, {})


def _terms(f: sp.Basic, known: dict[sp.Basic, float]) -> float:
    if f not in known:
        parts = [_terms(part, known) for part in f.args]
        if isinstance(f, sp.Add):
            known[f] = math.fsum(parts)
        elif isinstance(f, sp.Mul):
            known[f] = math.prod(parts)
        elif isinstance(f, sp.Pow) and f.base.is_Add and f.exp.is_Integer:
            few = math.log(parts[0]) * abs(int(f.exp)) < _LOG_OF_MANY
            known[f] = parts[0] ** abs(int(f.exp)) if few else math.inf
        else:
            known[f] = max((1.0, *parts))
    return known[f]


def shortened(F: Expr) -> Expr:
    """Return the shortest of a few plain forms of F: as it stands, over one denominator, multiplied out."""
    if size(F) > 350 or terms_if_expanded(F) > MOST_TERMS:
        return F
    return min((F, sp.factor_terms(F), sp.expand(F), sp.cancel(sp.together(F))), key=size)


def size(f: sp.Basic) -> int:
    """Return the number of nodes of the expression tree, walking parts that occur often only once.

    Examples
    --------
    >>> from sympy import symbols
    >>> x, y = symbols("x y")
    >>> size(x + 2*y)
    5
    """
    sizes: dict[sp.Basic, int] = {}
    stack: list[sp.Basic] = [f]
    while stack:
        node = stack[-1]
        open_ = [part for part in node.args if part not in sizes]
        if open_:
            stack.extend(open_)
        else:
            sizes[node] = 1 + sum(sizes[part] for part in node.args)
            stack.pop()
    return sizes[f]


def symbols_within(f: sp.Basic, known: dict[sp.Basic, frozenset[sp.Symbol]]) -> frozenset[sp.Symbol]:
    """Return the free symbols of an expression, walking parts that occur often only once.

    Parameters
    ----------
    f
        The expression.
    known
        The symbols of parts, of other expressions too; what is found is added.

    Examples
    --------
    >>> from sympy import Integral, cos, symbols
    >>> x, y = symbols("x y")
    >>> sorted(symbols_within(x * cos(y) + Integral(y**2, y), {}), key=str)
    [x, y]
    """
    stack: list[sp.Basic] = [f]
    while stack:
        node = stack[-1]
        walked = isinstance(node, sp.Add | sp.Mul | sp.Pow | sp.Function)
        open_ = [part for part in node.args if part not in known] if walked else []
        if open_:
            stack.extend(open_)
        else:
            own = [known[part] for part in node.args] if walked else [frozenset(node.free_symbols)]
            known[node] = frozenset[sp.Symbol]().union(*own)  # pyright: ignore[reportArgumentType]
            stack.pop()
    return known[f]


def symbols_of(*expressions: Expr) -> list[sp.Symbol]:
    """Return the symbols of some expressions by name."""
    found = {s for f in expressions for s in f.free_symbols if isinstance(s, sp.Symbol)}
    return sorted(found, key=lambda s: s.name)
