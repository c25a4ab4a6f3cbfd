"""Values of graph nodes at points, in any arithmetic."""

from __future__ import annotations

from math import prod
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph.arena import Arena
    from canon.expression.graph.number_systems import Arithmetic

__all__ = ["evaluate"]


def evaluate(
    graph: Arena, nodes: Sequence[int], values: Mapping[Symbol, Any], arithmetic: Arithmetic
) -> list[Any]:
    """Return the values of nodes; see :meth:`canon.expression.graph.graph.Graph.evaluate`."""
    done = dict[int, Any]()
    with arithmetic.quiet():
        for each in graph.reachable(nodes):
            kind, operands, value = graph.nodes[each]
            if kind == "symbol":
                if value not in values:
                    raise KeyError(f"no value given for the symbol {value}; give it one")
                done[each] = values[value]
            else:
                done[each] = _value(graph, each, [done[o] for o in operands], arithmetic)
    return [done[node] for node in nodes]


def _value(graph: Arena, node: int, x: list[Any], arithmetic: Arithmetic) -> Any:
    kind, operands, value = graph.nodes[node]
    if kind == "number":
        return arithmetic.number(value)
    if kind == "named":
        return arithmetic.named(value)
    if kind == "add":
        return sum(x[1:], x[0])
    if kind == "mul":
        return prod(x[1:], start=x[0])
    if kind == "pow":
        exponent = graph.nodes[operands[1]]
        return arithmetic.power(x[0], exponent.value if exponent.kind == "number" else x[1])
    return arithmetic.functions[kind](*x)
