"""Gaps in Taylor series of motions: high powers let many coefficients in a row vanish, or nearly so, as x¹⁶ at 0.

Where a motion passes a zero of a force of degree d at some speed, its series in time goes up by powers of d + 1: all
coefficients between are as small as the zero is near. heyoka takes the length of a step from the last two of them.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

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
    """Return the highest degree that expressions, or parts of them, have as polynomials; functions count as variables.

    Examples
    --------
    >>> from sympy import sin, sqrt, symbols
    >>> from canon.expression.graph.graph import Graph
    >>> x, y = symbols("x y")
    >>> graph = Graph()
    >>> [degree_of(graph, [graph.from_sympy(f)]) for f in (x**3 * y, sin(x) ** 7, sqrt(1 + x**8), x / (x + y) ** 3)]
    [4, 7, 8, 2]
    """
    degrees = dict[int, int]()
    for each in graph.reachable(nodes):
        kind, operands, _ = graph.nodes[each]
        below = [degrees[o] for o in operands]
        match kind:
            case "symbol":
                degrees[each] = 1
            case "add":
                degrees[each] = max(below, default=0)
            case "mul":
                degrees[each] = sum(below)
            case "pow":
                exponent = graph.nodes[operands[1]]
                whole = exponent.kind == "number" and exponent.value.denominator == 1 and exponent.value > 0
                degrees[each] = below[0] * int(exponent.value) if whole else min(1, max(below))
            case _:
                degrees[each] = min(1, max(below, default=0))
    return max(degrees.values(), default=0)
