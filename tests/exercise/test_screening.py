"""Screens of changed answers: a right one always passes, a wrong one hardly ever; what they find is right."""

from pathlib import Path

import pytest
import sympy as sp
from flint import acb
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.exercise.claim_verdict import examine
from canon.exercise.diagnose.derived_part import time_term
from canon.exercise.diagnose.diagnosis import WrongAnswer, judged_to_hold
from canon.exercise.diagnose.diagnosis_search import diagnosis
from canon.exercise.diagnose.effort import Effort
from canon.exercise.diagnose.repairs.answer_places import answers_of
from canon.exercise.diagnose.repairs.point_derivatives import BITS, Examples, Neighbourhood
from canon.exercise.diagnose.repairs.repair import repair
from canon.exercise.diagnose.repairs.screening import screening
from canon.exercise.question.question import Part
from canon.exercise.report.sentences import feedback, sentence
from canon.exercise.sheet.reading import Reading
from canon.exercise.sheet.sheet import Claim, read_sheet
from canon.proof.domain.balls import precision
from canon.proof.domain.domain import Domain

CLAIMS = Path(__file__).parent.parent / "data" / "claims"
KINDS = (
    "canonicity",
    "canonicity-time-dependent",
    "lagrange-bracket",
    "poisson-bracket",
    "generating-F1",
    "generating-F2",
    "generating-F3",
    "generating-F4",
    "transformed-hamiltonian-K",
    "constant-of-motion",
    "lagrangian-equivalence",
    "hamilton-equations",
    "equality-only",
)


def told(kind, **keys):
    finding = examine(Claim("a", kind, keys))
    return feedback(finding) if finding.verdict.fails else "holds"


@pytest.mark.parametrize("kind", KINDS)
def test_true_claims_pass_and_most_false_ones_do_not(kind):
    passed = {True: [], False: []}
    for claim in read_sheet(CLAIMS / f"{kind}.json").claims:
        reading = Reading(claim)
        screen = screening(reading, dict(answers_of(reading)))
        if screen is not None:
            passed[claim.expect == "holds"].append(screen.passes({}))
    assert all(passed[True])
    assert sum(passed[False]) <= 0.25 * len(passed[False])


@given(st.integers(-3, 3), st.integers(-3, 3), st.fractions(1, 3, max_denominator=4))
@settings(max_examples=50, deadline=None)
def test_slopes_are_derivatives(a, b, c):
    x, y = sp.symbols("x y", real=True)
    f = sp.Function("f", real=True)
    F = sp.sin(a * x + b * y) * f(x, y) + sp.Rational(c) * x**2 * f(x, y).diff(y)
    with precision(BITS):
        at = {x: acb(3) / 7, y: acb(-5) / 11}
        place = Neighbourhood(at, Examples([F]))
        difference = place.slope(F, x) - place.value(F.diff(x))
        assert abs(difference) < acb(2).real ** -80


@given(
    st.lists(st.integers(-3, 3), min_size=3, max_size=3),
    st.sampled_from([1, -1, 2, sp.Rational(1, 2), sp.Rational(3, 4)]),
    st.booleans(),
)
@settings(max_examples=50, deadline=None)
def test_a_lost_product_of_powers_is_found(powers, factor, with_sine):
    m, l, g, theta = sp.symbols("m l g theta", positive=True)
    term = factor * m ** powers[0] * l ** powers[1] * g ** powers[2] * (sp.sin(theta) if with_sine else 1)
    rest = sp.cos(theta) * m + sp.exp(l) * g**2
    found = repair(Part("a", rest, rest + term), Domain(), Effort(60.0))
    assert found is not None
    assert sp.expand(found.right - rest - term) == 0


def test_a_residual_that_is_no_product_of_powers_is_not_called_one():
    m, l = sp.symbols("m l", positive=True)
    assert repair(Part("a", m * sp.exp(l), m * sp.exp(l) + m**2 + l**3 + 1), Domain(), Effort(60.0)) is None


FRAME = {
    "q": ["q"],
    "p": ["p"],
    "new_q": ["Q"],
    "new_p": ["P"],
    "parameters": {"m": "positive"},
    "functions": {"V": ["q"], "s": ["t"]},
    "H": "p**2/(2*m) + V(q)",
    "map": {"Q": ["q - s(t)"], "P": ["p - m*Derivative(s(t), t)"]},
}
K = "P**2/(2*m) + V(Q + s(t)) + m*Q*Derivative(s(t), (t, 2))"


@pytest.mark.parametrize(
    ("claimed", "said"),
    [
        (K, "holds"),
        (K + " + cos(t)", "holds"),
        (K.replace("+ m*Q", "- m*Q"), "in K the sign of -Q*m*Derivative(s(t), (t, 2)) is wrong"),
        (K.replace("(2*m)", "m"), "in K the term P**2/m should be half that"),
        (K.split(" + m*Q")[0], "in K the term Q*m*Derivative(s(t), (t, 2)) is missing"),
    ],
)
def test_the_new_hamiltonian_is_compared_term_by_term(claimed, said):
    assert told("transformed-hamiltonian-K", **FRAME, K=claimed) == said


