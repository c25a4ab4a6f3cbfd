"""Answers that say nothing fail, `complete` demands every unknown, `in` names the variables: each of the kinds."""

import json
import re
from pathlib import Path
from xml.etree.ElementTree import fromstring

import pytest

from canon import is_constant_of_motion
from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.kind import Shape
from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.sheet import Claim, Sheet, claim_from, sheet_from
from canon.exercise.sheet_check import check

PAGE = (Path(__file__).parents[2] / "docs" / "sheets.md").read_text("utf-8")
NOTHING = "this says nothing about the motion: "
CONSTRAINTS = f"{NOTHING}it follows from the constraints alone"
ANYTHING = f"{NOTHING}it is true of anything"
ANY_SYSTEM = f"{NOTHING}what does not depend on the state is true of any system"

MGL = {"m": "positive", "g": "positive", "l": "positive"}
MK = {"m": "positive", "k": "positive"}
QP = {"q": ["q"], "p": ["p"]}
NEW = {**QP, "new_q": ["Q"], "new_p": ["P"]}
OSCILLATOR = {**QP, "parameters": {**MK, "E": "real"}, "H": "p**2/(2*m) + k*q**2/2"}
SPRING = {"q": ["x"], "parameters": {**MK, "c": "positive"}, "L": "m*x_dot**2/2 - k*x**2/2"}
DAMPED = {**SPRING, "F": "c*x_dot**2/2"}
PENDULUM = {"q": ["theta"], "parameters": MGL, "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)"}
CIRCLE = {
    "q": ["x", "y"], "parameters": MGL, "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y",
    "constraints": ["x**2 + y**2 = l**2"], "multipliers": ["lam"],
}  # fmt: skip
SLEIGH = {
    "q": ["x", "y", "theta"], "parameters": {"m": "positive", "J": "positive"},
    "L": "m*(x_dot**2 + y_dot**2)/2 + J*theta_dot**2/2",
    "constraints": ["x_dot*sin(theta) = y_dot*cos(theta)"], "multipliers": ["lam"],
}  # fmt: skip
FIXED = {"q": ["x", "y"], "parameters": MGL, "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y",
         "constraints": ["x", "y"], "multipliers": ["a", "b"]}  # fmt: skip
SPHERE = {"q": ["r", "theta"], "parameters": {"m": "positive", "g": "positive", "a": "positive"},
          "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 - m*g*r*cos(theta)", "contact": "r - a",
          "integrals": ["m*a**2*theta_dot**2/2 + m*g*a*cos(theta) = m*g*a"]}  # fmt: skip
KEPLER = {"q": ["r", "phi"], "parameters": {"m": "positive", "k": "positive", "r": "positive"},
          "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 + k/r", "cyclic": ["phi"], "momenta": ["l"],
          "convention": "L-pq"}  # fmt: skip
POINT = {"q": ["x"], "parameters": MK, "bodies": [{"m": "m", "r": ["x"]}]}
TOP = [
    {"u": "a", "v": "b", "value": "c"},
    {"u": "b", "v": "c", "value": "a"},
    {"u": "c", "v": "a", "value": "b"},
]
BODY = {"x": ["a", "b", "c"], "pairs": TOP}
HOOKE = {"q": ["x"], "equations": ["x_ddot + x = 0"], "parameters": {"A": "real", "B": "real"}}
TURN = {"Q": ["q*cos(s) - p*sin(s)"], "P": ["q*sin(s) + p*cos(s)"], "parameters": {"s": "real"}}
DISC = {"q": ["x", "y"], "constraints": ["x = y"]}
SPACE = {"q": ["x", "y", "z"], "p": ["px", "py", "pz"]}
LX, LY, LZ = "y*pz - z*py", "z*px - x*pz", "x*py - y*px"
XY, YZ, ZX = ({"f": f, "g": g, "value": v} for f, g, v in ((LX, LY, LZ), (LY, LZ, LX), (LZ, LX, LY)))

SMALL = {"small": ["e"], "parameters": {"e": "real"}}

