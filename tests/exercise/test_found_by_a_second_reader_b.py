"""Claims by which a second reader of the code had wrong verdicts, with wrong twins: forces that hold accelerations,
systems of first order, powers, parameters, starts and implicit maps."""

import time

import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim

BUDGET = 60.0
"""Seconds for a claim: that a busy machine is slow is no question here."""


def verdict_on(kind, **keys):
    return judge(Claim("a", kind, keys, budget=BUDGET))


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return verdict_on(kind, **keys).status.value
    except InvalidClaim:
        return "invalid"


ADDED_MASS = {
    "q": ["x"], "parameters": {"m": "positive", "k": "positive", "mu": "positive"},
    "L": "m*x_dot**2/2 - k*x**2/2", "Qnc": ["-mu*x_ddot"],
}  # fmt: skip


@pytest.mark.parametrize(
    ("answer", "due"),
    [
        ({"conserved": ["(m + mu)*x_dot**2/2 + k*x**2/2"]}, "holds"),
        ({"conserved": ["(m - mu)*x_dot**2/2 + k*x**2/2"]}, "fails"),
        ({"conserved": ["m*x_dot**2/2 + k*x**2/2"]}, "fails"),
        ({"not_conserved": ["m*x_dot**2/2 + k*x**2/2"]}, "holds"),
        ({"not_conserved": ["(m + mu)*x_dot**2/2 + k*x**2/2"]}, "fails"),
    ],
)
def test_what_a_body_with_added_mass_conserves(answer, due):
    assert said("conserved-or-not", **ADDED_MASS, **answer) == due


@pytest.mark.parametrize(
    ("rate", "due"),
    [
        ("-mu*x_dot*x_ddot", "holds"),
        ("mu*x_dot*x_ddot", "fails"),
        ("mu*k*x*x_dot/(m + mu)", "holds"),
        ("mu*k*x*x_dot/m", "fails"),
        ("0", "fails"),
    ],
)
def test_forces_that_hold_accelerations_have_their_power_on_the_motion(rate, due):
    assert said("dissipative", **ADDED_MASS, energy_rate=rate) == due


def test_forces_not_affine_in_the_accelerations_are_left_open():
    keys = {"q": ["x"], "L": "x_dot**2/2", "Qnc": ["-x_ddot**2"]}
    assert said("dissipative", **keys, energy_rate="-x_dot*x_ddot**2") == "holds"
    assert said("dissipative", **keys, energy_rate="-x_dot*x_ddot") == "undecided"


MAXWELL = {
    "q": ["x", "y"], "parameters": {"m": "positive", "k": "positive", "c": "positive"},
    "L": "m*x_dot**2/2 - k*(x - y)**2/2", "F": "c*y_dot**2/2",
}  # fmt: skip


@pytest.mark.parametrize(
    ("rate", "due"),
    [
        ("-c*y_dot**2", "holds"),
        ("-k*(x - y)*y_dot", "holds"),
        ("-k**2*(x - y)**2/c", "holds"),
        ("c*y_dot**2", "fails"),
        ("-k*(x + y)*y_dot", "fails"),
        ("k**2*(x - y)**2/c", "fails"),
        ("-2*k**2*(x - y)**2/c", "fails"),
    ],
)
def test_a_coordinate_without_mass_has_the_velocity_of_its_damper(rate, due):
    assert said("dissipative", **MAXWELL, energy_rate=rate) == due


PHASE_SPACE = {"q": ["x", "u"], "L": "u*x_dot - u**2/2 - x**2/2"}
VORTICES = {
    "q": ["x1", "y1", "x2", "y2"], "parameters": {"G": "positive", "K": "positive"},
    "L": "G*x1*y1_dot + K*x2*y2_dot + G*K*log((x1 - x2)**2 + (y1 - y2)**2)",
}  # fmt: skip
COUPLED = {
    "q": ["x", "y", "u", "v"],
    "L": "u*x_dot + v*y_dot - (u**2 + v**2)/2 - (x**2 + y**2)/2 - x**2*y",
}


