"""Slopes of rates: the second derivatives of H that move deviations from an orbit, those that are not 0."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.cached_property import cached_property

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph

__all__ = ["Slopes", "slopes"]


@dataclass(frozen=True, eq=False)
class Slopes:
    """The matrix ∂rate_i/∂x_j, by its entries that are not 0.

    Parameters
    ----------
    graph
        The graph that holds the entries.
    rows
        For each rate the pairs (j, node).
    """

    graph: Graph
    rows: tuple[tuple[tuple[int, int], ...], ...]

    @cached_property
    def varying(self) -> tuple[int, ...]:
        """The nodes of the entries that are no constants, each once, by diagonals: along a chain they lie in order."""
        entries = sorted((abs(j - i), i, node) for i, row in enumerate(self.rows) for j, node in row)
        nodes = dict.fromkeys(node for _, _, node in entries)
        return tuple(node for node in nodes if not self.graph.is_constant(node))

    @property
    def count(self) -> int:
        """How many entries are not 0."""
        return sum(map(len, self.rows))


def slopes(graph: Graph, rates: Sequence[int], x: Sequence[Symbol], *, symmetric: bool = False) -> Slopes:
    """Return the slopes of rates by symbols.

    Parameters
    ----------
    graph
        The graph that holds the rates, and gets their slopes.
    rates, x
        The rates and the symbols.
    symmetric
        Whether the matrix is symmetric, as of −∂V/∂q by q: then both entries of a pair are one node, so that a kick
        of deviations is symplectic to round-off.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon.expression.graph.graph import Graph
    >>> a, b = symbols("a b")
    >>> graph = Graph()
    >>> found = slopes(graph, [graph.from_sympy(f) for f in (a**2 + 3 * b, 3 * a)], [a, b], symmetric=True)
    >>> [[(j, graph.to_sympy(node)) for j, node in row] for row in found.rows]
    [[(0, 2*a), (1, 3)], [(0, 3)]]
    """
    place = {symbol: j for j, symbol in enumerate(x)}
    entries = dict[tuple[int, int], int]()
    for i, rate in enumerate(rates):
        own = sorted(place[symbol] for symbol in graph.symbols(rate) if symbol in place)
        columns = [j for j in own if j >= i or not symmetric]
        found = graph.gradient(rate, [x[j] for j in columns])
        entries |= {(i, j): node for j, node in zip(columns, found, strict=True) if node != graph.zero}
    if symmetric:
        entries |= {(j, i): node for (i, j), node in entries.items()}
    rows: list[list[tuple[int, int]]] = [[] for _ in rates]
    for (i, j), node in sorted(entries.items()):
        rows[i].append((j, node))
    return Slopes(graph, tuple(map(tuple, rows)))