COMPLETE = {
    "euler-lagrange": ({**PENDULUM, "claim": ["l*theta_ddot + g*sin(theta)"]}, ["theta", "theta_ddot"]),
    "dissipative": ({**DAMPED, "claim": ["m*x_ddot + c*x_dot + k*x"], "energy_rate": "-c*x_dot**2"},
                    ["x", "x_dot", "x_ddot"]),
    "multiplier-holonomic": ({**CIRCLE, "claim": ["m*x_ddot = 2*lam*x", "m*y_ddot = 2*lam*y - m*g"]},
                             ["x", "y", "x_ddot", "y_ddot", "lam"]),
    "nonholonomic": ({**SLEIGH, "claim": ["theta_ddot", "m*x_ddot = lam*sin(theta)", "m*y_ddot = -lam*cos(theta)"]},
                     ["theta", "x_ddot", "y_ddot", "theta_ddot", "lam"]),
    "legendre-hamiltonian": ({**PENDULUM, "p": ["p"], "H": "p**2/(2*m*l**2) - m*g*l*cos(theta)"}, ["theta", "p"]),
    "hamilton-equations": ({**OSCILLATOR, "q_dot": ["p/m"], "p_dot": ["-k*q"]}, ["q", "p"]),
    "routhian": ({**KEPLER, "R": "m*r_dot**2/2 - l**2/(2*m*r**2) + k/r"}, ["r", "r_dot", "l"]),
    "gibbs-appell": ({**POINT, "V": "k*x**2/2", "S": "m*x_ddot**2/2", "claim": ["m*x_ddot + k*x"]}, ["x", "x_ddot"]),
    "poisson-bracket": ({**SPACE, "pairs": [XY, YZ, ZX]}, ["x", "y", "z", "px", "py", "pz"]),
    "lagrange-bracket": ({"variables": ["A", "phi"], "q": ["A*cos(phi)"], "p": ["-A*sin(phi)"],
                          "pairs": [{"u": "A", "v": "phi", "value": "-A"}]}, ["A"]),
    "lie-bracket": ({"x": ["x", "y"], "X": ["y", "0"], "Y": ["0", "x"], "claim": ["-x", "y"]}, ["x", "y"]),
    "canonicity": ({**QP, **TURN}, ["q", "p"]),
    "canonicity-time-dependent": ({**QP, "Q": ["q + p*t"], "P": ["p"]}, ["q", "p"]),
    "bilinear-covariant": ({"x": ["q", "p"], "form": ["p*q", "0"], "claim": "q*(delta_p*d_q - d_p*delta_q)"}, ["q"]),
    "generating-F1": ({**NEW, "F": "q*Q", "map": {"Q": ["p"], "P": ["-q"]}}, ["q", "Q"]),
    "generating-F2": ({**NEW, "F": "q*P", "map": {"Q": ["q"], "P": ["p"]}}, ["q", "P"]),
    "generating-F3": ({**NEW, "F": "-p*Q", "map": {"Q": ["q"], "P": ["p"]}}, ["p", "Q"]),
    "generating-F4": ({**NEW, "F": "p*P", "map": {"Q": ["p"], "P": ["-q"]}}, ["p", "P"]),
    "transformed-hamiltonian-K": ({**NEW, "parameters": MK, "H": "p**2/(2*m)", "K": "Q**2/(2*m)",
                                   "map": {"Q": ["p"], "P": ["-q"]}}, ["Q"]),
    "constant-of-motion": ({**OSCILLATOR, "I": "p**2/m + k*q**2 + E"}, ["q", "p"]),
    "lagrangian-equivalence": ({"q": ["x"], "parameters": {"k": "positive"}, "L1": "x_dot**2",
                                "L2": "x_dot**2 + k*x_dot", "relation": "gauge", "F": "k*x"},
                               ["x"]),
    "equality-only": ({"parameters": {"x": "real"}, "box": {"x": [0, 1]}, "lhs": "x**2 - 1",
                       "rhs": "(x - 1)*(x + 1)"}, []),
    "kinetic-energy": ({**POINT, "T": "m*x_dot**2/2"}, ["x_dot"]),
    "generalized-force": ({"q": ["x"], "parameters": MK, "V": "k*x**2/2", "Q": ["-k*x"]}, ["x"]),
    "constraint-class": ({**DISC, "class": ["holonomic", "scleronomic", "bilateral"]}, []),
    "degrees-of-freedom": ({**DISC, "dof": "1"}, []),
    "reaction": ({**FIXED, "values": {"a": "0", "b": "m*g + 0*y_dot"}}, []),
    "leaving-condition": ({**SPHERE, "leaves": "cos(theta) = 2/3"}, ["theta"]),
    "conserved-or-not": ({**OSCILLATOR, "conserved": ["p**2/m + k*q**2", "7"], "not_conserved": ["q"]}, ["q", "p"]),
    "solution": ({**HOOKE, "solution": {"x": "A*cos(t) + B*sin(t)"}, "constants": ["A", "B"], "parameters": {}}, []),
    "linearisation": ({**PENDULUM, "equilibrium": {"theta": "0"}, "claim": ["theta_ddot + g/l*theta"]},
                      ["theta", "theta_ddot"]),
    "first-order": ({"exact": ["sin(e)/(e + e**2)"], "small": ["e"], "parameters": {"e": "real"},
                     "claim": ["1 - e"]}, []),
    "invariance": ({**QP, **TURN, "of": "poisson-brackets"}, ["q", "p"]),
    "jacobi-identity": ({**BODY, "casimirs": ["a**2 + b**2 + c**2", "7"]}, ["a", "b", "c"]),
    "positive-real": ({"variables": ["s"], "H": "1/(s + 1)", "is": ["positive-real"]}, []),
    "number": ({"value": ["1", "-2"], "claim": "(-1 ± 3)/2"}, []),
    "parameters": ({**QP, "of": "canonicity", "Q": ["a*q"], "P": ["b*p"], "find": ["a"],
                    "parameters": {"a": "real", "b": "nonzero"}, "values": [{"a": "1/b"}]}, []),
    "variation": ({**SPRING, "boundary": "m*x_dot*delta_x", "integrand": "-(m*x_ddot + k*x)*delta_x"},
                  ["x", "x_dot", "x_ddot"]),
    "differential": ({"x": ["q", "p"], "f": "q**2*p", "claim": "2*q*p*d_q + q**2*d_p"}, ["q", "p"]),
    "hamilton-jacobi": ({**OSCILLATOR, "constants": ["h"], "gradient": ["sqrt(2*m*h - k*m*q**2)"]}, ["q"]),
    "separable": ({"q": ["x", "y"], "p": ["a", "b"], "H": "a**2 + b**2 + x*y", "is": ["not separable"]}, []),
    "action-angle": ({**QP, "H": "p**2/2 + 2*q**2", "parameters": {"E": "positive"}, "J": ["E/2"]}, []),
    "frequency": ({**QP, "H": "p**2/2 + 2*q**2", "omega": ["2"]}, []),
    "lie-series": ({**QP, **SMALL, "f": "q", "W": "p*q", "claim": "q*(1 + e)"}, ["q"]),
    "normal-form": ({**QP, "H": "(p**2 + q**2 + q**4)/2", "actions": ["J"], "degree": 4, "K": "J + 3*J**2/4"}, ["J"]),
    "averaged-hamiltonian": ({**QP, **SMALL, "H": "p + e*p*cos(q)**2", "angles": ["q"], "K": "p + e*p/2"}, ["p"]),
    "generating-first-order": ({**QP, **SMALL, "H": "p + e*p*cos(q)", "W": "p*sin(q)"}, ["q", "p"]),
    "adiabatic-invariant": ({**QP, **SMALL, "H": "p + e*p*cos(q)", "I": "p + e*p*cos(q)"}, ["q", "p"]),
}  # fmt: skip
"""Of each kind a right and complete answer, and the variables in which it is written."""

