"""The three answers, on claims of every family and their wrong twins."""

import pytest
import sympy as sp
from sympy import Abs, Derivative, Function, I, Rational, cos, cosh, exp, log, sin, sinh, sqrt, tan, tanh

from canon.proof import Domain, equal, vanishes
from canon.proof.domain.verdict import Status

x, y = sp.symbols("x y", real=True)
a, b, g, l, t = sp.symbols("a b g l t", positive=True)
V = Function("V")

TRUE = [
    sin(x) ** 2 + cos(x) ** 2 - 1,
    sin(x) - 2 * sin(x / 2) * cos(x / 2),
    tan(x + y) - (tan(x) + tan(y)) / (1 - tan(x) * tan(y)),
    exp(x + y) - exp(x) * exp(y),
    cosh(x) ** 2 - sinh(x) ** 2 - 1,
    1 / cosh(sqrt(g / l) * t) ** 2 + tanh(sqrt(g / l) * t) ** 2 - 1,
    log(a * b) - log(a) - log(b),
    exp(I * x) - cos(x) - I * sin(x),
    sqrt(x**2 + 2 * x * y + y**2) - Abs(x + y),
    x * x**a - x ** (a + 1),
    (x**2 - 1) / (x - 1) - x - 1,
    Derivative(V(x), x) * sin(y) ** 2 + Derivative(V(x), x) * cos(y) ** 2 - Derivative(V(x), x),
]


@pytest.mark.parametrize("identity", TRUE, ids=str)
def test_identity_holds_and_its_twins_fail(identity):
    assert vanishes(identity).status is Status.HOLDS
    assert vanishes(identity + Rational(1, 10**20)).status is Status.FAILS
    assert vanishes(identity + x / 10**6).status is Status.FAILS


@pytest.mark.parametrize(
    "claim",
    [
        sqrt(x * y) - sqrt(x) * sqrt(y),
        sqrt(10**10 + 1) + sqrt(10**10 - 1) - 2 * 10**5,
        sp.sign(x) ** 2 - 1,
        V(x) - V(y),
        sp.acot(x) + sp.atan(x) - sp.pi / 2,
    ],
    ids=str,
)
def test_wrong_claims_fail_with_a_point(claim):
    verdict = vanishes(claim)
    assert verdict.status is Status.FAILS
    assert verdict.counterexample is not None


def test_conditions_give_signs():
    m = sp.Symbol("m", real=True)
    claim = sqrt((1 - m) ** 2) - (1 - m)
    assert vanishes(claim, Domain(conditions=(m < 1,))).holds
    assert vanishes(claim).fails


def test_matrices_entry_by_entry():
    turn = sp.Matrix([[cos(x), -sin(x)], [sin(x), cos(x)]])
    assert equal(turn * turn.T, sp.eye(2)).holds
    assert equal(turn * turn, sp.eye(2)).fails
    with pytest.raises(ValueError, match="shapes"):
        equal(turn, sp.eye(3))


def test_a_sum_of_squares_is_found_whichever_symbol_completes_the_square() -> None:
    """The squares of x and z have factors that may be zero; that of y has 1."""
    z = sp.Symbol("z", real=True)
    one_more = sp.expand((y + z * x) ** 2 + 1)
    assert equal(Abs(x) * Abs(one_more), Abs(x) * one_more).holds
    assert equal(Abs(x) * Abs(one_more - 2), Abs(x) * (one_more - 2)).fails


def test_a_derivative_that_is_not_carried_out_is_one_number_at_each_place() -> None:
    slope = Derivative(Abs(V(x)), x)
    assert equal(slope * sin(y) ** 2, slope - slope * cos(y) ** 2).holds
    assert equal(slope * sin(y) ** 2, slope + slope * cos(y) ** 2).fails
