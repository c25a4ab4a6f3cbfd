"""Expressions that differ from a given one by one slip: a sign, a factor, a function, an exponent, a symbol."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from fractions import Fraction

__all__ = ["common_slips", "times", "variants"]

_FACTORS = tuple(map(sp.Rational, ("2", "1/2", "4", "1/4", "3", "1/3")))
_TWINS = {
    sp.sin: sp.cos, sp.cos: sp.sin, sp.tan: sp.cot, sp.cot: sp.tan, sp.sinh: sp.cosh, sp.cosh: sp.sinh,
    sp.asin: sp.acos, sp.acos: sp.asin, sp.atan: sp.acot, sp.acot: sp.atan, sp.sec: sp.csc, sp.csc: sp.sec,
    sp.asinh: sp.acosh, sp.acosh: sp.asinh, sp.elliptic_k: sp.elliptic_e, sp.elliptic_e: sp.elliptic_k,
}  # fmt: skip


def variants(expression: Expr, symbols: Sequence[Symbol] = ()) -> Iterator[tuple[Expr, str]]:
    """Yield expressions that differ in one place, likely slips first, with the change in words.

    Parameters
    ----------
    expression
        What was written.
    symbols
        What may have been meant in place of a symbol.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> [str(new) for new, change in variants(sp.sin(x) - y) if "sin" in change]
    ['-y - sin(x)', '-y + cos(x)', '-y - sin(x)', '-y + sin(2*x)', '-y + sin(x/2)']
    """

    def exchanged(node: Expr) -> Iterator[tuple[Expr, str]]:
        return _exchanged(node, symbols)

    def multiplied(node: Expr) -> Iterator[tuple[Expr, str]]:
        return _multiplied(node, symbols)

    for edits in (_signs, _functions, _factors, _exponents, _dropped, exchanged, multiplied):
        yield from _one_place(expression, edits)
    if not expression.is_Add:
        for symbol in symbols:
            yield expression * symbol, f"{expression} lacks the factor {symbol}"
            yield expression / symbol, f"{expression} should be divided by {symbol}"
    yield from _everywhere(expression, symbols)


def common_slips(
    expressions: Sequence[Expr], symbols: Sequence[Symbol]
) -> Iterator[tuple[Mapping[Expr, Expr], str]]:
    """Yield substitutions that a person may have got wrong in all components of an answer alike."""
    own = sorted(set[Expr]().union(*(e.free_symbols for e in expressions)), key=str)
    for symbol in own:
        yield {symbol: -symbol}, f"the sign of {symbol} is wrong everywhere"
    functions = sorted(set[Expr]().union(*(e.atoms(sp.Function) for e in expressions)), key=str)
    for f in functions:
        yield {f: -f}, f"the sign of {f} is wrong everywhere"
        if (twin := _TWINS.get(f.func)) is not None:
            yield {f: twin(*f.args)}, f"{f} should be {twin(*f.args)} everywhere"
    for symbol in own:
        for factor in (*_FACTORS[:2], *(power for s in symbols if s != symbol for power in (s, 1 / s))):
            yield {symbol: factor * symbol}, f"{symbol} should be {factor * symbol} everywhere"


def times(factor: Fraction | sp.Rational) -> str:
    """Return a factor in words: half, twice, 3/2 times.

    Examples
    --------
    >>> times(sp.Rational(1, 2)), times(sp.Rational(3, 2))
    ('half', '3/2 times')
    """
    return {"1/2": "half", "2": "twice", "-1": "minus"}.get(str(factor), f"{factor} times")


def _one_place(
    expression: Expr, edits: Callable[[Expr], Iterator[tuple[Expr, str]]]
) -> Iterator[tuple[Expr, str]]:
    """Apply an edit at one place of the tree at a time, equal subexpressions elsewhere left alone."""
    yield from edits(expression)
    arguments = expression.args
    for i, argument in enumerate(arguments):
        if isinstance(argument, Expr) and not argument.is_Number:
            for new, change in _one_place(argument, edits):
                yield expression.func(*arguments[:i], new, *arguments[i + 1 :]), change


def _signs(node: Expr) -> Iterator[tuple[Expr, str]]:
    if node.is_Add:
        for term in node.args:
            yield node - 2 * term, f"the sign of {term} is wrong"


def _factors(node: Expr) -> Iterator[tuple[Expr, str]]:
    if node.is_Add:
        for term in node.args:
            for factor in _FACTORS:
                yield node + (factor - 1) * term, f"the term {term} should be {times(factor)} that"


def _functions(node: Expr) -> Iterator[tuple[Expr, str]]:
    twin = _TWINS.get(node.func)
    if twin is not None and len(node.args) == 1:
        yield twin(*node.args), f"{node} should be {twin(*node.args)}"
    if node.func in _TWINS or isinstance(node, sp.exp):
        for factor in (sp.S.NegativeOne, sp.Rational(2), sp.Rational(1, 2)):
            new = node.func(factor * node.args[0])
            yield new, f"{node} should be {new}"


def _exponents(node: Expr) -> Iterator[tuple[Expr, str]]:
    if node.is_Add or node.is_Mul or node.is_Number:
        if node.is_Add:
            yield node**2, f"{node} should be squared"
        return
    base, exponent = node.as_base_exp()
    if exponent.is_Rational:
        for other in dict.fromkeys((2 * exponent, exponent / 2, exponent + 1, exponent - 1, -exponent)):
            if other != 0:
                yield base**other, f"{node} should be {base**other}"
    if exponent == 2:
        yield base * sp.Abs(base), f"{node} should be {base * sp.Abs(base)}"
    if node.is_Symbol and not node.is_positive:
        yield sp.Abs(node), f"{node} should be Abs({node})"


def _dropped(node: Expr) -> Iterator[tuple[Expr, str]]:
    if node.is_Add:
        for term in node.args:
            yield node - term, f"the term {term} does not belong"
    if node.is_Mul:
        for factor in node.args:
            if not factor.is_Number:
                yield node / factor, f"the factor {factor} of {node} does not belong"


def _exchanged(node: Expr, symbols: Sequence[Symbol]) -> Iterator[tuple[Expr, str]]:
    """One symbol for another in one function, or as one factor."""
    places = node.args if node.is_Mul or node.is_Add else (node,) if node.is_Function else ()
    for place in places:
        for old in (
            sorted(place.free_symbols, key=str)
            if place.is_Function or place.is_Pow or place.is_Symbol
            else ()
        ):
            for new in symbols:
                if new != old:
                    changed = place.xreplace({old: new})
                    rest = (
                        node.func(*(changed if p == place else p for p in node.args))
                        if place != node
                        else changed
                    )
                    yield rest, f"{place} should be {changed}"


def _multiplied(node: Expr, symbols: Sequence[Symbol]) -> Iterator[tuple[Expr, str]]:
    if node.is_Add:
        for term in node.args:
            for symbol in symbols:
                yield node - term + term * symbol, f"the term {term} lacks the factor {symbol}"
                yield node - term + term / symbol, f"the term {term} should be divided by {symbol}"


def _everywhere(expression: Expr, symbols: Sequence[Symbol]) -> Iterator[tuple[Expr, str]]:
    """The same slip in all places at once."""
    for old, new in chain(
        ((a, b) for a in sorted(expression.free_symbols, key=str) for b in symbols if a != b),
        (
            (f, twin(*f.args))
            for f in sorted(expression.atoms(sp.Function), key=str)
            if (twin := _TWINS.get(f.func))
        ),
    ):
        yield expression.xreplace({old: new}), f"{old} should be {new} everywhere"
