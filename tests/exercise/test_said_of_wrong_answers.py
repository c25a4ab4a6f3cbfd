"""What is said of wrong answers of many kinds, and what is told as right; the right answer holds."""

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from

PHASE = {"q": ["q"], "p": ["p"]}
TO_NEW = {**PHASE, "new_q": ["Q"], "new_p": ["P"]}
GAUGE = {"q": ["x"], "L1": "x_dot**2/2", "relation": "gauge"}
STEP = {**PHASE, "parameters": {"h": "positive"}, "Q": ["q + h*p"]}
FOURIER = {**TO_NEW, "map": {"Q": ["p"], "P": ["-q"]}}
ENERGY = {**TO_NEW, "H": "(p**2 + q**2)/2"}
ANGLE = {"q": ["theta"], "p": ["J"], "H": "J + eps*cos(theta)", "small": "eps", "parameters": {"eps": "real"}}
SPRING = {
    "q": ["x"], "p": ["p"], "L": "m*x_dot**2/2 - k*x**2/2", "parameters": {"m": "positive", "k": "positive"},
    "dimensions": {"m": "mass", "x": "length", "k": "kg/s^2"},
}  # fmt: skip
FALL = {
    **SPRING, "L": "m*x_dot**2/2 - k*x**2/2 - m*g*x", "parameters": {**SPRING["parameters"], "g": "positive"},
    "dimensions": {**SPRING["dimensions"], "g": "acceleration"},
}  # fmt: skip
FREE = {
    **PHASE,
    "H": "p**2/(2*m)",
    "parameters": {"m": "positive"},
    "dimensions": {"m": "mass", "q": "length"},
}
OSCILLATOR = {"q": ["x"], "L": "x_dot**2/2 - x**2/2", "constants": ["a", "b"]}
MANY = {"q": [f"q{i}" for i in range(1, 7)], "p": [f"p{i}" for i in range(1, 7)]}
RIGHT_ENERGY = "p**2/(2*m) + k*x**2/2"
THREE_OF_SIX = (
    "in equation 1 the term 2*x1 should be half that; in equation 2 the term 3*x2 should be 1/3 times that; "
    "in equation 3 the term 4*x3 should be 1/4 times that; 3 more components are wrong"
)
FORCE = "has the dimension of force"
OF_A_COSINE = "x has the dimension of length, and in cos(x) only a pure number makes sense"
WORK = "has the dimension of energy or torque"


def of_each(n, value):
    return [{"f": f"q{i}**2", "g": f"p{i}", "value": value(i)} for i in range(1, n + 1)]


def oscillators(strength):
    L = " + ".join(f"(x{i}_dot**2 - x{i}**2)/2" for i in range(1, 7))
    return {
        "q": [f"x{i}" for i in range(1, 7)], "L": L,
        "claim": [f"x{i}_ddot + {strength(i)}*x{i}" for i in range(1, 7)],
    }  # fmt: skip


