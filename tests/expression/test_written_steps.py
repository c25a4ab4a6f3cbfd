"""Evaluations written as a function: the bits of walking over the steps, of numbers one by one and of arrays."""

import operator

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.array import all_finite
from canon.expression.graph.evaluation import _steps, _walked
from canon.expression.graph.graph import Graph
from canon.expression.graph.number_systems import FLOAT64, LONGDOUBLE
from canon.expression.graph.written_steps import value_of, written_steps

X, Y = sp.symbols("x y", real=True)
LEAVES = st.sampled_from([X, Y, sp.Integer(2), sp.Rational(1, 3), sp.pi, sp.Rational(-7, 5)])
POWERS = st.sampled_from([2, 3, -1, -2, sp.Rational(1, 2), sp.Rational(-3, 2), sp.Rational(2, 3)])
FORMULAS = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.tuples(inner, inner).map(lambda p: p[0] + p[1]),
        st.tuples(inner, inner).map(lambda p: p[0] * p[1]),
        st.tuples(inner, POWERS).map(lambda p: p[0] ** p[1] if p[0] != 0 else p[0]),
        st.tuples(st.sampled_from([sp.sin, sp.exp, sp.atan, sp.Abs]), inner).map(lambda p: p[0](p[1])),
    ),
    max_leaves=12,
)
NUMBERS = st.floats(-3, 3) | st.sampled_from([0.0, 1e-200, -1e200])


def finite(formula):
    return not formula.has(sp.zoo, sp.nan, sp.oo, sp.I)


@settings(max_examples=150, deadline=None)
@given(st.lists(FORMULAS.filter(finite), min_size=1, max_size=3), st.lists(NUMBERS, min_size=4, max_size=4))
def test_the_same_bits(formulas, numbers):
    graph = Graph()
    nodes = tuple(graph.from_sympy(f) for f in formulas)
    x, y = np.array(numbers[:2]), np.array(numbers[2:])
    for arithmetic, dtype in ((FLOAT64, np.float64), (LONGDOUBLE, np.longdouble)):
        steps, places = _steps(graph, nodes, arithmetic)
        with np.errstate(all="ignore"):
            point = {X: x.astype(dtype), Y: y.astype(dtype)}
            walked, written = _walked(steps, places, point), written_steps(steps, places)(point)
            for a, b in zip(walked, written, strict=True):
                np.testing.assert_array_equal(a, b)
            if dtype is np.longdouble:  # as energies at a few samples are evaluated
                for k in range(2):
                    alone = written_steps(steps, places)({X: point[X][k], Y: point[Y][k]})
                    for a, b in zip(walked, alone, strict=True):
                        np.testing.assert_array_equal(np.broadcast_to(a, 2)[k], b)


def test_long_sums_go_from_the_left():
    steps = [(None, (), 0.1)] * 3000 + [(operator.add, tuple(range(3000)), None)]
    total = 0.1
    for _ in range(2999):
        total += 0.1
    assert written_steps(steps, [3000])({}) == [total]


def test_a_missing_symbol_is_told_of():
    graph = Graph()
    node = graph.from_sympy(X * Y)
    for _ in range(20):
        with pytest.raises(KeyError, match="no value given for the symbol y"):
            graph.evaluate([node], {X: 1.0})
    assert graph.evaluate([node], {X: 2.0, Y: 3.0}) == [6.0]
    with pytest.raises(KeyError, match="symbol x"):
        written_steps([(value_of, (), X)], [0])({})


@given(st.lists(st.floats() | st.sampled_from([np.inf, -np.inf, np.nan, 1e300]), max_size=6))
def test_all_finite(numbers):
    for dtype in (np.float64, np.longdouble):
        assert all_finite(np.array(numbers, dtype=dtype)) == bool(np.isfinite(numbers).all())
