"""Conversion of SymPy expressions into graph nodes and back, without recursion."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.expression.graph.algebra import add, mul, power, raised
from canon.expression.graph.elementary import function
from canon.expression.symbols.repeated_sum import RepeatedSum

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sympy import Expr

    from canon.expression.graph.arena import Arena

__all__ = ["NotModelledError", "from_sympy", "to_sympy"]

_FUNCTIONS: dict[type, str] = {
    getattr(sp, name): name
    for name in (
        "sin", "cos", "tan", "exp", "log", "asin", "acos", "atan", "sinh", "cosh", "tanh",
        "asinh", "acosh", "atanh", "Abs", "sign", "atan2", "erf", "erfc",
    )
}  # fmt: skip

_LOWERED: dict[type, Callable[[Arena, int], int]] = {
    sp.cot: lambda g, x: mul(g, [function(g, "cos", x), raised(g, function(g, "sin", x), -1)]),
    sp.sec: lambda g, x: raised(g, function(g, "cos", x), -1),
    sp.csc: lambda g, x: raised(g, function(g, "sin", x), -1),
    sp.acot: lambda g, x: function(g, "atan", raised(g, x, -1)),
}


class NotModelledError(ValueError):
    """Raised for an expression with a function that the expression graph has no operation for."""


def from_sympy(arena: Arena, expression: Expr) -> int:
    """Return the node of a SymPy expression."""
    # The memo goes by identity: hashing a deep SymPy expression recurses.
    done: dict[int, int] = {}
    whole: Any = sp.sympify(expression, strict=True)
    waiting: list[Any] = [whole]
    plain: dict[int, Any] = {}
    while waiting:
        current = waiting[-1]
        if isinstance(current, RepeatedSum):
            _as_written_out(current, plain, done, waiting)
            continue
        if not isinstance(current, sp.Expr) or isinstance(current, (sp.Piecewise, sp.Max, sp.Min)):
            raise NotModelledError(_complaint(current))
        missing = [argument for argument in current.args if id(argument) not in done]
        if missing:
            waiting.extend(missing)
            continue
        waiting.pop()
        if id(current) not in done:
            done[id(current)] = _node(arena, current, [done[id(a)] for a in current.args])
    return done[id(whole)]


def _as_written_out(
    whole: RepeatedSum, plain: dict[int, Any], done: dict[int, int], waiting: list[Any]
) -> None:
    """Give a sum over rows the node of what it is written out, or let that wait for its own."""
    if id(whole) not in plain:
        plain[id(whole)] = whole.doit()
    written = plain[id(whole)]
    if id(written) not in done:
        waiting.append(written)
        return
    done[id(whole)] = done[id(written)]
    waiting.pop()


def _node(arena: Arena, expression: Any, operands: list[int]) -> int:
    if expression.is_Symbol:
        return arena.symbol(expression)
    if expression.is_Rational:
        return arena.number(Fraction(int(expression.p), int(expression.q)))
    if expression.is_Float and expression.is_finite:
        above, below = sp.Rational(expression).as_numer_denom()
        return arena.number(Fraction(int(above), int(below)))
    if expression in (sp.pi, sp.E):
        return arena.named(str(expression))
    if expression.is_Add:
        return add(arena, operands)
    if expression.is_Mul:
        return mul(arena, operands)
    if expression.is_Pow:
        return power(arena, *operands)
    kind = type(expression)
    if kind in _LOWERED:
        return _LOWERED[kind](arena, *operands)
    if kind in _FUNCTIONS:
        return function(arena, _FUNCTIONS[kind], *operands)
    raise NotModelledError(_complaint(expression))


def _complaint(expression: Any) -> str:
    shown = str(expression)
    shown = shown if len(shown) < 60 else shown[:57] + "..."
    if isinstance(expression, sp.core.function.AppliedUndef):
        remedy = "replace functions of time by symbols, as coordinates() makes them"
    elif expression is sp.I:
        remedy = "write the expression with real quantities"
    else:
        known = ", ".join(sorted(_FUNCTIONS.values()))
        remedy = f"it knows sums, products, powers, pi, E, cot, sec, csc, acot, {known}"
    return f"{type(expression).__name__} in {shown} has no operation in the expression graph; {remedy}"


def to_sympy(arena: Arena, nodes: Sequence[int]) -> list[Expr]:
    """Return nodes as SymPy expressions."""
    done = dict[int, Any]()
    for each in arena.reachable(nodes):
        kind, operands, value = arena.nodes[each]
        x = [done[o] for o in operands]
        if kind == "number":
            done[each] = sp.Rational(value.numerator, value.denominator)
        elif kind == "named":
            done[each] = sp.pi if value == "pi" else sp.E
        elif kind == "symbol":
            done[each] = value
        else:
            done[each] = _OPERATIONS[kind](*x)
    return [done[node] for node in nodes]


_OPERATIONS: dict[str, Any] = {
    "add": sp.Add, "mul": sp.Mul, "pow": sp.Pow, **{name: function for function, name in _FUNCTIONS.items()}
}  # fmt: skip
