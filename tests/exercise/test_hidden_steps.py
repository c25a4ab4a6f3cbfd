"""Steps that derivatives do not show, in claims: constant slopes, roots and poles that make a sign, singular pieces.

Each false claim stands beside right ones of the same form, which stay decided. The functions are recomputed by hand:
sqrt(q − 1) sqrt(q + 1)/sqrt(q² − 1) is 1 for q > −1 and −1 for q < −1; q sqrt(1 + 1/q²)/sqrt(1 + q²) is the sign of q;
the factor x sqrt(1 + 1/x²) − sqrt(1 + x²) is 0 for all x > 0.
"""

import pytest

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim

ROOTS = "sqrt(q - 1)*sqrt(q + 1)/sqrt(q**2 - 1)"
POLES, POLES_OF_X, POLES_OF_T, POLES_OF_Q = (f"{x}*sqrt(1 + 1/{x}**2)/sqrt(1 + {x}**2)" for x in "qxtQ")
FREE = {"q": ["q"], "p": ["p"], "H": "p**2/2"}
FREE_L = {"q": ["x"], "L": "x_dot**2/2"}
SAME = {"q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "map": {"Q": ["q"], "P": ["p"]}}
STEP = "Piecewise((2, x > 1), (0, True))"
VOID = "(x*sqrt(1 + 1/x**2) - sqrt(1 + x**2))"
NONZERO = {"q": ["x"], "parameters": {"x": "nonzero"}, "L": "x_dot**2/2 - x**2/2"}
BLADE = {"q": ["x", "y"], "parameters": {"m": "positive", "k": "positive"},
         "L": "m*(x_dot**2 + y_dot**2)/2 - k*x", "multipliers": ["lam"]}  # fmt: skip


def status(kind, **keys):
    return judge(Claim("a", kind, keys)).status.value


@pytest.mark.parametrize(
    ("kind", "keys"),
    [
        ("constant-of-motion", {**FREE, "I": f"p*{ROOTS}"}),
        ("constant-of-motion", {**FREE, "I": f"p*{POLES}"}),
        ("constant-of-motion", {**FREE, "I": "p*(log(-q) - log(q))/(I*pi)"}),
        ("constant-of-motion", {**FREE, "I": "p*sqrt(-q)/(sqrt(q)*I)"}),
        ("constant-of-motion", {"q": ["q"], "p": ["p"], "H": f"p**2/2 + {ROOTS}/4", "I": "p"}),
        ("constant-of-motion", {"q": ["q"], "p": ["p"], "H": f"p**2/2 + {POLES}", "I": "p"}),
        ("conserved-or-not", {**FREE_L, "conserved": [f"x_dot*{POLES_OF_X}"]}),
        ("hamilton-jacobi", {**FREE, "constants": ["E"], "parameters": {"E": "positive"},
                             "gradient": [f"sqrt(2*E)*{POLES}"]}),
        ("solution", {**FREE_L, "rates": {"x": f"v*{POLES_OF_X}"}, "constants": ["v"]}),
        ("solution", {**FREE_L, "parameters": {"A": "positive"},
                      "solution": {"x": f"A*t*{POLES_OF_T}"}}),
        ("generating-F2", {**SAME, "F": f"q*P + {POLES}"}),
        ("transformed-hamiltonian-K", {**SAME, "H": "p**2/2", "K": f"P**2/2 + {POLES_OF_Q}"}),
        ("lagrangian-equivalence", {"q": ["x"], "L1": "x_dot**2/2", "L2": "x_dot**2/2 + x_dot",
                                    "relation": "gauge", "F": f"x + {POLES_OF_X}"}),
        ("lagrangian-equivalence", {"q": ["x"], "L1": "x_dot**2/2", "L2": "x_dot**2/2 - x_dot*(1 - tanh(1/x)**2)/x**2",
                                    "relation": "gauge", "F": "tanh(1/x)"}),
        ("action-angle", {"q": ["q"], "p": ["p"], "H": "(p**2 + q**2)/2", "new_q": ["theta"], "new_p": ["J"],
                          "transformation": {"theta": f"atan2(q, p) + {POLES}/2", "J": "(p**2 + q**2)/2"}}),
        ("poisson-bracket", {"q": ["q"], "p": ["p"], "domain": ["atan(tan(q)) > 1/4"],
                             "pairs": [{"f": "q", "g": "Abs(q)*p", "value": "q"}]}),
        ("euler-lagrange", {"q": ["x"], "domain": [f"x + {STEP} > 2"],
                            "L": "x_dot**2/2 - Abs(x - 2)**3/3", "claim": ["x'' + (x - 2)**2 = 0"]}),
        ("lagrangian-equivalence", {"q": ["x"], "L1": "x_dot**2/2", "L2": "x_dot**2/2 + atan(tan(x_dot))",
                                    "relation": "gauge"}),
        ("differential", {"x": ["q", "p"], "f": "q*p", "claim": "p*atan(tan(d_q)) + q*d_p"}),
        ("differential", {"x": ["q", "p"], "f": "q*p", "claim": "p*d_q + q*d_p + Piecewise((5, d_q > 1), (0, True))"}),
        ("constraint-class", {"q": ["x", "y"], "constraints": ["y_dot = atan(tan(x_dot))"], "class": ["holonomic"]}),
        ("degrees-of-freedom", {"q": ["x", "y"], "constraints": ["y_dot = atan(tan(x_dot))"], "dof": "1",
                                "counting": "positions"}),
        ("euler-lagrange", {**NONZERO, "claim": [f"{VOID}*(x'' + x) = 0"]}),
        ("euler-lagrange", {**NONZERO, "claim": ["(atan(1/x) + atan(x) - pi/2)*(x'' + x) = 0"]}),
        ("equality-only", {"parameters": {"x": "nonzero"}, "lhs": "x*sign(atan(1/x) + atan(x) - pi/2)**2", "rhs": "x"}),
        ("legendre-hamiltonian", {"q": ["x"], "p": ["p"], "L": "(1 + sign(x))*x_dot**2/2", "exists": True}),
        ("canonicity", {"q": ["q"], "p": ["p"], "parameters": {"k": "real"}, "Q": ["(k + Abs(k))*q"], "P": ["p"],
                        "valence": "k + Abs(k)"}),
        ("solution", {"q": ["x"], "equations": ["x'' + x = 0"], "solution": {"x": "(A + Abs(A))*cos(t) + B*sin(t)"},
                      "constants": ["A", "B"]}),
        ("invariance", {"of": "lagrange-brackets", "q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"],
                        "F": "Max(q, 0)*P", "type": 2}),
        ("nonholonomic", {**BLADE, "constraints": ["y*(x_dot - y_dot)"], "claim": ["2*m*x'' + k = 0"]}),
    ],
)  # fmt: skip
def test_a_step_that_is_hidden_does_not_hold(kind, keys):
    assert status(kind, **keys) in ("fails", "undecided")


