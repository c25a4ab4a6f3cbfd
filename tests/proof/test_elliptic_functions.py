"""Elliptic functions and integrals in the zero test: identities of the handbooks, each with a wrong twin, and balls."""

from fractions import Fraction

import mpmath as mp
import pytest
import sympy as sp
from flint import acb, arb
from hypothesis import example, given, settings
from hypothesis import strategies as st

from canon.expression.symbols.jacobi_functions import (
    JACOBI,
    jacobi_am,
    jacobi_cn,
    jacobi_dn,
    jacobi_epsilon,
    jacobi_sn,
)
from canon.proof.domain.balls import precision, value
from canon.proof.domain.domain import EVERYWHERE, Domain
from canon.proof.domain.theta_quotients import amplitude, epsilon, sn_cn_dn
from canon.proof.vanish import vanishes

u, v, m = sp.symbols("u v m", real=True)
k = sp.Symbol("k", positive=True)
E = sp.Symbol("E", real=True)
s, c, d = (f(u, m) for f in (jacobi_sn, jacobi_cn, jacobi_dn))
a, b, e = (f(v, m) for f in (jacobi_sn, jacobi_cn, jacobi_dn))
K, F, Legendre, Third = sp.elliptic_k(m), sp.elliptic_f, sp.elliptic_e, sp.elliptic_pi
BELOW_ONE = Domain((m < 1,))

IDENTITIES = {
    "squares of sn and cn": (s**2 + c**2, sp.S.One, EVERYWHERE),
    "squares of sn and dn": (m * s**2 + d**2, sp.S.One, EVERYWHERE),
    "dn is a root": (sp.sqrt(1 - m * s**2), d, BELOW_ONE),
    "a scaled root": (
        sp.sqrt(2 + 2 * E - 4 * jacobi_sn(u, 2 / (1 + E)) ** 2),
        sp.sqrt(2 + 2 * E) * jacobi_dn(u, 2 / (1 + E)),
        Domain((E > 1,)),
    ),
    "Legendre's integral of the amplitude": (F(jacobi_am(u, m), m), u, BELOW_ONE),
    "amplitude of Legendre's integral": (jacobi_am(F(u, m), m), u, BELOW_ONE),
    "sn of Legendre's integral": (jacobi_sn(F(u, m), m), sp.sin(u), BELOW_ONE),
    "second integral of the amplitude": (Legendre(jacobi_am(u, m), m), jacobi_epsilon(u, m), BELOW_ONE),
    "addition of sn": (
        jacobi_sn(u + v, m),
        (s * b * e + a * c * d) / (1 - m * s**2 * a**2),
        BELOW_ONE,
    ),
    "addition of cn": (
        jacobi_cn(u - v, m),
        (c * b + s * a * d * e) / (1 - m * s**2 * a**2),
        BELOW_ONE,
    ),
    "doubling of dn": (jacobi_dn(2 * u, m), (d**2 - m * s**2 * c**2) / (1 - m * s**4), BELOW_ONE),
    "a quarter period on": (jacobi_sn(u + K, m), c / d, BELOW_ONE),
    "dn a quarter period on": (jacobi_dn(u + K, m), sp.sqrt(1 - m) / d, BELOW_ONE),
    "half a quarter period": (jacobi_sn(K / 2, m), 1 / sp.sqrt(1 + sp.sqrt(1 - m)), BELOW_ONE),
    "half a turn": (jacobi_am(u + 2 * K, m), jacobi_am(u, m) + sp.pi, BELOW_ONE),
    "half a turn of F": (F(u + sp.pi, m), F(u, m) + 2 * K, BELOW_ONE),
    "half a turn of E": (Legendre(u - sp.pi, m), Legendre(u, m) - 2 * Legendre(m), BELOW_ONE),
    "half a turn of the third kind": (
        Third(-1, u + sp.pi, m),
        Third(-1, u, m) + 2 * Third(-1, m),
        BELOW_ONE,
    ),
    "sine of the amplitude": (sp.sin(2 * jacobi_am(u, m)), 2 * s * c, BELOW_ONE),
    "sine of an arc": (
        sp.sin(2 * sp.asin(k * jacobi_sn(u, k**2))),
        2 * k * jacobi_sn(u, k**2) * jacobi_dn(u, k**2),
        Domain((k < 1,)),
    ),
    "slope of K": (K.diff(m), (Legendre(m) - (1 - m) * K) / (2 * m * (1 - m)), BELOW_ONE),
    "slope of E": (Legendre(m).diff(m), (Legendre(m) - K) / (2 * m), BELOW_ONE),
    "slope of sn": (s.diff(u), c * d, EVERYWHERE),
    "slope of the third kind": (
        Third(-k, u, m).diff(u),
        1 / ((1 + k * sp.sin(u) ** 2) * sp.sqrt(1 - m * sp.sin(u) ** 2)),
        BELOW_ONE,
    ),
    "equal characteristic and parameter": (
        Third(m, m, evaluate=False),
        Legendre(m) / (1 - m),
        BELOW_ONE,
    ),
    "mixed slopes": (jacobi_am(u, m).fdiff(2).diff(u), d.diff(m), BELOW_ONE),
    "mixed slopes of ε": (jacobi_epsilon(u, m).fdiff(2).diff(u), (d**2).diff(m), BELOW_ONE),
}