WORTHLESS = (
    ("euler-lagrange", {"q": ["x"], "L": "x*x_dot", "claim": ["0 = 0"]}, ANYTHING),
    ("dissipative", {"q": ["x"], "L": "x*x_dot", "claim": ["sin(x)**2 + cos(x)**2 = 1"]}, ANYTHING),
    ("routhian", {"q": ["x"], "L": "x_dot**2/2", "cyclic": ["x"], "momenta": ["l"], "convention": "L-pq",
                  "claim": ["l = l"]}, ANYTHING),
    ("multiplier-holonomic", {**CIRCLE, "claim": ["0 = 0"]}, ANYTHING),
    ("multiplier-holonomic", {**CIRCLE, "claim": ["lam = lam", "x*(y - y)"]}, ANYTHING),
    ("multiplier-holonomic", {**CIRCLE, "claim": ["sin(x)**2 + cos(x)**2 = 1"]}, CONSTRAINTS),
    ("multiplier-holonomic", {**CIRCLE, "claim": ["x**2 + y**2 = l**2"]}, CONSTRAINTS),
    ("multiplier-holonomic", {**CIRCLE, "claim": ["x*x_dot + y*y_dot = 0"]}, CONSTRAINTS),
    ("multiplier-holonomic", {**CIRCLE, "claim": ["x*x_ddot + x_dot**2 + y*y_ddot + y_dot**2 = 0"]}, CONSTRAINTS),
    ("multiplier-holonomic", {**CIRCLE, "claim": ["lam*(x*x_dot + y*y_dot) = 0", "x**2 + y**2 - l**2"]}, CONSTRAINTS),
    ("multiplier-holonomic", {**CIRCLE, "claim": ["(x*x_ddot + x_dot**2 + y*y_ddot + y_dot**2)**2"]}, CONSTRAINTS),
    ("multiplier-holonomic", {**FIXED, "claim": ["x_ddot = y_ddot"]}, CONSTRAINTS),
    ("nonholonomic", {**SLEIGH, "claim": ["lam*J = J*lam"]}, ANYTHING),
    ("nonholonomic", {**SLEIGH, "claim": ["y_dot*cos(theta) = x_dot*sin(theta)"]}, CONSTRAINTS),
    ("nonholonomic", {**SLEIGH, "claim": [
        "x_ddot*sin(theta) - y_ddot*cos(theta) + theta_dot*(x_dot*cos(theta) + y_dot*sin(theta))"]}, CONSTRAINTS),
    ("constant-of-motion", {**OSCILLATOR, "I": "7"}, ANY_SYSTEM),
    ("constant-of-motion", {**OSCILLATOR, "I": "E"}, ANY_SYSTEM),
    ("constant-of-motion", {**OSCILLATOR, "I": "f(E)", "functions": {"f": ["E"]}}, ANY_SYSTEM),
    ("constant-of-motion", {**OSCILLATOR, "I": "sin(q)**2 + cos(q)**2"}, ANY_SYSTEM),
    ("constant-of-motion", {**SPRING, "I": "k/m"}, ANY_SYSTEM),
    ("constant-of-motion", {"x": ["x", "y"], "X": ["x*y", "y"], "I": "x**2", "restrict": ["x"]},
     f"{NOTHING}it follows from `restrict` alone"),
    ("conserved-or-not", {**OSCILLATOR, "conserved": ["E", "7"]}, ANY_SYSTEM),
    ("conserved-or-not", {**OSCILLATOR, "conserved": ["m"], "not_conserved": ["q"]}, ANY_SYSTEM),
    ("conserved-or-not", {**OSCILLATOR, "not_conserved": ["t"]}, ANY_SYSTEM),
    ("jacobi-identity", {**BODY, "casimirs": ["7"]}, f"{NOTHING}a number has vanishing brackets in any system"),
    ("leaving-condition", {**SPHERE, "leaves": "0 = 0"}, f"{NOTHING}it holds all along the contact"),
    ("leaving-condition", {**SPHERE, "leaves": "r = a"}, f"{NOTHING}it holds all along the contact"),
    ("hamilton-equations", {**OSCILLATOR, "q_dot": ["q_dot"], "p_dot": ["-k*q"]},
     "dq/dt is a function of q, p and t; q_dot must be eliminated"),
    ("legendre-hamiltonian", {**SPRING, "p": ["p"], "H": "p*x_dot - m*x_dot**2/2 + k*x**2/2"},
     "H is a function of q, p and t; x_dot must be eliminated"),
    ("gibbs-appell", {**POINT, "claim": ["0 = 0"]}, None),
    ("canonicity", {**NEW, "implicit": ["Q - Q", "P - P"]}, None),
    ("generating-F1", {**NEW, "F": "7", "map": {"Q": ["p"], "P": ["-q"]}}, None),
    ("linearisation", {**PENDULUM, "equilibrium": {"theta": "0"}, "claim": ["theta = theta"]}, None),
)  # fmt: skip

