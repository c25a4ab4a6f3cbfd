"""Slips: expressions that differ from a given one in one place, by a sign, factor, function, exponent or symbol."""

from __future__ import annotations

import itertools
from dataclasses import replace
from itertools import chain, combinations, permutations
from typing import TYPE_CHECKING, TypeAlias, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.diagnose.change import Change, Mistake
from canon.exercise.diagnose.repairs.symbol_slips import (
    by_another,
    exchanged_symbol,
    in_one_argument,
    in_one_factor,
    slipped,
    swapped,
)
from canon.exercise.diagnose.repairs.unbuilt import Place, Within, built, places, product
from canon.expression.symbols.symbol import Coordinate
from canon.mechanics.algebra.substitution import exchanged, symbols_of
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from canon.exercise.diagnose.repairs.unbuilt import Form

__all__ = [
    "RARER", "common_slips", "lost_factors", "of_one_coefficient", "plain_variants", "rarer_variants", "variants",
]  # fmt: skip

Slip: TypeAlias = "tuple[Form, Change]"
"""An expression with a slip, and which one."""

_FACTORS: tuple[Expr, ...] = tuple(map(sp.Rational, ("2", "1/2", "4", "1/4", "3", "1/3")))
_FAMILIES = (
    (sp.sin, sp.cos), (sp.tan, sp.cot), (sp.sec, sp.csc), (sp.sinh, sp.cosh, sp.tanh), (sp.asin, sp.acos),
    (sp.atan, sp.acot), (sp.asinh, sp.acosh, sp.atanh), (sp.elliptic_k, sp.elliptic_e),
)  # fmt: skip
_TWINS = {f: tuple(g for g in family if g is not f) for family in _FAMILIES for f in family}
MOST_FUNCTIONS = 6
MOST_ALIKE = 6
MOST_TERMS = 6
MOST_IN_FRONT = 5
"""Factors of a term, some of which stood before a bracket."""
RARER = 2
"""The least rank of a rarer variant."""
_SHIFTS = (sp.S.One, sp.S.NegativeOne)
_CONSTANTS = (sp.pi, -sp.pi, sp.pi / 2, -sp.pi / 2)


_of = Change.of


def _everywhere_of(mistake: Mistake, *items: object) -> Change:
    return Change(mistake, items, everywhere=True)


