"""Pythagorean identity cos² x + sin² x = 1 applied to sums of products on an expression graph."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from canon.expression.graph.graph import Graph

__all__ = ["without_squares"]

_Monomial = frozenset[tuple[int, int]]
"""Pairs of a node and its power."""


def without_squares(graph: Graph, products: Sequence[Sequence[int]]) -> int | None:
    """Return the sum of products with cos² x + sin² x = 1 used; None where it does not apply and nothing cancels.

    Examples
    --------
    >>> from sympy import cos, sin, symbols
    >>> from canon.expression.graph.graph import Graph
    >>> m, l, x = symbols("m l x")
    >>> graph = Graph()
    >>> a, b = graph.from_sympy(l*cos(x)), graph.from_sympy(-l*sin(x))
    >>> M = graph.symbol(m)
    >>> graph.to_sympy(without_squares(graph, [(M, a, a), (M, b, b)]))
    l**2*m
    """
    terms: dict[_Monomial, Fraction] = {}
    for factors in products:
        coefficient, monomial = _collected(graph, factors)
        terms[monomial] = terms.get(monomial, Fraction(0)) + coefficient
    terms = {monomial: c for monomial, c in terms.items() if c}
    while _united(graph, terms):
        pass
    if len(terms) == len(products):
        return None
    return graph.plain_add([_product(graph, monomial, c) for monomial, c in terms.items()])


def _collected(graph: Graph, factors: Iterable[int]) -> tuple[Fraction, _Monomial]:
    """Return the number and the powers that a product consists of."""
    coefficient, powers, waiting = Fraction(1), dict[int, int](), list(factors)
    while waiting:
        each = waiting.pop()
        kind, operands, value = graph.nodes[each]
        if kind == "number":
            coefficient *= value
        elif kind == "mul":
            waiting.extend(operands)
        elif kind == "pow" and graph.nodes[operands[1]].value in (2, 3, 4):
            powers[operands[0]] = powers.get(operands[0], 0) + int(graph.nodes[operands[1]].value)
        else:
            powers[each] = powers.get(each, 0) + 1
    return coefficient, frozenset(powers.items())


def _united(graph: Graph, terms: dict[_Monomial, Fraction]) -> bool:
    """Unite one pair r cos² x + r sin² x to r, if there is one."""
    for monomial, c in terms.items():
        for node, power in monomial:
            if power < 2 or graph.nodes[node].kind != "sin":
                continue
            rest = _changed(monomial, node, -2)
            partner = _changed(rest, graph.function("cos", *graph.nodes[node].operands), 2)
            if terms.get(partner) == c:
                del terms[monomial], terms[partner]
                total = terms.pop(rest, Fraction(0)) + c
                if total:
                    terms[rest] = total
                return True
    return False


def _changed(monomial: _Monomial, node: int, by: int) -> _Monomial:
    """Return a monomial with another power of one node."""
    powers = dict(monomial)
    powers[node] = powers.get(node, 0) + by
    if not powers[node]:
        del powers[node]
    return frozenset(powers.items())


def _product(graph: Graph, monomial: _Monomial, coefficient: Fraction) -> int:
    factors = [graph.power(node, power) for node, power in sorted(monomial)]
    return graph.scaled(coefficient, graph.plain_mul(factors))
