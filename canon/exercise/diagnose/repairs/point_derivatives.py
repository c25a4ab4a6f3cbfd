"""Values and slopes of expressions at a point, from differences at a very small distance.

With balls of a few hundred bits a difference quotient is right to thirty digits, enough to tell a wrong
candidate at once. What passes is proved elsewhere: nothing is ever decided here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import acb, arb
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef, Derivative, Subs

from canon.exercise.diagnose.repairs.unbuilt import Joined, Values, Within
from canon.mechanics.algebra.substitution import exchanged
from canon.proof.domain.balls import Unmodelled, value
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from canon.exercise.diagnose.repairs.unbuilt import Form

__all__ = ["BITS", "Examples", "Neighbourhood", "small"]

BITS = 320
STEP = arb(2) ** -100
TOLERANCE = arb(2) ** -60


class Examples:
    """Polynomials put for the arbitrary functions, the same ones in every expression."""

    def __init__(self, expressions: Iterable[Expr]) -> None:
        applied = {a for e in expressions for a in e.atoms(AppliedUndef)}
        self._polynomials = {
            a.func: _polynomial(a, number) for number, a in enumerate(sorted(applied, key=str), 1)
        }
        self._known: dict[sp.Basic, Expr] = {}
        self._symbols: dict[sp.Basic, frozenset[sp.Basic]] = {}

    def unknowns(self, f: Expr) -> list[Expr]:
        """Return the arbitrary functions and derivatives of an expression, not those inside others."""
        if not self._polynomials and not f.has(Derivative, Subs):
            return []
        walk, found = sp.preorder_traversal(f), list[Expr]()
        for node in walk:
            if isinstance(node, AppliedUndef | Derivative | Subs):
                walk.skip()
                found.append(node)
        return found

    def symbols(self, f: sp.Basic) -> frozenset[sp.Basic]:
        """Return the free symbols of an expression; those of a part that several candidates share are found once."""
        found = self._symbols.get(f)
        if found is None:
            plain = bool(f.args) and isinstance(f, sp.Add | sp.Mul | sp.Pow)
            found = frozenset().union(*map(self.symbols, f.args)) if plain else frozenset(f.free_symbols)
            self._symbols[f] = found
        return found

    def __getitem__(self, unknown: Expr) -> Expr:
        """Return what a function, or a derivative of it, is in the example."""
        found = self._known.get(unknown)
        if found is None:
            found = self._known[unknown] = self._example(unknown)
        return found

    def _example(self, unknown: Expr) -> Expr:
        if isinstance(unknown, Subs):
            inner, variables, points = cast("tuple[Expr, tuple[Expr, ...], tuple[Expr, ...]]", unknown.args)
            return exchanged(self._example(inner), dict(zip(variables, points, strict=True)))
        if isinstance(unknown, AppliedUndef):
            places, polynomial = self._polynomials[unknown.func]
            return exchanged(polynomial, dict(zip(places, arguments(unknown), strict=True)))
        inner, *rest = arguments(unknown)
        by = cast("list[tuple[Symbol, int]]", rest)
        if isinstance(inner, AppliedUndef) and _by_places(inner, [s for s, _ in by]):
            places, polynomial = self._polynomials[inner.func]
            slope = polynomial.diff(*((places[arguments(inner).index(s)], n) for s, n in by))
            return exchanged(slope, dict(zip(places, arguments(inner), strict=True)))
        for node in inner.atoms(AppliedUndef):
            inner = exchanged(inner, {node: self._example(node)})
        return inner.diff(*by)


def _by_places(function: AppliedUndef, by: Sequence[Expr]) -> bool:
    """Whether a function is differentiated by its arguments, none of which depends on another."""
    return all(function.args.count(s) == 1 for s in by) and not any(
        argument.has(*by) for argument in function.args if argument not in by
    )


def _polynomial(function: AppliedUndef, number: int) -> tuple[tuple[Symbol, ...], Expr]:
    """Return places and a cubic in them, of the sign that the function is declared to have."""
    places = sp.symbols(f"_u0:{len(function.args)}", real=True)
    found = sp.Rational(number + 2, 3)
    for i, u in enumerate(places, 2):
        found += u * sp.Rational(number + i, i) - u**2 / (number + i) + u**3 / (2 * number + i)
    if len(places) > 1:
        found += number * sp.Mul(*places) + places[0] ** 2 * places[-1] / 2
    if function.is_positive or function.is_negative:
        found = (found**2 + sp.Rational(1, 4)) * (1 if function.is_positive else -1)
    return places, found


class Neighbourhood:
    """A point, and the points a little beside it along each symbol.

    Parameters
    ----------
    point
        The value of every symbol.
    examples
        What the arbitrary functions are.
    """

    def __init__(self, point: Mapping[Symbol, acb], examples: Examples) -> None:
        self.point = dict(point)
        self.examples = examples
        self._memos: dict[Symbol | None, dict[sp.Basic, acb]] = {}
        self._values: dict[Symbol | None, Values] = {}
        self._last: dict[Symbol | None, tuple[Form, acb]] = {}

    def beyond(self, values: Mapping[Symbol, acb]) -> Neighbourhood:
        """Return the neighbourhood of the point with more or other values."""
        return Neighbourhood({**self.point, **values}, self.examples)

    def value(self, f: Form, along: Symbol | None = None) -> acb:
        """Return the value of an expression, a step along a symbol away if one is given."""
        if isinstance(f, Expr):
            return self._value(f, along)
        last = self._last.get(along)
        if last is None or last[0] is not f:
            values = self._values.get(along)
            if values is None:
                values = self._values[along] = Values(lambda part: self._value(part, along))
            last = self._last[along] = (f, values(f))
        return last[1]

    def _value(self, f: Expr, along: Symbol | None) -> acb:
        memo = self._memos.get(along)
        if memo is None:
            memo = dict[sp.Basic, acb](self.point.items())
            self._memos[along] = memo
            if along is not None:
                memo[along] = self.point[along] + STEP
        found = memo.get(f)
        if found is not None:
            return found
        for unknown in self.examples.unknowns(f):
            if unknown not in memo:
                example = self.examples[unknown]
                if example.has(unknown):  # a derivative that SymPy leaves as it stands, as that of a jump
                    raise Unmodelled(str(unknown))
                memo[unknown] = self._value(example, along)
        return value(f, {}, memo)

    def slope(self, f: Form, by: Symbol) -> acb:
        """Return ∂f/∂s, to about thirty digits."""
        if not self._holds(f, by):
            return acb(0)
        return (self.value(f, by) - self.value(f)) / STEP

    def _holds(self, f: Form, symbol: Symbol) -> bool:
        """Whether a symbol stands in an expression, or stood there before a change."""
        if isinstance(f, Within):
            return symbol in self.examples.symbols(f.place.node) or self._holds(f.new, symbol)
        if isinstance(f, Joined):
            return any(self._holds(part, symbol) for part in f.parts)
        return symbol in self.examples.symbols(f)

    def slopes(self, f: Form, by: Sequence[Symbol]) -> list[acb]:
        """Return the slopes along several symbols."""
        return [self.slope(f, s) for s in by]


def small(terms: Sequence[acb]) -> bool:
    """Whether a sum vanishes as far as slopes tell.

    Examples
    --------
    >>> small([acb(1), acb(-1), acb(2) ** -90]), small([acb(1), acb(-1), acb(2) ** -20])
    (True, False)
    """
    scale = sum((abs(term) for term in terms), arb(1))
    return bool(abs(sum(terms, acb(0))) < TOLERANCE * scale)
