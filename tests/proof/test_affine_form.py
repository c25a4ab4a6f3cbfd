"""Affine is what has the form of it: steps and atan(tan x) have the derivatives of affine functions and more values."""

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.proof.domain.domain import Domain
from canon.proof.domain.relations import isolated, linear, unfolded
from canon.proof.equivalence import equivalent_equations
from canon.proof.rungs.cases import eliminations
from canon.proof.trees.affine_form import is_affine
from canon.proof.vanish import equal

x, y, z = sp.symbols("x y z", real=True)
STEP = sp.Piecewise((2, x > 1), (0, True))
SAW = sp.atan(sp.tan(x))
COEFFICIENTS = st.integers(-3, 3)


@given(st.lists(COEFFICIENTS, min_size=3, max_size=3), COEFFICIENTS, COEFFICIENTS)
@settings(max_examples=50, deadline=None)
def test_an_affine_function_is_what_its_slopes_and_rest_make_of_it(numbers, k, l):
    a, b, c = numbers
    f = (a + k * z**2) * x + (b * y + c) * (1 + l * z) - k * y * (z - 1)
    assert is_affine(f, [x, y])
    slopes = {s: sp.expand(f).diff(s) for s in (x, y)}
    rest = f.xreplace({x: sp.Integer(0), y: sp.Integer(0)})
    assert sp.expand(f - rest - sum(s * slope for s, slope in slopes.items())) == 0
    assert not is_affine(f + x * y, [x, y])


@pytest.mark.parametrize("bent", [SAW, x + STEP, abs(x), sp.sign(x), x**2, x * sp.sign(y * x), sp.sqrt(x)])
def test_what_only_has_constant_slopes_is_not_affine(bent):
    assert not is_affine(bent, [x])
    assert not linear(bent > 3)
    assert isolated(bent > 3) == (bent > 3)
    assert not [s for s, _, _ in eliminations(Domain((sp.Eq(bent - y, 3),)), {y}) if s == x]


@pytest.mark.parametrize(
    ("left", "right", "domain"),
    [
        (abs(x), x, (sp.Rational(1, 4) < SAW,)),
        (abs(x - 2), x - 2, (x + STEP > 2,)),
        (x, sp.Integer(4), (sp.Eq(x + STEP, 4),)),
        (x, sp.Rational(1, 2), (sp.Eq(SAW, sp.Rational(1, 2)),)),
        (x, sp.Integer(7), (sp.Eq(SAW, sp.Rational(1, 2)), x > 3, x < 4)),
    ],
)
def test_a_step_does_not_narrow_the_domain(left, right, domain):
    """True at every point that the constant slope would have left of the domain, false at others."""
    assert not equal(left, right, Domain(domain)).holds


@pytest.mark.parametrize(
    ("left", "right", "domain"),
    [
        (abs(x), x, (x + sp.Piecewise((3, x < 0), (0, True)) < 2, x > -1)),
        (x, sp.Integer(2), (sp.Eq(x + STEP, 4),)),
    ],
)
def test_a_counterexample_is_a_point_of_the_domain_as_it_was_given(left, right, domain):
    assert not equal(left, right, Domain(domain)).fails


@pytest.mark.parametrize(
    ("left", "right", "domain", "status"),
    [
        (abs(x), x, (2 * x - 1 > 0,), "HOLDS"),
        (abs(x), x, (2 * x + 1 > 0,), "FAILS"),
        (x, sp.Integer(4), (sp.Eq(x * (1 + y) - x * y, 4),), "HOLDS"),
        (x, sp.Integer(5), (sp.Eq(x * (1 + y) - x * y, 4),), "FAILS"),
        (x**2, 1 - y, (sp.Eq(x**2 + y, 1),), "HOLDS"),
        (x * y, sp.Integer(2), (sp.Eq(x, sp.sqrt(2)), sp.Eq(y, sp.sqrt(2))), "HOLDS"),
        (x * y, sp.Integer(3), (sp.Eq(x, sp.sqrt(2)), sp.Eq(y, sp.sqrt(2))), "FAILS"),
        (x + y, sp.Integer(1), (x + y >= 1, x + y <= 1), "HOLDS"),
        (sp.sqrt(x) * y, x, (sp.Eq(y, sp.sqrt(x)), x > 1), "HOLDS"),
        (y, sp.Integer(2), (sp.Eq(y, sp.sqrt(x)), x > 1), "FAILS"),
    ],
)
def test_affine_conditions_are_used_as_before(left, right, domain, status):
    assert equal(left, right, Domain(domain)).status.name == status


def test_a_modulus_is_unfolded_where_it_is_one_of_a_real_number():
    assert len(unfolded(abs(x) < 1)) == 2
    assert len(unfolded(sp.Abs(sp.sqrt(x)) < 1)) == 1
    assert not equal(abs(x), sp.sqrt(x) ** 2, Domain((sp.Abs(sp.sqrt(x)) < 1,))).holds


def test_systems_of_equations_go_by_the_form_too():
    u = sp.Symbol("u", real=True)
    assert equivalent_equations([u * (1 + x) - u * x - y], [u - y], [u]).holds
    with pytest.raises(ValueError, match="not affine"):
        equivalent_equations([sp.atan(sp.tan(u)) - y], [u - y], [u])
