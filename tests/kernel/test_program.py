"""Programs and their machine code against 40-digit interpretation."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.expression.graph.graph import Graph
from canon.expression.graph.number_systems import multiprecision
from canon.kernel.llvm.loop import field_function
from canon.kernel.llvm.number_types import DOUBLE, EXTENDED, SINGLE
from canon.kernel.program.hamilton_equations import exact_number
from canon.kernel.program.program import interpret, program
from tests.expression.test_graph import expressions, x, y, z

DIGITS = multiprecision(40)
POINT = (Fraction(3, 7), Fraction(5, 4), Fraction(2, 9))
FUNCTIONS = {**DIGITS.functions, "sqrt": DIGITS.root, "pow": lambda a, b: a**b}


def lowered(*outputs, inputs=(x, y, z)):
    graph = Graph()
    return program(graph, [graph.from_sympy(sp.sympify(f)) for f in outputs], inputs)


def compiled_values(steps, point):
    code = field_function(steps)
    values, out = np.array(point, dtype=np.float64), np.empty(len(steps.outputs))
    code.call(values.ctypes.data, out.ctypes.data)
    return out


@settings(max_examples=80, deadline=None)
@given(expressions)
def test_lowering_keeps_the_value(f):
    graph = Graph()
    node = graph.from_sympy(f)
    point = [DIGITS.number(v) for v in POINT]
    direct = graph.evaluate([node], dict(zip((x, y, z), point, strict=True)), DIGITS)[0]
    through = interpret(program(graph, [node], (x, y, z)), point, DIGITS.number, FUNCTIONS)[0]
    assert abs(direct - through) < 1e-30 * (1 + abs(direct))


@settings(max_examples=50, deadline=None)
@given(expressions)
def test_machine_code_computes_the_program(f):
    steps = lowered(f)
    point = [float(v) for v in POINT]
    found = compiled_values(steps, point)[0]
    reference = interpret(
        steps, [np.float64(v) for v in point], float, {**_NUMPY, "sqrt": np.sqrt, "pow": np.power}
    )[0]
    assert found == pytest.approx(float(reference), rel=1e-13, abs=1e-14)


_NUMPY = {
    **{n: getattr(np, n) for n in ("sin", "cos", "tan", "exp", "log", "sinh", "cosh", "tanh", "sign")},
    **{n: getattr(np, "arc" + n[1:]) for n in ("asin", "acos", "atan", "asinh", "acosh", "atanh", "atan2")},
    "Abs": np.abs,
}  # fmt: skip


@pytest.mark.parametrize("name", sorted(_NUMPY))
def test_every_function_reaches_the_platforms_library(name):
    function = getattr(sp, name)
    at = 1.75 if name == "acosh" else -0.4 if name in ("Abs", "sign") else 0.4
    real = sp.Symbol("x", real=True)
    f = function(real, y) if name == "atan2" else function(real)
    found = compiled_values(lowered(f, inputs=(real, y)), [at, 0.3])[0]
    true = _NUMPY[name](at, 0.3) if name == "atan2" else _NUMPY[name](at)
    assert found == pytest.approx(true, rel=4e-16)


def test_sign_and_abs_at_zero():
    real = sp.Symbol("x", real=True)
    np.testing.assert_array_equal(
        compiled_values(lowered(sp.sign(real), sp.Abs(real), inputs=(real,)), [0.0]), [0.0, 0.0]
    )


def test_nothing_is_contracted():
    # x² − y with y = fl(x²) is exactly 0; a fused multiply–subtract would return the rounding error of x².
    value = 1 + 2.0**-30
    assert compiled_values(lowered(x * x - y), [value, value * value, 0.0])[0] == 0.0


def test_powers_become_products_and_roots():
    steps = lowered((x + y) ** 8, sp.sqrt(x) ** 3, 1 / x)
    assert (steps.count("pow"), steps.count("sqrt"), steps.count("mul"), steps.count("div")) == (0, 1, 4, 1)
    assert lowered(x ** sp.Rational(1, 3)).count("pow") == 1


def test_the_negative_of_a_sum_costs_no_more_than_the_sum() -> None:
    graph = Graph()
    total = graph.add([graph.symbol(x), graph.symbol(y), graph.negative(graph.symbol(z))])
    for node, value in ((total, Fraction(7)), (graph.plain_mul([graph.number(-1), total]), Fraction(-7))):
        steps = program(graph, [node], (x, y, z))
        assert len(steps.instructions) == 5
        assert interpret(steps, (Fraction(2), Fraction(6), Fraction(1)), Fraction, {}) == [value]


def test_a_shared_reciprocal_is_computed_once_and_a_single_quotient_is_a_division():
    r3 = (x**2 + y**2) ** sp.Rational(3, 2)
    shared = lowered(x / r3, y / r3)
    assert (shared.count("div"), shared.count("sqrt")) == (1, 1)
    single = lowered(x / (y + z))
    assert [step.operation for step in single.instructions if step.operation != "input"] == ["add", "div"]


def test_subexpressions_without_symbols_become_one_constant():
    steps = lowered(x * sp.sqrt(2) * sp.sin(1) / sp.pi)
    assert [step.operation for step in steps.instructions].count("constant") == 1
    assert len(steps.instructions) == 3
    with mpmath.workdps(95):
        true = mpmath.sqrt(2) * mpmath.sin(1) / mpmath.pi
        value = next(step.value for step in steps.instructions if step.operation == "constant")
        assert abs(mpmath.mpf(value.numerator) / value.denominator - true) < mpmath.mpf(10) ** -90


def test_an_undeclared_symbol_is_named():
    with pytest.raises(KeyError, match="no value for y, z"):
        lowered(x * y + z, inputs=(x,))


def test_constants_that_are_not_real_are_refused():
    with pytest.raises(ValueError, match="not a real number"):
        lowered(x * sp.asin(2))


fractions = st.one_of(
    st.fractions(-(10**38), 10**38, max_denominator=10**30),
    st.tuples(st.integers(1, 10**38), st.integers(1, 10**38)).map(lambda t: Fraction(*t)),
)


@given(fractions)
def test_constants_print_as_the_nearest_machine_number(value):
    assert np.array([int(DOUBLE.literal(value), 16)], dtype=np.uint64).view(np.float64)[0] == float(value)
    single = np.array([int(SINGLE.literal(value), 16)], dtype=np.uint64).view(np.float64)[0]
    assert single == np.float32(float(value))
    digits = EXTENDED.literal(value).removeprefix("0xK")
    mantissa, exponent = int(digits[4:], 16), int(digits[:4], 16) & 0x7FFF
    printed = Fraction(mantissa) * Fraction(2) ** (exponent - 16383 - 63) if mantissa else Fraction(0)
    assert abs(printed - abs(value)) <= Fraction(2) ** -64 * abs(value)
    assert (int(digits[:4], 16) >= 0x8000) == (value < 0)


def test_constants_too_large_for_a_type_are_refused():
    with pytest.raises(OverflowError, match="too large for float"):
        SINGLE.literal(Fraction(10**39))


def test_exact_numbers():
    assert exact_number(np.float32(0.1), "g") == Fraction(float(np.float32(0.1)))
    assert exact_number("1/3", "g") == Fraction(1, 3)
    assert abs(float(exact_number(sp.pi / 2, "g")) - np.pi / 2) < 1e-16
    for wrong in (True, None, "a", float("nan"), sp.Symbol("s"), [1]):
        with pytest.raises(ValueError, match="g = "):
            exact_number(wrong, "g")
