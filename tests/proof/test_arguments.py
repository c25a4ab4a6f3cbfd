"""Arguments and exponents that are fractions or algebraic numbers: what is equal below a function is found to be."""

import pytest
from sympy import (
    E,
    Function,
    I,
    Ne,
    Rational,
    atan,
    cbrt,
    cos,
    cosh,
    exp,
    gamma,
    pi,
    sin,
    sinh,
    sqrt,
    symbols,
)

from canon.proof import Domain, equal

x, y, z, a, b = symbols("x y z a b", real=True)
p, q = symbols("p q", positive=True)
f = Function("f")
phi = (1 + sqrt(5)) / 2
cube = cbrt(2)
N = symbols("N", integer=True, positive=True)
c = symbols("c", real=True)

TRUE = [
    (cos(1 / (1 + sqrt(2))), cos(sqrt(2) - 1), Domain(), cos(sqrt(2) - 2)),
    (exp(x / (1 + sqrt(2))), exp(x * (sqrt(2) - 1)), Domain(), exp(x * (sqrt(2) + 1))),
    (sin(x / phi), sin(x * (phi - 1)), Domain(), sin(x * phi)),
    (cos(1 / (cube - 1)), cos(1 + cube + cube**2), Domain(), cos(1 + cube - cube**2)),
    (sin(1 / (sqrt(2) + sqrt(3))), sin(sqrt(3) - sqrt(2)), Domain(), sin(sqrt(3) + sqrt(2))),
    (exp(-1 / (2 - sqrt(3))), exp(-2 - sqrt(3)), Domain(), exp(2 - sqrt(3))),
    (sin(x / (p + sqrt(p**2 + 1))), sin(x * (sqrt(p**2 + 1) - p)), Domain(), sin(x * (sqrt(p**2 + 1) + p))),
    (cos(x * (cbrt(2 + sqrt(5)) + cbrt(sqrt(5) - 2))), cos(x * sqrt(5)), Domain(), cos(x)),
    (
        cos(1 / (1 + sqrt(2) + sqrt(3))),
        cos((2 + sqrt(2) - sqrt(6)) / 4),
        Domain(),
        cos((2 - sqrt(2) - sqrt(6)) / 4),
    ),
    (exp(sqrt(5 + 2 * sqrt(6)) * x), exp(sqrt(2) * x) * exp(sqrt(3) * x), Domain(), exp(sqrt(5) * x)),
    (atan(1 / (1 + sqrt(2))), atan(sqrt(2) - 1), Domain(), atan(sqrt(2))),
    (cosh(x / (sqrt(3) - 1)), cosh(x * (sqrt(3) + 1) / 2), Domain(), cosh(x)),
    (cos(x / (1 + I)), cos(x * (1 - I) / 2), Domain(), cos(x)),
    (exp(x / (1 + sqrt(2) * I)), exp(x * (1 - sqrt(2) * I) / 3), Domain(), exp(x)),
    (gamma(1 / (1 + sqrt(2))), gamma(sqrt(2) - 1), Domain(), gamma(sqrt(2))),
    (Function("f")(1 / (1 + sqrt(2))), Function("f")(sqrt(2) - 1), Domain(), Function("f")(sqrt(2))),
    (cos(sin(pi / 12)), cos((sqrt(6) - sqrt(2)) / 4), Domain(), cos((sqrt(6) + sqrt(2)) / 4)),
    (2 ** (1 + 1 / x), 2 * 2 ** (1 / x), Domain(), 4 * 2 ** (1 / x)),
    (exp(x / (x - z)) * exp(-z / (x - z)), E, Domain(), exp(2)),
    (exp(1 / (x * (x + 1))), exp(1 / x) * exp(-1 / (x + 1)), Domain(), exp(1 / x) * exp(1 / (x + 1))),
    (exp(x / (x + 1)), E * exp(-1 / (x + 1)), Domain(), E * exp(1 / (x + 1))),
    (3 ** ((x + 1) / x), 3 * 3 ** (1 / x), Domain(), 3 ** (1 / x)),
    (p ** ((x + 1) / x), p * p ** (1 / x), Domain(), p ** (1 / x)),
    (exp((x**2 + 1) / (x**2 - 1)), exp(1) * exp(2 / (x**2 - 1)), Domain(), exp(2 / (x**2 - 1))),
    (
        sin(1 + 1 / x),
        sin(1) * cos(1 / x) + cos(1) * sin(1 / x),
        Domain(),
        sin(1) * cos(1 / x) - cos(1) * sin(1 / x),
    ),
    (sin(x / (x + 1)), sin(1 - 1 / (x + 1)), Domain(), sin(1 + 1 / (x + 1))),
    (exp(-a / (a + b)) * exp(-b / (a + b)), exp(-1), Domain(), exp(1)),
    (
        exp((a * x + b) / (c * x + 1)),
        exp(a * x / (c * x + 1)) * exp(b / (c * x + 1)),
        Domain(),
        exp(a * x / (c * x + 1)),
    ),
    (exp(x**2 / (x - 1)), exp(x + 1) * exp(1 / (x - 1)), Domain(), exp(x + 1)),
    (cos(x**3 / (x**2 + 1)), cos(x - x / (x**2 + 1)), Domain(), cos(x)),
    (4 ** (1 / x + Rational(1, 2)), 2 * 2 ** (2 / x), Domain(), 2 ** (2 / x)),
    (exp(2 * x / (x**2 - 1)), exp(1 / (x - 1)) * exp(1 / (x + 1)), Domain(), exp(1 / (x - 1))),
    (x ** (1 + 1 / N), x * x ** (1 / N), Domain(), x ** (1 / N)),
    (2 ** ((N + 1) / N), 2 * 2 ** (1 / N), Domain(), 2 ** (1 / N)),
    (exp(1 / (1 + exp(x))) * exp(1 / (1 + exp(-x))), E, Domain(), exp(2)),
    (exp(x / (x - z)), E * exp(z / (x - z)), Domain(), exp(z / (x - z))),
    (exp(x * y / (x + y)) * exp(y**2 / (x + y)), exp(y), Domain(), exp(x)),
    (cosh(x / (x - z) - z / (x - z)), cosh(1), Domain(), sinh(1)),
    (exp(1 / (1 - x)) * exp(1 / (x - 1)), 1, Domain(), 2),
    ((x / y) ** (1 + 1 / p), x / y * (x / y) ** (1 / p), Domain(), (x / y) ** (1 / p)),
    (exp(-((x - 1) ** 2)) * exp(x**2), exp(2 * x - 1), Domain(), exp(2 * x + 1)),
    (
        exp(-((x - a) ** 2) / (2 * p**2)) * exp(-((x + a) ** 2) / (2 * p**2)),
        exp(-(x**2 + a**2) / p**2),
        Domain(),
        exp(-(x**2 - a**2) / p**2),
    ),
    (
        exp(-a * x**2 + b * x),
        exp(-a * (x - b / (2 * a)) ** 2) * exp(b**2 / (4 * a)),
        Domain(),
        exp(-a * (x - b / (2 * a)) ** 2) * exp(-(b**2) / (4 * a)),
    ),
    (
        exp(-((x - a) ** 2) / (2 * p**2) - (x - b) ** 2 / (2 * q**2)),
        exp(-(p**2 + q**2) / (2 * p**2 * q**2) * (x - (a * q**2 + b * p**2) / (p**2 + q**2)) ** 2)
        * exp(-((a - b) ** 2) / (2 * (p**2 + q**2))),
        Domain(),
        exp(-((a - b) ** 2) / (2 * (p**2 + q**2))),
    ),
    (exp(-(x**2) - y**2 - 2 * x * y), exp(-((x + y) ** 2)), Domain(), exp(-((x - y) ** 2))),
    (exp(I * (x + y) ** 2), exp(I * x**2) * exp(2 * I * x * y) * exp(I * y**2), Domain(), exp(I * x**2)),
    (
        exp(-p * (x - y) ** 2 - p * (y - z) ** 2),
        exp(-p * (x**2 + 2 * y**2 + z**2)) * exp(2 * p * y * (x + z)),
        Domain(),
        exp(-p * (x**2 + 2 * y**2 + z**2)) * exp(2 * p * y * (x - z)),
    ),
    (
        exp(-((x - y) ** 2) / (4 * p)) / sqrt(p),
        exp(-(x**2) / (4 * p)) * exp(x * y / (2 * p)) * exp(-(y**2) / (4 * p)) / sqrt(p),
        Domain(),
        exp(-(x**2) / (4 * p)) / sqrt(p),
    ),
    (2 ** ((x + 1) ** 2), 2 * 2 ** (x**2) * 4**x, Domain(), 2 ** (x**2) * 4**x),
    (
        exp(-a * x**2 - b * x),
        exp(b**2 / (4 * a)) * exp(-a * (x + b / (2 * a)) ** 2),
        Domain((Ne(a, 0),)),
        exp(b**2 / (2 * a)) * exp(-a * (x + b / (2 * a)) ** 2),
    ),
]


