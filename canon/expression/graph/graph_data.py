"""Graphs as plain data, for files: their nodes in order, from which the same numbers for the same nodes come back."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from canon.expression.graph.elementary import SLOPES
from canon.expression.graph.graph import Graph

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy import Symbol

__all__ = ["graph_data", "graph_from"]

_OPERATIONS = {"add", "mul", "pow", "atan2", *SLOPES}


def graph_data(graph: Graph, symbol: Callable[[Symbol], int]) -> dict[str, Any]:
    """Return all nodes of a graph, and which are known to be each other's negatives.

    Parameters
    ----------
    graph
        The graph.
    symbol
        Gives a symbol its number.

    Raises
    ------
    ValueError
        A node is an operation that files do not know.

    Examples
    --------
    >>> from sympy import Symbol
    >>> x, graph = Symbol("x"), Graph()
    >>> node = graph.from_sympy(x**2 - 1)
    >>> again = graph_from(graph_data(graph, lambda _: 0), [x])
    >>> again.to_sympy(node), again.nodes == graph.nodes
    (x**2 - 1, True)
    """
    nodes: list[list[Any]] = []
    for kind, operands, value in graph.nodes:
        if kind == "symbol":
            nodes.append([kind, symbol(value)])
        elif kind in ("number", "named"):
            nodes.append([kind, str(value)])
        elif kind in _OPERATIONS:
            nodes.append([kind, *operands])
        else:
            raise ValueError(f"{kind}(…) is an operation that files do not know")
    return {"nodes": nodes, "negatives": [list(pair) for pair in graph.negatives.items()]}


def graph_from(data: Mapping[str, Any], symbols: Sequence[Symbol]) -> Graph:
    """Return the graph that :func:`graph_data` wrote, its symbols by their numbers.

    Raises
    ------
    ValueError
        A node stands twice, is none that is known, or is made of later ones.
    """
    graph = Graph()
    for number, (kind, *rest) in enumerate(data["nodes"]):
        if kind == "symbol":
            made = graph.symbol(symbols[rest[0]])
        elif kind == "number":
            made = graph.number(Fraction(rest[0]))
        elif kind == "named":
            made = graph.named(rest[0])
        elif kind in _OPERATIONS and all(0 <= operand < number for operand in rest):
            made = graph.operation(kind, tuple(rest))
        else:
            raise ValueError(f"node {number} of a graph is no operation on nodes before it: {kind}")
        if made != number:
            raise ValueError(f"node {number} of a graph stands there twice")
    graph.negatives.update(dict(data["negatives"]))
    return graph
