"""Kinetic energies and generalized forces: bodies, constraints that leave something open, accelerations passed over."""

import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return judge(Claim("a", kind, keys)).status.value
    except InvalidClaim:
        return "invalid"


TWO = {"q": ["x", "y"], "parameters": {"m": "positive"}, "bodies": [{"m": "m", "r": ["x"]}]}


@pytest.mark.parametrize(
    ("constraint", "expected"),
    [
        ("y*(x_dot - y_dot)", "undecided"),
        ("(1 + y**2)*(x_dot - y_dot)", "holds"),
        ("x_dot + y_dot - 1", "fails"),
    ],
)
def test_a_constraint_that_holds_for_all_velocities_somewhere(constraint, expected):
    assert said("kinetic-energy", **TWO, T="m*y_dot**2/2", constraints=[constraint]) == expected
    multiplier = {"L": "(x_dot**2 + y_dot**2)/2 - x", "multipliers": ["u"], "constraints": [constraint]}
    if expected == "undecided":
        assert said("reaction", q=["x", "y"], **multiplier, values={"u": "1/(2*y)"}) == "undecided"
        assert (
            said("reaction", q=["x", "y"], **multiplier, values={"u": "1/(2*y)"}, domain=["y != 0"])
            == "holds"
        )


@pytest.mark.parametrize(
    ("k", "expected"), [("real", "undecided"), ("nonzero", "holds"), ("positive", "holds")]
)
def test_a_factor_that_may_be_zero(k, expected):
    keys = {**TWO, "parameters": {"m": "positive", "k": k}}
    assert said("kinetic-energy", **keys, T="m*y_dot**2/2", constraints=["k*(x_dot - y_dot)"]) == expected


@pytest.mark.parametrize(("constraint", "expected"), [
    ("x**2*z = y**2", "undecided"),  # at x = y = 0 every z is allowed
    ("(1 + x**2)*z = y**2 + 1", "holds"),
    ("(1 + x**2)*z = -y**2 - 1", "fails"),
])  # fmt: skip
def test_points_that_a_graph_misses(constraint, expected):
    keys = {"q": ["x", "y", "z", "u"], "bodies": [{"m": "1", "r": ["u"]}]}
    assert said("kinetic-energy", **keys, T="u_dot**2*Abs(z)/z/2", constraints=[constraint]) == expected


@pytest.mark.parametrize(
    "body",
    [
        {"I": "1", "angle": "x", "r": ["x"]},  # r without m
        {"I": "1", "angle": "x", "m": "3"},  # m without r
        {"I": "1", "angle": "x", "omega": ["2*x_dot"]},
        {"m": "1", "r": ["exp(I*x)"]},
        {"m": "1", "r": ["x_dot"]},
        {"I": "1", "omega": ["x_ddot"]},
        {"m": "1", "r": ["x"], "angle": "x"},
    ],
)
def test_bodies_that_say_too_little_or_too_much_are_invalid(body):
    assert said("kinetic-energy", q=["x"], bodies=[body], T="x_dot**2/2") == "invalid"


def test_a_body_with_all_it_needs():
    body = {"m": "2", "r": ["x"], "I": "3", "angle": "x"}
    assert said("kinetic-energy", q=["x"], bodies=[body], T="5*x_dot**2/2") == "holds"
    assert said("kinetic-energy", q=["x"], bodies=[body], T="3*x_dot**2/2") == "fails"


def test_accelerations_are_not_passed_over():
    assert said("generalized-force", q=["x"], V="x_ddot**2", Q=["0"]) == "invalid"
    assert said("generalized-force", q=["x"], V="x_dot*t", Q=["1"]) == "holds"
    assert said("variation", q=["x"], L="x_ddot**2/2", boundary="0", integrand="0") == "invalid"
    assert said("variation", q=["x"], L="x_dot*x", boundary="x*delta_x", integrand="0") == "holds"
    assert said("invariance", of="lagrange-equations", q=["q"], Q=["q + q_ddot"]) == "fails"
    assert said("invariance", of="lagrange-equations", q=["q"], Q=["q + q**3"]) == "holds"
    keys = {"of": "poisson-brackets", "q": ["q"], "p": ["p"], "P": ["p"]}
    assert said("invariance", **keys, Q=["q + q_dot"]) == "invalid"
    assert said("invariance", **keys, Q=["q + p"]) == "holds"
