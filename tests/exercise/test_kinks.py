"""Claims about derivatives of moduli, maxima and pieces: kinks are outside of them, and nothing else is."""

import pytest

from canon.exercise.judge import judge
from canon.exercise.sheet import Claim
from canon.proof.verdict import Status

PLANE = {"q": ["q"], "p": ["p"]}
REAL = {"parameters": {"k": "real"}}
FOLD = {"Q": ["Abs(q)"], "P": ["p*sign(q)"]}
DRAGGED = {"Q": ["Abs(q)"], "P": ["p"]}
PARTICLE = {"q": ["q"], "parameters": {"m": "positive"}}
STRETCHED = {"Q": ["2*Abs(q)"], "P": ["p*sign(q)"]}
NEW = {"new_q": ["Q"], "new_p": ["P"]}


def particle(r, T):
    return {**PARTICLE, "bodies": [{"m": "m", "r": [r]}], "T": T}


CLAIMS = {
    "kinetic energy of |q|": ("kinetic-energy", particle("Abs(q)", "m*q_dot**2/2"), True),
    "kinetic energy of |q|, sign left": ("kinetic-energy", particle("Abs(q)", "m*q_dot**2*sign(q)/2"), False),
    "kinetic energy of a maximum": ("kinetic-energy", particle("Max(q, -q)", "m*q_dot**2/2"), True),
    "kinetic energy of pieces": (
        "kinetic-energy",
        particle("Piecewise((q**2/2, q > 0), (-q**2/2, True))", "m*q**2*q_dot**2/2"),
        True,
    ),
    "kinetic energy of two speeds": (
        "kinetic-energy",
        particle("Piecewise((q, q > 0), (2*q, True))", "m*q_dot**2/2"),
        False,
    ),
    "a kink in the claimed energy only": ("kinetic-energy", particle("q", "m*q_dot**2*sign(q)**2/2"), False),
    "volume": ("invariance", {**PLANE, **DRAGGED, "of": "phase-volume"}, True),
    "twice the volume": ("invariance", {**PLANE, **STRETCHED, "of": "phase-volume"}, False),
    "all brackets": ("invariance", {**PLANE, **FOLD, "of": "poisson-brackets"}, True),
    "brackets of a reflexion": ("invariance", {**PLANE, **DRAGGED, "of": "poisson-brackets"}, False),
    "Lagrange's brackets": ("invariance", {**PLANE, **FOLD, "of": "lagrange-brackets"}, True),
    "Hamilton's form": ("invariance", {**PLANE, **FOLD, "of": "hamilton-equations"}, True),
    "valences of both signs": ("invariance", {**PLANE, **DRAGGED, "of": "hamilton-equations"}, False),
    "a fold": ("canonicity", {**PLANE, **FOLD}, True),
    "half a fold": ("canonicity", {**PLANE, **DRAGGED}, False),
    "a kink in a parameter": ("canonicity", {**PLANE, **REAL, "Q": ["q*Abs(k)"], "P": ["p*Abs(k)"]}, False),
    "a kink in a nonzero one": (
        "canonicity",
        {**PLANE, "parameters": {"k": "nonzero"}, "Q": ["q*Abs(k)"], "P": ["p/Abs(k)"]},
        True,
    ),
    "a bracket": (
        "poisson-bracket",
        {**PLANE, "pairs": [{"f": "Abs(q)", "g": "p*sign(q)", "value": "1"}]},
        True,
    ),
    "a value with a kink": (
        "poisson-bracket",
        {**PLANE, "pairs": [{"f": "q", "g": "p", "value": "sign(q)**2"}]},
        False,
    ),
    "another bracket": (
        "lagrange-bracket",
        {
            "variables": ["u", "v"],
            "q": ["Abs(u)"],
            "p": ["v*sign(u)"],
            "pairs": [{"u": "u", "v": "v", "value": "1"}],
        },
        True,
    ),
    "[X, Y]": (
        "lie-bracket",
        {"x": ["x", "y"], "X": ["Max(x, -x)", "0"], "Y": ["1", "0"], "claim": ["-x/Abs(x)", "0"]},
        True,
    ),
    "[X, Y], doubled": (
        "lie-bracket",
        {"x": ["x", "y"], "X": ["Max(x, -x)", "0"], "Y": ["1", "0"], "claim": ["-2*x/Abs(x)", "0"]},
        False,
    ),
    "the covariant": ("bilinear-covariant", {**PLANE, **FOLD, "factor": "1"}, True),
    "the covariant, doubled": ("bilinear-covariant", {**PLANE, **STRETCHED, "factor": "1"}, False),
    "a generating function": (
        "generating-F2",
        {**PLANE, **NEW, "F": "Abs(q)*P", "map": FOLD},
        True,
    ),
    "another generating function": (
        "generating-F2",
        {**PLANE, **NEW, "F": "q*P", "map": FOLD},
        False,
    ),
    "a new Hamiltonian": (
        "transformed-hamiltonian-K",
        {**PLANE, **NEW, "H": "p**2/2", "map": FOLD, "K": "P**2/2"},
        True,
    ),
    "a new Hamiltonian, doubled": (
        "transformed-hamiltonian-K",
        {**PLANE, **NEW, "H": "p**2/2", "map": FOLD, "K": "P**2"},
        False,
    ),
    "Hamilton's equations": (
        "hamilton-equations",
        {**PLANE, "H": "p**2/2 + Abs(q)", "q_dot": ["p"], "p_dot": ["Piecewise((-1, q > 0), (1, True))"]},
        True,
    ),
    "Hamilton's equations, a sign": (
        "hamilton-equations",
        {**PLANE, "H": "p**2/2 + Abs(q)", "q_dot": ["p"], "p_dot": ["Piecewise((1, q > 0), (-1, True))"]},
        False,
    ),
    "rest at a kink": (
        "hamilton-equations",
        {**PLANE, "H": "p**2/2 + Abs(q)", "solution": {"q": "0", "p": "0"}},
        True,
    ),
    "an integral": (
        "constant-of-motion",
        {**PLANE, "H": "p**2/2 + Abs(q)", "I": "p**2/2 + Piecewise((q, q > 0), (-q, True))"},
        True,
    ),
    "no integral": (
        "constant-of-motion",
        {**PLANE, "H": "p**2/2 + Abs(q)", "I": "p**2/2 + Piecewise((q, q > 0), (q, True))"},
        False,
    ),
    "a force": (
        "generalized-force",
        {**REAL, "q": ["q"], "V": "k*Abs(q)", "Q": ["Piecewise((-k, q > 0), (k, True))"]},
        True,
    ),
    "pieces that meet": (
        "constant-of-motion",
        {**PLANE, "H": "p**2/2", "I": "Piecewise((p**2, p > 0), (p**3, True))"},
        True,
    ),
    "no gauge in pieces": (
        "lagrangian-equivalence",
        {"q": ["q"], "L1": "0", "L2": "Piecewise((q_dot, q_dot > 0), (-q_dot, True))", "relation": "gauge"},
        False,
    ),
    "a gauge": (
        "lagrangian-equivalence",
        {"q": ["q"], "L1": "0", "L2": "q_dot*sign(q)", "relation": "gauge"},
        True,
    ),
    "no gauge": (
        "lagrangian-equivalence",
        {"q": ["q"], "L1": "0", "L2": "Abs(q_dot)", "relation": "gauge"},
        False,
    ),
    "no derivative, no kink": ("equality-only", {"lhs": "sign(k)**2", "rhs": "1", **REAL}, False),
}


@pytest.mark.parametrize("name", CLAIMS)
def test_kinks_are_outside_of_claims_about_derivatives(name):
    kind, keys, right = CLAIMS[name]
    assert judge(Claim(name, kind, keys)).status is (Status.HOLDS if right else Status.FAILS)


@pytest.mark.parametrize("I", ["sign(q)", "p*sign(q)**2", "Piecewise((p, q > 0), (2*p, True))", "q/Abs(q)"])
def test_what_jumps_is_not_called_constant(I):
    assert judge(Claim(I, "constant-of-motion", {**PLANE, "H": "p**2/2", "I": I})).undecided


def test_what_would_jump_elsewhere_is_constant_here():
    keys = {**PLANE, "H": "p**2/2", "I": "p*sign(q)", "domain": ["q > 0"]}
    assert judge(Claim("here", "constant-of-motion", keys)).holds


def test_what_jumps_and_changes_besides_is_refuted():
    keys = {**PLANE, "H": "p**2/2", "I": "Piecewise((q, q > 0), (2*q + 1, True))"}
    assert judge(Claim("moving", "constant-of-motion", keys)).fails
