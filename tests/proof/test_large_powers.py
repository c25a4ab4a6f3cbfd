"""Large whole exponents."""

import math

import pytest
from sympy import (
    Abs,
    E,
    I,
    Integer,
    Pow,
    Rational,
    cos,
    cosh,
    diff,
    exp,
    factorial,
    log,
    sin,
    sinh,
    sqrt,
    symbols,
    tan,
)

from canon.expression.symbols.magnitude import digits, has_huge_number
from canon.proof import Domain, equal
from canon.proof.domain.limits import TooLarge
from canon.proof.functions.large_powers import LARGEST_EXPONENT
from canon.proof.tower.tower import LARGEST_POWER, Tower
from canon.proof.trees.replacement import LARGEST_WRITTEN, NoValue, replaced

x, y = symbols("x y", real=True)
w = symbols("w", complex=True)

TRUE = [
    ((x + 1) ** 250 * (x - 1) ** 250, (x**2 - 1) ** 250, Domain(), (x**2 + 1) ** 250),
    (sin(x) ** 300, (1 - cos(x) ** 2) ** 150, Domain(), (1 + cos(x) ** 2) ** 150),
    ((x**2 + 2 * x + 1) ** 300, (x + 1) ** 600, Domain(), (x + 1) ** 500),
    (
        sin(x) ** 300 + cos(x) ** 300,
        cos(x) ** 300 + sin(x) ** 298 * (1 - cos(x) ** 2),
        Domain(),
        cos(x) ** 300,
    ),
    (tan(x) ** 400 * cos(x) ** 400, sin(x) ** 400, Domain(), sin(x) ** 300),
    ((x - y) ** 400, (y - x) ** 400, Domain(), -((x - y) ** 400)),
    (((x + 1) ** 300 - (x + 1) ** 299), x * (x + 1) ** 299, Domain(), x * (x + 1) ** 300),
    (diff(sin(x) ** 300, x), 300 * sin(x) ** 299 * cos(x), Domain(), -300 * sin(x) ** 299 * cos(x)),
    ((x**2 - y**2) ** 300 / (x - y) ** 300, (x + y) ** 300, Domain(), (x - y) ** 300),
    ((1 + tan(x) ** 2) ** 250, 1 / cos(x) ** 500, Domain(), cos(x) ** 500),
    (sqrt(x**2 + 1) ** 501, (x**2 + 1) ** 250 * sqrt(x**2 + 1), Domain(), (x**2 + 1) ** 250),
    ((cosh(x) ** 2 - sinh(x) ** 2) ** 1000, 1, Domain(), 2),
    ((sin(x) ** 2 + cos(x) ** 2) ** 5000, 1, Domain(), 2),
    (cos(x) ** 2000 * (1 + tan(x) ** 2) ** 1000, 1, Domain(), 2),
    ((x + 1) ** 3000 * (x - 1) ** 3000, (x**2 - 1) ** 3000, Domain(), (x**2 + 1) ** 3000),
    ((1 + x) ** Rational(501, 2), (1 + x) ** 250 * sqrt(1 + x), Domain(), (1 + x) ** 250),
    (
        (exp(x / 3) + 1) * (exp(x / 6) + 1),
        exp(x / 2) + exp(x / 3) + exp(x / 6) + 1,
        Domain(),
        exp(x / 2) + 2 * exp(x / 3) + 1,
    ),
    (exp(I * x) ** 300, cos(300 * x) + I * sin(300 * x), Domain(), cos(300 * x)),
    (cos(2 * x) ** 250, (cos(x) ** 2 - sin(x) ** 2) ** 250, Domain(), (cos(x) ** 2 + sin(x) ** 2) ** 250),
    (y + ((x + 1) ** 2 - x**2 - 2 * x - 1) ** 201, y, Domain(), -y),
    ((2 * x + 6) ** 250, 2**250 * (x + 3) ** 250, Domain(), 2**249 * (x + 3) ** 250),
    ((-2 * x - 6) ** 251, -(2**251) * (x + 3) ** 251, Domain(), 2**251 * (x + 3) ** 251),
    (
        (x**2 + y**2 + 1) ** 301 * (x**2 - y**2 - 1) ** 301,
        (x**4 - (y**2 + 1) ** 2) ** 301,
        Domain(),
        (x**4 + (y**2 + 1) ** 2) ** 301,
    ),
    (
        (w + x + y) ** 301 * (w - x - y) ** 301,
        (w**2 - (x + y) ** 2) ** 301,
        Domain(),
        (w**2 + (x + y) ** 2) ** 301,
    ),
]


