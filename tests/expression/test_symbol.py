"""Coordinates and their rates, and the total time derivative."""

import copy
import pickle
import random

import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from canon import coordinates, parameters, time, time_derivative
from canon.expression.symbols.symbol import Rate, without_dynamicsymbols
from canon.expression.symbols.user_input import given_symbols

THETA = coordinates("theta")
EVERY_KIND = (THETA, THETA.dot, THETA.ddot, THETA.momentum, parameters("m"))


def test_a_coordinate_knows_its_rates_and_momentum():
    theta, phi = coordinates("theta, phi")
    assert (theta.dot.name, theta.ddot.name, theta.momentum.name) == ("theta_dot", "theta_ddot", "p_theta")
    assert theta.dot == theta.dot
    assert theta.dot != phi.dot
    assert theta.is_real
    assert theta.dot.is_real


def test_assumptions_reach_the_coordinate_and_not_its_rate():
    r = coordinates("r", positive=True)
    assert r.is_positive
    assert r.dot.is_positive is None


def test_rates_print_with_dots_in_latex():
    theta = coordinates("theta")
    assert sp.latex(theta.dot) == r"\dot{\theta}"
    assert sp.latex(theta.ddot**2) == r"\ddot{\theta}^{2}"


def test_symbols_survive_pickling():
    r = coordinates("r", positive=True)
    assert pickle.loads(pickle.dumps(r.dot + r)) == r.dot + r


@pytest.mark.parametrize("make", [coordinates, parameters])
def test_one_name_gives_one_symbol_and_several_a_tuple(make):
    alone = make("x")
    assert isinstance(alone, sp.Symbol)
    assert make("x,") == (alone,)
    assert make("x, y") == make("x y") == (alone, make("y"))


@pytest.mark.parametrize("make", [coordinates, parameters])
def test_ranges_are_sympys(make):
    for names in ("q:3", "q1:2", "x y1:3", "a(1:3)b", "u:w"):
        assert [s.name for s in make(names)] == [s.name for s in sp.symbols(names, seq=True)]
    with pytest.raises(ValueError, match="x: is no range of names"):
        make("x:")
    with pytest.raises(ValueError, match="x3:1 is a range without names"):
        make("x3:1")
    with pytest.raises(ValueError, match="q2 named twice"):
        make("q:3 q2")


@pytest.mark.parametrize("names", ["", "  ", "x y x"])
def test_unusable_names_are_refused(names):
    with pytest.raises(ValueError, match=r"names given|named twice"):
        coordinates(names)


def test_parameters_take_assumptions():
    m, a = parameters("m a", positive=True)
    assert m.is_positive
    assert a.is_positive
    b = parameters("b")
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
    x = coordinates("x")
    assert time_derivative(x**2, [x]) != sp.diff(x**2, time)


@pytest.mark.parametrize("symbol", EVERY_KIND, ids=str)
def test_every_printer_and_compiler_of_sympy_takes_every_kind_of_symbol(symbol):
    for write in (
        sp.pycode,
        sp.ccode,
        sp.cxxcode,
        sp.fcode,
        sp.jscode,
        sp.rust_code,
        sp.julia_code,
        sp.octave_code,
    ):
        assert write(symbol).strip() == symbol.name
    assert sp.maple_code(symbol) == sp.mathematica_code(symbol) == str(symbol) == symbol.name
    assert sp.srepr(symbol) == f"{type(symbol).__name__}({symbol.name!r}, real=True)"
    assert sp.pretty(symbol, use_unicode=False) == symbol.name


def test_lambdify_shares_and_compiles_what_derivations_give():
    q, v, a, p, _ = EVERY_KIND
    u = sp.sin(q) + v
    f = a * u**2 + sp.cos(u**2) + p * u
    x = (0.3, 0.4, 0.5, 0.6)
    exact = float(f.xreplace(dict(zip((q, v, a, p), map(sp.Float, x), strict=True))))
    for options in ({}, {"cse": True}, {"cse": True, "modules": "math"}, {"cse": True, "modules": "mpmath"}):
        assert float(sp.lambdify((q, v, a, p), f, **options)(*x)) == pytest.approx(exact, rel=1e-14)
    assert float(sp.lambdify([(q, v, a, p)], [f], cse=True)(x)[0]) == pytest.approx(exact, rel=1e-14)


@pytest.mark.parametrize("symbol", EVERY_KIND, ids=str)
def test_copies_are_the_symbol_itself(symbol):
    f = sp.sin(symbol) ** 2 + symbol
    for same in (pickle.loads(pickle.dumps(f)), copy.copy(f), copy.deepcopy(f)):
        assert same == f
        (found,) = same.free_symbols
        assert (found, type(found)) == (symbol, type(symbol))
    dummy = sp.Dummy(symbol.name, real=True)
    assert dummy != symbol
    assert f.subs(symbol, dummy).subs(dummy, symbol) == f


def test_sorting_is_that_of_sympy_and_independent_of_the_order_of_making():
    mixed = random.Random(1).sample(EVERY_KIND, k=len(EVERY_KIND))
    for key in (sp.default_sort_key, lambda s: s.sort_key()):
        assert sorted(EVERY_KIND, key=key) == sorted(mixed, key=key)
    assert next(iter(sp.ordered(EVERY_KIND))).name == "m"


def test_rates_are_written_with_dots_in_every_mode():
    theta, q = coordinates("theta q_1")
    assert sp.latex(q.dot**2 + theta.ddot) == r"\dot{q_{1}}^{2} + \ddot{\theta}"
    assert sp.latex(theta.dot, mode="inline") == r"$\dot{\theta}$"
    assert sp.pretty(q.dot * theta.ddot, use_unicode=True) == "q\u0307₁⋅θ\u0308"
    assert sp.pretty(theta.dot**2, use_unicode=True).splitlines()[1] == "θ\u0307 "
    assert (sp.latex(Rate("v")), sp.pretty(Rate("v"))) == ("v", "v")


@pytest.mark.parametrize("given", [{THETA, THETA.dot}, frozenset({THETA})])
def test_a_set_of_symbols_has_no_order(given):
    with pytest.raises(TypeError, match="q: a set has no order; give a list"):
        given_symbols(given, "q")
    assert given_symbols([THETA, THETA.dot], "q") == (THETA, THETA.dot)
