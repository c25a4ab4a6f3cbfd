"""Sums, products and squares that the mass matrix is put together from, against SymPy, with wrong twins."""

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.expression.graph.graph import Graph
from canon.expression.graph.pythagoras import without_squares
from canon.expression.graph.sums import SharedSums, opposite, signed_product

a, b, c, m, x, y = sp.symbols("a b c m x y", positive=True)
POINT = {a: 0.7, b: 1.3, c: -0.4, m: 2.1, x: 0.6, y: 1.9}


def value(graph, node):
    return float(graph.evaluate([node], POINT)[0])


def united(*products):
    graph = Graph()
    node = without_squares(graph, [[graph.from_sympy(f) for f in product] for product in products])
    return None if node is None else graph.to_sympy(node)


def test_a_circle():
    s, k = sp.sin(x), sp.cos(x)
    assert united((m, a * k, a * k), (m, a * s, a * s)) == m * a**2
    assert united((m, a * k, b * k), (m, -a * s, -b * s)) == m * a * b
    assert united((m, a * k, b * s), (m, -a * s, b * k)) == 0
    assert united((m, a * k, a * k), (m, -a * s, a * s)) is None
    assert united((m, a * k, a * k), (c, a * s, a * s)) is None
    assert united((m, sp.cos(x), sp.cos(x)), (m, sp.sin(y), sp.sin(y))) is None


def test_a_sphere():
    """x = (sin x cos y, sin x sin y, cos x): the metric is diagonal, 1 and sin² x."""
    slopes_x = (sp.cos(x) * sp.cos(y), sp.cos(x) * sp.sin(y), -sp.sin(x))
    slopes_y = (-sp.sin(x) * sp.sin(y), sp.sin(x) * sp.cos(y))
    assert united(*((m, f, f) for f in slopes_x)) == m
    assert united(*((m, f, g) for f, g in zip(slopes_x, slopes_y, strict=False))) == 0
    assert united(*((m, f, f) for f in slopes_y)) == m * sp.sin(x) ** 2


@settings(max_examples=80, deadline=None)
@given(
    st.lists(
        st.lists(
            st.sampled_from([a, b, -1, sp.sin(x), sp.cos(x), sp.sin(y), -sp.cos(y), sp.cos(x) ** 2]),
            max_size=5,
        ),
        min_size=1,
        max_size=6,
    )
)
def test_squares_keep_the_value(products):
    graph = Graph()
    nodes = [[graph.from_sympy(sp.sympify(f)) for f in product] for product in products]
    found = without_squares(graph, nodes)
    plain = sum(value(graph, graph.mul(product)) for product in nodes)
    if found is not None:
        assert value(graph, found) == pytest.approx(plain, rel=1e-12, abs=1e-12)


@settings(max_examples=80, deadline=None)
@given(st.lists(st.sampled_from([a, -a, b, -b, a * b, -a * b, c]), min_size=1, max_size=7))
def test_signs_are_taken_out_of_products_and_sums(terms):
    graph = Graph()
    nodes = [graph.apart(graph.from_sympy(f)) for f in terms]
    product, total = signed_product(graph, nodes), SharedSums(graph).of(tuple(nodes))
    assert value(graph, product) == pytest.approx(float(sp.Mul(*terms).subs(POINT)), rel=1e-14)
    assert value(graph, total) == pytest.approx(float(sp.Add(*terms).subs(POINT)), rel=1e-13, abs=1e-13)
    minus = opposite(graph, product)
    assert value(graph, minus) == -value(graph, product)
    assert opposite(graph, minus) == product
    inside = graph.reachable([product])
    signs = [n for n in inside if graph.nodes[n].kind == "mul" and graph.minus_one in graph.nodes[n].operands]
    assert set(signs) <= {product}


def test_multiples_share_what_they_multiply():
    graph = Graph()
    f = graph.from_sympy(-3 * a * sp.sin(x))
    apart = graph.apart(f)
    assert graph.nodes[apart].operands == (graph.number(-3), graph.from_sympy(a * sp.sin(x)))
    assert graph.apart(graph.from_sympy(a * sp.sin(x))) == graph.from_sympy(a * sp.sin(x))
    assert graph.multiple(Fraction(1, 2), apart) != graph.from_sympy(-3 * a * sp.sin(x) / 2)
    assert value(graph, graph.multiple(Fraction(1, 2), apart)) == pytest.approx(
        value(graph, f) / 2, rel=1e-15
    )


def test_masks_tell_what_nodes_depend_on():
    graph = Graph()
    f, g = graph.from_sympy(a * sp.sin(x)), graph.from_sympy(b + 1)
    assert graph.masks[f] & graph.mask([a])
    assert not graph.masks[f] & graph.mask([b, y])
    assert graph.symbols(f) == {a, x}
    assert graph.all_symbols([f, g]) == {a, b, x}
    assert graph.derivative(f, y) == graph.zero == graph.derivative(g, x)
