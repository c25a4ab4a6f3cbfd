"""Claims in elliptic functions: exact motions of the pendulum and of Duffing, frequencies, actions; wrong twins."""

import pytest

from canon.exercise.claim_verdict import examine
from canon.exercise.sheet.sheet import Claim

PENDULUM = {
    "q": ["theta"], "L": "theta_dot**2/2 + w**2*cos(theta)", "parameters": {"w": "positive", "k": "positive"},
    "domain": ["k < 1"],
}  # fmt: skip
BY_HAMILTON = {
    "q": ["q"], "p": ["p"], "H": "p**2/2 - w**2*cos(q)", "parameters": {"w": "positive", "k": "positive"},
    "domain": ["k < 1"],
}  # fmt: skip
DUFFING = {
    "q": ["x"], "L": "x_dot**2/2 - x**2/2 - b*x**4/4", "parameters": {"A": "positive", "b": "positive"},
}  # fmt: skip
SWINGING = {
    "q": ["q"], "p": ["p"], "H": "p**2/2 - w**2*cos(q)", "parameters": {"E": "real", "w": "positive"},
    "domain": ["p**2/2 - w**2*cos(q) < w**2"],
}  # fmt: skip
TURNING = {**SWINGING, "domain": ["p**2/2 - w**2*cos(q) > w**2", "p > 0"]}
M = "((1 + E/w**2)/2)"
FROM_REST = {"initial": {"theta": "2*asin(k)", "theta_dot": "0"}}


def told(kind, keys, answer):
    return examine(Claim("a", kind, {**keys, **answer})).verdict


@pytest.mark.parametrize(
    ("keys", "right", "wrong"),
    [
        (PENDULUM, {"theta": "2*asin(k*jacobi_sn(w*t, k**2))"}, {"theta": "2*asin(k*jacobi_sn(w*t, k))"}),
        pytest.param(
            PENDULUM,
            {"theta": "2*jacobi_am(w*t/k, k**2)"},
            {"theta": "2*jacobi_am(w*t, k**2)"},
            marks=pytest.mark.slow,
        ),
        pytest.param(
            BY_HAMILTON,
            {"q": "2*asin(k*jacobi_sn(w*t, k**2))", "p": "2*k*w*jacobi_cn(w*t, k**2)"},
            {"q": "2*asin(k*jacobi_sn(w*t, k**2))", "p": "2*k*w*jacobi_dn(w*t, k**2)"},
            marks=pytest.mark.slow,
        ),
        pytest.param(
            {**PENDULUM, **FROM_REST},
            {"theta": "2*asin(k*jacobi_sn(w*t + elliptic_k(k**2), k**2))"},
            {"theta": "2*asin(k*jacobi_sn(w*t - elliptic_k(k**2), k**2))"},
            marks=pytest.mark.slow,
        ),
        pytest.param(
            DUFFING,
            {"x": "A*jacobi_cn(sqrt(1 + b*A**2)*t, b*A**2/(2*(1 + b*A**2)))"},
            {"x": "A*jacobi_cn(sqrt(1 + b*A**2)*t, b*A**2/(1 + b*A**2))"},
            marks=pytest.mark.slow,
        ),
    ],
)
def test_exact_motions(keys, right, wrong):
    assert told("solution", keys, {"solution": right}).holds
    assert told("solution", keys, {"solution": wrong}).fails


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "keys", "right", "wrong"),
    [
        (
            "frequency",
            SWINGING,
            {"omega": [f"pi*w/(2*elliptic_k({M}))"]},
            {"omega": [f"pi*w/elliptic_k({M})"]},
        ),
        (
            "frequency",
            TURNING,
            {"omega": [f"pi*w*sqrt({M})/elliptic_k(1/{M})"]},
            {"omega": [f"pi*w*sqrt({M})/(2*elliptic_k(1/{M}))"]},
        ),
        (
            "action-angle",
            SWINGING,
            {"J": [f"8*w/pi*(elliptic_e({M}) - (1 - {M})*elliptic_k({M}))"]},
            {"J": [f"8*w/pi*(elliptic_e({M}) - {M}*elliptic_k({M}))"]},
        ),
        (
            "action-angle",
            TURNING,
            {"J": [f"4*w*sqrt({M})/pi*elliptic_e(1/{M})"]},
            {"J": [f"4*w*sqrt({M})/pi*elliptic_k(1/{M})"]},
        ),
    ],
)
def test_frequencies_and_actions_of_the_pendulum(kind, keys, right, wrong):
    assert told(kind, keys, right).holds
    assert told(kind, keys, wrong).fails
