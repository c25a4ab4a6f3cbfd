"""Powers of −1, i and algebraic numbers with symbolic exponents."""

import pytest
from sympy import Eq, GoldenRatio, I, Integer, Mod, Piecewise, Rational, cos, exp, pi, sqrt, symbols

from canon.proof import Domain, equal

x = symbols("x", real=True)
n, k = symbols("n k", integer=True)
phi = (1 + sqrt(5)) / 2

TRUE = [
    ((-1) ** (n / 2), I**n, Domain(), (-I) ** n),
    (I ** (2 * n), (-1) ** n, Domain(), 1),
    (I ** (4 * n + 1), I, Domain(), -I),
    ((-I) ** n, (-1) ** n * I**n, Domain(), I**n),
    ((-1) ** (n + 1), -((-1) ** n), Domain(), (-1) ** n),
    (cos(n * pi / 2), (I**n + (-I) ** n) / 2, Domain(), (I**n - (-I) ** n) / 2),
    (exp(I * pi * n / 2), I**n, Domain(), (-I) ** n),
    ((-1) ** (n / 3), exp(I * pi * n / 3), Domain(), exp(-I * pi * n / 3)),
    (phi ** (n + 2), phi ** (n + 1) + phi**n, Domain(), phi ** (n + 1) - phi**n),
    (phi ** (-n), (phi - 1) ** n, Domain(), (phi + 1) ** n),
    (GoldenRatio, phi, Domain(), sqrt(5) / 2),
    (x * GoldenRatio**2, x * (GoldenRatio + 1), Domain(), x * (GoldenRatio - 1)),
    (((1 - sqrt(5)) / 2) ** n, (-1) ** n * phi ** (-n), Domain(), phi ** (-n)),
    (
        ((1 - sqrt(5)) / 2) ** (n + 2),
        ((1 - sqrt(5)) / 2) ** (n + 1) + ((1 - sqrt(5)) / 2) ** n,
        Domain(),
        ((1 - sqrt(5)) / 2) ** (n + 1) - ((1 - sqrt(5)) / 2) ** n,
    ),
    ((3 + sqrt(5)) ** n / 2**n, phi ** (2 * n), Domain(), phi**n),
    (
        (phi ** (2 * n) - (-1) ** n * 2 + phi ** (-2 * n)),
        (phi**n - ((1 - sqrt(5)) / 2) ** n) ** 2,
        Domain(),
        (phi**n + ((1 - sqrt(5)) / 2) ** n) ** 2,
    ),
    ((sqrt(2) - 1) ** n, (sqrt(2) + 1) ** (-n), Domain(), (sqrt(2) + 1) ** n),
    ((1 + I) ** (2 * n), (2 * I) ** n, Domain(), 2**n),
    ((-2) ** n, (-1) ** n * 2**n, Domain(), 2**n),
    ((2 + sqrt(3)) ** x, (2 - sqrt(3)) ** (-x), Domain(), (2 - sqrt(3)) ** x),
    (phi ** (x + 2), phi ** (x + 1) + phi**x, Domain(), phi ** (x + 1) - phi**x),
    ((7 + 4 * sqrt(3)) ** n, (2 + sqrt(3)) ** (2 * n), Domain(), (2 + sqrt(3)) ** n),
    ((-1) ** (n * (n - 1) / 2) * (-1) ** (n * (n + 1) / 2), (-1) ** n, Domain(), Integer(1)),
    ((-1) ** (n**2), (-1) ** n, Domain(), Integer(1)),
    (I ** (n**2), Piecewise((1, Eq(Mod(n, 2), 0)), (I, True)), Domain(), 1),
    ((-1) ** n * (-1) ** k, (-1) ** (n + k), Domain(), (-1) ** (n + 2 * k)),
    ((-1) ** (n - k), (-1) ** (n + k), Domain(), -((-1) ** (n + k))),
    (cos(n * pi), (-1) ** n, Domain(), 1),
    ((-1) ** (n / 2 + Rational(1, 2)), I ** (n + 1), Domain(), I**n),
    (((1 + I * sqrt(3)) / 2) ** (6 * n), Integer(1), Domain(), Integer(-1)),
    (
        ((-1 + I * sqrt(3)) / 2) ** (n + 2),
        -(((-1 + I * sqrt(3)) / 2) ** (n + 1)) - ((-1 + I * sqrt(3)) / 2) ** n,
        Domain(),
        ((-1 + I * sqrt(3)) / 2) ** n,
    ),
]


@pytest.mark.parametrize(("left", "right", "domain", "twin"), TRUE)
def test_identity_holds_and_its_twin_fails(left, right, domain, twin):
    assert equal(left, right, domain).holds
    assert equal(left, twin, domain).fails


def test_powers_of_a_negative_number_with_a_real_exponent_keep_their_branch():
    assert equal((1 - sqrt(5)) ** x, (-1) ** x * (sqrt(5) - 1) ** x).holds
    assert equal(((1 + I) ** 2) ** (x / 2), (1 + I) ** x).holds
    assert equal(((-1 + I) ** 2) ** (x / 2), (-1 + I) ** x).fails
    assert equal((-1) ** (n / 2), I**n * (-1) ** n).fails
    assert equal((-1) ** (x / 2), I**x).holds
