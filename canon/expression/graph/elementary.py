"""Elementary functions of the expression graph: their derivatives and exact values."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from canon.expression.graph.algebra import add, mul, negative, raised, scaled

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.expression.graph.arena import Arena

__all__ = ["AT_ZERO", "SLOPES", "function"]


def _one_plus_square(g: Arena, x: int, sign: int, power: Fraction | int) -> int:
    """Return (1 + sign·x²)**power."""
    return raised(g, add(g, [g.number(1), scaled(g, Fraction(sign), raised(g, x, 2))]), power)


def _bell(g: Arena, x: int, factor: int) -> int:
    """Return factor exp(−x²)/√π."""
    bell = function(g, "exp", negative(g, raised(g, x, 2)))
    return mul(g, [g.number(factor), bell, raised(g, g.named("pi"), -_HALF)])


_HALF = Fraction(1, 2)

SLOPES: dict[str, Callable[[Arena, int, int], int]] = {
    "sin": lambda g, x, _: function(g, "cos", x),
    "cos": lambda g, x, _: negative(g, function(g, "sin", x)),
    "tan": lambda g, _, f: _one_plus_square(g, f, 1, 1),
    "exp": lambda _g, _x, f: f,
    "log": lambda g, x, _: raised(g, x, -1),
    "asin": lambda g, x, _: _one_plus_square(g, x, -1, -_HALF),
    "acos": lambda g, x, _: negative(g, _one_plus_square(g, x, -1, -_HALF)),
    "atan": lambda g, x, _: _one_plus_square(g, x, 1, -1),
    "sinh": lambda g, x, _: function(g, "cosh", x),
    "cosh": lambda g, x, _: function(g, "sinh", x),
    "tanh": lambda g, _, f: _one_plus_square(g, f, -1, 1),
    "asinh": lambda g, x, _: _one_plus_square(g, x, 1, -_HALF),
    "acosh": lambda g, x, _: mul(g, [raised(g, add(g, [x, g.number(shift)]), -_HALF) for shift in (-1, 1)]),
    "atanh": lambda g, x, _: _one_plus_square(g, x, -1, -1),
    "erf": lambda g, x, _: _bell(g, x, 2),
    "erfc": lambda g, x, _: _bell(g, x, -2),
    "Abs": lambda g, x, _: function(g, "sign", x),
    "sign": lambda g, _x, _f: g.number(0),
}
"""The derivative of each function: from the graph, the argument's node and the function's own node."""

AT_ZERO = {
    "sin": 0, "cos": 1, "tan": 0, "exp": 1, "asin": 0, "atan": 0, "sinh": 0, "cosh": 1, "tanh": 0,
    "asinh": 0, "atanh": 0, "erf": 0, "erfc": 1, "Abs": 0, "sign": 0,
}  # fmt: skip


def function(arena: Arena, name: str, *operands: int) -> int:
    """Return an elementary function, by its SymPy name, of nodes."""
    if name not in SLOPES and name != "atan2":
        raise ValueError(f"the graph has no function {name!r}; it knows {', '.join(sorted(SLOPES))}, atan2")
    if len(operands) == 1 and operands[0] == arena.zero and name in AT_ZERO:
        return arena.number(AT_ZERO[name])
    return arena.operation(name, operands)
