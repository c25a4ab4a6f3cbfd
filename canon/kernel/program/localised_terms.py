"""Localised terms of an expression: exponentials that vanish but for a short way, and what they depend on.

A pulse exp(−((t − t₀)/w)²) or a bump 1/cosh²((x − x₀)/w) is rounded to nothing a few widths away, and with it all of
its Taylor coefficients: no method that chooses its steps by values of the term can know that it is there. The exponent
can: it is an ordinary function all the way, and the term is to be seen where the exponent is of moderate size.
Quotients 1/(1 + ((t − t₀)/w)²) are seen from afar by a series, but not by steps of one size, which may pass the middle.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.expression.graph.graph import Graph

__all__ = ["denominators_of", "exponents_of", "sights"]

_EXPONENTIAL = ("exp", "sinh", "cosh", "tanh")
_OF_SQUARES = ("erf", "erfc")
"""Functions that are constant but for exp(−x²)."""

_MARGIN = 14.0
"""exp(−14) ≈ 10⁻⁶: a term 10⁶ times larger than all others is still seen in time."""

_FARTHER_IN = 3.0
"""Powers of a term, such as 1/cosh⁶, come in sight so many times farther in."""


def exponents_of(graph: Graph, nodes: Sequence[int]) -> tuple[int, ...]:
    """Return the exponents of all exponentials in some expressions that are not constant, each once.

    Parameters
    ----------
    graph
        The graph that holds the expressions.
    nodes
        The expressions, such as rates of change.

    Examples
    --------
    >>> from sympy import exp, symbols, tanh
    >>> from canon.expression.graph.graph import Graph
    >>> x, t = symbols("x t")
    >>> graph = Graph()
    >>> [graph.to_sympy(g) for g in exponents_of(graph, [graph.from_sympy(x + exp(2 - t**2) + tanh(5 * x))])]
    [5*x, 2 - t**2]
    """
    found = dict[int, None]()
    for each in graph.reachable(nodes):
        kind, operands, _ = graph.nodes[each]
        if kind in _EXPONENTIAL:
            found[operands[0]] = None
        elif kind in _OF_SQUARES:
            found[graph.power(operands[0], 2)] = None
        elif kind == "pow" and not graph.is_constant(operands[1]):
            found[graph.mul([operands[1], graph.function("log", operands[0])])] = None
    varying = sorted(node for node in found if not graph.is_constant(node))
    return tuple(node for k, node in enumerate(varying) if graph.negative(node) not in varying[:k])


def denominators_of(graph: Graph, nodes: Sequence[int]) -> tuple[int, ...]:
    """Return the sums that stand in denominators, and whose quotients may therefore be large for a short way.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon.expression.graph.graph import Graph
    >>> x, t = symbols("x t")
    >>> graph = Graph()
    >>> [graph.to_sympy(g) for g in denominators_of(graph, [graph.from_sympy(x / (1 + t**2) ** 2 + 1 / x)])]
    [t**2 + 1]
    """
    found = dict[int, None]()
    for each in graph.reachable(nodes):
        kind, operands, _ = graph.nodes[each]
        if kind == "pow" and graph.nodes[operands[0]].kind == "add" and not graph.is_constant(operands[0]):
            exponent = graph.nodes[operands[1]]
            if exponent.kind != "number" or exponent.value < 0:
                found[operands[0]] = None
    return tuple(found)


def sights(unit: float) -> tuple[float, ...]:
    """Return the sizes of an exponent x, largest first, at which terms come in sight in numbers of a rounding unit.

    At the first exp(−x) is of no account yet, at the second 1 − tanh² x and 1/cosh² x begin to be, at the third higher
    powers.

    Raises
    ------
    ValueError
        The rounding unit is beyond the range of doubles.

    Examples
    --------
    >>> [round(x) for x in sights(2.0**-52)]
    [50, 17, 6]
    """
    if unit == 0:
        raise ValueError(
            "a precision of more than 300 decimal digits is beyond what is known here: give fewer"
        )
    digits = -math.log(unit)
    saturated = digits / 2 - 1
    return (_MARGIN + digits, saturated, saturated / _FARTHER_IN)
