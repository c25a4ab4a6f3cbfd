"""Claims by which a second reader of the code had wrong verdicts, with right neighbours: what a text says is judged."""

import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim

BUDGET = 60.0
"""Seconds for a claim: that a busy machine is slow is no question here."""


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return judge(Claim("a", kind, keys, budget=BUDGET)).status.value
    except InvalidClaim:
        return "invalid"


def why_invalid(kind, **keys):
    """Return the key at fault and the sentence on it."""
    with pytest.raises(InvalidClaim) as refused:
        judge(Claim("a", kind, keys, budget=BUDGET))
    return refused.value.error.key, str(refused.value)


SIGNS = {"m": "positive", "k": "positive", "c": "positive", "g": "positive", "l": "positive", "J": "positive"}
SPRING = {"q": ["x"], "parameters": SIGNS, "L": "m*x_dot**2/2 - k*x**2/2"}
PLANE = {"q": ["x", "y"], "parameters": SIGNS, "L": "m*(x_dot**2 + y_dot**2)/2 - k*(x**2 + y**2)/2"}
FIRST_ORDER = {"q": ["x", "u"], "parameters": SIGNS, "L": "u*x_dot - u**2/(2*m) - k*x**2/2"}
DAMPED = {**SPRING, "F": "c*x_dot**2/2"}
PENDULUM = {
    "q": ["x", "y"], "parameters": SIGNS, "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y",
    "constraints": ["x**2 + y**2 = l**2"], "multipliers": ["lam"],
}  # fmt: skip
SECOND_RATE = "x*x_ddot + y*y_ddot + x_dot**2 + y_dot**2"
BAR = {
    "q": ["x", "y"],
    "parameters": SIGNS,
    "bodies": [{"m": "m", "r": ["x", "y"]}],
    "constraints": ["x = y"],
}
BLADE = {
    "q": ["x", "y", "th"], "quasi": ["u", "w"], "q_dot": ["u*cos(th)", "u*sin(th)", "w"], "parameters": SIGNS,
    "bodies": [{"m": "m", "r": ["x", "y"], "I": "J", "angle": "th"}],
}  # fmt: skip
TABLE = {
    "q": ["x", "y"], "parameters": SIGNS, "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y", "constraints": ["y = 0"],
    "multipliers": ["N"],
}  # fmt: skip
ORBIT = {
    "q": ["r", "phi"], "parameters": {"m": "positive", "r": "positive"}, "L": "m*(r_dot**2 + r**2*phi_dot**2)/2",
    "cyclic": ["phi"], "momenta": ["p"], "convention": "L-pq",
}  # fmt: skip
SMALL = {
    "q": ["theta"], "parameters": SIGNS, "L": "l**2*theta_dot**2/2 + g*l*cos(theta)",
    "equilibrium": {"theta": "0"},
}  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "system", "claim", "due"),
    [
        ("euler-lagrange", SPRING, ["(m*x_ddot + k*x)**2/(m*x_ddot + k*x) = 0"], "fails"),
        ("euler-lagrange", SPRING, ["(m*x_ddot + k*x)/(m*x_ddot + k*x) = 1", "m*x_ddot + k*x = 0"], "fails"),
        ("euler-lagrange", SPRING, ["exp(log(m*x_ddot + k*x)) = 0"], "fails"),
        ("euler-lagrange", SPRING, ["m*x_ddot/x + k = 0"], "holds"),
        ("euler-lagrange", SPRING, ["m*x_ddot/x - k = 0"], "fails"),
        ("euler-lagrange", FIRST_ORDER, ["(x_dot - u/m)**2/(x_dot - u/m)", "u_dot = -k*x"], "fails"),
        ("euler-lagrange", FIRST_ORDER, ["x_dot*u/u = u/m", "u_dot = -k*x"], "holds"),
        ("euler-lagrange", FIRST_ORDER, ["x_dot*u/u = u/m", "u_dot = k*x"], "fails"),
        ("dissipative", DAMPED, ["(m*x_ddot + c*x_dot + k*x)**2/(m*x_ddot + c*x_dot + k*x) = 0"], "fails"),
        ("dissipative", DAMPED, ["m*x_ddot + c*x_dot + k*x = 0"], "holds"),
        ("multiplier-holonomic", PENDULUM, ["(m*x_ddot - 2*lam*x)**2/(m*x_ddot - 2*lam*x) = 0"], "fails"),
        (
            "multiplier-holonomic",
            PENDULUM,
            [
                "m*x_ddot = 2*lam*x",
                f"m*y_ddot + m*g + ({SECOND_RATE})**2/({SECOND_RATE}) = 2*lam*y",
            ],
            "fails",
        ),
        ("multiplier-holonomic", PENDULUM, ["m*x_ddot = 2*lam*x", "m*y_ddot + m*g = 2*lam*y"], "holds"),
        ("multiplier-holonomic", PENDULUM, ["x_ddot/(y_ddot + g) = x/y"], "holds"),
        ("multiplier-holonomic", PENDULUM, ["x_ddot/(y_ddot + g) = y/x"], "fails"),
        ("linearisation", SMALL, ["(theta_ddot + g/l*theta)**2/(theta_ddot + g/l*theta) = 0"], "fails"),
        ("linearisation", SMALL, ["theta_ddot + g/l*theta = 0"], "holds"),
        (
            "routhian",
            ORBIT,
            ["m*r_ddot - p**2/(m*r**3) + (p - m*r**2*phi_dot)**2/(p - m*r**2*phi_dot) = 0"],
            "fails",
        ),
        ("routhian", ORBIT, ["m*r_ddot - p**2/(m*r**3) = 0"], "holds"),
        (
            "gibbs-appell",
            BLADE,
            [
                "m*u_dot + (x_dot*sin(th) - y_dot*cos(th))**2/(x_dot*sin(th) - y_dot*cos(th)) = 0",
                "J*w_dot = 0",
            ],
            "fails",
        ),
        ("gibbs-appell", BLADE, ["m*u_dot = 0", "J*w_dot = 0"], "holds"),
    ],
)
def test_an_equation_without_a_value_on_the_motions_is_true_of_none(kind, system, claim, due):
    assert said(kind, **system, claim=claim) == due


