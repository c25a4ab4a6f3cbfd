"""The gamma family and both real branches of the Lambert W function."""

import pytest
from sympy import (
    E,
    FallingFactorial,
    LambertW,
    Rational,
    RisingFactorial,
    beta,
    binomial,
    cos,
    digamma,
    erf,
    erfc,
    exp,
    factorial,
    fibonacci,
    gamma,
    log,
    loggamma,
    lucas,
    pi,
    sin,
    sqrt,
    symbols,
)

from canon.proof import Domain, equal

x, y = symbols("x y", real=True)
p, q = symbols("p q", positive=True)
n, k = symbols("n k", integer=True)
N = symbols("N", integer=True, positive=True)
ONE = sin(x) ** 2 + cos(x) ** 2

TRUE = [
    (gamma(x + 1), x * gamma(x), Domain(), gamma(x)),
    (factorial(n + 1), (n + 1) * factorial(n), Domain((n >= 0,)), n * factorial(n)),
    (gamma(x + 3) / gamma(x), x * (x + 1) * (x + 2), Domain(), x * (x + 1) * (x + 3)),
    (gamma(x + Rational(1, 2)) / gamma(x - Rational(1, 2)), x - Rational(1, 2), Domain(), x + Rational(1, 2)),
    (factorial(N), gamma(N + 1), Domain(), gamma(N)),
    (binomial(N, 2), N * (N - 1) / 2, Domain(), N * (N + 1) / 2),
    (factorial(N) / factorial(N - 1), N, Domain(), N + 1),
    (gamma(x) * gamma(1 - x), pi / sin(pi * x), Domain(), pi / cos(pi * x)),
    (beta(p, q), gamma(p) * gamma(q) / gamma(p + q), Domain(), gamma(p) * gamma(q)),
    (beta(p + 1, q), beta(p, q) * p / (p + q), Domain(), beta(p, q) * q / (p + q)),
    (loggamma(p + 1), log(p) + loggamma(p), Domain(), loggamma(p)),
    (digamma(p + 1), digamma(p) + 1 / p, Domain(), digamma(p)),
    (gamma(x + 1) * gamma(y - 1) * (y - 1), x * gamma(x) * gamma(y), Domain(), x * gamma(x) * gamma(y) * 2),
    (gamma(n + 1), factorial(n), Domain((n >= 0,)), factorial(n + 1)),
    (
        binomial(N + 1, k),
        binomial(N, k) + binomial(N, k - 1),
        Domain(
            (
                k >= 1,
                k <= N,
            )
        ),
        binomial(N, k),
    ),
    (
        LambertW(x, -1) * exp(LambertW(x, -1)),
        x,
        Domain(
            (
                x < 0,
                x > -exp(-1),
            )
        ),
        -x,
    ),
    (LambertW(x, -1) * exp(LambertW(x, -1)), x, Domain(), -x),
    (
        LambertW(x, -1).diff(x),
        1 / (exp(LambertW(x, -1)) * (1 + LambertW(x, -1))),
        Domain(
            (
                x < 0,
                x > -exp(-1),
            )
        ),
        1 / (exp(LambertW(x, -1))),
    ),
    (
        log(-LambertW(x, -1)) + LambertW(x, -1),
        log(-x),
        Domain(
            (
                x < 0,
                x > -exp(-1),
            )
        ),
        log(x),
    ),
    (LambertW(x * exp(x), -1), x, Domain((x < -1,)), -x),
    (LambertW(x) * exp(LambertW(x)), x, Domain(), -x),
    (exp(LambertW(x)), x / LambertW(x), Domain((x > 0,)), x * LambertW(x)),
    (LambertW(-log(2) / 2, -1), -2 * log(2), Domain(), -log(2)),
    (gamma(x + 1).diff(x), gamma(x) + x * gamma(x).diff(x), Domain((x > 0,)), gamma(x)),
    (erfc(x), 1 - erf(x), Domain(), 1 + erf(x)),
    (
        FallingFactorial(p, n),
        gamma(p + 1) / gamma(p - n + 1),
        Domain((n >= 0, n < p)),
        gamma(p + 1) / gamma(p + n + 1),
    ),
    (
        FallingFactorial(p, n + 1),
        (p - n) * FallingFactorial(p, n),
        Domain((n >= 0, n + 1 < p)),
        (p + n) * FallingFactorial(p, n),
    ),
    (gamma(1 + 4 * ONE), 24, Domain(), 120),
    (gamma(ONE / 2), sqrt(pi), Domain(), pi),
    (
        gamma(x) * gamma(3 - x),
        (2 - x) * gamma(x) * gamma(2 - x),
        Domain(),
        (1 - x) * gamma(x) * gamma(2 - x),
    ),
    (
        digamma(p + 1) + digamma(q + 1),
        digamma(p) + digamma(q) + 1 / p + 1 / q,
        Domain(),
        digamma(p) + digamma(q) + 1 / p - 1 / q,
    ),
]


@pytest.mark.parametrize(("left", "right", "domain", "twin"), TRUE)
def test_identity_holds_and_its_twin_fails(left, right, domain, twin):
    assert equal(left, right, domain).holds
    assert equal(left, twin, domain).fails