@pytest.mark.parametrize(("left", "right", "domain", "twin"), TRUE)
def test_identity_holds_and_its_twin_fails(left, right, domain, twin):
    assert equal(left, right, domain).holds
    assert equal(left, twin, domain).fails


def test_fractions_of_sines_are_divided_by_their_relation():
    assert equal(exp(cos(x) ** 2 / (1 - sin(x))), E * exp(sin(x))).holds
    assert equal(exp(cos(x) ** 2 / (1 - sin(x))), E * exp(-sin(x))).fails
    assert equal(cos(x * sqrt(2 - sqrt(2)) * sqrt(2 + sqrt(2))), cos(sqrt(2) * x)).holds
    assert equal(cos(x * sqrt(2 - sqrt(2)) * sqrt(2 + sqrt(2))), cos(2 * x)).fails


def test_a_denominator_that_may_vanish_stays():
    """1/(x + √2) has a value at −√2 only by its own form: nothing is multiplied by x − √2, which vanishes at √2."""
    assert equal(f(1 / (x + sqrt(2))), f((x - sqrt(2)) / (x**2 - 2))).undecided
    assert equal(f(1 / (p + sqrt(2))), f((p - sqrt(2)) / (p**2 - 2)), Domain((p > 2,))).undecided


def test_exponents_that_differ_by_no_constant_are_different():
    assert equal(exp(x / (x - z)) * exp(z / (x - z)), E).fails
    assert equal(exp(1 / (x * (x + 1))), exp(1 / x) * exp(-1 / (x + 2))).fails
