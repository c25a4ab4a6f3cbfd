"""Sums of multiples of products, the form of equations while their products are shared (see shared_products.py)."""

from __future__ import annotations

import itertools
from collections import Counter
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from canon.expression.graph.graph import Graph

__all__ = ["Factor", "Product", "Sum", "SumTable", "Term", "written_back"]

Factor = tuple[int, int]
"""A function and 1, or −1 for its reciprocal; functions are nodes, or negative numbers for new ones."""

Product = tuple[Factor, ...]
"""Factors in order, equal ones repeated."""

Sum = tuple[tuple[int, Fraction], ...]
"""Products by their numbers, each once, and their factors."""

_LONGEST = 12
"""Products of more factors, and sums of more terms, stay as they are."""

_HIGHEST = 2
"""Powers up to this one are repeated factors; higher ones count as functions."""


@dataclass
class Term:
    """A constant multiple of a product; the constant is a node."""

    factor: int
    product: int


@dataclass
class SumTable:
    """The products and sums of some functions; products are numbered, so that they can change in place."""

    graph: Graph
    products: list[Product] = field(default_factory=list[Product])
    uses: Counter[int] = field(default_factory=Counter[int])
    sums: dict[int, list[Term]] = field(default_factory=dict[int, list[Term]])
    meanings: dict[int, Term] = field(default_factory=dict[int, Term])
    """What multiple of which product a node of the graph, or a new function, is."""

    _number: dict[Product, int] = field(default_factory=dict[Product, int])
    _new: itertools.count[int] = field(default_factory=lambda: itertools.count(1))

    def read(self, nodes: Iterable[int]) -> None:
        """Enter what nodes are made of."""
        waiting, seen = list(nodes), set[int]()
        while waiting:
            node = waiting.pop()
            if node not in seen:
                seen.add(node)
                waiting.extend(self._entered(node))

    def _entered(self, node: int) -> Sequence[int]:
        """Enter one node; return the nodes that its terms and factors are."""
        kind, operands, _ = self.graph.nodes[node]
        if kind == "add":
            self.sums[node] = [self._term(term) for term in operands]
            return [o for term in self.sums[node] for o, _ in self.products[term.product]]
        if kind not in ("mul", "pow"):
            return operands
        self.meanings[node] = term = self._term(node)
        own = [o for o, _ in self.products[term.product]]
        return operands if own == [node] else own

    def term(self, factor: int, product: Product) -> Term:
        """Return a multiple of a product, entered where it is new."""
        product = tuple(sorted(product))
        number = self._number.get(product)
        if number is None:
            number = self._number[product] = len(self.products)
            self.products.append(product)
        self.uses[number] += 1
        return Term(factor, number)

    def numerical(self, terms: Sequence[Term]) -> Sum | None:
        """Return a sum as products with rational factors, or None where it is long or has others."""
        nodes = [self.graph.nodes[term.factor] for term in terms]
        if len(terms) > _LONGEST or any(node.kind != "number" for node in nodes):
            return None
        factors: dict[int, Fraction] = {}
        for term, node in zip(terms, nodes, strict=True):
            factors[term.product] = factors.get(term.product, Fraction(0)) + node.value
        return tuple(factors.items())

    def count_uses(self) -> None:
        """Count in how many places each product is read."""
        terms = itertools.chain(self.meanings.values(), *self.sums.values())
        self.uses = Counter(term.product for term in terms)

    def new(self) -> int:
        """Return a name for a new function."""
        return -next(self._new)

    def _term(self, node: int) -> Term:
        constants, factors, waiting = list[int](), list[Factor](), [node]
        while waiting:
            each = waiting.pop()
            if not self.graph.masks[each]:
                constants.append(each)
            elif self.graph.nodes[each].kind == "mul":
                waiting.extend(self.graph.nodes[each].operands)
            else:
                factors.extend(self._factors(each))
        if len(factors) > _LONGEST:
            return self.term(self.graph.one, ((node, 1),))
        return self.term(self.graph.mul(constants), tuple(factors))

    def _factors(self, node: int) -> list[Factor]:
        kind, operands, _ = self.graph.nodes[node]
        exponent = self.graph.nodes[operands[1]] if kind == "pow" else None
        if exponent is None or exponent.kind != "number":
            return [(node, 1)]
        times = exponent.value
        if times.denominator != 1 or abs(times) > _HIGHEST:
            return [(node, 1)]
        return [(operands[0], 1 if times > 0 else -1)] * abs(int(times))


def written_back(table: SumTable, nodes: Sequence[int]) -> list[int]:
    """Write the functions of a table back into its graph, and return the nodes that given ones have become."""
    return _Writing(table).written(nodes)


class _Writing:
    """Writes the table back into the graph, what is read before what reads it."""

    def __init__(self, table: SumTable) -> None:
        self.table, self.graph = table, table.graph
        self.done: dict[int, int] = {}

    def written(self, nodes: Sequence[int]) -> list[int]:
        waiting = list(reversed(nodes))
        while waiting:
            node = waiting[-1]
            if node in self.done:
                waiting.pop()
                continue
            missing = [each for each in self._read(node) if each not in self.done]
            if missing:
                waiting.extend(reversed(missing))
            else:
                waiting.pop()
                self.done[node] = self._write(node)
        return [self.done[node] for node in nodes]

    def _read(self, node: int) -> list[int]:
        table = self.table
        if node in table.sums:
            return [o for term in table.sums[node] for o, _ in table.products[term.product]]
        own = self._factors_of(node)
        return list(self.graph.nodes[node].operands) if own is None else [o for o, _ in own]

    def _factors_of(self, node: int) -> Product | None:
        """Return a product's factors, or None where it has no other than itself."""
        term = self.table.meanings.get(node)
        if term is None:
            return None
        product = self.table.products[term.product]
        return None if product == ((node, 1),) else product

    def _write(self, node: int) -> int:
        graph = self.graph
        if node in self.table.sums:
            return graph.plain_add(self._term(term) for term in self.table.sums[node])
        if self._factors_of(node) is not None:
            return self._term(self.table.meanings[node])
        kind, operands, _ = graph.nodes[node]
        new = tuple(self.done[o] for o in operands)
        return node if new == operands else self._rebuilt(kind, new)

    def _rebuilt(self, kind: str, operands: tuple[int, ...]) -> int:
        if kind == "mul":
            return self.graph.plain_mul(operands)
        return self.graph.operation(kind, operands)

    def _term(self, term: Term) -> int:
        graph, powers = self.graph, Counter[int]()
        for function, sign in self.table.products[term.product]:
            powers[self.done[function]] += sign
        product = graph.plain_mul(
            base if times == 1 else graph.operation("pow", (base, graph.number(times)))
            for base, times in powers.items()
            if times
        )
        if product == graph.one or term.factor == graph.one:
            return graph.plain_mul([term.factor, product])
        return graph.operation("mul", (term.factor, product))