@pytest.mark.parametrize(
    ("kind", "system", "key", "answer", "due"),
    [
        ("kinetic-energy", BAR, "T", "m*x_dot**2 + (x - y)**2/(x - y)", "fails"),
        ("kinetic-energy", BAR, "T", "m*x_dot**2*(x_dot - y_dot)/(x_dot - y_dot)", "fails"),
        ("kinetic-energy", BAR, "T", "m*x_dot**2*(x + y)/(2*y)", "holds"),
        (
            "gibbs-appell",
            BLADE,
            "S",
            "m*u_dot**2/2 + J*w_dot**2/2 + (x_dot*sin(th) - y_dot*cos(th))**2/(x_dot*sin(th) - y_dot*cos(th))",
            "fails",
        ),
        ("gibbs-appell", BLADE, "S", "m*u_dot**2/2 + J*w_dot**2/2", "holds"),
        ("reaction", TABLE, "values", {"N": "m*g + y_ddot**2/y_ddot"}, "fails"),
        ("reaction", TABLE, "values", {"N": "m*g + m*y_ddot"}, "holds"),
        (
            "dissipative",
            DAMPED,
            "energy_rate",
            "-c*x_dot**2 + (m*x_ddot + c*x_dot + k*x)**2/(m*x_ddot + c*x_dot + k*x)",
            "fails",
        ),
        ("dissipative", DAMPED, "energy_rate", "x_dot*(m*x_ddot + k*x)", "holds"),
        (
            "routhian",
            ORBIT,
            "R",
            "m*r_dot**2/2*(p - m*r**2*phi_dot)/(p - m*r**2*phi_dot) - p**2/(2*m*r**2)",
            "fails",
        ),
        ("routhian", ORBIT, "R", "m*r_dot**2/2 - p**2/(2*m*r**2)", "holds"),
    ],
)
def test_an_answer_without_a_value_on_the_motions_is_none(kind, system, key, answer, due):
    assert said(kind, **system, **{key: answer}) == due


