"""Slips with symbols: one symbol for another in a function or factor, two exchanged, a derivative by another one."""

from __future__ import annotations

from itertools import chain, combinations, islice, product
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.exercise.diagnose.change import Change, Mistake
from canon.exercise.diagnose.repairs.unbuilt import Within, places
from canon.mechanics.algebra.substitution import exchanged, symbols_of
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from canon.exercise.diagnose.repairs.unbuilt import Form

__all__ = ["by_another", "exchanged_symbol", "in_one_argument", "in_one_factor", "slipped", "swapped"]

MOST_SWAPPED = 6
_of = Change.of


def slipped(expression: Expr, slip: Mapping[Expr, Expr]) -> Expr | None:
    """Return an expression with a slip put in, None where it would stand behind a d/d….

    Examples
    --------
    >>> x, f = sp.Symbol("x"), sp.Function("f")
    >>> slipped(x + x**2, {x: -x}), slipped(f(x).diff(x), {x: -x})
    (x**2 - x, None)
    """
    try:
        return exchanged(expression, dict(slip))
    except (TypeError, ValueError):  # such as a derivative by −x, or a comparison with i
        return None


def exchanged_symbol(node: Expr, symbols: Sequence[Symbol]) -> Iterator[tuple[Form, Change]]:
    """One symbol for another in one function, or as one factor."""
    if node.is_Function:
        for changed in _with_another_symbol(node, symbols):
            yield changed, _of(Mistake.SYMBOL, node, changed)
    if not (node.is_Mul or node.is_Add):
        return
    for place in places(node):
        old = place.operand
        for changed in (
            _with_another_symbol(old, symbols) if old.is_Function or old.is_Pow or old.is_Symbol else ()
        ):
            yield Within(place, changed), _of(Mistake.SYMBOL, old, changed)


def _with_another_symbol(f: Expr, symbols: Sequence[Symbol]) -> Iterator[Expr]:
    for old, new in product(symbols_of(f), symbols):
        changed = slipped(f, {old: new}) if new != old else None
        if changed is not None:
            yield changed


def in_one_factor(node: Expr, symbols: Sequence[Symbol]) -> Iterator[tuple[Expr, Change]]:
    """One symbol for another in one factor of a power: x² for x ẋ."""
    base, exponent = node.as_base_exp()
    if base.is_Symbol and exponent.is_Integer and exponent > 1:
        for new in symbols:
            if new != base:
                right = node / base * new
                yield right, _of(Mistake.SYMBOL, node, right)


def in_one_argument(node: Expr, symbols: Sequence[Symbol]) -> Iterator[tuple[Expr, Change]]:
    """One symbol for another as one argument of a function of several."""
    places = arguments(node) if isinstance(node, AppliedUndef) and len(node.args) > 1 else ()
    for i, place in enumerate(places):
        for new in symbols if place.is_Symbol else ():
            if new != place:
                right = node.func(*places[:i], new, *places[i + 1 :])
                yield right, _of(Mistake.SYMBOL, node, right)


def by_another(node: Expr) -> Iterator[tuple[Expr, Change]]:
    """The derivative by another argument of the function."""
    if isinstance(node, sp.Derivative) and len(node.variables) == 1:
        f = arguments(node)[0]
        for other in symbols_of(*(a for a in arguments(f) if a.is_Symbol)):
            if other != node.variables[0]:
                right = sp.Derivative(f, other)
                yield right, _of(Mistake.VARIABLE_OF_DERIVATIVE, node, right)


def swapped(node: Expr) -> Iterator[tuple[Expr, Change]]:
    """Two symbols exchanged in one sum."""
    if node.is_Add:
        symbols = symbols_of(node)
        few, alike = combinations(symbols[:MOST_SWAPPED], 2), _alike(symbols[MOST_SWAPPED:], symbols)
        for a, b in chain(few, islice(alike, MOST_SWAPPED)):
            new = slipped(node, {a: b, b: a})
            if new is not None and new != node:
                yield new, _of(Mistake.SYMBOLS_EXCHANGED, node, a, b)


def _alike(symbols: Sequence[Symbol], among: Sequence[Symbol]) -> Iterator[tuple[Symbol, Symbol]]:
    """Yield pairs of symbols that differ in a figure, as θ1 and θ2, one of them among the first."""
    for b in symbols:
        same = (a for a in among if a.name < b.name and _bare(a) == _bare(b))
        yield from ((a, b) for a in same if type(a) is type(b))


def _bare(symbol: Symbol) -> str:
    return symbol.name.translate(str.maketrans("", "", "0123456789"))