@pytest.mark.parametrize(
    ("kind", "keys"),
    [
        ("constant-of-motion", {**FREE, "I": "p*sqrt(1 + p**2)"}),
        ("constant-of-motion", {"q": ["q"], "p": ["p"], "H": "p**2/2 - k/sqrt(1 + 1/q**2)",
                                "parameters": {"k": "positive"},
                                "I": "p**2 - 2*k*Abs(q)/sqrt(1 + q**2)"}),
        ("constant-of-motion", {**FREE, "parameters": {"q": "positive"}, "I": "p*sqrt(1 + 1/q**2)*q/sqrt(1 + q**2)"}),
        ("constant-of-motion", {"q": ["q"], "p": ["p"], "H": "p*q", "parameters": {"q": "positive", "p": "positive"},
                                "I": "t - log(q)"}),
        ("constant-of-motion", {"q": ["x", "y"], "p": ["px", "py"], "H": "(px**2 + py**2)/2 - 1/sqrt(x**2 + y**2)",
                                "I": "py*(x*py - y*px) - x/sqrt(x**2 + y**2)"}),
        ("hamilton-jacobi", {**FREE, "H": "p**2/2 + q**2/2", "constants": ["E"], "parameters": {"E": "positive"},
                             "gradient": ["sqrt(2*E - q**2)"]}),
        ("hamilton-jacobi", {**FREE, "H": "p**2/2 + q**2/2", "constants": ["E"], "parameters": {"E": "positive"},
                             "W": "q*sqrt(2*E - q**2)/2 + E*asin(q/sqrt(2*E))"}),
        ("solution", {**FREE_L, "rates": {"x": "v"}, "constants": ["v"]}),
        ("solution", {"q": ["x"], "equations": ["4*x**3*x'' + 1 = 0"], "solution": {"x": "sqrt(t)"}}),
        ("generating-F2", {**SAME, "F": "q*P"}),
        ("generating-F3", {"q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "F": "-p*Q*Abs(Q)",
                           "map": {"Q": ["sign(q)*sqrt(Abs(q))"], "P": ["2*p*sqrt(Abs(q))"]}}),
        ("transformed-hamiltonian-K", {**SAME, "H": "p**2/2", "K": "P**2/2"}),
        ("lagrangian-equivalence", {"q": ["x"], "L1": "x_dot**2/2", "L2": "x_dot**2/2 + x_dot/(2*sqrt(x))",
                                    "relation": "gauge", "F": "sqrt(x)", "parameters": {"x": "positive"}}),
        ("lagrangian-equivalence", {"q": ["x"], "L1": "x_dot**2/2", "L2": "(x_dot + 1)**2/2 - x*x_dot",
                                    "relation": "gauge"}),
        ("lagrangian-equivalence", {"q": ["x"], "L1": "0", "L2": "sign(x)*x_dot", "relation": "gauge"}),
        ("lagrangian-equivalence", {"q": ["x"], "L1": "0", "L2": "x_dot*sign(x_dot)", "relation": "gauge",
                                    "domain": ["x_dot > 2"]}),
        ("action-angle", {"q": ["q"], "p": ["p"], "H": "(p**2 + q**2)/2", "new_q": ["theta"], "new_p": ["J"],
                          "transformation": {"theta": "atan2(q, p)", "J": "(p**2 + q**2)/2"}}),
        ("poisson-bracket", {"q": ["q"], "p": ["p"], "domain": ["2*q > 1/4"],
                             "pairs": [{"f": "q", "g": "Abs(q)*p", "value": "q"}]}),
        ("euler-lagrange", {"q": ["x"], "domain": ["2*x - 4 > 0"],
                            "L": "x_dot**2/2 - Abs(x - 2)**3/3", "claim": ["x'' + (x - 2)**2 = 0"]}),
        ("differential", {"x": ["q", "p"], "f": "q*p", "claim": "p*d_q + q*d_p"}),
        ("differential", {"x": ["q", "p"], "f": "q**2*p", "claim": "q*(2*p*d_q + q*d_p)"}),
        ("constraint-class", {"q": ["x", "y"], "constraints": ["y_dot = 2*x_dot"], "class": ["holonomic"]}),
        ("degrees-of-freedom", {"q": ["x", "y"], "constraints": ["y_dot = 2*x_dot"], "dof": "1",
                                "counting": "positions"}),
        ("euler-lagrange", {**NONZERO, "claim": ["(x'' + x)/x = 0"]}),
        ("euler-lagrange", {**NONZERO, "claim": ["sqrt(1 + 1/x**2)*(x'' + x) = 0"]}),
        ("equality-only", {"parameters": {"x": "nonzero"}, "lhs": "x*sign(x)**2", "rhs": "x"}),
        ("legendre-hamiltonian", {"q": ["x"], "p": ["p"], "L": "(2 + sign(x))*x_dot**2/2", "exists": True}),
        ("canonicity", {"q": ["q"], "p": ["p"], "parameters": {"k": "positive"}, "Q": ["(k + Abs(k))*q"], "P": ["p"],
                        "valence": "k + Abs(k)"}),
        ("solution", {"q": ["x"], "equations": ["x'' + x = 0"], "solution": {"x": "(A + 2*Abs(A))*cos(t) + B*sin(t)"},
                      "constants": ["A", "B"]}),
        ("nonholonomic", {**BLADE, "constraints": ["x_dot - y_dot"], "claim": ["2*m*x'' + k = 0"]}),
        ("nonholonomic", {**BLADE, "constraints": ["m*(x_dot - y_dot)"], "claim": ["2*m*x'' + k = 0"]}),
        ("nonholonomic", {**BLADE, "constraints": ["y*(x_dot - y_dot)"], "domain": ["y > 0"],
                          "claim": ["2*m*x'' + k = 0"]}),
    ],
)  # fmt: skip
def test_right_answers_of_the_same_form_stay_decided(kind, keys):
    assert status(kind, **keys) == "holds"


@pytest.mark.parametrize("domain", [[], ["x > 0"]])
def test_a_right_answer_is_not_refuted_outside_the_domain(domain):
    step = {"parameters": {"x": "real"}, "domain": [f"x + {STEP} = 4", *domain]}
    assert status("equality-only", **step, lhs="x", rhs="2") != "fails"
    below = ["x + Piecewise((3, x < 0), (0, True)) < 2", "x > -1", *domain]
    assert status("equality-only", parameters={"x": "real"}, domain=below, lhs="Abs(x)", rhs="x") != "fails"
