"""Derivatives on an expression graph: forward by one symbol or along a direction, in reverse by many.

Only what depends on the symbols is visited. The slope of a product by one of its factors is the product of the
others; where many factors vary, products of heads and tails make all of them at linear cost.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.expression.graph.algebra import add, mul, negative, power, raised
from canon.expression.graph.elementary import SLOPES, function

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph.arena import Arena

__all__ = ["derivative", "directional", "gradient"]

_FEW = 2
"""Up to so many factors that vary the products of the others are formed one by one."""


def derivative(arena: Arena, node: int, symbol: Symbol, known: dict[int, int]) -> int:
    """Return ∂node/∂symbol; ``known`` holds the derivatives by this symbol already found and takes up the new ones."""
    known[arena.symbol(symbol)] = arena.one
    return _forward(arena, node, arena.mask((symbol,)), known)


def directional(arena: Arena, nodes: Sequence[int], along: Mapping[Symbol, int]) -> list[int]:
    """Return Σ ∂node/∂s ds of nodes, ds being the node that ``along`` has for the symbol s: in one sweep."""
    known = {arena.symbol(symbol): rate for symbol, rate in along.items()}
    wanted = arena.mask(along)
    return [_forward(arena, node, wanted, known) for node in nodes]


def _forward(arena: Arena, node: int, wanted: int, known: dict[int, int]) -> int:
    """Return the derivative of a node from those of the symbols; those of what it is made of are kept too."""
    if not arena.masks[node] & wanted:
        return arena.zero
    for each in _varying(arena, node, wanted, known):
        known[each] = add(
            arena,
            [
                slope if known[o] == arena.one else mul(arena, (slope, known[o]))
                for o, slope in _slopes(arena, each, wanted)
            ],
        )
    return known[node]


def gradient(arena: Arena, node: int, symbols: Sequence[Symbol]) -> tuple[int, ...]:
    """Return ∂node/∂symbol for many symbols at once."""
    own = [arena.symbol(symbol) for symbol in symbols]
    wanted = arena.mask(symbols)
    contributions: dict[int, list[int]] = {node: [arena.one]}
    for each in reversed(_varying(arena, node, wanted, ())):
        if arena.nodes[each].operands:
            adjoint = add(arena, contributions.pop(each))
            for operand, slope in _slopes(arena, each, wanted):
                product = slope if adjoint == arena.one else mul(arena, (adjoint, slope))
                contributions.setdefault(operand, []).append(product)
    return tuple(add(arena, contributions.get(each, ())) for each in own)


def _varying(arena: Arena, node: int, wanted: int, known: Collection[int]) -> list[int]:
    """Return the nodes below one that depend on the wanted symbols and are not known, operands first."""
    found, waiting, masks = set[int](), [node], arena.masks
    while waiting:
        each = waiting.pop()
        if each not in found and each not in known and masks[each] & wanted:
            found.add(each)
            waiting.extend(arena.nodes[each].operands)
    return sorted(found)


def _slopes(arena: Arena, node: int, wanted: int) -> Iterator[tuple[int, int]]:
    """Yield the operands that vary and the partial derivative of the operation by each."""
    kind, operands, _ = arena.nodes[node]
    masks = arena.masks
    if kind == "add":
        yield from ((o, arena.one) for o in operands if masks[o] & wanted)
    elif kind == "mul":
        yield from _of_product(arena, operands, wanted)
    elif kind == "pow":
        base, exponent = operands
        if masks[base] & wanted:
            yield base, mul(arena, (exponent, power(arena, base, add(arena, (exponent, arena.number(-1))))))
        if masks[exponent] & wanted:
            yield exponent, mul(arena, (node, function(arena, "log", base)))
    elif kind == "atan2":
        y, x = operands
        inverse = raised(arena, add(arena, (raised(arena, x, 2), raised(arena, y, 2))), -1)
        if masks[y] & wanted:
            yield y, mul(arena, (x, inverse))
        if masks[x] & wanted:
            yield x, negative(arena, mul(arena, (y, inverse)))
    else:
        yield operands[0], SLOPES[kind](arena, operands[0], node)


def _of_product(arena: Arena, factors: tuple[int, ...], wanted: int) -> Iterator[tuple[int, int]]:
    varying = [k for k, factor in enumerate(factors) if arena.masks[factor] & wanted]
    if len(varying) <= _FEW:
        for k in varying:
            others = factors[:k] + factors[k + 1 :]
            yield factors[k], others[0] if len(others) == 1 else mul(arena, others)
        return
    before, after = [arena.one], [arena.one]
    for factor in factors[:-1]:
        before.append(mul(arena, (before[-1], factor)))
    for factor in reversed(factors[1:]):
        after.append(mul(arena, (after[-1], factor)))
    after.reverse()
    yield from ((factors[k], mul(arena, (before[k], after[k]))) for k in varying)
