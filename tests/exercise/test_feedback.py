"""What a student is told: true, about the right place, and never invented."""

from pathlib import Path

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.exercise.claim_verdict import examine
from canon.exercise.diagnose.effort import Effort
from canon.exercise.diagnose.repairs.repair import repair
from canon.exercise.diagnose.repairs.slips import variants
from canon.exercise.diagnose.repairs.unbuilt import built
from canon.exercise.diagnose.right_answer import corrected
from canon.exercise.question.question import Part
from canon.exercise.report.sentences import feedback
from canon.exercise.sheet.sheet import Claim, bundled_sheet, read_sheet
from canon.proof.domain.domain import Domain
from canon.proof.vanish import vanishes

CLAIMS = Path(__file__).parent.parent / "data" / "claims"
EXPECTED = {
    "EL-01a": "in equation 1 cos(theta) should be sin(theta)",
    "EL-01b": "in equation 1 the sign of -g*sin(theta)/l is wrong",
    "EL-02a": "in equation 2 the term phi_dot*r_dot should be twice that",
    "EL-02b": "each equation is right, but together they do not determine the motion: an equation is missing",
    "EL-02c": "each equation is right, but together they do not determine the motion: an equation is missing",
    "EL-06b": "in equation 1 the term a*omega*sin(theta)*cos(omega*t) lacks the factor omega",
    "EL-10a": "in equation 1 the term x_dot**2*Derivative(M(x), x) should be half that",
    "EL-14a": "in equation 1 the term -Omega**2*m*x is missing; in equation 2 the term -Omega**2*m*y is missing",
    "DI-01a": "dE/dt should be twice what it is",
    "DI-02a": "in equation 2 the term c*phi_dot lacks the factor r",
    "DI-05a": "dE/dt has the wrong sign",
    "LH-01a": "in H the sign of g*l*m*cos(theta) is wrong",
    "HE-01a": "dp/dt has the wrong sign",
    "HE-01c": "the equations of q and p are exchanged",
    "RO-01b": "right under the opposite sign convention; the convention here is the one that `convention` says",
    "GA-01b": "S should be half what it is",
    "PB-01a": "right under the opposite sign convention; the convention here is {q, p} = +1",
    "LI-02a": "right under the opposite sign convention; the convention here is [X, Y] = X·∇Y − Y·∇X",
    "CA-01a": "{Q, P} = -1, not 1: exchange Q and P, or change the sign of one of them",
    "CA-05a": "canonical with valence 2, not 1: {Q, P} = 2; multiply P by 1/2",
    "CA-13a": "right for y > 0, but not on the whole domain",
    "BC-05a": "the factor is 2, not 1/2",
    "F1-01a": "F should be half what it is",
    "F1-02b": "right under the opposite sign of a rule: here P = −∂F/∂Q",
    "F2-01a": "F has the wrong sign",
    "KH-02a": "K is H in the new variables; ∂F/∂t is missing: K = H + ∂F/∂t",
    "KH-02b": "the sign of ∂F/∂t in K is wrong: K = H + ∂F/∂t",
    "CM-01b": "in I the term -k*x/sqrt(x**2 + y**2) lacks the factor m",
    "CM-02a": "in I the sign of t*p/m is wrong",
    "LE-02b": "in F the sign of -m*v*x is wrong",
    "LE-04a": "L1 and L2 have the same equations of motion, but L2 − L1 is not dF/dt of any F(q, t)",
    "EQ-33a": "in rhs x should be Abs(x)",
}
EVERY = {c.id: c for path in CLAIMS.glob("*.json") for c in read_sheet(path).claims}


@pytest.mark.parametrize("name", EXPECTED)
def test_what_is_said(name):
    finding = examine(EVERY[name])
    assert finding.verdict.fails
    assert feedback(finding) == EXPECTED[name]


def test_the_tour_says_where_each_false_answer_is_wrong():
    said = {c.id: feedback(examine(c)) for c in bundled_sheet().claims if c.expect == "fails"}
    assert said["oscillator-F1"] == "F should be half what it is"
    assert "opposite sign convention" in said["bracket-sign"]
    assert "the sign of -g*sin(phi)/l is wrong" in said["double-pendulum"]
    assert "theta2_dot**2" in said["rod-pendulum"]
    assert all(said.values()), said


def test_the_right_answer_is_shown():
    assert corrected(examine(EVERY["LH-01a"])) == "-g*l*m*cos(theta) + p**2/(2*l**2*m)"
    assert corrected(examine(EVERY["HE-01a"])) == "p/m; -m*w**2*q"
    assert corrected(examine(EVERY["RO-01a"])) == "k/r + m*r_dot**2/2 - l**2/(2*m*r**2)"
    assert corrected(examine(EVERY["PB-02a"])) == "{f, g} of pair 1 = 1"


def test_nothing_is_said_of_what_no_single_slip_explains():
    wrong = {"kind": "equality-only", "lhs": "sin(t)", "rhs": "exp(t) + t**5 - 7*cos(t**2)"}
    assert feedback(examine(Claim("w", "equality-only", wrong))) == ""


x, y, m = sp.symbols("x y m", real=True)
RIGHT = m * x**2 / 2 - sp.sin(x) * y + sp.cos(y) * m**2


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 60))
def test_a_repair_is_always_right(number):
    """Whatever slip was made, what is proposed equals the right expression; signs and factors are always found."""
    slips = [
        slip
        for slip in ((built(new), change) for new, change in variants(RIGHT, (x, y, m)))
        if slip[0].free_symbols and not slip[0].has(sp.zoo, sp.nan)
    ]
    wrong, change = slips[number * 7 % len(slips)]
    if vanishes(wrong - RIGHT).holds:
        return
    found = repair(Part("the answer", wrong, RIGHT), Domain(), Effort(60.0))
    if found is None:
        assert "SIGN" not in change.mistake.name
        assert "TERM" not in change.mistake.name
        return
    assert vanishes(found.right - RIGHT).holds
    assert found.change.place == "the answer"


k = sp.Symbol("k", imaginary=True)
x, y = sp.symbols("x y", real=True)


@pytest.mark.parametrize(
    "expression",
    [
        sp.elliptic_e(x, y) + x,
        x - sp.elliptic_k(y) * sp.elliptic_f(x, y),
        sp.Piecewise((x, x < 1), (y, True)) + sp.Abs(k),
        sp.sin(sp.Piecewise((x, x < 1), (y, True))) * sp.Abs(k),
        sp.sin(sp.Max(x, y)) * sp.Abs(k),
    ],
)
def test_slips_that_say_nothing_are_left_out(expression):
    """The twins of an elliptic integral take another number of arguments; an imaginary symbol has no order."""
    found = list(variants(expression, [x, y, k]))
    assert len(found) > 5
    assert all(isinstance(built(new), sp.Expr) for new, _ in found)


@pytest.mark.parametrize(
    ("claimed", "right"),
    [
        (sp.exp(1000 * x**2), sp.exp(3000 * x**2)),
        (sp.exp(-1000 * x**2), sp.exp(-3000 * x**2)),
        (x**1_000_000, 2 * x**1_000_001),
    ],
)
def test_ratios_beyond_all_bounds_are_no_factors(claimed, right):
    found = repair(Part("a", claimed, right), Domain(), Effort(60.0))
    assert found is None or vanishes(found.right - right).holds
