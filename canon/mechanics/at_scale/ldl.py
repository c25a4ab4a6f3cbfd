"""LDLᵀ factorisation on an expression graph: linear equations solved in n³/6 products, nothing expanded or inverted."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.expression.graph.graph import Graph

__all__ = ["solved_on_graph"]


def solved_on_graph(graph: Graph, M: Sequence[Sequence[int]], right: Sequence[int]) -> tuple[int, ...]:
    """Return the nodes x with M x = right for a symmetric positive definite M.

    Parameters
    ----------
    graph
        The graph.
    M
        Lower triangle: row i has i + 1 nodes. No rows are exchanged, which definiteness allows.
    right
        The right-hand side.

    Raises
    ------
    ZeroDivisionError
        A pivot is 0 on the graph.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon.expression.graph.graph import Graph
    >>> a, b = symbols("a b", positive=True)
    >>> graph = Graph()
    >>> A, B = graph.symbol(a), graph.symbol(b)
    >>> x = solved_on_graph(graph, [[A], [graph.zero, B]], [B, A])
    >>> [graph.to_sympy(node) for node in x]
    [b/a, a/b]
    """
    add, mul, minus = graph.plain_add, graph.plain_mul, graph.negative
    n = len(right)
    lower: list[list[int]] = []  # L
    inverse: list[int] = []
    y: list[int] = []
    for i in range(n):
        opposite: list[int] = []  # −L_ij D_j
        row: list[int] = []  # L_ij
        for j in range(i):
            scaled = add((M[i][j], *map(mul, zip(opposite, lower[j], strict=True))))
            opposite.append(minus(scaled))
            row.append(mul((scaled, inverse[j])))
        pivot = add((M[i][i], *map(mul, zip(opposite, row, strict=True))))
        if pivot == graph.zero:
            raise ZeroDivisionError(
                f"pivot {i + 1} of the mass matrix is 0; L does not determine the accelerations: use fewer coordinates"
            )
        lower.append(row)
        inverse.append(graph.power(pivot, -1))
        y.append(add((right[i], *map(mul, zip(row, map(minus, y), strict=True)))))
    x, taken = [graph.zero] * n, [graph.zero] * n
    for i in reversed(range(n)):
        x[i] = add((mul((y[i], inverse[i])), *(mul((lower[k][i], taken[k])) for k in range(i + 1, n))))
        taken[i] = minus(x[i])
    return tuple(x)
