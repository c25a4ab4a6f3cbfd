"""Values of integrals and sums over ranges, from their syntax trees."""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING, NoReturn, Protocol

import sympy as sp

from canon.expression.ranges.definite_integrals import definite_integral
from canon.expression.ranges.integrand_values import part_without_value
from canon.expression.ranges.range_of_call import (
    INTEGRAL,
    LIMITS_ARE_MISSING,
    PRODUCT,
    SUM,
    Range,
    name_with_index_inside,
    ranges,
    with_index,
    without_bounds,
)
from canon.expression.symbols.symbol import Coordinate, Momentum, Rate
from canon.expression.text.syntax import Call, Name, Product, Sum, Tuple, parts

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Basic, Expr

    from canon.expression.text.scope import Scope
    from canon.expression.text.syntax import Node

__all__ = ["over_ranges"]

MOST_TERMS = 100
MOST_NODES = 20_000
"""Size of all terms of a sum together."""


class _Builder(Protocol):
    """What gives a tree its meaning."""

    text: str
    scope: Scope

    def __init__(self, text: str, scope: Scope) -> None: ...
    def expression(self, node: Node) -> Expr: ...
    def refuse(self, node: Node, reason: str, remedy: str = "") -> NoReturn: ...


def over_ranges(builder: _Builder, node: Call) -> Expr:
    """Return the value of a definite integral, of a finite sum or product.

    Raises
    ------
    LanguageError
        Where a range is not complete, a bound of a sum no number, or an integral of no known form.
    """
    operand = node.arguments[0]
    found: Sequence[Range] = ranges(node.arguments[1:])
    variable = without_bounds(node.arguments[1:]) if node.function == INTEGRAL else None
    if variable is not None and builder.scope.quadratures:
        return _quadrature(builder, variable, operand)
    if variable is not None and isinstance(node.arguments[1], Tuple):
        builder.refuse(node, f"this integral {LIMITS_ARE_MISSING}", r"write \int_{0}^{a} f\,dx, or the value")
    if not found or (node.function != INTEGRAL and len(found) > 1):
        builder.refuse(
            node, f"{node.function} takes a variable and two bounds", f"write {node.function}(f, (x, 0, a))"
        )
    if node.function == INTEGRAL:
        return _integrated(builder, node, operand, found)
    index = next(iter(found))
    lower, upper = (builder.expression(bound) for bound in (index.lower, index.upper))
    if not (lower.is_Integer and upper.is_Integer and 0 <= int(upper) - int(lower) < MOST_TERMS):
        reason = f"a sum or product has from 1 to {MOST_TERMS} terms here"
        builder.refuse(node, reason, "write numbers as its bounds, or its value")
    if any(isinstance(part, Call) and part.function in (SUM, PRODUCT) for part in parts(operand)):
        builder.refuse(node, "a sum within a sum is not read", "write the terms of one of them")
    numbers = range(int(lower), int(upper) + 1)
    if len(numbers) * sum(1 for _ in parts(operand)) > MOST_NODES:
        builder.refuse(node, "this sum is longer than anyone writes", "write its value")
    name, known = index.variable.text, builder.scope.declares
    if (doubtful := name_with_index_inside(operand, name)) is not None:
        reason = f"does {doubtful.text} change with the index {name}?"
        builder.refuse(doubtful, reason, "write the terms one by one")
    terms = tuple((False, with_index(operand, name, number, known)) for number in numbers)
    return builder.expression((Sum if node.function == SUM else Product)(terms, node.column))


def _integrated(builder: _Builder, node: Call, operand: Node, found: Sequence[Range]) -> Expr:
    """Return the integral over one range after the other, the first the innermost."""
    _refuse_what_moves(builder, operand, found)
    scope = reduce(lambda known, one: known.with_variable(one.variable.text), found, builder.scope)
    inside = type(builder)(builder.text, scope)
    value = inside.expression(operand)
    if (part := part_without_value(builder, node, found)) is not None:
        if (known := _up_to_a_coordinate(builder, inside, value, found)) is not None:
            return known
        reason = "this integral is not read: here its integrand may have no value on the range"
        builder.refuse(part, reason, "write its value, as a function of its ends")
    for number, one in enumerate(found):
        x = scope.symbol(one.variable.text)
        if x is None or one.variable.primes:
            builder.refuse(one.variable, "an integral is over a variable, no function or rate")
        outer = inside if number + 1 < len(found) else builder
        whole = definite_integral(value, x, outer.expression(one.lower), outer.expression(one.upper))
        if whole is None and (known := _up_to_a_coordinate(builder, inside, value, found)) is not None:
            return known
        if whole is None:
            reason = "this integral is not read: the integrand is no sum of powers, sines, cosines and exponentials"
            builder.refuse(node, reason, "write its value, as a function of its ends")
        value = whole
    return value


def _up_to_a_coordinate(builder: _Builder, inside: _Builder, f: Expr, found: Sequence[Range]) -> Expr | None:
    """Return an integral from a place where f has a value up to a coordinate, whose derivative is f there.

    None where quadratures may not stand, and of any other integral.
    """
    if not builder.scope.quadratures or len(found) != 1:
        return None
    (one,) = found
    x, lower, upper = (
        inside.scope.symbol(one.variable.text),
        *map(builder.expression, (one.lower, one.upper)),
    )
    moving = [s for s in (f.free_symbols | lower.free_symbols) - {x} if _moves(s, builder.scope)]
    if x is None or moving or f.has(sp.Integral) or not isinstance(upper, Coordinate):
        return None
    has_value = not f.subs(x, lower).has(sp.zoo, sp.oo, sp.nan)
    return sp.Integral(f, (x, lower, upper)) if has_value else None


def _moves(symbol: Basic, scope: Scope) -> bool:
    return isinstance(symbol, Coordinate | Momentum | Rate) or symbol == scope.time


def _quadrature(builder: _Builder, variable: Name, operand: Node) -> Expr:
    """Return an integral over a coordinate without limits, whose derivative by it is what is integrated.

    Nothing else that moves may stand in it, or its derivative by that would not be known.
    """
    x, f = builder.scope.symbol(variable.text), builder.expression(operand)
    if variable.primes or not isinstance(x, Coordinate):
        builder.refuse(variable, "an integral without limits is over a coordinate", "write its limits")
    moving = sorted(str(s) for s in f.free_symbols - {x} if _moves(s, builder.scope))
    if moving or f.has(sp.Integral):
        held = moving[0] if moving else "an integral"
        reason = f"an integral over {x} without limits holds {held} too, by which its derivative is not known"
        builder.refuse(operand, reason, "write its value")
    return sp.Integral(f, x)


def _refuse_what_moves(builder: _Builder, operand: Node, found: Sequence[Range]) -> None:
    """Refuse ∫ x dt and ∫ p dq, which mean the values along a motion that is not given here."""
    scope, variables = builder.scope, {one.variable.text for one in found}
    over_time = scope.time.name in variables
    over_coordinate = any(isinstance(scope.symbol(name), Coordinate) for name in variables)
    for part in parts(operand):
        if not isinstance(part, Name) or part.text in variables:
            continue
        momentum = isinstance(scope.symbol(part.text), Momentum)
        if (over_time and scope.moves(part.text)) or (over_coordinate and momentum):
            reason = f"{part.text} changes along the motion: is it held fixed under the integral?"
            builder.refuse(part, reason, "write the value of the integral")
