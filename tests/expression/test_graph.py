"""The expression graph against SymPy: translation, derivatives, evaluation, depth."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.expression.graph.elementary import SLOPES
from canon.expression.graph.graph import Graph
from canon.expression.graph.number_systems import LONGDOUBLE, multiprecision
from canon.expression.graph.python_source import python_function
from canon.expression.graph.sympy_conversion import NotModelledError

x, y, z = sp.symbols("x y z", positive=True)
POINT = {x: sp.Rational(3, 7), y: sp.Rational(5, 4), z: sp.Rational(2, 9)}
DIGITS = multiprecision(40)


def _leaves():
    numbers = st.fractions(-3, 3, max_denominator=6).map(lambda f: sp.Rational(f.numerator, f.denominator))
    return st.one_of(st.sampled_from([x, y, z, sp.pi, sp.E]), numbers)


def _grown(children):
    # Kept finite at POINT: roots and logarithms see positive arguments, denominators stay away from 0.
    pairs = st.tuples(children, children)
    return st.one_of(
        pairs.map(lambda ab: ab[0] + ab[1]),
        pairs.map(lambda ab: ab[0] * ab[1]),
        pairs.map(lambda ab: ab[0] / (1 + ab[1] ** 2)),
        pairs.map(lambda ab: (1 + ab[0] ** 2) ** sp.sin(ab[1])),
        pairs.map(lambda ab: sp.atan2(ab[0], 1 + ab[1] ** 2)),
        st.tuples(children, st.integers(-3, 3)).map(lambda an: (1 + an[0] ** 2) ** sp.Rational(an[1], 2)),
        children.map(lambda a: sp.log(2 + a**2)),
        children.map(lambda a: sp.exp(sp.cos(a))),
        children.map(lambda a: sp.asinh(sp.sin(a))),
        children.map(lambda a: sp.tanh(a) + sp.atan(a)),
    )


expressions = st.recursive(_leaves(), _grown, max_leaves=6)


def _close(a, b):
    return abs(a - b) <= 1e-25 * (1 + abs(a) + abs(b))


def _value(graph, node):
    values = {s: DIGITS.number(Fraction(int(v.p), int(v.q))) for s, v in POINT.items()}
    return graph.evaluate([node], values, DIGITS)[0]


def _sympy_value(expression):
    values = [DIGITS.number(Fraction(int(v.p), int(v.q))) for v in POINT.values()]
    with mpmath.workdps(40):
        return mpmath.mpf(sp.lambdify(list(POINT), expression, "mpmath")(*map(mpmath.mpf, values)))


@settings(max_examples=60, deadline=None)
@given(expressions)
def test_translation_keeps_the_value_and_hash_consing_makes_it_stable(f):
    graph = Graph()
    node = graph.from_sympy(f)
    assert _close(_value(graph, node), _sympy_value(f))
    back = graph.to_sympy(node)
    assert _close(_sympy_value(back), _sympy_value(f))
    size = len(graph.nodes)
    assert graph.from_sympy(f) == node
    assert len(graph.nodes) == size


@settings(max_examples=60, deadline=None)
@given(expressions)
def test_forward_reverse_and_sympy_derivatives_agree(f):
    graph = Graph()
    node = graph.from_sympy(f)
    reverse = graph.gradient(node, (x, y, z))
    for symbol, gradient in zip((x, y, z), reverse, strict=True):
        true = _sympy_value(sp.diff(f, symbol))
        assert _close(_value(graph, graph.derivative(node, symbol)), true)
        assert _close(_value(graph, gradient), true)


@settings(max_examples=50, deadline=None)
@given(expressions, expressions)
def test_derivative_laws(f, g):
    graph = Graph()
    a, b = graph.from_sympy(f), graph.from_sympy(g)
    da, db = graph.derivative(a, x), graph.derivative(b, x)
    value = lambda node: _value(graph, node)  # noqa: E731
    assert _close(value(graph.derivative(graph.mul([a, b]), x)), value(a) * value(db) + value(b) * value(da))
    assert _close(value(graph.derivative(graph.add([a, b]), x)), value(da) + value(db))
    mixed = graph.derivative(graph.derivative(a, x), y), graph.derivative(graph.derivative(a, y), x)
    assert _close(*map(value, mixed))


@pytest.mark.parametrize("name", sorted(SLOPES))
def test_every_slope_is_the_slope_of_its_function(name):
    graph = Graph()
    at = Fraction(7, 4) if name == "acosh" else Fraction(2, 5)
    node = graph.function(name, graph.symbol(x))
    slope = graph.derivative(node, x)

    def f(value):
        return graph.evaluate([node], {x: value}, DIGITS)[0]

    step = mpmath.mpf(10) ** -12
    point = DIGITS.number(at)
    difference = (f(point + step) - f(point - step)) / (2 * step)
    found = graph.evaluate([slope], {x: point}, DIGITS)[0]
    assert abs(found - difference) < mpmath.mpf(10) ** -18


def test_light_algebra_merges_terms_bases_and_numbers():
    graph = Graph()
    a, b = graph.symbol(x), graph.symbol(y)
    assert graph.add([a, b, graph.negative(a)]) == b
    assert graph.mul([a, b, graph.power(a, -1)]) == b
    assert graph.mul([graph.power(a, Fraction(1, 2)), graph.power(a, Fraction(1, 2))]) == a
    assert graph.power(graph.power(a, -1), -1) == a
    assert graph.power(graph.negative(a), 2) == graph.power(a, 2)
    assert graph.power(graph.number(Fraction(9, 4)), Fraction(-3, 2)) == graph.number(Fraction(8, 27))
    assert graph.mul([a, graph.number(0)]) == graph.number(0)
    assert graph.add([]) == graph.number(0)
    assert graph.mul([]) == graph.number(1)


def test_an_even_root_of_a_power_is_not_merged():
    graph = Graph()
    square = graph.power(graph.symbol(sp.Symbol("u", real=True)), 2)
    assert graph.to_sympy(graph.power(square, Fraction(1, 2))) != sp.Symbol("u", real=True)
    assert graph.evaluate([graph.power(square, Fraction(1, 2))], {sp.Symbol("u", real=True): -2.0}) == [2.0]


def test_substitution_replaces_subexpressions_at_once():
    graph = Graph()
    f = graph.from_sympy(x * sp.sin(y) + y)
    a, b = graph.symbol(x), graph.symbol(y)
    (swapped,) = graph.substitute([f], {a: b, b: a})
    assert swapped == graph.from_sympy(y * sp.sin(x) + x)


def test_depth_and_width_do_not_recurse():
    graph = Graph()
    node = graph.symbol(x)
    for _ in range(20_000):
        node = graph.function("sin", node)
    slope = graph.derivative(node, x)
    reverse = graph.gradient(node, [x])[0]
    values = graph.evaluate([node, slope, reverse], {x: 0.3})
    assert np.isfinite(values).all()
    assert values[1] == pytest.approx(values[2], rel=1e-9)

    deep = x
    for _ in range(4_000):
        deep = sp.sin(deep, evaluate=False)
    assert len(graph.reachable([graph.from_sympy(deep)])) == 4_001


def test_a_shared_gradient_stays_linear_in_size():
    symbols = sp.symbols("s:60")
    graph = Graph()
    node = graph.mul([graph.from_sympy(sp.cos(s)) for s in symbols])
    before = len(graph.nodes)
    graph.gradient(node, symbols)
    assert len(graph.nodes) - before < 20 * len(symbols)


def test_arrays_and_long_doubles():
    graph = Graph()
    f = graph.from_sympy(sp.sqrt(x) / 3 + sp.pi)
    points = np.linspace(1, 2, 5)
    np.testing.assert_allclose(graph.evaluate([f], {x: points})[0], np.sqrt(points) / 3 + np.pi, rtol=1e-15)
    wide = graph.evaluate([f], {x: np.longdouble(2)}, LONGDOUBLE)[0]
    true = _sympy_value(sp.sqrt(2) / 3 + sp.pi)
    with mpmath.workdps(30):
        assert abs(mpmath.mpf(str(wide)) - true) < 8 * float(np.finfo(np.longdouble).eps)


def test_long_exact_numbers_are_rounded_once():
    third = Fraction(10**60 + 1, 3 * 10**60)
    assert LONGDOUBLE.number(third) == np.longdouble(1) / np.longdouble(3)
    assert LONGDOUBLE.number(-third) == -np.longdouble(1) / np.longdouble(3)


@pytest.mark.parametrize(
    ("expression", "named"),
    [
        (sp.gamma(x), "gamma"),
        (sp.Function("theta")(x), "theta(x)"),
        (sp.I * x, "ImaginaryUnit"),
        (sp.Piecewise((x, x > 1), (y, True)), "Piecewise"),
        (sp.oo, "Infinity"),
    ],
)
def test_what_is_not_modelled_is_named(expression, named):
    with pytest.raises(NotModelledError, match="operation") as caught:
        Graph().from_sympy(expression)
    assert named in str(caught.value)


def test_errors_name_the_symbol_and_the_division():
    graph = Graph()
    with pytest.raises(KeyError, match="symbol x"):
        graph.evaluate([graph.symbol(x)], {})
    with pytest.raises(ZeroDivisionError, match="divides by zero"):
        graph.power(graph.number(0), -1)
    with pytest.raises(ValueError, match="no function 'sine'"):
        graph.function("sine", graph.symbol(x))


def test_a_float_is_the_binary_number_it_is():
    graph = Graph()
    half, tenth = graph.from_sympy(sp.Float("0.5")), graph.from_sympy(sp.Float(0.1))
    assert graph.to_sympy(half) == sp.Rational(1, 2)
    assert graph.to_sympy(tenth) == sp.Rational(0.1) != sp.Rational(1, 10)


def _agrees(f, *symbols):
    graph = Graph()
    node = graph.from_sympy(f)
    at = {s: DIGITS.number(Fraction(k + 2, 7)) for k, s in enumerate(symbols)}
    values = {s: sp.Rational(k + 2, 7) for k, s in enumerate(symbols)}
    for found, true in [(node, f), *((graph.derivative(node, s), f.diff(s)) for s in symbols)]:
        with mpmath.workdps(40):
            assert _close(graph.evaluate([found], at, DIGITS)[0], mpmath.mpf(sp.N(true.subs(values), 40)))


U, W = sp.symbols("u w", real=True)


@pytest.mark.parametrize("f", [sp.cot(U), sp.sec(U), sp.csc(U), sp.acot(U), 2**U, U**W, (1 + U**2) ** W])
def test_functions_and_powers_have_the_values_and_slopes_of_sympys(f):
    _agrees(f, *sorted(f.free_symbols, key=str))


@pytest.mark.parametrize("f", [sp.atan2(U, 2), sp.atan2(2, U), sp.atan2(U, W), sp.atan2(1 + U, 2 - W)])
def test_both_slopes_of_an_angle_of_two(f):
    _agrees(f, *sorted(f.free_symbols, key=str))


def test_no_other_constant_has_a_name():
    with pytest.raises(ValueError, match="no constant is called 'tau'; the graph knows 'pi' and 'E'"):
        Graph().named("tau")


def test_error_functions_of_long_doubles_at_infinity():
    infinity, erf, erfc = np.longdouble("inf"), LONGDOUBLE.functions["erf"], LONGDOUBLE.functions["erfc"]
    assert [erf(infinity), erf(-infinity), erfc(infinity), erfc(-infinity)] == [1, -1, 0, 2]
    assert np.isnan(erf(np.longdouble("nan")))
    assert erf(infinity).dtype == np.longdouble


def test_a_long_function_is_the_same_before_and_after_it_is_compiled():
    f = sp.pi + sp.Add(*(sp.cos(k * x) * (k + x) ** y for k in range(1, 120)))
    graph = Graph()
    node = graph.from_sympy(f)
    assert len(graph.reachable([node])) > 300
    of_python = python_function(graph, [node], [x, y])
    values = [of_python((0.75, 0.5))[0] for _ in range(12)]
    assert len(set(values)) == 1
    true = sp.N(f.subs({x: sp.Rational(3, 4), y: sp.Rational(1, 2)}), 30)
    assert abs(values[0] - true) < 1e-12