SAID = [
    ("lagrangian-equivalence", {**GAUGE, "L2": "x_dot**2/2 + x*x_dot", "F": "sin(x)"}, {"F": "x**2/2"},
     "L2 − L1 is dF/dt of some F(q, t), but not of this one", ""),
    ("lagrangian-equivalence", {**GAUGE, "L2": "x_dot**2/2 + x**2*x_dot + x", "F": "x**3/3"},
     {"L2": "x_dot**2/2 + x**2*x_dot"}, "in L2 the term x does not belong", "L2 = x**2*x_dot + x_dot**2/2"),
    ("canonicity", {**STEP, "P": ["p - h*q"]}, {"P": ["p - h*(q + h*p)"]},
     "in Q the new momenta P belong in place of the old ones", "Q = h*(-h*q + p) + q"),
    ("canonicity", {**PHASE, "Q": ["2*q"], "P": ["p"], "dimensions": {"q": "length", "p": "momentum"}}, {"P": ["p/2"]},
     "canonical with valence 2, not 1: {Q, P} = 2; multiply P by 1/2", "P = p/2"),
    ("bilinear-covariant", {**PHASE, "Q": ["2*q"], "P": ["3*p"], "factor": "5"}, {"factor": "6"},
     "the factor is 6, not 5", "the coefficient of δp dq − dp δq = 6"),
    ("bilinear-covariant", {**PHASE, "Q": ["q**2"], "P": ["p"], "factor": "2"}, {"P": ["p/q"]},
     "in P the term p should be divided by q", "the coefficient of δp dq − dp δq = 2*q"),
    ("euler-lagrange", {"q": ["x", "y"], "L": "((x_dot + y_dot)**2 - (x + y)**2)/2",
                        "claim": ["x_ddot + y_ddot + 2*(x + y)"]},
     {"claim": ["x_ddot + y_ddot + x + y"]},
     "equation 1 of motion does not follow from the claimed ones: x + x_ddot + y + y_ddot = 0",
     "x + x_ddot + y + y_ddot = 0; x + x_ddot + y + y_ddot = 0"),
    ("euler-lagrange", oscillators(lambda i: i + 1), oscillators(lambda i: 1),
     THREE_OF_SIX,
     "; ".join(f"x{i} + x{i}_ddot = 0" for i in range(1, 7))),
    ("poisson-bracket", {**MANY, "pairs": of_each(6, lambda i: f"q{i}")}, {"pairs": of_each(6, lambda i: f"2*q{i}")},
     "; ".join(f"{{f, g}} of pair {i} should be twice what it is" for i in (1, 2, 3)) + "; 3 more components are wrong",
     "; ".join(f"{{f, g}} of pair {i} = 2*q{i}" for i in (1, 2, 3))),
    ("constant-of-motion", {**PHASE, "H": "p**2/2 + q**2/2", "I": "3"}, {"I": "p**2 + q**2"},
     "this says nothing about the motion: what does not depend on the state is true of any system", ""),
    ("constant-of-motion", {**FREE, "I": "3"}, {"I": "p"},
     "this says nothing about the motion: what does not depend on the state is true of any system", ""),
    ("transformed-hamiltonian-K", {**ENERGY, "map": {"Q": ["atan2(q, p)"], "P": ["(p**2 + q**2)/2"]}, "K": "2*P"},
     {"K": "P"}, "K should be half what it is", "K = P"),
    ("transformed-hamiltonian-K", {**ENERGY, "map": {"Q": ["q"], "P": ["p + q**2"]}, "K": "(P - Q**2)**2/2 + Q**2"},
     {"K": "(P - Q**2)**2/2 + Q**2/2"}, "in K the term Q**2 should be half that", "K = Q**2/2 + (-Q**2 + P)**2/2"),
    ("generating-F1", {**FOURIER, "F": "q*Q**2/2"}, {"F": "q*Q"},
     "in F the term Q**2*q/2 lacks the factor 2/Q", "Q*q"),
    ("generating-F1", {**FOURIER, "F": "q*Q", "map": {"Q": ["p"], "P": ["-2*q"]}}, FOURIER,
     "P should be half what it is", "P = -q"),
    ("generating-F1", {**FOURIER, "F": "q + Q"}, {"F": "q*Q"}, "", "Q*q"),
    ("generating-F1", {**FOURIER, "F": "q", "map": {"Q": ["q"], "P": ["p"]}}, {**FOURIER, "F": "q*Q"}, "", ""),
    ("generating-first-order", {**ANGLE, "new_p": ["P"], "F2": "-theta*P - eps*sin(theta)"},
     {"F2": "theta*P - eps*sin(theta)"},
     "right under the opposite sign convention; the convention here is K = H + ε {H, W}, or F2 = Σ q P + ε S", ""),
    ("hamilton-equations", {**FREE, "q_dot": ["0"], "p_dot": ["p/m"]}, {"q_dot": ["p/m"], "p_dot": ["0"]},
     "the equations of q and p are exchanged", "p/m; 0"),  # zero has any dimension
    ("solution", {**OSCILLATOR, "solution": {"x": "a*cos(t) + b*sin(2*t)"}}, {"solution": {"x": "a*cos(t) + b*sin(t)"}},
     "in the solution for x sin(2*t) should be sin(t)", "x = a*cos(t) + b*sin(t)"),
    ("legendre-hamiltonian", {**SPRING, "H": "p**2/(2*m) + k*x**2"}, {"H": RIGHT_ENERGY},
     "in H the term k*x**2 should be half that", "k*x**2/2 + p**2/(2*m)"),
    ("legendre-hamiltonian", {**SPRING, "H": "p**2/(2*m) + k*x"}, {"H": RIGHT_ENERGY},
     f"in H the term k*x lacks the factor x/2; k*x {FORCE}, and p**2/(2*m) {WORK}: one of them is wrong",
     "k*x**2/2 + p**2/(2*m)"),
    ("legendre-hamiltonian", {**SPRING, "H": "p**2/(2*m) + cos(x)"}, {"H": RIGHT_ENERGY},
     f"in H the term k*x**2/2 is missing, and the term cos(x) does not belong; {OF_A_COSINE}", "k*x**2/2 + p**2/(2*m)"),
    ("legendre-hamiltonian", {**SPRING, "H": "p/m"}, {"H": RIGHT_ENERGY},
     f"H has the dimension of velocity, and the right one {WORK}", "k*x**2/2 + p**2/(2*m)"),
    ("legendre-hamiltonian", {**FALL, "H": f"{RIGHT_ENERGY} + m*g"}, {"H": f"{RIGHT_ENERGY} + m*g*x"},
     f"in H the term g*m lacks the factor x; g*m {FORCE}, the other terms have {WORK[4:]}: one of them is wrong",
     "g*m*x + k*x**2/2 + p**2/(2*m)"),
]  # fmt: skip


def judged(kind, keys):
    claim = claim_from({"id": "a", "kind": kind, **keys})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


@pytest.mark.parametrize(("kind", "wrong", "mended", "said", "right"), SAID)
def test_what_is_said_and_what_is_told_as_right(kind, wrong, mended, said, right):
    found = judged(kind, wrong)
    assert (found.status, found.feedback, found.corrected) == ("fails", said, right)
    assert judged(kind, {**wrong, **mended}).status == "holds"


@pytest.mark.parametrize(("kind", "keys", "share"), [
    ("poisson-bracket", {**MANY, "pairs": of_each(4, lambda i: f"{1 + (i > 1)}*q{i}")}, 0.75),
    ("hamilton-equations", {**PHASE, "H": "p**2/2 + q**2/2", "q_dot": ["p"], "p_dot": ["q"]}, 0.5),
    ("hamilton-equations", {**PHASE, "H": "p**2/2 + q**2/2", "q_dot": ["p**3"], "p_dot": ["q*sin(q)"]}, 0.0),
    ("solution", {**OSCILLATOR, "solution": {"x": "a*cos(t) + b*sin(2*t)"}}, 0.5),
    ("constant-of-motion", {**PHASE, "H": "p**2/2 + q**2/2", "I": "p*exp(sin(q))"}, 0.0),
    ("hamilton-equations", {**PHASE, "H": "p**2/2 + q**2/2", "q_dot": ["-q"], "p_dot": ["p"]}, 0.0),
    ("canonicity", {**PHASE, "Q": ["2*q"], "P": ["p"]}, 0.5),
])  # fmt: skip
def test_the_share_of_a_wrong_answer_that_is_right(kind, keys, share):
    assert judged(kind, {**keys, "points": 4, "partial": True}).share == share
