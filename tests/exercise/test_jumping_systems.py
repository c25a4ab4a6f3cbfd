"""Systems whose H or L jumps, and constants of the motion that jump where no motion crosses.

Truths by refraction at a step of the potential: H and what does not depend on the momentum across it are kept
(Landau & Lifshitz, Mechanics, § 7, problem), the momentum across it is not.
"""

import pytest

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim

STEP = {"q": ["q"], "p": ["p"], "H": "p**2/2 + sign(q)"}
WALL = {"q": ["x", "y"], "p": ["px", "py"], "H": "(px**2 + py**2)/2 + Piecewise((U, x > 0), (0, True))",
        "parameters": {"U": "positive"}}  # fmt: skip
FORWARDS = {
    "q": ["x", "y"],
    "L": "(x_dot**2 + 2*y_dot**2)/2 - U*(1 + sign(x))/2",
    "parameters": {"U": "positive"},
}
OSCILLATOR = {"q": ["q"], "p": ["p"], "H": "(p**2 + q**2)/2"}
FREE = {"q": ["x", "y"], "p": ["px", "py"], "H": "(px**2 + py**2)/2"}


def said(kind, **keys):
    verdict = judge(Claim("a", kind, keys))
    told = "; ".join([verdict.feedback, *(each.text for each in verdict.evidence)])
    return verdict.status.value, told


@pytest.mark.parametrize(
    ("system", "kept", "changed"),
    [
        (STEP, "p**2/2 + sign(q)", "p"),
        (STEP, "3*p**2 + 6*sign(q)", "p**2"),
        (WALL, "py", "px"),
        (WALL, "(px**2 + py**2)/2 + Piecewise((U, x > 0), (0, True)) + py**3", "px + py"),
        (FORWARDS, "y_dot", "x_dot"),
        (FORWARDS, "x_dot**2/2 + U*(1 + sign(x))/2", "x_dot*y_dot"),
    ],
)
def test_what_a_step_of_the_potential_changes_is_not_called_constant(system, kept, changed):
    assert said("constant-of-motion", **system, I=kept)[0] == "holds"
    status, told = said("constant-of-motion", **system, I=changed)
    assert status == "undecided"
    assert "the momentum changes at once there" in told
    for key in ("conserved", "not_conserved"):
        assert said("conserved-or-not", **system, **{key: [changed]})[0] == "undecided"


def test_a_coordinate_at_which_L_jumps_is_not_ignorable():
    plane = {"q": ["r", "phi"], "cyclic": ["phi"], "momenta": ["p"], "convention": "L-pq",
             "parameters": {"r": "positive"}}  # fmt: skip
    kinetic, reduced = "(r_dot**2 + r**2*phi_dot**2)/2", "r_dot**2/2 - p**2/(2*r**2)"
    jumping = said("routhian", **plane, L=f"{kinetic} - sign(phi)", R=f"{reduced} - sign(phi)")
    assert jumping[0] == "undecided"
    assert said("routhian", **plane, L=f"{kinetic} - sign(r - 1)", R=f"{reduced} - sign(r - 1)")[0] == "holds"


@pytest.mark.parametrize("relation", ["gauge", "equations"])
def test_a_term_linear_in_the_velocity_that_jumps_is_no_gauge_term(relation):
    L1 = "(x_dot**2 + y_dot**2)/2"
    keys = {"q": ["x", "y"], "relation": relation, "L1": L1}
    assert said("lagrangian-equivalence", **keys, L2=f"{L1} + x_dot*sign(y)")[0] == "undecided"
    assert said("lagrangian-equivalence", **keys, L2=f"{L1} + x_dot*sign(x)")[0] == "holds"
    assert said("lagrangian-equivalence", **keys, L2=f"{L1} + x_dot*y + y_dot*x")[0] == "holds"


@pytest.mark.parametrize("domain", ["q > 0", "q < -1"])
def test_on_one_side_of_the_step_the_momentum_is_constant(domain):
    assert said("constant-of-motion", **STEP, I="p", domain=[domain])[0] == "holds"


def test_a_motion_through_a_step_is_not_called_a_solution():
    assert said("solution", q=["x"], L="x_dot**2/2 - sign(x)", solution={"x": "t"})[0] == "undecided"
    assert said("hamilton-equations", **STEP, solution={"q": "t", "p": "1"})[0] == "undecided"


def test_a_motion_on_one_side_of_a_step_is_one():
    keys = {"q": ["x"], "L": "x_dot**2/2 - sign(x)", "solution": {"x": "t**2*0 + 1 + t"}, "domain": ["t > 0"]}
    assert said("solution", **keys)[0] == "holds"
    assert said("solution", **{**keys, "solution": {"x": "1 + t**2"}})[0] == "fails"


@pytest.mark.parametrize(
    ("system", "beside", "across"),
    [
        (OSCILLATOR, "sign(q**2 + p**2 - 1)*(q**2 + p**2)", "sign(q**2 - p**2 - 1)*(q**2 + p**2)"),
        (OSCILLATOR, "Piecewise((q**2 + p**2, q**2 + p**2 > 4), (1, True))",
         "Piecewise((q**2 + p**2, q > 4), (1, True))"),
        (FREE, "sign(x*py - y*px)*(px**2 + py**2)", "sign(x*py + y*px)*(px**2 + py**2)"),
        (FREE, "acot(px)*py", "acot(x)*py"),
    ],
)  # fmt: skip
def test_a_constant_is_continuous_on_the_domain_even_where_no_motion_crosses(system, beside, across):
    """SHEETS: constants of the motion are continuous on the domain; on each side of the border there is one."""
    assert said("constant-of-motion", **system, I=beside)[0] == "fails"
    assert said("constant-of-motion", **system, I=across)[0] == "fails"


def test_on_one_side_of_a_border_it_is_a_constant():
    keys = {**OSCILLATOR, "domain": ["q**2 + p**2 > 1"]}
    assert said("constant-of-motion", **keys, I="sign(q**2 + p**2 - 1)*(q**2 + p**2)")[0] == "holds"
    assert said("constant-of-motion", **keys, I="sign(q**2 + p**2 - 2)*(q**2 + p**2)")[0] == "fails"


def test_a_number_on_each_side_of_a_constant_says_nothing():
    status, told = said("constant-of-motion", **OSCILLATOR, I="sign(q**2 + p**2 - 1)")
    assert status == "fails"
    assert "says nothing about the motion" in told


def test_casimirs_are_continuous_too():
    body = {"x": ["a", "b", "c"], "pairs": [{"u": "a", "v": "b", "value": "c"}, {"u": "b", "v": "c", "value": "a"},
            {"u": "c", "v": "a", "value": "b"}]}  # fmt: skip
    size = "(a**2 + b**2 + c**2)"
    assert said("jacobi-identity", **body, casimirs=[f"sign({size} - 1)*{size}"])[0] == "fails"
    assert said("jacobi-identity", **body, casimirs=[f"sign({size} + 1)*{size}"])[0] == "holds"
    assert said("jacobi-identity", **body, casimirs=[f"sign(a)*{size}"])[0] == "fails"
