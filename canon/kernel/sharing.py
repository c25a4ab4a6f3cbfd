"""Equations written with fewer products of two functions: parts of products and of sums shared, sums factored.

A Taylor coefficient of order k of a product of two functions is a sum of k products, that of a constant multiple
one product: what a right-hand side costs is its number of products and quotients of functions. A product
is taken here as a list of factors, each a function or its reciprocal. Greedily, the pair of factors that occurs
in most products becomes a function of its own, N/D for instance, whose square then is N²/D²; then the pair of terms
that occurs in most sums, up to a constant; then common factors of a sum's terms are taken out of it. Constant factors
do not count, nothing is expanded, and the function stays the same wherever it is defined.

Source: A. Hosangadi, F. Fallah, R. Kastner, Optimizing polynomial expressions by algebraic factorization and common
subexpression elimination, IEEE Trans. Comput.-Aided Des. 25 (2006) 2012–2022, doi:10.1109/TCAD.2005.862741.
"""

from __future__ import annotations

import heapq
import itertools
from collections import Counter
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from canon.expression.graph import Graph

__all__ = ["with_shared_products"]

_Factor = tuple[int, int]
"""A function and 1, or −1 for its reciprocal; functions are nodes, or negative numbers for new ones."""

_Product = tuple[_Factor, ...]
"""Factors in order, equal ones repeated."""

_Sum = tuple[tuple[int, Fraction], ...]
"""Products by their numbers, and their factors."""

_Pair = tuple[int, int, Fraction]
"""Two products of a sum and the second's factor as a multiple of the first's."""

_Row = TypeVar("_Row")
_P = TypeVar("_P")

_LONGEST = 12
"""Products of more factors, and sums of more terms, stay as they are."""

_HIGHEST = 2
"""Powers up to this one are repeated factors; higher ones count as functions."""


def with_shared_products(graph: Graph, nodes: Sequence[int]) -> list[int]:
    """Return the same functions, written with fewer products and quotients of functions.

    Parameters
    ----------
    graph
        The graph; what is new is added to it.
    nodes
        The functions that are wanted together.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon.expression.graph import Graph
    >>> x, y, z = symbols("x y z")
    >>> graph = Graph()
    >>> wanted = [graph.from_sympy(each) for each in (x / y, x**2 / y**2 + 3 * z * x / y)]
    >>> [graph.to_sympy(node) for node in with_shared_products(graph, wanted)]
    [x/y, x*(x/y + 3*z)/y]
    """
    table = _Table(graph)
    table.read(nodes)
    _share_products(table)
    _share_sums(table)
    table.count_uses()
    for node in list(table.sums):
        _factor_sum(table, node)
    _share_products(table)
    return _Writing(table).written(nodes)


@dataclass
class _Term:
    """A constant multiple of a product; the constant is a node."""

    factor: int
    product: int


@dataclass
class _Table:
    """The products and sums of some functions; products are numbered, so that they can change in place."""

    graph: Graph
    products: list[_Product] = field(default_factory=list[_Product])
    uses: Counter[int] = field(default_factory=Counter[int])
    sums: dict[int, list[_Term]] = field(default_factory=dict[int, list[_Term]])
    meanings: dict[int, _Term] = field(default_factory=dict[int, _Term])
    """What multiple of which product a node of the graph, or a new function, is."""

    _number: dict[_Product, int] = field(default_factory=dict[_Product, int])
    _new: itertools.count[int] = field(default_factory=lambda: itertools.count(1))

    def read(self, nodes: Iterable[int]) -> None:
        """Enter what nodes are made of."""
        waiting, seen = list(nodes), set[int]()
        while waiting:
            node = waiting.pop()
            if node in seen:
                continue
            seen.add(node)
            kind, operands, _ = self.graph.nodes[node]
            if kind == "add":
                self.sums[node] = [self._term(term) for term in operands]
                waiting.extend(o for term in self.sums[node] for o, _ in self.products[term.product])
            elif kind in ("mul", "pow"):
                self.meanings[node] = term = self._term(node)
                own = [o for o, _ in self.products[term.product]]
                waiting.extend(operands if own == [node] else own)
            else:
                waiting.extend(operands)

    def term(self, factor: int, product: _Product) -> _Term:
        """Return a multiple of a product, entered where it is new."""
        product = tuple(sorted(product))
        number = self._number.get(product)
        if number is None:
            number = self._number[product] = len(self.products)
            self.products.append(product)
        self.uses[number] += 1
        return _Term(factor, number)

    def numerical(self, terms: Sequence[_Term]) -> _Sum | None:
        """Return a sum as products with rational factors, or None where it is long or has others."""
        nodes = [self.graph.nodes[term.factor] for term in terms]
        if len(terms) > _LONGEST or any(node.kind != "number" for node in nodes):
            return None
        return tuple((term.product, node.value) for term, node in zip(terms, nodes, strict=True))

    def count_uses(self) -> None:
        """Count in how many places each product is read."""
        terms = itertools.chain(self.meanings.values(), *self.sums.values())
        self.uses = Counter(term.product for term in terms)

    def new(self) -> int:
        """Return a name for a new function."""
        return -next(self._new)

    def _term(self, node: int) -> _Term:
        constants, factors, waiting = list[int](), list[_Factor](), [node]
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

    def _factors(self, node: int) -> list[_Factor]:
        kind, operands, _ = self.graph.nodes[node]
        exponent = self.graph.nodes[operands[1]] if kind == "pow" else None
        if exponent is None or exponent.kind != "number":
            return [(node, 1)]
        times = exponent.value
        if times.denominator != 1 or abs(times) > _HIGHEST:
            return [(node, 1)]
        return [(operands[0], 1 if times > 0 else -1)] * abs(int(times))