EMPTY = (
    ("reaction", {**CIRCLE, "values": {}}),
    ("solution", {"x": [], "X": [], "solution": {}}),
    ("conserved-or-not", {**OSCILLATOR, "conserved": []}),
    ("lie-bracket", {"x": [], "X": [], "Y": [], "claim": []}),
    ("multiplier-holonomic", {**CIRCLE, "claim": []}),
)

OPEN = (
    ("multiplier-holonomic", {**CIRCLE, "claim": ["x*y_ddot - y*x_ddot + g*x"]},
     "lam stays open: 1 equation is missing"),
    ("multiplier-holonomic", {**CIRCLE, "claim": ["2*l**2*lam + m*(x_dot**2 + y_dot**2) = m*g*y", "0 = 0"]},
     "x_ddot, y_ddot stay open: 1 equation is missing"),
    ("multiplier-holonomic", {**FIXED, "claim": ["a = 0"]}, "b stays open: 1 equation is missing"),
    ("nonholonomic", {**SLEIGH, "claim": ["theta_ddot"]}, "x_ddot, y_ddot, lam stay open: 2 equations are missing"),
    ("legendre-hamiltonian", {**SPRING, "p": ["p"], "exists": True}, "H stays open"),
    ("dissipative", {**DAMPED, "energy_rate": "x_dot*(m*x_ddot + k*x)"}, "dE/dt stays open: it is written with x_ddot"),
    ("dissipative", {**DAMPED, "claim": ["m*x_ddot + c*x_dot + k*x"], "energy_rate": "x_dot*(m*x_ddot + k*x)"},
     "dE/dt stays open: it is written with x_ddot"),
    ("poisson-bracket", {**SPACE, "pairs": [XY, YZ]}, "{-py*z + pz*y, -px*y + py*x} stays open"),
    ("lagrange-bracket", {"variables": ["a", "b", "c"], "q": ["a + c"], "p": ["b"],
                          "pairs": [{"u": "b", "v": "a", "value": "-1"}]}, "{a, c}, {b, c} stay open"),
    ("lagrangian-equivalence", {"q": ["x"], "L1": "x_dot**2", "L2": "x_dot**2 + x_dot", "relation": "gauge"},
     "F stays open"),
    ("constraint-class", {**DISC, "class": ["holonomic"]},
     "scleronomic or rheonomic, bilateral or unilateral stay open"),
    ("reaction", {**FIXED, "values": {"a": "0"}}, "b stays open"),
    ("solution", {**HOOKE, "solution": {"x": "A*cos(t)"}},
     "this is one motion of many: 2 constants of integration stay open"),
    ("solution", {**HOOKE, "solution": {"x": "A*sin(t)"}, "initial": {"x": "0"}},
     "the initial value of x_dot stays open"),
    ("solution", {"q": ["y"], "parameters": {"g": "positive"}, "L": "y_dot**2/2 - g*y", "rates": {"y": "1 - g*t"}},
     "this is one motion of many: 2 constants of integration stay open"),
    ("first-order", {"exact": ["sin(e)/(e + e**2)"], "small": ["e"], "parameters": {"e": "real"},
                     "claim": ["1/(1 + e)"]},
     "claim 1 is no sum of powers of e: expand it"),
    ("jacobi-identity", BODY, "a Casimir function stays open"),
)  # fmt: skip

