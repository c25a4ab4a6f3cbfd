"""Expansions of named functions at places where they are analytic, to first order and beyond, and wrong twins."""

import mpmath
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from canon.exercise.claim_verdict import judge
from canon.exercise.question.series_expansion import check_analytic, coefficient, coefficients
from canon.exercise.sheet.sheet import Claim
from canon.expression.symbols.jacobi_functions import jacobi_sn
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Undecided

NAMES = dict.fromkeys(("m", "x", "A"), "real") | dict.fromkeys(("a", "l", "g"), "positive")
PERIOD = "4*sqrt(l/g)*elliptic_k(sin(A/2)**2)"


def told(exact, small, claim, order=1, **more):
    keys = {"exact": [exact], "small": [small], "claim": [claim], "order": order, "parameters": NAMES, **more}
    return judge(Claim("a", "first-order", keys))


@pytest.mark.parametrize(
    ("exact", "small", "order", "right", "wrong"),
    [
        ("elliptic_k(m)", "m", 1, "pi/2*(1 + m/4)", "pi/2*(1 + m/2)"),
        ("elliptic_k(m)", "m", 2, "pi/2*(1 + m/4 + 9*m**2/64)", "pi/2*(1 + m/4 + 9*m**2/32)"),
        ("elliptic_e(m)", "m", 2, "pi/2*(1 - m/4 - 3*m**2/64)", "pi/2*(1 - m/4 + 3*m**2/64)"),
        ("elliptic_e(x, m)", "m", 1, "x - m*(x/4 - sin(2*x)/8)", "x - m*(x/2 - sin(2*x)/4)"),
        ("elliptic_k(1/2 + m)", "m", 1, "elliptic_k(1/2) + m*(2*elliptic_e(1/2) - elliptic_k(1/2))",
         "elliptic_k(1/2) + m*(4*elliptic_e(1/2) - 2*elliptic_k(1/2))"),
        ("elliptic_pi(m, 0)", "m", 1, "pi/2*(1 + m/2)", "pi/2*(1 + m)"),
        (PERIOD, "A", 2, "2*pi*sqrt(l/g)*(1 + A**2/16)", "2*pi*sqrt(l/g)*(1 + A**2/8)"),
        (PERIOD, "A", 4, "2*pi*sqrt(l/g)*(1 + A**2/16 + 11*A**4/3072)", "2*pi*sqrt(l/g)*(1 + A**2/16 + 11*A**4/1536)"),
        (PERIOD, "A", 1, "2*pi*sqrt(l/g)", "pi*sqrt(l/g)"),
        ("LambertW(x)", "x", 3, "x - x**2 + 3*x**3/2", "x - x**2 + x**3"),
        ("asin(1/2 + x)", "x", 1, "pi/6 + 2*x/sqrt(3)", "pi/6 + x/sqrt(3)"),
        ("acosh(2 + x)", "x", 1, "acosh(2) + x/sqrt(3)", "acosh(2) + x/sqrt(2)"),
        ("atan2(x, a)", "x", 1, "x/a", "a*x"),
        ("Abs(a + x)", "x", 2, "a + x", "a - x"),
        ("Abs(x - a)*sign(x - a)", "x", 2, "x - a", "a - x"),
        ("(elliptic_k(m) - elliptic_e(m))/m", "m", 1, "pi/4 + 3*pi*m/32", "pi/4 + pi*m/32"),
    ],
)  # fmt: skip
def test_an_expansion_and_its_wrong_twin(exact, small, order, right, wrong):
    assert told(exact, small, right, order).holds
    verdict = told(exact, small, wrong, order)
    assert verdict.fails
    assert "order" in verdict.feedback


@pytest.mark.parametrize(
    "exact", ["elliptic_k(1 + m)", "elliptic_k(2 + m)", "elliptic_k(a + m)", "Abs(m)", "acot(m)", "asin(1 + m)",
              "LambertW(m - exp(-1))", "acosh(1 + m)", "elliptic_pi(2 + m, 1/2)"],
)  # fmt: skip
def test_what_is_not_analytic_there_stays_undecided(exact):
    assert told(exact, "m", "a", 1).undecided