@pytest.mark.parametrize(
    ("system", "I", "due"),
    [
        (PHASE_SPACE, "u**2 + x**2", "holds"),
        (PHASE_SPACE, "u**2 - x**2", "fails"),
        (PHASE_SPACE, "x_dot**2 + x**2", "holds"),
        (PHASE_SPACE, "x_dot**2 - x**2", "fails"),
        (PHASE_SPACE, "u*cos(t) + x*sin(t)", "holds"),
        (PHASE_SPACE, "u*cos(t) - x*sin(t)", "fails"),
        (VORTICES, "(x1 - x2)**2 + (y1 - y2)**2", "holds"),
        (VORTICES, "(x1 - x2)**2 - (y1 - y2)**2", "fails"),
        (VORTICES, "G*x1 + K*x2", "holds"),
        (VORTICES, "K*x1 + G*x2", "fails"),
        ({"q": ["x", "y"], "L": "x_dot**2/2"}, "x_dot", "holds"),
        ({"q": ["x", "y"], "L": "x_dot**2/2"}, "y_dot", "fails"),
        ({**PHASE_SPACE, "L": "u*x_dot - H(x, u)", "functions": {"H": ["x", "u"]}}, "H(x, u)", "holds"),
        ({**PHASE_SPACE, "L": "u*x_dot - H(x, u)", "functions": {"H": ["x", "u"]}}, "H(x, u)*u", "fails"),
        ({**COUPLED, "restrict": ["x", "u"]}, "v**2 + y**2", "holds"),
        ({**COUPLED, "restrict": ["x", "u"]}, "v**2 - y**2", "fails"),
        (COUPLED, "v**2 + y**2", "fails"),
    ],
)
def test_constants_where_the_equations_bind_the_velocities(system, I, due):
    assert said("constant-of-motion", **system, I=I) == due


@pytest.mark.parametrize("I", ["x_dot - u", "3", "(x_dot - u)*x + 1"])
def test_a_number_on_every_motion_is_no_constant_of_it(I):
    found = verdict_on("constant-of-motion", **PHASE_SPACE, I=I)
    assert found.fails
    assert "says nothing" in found.feedback


@pytest.mark.parametrize(
    ("power", "Q", "due"),
    [
        ("P0", "P0/x_dot", "holds"),
        ("P0", "0", "fails"),
        ("P0 - k*x_dot", "P0/x_dot - k", "holds"),
        ("P0 - k*x_dot", "-k", "fails"),
        ("P0 - k*x_dot**2", "P0/x_dot - k*x_dot", "holds"),
        ("P0 - k*x_dot**2", "-k*x_dot", "fails"),
        ("-k*x_dot", "-k", "holds"),
        ("-k*x_dot", "k", "fails"),
        ("-k*x_dot + P0*(sin(x)**2 + cos(x)**2 - 1)", "-k", "holds"),
    ],
)
def test_power_at_rest_is_part_of_the_force(power, Q, due):
    keys = {"q": ["x"], "parameters": {"P0": "positive", "k": "positive"}}
    assert said("generalized-force", **keys, power=power, Q=[Q]) == due


def test_power_at_rest_determines_no_forces_of_several_coordinates():
    keys = {"q": ["x", "y"], "parameters": {"P0": "positive"}}
    assert said("generalized-force", **keys, power="P0", Q=["0", "0"]) == "invalid"
    assert said("generalized-force", **keys, power="P0*x_dot", Q=["P0", "0"]) == "holds"
    assert said("generalized-force", **keys, power="P0*x_dot", Q=["0", "P0"]) == "fails"


PHASE = {"q": ["q"], "p": ["p"], "find": ["a"]}


