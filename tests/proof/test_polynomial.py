"""Factors by FLINT: against products made up, and against SymPy where that is quick."""

import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.proof.trees.polynomial import polynomial_factors
from canon.proof.trees.polynomial_roots import Root, polynomial_in, real_roots

x, y, z = sp.symbols("x y z")
IRREDUCIBLE = [x, y, x + y, x**2 + 1, x * y - 2, x + z**2, sp.sin(x) + y, sp.cos(z) - 3]


@settings(max_examples=50, deadline=None)
@given(st.lists(st.sampled_from(IRREDUCIBLE), min_size=1, max_size=5), st.integers(1, 9))
def test_the_factors_of_a_product_are_found_again(factors, number):
    found = polynomial_factors(sp.expand(sp.Rational(number, 7) * sp.Mul(*factors)))
    assert dict(found) == {f: factors.count(f) for f in factors}


def test_numerators_symbols_under_functions_and_irrational_coefficients():
    assert polynomial_factors((x**2 - 1) / (y + 1)) == [(x - 1, 1), (x + 1, 1)]
    assert polynomial_factors(sp.Integer(6)) == []
    assert polynomial_factors((sp.sqrt(2) * x - y) ** 3) == [(sp.sqrt(2) * x - y, 3)]


def test_six_variables_take_no_time():
    v = sp.symbols("v0:3")
    gradient = [8 * x**7 * y**4, 4 * x**8 * y**3 + 6 * y**5 * z**5, 5 * y**6 * z**4 + 1]
    form = sum(a * b for a, b in zip(v, gradient, strict=True))
    factors = [1 + x**4 * y**4 * z**4, form, v[0] + v[1] * y**3 + v[2] * z]
    found = polynomial_factors(sp.expand(sp.Mul(*factors)))
    assert len(found) == 3
    assert all(any(sp.expand(f - g) == 0 or sp.expand(f + g) == 0 for g, _ in found) for f in factors)


def test_what_cancels_when_it_is_expanded_stays_whole():
    nothing = sp.exp(x) * sp.exp(y) - sp.exp(x + y)
    assert polynomial_factors(nothing) == [(nothing, 1)]
    assert dict(polynomial_factors(sp.exp(x) * sp.exp(y) + sp.exp(x + y) + 1))


def test_what_does_not_depend_on_the_unknown_has_no_roots_in_it() -> None:
    for constant in (y + 1, sp.Integer(3), sp.S.Zero, sp.sqrt(x)):
        assert polynomial_in(constant, x) is None
    assert real_roots(polynomial_in(x * y + 1, x)) == [Root(-1 / y)]
