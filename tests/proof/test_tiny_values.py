"""Differences below what any ball of their terms resolves are refuted in another form of theirs, and zero is not."""

import time

import pytest
from sympy import Abs, Eq, Piecewise, cos, exp, log, sin, sqrt, symbols

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim
from canon.proof import Domain, equal, vanishes
from canon.proof.refute.tiny_values import other_forms

x, y = symbols("x y", real=True)
a, b = symbols("a b", positive=True)
TINY = (
    -2 * x * y * exp(-2000 - x**2),
    (x + y) * exp(-3000) / (1 + x**2),
    x * (1 + exp(-4000)) - x,
    (x + exp(-5000)) ** 2 - x**2 - exp(-10000),
    sqrt(a**2 + exp(-5000)) - a,
    sqrt(a**2 + b**2 + exp(-9000)) - sqrt(a**2 + b**2),
    exp(-7000 + x) * cos(y) + sin(x) ** 2 + cos(x) ** 2 - 1,
    a - sqrt(a**2 - exp(-6000)),
)
ZERO = (
    x * exp(-2000 - x**2) - x * exp(-1000 - x**2) * exp(-1000),
    (x + exp(-5000)) ** 2 - x**2 - exp(-10000) - 2 * x * exp(-5000),
    sqrt(a**2 + 2 * a * exp(-5000) + exp(-10000)) - a - exp(-5000),
    exp(-4000) * (sin(x) ** 2 + cos(x) ** 2 - 1),
)


@pytest.mark.parametrize("f", TINY, ids=str)
def test_a_tiny_difference_is_seen(f):
    verdict = vanishes(f)
    assert verdict.fails
    assert verdict.counterexample is not None
    assert "e-" in verdict.counterexample.left
    assert not equal(f + x, x).holds


@pytest.mark.parametrize("f", ZERO, ids=str)
def test_zero_beside_tiny_numbers_is_zero_or_open(f):
    assert not vanishes(f).fails


@pytest.mark.parametrize(
    "f", [x * Abs(x) - x**2, Piecewise((exp(-8000) * x, x > 0), (0, True)), log(x**2) - 2 * log(x)]
)
def test_pieces_and_branches_are_judged_on_their_own_side(f):
    assert vanishes(f, Domain((x <= 0,) if f.has(Piecewise) else (x > 0,))).holds
    assert not vanishes(f).holds


@pytest.mark.parametrize(
    ("I", "status"),
    [
        ("p**2 + q**2 + exp(-2000 - q**2)", "fails"),
        ("p**2 + q**2 + exp(-900 - p**2 - q**2)", "holds"),
        ("(p**2 + q**2)*(1 + exp(-3000)*q)", "fails"),
        ("(p**2 + q**2)*(1 + exp(-3000))", "holds"),
    ],
)
def test_a_tiny_term_beside_the_energy(I, status):
    keys = {"I": I, "q": ["q"], "p": ["p"], "H": "(p**2 + q**2)/2"}
    assert judge(Claim("a", "constant-of-motion", keys)).status.value == status


@pytest.mark.parametrize("f", [x**2 + x, x**2 + x * sin(a), x**3 + x * sqrt(a), sqrt(x**2 + a) + x], ids=str)
def test_each_other_form_has_the_value_of_the_expression_on_the_domain(f):
    """An equality makes x a root of 2y; x² and x, put together before that was known, were taken apart wrongly."""
    domain = Domain((y > 0, Eq(x**2, 2 * y)))
    forms = list(other_forms(f, domain, time.monotonic() + 10))
    for form in forms:
        for place in ({x: 2, y: 2, a: 3}, {x: -4, y: 8, a: 1}):
            assert abs((form - f).subs(place).evalf(30)) < 1e-25
    assert len(forms) > 1
