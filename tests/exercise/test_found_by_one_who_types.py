"""Answers as one typed them who had never seen canon, right and wrong: what was misread, passed or told badly."""

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import Claim

PLANET = {
    "q": ["r", "phi"], "parameters": {"m": "positive", "k": "positive", "r": "positive"},
    "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 + k/r",
}  # fmt: skip
SPRING = {"q": ["x"], "parameters": {"m": "positive", "k": "positive", "c": "positive"},
          "L": "m*x_dot**2/2 - k*x**2/2"}  # fmt: skip
DAMPED = {**SPRING, "F": "c*x_dot**2/2"}
ROOT = {"exact": ["sqrt(1+eps)"], "small": ["eps"], "parameters": {"eps": "real"}}
ANGLE = {"q": ["theta"], "parameters": {"l": "positive", "g": "positive"},
         "L": "l**2*theta_dot**2/2 + g*l*cos(theta)"}  # fmt: skip


def judged(kind, **keys):
    *_, (judgement, _) = judgements(Claim("a", kind, keys, budget=60.0))
    return judgement


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        (r"\frac{d}{dt}(mr^2\dot\phi)=0", r"\frac{d}{dt}(mr\dot\phi)=0"),
        ("d/dt (r² φ') = 0", "d/dt (r² + φ') = 0"),
        (
            r"$\frac{\mathrm{d}}{\mathrm{d}t}\left[ r^2\dot\phi\right] = 0.$",
            r"\frac{d}{dt}\left[r\dot r\right] = 0",
        ),
        (r"\frac{d(mr^2\dot\phi)}{dt}=0", r"\frac{d(mr^2)}{dt}=0"),
        ("d(m r² φ')/(dt) = 0", "d(m r φ')/(dt) = 0"),
        ("0 = d/dt[(m r²)(φ')]", "0 = d/dt[(m r²)(r')]"),
        ("d/dt(½m(r'² + r²φ'²) - k/r) = 0", "d/dt(½m(r'² + r²φ'²) + k/r) = 0"),
    ],
)
def test_a_constant_may_be_told_by_its_rate(right, wrong):
    assert judged("constant-of-motion", **PLANET, I=right).status == "holds"
    assert judged("conserved-or-not", **PLANET, conserved=[right]).status == "holds"
    assert judged("constant-of-motion", **PLANET, I=wrong).status == "fails"


@pytest.mark.parametrize(
    "other", ["d/dt (m r²) φ' = 0", "d/dt (m r² φ') (r) = 0", "d/dt (m r² φ') = 1", "d/dt(5) = 0"]
)
def test_what_only_looks_like_the_rate_of_a_constant_is_none(other):
    assert judged("constant-of-motion", **PLANET, I=other).status == "fails"


def test_with_a_parameter_called_d_a_quotient_by_dt_is_no_rate():
    named = {**PLANET, "parameters": {**PLANET["parameters"], "d": "positive"}}
    assert judged("constant-of-motion", **named, I="d/dt (r² φ') = 0").status != "holds"
    assert judged("constant-of-motion", **named, I="d r² φ'").status == "holds"


@pytest.mark.parametrize(
    ("answer", "due"),
    [
        ("√(1+ε)", "fails"),
        ("1 + ε/2", "holds"),
        ("1 + ε", "fails"),
    ],
)
def test_what_is_given_is_no_expansion_of_itself(answer, due):
    found = judged("first-order", **ROOT, claim=answer)
    assert found.status == due
    assert ("it is what is given" in found.feedback) == (answer == "√(1+ε)")
    assert judged("first-order", **{**ROOT, "exact": ["1 + eps/2"]}, claim="1 + eps/2").status == "holds"


@pytest.mark.parametrize("rate", ["d/dt(m x'^2/2 + k x^2/2)", "m x' x'' + k x x'", "x' (m x'' + k x)"])
def test_an_energy_rate_with_accelerations_is_told_to_be_open(rate):
    """It is true, and of any motion: where a complete answer is wanted it fails."""
    found = judged("dissipative", **DAMPED, energy_rate=rate)
    assert (found.status, found.warnings) == ("holds", ("dE/dt stays open: it is written with x_ddot",))
    assert judged("dissipative", **DAMPED, energy_rate=rate, complete=True).status == "fails"
    assert judged("dissipative", **DAMPED, energy_rate="-c x'^2", complete=True).status == "holds"
    assert judged("dissipative", **DAMPED, energy_rate="-2 c x'^2").status == "fails"


def test_a_capital_e_is_taken_for_an_energy_by_who_tells_of_it():
    found = judged("euler-lagrange", **ANGLE, claim="½θ̇² - (g/l) cosθ = E")
    assert found.status == "invalid"
    assert "E is not declared; if an energy is meant, write what it is equal to" in found.known


def test_the_rate_of_a_momentum_restates_what_is_asked():
    keys = {
        "q": ["x"],
        "p": ["p"],
        "parameters": {"m": "positive", "k": "positive"},
        "H": "p**2/(2*m)+k*x**2/2",
    }
    found = judged("hamilton-equations", **keys, q_dot="p/m", p_dot="p'")
    assert (
        "p' is the rate of a momentum, for which there is no symbol; write what it is equal to" in found.known
    )
    assert judged("hamilton-equations", **keys, q_dot="p/m", p_dot="-k x").status == "holds"


def test_both_readings_of_a_slash_before_a_bracket_are_shown_whole():
    found = judged("equality-only", lhs="2*tan(x)", rhs="2 tan x/(1+0)", parameters={"x": "real"})
    assert "tan(x)/(…) or tan(x/(…))" in found.known