@pytest.mark.parametrize(("left", "right", "domain", "twin"), TRUE)
def test_identity_holds_and_its_twin_fails(left, right, domain, twin):
    assert equal(left, right, domain).holds
    assert equal(left, twin, domain).fails


def test_powers_of_sums_in_three_variables_are_not_multiplied_out():
    z = symbols("z", real=True)
    assert equal((x + y + z) ** 900 / (x + y + z) ** 899, x + y + z).holds
    assert equal((x + y + z) ** 900 - (x + y + z) ** 899, (x + y + z - 1) * (x + y + z) ** 899).holds
    assert equal((x * y + z) ** 100000 * (x * y - z) ** 100000, (x**2 * y**2 - z**2) ** 100000).holds


def test_the_sign_of_a_large_power_follows_its_parity():
    assert equal(sqrt((x + y) ** 1000), (x + y) ** 500).holds
    assert equal(sqrt((x + y) ** 1002), (x + y) ** 501).fails
    assert equal(sqrt((x + y + 1) ** 2002), Abs(x + y + 1) ** 1001).holds
    assert equal((x - y) ** 3001, -((y - x) ** 3001)).holds


@pytest.mark.parametrize("exponent", [1000, 10**6])
def test_a_power_of_e_is_as_long_as_the_exponential_function(exponent: int) -> None:
    power = Pow(E, exponent, evaluate=False)
    assert power.func is Pow
    assert digits(power) == pytest.approx(exponent * math.log10(math.e), rel=1e-12)
    assert has_huge_number(x + power) is (exponent > 10**5)


@pytest.mark.parametrize("terms", [1, 2])
def test_powers_that_flint_would_not_come_back_from_are_refused(terms):
    tower = Tower()
    base = tower.monomial(tower.generator("x")) + (terms - 1)
    assert len(tower.polynomial_power(base, LARGEST_POWER)) == (1 if terms == 1 else LARGEST_POWER + 1)
    with pytest.raises(TooLarge, match=f"the power {LARGEST_POWER + 1}"):
        tower.polynomial_power(base, LARGEST_POWER + 1)


def test_a_polynomial_of_a_huge_degree_is_not_listed_by_its_coefficients():
    tower = Tower()
    x = tower.generator("x")
    listed = tower.coefficients(tower.monomial(x, LARGEST_POWER) + 3, x)
    assert [listed[0], listed[-1], len(listed)] == [3, 1, LARGEST_POWER + 1]
    with pytest.raises(TooLarge, match=f"the degree {LARGEST_POWER + 1}"):
        tower.coefficients(tower.monomial(x, LARGEST_POWER + 1) + 3, x)


def test_a_power_beyond_all_that_are_meant_is_not_factored():
    for exponent, is_decided in ((LARGEST_EXPONENT, True), (LARGEST_EXPONENT + 2, False)):
        assert equal(((x + y) * (x - y)) ** exponent, (x**2 - y**2) ** exponent).holds is is_decided


@pytest.mark.parametrize("f", [x**y, factorial(x), exp(x * log(y))], ids=str)
def test_numbers_of_thousands_of_digits_are_not_written_out(f):
    """SymPy would write out 3**(10**9)."""
    exponent, base = (y, x) if f == x**y else (x, y)
    put_in = {exponent: Integer(LARGEST_WRITTEN), base: Integer(3)}
    assert digits(replaced(f, put_in)) > 400
    with pytest.raises(NoValue):
        replaced(f, put_in | {exponent: Integer(LARGEST_WRITTEN + 1)})
