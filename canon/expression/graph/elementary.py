"""The elementary functions of the expression graph: their derivatives and what is known of them exactly."""

from __future__ import annotations

from fractions import Fraction
from math import isqrt
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.expression.graph.graph import Graph

__all__ = ["AT_ZERO", "SLOPES", "folded_power"]

_FOLDED_BITS = 4096
"""Powers of exact numbers are worked out up to this size."""


def folded_power(base: Fraction, power: Fraction) -> Fraction | None:
    """Return base**power where that is a rational number of modest size."""
    if not base and power < 0:
        raise ZeroDivisionError("the expression divides by zero: an exact 0 is raised to a negative power")
    if power.denominator == 2 and base >= 0:
        roots = Fraction(isqrt(base.numerator), isqrt(base.denominator))
        if roots * roots != base:
            return None
        base, power = roots, power * 2
    size = max(base.numerator.bit_length(), base.denominator.bit_length())
    if power.denominator != 1 or size * abs(power) > _FOLDED_BITS:
        return None
    return Fraction(base**power.numerator)


def _one_plus_square(g: Graph, x: int, sign: int, power: Fraction | int) -> int:
    """Return (1 + sign·x²)**power."""
    return g.power(g.add([g.number(1), g.scaled(Fraction(sign), g.power(x, 2))]), power)


_HALF = Fraction(1, 2)

SLOPES: dict[str, Callable[[Graph, int, int], int]] = {
    "sin": lambda g, x, _: g.function("cos", x),
    "cos": lambda g, x, _: g.negative(g.function("sin", x)),
    "tan": lambda g, _, f: _one_plus_square(g, f, 1, 1),
    "exp": lambda _g, _x, f: f,
    "log": lambda g, x, _: g.power(x, -1),
    "asin": lambda g, x, _: _one_plus_square(g, x, -1, -_HALF),
    "acos": lambda g, x, _: g.negative(_one_plus_square(g, x, -1, -_HALF)),
    "atan": lambda g, x, _: _one_plus_square(g, x, 1, -1),
    "sinh": lambda g, x, _: g.function("cosh", x),
    "cosh": lambda g, x, _: g.function("sinh", x),
    "tanh": lambda g, _, f: _one_plus_square(g, f, -1, 1),
    "asinh": lambda g, x, _: _one_plus_square(g, x, 1, -_HALF),
    "acosh": lambda g, x, _: g.mul([g.power(g.add([x, g.number(shift)]), -_HALF) for shift in (-1, 1)]),
    "atanh": lambda g, x, _: _one_plus_square(g, x, -1, -1),
    "Abs": lambda g, x, _: g.function("sign", x),
    "sign": lambda g, _x, _f: g.number(0),
}
"""The derivative of each function: from the graph, the argument's node and the function's own node."""

AT_ZERO = {
    "sin": 0, "cos": 1, "tan": 0, "exp": 1, "asin": 0, "atan": 0, "sinh": 0, "cosh": 1, "tanh": 0,
    "asinh": 0, "atanh": 0, "Abs": 0, "sign": 0,
}  # fmt: skip
