"""Jumps that roots, logarithms and poles hide, and the ordinary functions that have the same parts and none."""

import pytest
import sympy as sp
from sympy import (
    Abs,
    Function,
    I,
    acos,
    acosh,
    arg,
    asin,
    atan,
    atan2,
    atanh,
    elliptic_k,
    exp,
    log,
    pi,
    sign,
    sin,
    sqrt,
    tanh,
)  # fmt: skip

from canon.proof.continuity.branching import open_surfaces
from canon.proof.continuity.continuity import continuity
from canon.proof.domain.domain import Domain

q, p, a = sp.symbols("q p a", real=True)
E, k, l = sp.symbols("E k l", positive=True)
V = Function("V")
OF_ROOTS = sqrt(q - 1) * sqrt(q + 1) / sqrt(q**2 - 1)
"""1 for q > −1, and −1 for q < −1."""
OF_POLES = q * sqrt(1 + 1 / q**2) / sqrt(1 + q**2)
"""The sign of q, in roots that are real."""


@pytest.mark.parametrize(
    "step",
    [OF_ROOTS, OF_POLES, (log(-q) - log(q)) / (I * pi), sqrt(-q) / (I * sqrt(q)), arg(q) / pi, sign(1 + 1 / q),
     sqrt(q**2 + q**4) / (q * sqrt(1 + q**2)), I * (-q) ** sp.Rational(3, 2) / q ** sp.Rational(3, 2)],
)  # fmt: skip
def test_hidden_steps_are_certified(step):
    assert continuity(p * step, [q, p]).fails
    assert continuity(q * p + step, [q, p]).fails


def test_the_sides_of_a_certified_jump_are_its_limits():
    found = continuity(p * OF_ROOTS, [q, p]).counterexample
    near, place = sp.Rational(1, 10**9), sp.Rational(found.point["q"])
    value = {p: sp.Rational(found.point["p"])}
    for end, told in ((place - near, found.left), (place + near, found.right)):
        assert abs(complex((p * OF_ROOTS).subs({**value, q: end}).evalf(30)) - float(told)) < 1e-6
    assert place == -1


@pytest.mark.parametrize(
    "open_", [tanh(1 / q), V(1 / q), 1 / (1 + exp(1 / q)), exp(1 / q) - exp(2 / q), sin(1 / q)]
)
def test_what_is_taken_of_a_pole_is_not_called_continuous(open_):
    assert not continuity(p * open_, [q, p]).holds
    assert continuity(p * open_, [q, p], Domain((q > 2,))).holds


@pytest.mark.parametrize(
    "plain",
    [
        q * sqrt(2 * E - q**2) / 2 + E * asin(q / sqrt(2 * E)),
        sqrt(2 * E + 2 * k / q - l**2 / q**2),
        acos((l**2 / (k * q) - 1) / sqrt(1 + 2 * E * l**2 / k**2)),
        q * log(p) - q,
        log((1 + q) / (1 - q)) / 2,
        log(q - 1) - log(q + 1),
        log(q**2) + p,
        sqrt(q) * log(q) + sqrt(q) / (1 + q),
        atanh(q) + atan(q),
        acosh(q) * sqrt(q - 1),
        elliptic_k((1 + q) / 2) * p,
        p * exp(q / p),
        exp(-1 / q**2) * p,
        tanh(q) + exp(-q),
        atan(q / sqrt(2 * E - q**2)),
        sqrt(p**2 + sin(q) ** 2),
        q / sqrt(p**2 + q**2),
        -k / Abs(q) + p**2 / 2,
        sqrt(1 + 1 / q**2),
        p * sqrt(1 + 1 / q**2) * Abs(q),
        1 / q + q * Abs(q),
        q**2 * sqrt(1 + 1 / q**2),
        V(q) + q * V(p) / p,
        atan2(q, p),
    ],
)
def test_ordinary_functions_stay_continuous(plain):
    assert continuity(plain, [q, p]).holds, continuity(plain, [q, p])


def test_where_one_side_is_not_real_it_is_said():
    f = atan(q / sqrt(2 * E - q**2))
    assert open_surfaces(f, [q], Domain())
    assert any("where it is real" in text for text in continuity(f, [q]).assumed)
    assert continuity(a * asin(q / sqrt(a)), [q, a]).assumed == ()


def test_what_is_given_may_jump_where_it_does():
    assert continuity(p + V(q / p), [q, p], given=[V(q / p)]).holds
    assert not continuity(p + V(q / p), [q, p], given=[V(q)]).holds


NOTHING = sp.tan(q) - sin(q) / sp.cos(q)


@pytest.mark.parametrize("function", [tanh, exp, atan, sp.cot, lambda u: log(2 + u)])
def test_poles_that_cancel_inside_a_function_hide_no_jump(function):
    assert continuity(p + function(1 + NOTHING), [q, p]).holds
    assert continuity(p * function(1 / q - (1 + q) / q), [q, p]).holds


@pytest.mark.parametrize("left", [sp.tan(q) - 2 * sin(q) / sp.cos(q), 1 / q - 2 * sp.cos(q) / q])
def test_poles_that_do_not_cancel_do(left):
    assert not continuity(p + tanh(1 + left), [q, p]).holds
