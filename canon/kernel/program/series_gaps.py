"""Gaps in Taylor series of motions: high powers let many coefficients in a row vanish, or nearly so, as x¹⁶ at 0.

Where a motion passes a zero of a force of degree d at some speed, its series in time goes up by powers of d + 1: all
coefficients between are as small as the zero is near. heyoka takes the length of a step from the last two of them.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.expression.graph.graph import Graph

__all__ = ["degree_of", "may_have_gaps"]


def may_have_gaps(graph: Graph, rates: Sequence[int], order: int) -> bool:
    """Return whether the last two coefficients of series of an order may vanish together in mid-motion.

    Series of period D in their powers have the coefficients kD + 1 of q and kD of p. Where both of the last two fall
    between, and what fills the gap grows with a power of the distance from the zero, steps there are too long; where it
    grows in proportion, they lose no more than rounding does.

    Parameters
    ----------
    graph
        The graph that holds the rates of change.
    rates
        The right-hand sides.
    order
        The order of the series.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon.expression.graph.graph import Graph
    >>> x, y = symbols("x y")
    >>> graph = Graph()
    >>> [may_have_gaps(graph, [graph.from_sympy(f)], 20) for f in (x**3 + x * y, x**15, x / (x**2 + y**2) ** 3)]
    [False, True, False]
    """
    return any(_gap(period, order) for period in range(2, degree_of(graph, rates) + 2))


@functools.cache
def _gap(period: int, order: int) -> bool:
    last = (order - 3) // period
    return last >= 0 and (last + 1) * period >= order + 2


def degree_of(graph: Graph, nodes: Sequence[int]) -> int:
    """Return the highest degree with which expressions, or parts of them, vanish where a motion may pass at speed.

    That is their degree as polynomials of the variables, which may vanish together on a straight way, and the highest
    power of one function that all their terms have: sin θ₁ cos θ₂ vanishes twice only at points that a motion does not
    meet, and 1 + cos⁹ θ does not vanish with its second term.

    Examples
    --------
    >>> from sympy import cos, sin, sqrt, symbols
    >>> from canon.expression.graph.graph import Graph
    >>> x, y = symbols("x y")
    >>> graph = Graph()
    >>> expressions = x**3 * y, sin(x) ** 7, x * sin(x) * cos(x) * sin(y), sqrt(1 + x**8), y + sin(x) ** 9
    >>> [degree_of(graph, [graph.from_sympy(f)]) for f in expressions]
    [4, 7, 2, 8, 1]
    """
    found, asked = dict[int, _Degree](), list(nodes)
    for each in graph.reachable(nodes):
        kind, operands, _ = graph.nodes[each]
        below = [found[o] for o in operands]
        match kind:
            case "symbol":
                found[each] = _Degree(1, {})
            case "number" | "named":
                found[each] = _NONE
            case "add":
                found[each] = _Degree(max(d.variables for d in below), _common(below))
            case "mul":
                found[each] = _Degree(sum(d.variables for d in below), _together(below))
            case "pow" if (power := _whole_power(graph, operands[1])) is not None:
                found[each] = below[0].times(power)
            case "pow" if _is_negative(graph, operands[1]):
                asked += operands
                found[each] = _NONE
            case _:
                asked += operands
                found[each] = _function(each, below)
    return max((found[each].highest for each in asked), default=0)


def _whole_power(graph: Graph, exponent: int) -> int | None:
    """Return an exponent that is a positive whole number."""
    kind, _, value = graph.nodes[exponent]
    return int(value) if kind == "number" and value.denominator == 1 and value > 0 else None


def _is_negative(graph: Graph, exponent: int) -> bool:
    kind, _, value = graph.nodes[exponent]
    return kind == "number" and value < 0


@dataclass(frozen=True)
class _Degree:
    """The degree of a product in all variables together, and in each function in it."""

    variables: int
    functions: Mapping[int, int]

    @property
    def highest(self) -> int:
        return self.variables + max(self.functions.values(), default=0)

    def times(self, power: int) -> _Degree:
        return _Degree(self.variables * power, {f: n * power for f, n in self.functions.items()})


_NONE = _Degree(0, {})


def _function(node: int, below: Sequence[_Degree]) -> _Degree:
    """Return the degree of a function of something that varies, as one of itself."""
    return _Degree(0, {node: 1}) if any(degree.highest for degree in below) else _NONE


def _together(below: Sequence[_Degree]) -> dict[int, int]:
    """Return the power of each function in a product."""
    found = dict[int, int]()
    for degree in below:
        for f, n in degree.functions.items():
            found[f] = found.get(f, 0) + n
    return found


def _common(below: Sequence[_Degree]) -> dict[int, int]:
    """Return the power of each function that all terms of a sum have."""
    first, *rest = (degree.functions for degree in below)
    shared = (f for f in first if all(f in other for other in rest))
    return {f: min(first[f], *(other[f] for other in rest)) for f in shared}
