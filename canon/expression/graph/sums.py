"""Sums of the same terms on an expression graph: common parts shared, signs taken out."""

from __future__ import annotations

from operator import ne
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from canon.expression.graph.graph import Graph

__all__ = ["SharedSums", "opposite", "signed_product"]


def opposite(graph: Graph, node: int) -> int:
    """Return −node, whose factor −1 stands apart: −(−x) is x, and x and −x share x.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon.expression.graph.graph import Graph
    >>> graph = Graph()
    >>> x = graph.from_sympy(symbols("a") * symbols("b"))
    >>> opposite(graph, opposite(graph, x)) == x
    True
    """
    positive = _unsigned(graph, node)
    return graph.multiple(-1, node) if positive == node and node != graph.zero else positive


def signed_product(graph: Graph, factors: Iterable[int]) -> int:
    """Return a product, or the opposite of one without signs where an odd number of factors are opposites."""
    odd, unsigned = False, list[int]()
    for factor in factors:
        positive = _unsigned(graph, factor)
        odd ^= positive != factor
        unsigned.append(positive)
    product = graph.plain_mul(unsigned)
    return opposite(graph, product) if odd else product


def _unsigned(graph: Graph, node: int) -> int:
    """Return x where a node is −x, and else the node."""
    kind, operands, _ = graph.nodes[node]
    if kind == "mul" and len(operands) == 2 and operands[0] == graph.minus_one:
        return operands[1]
    return node


class SharedSums:
    """Sums of nodes that share heads and tails.

    A sum is built from its head, all but its last term, where that is known, and else from its tail. The n sums of
    the heads of a chain of n terms, or those of its tails, take n additions together instead of n²/2. Where all terms
    are opposites, the sum is the opposite of one without signs.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon.expression.graph.graph import Graph
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
        if _unsigned(self._graph, terms[0]) != terms[0]:
            positive = tuple([_unsigned(self._graph, term) for term in terms])
            if all(map(ne, positive, terms)):
                return opposite(self._graph, self._of(positive))
        return self._of(terms)

    def _of(self, terms: tuple[int, ...]) -> int:
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