def test_a_step_with_old_momenta():
    keys = {"q": ["q"], "p": ["p"], "parameters": {"h": "real"}, "functions": {"V": ["q"]}}
    kick = "p - h*Derivative(V(q), q)"
    assert told("canonicity", **keys, Q=[f"q + h*({kick})"], P=[kick]) == "holds"
    said = "in Q the new momenta P belong in place of the old ones"
    assert told("canonicity", **keys, Q=["q + h*p"], P=[kick]) == said


def test_a_lost_time_term_and_a_constant_that_needs_none():
    keys = {"q": ["x"], "p": ["p"], "H": "p**2/(2*m)", "parameters": {"m": "positive"}}
    assert told("constant-of-motion", **keys, I="m*x - p*t") == "holds"
    said = "I grows at the constant rate k: in I the term -k*t is missing"
    keys["H"], keys["parameters"] = "p**2/2 - k*x", {"k": "positive"}
    assert told("constant-of-motion", **keys, I="p") == said
    assert told("constant-of-motion", **keys, I="p - k*t") == "holds"


def test_a_term_without_its_time_is_put_right():
    keys = {"q": ["x"], "p": ["p"], "H": "p**2/(2*m)", "parameters": {"m": "positive"}}
    finding = examine(Claim("a", "constant-of-motion", {**keys, "I": "x - p/m"}))
    (found,) = time_term(WrongAnswer(finding, (), finding.reading.domain, Effort(60.0)))
    assert sentence(found) == "in I the term -p/m lacks the factor t"
    assert judged_to_hold(found.repaired, Effort(60.0))


@pytest.mark.parametrize(
    ("x", "passes"), [("2*cos(t)", True), ("cos(t)", False), ("2*cos(t) + sin(t)", False)]
)
def test_a_motion_that_begins_elsewhere_does_not_pass(x, passes):
    keys = {"q": ["x"], "L": "x_dot**2/2 - x**2/2", "initial": {"x": "2", "x_dot": "0"}, "solution": {"x": x}}
    reading = Reading(Claim("a", "solution", keys))
    assert screening(reading, dict(answers_of(reading))).passes({}) is passes


@pytest.mark.parametrize(
    ("x", "p", "passes"),
    [("sin(t)", "cos(t)", True), ("sin(t)", "sin(t)", False), ("sin(2*t)", "2*cos(2*t)", False)],
)
def test_a_motion_in_phase_space_passes_where_it_obeys_hamiltons_equations(x, p, passes):
    keys = {"q": ["x"], "p": ["p"], "H": "p**2/2 + x**2/2", "solution": {"x": x, "p": p}}
    reading = Reading(Claim("a", "hamilton-equations", keys))
    assert screening(reading, dict(answers_of(reading))).passes({}) is passes


def test_the_part_of_the_domain_where_a_branch_is_right_is_told():
    keys = {
        "parameters": {"x": "real"},
        "domain": ["0 < x", "x < pi"],
        "lhs": "asin(sin(x))",
        "rhs": "pi - x",
    }
    said = "right where x - pi/2 > 0, but not on the whole domain"
    assert told("equality-only", **keys) == said
    assert told("equality-only", **{**keys, "domain": ["pi/2 < x", "x < pi"]}) == "holds"


def test_a_parameter_that_was_taken_to_be_one_is_told():
    keys = {"q": ["q"], "p": ["p"], "parameters": {"a": "positive"}, "P": ["p"]}
    assert told("canonicity", **keys, Q=["q**a"]) == "right for a = 1, but not in general"


def test_right_only_for_small_angles_is_said_of_truncated_answers_only():
    keys = {"q": ["theta"], "parameters": {"l": "positive", "g": "positive"}}
    keys["L"] = "l**2*theta_dot**2/2 + g*l*cos(theta)*sqrt(1 + sin(theta)**4)"
    said = told("euler-lagrange", **keys, claim=["l*theta_ddot + g*theta"])
    assert said == "right only for small theta, to second order"
    assert "small" not in told("euler-lagrange", **keys, claim=["l*theta_ddot - g*theta"])


def test_every_repair_told_is_judged_as_a_whole():
    finding = examine(Claim("a", "generating-F2", {
        "q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "F": "q**3*P", "parameters": {"q": "positive"},
        "map": {"Q": ["q**3"], "P": ["p/q**2"]},
    }))  # fmt: skip
    found = diagnosis(finding)
    assert sentence(found) == "P should be 1/3 times what it is"
    assert judged_to_hold(found.repaired, Effort(60.0))
