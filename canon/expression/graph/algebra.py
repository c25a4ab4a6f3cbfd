"""The light algebra of the expression graph: equal terms and bases merged, short sums and products flattened.

Only exact numbers are worked with, and nothing is expanded. Like SymPy, x·x⁻¹ becomes 1.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from canon.expression.graph.elementary import folded_power

if TYPE_CHECKING:
    from collections.abc import Iterable

    from canon.expression.graph.graph import Graph

__all__ = ["add", "factored", "mul", "power", "scaled"]

_FLATTENED = 8
"""Sums and products longer than this stay one shared node when they are part of a longer one."""


def add(graph: Graph, terms: Iterable[int]) -> int:
    """Return the sum of nodes, equal terms merged."""
    constant, coefficients = 0, dict[int, Fraction | int]()
    for term in _flat(graph, "add", terms):
        factor, rest = factored(graph, term)
        if rest is None:
            constant += factor
        else:
            coefficients[rest] = coefficients.get(rest, 0) + factor
    operands = sorted(
        rest if factor == 1 else scaled(graph, factor, rest)
        for rest, factor in coefficients.items()
        if factor
    )
    if constant:
        operands.insert(0, graph.number(constant))
    if len(operands) < 2:
        return operands[0] if operands else graph.number(0)
    return graph.operation("add", tuple(operands))


def mul(graph: Graph, factors: Iterable[int]) -> int:
    """Return the product of nodes, powers of equal bases merged."""
    constant, exponents = 1, dict[int, Fraction | int]()
    for factor in _flat(graph, "mul", factors):
        node = graph.nodes[factor]
        if node.kind == "number":
            constant *= node.value
            continue
        base, exponent = _powered(graph, factor)
        exponents[base] = exponents.get(base, 0) + exponent
    operands: list[int] = []
    for base, exponent in exponents.items():
        raised = base if exponent == 1 else power(graph, base, graph.number(exponent))
        if graph.nodes[raised].kind == "number":
            constant *= graph.nodes[raised].value
        else:
            operands.append(raised)
    if not constant:
        return graph.number(0)
    return _product(graph, constant, tuple(sorted(operands)))


def power(graph: Graph, base: int, exponent: int) -> int:
    """Return base**exponent, the principal value."""
    if graph.nodes[exponent].kind != "number":
        return graph.operation("pow", (base, exponent))
    exact: Fraction = graph.nodes[exponent].value
    if exact in (0, 1):
        return base if exact else graph.number(1)
    node = graph.nodes[base]
    if node.kind == "number":
        folded = folded_power(node.value, exact)
        return graph.operation("pow", (base, exponent)) if folded is None else graph.number(folded)
    if exact.denominator == 1:
        inner, own = _powered(graph, base)
        if own != 1:
            return power(graph, inner, graph.number(own * exact))
        factor, rest = factored(graph, base)
        if factor != 1 and rest is not None:
            return mul(graph, [power(graph, graph.number(factor), exponent), power(graph, rest, exponent)])
    return graph.operation("pow", (base, exponent))


def scaled(graph: Graph, factor: Fraction | int, node: int) -> int:
    """Return factor · node without looking at anything but node's own numerical factor."""
    own, rest = factored(graph, node)
    if rest is None or not factor:
        return graph.number(factor * own)
    operands = graph.nodes[rest].operands if graph.nodes[rest].kind == "mul" else (rest,)
    return _product(graph, factor * own, operands)


def factored(graph: Graph, node: int) -> tuple[Fraction | int, int | None]:
    """Split c·x into its number c and the rest x (None where the node is a number)."""
    kind, operands, value = graph.nodes[node]
    if kind == "number":
        return value, None
    if kind == "mul" and graph.nodes[operands[0]].kind == "number":
        return graph.nodes[operands[0]].value, _product(graph, 1, operands[1:])
    return 1, node


def _powered(graph: Graph, node: int) -> tuple[int, Fraction | int]:
    """Split x**c into x and the exact number c (1 for what is no such power)."""
    kind, operands, _ = graph.nodes[node]
    if kind == "pow" and graph.nodes[operands[1]].kind == "number":
        return operands[0], graph.nodes[operands[1]].value
    return node, 1


def _product(graph: Graph, constant: Fraction | int, operands: tuple[int, ...]) -> int:
    if constant != 1 or not operands:
        operands = (graph.number(constant), *operands)
    return operands[0] if len(operands) == 1 else graph.operation("mul", operands)


def _flat(graph: Graph, kind: str, operands: Iterable[int]) -> list[int]:
    flat: list[int] = []
    for operand in operands:
        node = graph.nodes[operand]
        flat.extend(node.operands if node.kind == kind and len(node.operands) <= _FLATTENED else (operand,))
    return flat
