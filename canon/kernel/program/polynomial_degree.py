"""Polynomial degree of an expression of the graph in some of its symbols, where it is a polynomial of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph

__all__ = ["polynomial_degree"]


def polynomial_degree(graph: Graph, node: int, variables: Sequence[Symbol]) -> int | None:
    """Return a bound of the degree of a node as a polynomial of all the variables together; None where it is none.

    It is the degree as the polynomial is written: what cancels on multiplying out counts. Other symbols are
    constants, and so are functions of them alone.

    Examples
    --------
    >>> from sympy import cos, sqrt, symbols
    >>> from canon.expression.graph.graph import Graph
    >>> x, y, k = symbols("x y k")
    >>> graph = Graph()
    >>> expressions = (x**2 + y) ** 3 * y, sqrt(k) * x + cos(k), x / k, x / (1 + y), cos(x), x**k
    >>> [polynomial_degree(graph, graph.from_sympy(f), [x, y]) for f in expressions]
    [7, 1, 1, None, None, None]
    """
    moving = {graph.symbol(each) for each in variables}
    found = dict[int, int | None]()
    for each in graph.reachable([node]):
        kind, operands, _ = graph.nodes[each]
        below = [found[o] for o in operands]
        if kind == "symbol":
            found[each] = int(each in moving)
        elif None in below:
            found[each] = None
        else:
            found[each] = _degree(graph, kind, operands, [d for d in below if d is not None])
    return found[node]


def _degree(graph: Graph, kind: str, operands: Sequence[int], below: Sequence[int]) -> int | None:
    """Return the degree of an operation on polynomials of known degrees."""
    if not any(below):
        return 0
    if kind == "add":
        return max(below)
    if kind == "mul":
        return sum(below)
    if kind == "pow":
        exponent = graph.nodes[operands[1]]
        if exponent.kind == "number" and exponent.value > 0 and exponent.value.denominator == 1:
            return below[0] * int(exponent.value)
    return None
