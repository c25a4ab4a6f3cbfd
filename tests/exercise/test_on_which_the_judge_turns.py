"""What the judges of several kinds decide, what they leave undecided and why: each beside its neighbours."""

import pytest
import sympy as sp

from canon.exercise.claim_verdict import examine
from canon.exercise.judges.energy_and_force import LONGEST_REDUCED, shown_short
from canon.exercise.sheet.reading import InvalidClaim
from canon.exercise.sheet.sheet import claim_from

TORUS = {"q": ["q"], "p": ["p"], "parameters": {"E": "positive", "w": "positive"}}
SLOW = {
    "q": ["theta", "x"], "p": ["J", "y"], "small": "eps", "angles": ["theta"], "order": 2,
    "H": "J**2/2 + eps*(x**2 + y**2)/2 + eps*x*cos(theta)", "parameters": {"eps": "real"},
}  # fmt: skip
NO_MEAN = {**SLOW, "H": "J + eps*(x**2 + y**2)/2 + eps*x*cos(theta)"}
TWO = {
    "q": ["x", "y"], "p": ["px", "py"], "actions": ["I", "J"], "degree": 4, "K": "a*I + b*J + I*J",
    "H": "a*(px**2 + x**2)/2 + b*(py**2 + y**2)/2 + x**2*y**2",
    "parameters": {"a": "positive", "b": "positive", "c": "real"},
}  # fmt: skip
SMALL = {"small": "e", "parameters": {"e": "real", "a": "real"}}
FIRST_ORDER = {"q": ["x", "y"], "L": "x*y_dot - x**2/2 - y**2/2"}
RATE = {"q": ["z"], "equations": ["z_ddot - (t*cos(t) - sin(t))/t**2"], "rates": {"z": "sin(t)/t"}}
BRACKET = {"of": "poisson-bracket", "q": ["q"], "p": ["p"], "find": ["n"]}
WHOLE = {**BRACKET, "pairs": [{"f": "q*n*cos(2*pi*n)", "g": "p", "value": "n*cos(2*pi*n)"}],
         "parameters": {"n": "integer", "q": "positive"}}  # fmt: skip
SQUARES = {
    "of": "constant-of-motion", "q": ["q"], "p": ["p"], "H": "p**2/2 + b**2*q**2/2", "I": "p**2 + a**2*q**2",
    "find": ["a"], "parameters": {"a": "real", "b": "real"},
}  # fmt: skip

