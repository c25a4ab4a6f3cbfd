"""Steps and kinks of what is given: what a second reader claimed of them, and the status that it may have."""

import pytest

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim

LINE, PLANE = {"q": ["q"], "p": ["p"]}, {"q": ["x", "y"], "p": ["px", "py"]}
T, STEP = "(px**2 + py**2)/2", "Piecewise((1, x > 0), (0, True))"
DISC, N = f"{T} + Piecewise((0, x**2 + y**2 < 1), (3, True))", "Piecewise((2, x > 0), (1, True))"
L_PLANE, OF_TIME = "(x_dot**2 + y_dot**2)/2", "Piecewise((1, t > 0), (0, True))"
NOT_RIGHT = {"fails", "undecided"}


def status(kind, **keys):
    return judge(Claim("a", kind, keys)).status.value


@pytest.mark.parametrize(
    ("system", "I"),
    [
        ({**LINE, "H": "(p**2 + q**2)/2"}, "sign(atan2(q, p) - t)*(q**2 + p**2)"),
        ({**LINE, "H": "p"}, "sign(atan(tan(q)) - t - 1/10)*p"),
        ({**PLANE, "H": T}, f"py*sign(px + {STEP})"),
        ({**PLANE, "H": f"{T} + {STEP}"}, "py*sign(px**2 - 4)"),
        ({**PLANE, "H": f"{T} + {STEP}"}, "py*sign(px - 2)"),
        ({"q": ["x", "y"], "L": f"{L_PLANE} - {STEP}"}, "y_dot*sign(x_dot - 2)"),
        ({**PLANE, "H": f"{T} + sign(x)"}, "py + sign(x)"),
        ({**PLANE, "H": f"{T} + sign(x)"}, "py*(2 + sign(x))"),
        ({**PLANE, "H": DISC}, "x*py - y*px + Piecewise((1, x**2 + y**2 < 1), (0, True))"),
        ({"x": ["x", "y"], "X": ["1", "sign(x)"]}, "y - abs(x) + sign(x)"),
        ({"q": ["x", "y"], "L": f"{N}*{L_PLANE}"}, "y_dot"),
        ({**PLANE, "H": f"{T}/{N}"}, f"py/{N}"),
        ({"q": ["x", "y"], "L": f"{L_PLANE} + x_dot*sign(y)"}, "x_dot"),
        *(({**LINE, "H": f"p**2/2 + {V}"}, "p") for V in (
            "abs(q)/q", "sqrt(q**2)/q", "max(q, 0)/q", "sign(q**3)", "sign(q**2 - 10**6)",
            "Piecewise((1, q**2 < 1000000), (0, True))",
        )),
        ({**LINE, "H": "p**2/2 + q**2/2 + sign(q)"}, "q*p"),
    ],
)  # fmt: skip
def test_no_constant(system, I):
    assert status("constant-of-motion", **system, I=I) in NOT_RIGHT


@pytest.mark.parametrize(
    ("system", "I"),
    [
        ({**PLANE, "H": DISC}, "x*py - y*px"),
        ({"x": ["x", "y"], "X": ["1", "sign(x)"]}, "y - abs(x)"),
        ({**PLANE, "H": f"{T}/{N}"}, "py"),
        ({"q": ["x", "y"], "L": f"{L_PLANE} + x*sign(sin(t))"}, "y_dot"),
        ({**LINE, "H": f"p**2/2 - q*{OF_TIME}"}, "p - max(t, 0)"),
        ({**LINE, "H": "p**2/(2*(2 - sign(t)))"}, "p"),
        ({**PLANE, "H": f"{T} + sign(x) + sign(y)"}, "px**2/2 + sign(x)"),
        ({**LINE, "H": "p**2/2 + sign(p)"}, "p"),
        ({**LINE, "H": "p**2/2 + q**2/2 + sign(p)"}, "p**2/2 + q**2/2 + sign(p)"),
    ],
)
def test_constants(system, I):
    assert status("constant-of-motion", **system, I=I) == "holds"


