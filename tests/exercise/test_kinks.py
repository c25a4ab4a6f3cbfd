"""|u|, sign(u), Max and pieces in what is differentiated: nothing is claimed at the kink, everything beside it."""

import pytest

from canon.exercise.feedback import corrected
from canon.exercise.judge import examine
from canon.exercise.sheet import Claim

RIGHT = [
    (
        "legendre-hamiltonian",
        {"q": "x", "p": "p", "L": "x_dot**2/2 + Abs(x_dot)"},
        "H",
        "(Abs(p) - 1)**2/2",
        "p**2/2",
    ),
    (
        "routhian",
        {
            "q": ["x", "y"],
            "cyclic": "y",
            "momenta": "b",
            "convention": "L-pq",
            "L": "(x_dot**2 + y_dot**2)/2 + Abs(y_dot)",
        },
        "R",
        "x_dot**2/2 - (Abs(b) - 1)**2/2",
        "x_dot**2/2 - b**2/2",
    ),
    (
        "dissipative",
        {"q": "x", "L": "x_dot**2/2", "F": "Max(x_dot, 0)"},
        "energy_rate",
        "-Max(x_dot, 0)",
        "-x_dot",
    ),
    ("euler-lagrange", {"q": "x", "L": "x_dot*Abs(x_dot)"}, "claim", "x_ddot", "x_ddot + x"),
    (
        "euler-lagrange",
        {"q": ["r", "f"], "L": "(r_dot**2 + r**2*f_dot**2)/2"},
        "claim",
        ["r_ddot - r*f_dot**2", "Abs(r)*f_ddot + 2*r_dot*f_dot*sign(r)"],
        ["r_ddot - r*f_dot**2", "Abs(r)*f_ddot + 2*r_dot*f_dot"],
    ),
    ("lie-bracket", {"x": "x", "X": "sign(x)", "Y": "x**2"}, "claim", "2*x*sign(x)", "-2*x*sign(x)"),
    (
        "poisson-bracket",
        {"q": "q", "p": "p"},
        "pairs",
        [{"f": "q*sign(q)", "g": "p", "value": "sign(q)"}],
        [{"f": "q*sign(q)", "g": "p", "value": "-sign(q)"}],
    ),
    (
        "constant-of-motion",
        {"q": "q", "p": "p", "parameters": {"q": "positive"}, "H": "p**2*q**2/2", "domain": ["Ne(p, 0)"]},
        "I",
        "q*p*sign(p)",
        "q*sign(p)",
    ),
    ("canonicity", {"q": "q", "p": "p", "Q": "q*sign(q)"}, "P", "p*sign(q)", "p"),
]


@pytest.mark.parametrize(
    ("kind", "keys", "key", "right", "wrong"), RIGHT, ids=[f"{r[0]}-{r[3]}"[:50] for r in RIGHT]
)
def test_beside_the_kink(kind, keys, key, right, wrong):
    assert examine(Claim("a", kind, {**keys, key: right})).verdict.holds
    finding = examine(Claim("a", kind, {**keys, key: wrong}))
    assert finding.verdict.fails
    assert "DiracDelta" not in corrected(finding) + finding.verdict.feedback


def test_a_factor_that_vanishes_on_a_piece_is_no_equation():
    keys = {"q": ["r", "f"], "L": "(r_dot**2 + r**2*f_dot**2)/2"}
    claim = ["r_ddot - r*f_dot**2", "(Abs(r) + r)*(r*f_ddot + 2*r_dot*f_dot)"]
    assert not examine(Claim("a", "euler-lagrange", {**keys, "claim": claim})).verdict.holds


def test_a_sign_alone_is_still_no_constant():
    keys = {"q": "q", "p": "p", "H": "p**2/2 + q**2/2", "domain": ["Ne(p, 0)"]}
    assert not examine(Claim("a", "constant-of-motion", {**keys, "I": "sign(p)"})).verdict.holds


@pytest.mark.parametrize("sign", ["+", "-"])
def test_conditions_on_functions_in_equations_of_motion(sign):
    keys = {"q": "x", "functions": {"V": ["x"]}, "L": "V(x)*x_dot**2/2", "domain": ["V(x) > 0"]}
    claim = f"V(x)*x_ddot {sign} Derivative(V(x), x)*x_dot**2/2"
    verdict = examine(Claim("a", "euler-lagrange", {**keys, "claim": claim})).verdict
    assert (verdict.holds, verdict.fails) == (sign == "+", sign == "-")