def variants(expression: Expr, symbols: Sequence[Symbol] = ()) -> Iterator[Slip]:
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
    >>> [(str(built(new)), change.mistake.name) for new, change in variants(sp.sin(x) - y)][:3]
    [('y + sin(x)', 'TERM_SIGN'), ('-y - sin(x)', 'TERM_SIGN'), ('-y + cos(x)', 'FUNCTION')]
    """
    yield from plain_variants(expression)
    yield from lost_factors(expression, symbols)
    yield from rarer_variants(expression, symbols)


def lost_factors(expression: Expr, symbols: Sequence[Symbol]) -> Iterator[Slip]:
    """Yield expressions in which a symbol stands before one term more, or below it."""

    def multiplied(node: Expr) -> Iterator[Slip]:
        return _multiplied(node, symbols)

    yield from _one_place(expression, multiplied)
    for symbol in symbols:
        yield product(expression, symbol), _of(Mistake.FACTOR_MISSING, expression, symbol)
        if not expression.is_Add:
            yield product(expression, 1 / symbol), _of(Mistake.DIVISOR_MISSING, expression, symbol)


def rarer_variants(expression: Expr, symbols: Sequence[Symbol]) -> Iterator[Slip]:
    """Yield expressions with slips of rank :data:`RARER` or above: other symbols, arguments, fractions, brackets."""

    def another_symbol(node: Expr) -> Iterator[Slip]:
        return exchanged_symbol(node, symbols)

    def another_factor(node: Expr) -> Iterator[Slip]:
        return in_one_factor(node, symbols)

    def another_argument(node: Expr) -> Iterator[Slip]:
        return in_one_argument(node, symbols)

    functions = sorted((f for f in expression.atoms(sp.Function) if _twins(f)), key=str)[:MOST_FUNCTIONS]

    def multiplied_by_functions(node: Expr) -> Iterator[Slip]:
        return _multiplied(node, functions)

    rest = (
        by_another,
        _superfluous,
        _upside_down,
        _unwrapped,
        another_symbol,
        _dropped,
        swapped,
        _shifted,
        another_factor,
        another_argument,
        _other_branch,
        _out_of_a_bracket,
        multiplied_by_functions,
    )
    for edits in rest:
        yield from _one_place(expression, edits)
    yield from _everywhere(expression, symbols)


def plain_variants(expression: Expr) -> Iterator[Slip]:
    """Yield expressions that differ in a sign, a function, a number in front of a term or an exponent."""
    for edits in (_signs, _functions, _factors, _together, _exponents):
        yield from _one_place(expression, edits)


def common_slips(
    expressions: Sequence[Expr], symbols: Sequence[Symbol]
) -> Iterator[tuple[Mapping[Expr, Expr], Change]]:
    """Yield substitutions that a person may have got wrong in all components of an answer alike."""
    own = symbols_of(*expressions)
    for symbol in own:
        yield {symbol: -symbol}, _everywhere_of(Mistake.SIGN_OF, symbol)
    functions = sorted({f for e in expressions for f in e.atoms(sp.Function)}, key=str)
    for f in functions:
        yield {f: -f}, _everywhere_of(Mistake.SIGN_OF, f)
        yield {f: f**2}, _everywhere_of(Mistake.SQUARE, f)
        for twin in _twins(f):
            yield {f: twin(*arguments(f))}, _everywhere_of(Mistake.FUNCTION, f, twin(*arguments(f)))
    for a, b in combinations(own, 2) if len(expressions) > 1 else ():
        yield {a: b, b: a}, _everywhere_of(Mistake.SYMBOLS_EXCHANGED, None, a, b)
    for node in _repeated(expressions):
        for new, change in chain(_signs(node), _factors(node)):
            yield {node: built(new)}, replace(change, everywhere=True, inside=node)
    for symbol in own:
        for factor in (*_FACTORS[:2], *(power for s in symbols if s != symbol for power in (s, 1 / s))):
            yield {symbol: factor * symbol}, _everywhere_of(Mistake.SYMBOL, symbol, factor * symbol)


def _twins(f: Expr) -> tuple[Callable[..., Expr], ...]:
    """Return the functions that one of one argument is mistaken for; those of more have no twins."""
    if len(f.args) != 1:  # such as the incomplete elliptic_e(z, m)
        return ()
    return cast("dict[object, tuple[Callable[..., Expr], ...]]", _TWINS).get(f.func, ())


def _one_place(expression: Expr, edits: Callable[[Expr], Iterator[Slip]]) -> Iterator[Slip]:
    """Apply an edit at one place of the tree at a time, equal subexpressions elsewhere left alone."""
    yield from edits(expression)
    for i, operand in enumerate(expression.args):
        if isinstance(operand, Expr) and not operand.is_Number:
            place = Place(expression, i)
            put = Within if place.is_valued else _put_at_once
            for new, change in _one_place(operand, edits):
                whole = put(place, new)
                if whole is not None:
                    yield whole, change


def _put_at_once(place: Place, new: Form) -> Form | None:
    """Return a node whose value says nothing without its tree, None where SymPy has none: a derivative by a number."""
    try:
        return built(Within(place, new))
    except (TypeError, ValueError):
        return None


def _each_term(node: Expr) -> Iterator[Place]:
    """Yield the place of each term of a sum."""
    return places(node) if node.is_Add else iter(())


def _times(place: Place, factor: Expr) -> Form:
    """Return a node with one operand multiplied."""
    return Within(place, product(place.operand, factor))


def _signs(node: Expr) -> Iterator[Slip]:
    for place in _each_term(node):
        yield _times(place, sp.S.NegativeOne), _of(Mistake.TERM_SIGN, place.operand)


def _factors(node: Expr) -> Iterator[Slip]:
    for place in _each_term(node):
        for factor in _FACTORS:
            yield _times(place, factor), _of(Mistake.TERM_FACTOR, place.operand, factor)


def _together(node: Expr) -> Iterator[Slip]:
    """The terms that share a coefficient, which were one bracket: SymPy distributes numbers over sums."""
    for terms in of_one_coefficient(node):
        yield node - 2 * terms, _of(Mistake.TERM_SIGN, terms)
        for factor in _FACTORS:
            yield node + (factor - 1) * terms, _of(Mistake.TERM_FACTOR, terms, factor)


def of_one_coefficient(f: Expr) -> Iterator[Expr]:
    """Yield the parts of a sum whose terms have the same number in front, where there are several.

    Examples
    --------
    >>> x, y, z = sp.symbols("x y z")
    >>> list(of_one_coefficient((x + y) / 2 - z))
    [x/2 + y/2]
    """
    groups: dict[Expr, list[Expr]] = {}
    terms = arguments(f) if f.is_Add else ()
    for term in terms:
        groups.setdefault(term.as_coeff_Mul()[0], []).append(term)
    yield from (sp.Add(*group) for group in groups.values() if 2 <= len(group) < len(terms))
    for group in groups.values():
        if 2 < len(group) <= MOST_ALIKE:
            yield from (a + b for a, b in combinations(group, 2))


def _functions(node: Expr) -> Iterator[Slip]:
    for twin in _twins(node):
        yield twin(*arguments(node)), _of(Mistake.FUNCTION, node, twin(*arguments(node)))
    if _twins(node) or isinstance(node, sp.exp):
        for factor in (sp.S.NegativeOne, sp.Rational(2), sp.Rational(1, 2)):
            new = node.func(factor * arguments(node)[0])
            yield new, _of(Mistake.ARGUMENT, node, new)


def _upside_down(node: Expr) -> Iterator[Slip]:
    """A fraction of two symbols written as its inverse."""
    powers = node.as_powers_dict() if node.is_Mul else {}
    for (a, up), (b, down) in permutations(powers.items(), 2):
        if a.is_Symbol and b.is_Symbol and up.is_positive and down == -up:
            new = node * (b / a) ** (2 * up)
            yield new, _of(Mistake.UPSIDE_DOWN, node, new)


def _unwrapped(node: Expr) -> Iterator[Slip]:
    """An angle that stands for its sine or tangent."""
    places = arguments(node) if node.is_Mul or node.is_Add else ()
    for angle in places:
        if angle.is_Symbol or angle.is_Add or angle.is_Mul:
            for function in (sp.sin, sp.tan, sp.sinh) if isinstance(angle, Coordinate) or node.is_Mul else ():
                rest = node.func(*(function(p) if p == angle else p for p in places))
                yield rest, _of(Mistake.FUNCTION_MISSING, angle, function(angle))


def _exponents(node: Expr) -> Iterator[Slip]:
    if node.is_Add or node.is_Mul or node.is_Number:
        if node.is_Add:
            yield node**2, _of(Mistake.SQUARE, node)
        return
    base, exponent = node.as_base_exp()
    if exponent.is_Rational:
        for other in dict.fromkeys((2 * exponent, exponent / 2, exponent + 1, exponent - 1, -exponent)):
            if other != 0 and not (base.is_Function and abs(exponent) == 1 == abs(other)):
                yield base**other, _of(Mistake.EXPONENT, node, base**other)
    if exponent == 2:
        yield base * sp.Abs(base), _of(Mistake.FUNCTION, node, base * sp.Abs(base))
    if node.is_Symbol and not node.is_positive:
        yield sp.Abs(node), _of(Mistake.FUNCTION, node, sp.Abs(node))


def _other_branch(node: Expr) -> Iterator[Slip]:
    """Another angle with the same sine, cosine or tangent."""
    if isinstance(node, sp.asin):
        others: tuple[Expr, ...] = (sp.pi - node,)
    elif isinstance(node, sp.acos):
        others = (-node, 2 * sp.pi - node)
    elif isinstance(node, sp.atan | sp.acot):
        others = (node + sp.pi, node - sp.pi)
    else:
        return
    yield from ((other, _of(Mistake.BRANCH, node, other)) for other in others)


def _out_of_a_bracket(node: Expr) -> Iterator[Slip]:
    """A term that lacks what another one is multiplied with: a(b + c) written as ab + c."""
    terms = places(node) if node.is_Add and len(arguments(node)) <= MOST_TERMS else ()
    for other, place in permutations(terms, 2):
        factors = sp.Mul.make_args(other.operand)
        if not 2 <= len(factors) <= MOST_IN_FRONT:
            continue
        for count in range(2, len(factors) + 1):
            for some in combinations(factors, count):
                yield _lacking(place, sp.Mul(*some))
        yield from _divided_by_a_bracket(place, other.operand)


def _divided_by_a_bracket(place: Place, other: Expr) -> Iterator[Slip]:
    """A term that lacks a divisor which another one was reduced by: (a²b² + c)/(2a) written as a b²/2 + c."""
    number, rest = other.as_coeff_Mul()
    symbols = [f for f in sp.Mul.make_args(rest) if f.is_Symbol and f.is_positive]
    for count in range(1, len(symbols) + 1):
        for some in combinations(symbols, count):
            yield _lacking(place, number / sp.Mul(*some))


def _lacking(place: Place, factor: Expr) -> Slip:
    return _times(place, factor), _of(Mistake.FACTOR_MISSING, place.operand, factor)


def _superfluous(node: Expr) -> Iterator[Slip]:
    for place in _each_term(node):
        yield Within(place, sp.S.Zero), _of(Mistake.TERM_SUPERFLUOUS, place.operand)


def _dropped(node: Expr) -> Iterator[Slip]:
    if node.is_Mul:
        for factor in arguments(node):
            if not factor.is_Number:
                yield node / factor, _of(Mistake.FACTOR_SUPERFLUOUS, factor, node)


def _shifted(node: Expr) -> Iterator[Slip]:
    """A number lost in the argument of a function, or beside one."""
    if node.is_Function and len(arguments(node)) == 1:
        for number in _SHIFTS:
            new = node.func(arguments(node)[0] + number)
            yield new, _of(Mistake.ARGUMENT, node, new)
            yield node + number, _of(Mistake.TERM_MISSING_IN, node, number)


def _multiplied(node: Expr, symbols: Sequence[Expr]) -> Iterator[Slip]:
    for place in _each_term(node):
        for symbol in symbols:
            yield _lacking(place, symbol)
            yield _times(place, 1 / symbol), _of(Mistake.DIVISOR_MISSING, place.operand, symbol)
            if symbol.is_Symbol:
                yield _lacking(place, symbol**2)


def _everywhere(expression: Expr, symbols: Sequence[Symbol]) -> Iterator[Slip]:
    """The same slip in all places at once, two symbols exchanged, a constant angle lost."""
    for slip, change in common_slips([expression], ()):
        new = slipped(expression, slip)
        if new is not None:
            yield new, change
    for angle in (s for s in symbols_of(expression) if isinstance(s, Coordinate)):
        change = _everywhere_of(Mistake.FUNCTION_MISSING, angle, sp.sin(angle))
        yield _outside_of_functions(expression, angle), change
    yield from _renamed(expression, symbols)
    if expression.has(*_TWINS):
        for angle in _CONSTANTS:
            yield expression + angle, _of(Mistake.TERM_MISSING, angle)


def _renamed(expression: Expr, symbols: Sequence[Symbol]) -> Iterator[Slip]:
    """Two symbols exchanged in all places, one symbol for another in all places."""
    own = symbols_of(expression)
    for a, b in combinations(own, 2):
        other = slipped(expression, {a: b, b: a})
        if other is not None:
            yield other, _of(Mistake.SYMBOLS_EXCHANGED, None, a, b)
    for old, new in itertools.product(own, symbols):
        renamed = slipped(expression, {old: new}) if new != old else None
        if renamed is not None:
            yield renamed, _everywhere_of(Mistake.SYMBOL, old, new)


def _outside_of_functions(f: Expr, angle: Symbol) -> Expr:
    """Return f with sin θ for θ, but for θ in the argument of a function."""
    inside: dict[Expr, Expr] = {
        cast("Expr", g): sp.Dummy() for g in f.atoms(sp.Function, sp.Derivative) if g.has(angle)
    }
    free = exchanged(exchanged(f, inside), {angle: sp.sin(angle)})
    return exchanged(free, {d: g for g, d in inside.items()})


def _repeated(expressions: Sequence[Expr]) -> list[Expr]:
    """Return the sums that stand in more than one place."""
    counts: dict[Expr, int] = {}
    for expression in expressions:
        for node in sp.preorder_traversal(expression):
            if isinstance(node, Expr) and node.is_Add:
                counts[node] = counts.get(node, 0) + 1
    return [node for node, count in counts.items() if count > 1]