@pytest.mark.parametrize("name", IDENTITIES)
def test_identities_of_the_handbooks(name):
    left, right, domain = IDENTITIES[name]
    assert vanishes(left - right, domain).holds
    assert vanishes(left - right - m / 10**9, domain).fails


@pytest.mark.parametrize(
    "wrong",
    [
        s**2 - c**2 - 1,
        d**2 - m * s**2 - 1,
        s.diff(u) - c,
        jacobi_sn(u + K, m) - c,
        jacobi_am(u + K, m) - jacobi_am(u, m) - sp.pi / 2,
        jacobi_sn(2 * u, m) - 2 * s * c,
        F(jacobi_am(u, m), m) - jacobi_am(u, m),
        F(u + sp.pi / 2, m) - F(u, m) - K,
        K.diff(m) - (Legendre(m) - K) / (2 * m * (1 - m)),
    ],
)
def test_wrong_twins(wrong):
    assert vanishes(wrong, BELOW_ONE).fails


def test_beyond_the_unit_parameter_the_amplitude_swings_and_is_no_inverse():
    swinging = Domain((m > 1,))
    assert vanishes(s**2 + c**2 - 1, swinging).holds
    assert vanishes(d**2 + m * s**2 - 1, swinging).holds
    assert vanishes(d - sp.sqrt(1 - m * s**2), swinging).fails
    assert vanishes(F(jacobi_am(u, m), m) - u, swinging).fails


@example(jacobi_epsilon, Fraction(1), Fraction(3))  # 1/3 was worked out in doubles once
@given(
    st.sampled_from(JACOBI),
    st.fractions(-20, 20, max_denominator=97),
    st.fractions(-3, 3, max_denominator=97).filter(lambda x: x not in (0, 1)),
)
@settings(deadline=None, max_examples=50)
def test_balls_hold_the_values_of_another_library(f, argument, parameter):
    """The nome's quotients of theta functions against mpmath's descending transformations."""
    point = {u: sp.Rational(argument), m: sp.Rational(parameter)}
    with precision(150):
        ball = value(f(u, m), point)
        assert ball.imag.is_zero()
        assert ball.rel_accuracy_bits() > 60 or ball.contains(0)
        due = arb(str(f(*point.values()).n(55))) + arb(0, 1e-45)
        assert ball.real.overlaps(due)
        assert not ball.real.overlaps(due + arb(1) / 10**9)


def test_balls_at_complex_arguments():
    argument, parameter = acb(1, 2), acb("0.3")
    with precision(120):
        found = sn_cn_dn(argument, parameter)
        for ball, name in zip(found, ("sn", "cn", "dn"), strict=True):
            with mp.workprec(200):
                due = mp.ellipfun(name, mp.mpc(1, 2), m=mp.mpf("0.3"))
            assert abs(complex(ball.mid()) - complex(due)) < 1e-14


def test_a_pole_at_an_imaginary_argument_has_no_value():
    """sn has its pole at i K(1 − m), where zero times it is not zero."""
    pole = sp.I * sp.elliptic_k(1 - m)
    assert not vanishes(sp.Mul(0, jacobi_sn(pole, m), evaluate=False), Domain((m > 0, m < 1))).holds