def _share_products(table: _Table) -> None:
    """Make pairs of factors that several products have functions of their own."""

    def named(pair: _Product) -> int:
        name = table.new()
        table.meanings[name] = _Term(table.graph.one, len(table.products))
        table.products.append(pair)
        return name

    rows = dict(enumerate(table.products))
    _share(rows, _pairs, lambda row, pair, name: _replaced(row, pair, (name, 1)), named)
    table.products[: len(rows)] = rows.values()


def _share_sums(table: _Table) -> None:
    """Make pairs of terms that several sums have, up to a constant, functions of their own."""

    def named(pair: _Pair) -> int:
        first, second, ratio = pair
        name = table.new()
        table.sums[name] = [_Term(table.graph.one, first), _Term(table.graph.number(ratio), second)]
        return name

    def replaced(row: _Sum, pair: _Pair, name: int) -> _Sum:
        first, second, _ = pair
        rest = {product: factor for product, factor in row if product not in (first, second)}
        product = table.term(table.graph.one, ((name, 1),)).product
        return (*rest.items(), (product, dict(row)[first]))

    rows = {node: row for node, terms in table.sums.items() if (row := table.numerical(terms)) is not None}
    _share(rows, _term_pairs, replaced, named)
    for node, row in rows.items():
        table.sums[node] = [_Term(table.graph.number(factor), product) for product, factor in row]


def _share(
    rows: dict[int, _Row],
    pairs_of: Callable[[_Row], set[_P]],
    replaced: Callable[[_Row, _P, int], _Row],
    named: Callable[[_P], int],
) -> None:
    """Name the pair that most rows have and put the name in its place, until no two rows have a pair in common."""
    having: dict[_P, set[int]] = {}
    for number, row in rows.items():
        for pair in pairs_of(row):
            having.setdefault(pair, set()).add(number)
    queue: list[tuple[int, Any]] = [(-len(found), pair) for pair, found in having.items()]
    heapq.heapify(queue)
    while queue:
        count, pair = heapq.heappop(queue)
        now = len(having[pair])
        if now < 2:
            continue
        if -count != now:
            heapq.heappush(queue, (-now, pair))
            continue
        name = named(pair)
        for number in sorted(having[pair]):
            before = rows[number]
            after = rows[number] = replaced(before, pair, name)
            for gone in pairs_of(before) - pairs_of(after):
                having[gone].discard(number)
            for found in pairs_of(after) - pairs_of(before):
                having.setdefault(found, set()).add(number)
                heapq.heappush(queue, (-len(having[found]), found))


def _pairs(product: _Product) -> set[_Product]:
    return {tuple(sorted(pair)) for pair in itertools.combinations(product, 2)}


def _term_pairs(row: _Sum) -> set[_Pair]:
    # Of 2a + b the name is b + 2a: b then needs no factor.
    ordered = sorted(row, key=lambda term: (abs(term[1]) != 1, term[0]))
    return {(a[0], b[0], b[1] / a[1]) for a, b in itertools.combinations(ordered, 2)}


def _replaced(product: _Product, pair: _Product, new: _Factor) -> _Product:
    """Return a product with a pair of its factors, as often as it occurs, as one factor."""
    counts = Counter(product)
    needed = Counter(pair)
    times = min(counts[each] // needed[each] for each in needed)
    for each in needed:
        counts[each] -= times * needed[each]
    counts[new] += times
    return tuple(sorted(counts.elements()))


def _factor_sum(table: _Table, node: int) -> None:
    """Take common factors out of a sum's terms as long as that saves products."""
    terms = table.sums[node]
    while True:
        own = [t for t in terms if table.uses[t.product] == 1 and len(table.products[t.product]) > 1]
        counts = Counter(factor for term in own for factor in set(table.products[term.product]))
        common, count = max(counts.items(), key=lambda item: (item[1], item[0]), default=((0, 1), 0))
        if count < 2:
            break
        inside, outside = list[_Term](), list[_Term]()
        for term in terms:
            factors = list(table.products[term.product])
            if term in own and common in factors:
                factors.remove(common)
                inside.append(table.term(term.factor, tuple(factors)))
            else:
                outside.append(term)
        rest = table.new()
        table.sums[rest] = inside
        _factor_sum(table, rest)
        terms = [*outside, table.term(table.graph.one, (common, (rest, 1)))]
    table.sums[node] = terms


class _Writing:
    """Writes the table back into the graph, what is read before what reads it."""

    def __init__(self, table: _Table) -> None:
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

    def _factors_of(self, node: int) -> _Product | None:
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

    def _term(self, term: _Term) -> int:
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
