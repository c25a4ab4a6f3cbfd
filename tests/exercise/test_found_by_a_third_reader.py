"""Claims by which a third reader of the code had wrong verdicts, with wrong twins: staircases of turns, gauge terms by
angles, and parameters that are called as canon calls its own symbols."""

import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import Claim, claim_from

BUDGET = 60.0
"""Seconds for a claim: that a busy machine is slow is no question here."""

STAIRS = "atan2(2*sin(t), cos(t)) - t - atan(sin(t)*cos(t)/(cos(t)**2 + 2*sin(t)**2))"
"""0, −2π, −4π, …"""


def said(kind, **keys):
    """Return the verdict on a claim as a word."""
    return judge(Claim("a", kind, keys, budget=BUDGET)).status.value


@pytest.mark.parametrize(
    ("H", "place", "momentum", "due"),
    [
        ("p**2/(2*m)", "v*t", "m*v", "holds"),
        ("p**2/(2*m)", f"v*t + {STAIRS}", "m*v", "fails"),
        ("p**2/(2*m)", f"v*t + 5*({STAIRS})", "m*v", "fails"),
        ("p**2/2 - cos(x)", "pi", "0", "holds"),
        ("p**2/2 - cos(x)", f"pi + {STAIRS}", "0", "fails"),
        ("p**2/(2*cosh(tan(t))*cos(t)**2)", "2*atan(exp(tan(t)))", "1", "undecided"),
    ],
)
def test_a_particle_does_not_leap_by_whole_turns(H, place, momentum, due):
    keys = {"q": ["x"], "p": ["p"], "parameters": {"m": "positive", "v": "positive"}, "H": H}
    assert said("hamilton-equations", **keys, solution={"x": place, "p": momentum}) == due


@pytest.mark.parametrize(("name", "due"), [("phi", "holds"), ("x", "undecided")])
def test_only_an_angle_may_be_given_up_to_whole_turns(name, due):
    H = "p**2/(2*(4*sin(t)**2 + cos(t)**2))"
    solution = {name: "atan2(2*sin(t), cos(t))", "p": "2"}
    assert said("hamilton-equations", q=[name], p=["p"], H=H, solution=solution) == due


@pytest.mark.parametrize(("place", "due"), [("v*t", "holds"), (f"v*t + {STAIRS}", "fails")])
def test_a_solution_does_not_leap_by_whole_turns(place, due):
    keys = {"q": ["x"], "L": "m*x_dot**2/2", "parameters": {"m": "positive", "v": "positive"}}
    assert said("solution", **keys, solution={"x": place}, initial={"x": "0", "x_dot": "v"}) == due


FREE = "(x_dot**2 + y_dot**2)/2"
RATE = "(x*y_dot - y*x_dot)/(x**2 + y**2)"


@pytest.mark.parametrize(
    ("more", "F", "due"),
    [
        (RATE, "atan2(y, x)", "holds"),
        (f"2*{RATE}", "atan2(y, x)", "fails"),
        (f"atan2(y, x) + t*{RATE}", "t*atan2(y, x)", "fails"),
        (f"x_dot*atan2(y, x) + x*{RATE}", "x*atan2(y, x)", "fails"),
    ],
)
def test_a_gauge_term_steps_by_a_number_at_most(more, F, due):
    keys = {"q": ["x", "y"], "L1": FREE, "L2": f"{FREE} + {more}", "relation": "gauge", "F": F}
    assert said("lagrangian-equivalence", **keys) == due


@pytest.mark.parametrize("name", ["I1", "c"])
@pytest.mark.parametrize(("K", "due"), [("J + 3*{}*J**2/2", "holds"), ("J", "fails")])
def test_a_moment_of_inertia_is_no_action_of_a_normal_form(name, K, due):
    keys = {"q": ["q"], "p": ["p"], "parameters": {name: "real"}, "actions": ["J"], "degree": 4}
    H = f"(p**2 + q**2)/2 + {name}*q**4"
    assert said("normal-form", **keys, H=H, K=K.format(name)) == due