NOUGHT = (k + 1) ** 2 - k**2 - 2 * k - 1
"""Zero once it is multiplied out, which SymPy does not do when it takes a function of it."""

DEGENERATE = [
    (sp.elliptic_k(NOUGHT), sp.pi / 2, sp.pi, ()),
    (F(u, NOUGHT), u, 2 * u, ()),
    (jacobi_am(u, NOUGHT), u, -u, ()),
    (jacobi_sn(u, NOUGHT), sp.sin(u), sp.cos(u), ()),
    (jacobi_cn(u, NOUGHT), sp.cos(u), -sp.cos(u), ()),
    (Third(NOUGHT, m), K, 2 * K, (m < 1,)),
    (Third(NOUGHT, u, m), F(u, m), F(2 * u, m), (m < 1,)),
]


@pytest.mark.parametrize(("left", "right", "wrong", "domain"), DEGENERATE)
def test_parameters_and_characteristics_that_turn_out_to_be_zero(left, right, wrong, domain):
    assert vanishes(left - right, Domain(domain)).holds
    assert vanishes(left - wrong, Domain(domain)).fails


@pytest.mark.parametrize(
    ("left", "right", "wrong"),
    [
        (jacobi_am(2 * K, m), sp.pi, sp.pi / 2),
        (jacobi_am(3 * K, m), 3 * sp.pi / 2, -sp.pi / 2),
        (jacobi_am(-K, m), -sp.pi / 2, sp.pi / 2),
        (F(sp.asin(v) + sp.acos(v), m), K, -K),
        (F(2 * sp.asin(v) + 2 * sp.acos(v), m), 2 * K, K),
        (F(-3 * sp.asin(v) - 3 * sp.acos(v), m), -3 * K, 3 * K),
        (Legendre(sp.asin(v) + sp.acos(v), m), Legendre(m), K),
    ],
)
def test_arcs_and_amplitudes_of_whole_quarter_periods(left, right, wrong):
    inside = Domain((m < 1, v > -1, v < 1))
    assert vanishes(left - right, inside).holds
    assert vanishes(left - wrong, inside).fails


@pytest.mark.parametrize("f", [lambda z: F(z, m), lambda z: Third(z, m), lambda z: Third(z, u, m)])
def test_of_parameters_that_may_be_anything_only_equal_arguments_are_equal(f):
    assert vanishes(f(v * (v + 1)) - f(v**2 + v)).holds
    assert vanishes(f(v * (v + 1)) - f(v**2 - v)).fails


@pytest.mark.parametrize("argument", [13 * u, -25 * u / 2, 14 * F(u, m), u + 13 * v])
def test_many_times_an_argument_is_an_argument_of_its_own(argument):
    """What is known of m makes nothing less decided."""
    circle = jacobi_sn(argument, m) ** 2 + jacobi_cn(argument, m) ** 2
    for domain in (EVERYWHERE, BELOW_ONE):
        assert vanishes(circle - 1, domain).holds
        assert vanishes(circle - 2, domain).fails


def test_many_times_an_argument_forwards_and_backwards():
    there, back = jacobi_sn(v - 13 * u, m), jacobi_sn(13 * u - v, m)
    assert vanishes(there + back, BELOW_ONE).holds
    assert vanishes(there - back, BELOW_ONE).fails


def test_at_the_parameter_one_elliptic_functions_are_hyperbolic():
    with precision(120), mp.workprec(150):
        due = (mp.tanh(2), mp.sech(2), mp.sech(2))
        for ball, right in zip(sn_cn_dn(acb(2), acb(1)), due, strict=True):
            assert ball.overlaps(acb(str(right)))
            assert ball.rel_accuracy_bits() > 100


def test_amplitudes_have_values_at_real_arguments_that_are_narrowly_known():
    parameter = acb("0.3")
    narrow = acb(arb(7, 1e-20))
    for f, due in ((amplitude, jacobi_am), (epsilon, jacobi_epsilon)):
        with precision(120):
            right = arb(str(due(sp.Integer(7), sp.Rational(3, 10)).n(30)))
            assert f(narrow, parameter).real.overlaps(right + arb(0, 1e-18))
            assert not f(narrow, parameter).real.overlaps(right + arb(1) / 10**9)
            for unknown in (acb(7, 1), acb(arb(0, 1000)), acb("inf")):
                assert not f(unknown, parameter).is_finite()
