"""Derivatives on an expression graph: forward by one symbol, in reverse by many.

Only what depends on the symbols is visited. The slope of a product by one of its factors is the product of the
others; where many factors vary, products of heads and tails make all of them at linear cost.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.expression.graph.elementary import SLOPES

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph

__all__ = ["derivative", "gradient"]

_FEW = 2
"""Up to so many factors that vary the products of the others are formed one by one."""


def derivative(graph: Graph, node: int, symbol: Symbol, known: dict[int, int]) -> int:
    """Return ∂node/∂symbol; ``known`` holds the derivatives by this symbol already found and takes up the new ones."""
    wanted = graph.mask((symbol,))
    if not graph.masks[node] & wanted:
        return graph.zero
    known[graph.symbol(symbol)] = graph.one
    for each in _varying(graph, node, wanted, known):
        known[each] = graph.add(
            [
                slope if known[o] == graph.one else graph.mul((slope, known[o]))
                for o, slope in _slopes(graph, each, wanted)
            ]
        )
    return known[node]


def gradient(graph: Graph, node: int, symbols: Sequence[Symbol]) -> tuple[int, ...]:
    """Return ∂node/∂symbol for many symbols at once."""
    own = [graph.symbol(symbol) for symbol in symbols]
    wanted = graph.mask(symbols)
    contributions: dict[int, list[int]] = {node: [graph.one]}
    for each in reversed(_varying(graph, node, wanted, ())):
        if graph.nodes[each].operands:
            adjoint = graph.add(contributions.pop(each))
            for operand, slope in _slopes(graph, each, wanted):
                product = slope if adjoint == graph.one else graph.mul((adjoint, slope))
                contributions.setdefault(operand, []).append(product)
    return tuple(graph.add(contributions.get(each, ())) for each in own)


def _varying(graph: Graph, node: int, wanted: int, known: Collection[int]) -> list[int]:
    """Return the nodes below one that depend on the wanted symbols and are not known, operands first."""
    found, waiting, masks = set[int](), [node], graph.masks
    while waiting:
        each = waiting.pop()
        if each not in found and each not in known and masks[each] & wanted:
            found.add(each)
            waiting.extend(graph.nodes[each].operands)
    return sorted(found)


def _slopes(graph: Graph, node: int, wanted: int) -> Iterator[tuple[int, int]]:
    """Yield the operands that vary and the partial derivative of the operation by each."""
    kind, operands, _ = graph.nodes[node]
    masks = graph.masks
    if kind == "add":
        yield from ((o, graph.one) for o in operands if masks[o] & wanted)
    elif kind == "mul":
        yield from _of_product(graph, operands, wanted)
    elif kind == "pow":
        base, exponent = operands
        if masks[base] & wanted:
            yield base, graph.mul((exponent, graph.pow(base, graph.add((exponent, graph.number(-1))))))
        if masks[exponent] & wanted:
            yield exponent, graph.mul((node, graph.function("log", base)))
    elif kind == "atan2":
        y, x = operands
        inverse = graph.power(graph.add((graph.power(x, 2), graph.power(y, 2))), -1)
        if masks[y] & wanted:
            yield y, graph.mul((x, inverse))
        if masks[x] & wanted:
            yield x, graph.negative(graph.mul((y, inverse)))
    else:
        yield operands[0], SLOPES[kind](graph, operands[0], node)


def _of_product(graph: Graph, factors: tuple[int, ...], wanted: int) -> Iterator[tuple[int, int]]:
    varying = [k for k, factor in enumerate(factors) if graph.masks[factor] & wanted]
    if len(varying) <= _FEW:
        for k in varying:
            others = factors[:k] + factors[k + 1 :]
            yield factors[k], others[0] if len(others) == 1 else graph.mul(others)
        return
    before, after = [graph.one], [graph.one]
    for factor in factors[:-1]:
        before.append(graph.mul((before[-1], factor)))
    for factor in reversed(factors[1:]):
        after.append(graph.mul((after[-1], factor)))
    after.reverse()
    yield from ((factors[k], graph.mul((before[k], after[k]))) for k in varying)