def test_where_the_domain_says_that_it_is_analytic():
    claim = "elliptic_k(a) + m*(elliptic_e(a) - (1 - a)*elliptic_k(a))/(2*a*(1 - a))"
    assert told("elliptic_k(a + m)", "m", claim, domain=["a < 1"]).holds
    assert told("elliptic_k(a + m)", "m", claim.replace("2*a", "a"), domain=["a < 1"]).fails


e = sp.Symbol("e", real=True)


@pytest.mark.parametrize("f", [sp.elliptic_k(e), sp.elliptic_e(e), sp.LambertW(e), sp.elliptic_e(1, e)])
def test_coefficients_against_numbers(f):
    """Differences at many digits give the same."""
    g = sp.lambdify(e, f, "mpmath")
    with mpmath.workdps(60):
        numbers = mpmath.taylor(g, 0, 5, singular=True)
    for k, number in enumerate(numbers):
        assert abs(complex(number) - complex(sp.N(coefficient(f, e, k), 20))) < 1e-9


x = sp.Symbol("x", positive=True)
leaves = st.sampled_from([e, x, 1 + e, x - e, sp.cos(x + e), sp.exp(e * x), sp.Integer(2)])
powers = st.sampled_from([2, 3, -1, -2, sp.Rational(1, 2), sp.Rational(-3, 2), sp.Rational(5, 3)])


def positive(f):
    return sp.exp(f) if f.subs({e: 0, x: 1}).evalf() <= 0 else f


functions = st.recursive(
    leaves,
    lambda parts: st.one_of(
        st.lists(parts, min_size=2, max_size=3).map(lambda of: sp.Add(*of)),
        st.lists(parts, min_size=2, max_size=3).map(lambda of: sp.Mul(*of)),
        st.tuples(parts, powers).map(lambda of: positive(of[0]) ** of[1]),
    ),
    max_leaves=6,
)


@given(functions, st.integers(0, 4))
def test_coefficients_are_those_of_derivatives(f, order):
    """The second route is SymPy's derivative of the whole; both at x = 1."""
    for k, c in enumerate(coefficients(f, e, order)):
        derivative = (f.diff(e, k) if k else f).subs({e: 0, x: 1}) / sp.factorial(k)
        left, right = sp.N(c.subs(x, 1), 30), sp.N(derivative, 30)
        assert abs(left - right) <= 1e-20 * (1 + abs(right))


def test_the_square_of_what_may_be_zero_has_no_quotient():
    """At x = 1 the first coefficient of the base is 0; (x − 1 + e)² is a polynomial there too."""
    assert coefficients((x - 1 + e) ** 2, e, 2) == [(x - 1) ** 2, 2 * x - 2, 1]
    assert coefficients((x - 1 + e) ** 20, e, 1)[1].subs(x, 1) == 0


z, b = sp.Symbol("z", real=True), sp.Symbol("b", positive=True)
UP_TO_THREE = Domain((b < 3,))


@pytest.mark.parametrize(("analytic", "singular"), [
    (sp.cot(z + b), sp.cot(z)),
    (sp.csc(b - z), sp.csc(b * z)),
    (jacobi_sn(z, b), jacobi_sn(z + sp.I, b)),  # poles where the imaginary part is K(1 − m)
    (sp.atan2(z, z + b), sp.atan2(z, z - b)),  # the cut along the negative axis
    (sp.atan2(z + b, z - b), sp.atan2(z, z)),
])  # fmt: skip
def test_functions_are_expanded_where_they_are_analytic_and_nowhere_else(analytic, singular):
    check_analytic(analytic, {z: sp.S.Zero}, UP_TO_THREE)
    with pytest.raises(Undecided, match="is not certainly analytic there"):
        check_analytic(singular, {z: sp.S.Zero}, UP_TO_THREE)


def test_coefficients_of_powers_whose_exponent_is_small():
    assert coefficients(b ** (z + 1), z, 2) == [b, b * sp.log(b), b * sp.log(b) ** 2 / 2]
    assert coefficients(jacobi_sn(z, b), z, 3) == [0, 1, 0, -(1 + b) / 6]  # DLMF 22.10.4


@pytest.mark.parametrize("f", [sp.sqrt(z), z**z, z ** sp.Rational(5, 3)])
def test_what_has_no_expansion_in_whole_powers_is_told(f):
    with pytest.raises(Undecided, match="is not finite, so this is no expansion in whole powers"):
        coefficients(f, z, 2)
