"""Polynomial degrees read from the graph, beside those that SymPy finds."""

import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.expression.graph.graph import Graph
from canon.kernel.program.polynomial_degree import polynomial_degree

x, y, k = sp.symbols("x y k", positive=True)
leaves = st.sampled_from([x, y, k, sp.Integer(2), sp.Rational(3, 7), sp.cosh(k), sp.sqrt(k)])
expressions = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.tuples(inner, inner).map(lambda pair: pair[0] + pair[1]),
        st.tuples(inner, inner).map(lambda pair: pair[0] * pair[1]),
        st.tuples(inner, st.integers(1, 3)).map(lambda pair: pair[0] ** pair[1]),
    ),
    max_leaves=6,
)


def degree(f, *variables):
    graph = Graph()
    return polynomial_degree(graph, graph.from_sympy(f), variables)


@given(expressions)
@settings(max_examples=50)
def test_it_is_the_degree_where_nothing_cancels(f):
    assert degree(f, x, y) == sp.Poly(f, x, y).total_degree()


@given(expressions, st.sampled_from([sp.sin(x), 1 / (1 + y), sp.sqrt(x), x**k, sp.exp(y * x)]))
@settings(max_examples=50)
def test_functions_of_the_variables_are_no_polynomials(f, wrong):
    assert degree(f + wrong, x, y) is None
    assert degree(f + wrong, sp.Symbol("z")) == 0


def test_what_cancels_counts():
    assert degree((x + 1) ** 3 - x**3, x) == 3