OPEN += (
    ("multiplier-holonomic",
     {**CIRCLE, "claim": ["x*y_ddot - y*x_ddot + g*x", "Max(y, 0)*(2*l**2*lam + m*(x_dot**2 + y_dot**2) - m*g*y)"]},
     "lam stays open: 1 equation is missing, where y < 0"),
)  # fmt: skip

CLOSED = (
    ("multiplier-holonomic", {**CIRCLE, "claim": ["x*y_ddot - y*x_ddot + g*x",
                                                "2*l**2*lam + m*(x_dot**2 + y_dot**2) = m*g*y"]}),
    ("multiplier-holonomic", {**CIRCLE, "claim": ["Abs(x)*(x*y_ddot - y*x_ddot + g*x)",
                                                "2*l**2*lam + m*(x_dot**2 + y_dot**2) = m*g*y"]}),
    ("dissipative", {**DAMPED, "claim": ["m*x_ddot + c*x_dot + k*x"]}),
    ("dissipative", {**DAMPED, "energy_rate": "-c*x_dot**2"}),
    ("dissipative", {**DAMPED, "energy_rate": "-c*x_dot**2", "in": ["x", "x_dot"]}),
    ("hamilton-equations", {**OSCILLATOR, "parameters": {**MK, "A": "real"},
                            "solution": {"q": "A*cos(sqrt(k/m)*t)", "p": "-A*sqrt(k*m)*sin(sqrt(k/m)*t)"}}),
    ("routhian", {**KEPLER, "claim": ["m*r_ddot - l**2/(m*r**3) + k/r**2"]}),
    ("poisson-bracket", {**QP, "pairs": [{"f": "q", "g": "p", "value": "1"}]}),
    ("poisson-bracket", {**SPACE, "pairs": [XY, {"f": LX, "g": LZ, "value": f"-({LY})"}]}),
    ("lagrangian-equivalence", {"q": ["x"], "L1": "x_dot**2", "L2": "2*x_dot**2 + x_dot", "relation": "equations"}),
    ("reaction", {**FIXED, "force": ["0", "m*g"]}),
    ("solution", {**HOOKE, "solution": {"x": "A*sin(t)"}, "initial": {"x": "0", "x_dot": "A"}}),
    ("first-order", {"exact": ["1/(e*(1 + e))"], "small": ["e"], "parameters": {"e": "real"},
                     "claim": ["1/e - 1 + e"]}),
    ("jacobi-identity", {"x": ["q", "p"], "pairs": [{"u": "q", "v": "p", "value": "1"}]}),
)  # fmt: skip


