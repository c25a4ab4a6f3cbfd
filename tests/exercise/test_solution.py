"""Solutions of equations of motion: kinks, constants of integration, general solutions, and wrong twins."""

import mpmath as mp
import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim


def verdict(kind, **keys):
    return judge(Claim("a", kind, keys))


def test_first_order_equations_have_as_many_constants_as_coordinates():
    keys = {"q": ["x"], "equations": ["x_dot + x"], "solution": {"x": "A*exp(-t)"}}
    assert verdict("solution", **keys, constants=["A"]).holds
    assert verdict("solution", **{**keys, "solution": {"x": "(A + B)*exp(-t)"}}, constants=["A", "B"]).fails


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return judge(Claim("a", kind, keys)).status.value
    except InvalidClaim:
        return "invalid"


@pytest.mark.parametrize(("equation", "x", "domain", "expected"), [
    ("x_ddot", "sqrt(t**2 - 2*t + 1)", [], "fails"),  # |t − 1|
    ("x_ddot", "sqrt(t**2 - 2*t + 1)", ["t > 1"], "holds"),
    ("x_ddot + x/4", "sqrt(1 - cos(t))", [], "undecided"),  # √2 |sin t/2|
    ("x_ddot + x/4", "sin(t/2)", [], "holds"),
    ("x_dot**2 = 1", "Abs(t)", [], "fails"),  # its velocity jumps
    ("x_dot = sign(t)", "Abs(t)", [], "holds"),  # as the equation wants it
    ("x_dot**2 = 1", "Abs(t)", ["t > 0"], "holds"),
    ("x*x_dot = 1", "sqrt(2*t + c)", [], "holds"),
    ("x*x_dot = 1", "sqrt(t + c)", [], "fails"),
    ("x_ddot", "Abs(c)*t", [], "holds"),
])  # fmt: skip
def test_motions_with_kinks(equation, x, domain, expected):
    keys = {"q": ["x"], "equations": [equation], "solution": {"x": x}, "parameters": {"c": "real"}}
    assert said("solution", **keys, domain=domain) == expected


def test_a_kink_is_one():
    """The motions called wrong or doubtful above leave the equation by a jump of the velocity."""
    for f, t in ((lambda t: mp.sqrt(t**2 - 2 * t + 1), 1), (lambda t: mp.sqrt(1 - mp.cos(t)), 0)):
        right, left = (mp.diff(f, t + side * mp.mpf("1e-3")) for side in (1, -1))
        assert abs(right - left) > 1


@pytest.mark.parametrize(("equations", "x", "constants", "expected"), [
    (["x_ddot + k**2*x"], "A*cos(k*t)", ["A", "k"], "fails"),  # k is no constant of integration
    (["x_ddot + k**2*x"], "A*cos(k*t + B)", ["A", "B"], "holds"),
    (["x_ddot + k**2*x"], "A*cos(k*t)", ["A", "B"], "fails"),
    (["x_dot**2 - 1"], "t + C", ["C"], "undecided"),  # −t + C is one too
    (["x_dot - 1"], "t + C", ["C"], "holds"),
])  # fmt: skip
def test_constants_of_integration(equations, x, constants, expected):
    keys = {"q": ["x"], "equations": equations, "solution": {"x": x}, "constants": constants}
    assert said("solution", **keys, parameters={"k": "positive"}) == expected


def test_general_solutions_of_equations_that_leave_something_free():
    line = {"solution": {"x": "A + B*t", "y": "C + D*t"}, "constants": ["A", "B", "C", "D"], "q": ["x", "y"]}
    twice = ["x_ddot + y_ddot", "2*x_ddot + 2*y_ddot"]  # x = sin t, y = −sin t is one too
    assert said("solution", **line, equations=twice) == "undecided"
    assert said("solution", **line, equations=["x_ddot + y_ddot", "x_ddot - y_ddot"]) == "holds"
    assert said("solution", **line, L="(x_dot + y_dot)**2/2") == "undecided"
    assert said("solution", **line, L="(x_dot**2 + y_dot**2)/2") == "holds"


def test_lagrangians_of_first_order_have_as_many_constants_as_coordinates():
    turn = {"x": "A*cos(t) + B*sin(t)", "y": "-A*sin(t) + B*cos(t)"}
    keys = {"q": ["x", "y"], "L": "y*x_dot - (x**2 + y**2)/2", "solution": turn}
    assert said("solution", **keys, constants=["A", "B"]) == "holds"
    assert said("solution", **keys, constants=["A"], parameters={"B": "real"}) == "fails"


FALL = {"q": ["r"], "p": ["p"], "parameters": {"r": "positive", "k": "positive"}, "H": "p**2/2 - k/r"}
FREE = {"q": ["q"], "p": ["p"], "H": "p**2/2"}
TURN = {"q": "acos(cos(t))", "p": "sin(t)/sqrt(1 - cos(t)**2)"}


@pytest.mark.parametrize(("root", "holds"), [("9*k*t**2/2", True), ("9*k*t**2/4", False)])
def test_a_fall_at_zero_energy_before_and_after_the_centre(root, holds):
    solution = {"r": f"({root})**(1/3)", "p": f"3*k*t/({root})**(2/3)"}
    verdict = judge(Claim("a", "hamilton-equations", {**FALL, "domain": ["Ne(t, 0)"], "solution": solution}))
    assert (verdict.holds, verdict.fails) == (holds, not holds)


@pytest.mark.parametrize(("end", "holds"), [("3.1", True), ("pi", True), ("3.2", False), ("7", False)])
def test_an_arc_of_a_cosine_is_a_motion_until_it_turns_round(end, holds):
    keys = {**FREE, "solution": TURN, "domain": ["t > 0", f"t < {end}"], "box": {"t": [0.1, 3]}}
    assert judge(Claim("a", "hamilton-equations", keys)).holds == holds
