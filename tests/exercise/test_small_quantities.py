"""Expansions and linearisations: against SymPy's series, at places that are not there, and what must stay undecided."""

from itertools import pairwise

import mpmath as mp
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim


def verdict(kind, **keys):
    return judge(Claim("a", kind, keys))


ATOMS = (
    "sin(e)",
    "cos(2*e)",
    "exp(-e)",
    "1/(1 + a*e)",
    "sqrt(1 + e)",
    "log(1 + e)",
    "e**2",
    "a*e",
    "b",
    "tan(e)",
)


@settings(max_examples=50, deadline=None)
@given(st.lists(st.sampled_from(ATOMS), min_size=2, max_size=4), st.integers(1, 3), st.integers(1, 4))
def test_expansions_against_series(atoms, order, slip):
    text = " + ".join(f"({x})*({y})" for x, y in pairwise(atoms))
    e, a, b = sp.symbols("e a b")
    right = sp.series(sp.sympify(text, locals={"e": e, "a": a, "b": b}), e, 0, order + 1).removeO()
    keys = {"exact": [text], "small": ["e"], "order": order, "parameters": dict.fromkeys("eab", "real")}
    assert verdict("first-order", **keys, claim=[str(sp.expand(right))]).holds
    wrong = verdict("first-order", **keys, claim=[f"{sp.expand(right)} + a*e**{slip}"])
    assert wrong.fails if slip <= order else wrong.holds
    if wrong.fails:
        ordinal = ("zeroth", "first", "second")[slip - 1]
        assert wrong.feedback.startswith(f"right to {ordinal} order in e only")


@pytest.mark.parametrize(
    "exact", ["Abs(e)", "sqrt(e)", "sqrt(e**2 + e**4)", "exp(-1/e**2)", "log(e)", "Max(e, 0)"]
)
def test_what_has_no_expansion_is_undecided(exact):
    keys = {"small": ["e"], "claim": ["0"], "parameters": {"e": "real"}}
    assert verdict("first-order", exact=[exact], **keys).undecided


def test_a_verdict_to_first_order_says_so():
    said = verdict("first-order", exact=["sin(x)"], claim=["x"], small=["x"], parameters={"x": "real"})
    assert said.question == "right to first order in x"
    assert said.certificate == "exact to first order in x"


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return judge(Claim("a", kind, keys)).status.value
    except InvalidClaim:
        return "invalid"


def declared(text):
    return dict(pair.split(":") for pair in text.split())


HOOP = {
    "q": ["theta"],
    "parameters": {"a": "positive", "w": "positive", "g": "positive"},
    "L": "a**2*(theta_dot**2 + w**2*sin(theta)**2)/2 + g*a*cos(theta)",
    "equilibrium": {"theta": "acos(g/(a*w**2))"},
    "claim": ["theta'' + (w**2 - g**2/(a**2*w**2))*theta = 0"],
}


@pytest.mark.parametrize(("domain", "expected"), [
    (["g > a*w**2"], "undecided"),  # arccos of more than 1
    (["g < a*w**2"], "holds"),
])  # fmt: skip
def test_places_that_are_not_real_are_no_equilibria(domain, expected):
    assert said("linearisation", **HOOP, domain=domain) == expected


@pytest.mark.parametrize(("keys", "expected"), [
    ({"domain": ["x > 1"]}, "invalid"),  # the place is not there
    ({"domain": ["x > -1"]}, "holds"),
    ({"parameters": {"x": "positive"}}, "invalid"),
    ({"claim": ["x*(x'' + x) = 0"]}, "fails"),  # not linear
    ({"claim": ["2*(x'' + x) = 0"]}, "holds"),
])  # fmt: skip
def test_where_an_oscillator_rests(keys, expected):
    whole = {
        "q": ["x"],
        "L": "x_dot**2/2 - x**2/2",
        "equilibrium": {"x": "0"},
        "claim": ["x'' + x = 0"],
        **keys,
    }
    assert said("linearisation", **whole) == expected


@pytest.mark.parametrize(("exact", "claim", "expected"), [
    ("e*tan(asin(3/5) + acos(3/5) + e)", "0", "undecided"),  # a pole that is hidden: the limit is −1
    ("e*tan(asin(3/5) + acos(4/5) + e)", "0", "holds"),
    ("e*tan(asin(3/5) + acos(4/5) + e)", "1", "fails"),
    ("e/cos(asin(3/5) + acos(3/5) + e)", "0", "undecided"),
])  # fmt: skip
def test_hidden_poles(exact, claim, expected):
    keys = {"exact": [exact], "claim": [claim], "small": ["e"], "order": 0, "parameters": {"e": "real"}}
    assert said("first-order", **keys) == expected
    with mp.workdps(30):
        near = sp.lambdify(sp.Symbol("e"), sp.sympify(exact), "mpmath")(mp.mpf("1e-9"))
    if expected != "undecided":
        assert (abs(near - mp.mpf(claim)) < mp.mpf("1e-8")) == (expected == "holds")
    else:
        assert abs(abs(near) - 1) < mp.mpf("1e-8")


@pytest.mark.parametrize(("exact", "claim", "domain", "expected"), [
    ("Abs(a)*e", "a*e", ["a > e"], "holds"),  # a > e > 0 for every e leaves a ≥ 0
    ("Abs(a)*e", "-a*e", ["a > e"], "fails"),
    ("Abs(a)*e", "a*e", ["a < 1"], "fails"),
    ("sin(e)", "e", ["e > 1"], "undecided"),  # not small
    ("sin(e)", "e", ["e < 1"], "holds"),
])  # fmt: skip
def test_conditions_on_what_is_small(exact, claim, domain, expected):
    keys = {"exact": [exact], "claim": [claim], "small": ["e"], "parameters": declared("e:positive a:real")}
    assert said("first-order", **keys, domain=domain) == expected


def test_a_derivative_at_a_place_is_told_as_one_of_the_function():
    """Runge's method with h in place of h/2: f′(y) of both sides is one thing, SymPy's Subs is not shown."""
    exact = ["y + h*f(y) + h**2/2*Derivative(f(y), y)*f(y)"]
    keys = {"parameters": {"y": "real", "h": "real"}, "functions": {"f": ["y"]}, "small": ["h"], "order": 2}
    verdict = judge(Claim("a", "first-order", {**keys, "exact": exact, "claim": ["y + h*f(y + h*f(y))"]}))
    assert verdict.fails
    assert "exact less claimed is -h**2*f(y)*Derivative(f(y), y)/2 there" in verdict.feedback
    assert judge(
        Claim("a", "first-order", {**keys, "exact": exact, "claim": ["y + h*f(y + h/2*f(y))"]})
    ).holds
