"""Equivalent control: what stands in place of the signs of several switching functions that all stay zero.

Two blocks that dry friction holds at once feel forces between −μN and μN, those that keep both at rest. Where rates
depend on the signs linearly these are put in place of them: ġ = a + B s = 0 (V. I. Utkin, Sliding Modes in Control and
Optimization, Springer 1992, ch. 2, doi:10.1007/978-3-642-84379-2). A function is held while its share s is within ±1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph

__all__ = ["shares_that_hold"]


def shares_that_hold(
    graph: Graph,
    inputs: Sequence[Symbol],
    zeros: Mapping[int, int],
    rates: Callable[[Mapping[int, int]], Sequence[int]],
) -> Mapping[int, int] | None:
    """Return what stands in place of the signs of held functions, by their number; None where nothing is determined.

    Parameters
    ----------
    graph, inputs
        The graph, and the variables of the state with the time.
    zeros
        The nodes of the held functions, by their number.
    rates
        Returns the nodes of the state's rates with nodes in place of these signs.
    """
    shares = {k: graph.symbol(sp.Dummy(f"share_{k}", real=True)) for k in zeros}
    moving = [*rates(shares), graph.one]
    speeds = [
        graph.add([graph.mul(pair) for pair in zip(graph.gradient(zero, inputs), moving, strict=True)])
        for zero in zeros.values()
    ]
    unknown = [graph.nodes[share].value for share in shares.values()]
    B = [graph.gradient(speed, unknown) for speed in speeds]
    if not graph.all_symbols([each for row in B for each in row]).isdisjoint(unknown):
        return None
    a = graph.substitute(speeds, dict.fromkeys(shares.values(), graph.zero))
    solved = _solved(graph, B, [graph.negative(each) for each in a])
    return None if solved is None else dict(zip(zeros, solved, strict=True))


def _solved(graph: Graph, matrix: Sequence[Sequence[int]], right: Sequence[int]) -> list[int] | None:
    """Return the solution by elimination, whose pivots are the first entries that are not zero as they stand."""
    rows = [[*row, b] for row, b in zip(matrix, right, strict=True)]
    n = len(rows)
    for k in range(n):
        pivot = next((i for i in range(k, n) if rows[i][k] != graph.zero), None)
        if pivot is None:
            return None
        rows[k], rows[pivot] = rows[pivot], rows[k]
        inverse = graph.power(rows[k][k], -1)
        rows[k] = [graph.mul((inverse, each)) for each in rows[k]]
        for i in range(n):
            factor = rows[i][k]
            if i != k and factor != graph.zero:
                rows[i] = [
                    graph.add((each, graph.negative(graph.mul((factor, own)))))
                    for each, own in zip(rows[i], rows[k], strict=True)
                ]
    return [row[n] for row in rows]
