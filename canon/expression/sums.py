"""Many sums of the same terms on an expression graph, sharing what they have in common."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from canon.expression.graph import Graph

__all__ = ["SharedSums"]


class SharedSums:
    """Sums of nodes that share heads and tails.

    A sum is built from its head, all but its last term, where that is known, and else from its tail. The n sums of
    the heads of a chain of n terms, or those of its tails, take n additions together instead of n²/2.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon.expression.graph import Graph
    >>> graph = Graph()
    >>> a, b, c = (graph.symbol(s) for s in symbols("a b c"))
    >>> sums = SharedSums(graph)
    >>> whole, tail = sums.of((a, b, c)), sums.of((b, c))
    >>> tail in graph.nodes[whole].operands
    True
    """

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._known: dict[tuple[int, ...], int] = {}

    def of(self, terms: tuple[int, ...]) -> int:
        """Return the sum of nodes."""
        if len(terms) < 2:
            return terms[0] if terms else self._graph.zero
        add, known = self._graph.plain_add, self._known
        start = 0
        while start < len(terms) - 2 and terms[start:] not in known and terms[start:-1] not in known:
            start += 1
        total = known.get(terms[start:])
        if total is None:
            head = known.get(terms[start:-1], terms[start])
            total = known[terms[start:]] = add((head, terms[-1]))
        for k in range(start - 1, -1, -1):
            total = known[terms[k:]] = add((terms[k], total))
        return total
