"""Coordinates and their rates, and the total time derivative."""

import pickle

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from canon import coordinates, parameters, time, time_derivative
from canon.expression.symbol import without_dynamicsymbols


def test_a_coordinate_knows_its_rates_and_momentum():
    theta, phi = coordinates("theta, phi")
    assert (theta.dot.name, theta.ddot.name, theta.momentum.name) == ("theta_dot", "theta_ddot", "p_theta")
    assert theta.dot == theta.dot
    assert theta.dot != phi.dot
    assert theta.is_real
    assert theta.dot.is_real


def test_assumptions_reach_the_coordinate_and_not_its_rate():
    (r,) = coordinates("r", positive=True)
    assert r.is_positive
    assert r.dot.is_positive is None


def test_rates_print_with_dots_in_latex():
    (theta,) = coordinates("theta")
    assert sp.latex(theta.dot) == r"\dot{\theta}"
    assert sp.latex(theta.ddot**2) == r"\ddot{\theta}^{2}"


def test_symbols_survive_pickling():
    (r,) = coordinates("r", positive=True)
    assert pickle.loads(pickle.dumps(r.dot + r)) == r.dot + r


@pytest.mark.parametrize("names", ["", "  ", "x y x"])
def test_unusable_names_are_refused(names):
    with pytest.raises(ValueError, match=r"names given|named twice"):
        coordinates(names)


def test_parameters_take_assumptions():
    m, a = parameters("m a", positive=True)
    assert m.is_positive
    assert a.is_positive
    (b,) = parameters("b")
    assert b.is_real
    assert b.is_positive is None


exponents = st.integers(0, 3)


@given(exponents, exponents, exponents, exponents)
def test_time_derivative_agrees_with_functions_of_time(a, b, c, d):
    """Second route: put q(t) in, let SymPy differentiate by t, take q(t) out again."""
    x, y = coordinates("x y")
    f = x**a * y.dot**b * time**c * sp.sin(x + y) + x.dot**d
    X, Y = sp.Function("X")(time), sp.Function("Y")(time)
    f_of_t = f.xreplace({x.dot: X.diff(time), y.dot: Y.diff(time)}).xreplace({x: X, y: Y})
    expected = without_dynamicsymbols(sp.diff(f_of_t, time), {X: x, Y: y})
    assert sp.expand(time_derivative(f, [x, y]) - expected) == 0


def test_time_derivative_is_not_the_partial_one():
    (x,) = coordinates("x")
    assert time_derivative(x**2, [x]) != sp.diff(x**2, time)