@pytest.mark.parametrize(
    ("claim", "values", "assumed", "due"),
    [
        ({"of": "constant-of-motion", "H": "p**2/2 + q**2/2", "I": "a*(p**2 + q**2)"}, {}, "real", "fails"),
        ({"of": "constant-of-motion", "H": "p**2/2 + q**2/2", "I": "a*(p**2 + q**2)"}, {}, "nonzero", "holds"),
        ({"of": "constant-of-motion", "H": "p**2/2 + q**2/2", "I": "a + p**2 + q**2"}, {}, "real", "holds"),
        ({"of": "constant-of-motion", "H": "p**2/2 + q**2/2", "I": "(a - 1)*p**2 - q**2"}, {}, "real", "fails"),
        ({"of": "constant-of-motion", "H": "p**2/2", "I": "(a**2 + 1)*p"}, {}, "real", "holds"),
        ({"of": "constant-of-motion", "H": "p**2/2", "I": "(a**2 - 1)*p"}, {}, "real", "fails"),
        ({"of": "constant-of-motion", "H": "p**2/2", "I": "(a - 1)*p", "domain": ["a > 2"]}, {}, "real", "holds"),
        ({"of": "constant-of-motion", "H": "p**2/2", "I": "(a - 3)*p", "domain": ["a > 2"]}, {}, "real", "fails"),
        ({"of": "canonicity", "Q": ["a*q"], "P": ["p"], "valence": "a"}, {}, "real", "fails"),
        ({"of": "canonicity", "Q": ["a*q"], "P": ["p"], "valence": "a"}, {}, "nonzero", "holds"),
        ({"of": "canonicity", "Q": ["a*q"], "P": ["p"], "valence": "2*a"}, {}, "nonzero", "fails"),
        ({"of": "canonicity", "Q": ["a*q"], "P": ["p"], "valence": "2"}, {"a": "2"}, "real", "holds"),
        ({"of": "constant-of-motion", "H": "p**2/2", "I": "p + (a - 2)**2/(a - 2)*q"}, {"a": "2"}, "real", "fails"),
        ({"of": "constant-of-motion", "H": "p**2/2", "I": "p + (a - 2)*q"}, {"a": "2"}, "real", "holds"),
        ({"of": "constant-of-motion", "H": "p**2/2", "I": "p + (a - 2)*q"}, {"a": "3"}, "real", "fails"),
    ],
)  # fmt: skip
def test_every_value_of_a_parameter_that_is_claimed_does(claim, values, assumed, due):
    assert said("parameters", **PHASE, **claim, values=[values], parameters={"a": assumed}) == due


@pytest.mark.parametrize(("I", "exception"), [("a*p", "a = 0"), ("(a - 2)*p", "a = 2")])
def test_the_value_that_is_no_solution_is_named(I, exception):
    keys = {**PHASE, "of": "constant-of-motion", "H": "p**2/2", "parameters": {"a": "real"}}
    found = verdict_on("parameters", **keys, I=I, values=[{}])
    assert exception in found.feedback


SPRING = {"q": ["x"], "L": "x_dot**2/2 - x**2/2"}
REPELLED = {"q": ["x"], "parameters": {"x": "nonzero"}, "L": "x_dot**2/2 - 1/(2*x**2)"}


@pytest.mark.parametrize(
    ("system", "rate", "initial", "due"),
    [
        (SPRING, "sqrt(1 - x**2)", {"x": "1/2"}, "holds"),
        (SPRING, "sqrt(1 - x**2)", {"x": "1"}, "holds"),
        (SPRING, "sqrt(1 - x**2)", {"x": "2"}, "fails"),
        (SPRING, "sqrt(1 - x**2)", {"x": "2", "x_dot": "I*sqrt(3)"}, "fails"),
        (SPRING, "sqrt(1 - x**2)", {"x": "3/5", "x_dot": "4/5"}, "holds"),
        (SPRING, "sqrt(1 - x**2)", {"x": "3/5", "x_dot": "-4/5"}, "fails"),
        (REPELLED, "sqrt(1 - 1/x**2)", {"x": "2"}, "holds"),
        (REPELLED, "sqrt(1 - 1/x**2)", {"x": "1/2"}, "fails"),
        ({"q": ["x"], "equations": ["x*x_ddot + x_dot**2 = 0"]}, "1/x", {"x": "2"}, "holds"),
        ({"q": ["x"], "equations": ["x*x_ddot + x_dot**2 = 0"]}, "1/x", {"x": "0"}, "fails"),
    ],
)
def test_motions_start_with_real_velocities(system, rate, initial, due):
    assert said("solution", **system, rates={"x": rate}, initial=initial) == due