def judged(kind, **keys):
    claim = claim_from({"id": "a", "kind": kind, **keys})
    if claim.errors:
        return "invalid", claim.errors[0].brief, ()
    *_, (told, last) = judgements(claim)
    assert last
    return told.status, told.feedback or told.known, told.warnings


# --- answers that say nothing ---------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "keys", "told"), WORTHLESS)
@pytest.mark.parametrize("complete", [False, True])
def test_an_answer_that_is_true_of_anything_fails(kind, keys, told, complete):
    status, feedback, warnings = judged(kind, **keys, complete=complete)
    assert status == "fails"
    assert told is None or feedback == told
    assert not warnings


@pytest.mark.parametrize(("kind", "keys"), EMPTY)
def test_an_empty_answer_is_invalid(kind, keys):
    status, told, _ = judged(kind, **keys)
    assert (status, "nothing is claimed: the answer is empty" in told) == ("invalid", True)


def test_an_empty_table_beside_an_answer_is_invalid():
    right = {**FIXED, "force": ["0", "m*g"]}
    assert judged("reaction", **right)[0] == "holds"
    assert judged("reaction", **right, values={"a": "0", "b": "m*g"})[0] == "holds"
    status, told, _ = judged("reaction", **right, values={})
    assert (status, "the table is empty" in told) == ("invalid", True)


def test_trivial_parts_beside_others_do_no_harm():
    rate = "x*x_ddot + x_dot**2 + y*y_ddot + y_dot**2"
    for trivial in ("0 = 0", "lam = lam", "x**2 + y**2 = l**2", rate):
        said = "x*y_ddot - y*x_ddot + g*x"
        for claim in ([trivial, said], [said, trivial], [f"{rate} = {said}"]):
            assert judged("multiplier-holonomic", **CIRCLE, claim=claim)[0] == "holds"
    assert judged("conserved-or-not", **OSCILLATOR, conserved=["7", "p**2/m + k*q**2"])[0] == "holds"
    assert judged("jacobi-identity", **BODY, casimirs=["7", "a**2 + b**2 + c**2"])[0] == "holds"