@pytest.mark.parametrize(
    ("J", "due"),
    [
        ("(p**2 + (w_0**2 + w(tau)**2)*q**2)/(2*sqrt(w_0**2 + w(tau)**2))", "holds"),
        ("(p**2 + 2*w(tau)**2*q**2)/(2*sqrt(2)*w(tau))", "fails"),
    ],
)
def test_a_parameter_is_no_function_of_the_slow_time(J, due):
    keys = {
        "q": ["q"], "p": ["p"], "parameters": {"w": "positive", "w_0": "positive", "tau": "real"},
        "functions": {"w": ["tau"]}, "H": "p**2/2 + (w_0**2 + w(tau)**2)*q**2/2",
    }  # fmt: skip
    assert said("action-angle", **keys, J=[J]) == due


@pytest.mark.parametrize(("J", "due"), [("(p**2 + q**2)/2", "holds"), ("p**2 + q**2", "fails")])
def test_a_field_may_be_called_as_the_energy_is(J, due):
    keys = {"q": ["q"], "p": ["p"], "parameters": {"E_0": "positive"}}
    assert said("action-angle", **keys, H="E_0*(p**2 + q**2)/2", J=[J]) == due


@pytest.mark.parametrize(("place", "due"), [("x", "holds"), ("2*x", "fails"), ("x + x_dot", "invalid")])
def test_a_position_in_the_energy_of_accelerations_holds_no_velocity(place, due):
    keys = {"q": ["x"], "parameters": {"m": "positive"}, "bodies": [{"m": "m", "r": [place]}]}
    if due == "invalid":
        with pytest.raises(InvalidClaim, match="position depends on coordinates and time only"):
            said("gibbs-appell", **keys, S="m*x_ddot**2/2")
        return
    assert said("gibbs-appell", **keys, S="m*x_ddot**2/2") == due


def test_the_multipliers_of_constraints_on_velocities_are_told_by_their_own_convention():
    keys = {"q": ["x", "y"], "L": "(x_dot**2 + y_dot**2)/2", "constraints": ["y_dot - t*x_dot"]}
    answer = {"multipliers": ["lam"], "claim": ["x_ddot - t*lam", "y_ddot + lam"]}
    claim = claim_from({"id": "a", "kind": "nonholonomic", "budget": 20, **keys, **answer})
    *_, (judgement, _) = judgements(claim)
    assert judgement.feedback.endswith("Σ λ ∂g/∂q̇")


def test_a_factor_that_holds_the_time_makes_no_constraint_rheonomic():
    keys = {"q": ["x", "y"], "constraints": ["exp(t)*(x - y) = 0"]}
    assert said("constraint-class", **keys, **{"class": ["rheonomic"]}) == "fails"
    assert said("constraint-class", **keys, **{"class": ["scleronomic"]}) == "holds"
    verdict = judge(Claim("a", "constraint-class", keys | {"class": ["rheonomic"]}, budget=BUDGET))
    assert "what is allowed does not depend on the time" in verdict.feedback


AGAINST = "atan2(q, p) - atan2(2*(q + p), p - q)"
"""Two angles about one centre, one against the other."""
WEDGES = f"{AGAINST} + atan((2*p**2 + p*q + q**2)/(p**2 + p*q + 2*q**2))"
"""With a smooth third term: 0 on some wedges and 2π on others."""


@pytest.mark.parametrize(
    ("more", "due"), [("0", "holds"), (WEDGES, "fails"), (f"3*({WEDGES})", "fails"), (AGAINST, "fails")]
)
def test_angles_that_undo_each_other_are_no_matter_of_choice(more, due):
    keys = {"q": ["q"], "p": ["p"], "H": "(p**2 + q**2)/2"}
    assert said("constant-of-motion", **keys, I=f"p**2 + q**2 + {more}") == due
    identity = {"new_q": ["Q"], "new_p": ["P"], "map": {"Q": ["q"], "P": ["p"]}}
    F = f"q*P + {more.replace('p', 'P')}"
    assert said("generating-F2", q=["q"], p=["p"], **identity, F=F) == due