@pytest.mark.parametrize(
    ("equations", "due"),
    [
        (["(Q - q)**2/(Q - q)", "P - p"], "fails"),
        (["Q - q", "P - p"], "holds"),
        (["Q - q - h*(P + p)/2", "P - p + h*(Q**2 - q**2)/(Q - q)"], "holds"),
        (["Q - q - h*(P + p)/2", "P - p + h*(Q**2 - 2*q**2)/(Q - q)"], "fails"),
    ],
)
def test_equations_of_a_map_have_values_on_it(equations, due):
    map_ = {"q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "box": {"h": [0, 0.1]}}
    assert said("canonicity", **map_, parameters={"h": "positive"}, implicit=equations) == due


PHASE = {"q": ["q"], "p": ["p"], "H": "p**2/2 + q**2/2"}
OSCILLATOR = {"q": ["x"], "L": "x_dot**2/2 - x**2/2"}
CIRCLE = {"q": "sin(t)", "p": "cos(t)"}
BY_F = {"F": "q*P1", "type": 2, "new_q": ["Q1"], "new_p": ["P1"]}


@pytest.mark.parametrize(
    ("kind", "right", "beside", "key"),
    [
        ("conserved-or-not", {**PHASE, "conserved": ["p**2 + q**2"]}, {"Qnc": ["-p"]}, "Qnc"),
        ("conserved-or-not", {**PHASE, "conserved": ["p**2 + q**2"]}, {"x": ["z"]}, "x"),
        ("conserved-or-not", {**OSCILLATOR, "conserved": ["x_dot**2 + x**2"]}, {"p": ["p"]}, "p"),
        ("constant-of-motion", {**OSCILLATOR, "I": "x_dot**2 + x**2"}, {"p": ["p"]}, "p"),
        ("constant-of-motion", {"x": ["a"], "X": ["0"], "I": "a"}, {"q": ["b"]}, "q"),
        ("solution", {**PHASE, "solution": CIRCLE}, {"Qnc": ["-p"]}, "Qnc"),
        ("solution", {**OSCILLATOR, "solution": {"x": "sin(t)"}}, {"equations": ["x_ddot = 0"]}, "L"),
        ("solution", {**OSCILLATOR, "solution": {"x": "sin(t)"}}, {"p": ["p"]}, "p"),
        ("invariance", {"of": "poisson-brackets", "q": ["q"], "p": ["p"], **BY_F}, {"Q": ["2*q"]}, "Q"),
        ("canonicity", {"q": ["q"], "p": ["p"], "Q": ["q"], "P": ["p"]}, {"new_p": ["P1"]}, "new_p"),
        ("hamilton-equations", {**PHASE, "solution": CIRCLE}, {"p_dot": ["5"]}, "q_dot"),
    ],
)
def test_keys_of_another_way_of_saying_it_are_refused_by_name(kind, right, beside, key):
    assert said(kind, **right) == "holds"
    at, sentence = why_invalid(kind, **{**right, **beside})
    assert at == key
    assert "can't stand beside" in sentence or "would be passed over" in sentence


@pytest.mark.parametrize(("number", "F"), [(1, "q*Q1"), (2, "q*P1"), (3, "p*Q1"), (4, "p*P1")])
def test_generating_functions_of_all_four_types_are_judged(number, F):
    map_ = {"of": "poisson-brackets", "q": ["q"], "p": ["p"], "new_q": ["Q1"], "new_p": ["P1"], "F": F}
    assert said("invariance", **map_, type=number) == "holds"
    for other in (0, 5):
        key, sentence = why_invalid("invariance", **map_, type=other)
        assert key == "type"
        assert "should be 1, 2, 3 or 4" in sentence


def test_what_goes_together_still_does():
    forced = {**OSCILLATOR, "parameters": {"c": "positive"}, "Qnc": ["-c*x_dot"]}
    assert said("conserved-or-not", **forced, not_conserved=["x_dot**2 + x**2"]) == "holds"
    assert said("conserved-or-not", **forced, conserved=["x_dot**2 + x**2"]) == "fails"
    both = {"q_dot": ["p"], "p_dot": ["-q"], "solution": CIRCLE}
    assert said("hamilton-equations", **PHASE, **both) == "holds"
    assert said("hamilton-equations", **PHASE, **{**both, "p_dot": ["q"]}) == "fails"
    assert said("solution", q=["x"], equations=["x_ddot = 0"], solution={"x": "t"}) == "holds"
    assert said("solution", q=["x"], equations=["x_ddot = 1"], solution={"x": "t"}) == "fails"


def test_rates_in_quasi_velocities_need_their_names():
    body = {"q": ["x"], "parameters": SIGNS, "bodies": [{"m": "m", "r": ["x"]}]}
    assert said("gibbs-appell", **body, S="m*x_ddot**2/2") == "holds"
    assert said("gibbs-appell", **body, S="m*x_ddot**2/2", q_dot=["2*u"]) == "invalid"


@pytest.mark.parametrize(
    ("keys", "due"),
    [
        ({"p": ["p"], "Q": ["x*p"]}, "fails"),
        ({"p": ["p"], "Q": ["x**3 + t"]}, "holds"),
        ({"p": ["p"], "Q": ["x"], "P": ["3*p"]}, "invalid"),
        ({"Q": ["x**3 + t"]}, "holds"),
    ],
)
def test_momenta_stand_in_no_point_transformation(keys, due):
    assert said("invariance", of="lagrange-equations", q=["x"], **keys) == due


@pytest.mark.parametrize(
    ("claim", "due"),
    [
        ("> 3", "invalid"),
        (">= 3", "invalid"),
        (">3", "invalid"),
        ("> = 3", "invalid"),
        ("> > 3", "invalid"),
        ("⇒ > 3", "invalid"),
        ("Answer: > 3", "invalid"),
        ("$> 3$", "invalid"),
        ("> x = 3", "holds"),
        ("> x = 4", "fails"),
        ("⇒ 3", "holds"),
        ("-> 3", "holds"),
        ("3", "holds"),
    ],
)
def test_what_is_greater_than_a_number_is_not_the_number(claim, due):
    assert said("number", value="3", claim=claim) == due


def test_a_sign_of_greater_is_no_mark_of_an_expression():
    assert said("degrees-of-freedom", q=["x", "y"], dof="> 2") == "invalid"
    assert said("degrees-of-freedom", q=["x", "y"], dof="2") == "holds"
    assert said("equality-only", parameters={"x": "real"}, lhs="2*x", rhs="> x + x") == "invalid"
    assert said("equality-only", parameters={"x": "real"}, lhs="2*x", rhs="x + x") == "holds"
    system = {"q": ["q"], "p": ["p"], "parameters": SIGNS, "L": "m*q_dot**2/2 - k*q**2/2"}
    for sign, due in (("", "holds"), (">= ", "invalid"), ("> ", "invalid"), ("> H = ", "holds")):
        assert said("legendre-hamiltonian", **system, H=f"{sign}p**2/(2*m) + k*q**2/2") == due
    assert said("euler-lagrange", **SPRING, claim=["> m*x'' = -k*x"]) == "holds"
    assert said("euler-lagrange", **SPRING, claim=["> m*x'' = k*x"]) == "fails"
    assert said("euler-lagrange", **SPRING, claim=["> m*x'' + k*x"]) == "invalid"


@pytest.mark.parametrize(
    ("claim", "due"),
    [
        ("x ∈ [1, 3]", "invalid"),
        ("x ∈ (1, 3)", "invalid"),
        ("x ∈ ]1, 3[", "invalid"),
        ("x ∈ [sqrt(1); 3]", "invalid"),
        (r"$x \in \left[1, 3\right]$", "invalid"),
        ("x ∈ {1, 3}", "holds"),
        (r"$x \in \{1, 3\}$", "holds"),
        ("x ∈ {1, 4}", "fails"),
        ("x = [1, 3]", "holds"),
        ("x = [1, 4]", "fails"),
    ],
)
def test_a_range_is_not_its_two_ends(claim, due):
    assert said("number", value=["1", "3"], claim=claim) == due


@pytest.mark.parametrize(
    ("restrict", "I", "due"),
    [
        (["x_dot"], "x**3", "fails"),
        (["x*x_dot + y*y_dot"], "x**2 + y**2", "fails"),
        (["x", "x_dot"], "x*y", "fails"),
        (["x", "x_dot"], "y_dot**2/2 + y**4", "holds"),
        (["x", "x_dot"], "y_dot**2/2 + y**4 + x*y", "holds"),
        (["x", "x_dot"], "y_dot**2/2 - y**4", "fails"),
        (["x", "x_dot"], "x_dot", "holds"),
        (["x_dot"], "x_dot", "fails"),
        (["x_dot"], "y_dot", "fails"),
    ],
)
def test_what_follows_from_a_restriction_whatever_moves_it_says_nothing(restrict, I, due):
    system = {"q": ["x", "y"], "L": "(x_dot**2 + y_dot**2)/2 - x**2/2 - y**4"}
    assert said("constant-of-motion", **system, restrict=restrict, I=I) == due


FIELD = {**PLANE, "L": "m*(x_dot**2 + y_dot**2)/2 + c*(x*y_dot - y*x_dot)/2"}
CENTRAL = {
    "q": ["r", "phi"], "parameters": ORBIT["parameters"], "functions": {"V": ["r"]},
    "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 - V(r)",
}  # fmt: skip


@pytest.mark.parametrize(
    ("system", "claim", "due"),
    [
        (PLANE, ["m*(x_ddot + I*y_ddot) + k*(x + I*y) = 0"], "holds"),
        (PLANE, ["m*(x_ddot + I*y_ddot) + k*(x - I*y) = 0"], "fails"),
        (PLANE, ["(m*(x_ddot + I*y_ddot) + k*(x + I*y))*exp(I*x) = 0"], "holds"),
        (PLANE, ["m*x_ddot + k*x = 0", "I*(m*y_ddot + k*y) = 0"], "holds"),
        (PLANE, ["m*x_ddot + k*x = 0", "I*(m*y_ddot - k*y) = 0"], "fails"),
        (PLANE, ["m*x_ddot + I*x_ddot*y + k*x = 0", "m*y_ddot + k*y = 0"], "fails"),
        (FIELD, ["m*(x_ddot + I*y_ddot) = -I*c*(x_dot + I*y_dot)"], "holds"),
        (FIELD, ["m*(x_ddot + I*y_ddot) = I*c*(x_dot + I*y_dot)"], "fails"),
        (
            CENTRAL,
            [
                "exp(I*phi)*(m*(r_ddot - r*phi_dot**2 + I*(r*phi_ddot + 2*r_dot*phi_dot)) + Derivative(V(r), r)) = 0"
            ],
            "holds",
        ),
        (
            CENTRAL,
            [
                "exp(I*phi)*(m*(r_ddot - r*phi_dot**2 + I*(r*phi_ddot + r_dot*phi_dot)) + Derivative(V(r), r)) = 0"
            ],
            "fails",
        ),
    ],
)
def test_a_complex_equation_says_two_real_ones(system, claim, due):
    assert said("euler-lagrange", **system, claim=claim) == due


@pytest.mark.parametrize(
    ("kind", "system", "key", "answer", "factor"),
    [
        ("constant-of-motion", PHASE, "I", "(p**2 + q**2){}", "q_dot - p"),
        ("constant-of-motion", OSCILLATOR, "I", "(x_dot**2 + x**2){}", "x_ddot + x"),
        ("conserved-or-not", PHASE, "conserved", ["(p**2 + q**2){}"], "q_dot - p"),
        ("conserved-or-not", OSCILLATOR, "not_conserved", ["x_dot{}"], "x_ddot + x"),
        ("hamilton-equations", {**PHASE, "p_dot": ["-q"]}, "q_dot", ["p{}"], "q_dot - p"),
        ("hamilton-equations", PHASE, "solution", {"q": "sin(t){}", "p": "cos(t)"}, "q_dot - cos(t)"),
        ("solution", OSCILLATOR, "solution", {"x": "sin(t){}"}, "x - sin(t)"),
        ("solution", OSCILLATOR, "rates", {"x": "sqrt(1 - x**2){}"}, "x_dot - sqrt(1 - x**2)"),
        ("kinetic-energy", BAR, "T", "m*x_dot**2{}", "x_ddot - y_ddot"),
        ("legendre-hamiltonian", {"q": ["q"], "p": ["p"], "L": "q_dot**2/2"}, "H", "p**2/2{}", "p - q_dot"),
        (
            "generating-F2",
            {"q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "map": {"Q": ["q"], "P": ["p"]}},
            "F",
            "q*P{}",
            "p - P",
        ),
    ],
)
def test_what_cancels_has_a_value_on_the_motions(kind, system, key, answer, factor):
    def with_factor(said_so, by):
        if isinstance(said_so, str):
            return said_so.format(by)
        if isinstance(said_so, list):
            return [with_factor(each, by) for each in said_so]
        return {name: with_factor(each, by) for name, each in said_so.items()}

    for by, due in (
        ("", "holds"),
        (f"*({factor})/({factor})", "fails"),
        (f"*({factor} + 1)/({factor} + 1)", "holds"),
    ):
        assert said(kind, **system, **{key: with_factor(answer, by)}) == due