@pytest.mark.parametrize(("start", "due"), [("a", "holds"), ("1 + a", "fails"), ("1/(1 + a)", "holds")])
def test_starts_in_letters_are_real_for_some_values(start, due):
    keys = {**SPRING, "parameters": {"a": "positive"}, "rates": {"x": "sqrt(1 - x**2)"}}
    assert said("solution", **keys, initial={"x": start}) == due


IMPLICIT = {
    "q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"],
    "parameters": {"h": "positive", "g": "positive"}, "box": {"h": [0, 0.1]},
}  # fmt: skip
MEAN = "Q - q - h*(P + p)/2"


@pytest.mark.parametrize(
    ("equations", "due"),
    [
        ([MEAN, "P**2/2 + g*Q = p**2/2 + g*q"], "holds"),
        ([MEAN, "P**2/2 + 2*g*Q = p**2/2 + 2*g*q + h*p**2"], "fails"),
        (["Q - q - h*P", "P**2/2 + g*Q = p**2/2 + g*q"], "fails"),
        ([MEAN, "P**2 + g**2*Q**2 = p**2 + g**2*q**2"], "holds"),
        ([MEAN, "P**2 + g**2*Q**2 = p**2 + q**2"], "fails"),
        (["Q**3 = q**3", "P*Q**2 = p*q**2"], "holds"),
        (["Q**3 = q**3", "P*Q**2 = 2*p*q**2"], "fails"),
        (["Q**3 = 8*q**3", "2*P*Q**2 = 4*p*q**2"], "holds"),
        (["Q**3 = 8*q**3", "P*Q**2 = 4*p*q**2"], "fails"),
        (["Q = q", "(P - p - h*q)*(P + 2*p) = 0"], "holds"),
        (["Q = q", "(P - p - h*p)*(P - p + 1) = 0"], "fails"),
    ],
)
def test_of_several_solutions_the_map_near_the_identity_is_meant(equations, due):
    assert said("canonicity", **IMPLICIT, implicit=equations) == due


def test_solutions_that_are_not_real_are_told_on_a_busy_machine_too(monkeypatch):
    """Where a second of work takes six on the clock."""
    clock, start = time.monotonic, time.monotonic()
    monkeypatch.setattr(time, "monotonic", lambda: start + 6.0 * (clock() - start))
    assert said("canonicity", **IMPLICIT, implicit=["Q**3 = 8*q**3", "2*P*Q**2 = 4*p*q**2"]) == "holds"


@pytest.mark.parametrize(
    ("equations", "due"),
    [
        ([MEAN, "P**2/2 + g*Q = p**2/2 + g*q"], "undecided"),
        (["(Q + q)*(Q + 2*q) = 0", "P = -p"], "undecided"),
        (["(Q + q)*(Q - q + 1) = 0", "P*Q = p*q"], "undecided"),
        (["(Q + 3*q)*(Q + 2*q) = 0", "P = -p"], "fails"),
        (["Q**2 = 4*q**2", "P*Q = p*q"], "holds"),
    ],
)
def test_where_no_solution_is_seen_to_be_near_the_identity_all_of_them_count(equations, due):
    without = {key: value for key, value in IMPLICIT.items() if key != "box"}
    assert said("canonicity", **without, implicit=equations) == due