@pytest.mark.parametrize(
    ("I", "due"),
    [("atan2(q, p) + acot(p/q) - 2*t", "holds"), ("atan2(q, p) + acot(q/p) + p**2 + q**2", "fails")],
)
def test_the_sense_in_which_an_arc_cotangent_winds(I, due):
    assert said("constant-of-motion", q=["q"], p=["p"], H="(p**2 + q**2)/2", I=I) == due


def test_phases_of_two_oscillators_may_step():
    keys = {"q": ["x", "y"], "p": ["p_x", "p_y"], "H": "(p_x**2 + x**2 + p_y**2 + y**2)/2"}
    assert said("constant-of-motion", **keys, I="atan2(x, p_x) - atan2(y, p_y)") == "holds"
    assert said("constant-of-motion", **keys, I="atan2(x, p_x) - 2*atan2(y, p_y)") == "fails"


@pytest.mark.parametrize(
    ("assumed", "values", "due"),
    [
        ("nonzero", [{}], "holds"),
        ("real", [{}], "fails"),
        ("positive", [{}], "holds"),
        ("nonzero", [{"a": "1"}], "fails"),
    ],
)
def test_an_open_value_is_one_where_the_answers_have_a_value(assumed, values, due):
    keys = {"q": ["q"], "p": ["p"], "Q": ["a*q"], "P": ["p/a"], "parameters": {"a": assumed}}
    assert said("parameters", of="canonicity", find=["a"], values=values, **keys) == due


def test_right_for_one_is_not_said_of_what_is_negative():
    keys = {"q": ["x"], "L": "x_dot**2/2 + a*x**4/4 + a**2*x**2/2", "claim": ["x_ddot - x**3 - x"]}
    told = {}
    for assumed in ("negative", "real"):
        claim = claim_from({"id": "a", "kind": "euler-lagrange", "parameters": {"a": assumed}, **keys})
        *_, (told[assumed], _) = judgements(claim)
    assert "a = 1" in told["real"].feedback
    assert told["negative"].status == "fails"
    assert "a = 1" not in told["negative"].feedback


@pytest.mark.parametrize(
    ("exact", "order", "claimed", "right"),
    [("cos(e)/e**8", -8, "2/e**8", "e**(-8)"), ("cos(e)/e", 1, "2/e", "-e/2 + 1/e")],
)
def test_what_is_right_at_a_pole_is_the_expansion_itself(exact, order, claimed, right):
    keys = {"exact": [exact], "small": ["e"], "order": order, "parameters": {"e": "real"}}
    *_, (told, _) = judgements(claim_from({"id": "a", "kind": "first-order", **keys, "claim": [claimed]}))
    assert (told.status, told.corrected) == ("fails", right)
    assert said("first-order", **keys, claim=[right]) == "holds"


def test_a_force_may_hold_a_length_t_where_the_time_is_tau():
    keys = {"q": ["x"], "t": "tau", "parameters": {"t": "positive", "F": "real"}}
    force = [{"F": ["F*t"], "r": ["x"]}]
    assert said("generalized-force", **keys, forces=force, Q=["F*t"]) == "holds"
    assert said("generalized-force", **keys, forces=force, Q=["F*tau"]) == "fails"


def test_rates_of_quasi_velocities_hold_no_velocities_of_coordinates():
    keys = {"q": ["x", "y"], "quasi": ["u"], "parameters": {"m": "positive"}}
    bodies = [{"m": "m", "r": ["x", "y"]}]
    with pytest.raises(InvalidClaim, match=r"q_dot\[1\]: holds x_dot"):
        said("gibbs-appell", **keys, q_dot=["u", "x_dot*y"], bodies=bodies, claim=["m*u_dot"])


@pytest.mark.parametrize("declared", [{}, {"delta_x": "real"}])
@pytest.mark.parametrize(("boundary", "due"), [("m*x_dot*delta_x", "holds"), ("2*m*x_dot*delta_x", "fails")])
def test_a_variation_may_be_declared(declared, boundary, due):
    keys = {"q": ["x"], "parameters": {"m": "positive", **declared}, "L": "m*x_dot**2/2"}
    assert said("variation", **keys, boundary=boundary, integrand="-m*x_ddot*delta_x") == due
