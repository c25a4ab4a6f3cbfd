"""The arithmetic below normal forms: roots in number fields, real roots, dependent fractions, ideals, signs, places."""

import pytest
import sympy as sp
from flint import arb, fmpq
from sympy import Abs, Eq, Function, Poly, cos, exp

from canon.proof import Domain, equal, vanishes
from canon.proof.domain.balls import precision
from canon.proof.functions.normal_form import NormalForm
from canon.proof.tower.algebraic_numbers import root_in_field
from canon.proof.tower.factors import modulus_of_polynomial
from canon.proof.tower.tower import Tower
from canon.proof.trees.function_places import places_apart
from canon.proof.trees.polynomial_roots import Root, real_roots

x, y, z, u, v = sp.symbols("x y z u v", real=True)


def root_of(a, b, degree, *, power=1, radius=0.0):
    """Return α with α^degree = (a + b√2)^power, as {exponent of √2: coefficient}; None where none is found."""
    tower = Tower()
    rho = tower.monomial(tower.generator("√2"))
    tower.relate(0, 2, tower.constant(2))
    p = tower.polynomial_power(tower.constant(a) + tower.constant(b) * rho, power)
    with precision(256):
        size = ((arb(a) + arb(b) * arb(2).sqrt()) ** power).root(degree) + arb(0, radius)
        found = root_in_field(tower, p, degree, size)
    return None if found is None else {sum(e for _, e in m): c for m, c in tower.terms(found)}


@pytest.mark.parametrize("b", [fmpq(1), fmpq(-1, 2), fmpq(3, 10)])
@pytest.mark.parametrize("degree", [2, 3, 4, 6])
def test_a_root_in_the_field_of_the_number_is_found(b, degree):
    assert root_of(fmpq(3), b, degree, power=degree) == {0: 3, 1: b}


@pytest.mark.parametrize(
    ("a", "b", "degree", "power"),
    [
        (1, 1, 4, 1),  # of norm −1
        (3, 2, 3, 1),  # of norm 1, and no cube
        (7, 1, 3, 1),  # of norm 47
        (3, fmpq(1, 11), 3, 3),  # denominators up to 12 are tried, but for 11
        (10**6, 1, 6, 6),  # of a norm of 73 digits
    ],
)
def test_no_root_is_found_outside_the_field_nor_of_long_numbers(a, b, degree, power):
    assert root_of(fmpq(a), fmpq(b), degree, power=power) is None


def test_a_root_is_multiplied_out_before_it_is_believed():
    assert root_of(fmpq(17), fmpq(12), 3, radius=0.3) is None
    assert root_of(fmpq(3), fmpq(2), 2, radius=0.01) == {0: 1, 1: 1}


def test_roots_of_odd_degree_are_real_and_are_written_of_numbers():
    a = sp.Symbol("a", real=True)
    assert real_roots(Poly(x**3 + 8, x)) == [Root(sp.Integer(-2))]
    assert real_roots(Poly(2 * x**5 - 64, x)) == [Root(sp.Integer(2))]
    assert real_roots(Poly(x**3 - a, x)) is None
    assert real_roots(Poly(x**3 - a, x), positive=True) == [Root(sp.cbrt(a))]


def test_places_are_compared_of_one_function():
    V, W = Function("V"), Function("W")
    assert list(places_apart([V(x) + W(y)])) == []
    assert list(places_apart([V(x) + W(y) + V(y)])) == [(V(x), V(y))]


def test_the_modulus_of_a_difference_is_one_kernel_whichever_way_it_is_written():
    forms = NormalForm(Domain(), {})
    gap, other = (forms.form(f).num for f in (x - y, x + y))
    assert modulus_of_polynomial(forms, gap) == modulus_of_polynomial(forms, -gap)
    assert modulus_of_polynomial(forms, gap) != modulus_of_polynomial(forms, other)


def many(number):
    return sp.Add(*sp.symbols(f"s1:{number + 1}", real=True))


@pytest.mark.parametrize("terms", [1, 5, 70])
def test_exponents_whose_sum_is_a_number_are_known_where_the_denominator_is_short(terms):
    rest = many(terms)
    below = x + rest
    first, second = exp(x / below), exp(rest / below)
    found = equal((first + 1) * (second + 1), sp.E + first + second + 1, budget=0.5)
    assert found.holds is (terms < 70)
    assert not found.fails
    assert equal((first + 1) * (second + 1), sp.E - first + second + 1).fails


@pytest.mark.parametrize("degree", [3, 67])
def test_exponents_over_a_difference_of_powers_and_its_long_factor(degree):
    whole = x**degree - y**degree
    factor = sp.Add(*(x**k * y ** (degree - 1 - k) for k in range(degree)))
    first, second = exp(x / whole), exp(-y / whole)
    found = equal((first + 1) * (second + 1), exp(1 / factor) + first + second + 1, budget=0.5)
    assert found.holds is (degree == 3)
    assert not found.fails
    assert equal((first + 1) * (second + 1), exp(2 / factor) + first + second + 1, budget=0.5).fails


def test_exponents_over_what_is_zero_on_one_side():
    below = x + Abs(x)
    product = (exp(y / below) + 1) * (exp(1 / below) - 1)
    right = exp((1 + y) / below) - exp(y / below) + exp(1 / below) - 1
    assert equal(product, right, Domain((x > 0,))).holds
    assert equal(product, -right, Domain((x > 0,))).fails
    assert not equal(product, right, budget=0.5).fails


def test_every_entry_is_reduced_by_all_equalities_together():
    circle = Domain((Eq(x**2 + y**2, 1), Eq(u**2 + v**2, 1), Eq(x * u + y * v, 0)))
    area = (x * v - y * u) ** 2 - 1
    assert vanishes(sp.Matrix([area, area * x, y * area]), circle).holds
    assert vanishes(sp.Matrix([area, area * x, y * area + x]), circle).fails


def test_long_conditions_give_signs():
    long = many(12)
    two = Domain((long > 0, long + x > 0))
    assert equal(Abs(long + x), long + x, two).holds
    assert equal(Abs(long - x), long - x, two).fails


def test_of_many_conditions_beside_many_waves_each_gives_a_sign():
    names, angles = sp.symbols("a1:10", real=True), sp.symbols("b1:10", real=True)
    several = Domain(tuple(a + y**2 > 0 for a in names))
    waves = sp.Add(*map(cos, angles))
    assert equal(Abs(names[0] + y**2) * waves, (names[0] + y**2) * waves, several).holds
    assert equal(Abs(names[0] - y**2) * waves, (names[0] - y**2) * waves, several).fails


def test_an_equality_for_the_square_of_a_symbol_holds_beside_complex_numbers():
    w = sp.Symbol("w", complex=True)
    root = Domain((sp.Ne(w, 5), Eq(y**2, w**2 + 1)))
    assert equal(y**2 * z, (w**2 + 1) * z, root).holds
    assert equal(y**2 * z, (w**2 - 1) * z, root, budget=0.5).fails