def test_products_and_fibonacci_numbers():
    assert equal(RisingFactorial(p, n), gamma(p + n) / gamma(p), Domain((n >= 0,))).holds
    assert equal(RisingFactorial(p, n), gamma(p + n) / gamma(p + 1), Domain((n >= 0,))).fails
    assert equal(fibonacci(n + 2), fibonacci(n + 1) + fibonacci(n)).holds
    assert not equal(fibonacci(n + 2), fibonacci(n + 1) - fibonacci(n)).holds


def test_lucas_numbers_follow_the_rule_of_fibonaccis():
    assert equal(lucas(n + 2), lucas(n + 1) + lucas(n)).holds
    assert equal(lucas(n), fibonacci(n - 1) + fibonacci(n + 1)).holds
    for wrong in (lucas(n + 1) - lucas(n), fibonacci(n + 2) + fibonacci(n)):
        verdict = equal(lucas(n + 2), wrong)
        assert not verdict.holds
        assert "lucas is not modelled" in str(verdict)


@pytest.mark.parametrize("f", [lambda a: RisingFactorial(a, n), lambda a: beta(a, y), lambda a: beta(y, a)])
def test_of_arguments_of_any_sign_only_equal_ones_are_known_to_give_the_same(f):
    assert equal(f(x * (x + 1)), f(x**2 + x)).holds
    assert equal(f(x * (x + 1)), f(x**2 - x)).fails


def test_reflection_needs_arguments_that_leave_no_whole_number():
    assert equal(gamma(x) * gamma(-x), -pi / (x * sin(pi * x))).holds
    assert equal(gamma(x) * gamma(-x), pi / (x * sin(pi * x))).fails
    assert not equal(gamma(x) * gamma(3 - x), (2 - x) * (1 - x) * pi / sin(pi * x)).fails


def test_binomial_coefficients_outside_the_triangle():
    """C(1, 3) = 0 has a value where Γ(−1) has none."""
    m, j = symbols("m j", integer=True, nonnegative=True)
    assert not equal(binomial(m, j), gamma(m + 1) / (gamma(j + 1) * gamma(m - j + 1))).fails
    assert equal(binomial(m, j), factorial(m) / (factorial(j) * factorial(m - j)), Domain((j <= m,))).holds
    assert equal(binomial(m, j), factorial(m) / (factorial(j) * factorial(m + j)), Domain((j <= m,))).fails


def test_each_branch_of_lambert_w_is_its_own():
    below = Domain((x > -exp(-1), x < 0))
    assert equal(LambertW(x, -1), LambertW(x), below).fails
    assert equal(LambertW(x * exp(x), -1), x, Domain((x > -1, x < 0))).fails
    assert equal(LambertW(x * exp(x)), x, Domain((x > -1,))).holds


DISGUISED = [
    (E * (x * exp(x) + exp(x)), x + 1, x > -2, x < -2),
    ((p + x - 2) * exp(p) * exp(x - 2), p + x - 2, x > 2, x < 1),
    ((x**2 - 1) * exp(x**2) / E, x**2 - 1, x > -9, None),
    ((x**2 - 2) * exp(x**2) / E**2, x**2 - 2, x > 1, x < 1),
    (-E * x * exp(-x) + E * exp(-x), 1 - x, x < 2, x > 2),
    (x * exp(3 * x) * exp(-2 * x), x, x >= -1, x < 0),
]
"""u exp u written otherwise, u, where u ≥ −1, and where it is less at some places."""


@pytest.mark.parametrize(("z", "u", "above", "below"), DISGUISED)
def test_lambert_w_undoes_an_argument_in_other_clothes_on_its_branch(z, u, above, below):
    assert equal(LambertW(z), u, Domain((above,))).holds
    assert equal(LambertW(z), u + 1, Domain((above,))).fails
    assert equal(LambertW(2 * z), u, Domain((above,))).fails
    if below is not None:
        assert equal(LambertW(z), u, Domain((below,))).fails
        assert equal(LambertW(z), u).fails
    assert equal(LambertW(z, -1), u, Domain((above,))).fails


def test_the_lower_branch_of_lambert_w_undoes_what_is_at_most_minus_one():
    z = E * (x * exp(x) + exp(x))
    assert equal(LambertW(z, -1), x + 1, Domain((x <= -2,))).holds
    assert equal(LambertW(z, -1), x + 1, Domain((x < -1,))).fails


def test_lamberts_w_of_logarithms_on_one_side_of_their_branch_point():
    """m log u lies on the principal branch where u ≥ exp(−1/m): a sum with 1 does not show it."""
    x = symbols("x", positive=True)
    for m, beyond in ((1, x > exp(-1)), (2, x > exp(-Rational(1, 2))), (-1, x < exp(1))):
        g = m * log(x)
        assert equal(LambertW(g * exp(g)), g, Domain((beyond,))).holds
        assert equal(LambertW(g * exp(g)), g + 1, Domain((beyond,))).fails
        assert equal(LambertW(g * exp(g)), g, Domain()).fails
    assert equal(LambertW(x * log(x)), log(x), Domain((x > exp(-1) / 2,))).fails