def test_solutions_through_steps_and_steps_in_time():
    for V in ("abs(x)/x", "sign(x**3)"):
        assert status("solution", q=["x"], L=f"x_dot**2/2 - {V}", solution={"x": "t"}) in NOT_RIGHT
    by_rates = {"q": ["x"], "L": "x_dot**2/2 - sign(x)", "rates": {"x": "v"}, "constants": ["v"]}
    assert status("solution", **by_rates, parameters={"v": "real"}) in NOT_RIGHT
    for wrong in ("t", "A*exp(t)"):
        keys = {"L": "x_dot**2/2 - x**2/2 - sign(x)", "solution": {"x": wrong}, "parameters": {"A": "real"}}
        assert status("solution", q=["x"], **keys) == "fails"
    pushed = {"L": "x_dot**2/2 + x*Piecewise((1, t > 1), (0, True))"}
    right = {"x": "Piecewise(((t - 1)**2/2, t > 1), (0, True))"}
    assert status("solution", q=["x"], **pushed, solution=right) == "holds"
    assert (
        status("solution", q=["x"], **pushed, solution={"x": "Piecewise(((t - 1)**2, t > 1), (0, True))"})
        == "fails"
    )
    from_rest = {"q": "max(t, 0)**2/2", "p": "max(t, 0)"}
    assert status("hamilton-equations", **LINE, H=f"p**2/2 - q*{OF_TIME}", solution=from_rest) == "holds"


def test_what_is_not_conserved_beside_a_step():
    assert status("conserved-or-not", **LINE, H="p**2/2 + q**2/2 + sign(q)", not_conserved=["p"]) == "holds"
    L = f"{L_PLANE} + x*sign(sin(t))"
    assert status("conserved-or-not", q=["x", "y"], L=L, not_conserved=["x_dot"]) == "holds"


def test_the_slopes_of_an_action_go_on_across_a_step():
    keys = {**PLANE, "H": f"{T} + sign(x)", "constants": ["E", "c"], "energy": "E"}
    assert status("hamilton-jacobi", **keys, gradient=["c", "sqrt(2*(E - sign(x)) - c**2)"]) in NOT_RIGHT


@pytest.mark.parametrize(
    "V",
    ["x*sign(y)", "sign(x)*sign(y)", "max(x, 0)*sign(y)", "Piecewise((1, And(x > 0, y > 0)), (0, True))",
     "atan(tan(x + y))", "asin(sin(x + y))"],
)  # fmt: skip
def test_products_of_steps_do_not_separate(V):
    assert status("separable", **PLANE, H=f"{T} + {V}", **{"is": ["separable"]}) in NOT_RIGHT


@pytest.mark.parametrize("V", ["abs(x) + abs(y)", "sign(x) + sign(y)", "abs(sin(x)) + y**2"])
def test_steps_of_one_coordinate_each_do(V):
    assert status("separable", **PLANE, H=f"{T} + {V}", **{"is": ["separable"]}) == "holds"


@pytest.mark.parametrize(
    "ties",
    [
        ["w = a", "a = 1"],
        ["a = 1", "w = a"],
        ["a = 2", "b = 1/2", "w = a*b"],
        ["w = a", "w = b", "b = 1"],
        ["w**2 = 1"],
    ],
)  # fmt: skip
def test_ties_are_followed_in_any_order(ties):
    keys = {**PLANE, "actions": ["J1", "J2"], "degree": 4, "parameters": dict.fromkeys("wab", "positive"),
            "H": "(px**2 + x**2)/2 + w*(py**2 + y**2)/2 + x**2*y**2", "K": "J1 + w*J2 + J1*J2"}  # fmt: skip
    assert status("normal-form", **keys, domain=ties) == "undecided"
    assert status("normal-form", **keys, domain=["w**2 = 2"]) == "holds"


def test_a_tie_that_only_names_the_frequency_is_no_hindrance():
    keys = {**LINE, "actions": ["J"], "degree": 4, "H": "p**2/(2*m) + k*q**2/2 + b*q**4", "domain": ["w**2 = k/m"],
            "parameters": {**dict.fromkeys("wkm", "positive"), "b": "real"}}  # fmt: skip
    assert status("normal-form", **keys, K="w*J + 3*b*J**2/(2*m*k)") == "holds"
    assert status("normal-form", **keys, K="w*J + b*J**2/(2*m*k)") == "fails"


def test_a_leaving_of_one_contact_only_is_not_told_as_a_sense():
    keys = {"q": ["r", "theta"], "parameters": {"m": "positive", "a": "positive", "r": "positive"},
            "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 - m*r*cos(theta)", "contact": "(r - a)*(r - 2*a)"}  # fmt: skip
    claim = Claim(
        "a", "leaving-condition", {**keys, "leaves": "(theta_dot**2*a - cos(theta))*(2*a - r) + (r - a) = 0"}
    )
    with pytest.raises(ValueError, match="holds nowhere"):
        judge(claim)