def test_what_is_said_of_the_library_stays():
    """A number is constant; only sheets judge answers."""
    import sympy as sp

    from canon import Hamiltonian, coordinates, parameters

    q, p = coordinates("q"), parameters("p")
    assert is_constant_of_motion(sp.Integer(7), Hamiltonian(p**2 / 2, [q], [p])).holds


def test_a_relation_that_motion_keeps_says_something():
    """The surface x = 0 is kept by this system and by few others, though x vanishes on it."""
    system = {"x": ["x", "y"], "restrict": ["x"], "I": "x"}
    assert judged("constant-of-motion", **system, X=["x*y", "y"])[0] == "holds"
    assert judged("constant-of-motion", **system, X=["x + y", "y"])[0] == "fails"


# --- complete answers -----------------------------------------------------------------------------


def test_every_kind_is_here():
    assert set(COMPLETE) == set(KINDS)


@pytest.mark.parametrize("kind", COMPLETE)
def test_a_complete_answer_holds_where_one_is_wanted(kind):
    keys, _ = COMPLETE[kind]
    for complete in (True, False):
        status, feedback, warnings = judged(kind, **keys, complete=complete)
        assert (status, feedback) == ("holds", "")
        assert not [warning for warning in warnings if "open" in warning or "missing" in warning]


@pytest.mark.parametrize(("kind", "keys"), CLOSED)
def test_other_complete_answers(kind, keys):
    assert judged(kind, **keys, complete=True) == ("holds", "", ())


@pytest.mark.parametrize(("kind", "keys", "open_"), OPEN)
def test_what_stays_open_fails_where_a_complete_answer_is_wanted_and_is_told_otherwise(kind, keys, open_):
    assert judged(kind, **keys, complete=True) == ("fails", open_, ())
    status, feedback, warnings = judged(kind, **keys)
    assert (status, feedback) == ("holds", "")
    assert open_ in warnings


def test_wrong_and_incomplete_is_told_as_wrong():
    status, told, warnings = judged(
        "multiplier-holonomic", **CIRCLE, claim=["x*y_ddot - y*x_ddot - g*x"], complete=True
    )
    assert (status, warnings) == ("fails", ())
    assert "open" not in told


# --- the variables of an answer -------------------------------------------------------------------


@pytest.mark.parametrize("kind", COMPLETE)
def test_an_answer_in_the_variables_that_are_named(kind):
    keys, names = COMPLETE[kind]
    assert judged(kind, **keys, **{"in": names})[0] == "holds"
    for left_out in names:
        fewer = [name for name in names if name != left_out]
        status, told, _ = judged(kind, **keys, **{"in": fewer})
        wanted = ", ".join(fewer) or "parameters and the time alone"
        assert (status, told) == (
            "fails", f"{left_out} stands in the answer; it should be written in {wanted}"
        )  # fmt: skip


@pytest.mark.parametrize("kind", COMPLETE)
def test_a_name_that_is_not_declared_is_invalid(kind):
    keys, names = COMPLETE[kind]
    status, told, _ = judged(kind, **keys, **{"in": [*names, "nobody"]})
    assert (status, told.split(";")[0]) == ("invalid", "key in: nobody is not declared")