DECIDED = [
    ("action-angle", {**TORUS, "H": "p**2/2 + w**2*q**2/2", "J": ["E/w"]}, "holds", ""),
    ("action-angle", {**TORUS, "H": "p**2/2 + w**2*q**2/2", "J": ["E/w"], "domain": ["Eq(q, 0)", "Eq(p, 0)"]},
     "undecided", "bounded motions were found through 0 of 24 points of the domain only; narrow it"),
    ("action-angle", {**TORUS, "H": "p**2/2 + V(q)", "functions": {"V": ["q"]}, "J": ["E/w"]},
     "undecided", "H holds a function of the coordinates that is not given, so its actions are not known"),
    ("frequency", {**TORUS, "H": "p**2/2 + q**4/4 + q**6", "omega": ["1"]}, "fails", ""),  # no closed form is known
    ("averaged-hamiltonian", {**NO_MEAN, "K": "J + eps*(x**2 + y**2)/2"}, "holds", ""),
    ("averaged-hamiltonian", {**NO_MEAN, "K": "J + eps*(x**2 + y**2)/3"}, "fails", ""),
    ("averaged-hamiltonian", {**SLOW, "K": "J**2/2 + eps*(x**2 + y**2)/2"},
     "undecided", "to order 1 K is right; beyond, it depends on which generator is taken"),
    ("averaged-hamiltonian", {**SLOW, "K": "J**2/2 + eps*(x**2 + y**2)/3"}, "fails", ""),
    ("normal-form", {**TWO, "domain": ["Eq(sin(c), cos(c**2))"]}, "holds", ""),  # of what does not stand in H
    ("normal-form", {**TWO, "domain": ["Eq(c, 1)"], "K": "a*I + b*J + 2*I*J"}, "fails", ""),
    ("normal-form", {**TWO, "domain": ["Eq(sin(a), cos(b))"]},
     "undecided", "the domain ties parameters, sin(a) - cos(b) = 0: write their values into H"),
    ("normal-form", {**TWO, "domain": ["Eq(a**2 + a*b, b**3 + b)"]},
     "undecided", "the domain ties parameters, a**2 + a*b - b**3 - b = 0: write their values into H"),
    ("normal-form", {**TWO, "domain": ["Eq(sin(a), b)"]}, "undecided", "write a parameter for it"),
    ("first-order", {**SMALL, "exact": "a + e", "claim": "a + e", "domain": ["Ne(e, 0)"]}, "holds", ""),
    ("first-order", {**SMALL, "exact": "a + e", "claim": "a + 2*e", "domain": ["Ne(e, 0)"]}, "fails", ""),
    ("first-order", {**SMALL, "exact": "a + e", "claim": "a + e", "domain": ["Eq(e, 0)"]},
     "undecided", "the domain keeps what is small at one value; leave that condition out"),
    ("euler-lagrange", {**FIRST_ORDER, "claim": ["x_dot = -y", "y_dot = x"]}, "holds", ""),
    ("euler-lagrange", {**FIRST_ORDER, "claim": ["x_dot = y", "y_dot = -x"]}, "fails", ""),
    ("euler-lagrange", {"q": ["x"], "L": "x_dot*x**2 - x**3", "claim": ["x**2"]},
     "undecided", "the equations bind the state in a way that is not affine; solve them for the velocities"),
    ("solution", {**RATE, "initial": {"z": "0"}}, "undecided", "z_dot at the start is a limit, which is not taken"),
    ("solution", {**RATE, "initial": {"z": "0", "z_dot": "sin(1)"}, "t0": "1"}, "holds", ""),
    ("solution", {**RATE, "initial": {"z": "0", "z_dot": "cos(1)"}, "t0": "1"}, "fails", ""),
    ("parameters", {**WHOLE, "values": [{"n": "sqrt(4 + 2*sqrt(3)) - sqrt(3) + 1/2"}]}, "fails", ""),  # 3/2
    ("parameters", {**SQUARES, "values": [{"a": "abs(b)"}, {"a": "-abs(b)"}]}, "holds", ""),
    ("parameters", {**SQUARES, "values": [{"a": "abs(b)"}]}, "fails", ""),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "keys", "status", "said"), DECIDED)
def test_what_is_decided_and_what_is_not(kind, keys, status, said):
    verdict = examine(claim_from({"id": "a", "kind": kind, **keys})).verdict
    assert verdict.status.value == status
    assert said in " ".join(evidence.text for evidence in verdict.evidence)


def test_a_value_that_is_no_whole_number_is_told():
    keys = {**WHOLE, "values": [{"n": "sqrt(4 + 2*sqrt(3)) - sqrt(3) + 1/2"}]}
    told = examine(claim_from({"id": "a", "kind": "parameters", **keys}))
    assert told.verdict.feedback.endswith("is no whole number")


def test_only_kinds_whose_claims_have_parameters_are_asked_for_them():
    with pytest.raises(InvalidClaim, match=r"should be one of canonicity, .*, jacobi-identity$"):
        examine(
            claim_from({"id": "a", "kind": "parameters", **SQUARES, "of": "euler-lagrange", "values": []})
        )


def test_long_answers_are_shown_as_they_were_found():
    x, y = sp.symbols("x y")
    product = (sp.sin(x) ** 2 + sp.cos(x) ** 2) * (x + y) ** 2
    assert shown_short(product) == x**2 + 2 * x * y + y**2
    long = sp.Mul(*(x + k * y for k in range(1, LONGEST_REDUCED)))
    assert shown_short(long) is long
