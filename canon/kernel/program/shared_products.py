"""Shared products: equations rewritten with fewer products of functions, sums factored and common parts reused.

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
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeVar

from canon.kernel.program.terms import Product, Sum, SumTable, Term, written_back

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.expression.graph.graph import Graph
    from canon.kernel.program.terms import Factor

__all__ = ["with_shared_products"]

_Pair = tuple[int, int, Fraction]
"""Two products of a sum and the second's factor as a multiple of the first's."""

_Row = TypeVar("_Row")
_P = TypeVar("_P")


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
    >>> from canon.expression.graph.graph import Graph
    >>> x, y, z = symbols("x y z")
    >>> graph = Graph()
    >>> wanted = [graph.from_sympy(each) for each in (x / y, x**2 / y**2 + 3 * z * x / y)]
    >>> [graph.to_sympy(node) for node in with_shared_products(graph, wanted)]
    [x/y, x*(x/y + 3*z)/y]
    """
    table = SumTable(graph)
    table.read(nodes)
    _share_products(table)
    _share_sums(table)
    table.count_uses()
    for node in list(table.sums):
        _factor_sum(table, node)
    _share_products(table)
    return written_back(table, nodes)


def _share_products(table: SumTable) -> None:
    """Make pairs of factors that several products have functions of their own."""

    def named(pair: Product) -> int:
        name = table.new()
        table.meanings[name] = Term(table.graph.one, len(table.products))
        table.products.append(pair)
        return name

    rows = dict(enumerate(table.products))
    _share(rows, _pairs, lambda row, pair, name: _replaced(row, pair, (name, 1)), named)
    table.products[: len(rows)] = rows.values()


def _share_sums(table: SumTable) -> None:
    """Make pairs of terms that several sums have, up to a constant, functions of their own."""

    def named(pair: _Pair) -> int:
        first, second, ratio = pair
        name = table.new()
        table.sums[name] = [Term(table.graph.one, first), Term(table.graph.number(ratio), second)]
        return name

    def replaced(row: Sum, pair: _Pair, name: int) -> Sum:
        first, second, _ = pair
        rest = {product: factor for product, factor in row if product not in (first, second)}
        product = table.term(table.graph.one, ((name, 1),)).product
        return (*rest.items(), (product, dict(row)[first]))

    rows = {node: row for node, terms in table.sums.items() if (row := table.numerical(terms)) is not None}
    _share(rows, _term_pairs, replaced, named)
    for node, row in rows.items():
        table.sums[node] = [Term(table.graph.number(factor), product) for product, factor in row]


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


def _pairs(product: Product) -> set[Product]:
    return {tuple(sorted(pair)) for pair in itertools.combinations(product, 2)}


def _term_pairs(row: Sum) -> set[_Pair]:
    # Of 2a + b the name is b + 2a: b then needs no factor.
    ordered = sorted(row, key=lambda term: (abs(term[1]) != 1, term[0]))
    return {(a[0], b[0], b[1] / a[1]) for a, b in itertools.combinations(ordered, 2)}


def _replaced(product: Product, pair: Product, new: Factor) -> Product:
    """Return a product with a pair of its factors, as often as it occurs, as one factor."""
    counts = Counter(product)
    needed = Counter(pair)
    times = min(counts[each] // needed[each] for each in needed)
    for each in needed:
        counts[each] -= times * needed[each]
    counts[new] += times
    return tuple(sorted(counts.elements()))


def _factor_sum(table: SumTable, node: int) -> None:
    """Take common factors out of a sum's terms as long as that saves products."""
    terms = table.sums[node]
    while True:
        own = [t for t in terms if table.uses[t.product] == 1 and len(table.products[t.product]) > 1]
        counts = Counter(factor for term in own for factor in set(table.products[term.product]))
        common, count = max(counts.items(), key=lambda item: (item[1], item[0]), default=((0, 1), 0))
        if count < 2:
            break
        inside, outside = list[Term](), list[Term]()
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