@pytest.mark.parametrize(
    ("kind", "keys", "names", "told"),
    [
        ("reaction", {**CIRCLE, "values": {"lam": "m*x_ddot/(2*x)"}}, ["x", "y", "x_dot", "y_dot"],
         "x_ddot stands in the answer; it should be written in x, y, x_dot, y_dot"),
        ("constant-of-motion", {**OSCILLATOR, "I": "(p**2/m + k*q**2)*f(q)/f(q) + f(q)*0", "functions": {"f": ["q"]}},
         ["q", "p"], ""),
        ("euler-lagrange", {**SPRING, "L": "m*x_dot**2/2 - V(x)", "functions": {"V": ["x"]},
                            "claim": ["m*x_ddot + Derivative(V(x), x)"]}, ["x_ddot"],
         "x stands in the answer; it should be written in x_ddot"),
        ("euler-lagrange", {**SPRING, "L": "m*x_dot**2/2 - V(x)", "functions": {"V": ["x"]},
                            "claim": ["m*x_ddot + Derivative(V(x), x)"]}, ["x", "x_ddot", "V"], ""),
        ("hamilton-equations", {**OSCILLATOR, "q_dot": ["p/m + q_dot - q_dot"], "p_dot": ["-k*q"]}, ["q", "p"], ""),
        ("constant-of-motion", {**QP, "parameters": MK, "H": "p**2/(2*m)", "I": "q - t*p/m"}, ["q", "p"], ""),
        ("euler-lagrange", {**PENDULUM, "claim": [r"$l\ddot\theta + g\sin\theta = 0$"]}, ["theta"],
         "theta_ddot stands in the answer; it should be written in theta"),
        ("gibbs-appell", {"q": ["x"], "quasi": ["u"], "q_dot": ["2*u"], "parameters": MK,
                          "bodies": [{"m": "m", "r": ["x"]}], "claim": ["u_dot"]}, ["u_dot"], ""),
        ("gibbs-appell", {"q": ["x"], "quasi": ["u"], "q_dot": ["2*u"], "parameters": MK,
                          "bodies": [{"m": "m", "r": ["x"]}], "claim": ["u_dot"]}, ["u"],
         "u_dot stands in the answer; it should be written in u"),
    ],
)  # fmt: skip
def test_what_may_stand_in_an_answer(kind, keys, names, told):
    assert judged(kind, **keys, **{"in": names})[:2] == ("fails" if told else "holds", told)


# --- sheets, pages, reports -----------------------------------------------------------------------


def sheet(**keys):
    claims = [
        {"id": "own", "kind": "reaction", **FIXED, "values": {"a": "0"}, "complete": False, "in": ["x"]},
        {"id": "all", "kind": "reaction", **FIXED, "values": {"a": "0"}},
    ]
    return sheet_from(json.dumps({**keys, "claims": claims}).encode())


def test_the_keys_beside_the_claims_are_meant_for_all_that_have_none_of_their_own():
    report = check(sheet(complete=True))
    assert [j.status for j in report] == ["holds", "fails"]
    claims = sheet(**{"in": ["y"]}).claims
    assert [claim.keys["in"] for claim in claims] == [["x"], ["y"]]


@pytest.mark.parametrize(
    ("key", "value"), [("complete", "yes"), ("complete", 1), ("in", ["x'"]), ("in", {"x": 1})]
)
def test_keys_of_a_wrong_shape(key, value):
    status, told, _ = judged("equality-only", lhs="1", rhs="1", **{key: value})
    assert (status, told.startswith(f"key {key}: should be")) == ("invalid", True)


def test_warnings_stand_in_every_output():
    report = check(Sheet("open", (Claim("a", "reaction", {**FIXED, "values": {"a": "0"}}),)))
    assert report.judgements[0].warnings == ("b stays open",)
    assert "    b stays open" in str(report).splitlines()
    assert json.loads(report.json_lines())["warnings"] == ["b stays open"]
    assert json.loads(report.to_json())["claims"][0]["warnings"] == ["b stays open"]
    assert "b stays open" in report.to_html()
    assert fromstring(report.to_junit()).findtext(".//testcase/system-out") == "b stays open"


def test_the_page_shows_what_is_wanted():
    claim = Claim("a", "reaction", {**FIXED, "values": {"a": "0", "b": "m*g"}, "complete": True, "in": ["x"]})
    html = check(Sheet("all", (claim,))).to_html()
    assert "a complete answer" in html
    assert "written in" in html


def test_the_table_of_the_page_is_that_of_the_kinds():
    rows = re.findall(r"^\| `([\w-]+)` \| (`.*`) \| (.*) \|$", PAGE.split("## Answers")[1], re.MULTILINE)
    assert rows == [
        (name, ", ".join(f"`{key}`" for key in kind.answer), kind.unknowns) for name, kind in KINDS.items()
    ]


def test_the_answer_of_each_kind_stands_in_keys_of_its_own():
    for kind in KINDS.values():
        shapes = {**kind.required, **kind.optional}
        assert kind.answer
        assert kind.unknowns
        for key in kind.answer:
            texts = (Shape.TEXT, Shape.TEXTS, Shape.EXPRESSIONS, Shape.BRACKETS, Shape.WORDS, Shape.VALUES)
            assert shapes[key] in texts
