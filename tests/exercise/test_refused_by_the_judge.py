"""What the judge of each kind refuses as no claim of it: one part of a claim that holds is changed, and told is why."""

from decimal import Decimal

import pytest

from canon.exercise.claim_verdict import examine
from canon.exercise.sheet.reading import InvalidClaim
from canon.exercise.sheet.sheet import claim_from

PLANE, PHASE = {"q": ["x", "y"]}, {"q": ["q"], "p": ["p"]}
TO_NEW = {**PHASE, "new_q": ["Q"], "new_p": ["P"]}
OSCILLATOR = {**PHASE, "H": "(p**2 + q**2)/2"}
PERTURBED = {
    "q": ["theta"], "p": ["J"], "H": "J + eps*cos(theta)", "small": "eps", "parameters": {"eps": "real"},
}  # fmt: skip
FALL = {"q": ["z"], "L": "m*z_dot**2/2 - m*g*z", "parameters": {"m": "positive", "g": "positive"}}

GOOD = {
    "lagrange-bracket": {
        "variables": ["u", "v"], "q": ["u*cos(v)"], "p": ["u*sin(v)"],
        "pairs": [{"u": "u", "v": "v", "value": "u"}],
    },
    "canonicity": {**TO_NEW, "implicit": ["Q - p", "P + q"]},
    "generating-F1": {**TO_NEW, "F": "q*Q", "map": {"Q": ["p"], "P": ["-q"]}},
    "constraint-class": {
        **PLANE, "constraints": ["x_dot - y*y_dot"], "class": ["scleronomic", "holonomic", "bilateral"],
    },
    "kinetic-energy": {
        "q": ["x"], "bodies": [{"m": "m", "r": ["x"], "I": "m", "omega": ["x_dot"]}], "T": "m*x_dot**2",
        "parameters": {"m": "positive"},
    },
    "generalized-force": {
        **PLANE, "Q": ["6", "-y"], "work": "3*delta_x - y*delta_y", "forces": [{"torque": ["1"], "omega": ["3*x_dot"]}],
    },
    "invariance": {**TO_NEW, "of": "poisson-brackets", "F": "q*P + P**2", "type": 2},
    "jacobi-identity": {"x": ["x", "y"], "pairs": [{"u": "x", "v": "y", "value": "x"}]},
    "number": {
        "value": "m*g", "claim": "19.6 N", "unit": "N", "tolerance": "1 %",
        "given": {"m": "2", "g": "9.81"}, "parameters": {"m": "positive", "g": "positive"},
    },
    "parameters": {
        "of": "constant-of-motion", **OSCILLATOR, "I": "p**2 + a*q**2", "find": ["a"], "values": [{"a": "1"}],
        "parameters": {"a": "real"},
    },
    "hamilton-jacobi": {
        "q": ["x", "y"], "p": ["px", "py"], "H": "(px**2 + py**2)/2", "constants": ["a", "b"],
        "W": "a*x + b*y", "energy": "(a**2 + b**2)/2",
    },
    "separable": {**OSCILLATOR, "is": "separable"},
    "normal-form": {**OSCILLATOR, "actions": ["J"], "degree": 2, "K": "J"},
    "generating-first-order": {**PERTURBED, "W": "sin(theta)"},
    "adiabatic-invariant": {**PERTURBED, "I": "J + eps*cos(theta)", "order": 1},
    "action-angle": {**OSCILLATOR, "J": ["E"], "energy": "E", "parameters": {"E": "positive"}},
    "frequency": {**OSCILLATOR, "omega": ["1"]},
    "positive-real": {"variables": ["s"], "H": "1/(s + 1)", "is": ["passive"]},
    "leaving-condition": {
        "q": ["r", "theta"], "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 - m*g*r*cos(theta)", "contact": "r - R",
        "integrals": ["m*R**2*theta_dot**2/2 + m*g*R*cos(theta) = m*g*R"], "leaves": "cos(theta) = 2/3",
        "parameters": {"m": "positive", "g": "positive", "R": "positive"},
    },
    "first-order": {"exact": "sin(e)", "small": "e", "claim": "e", "parameters": {"e": "real"}},
    "solution": {**FALL, "rates": {"z": "sqrt(2*(E/m - g*z))"}, "constants": ["E"]},
    "conserved-or-not": {**OSCILLATOR, "conserved": ["p**2 + q**2"]},
    "legendre-hamiltonian": {
        "q": ["x"], "p": ["p"], "L": "m*x_dot**2/2 - k*x**2/2", "H": "p**2/(2*m) + k*x**2/2",
        "dimensions": {"m": "mass", "x": "length", "k": "kg/s^2"}, "parameters": {"m": "positive", "k": "positive"},
    },
    "differential": {"x": ["x"], "f": "u**2", "given": {"u": "3*d_x"}, "claim": "6*u*d_x", "parameters": {"u": "real"}},
}  # fmt: skip

TWO = {"new_q": ["Q1", "Q2"], "new_p": ["P1", "P2"]}
NEW_ENERGY = {"energy": "(a**2 + b**2)/2", "W": None, "S": "a*x + b*y - (a**2 + b**2)*t/2"}
FREE_FALL = {"rates": None, "solution": {"z": "h + v*t - g*t**2/2"}, "constants": ["h", "v"]}
NO_NAME_OF_ENERGY = "should be a name among the parameters that does not stand in H, not"
MAP = {"J": None, "energy": None, "transformation": {"u": "q"}}
POINTS = {"m": "m", "r": ["x"]}
CLASH, IMPOSSIBLE = "key dimensions: in L that is given", "moment of inertia; numbers have no dimension"
OF_TWO = "depends on variables that a generating function of type"

REFUSED = [
    ("lagrange-bracket", {"p": ["u", "v"]}, "key p: 2 momenta for 1 coordinate"),
    ("lagrange-bracket", {"pairs": [{"u": "u", "v": "a", "value": "u"}], "parameters": {"a": "real"}},
     "key pairs[0].v: a is not one of the variables"),
    ("canonicity", {**TWO, "implicit": ["Q1 - p", "P1 + q"]}, "key new_q: 2 new coordinates for 1 old; give one each"),
    ("generating-F1", {**TWO, "F": "q*Q1"}, "key new_q: 2 new coordinates for 1 old; give one each"),
    ("constraint-class", {"constraints": ["x_ddot - y"]}, "key constraints[0]: a constraint holds no accelerations"),
    ("kinetic-energy", {"T": "m*x_dot**2 + x_ddot"},
     "key T: a kinetic energy depends on coordinates, velocities and time only"),
    ("kinetic-energy", {"bodies": [{**POINTS, "I": ["m", "2*m"], "omega": ["x_dot"]}]},
     "key bodies[0].I: 2 moments of inertia for 1 angular velocity"),
    ("kinetic-energy", {"bodies": [{**POINTS, "m": ["m", "m"]}]},
     "key bodies[0].m: 1 expression should be here, not 2"),
    ("generalized-force", {"work": "3*delta_x - y*delta_y + 1"},
     "key work: a virtual work is linear in delta_x, delta_y"),
    ("generalized-force", {"work": "3*delta_x*delta_y"}, "key work: a virtual work is linear in delta_x, delta_y"),
    ("generalized-force", {"forces": [{"F": ["1", "2"], "r": ["x"]}]}, "key forces[0].F: 2 components, and 1 of r"),
    ("generalized-force", {"forces": [{"torque": ["1"], "omega": ["3*x_dot**2"]}]},
     "key forces[0].omega: should be affine in the velocities"),
    ("invariance", {"type": 5}, "key type: should be 1, 2, 3 or 4"),
    ("invariance", {"type": Decimal("2.5")}, "key type: should be 1, 2, 3 or 4"),
    ("invariance", {**TWO, "F": "q*P1"}, "key new_q: 2 new coordinates for 1 old; give one each"),
    ("invariance", {"F": "q*P", "type": 1}, f"key F: {OF_TWO} 1 can't depend on"),
    ("invariance", {"F": "q*P + Q**2"}, f"key F: {OF_TWO} 2 can't depend on"),
    ("invariance", {"F": "p*Q + q", "type": 3}, f"key F: {OF_TWO} 3 can't depend on"),
    ("invariance", {"F": "p*P + Q", "type": 4}, f"key F: {OF_TWO} 4 can't depend on"),
    ("invariance", {"of": "lagrange-equations"},
     "key Q: missing; give the new coordinates as functions of the old ones"),
    ("jacobi-identity", {"pairs": [{"u": "x", "v": "z", "value": "x"}], "parameters": {"z": "real"}},
     "key pairs[0].v: z is not one of x, y"),
    ("jacobi-identity", {"pairs": [{"u": u, "v": v, "value": "x"} for u, v in ("xy", "yx")]},
     "key pairs[1]: {y, x} is given already, or zero by antisymmetry"),
    ("jacobi-identity", {"pairs": [{"u": "x", "v": "x", "value": "0"}]},
     "key pairs[0]: {x, x} is given already, or zero by antisymmetry"),
    ("number", {"tolerance": "-1 %"},
     "key tolerance: should be a number ≥ 0 such as 0.001, or a part of the value such as 0.5 %"),
    ("number", {"tolerance": "g"},
     "key tolerance: should be a number ≥ 0 such as 0.001, or a part of the value such as 0.5 %"),
    ("number", {"unit": "furlong"}, "key unit: should be a unit of the SI or one made of them, such as m/s^2 or kJ"),
    ("number", {"value": "m*g/(g - 9.81)"}, "key value[0]: this has no value"),
    ("number", {"value": "2 s"}, "key value[0]: s is no unit of what is asked in N"),
    ("number", {"given": {"m": "2", "h": "9.81"}}, "key given.h: is not declared; the names here are m, g"),
    ("number", {"given": {"m": "2", "g": "m"}}, "key given.g: should be a number"),
    ("parameters", {"find": []}, "key find: at least one parameter is needed"),
    ("parameters", {"values": [{"b": "1"}]}, "key values[0].b: is not among find = a"),
    ("hamilton-jacobi", {"H": "(px**2 + py**2)/2 + a"},
     "key constants: a stands in H, so it is a parameter and no constant of integration"),
    ("hamilton-jacobi", {"constants": ["a", "a"]}, "key constants: a is declared twice"),
    ("hamilton-jacobi", {"energy": "x*a"}, "key energy: holds x; the energy is a function of the constants"),
    ("hamilton-jacobi", {"energy": "2"}, "key energy: should depend on the constants"),
    ("hamilton-jacobi", {"energy": None},
     'key constants: which of them is the energy? Name it E, or say energy = "…"'),
    ("hamilton-jacobi", {**NEW_ENERGY, "H": "(px**2 + py**2)/2 + cos(t)"},
     "key energy: H depends on t, so no energy is kept"),
    ("separable", {"H": "p**2 + t*q"},
     "key H: depends on t; take it as a coordinate: H + p_t, with its momentum"),
    ("normal-form", {"actions": ["J1", "J2"], "K": "J1"}, "key actions: 2 actions for 1 coordinate"),
    ("normal-form", {"H": "p**2 + q**2 + t"},
     "key H: depends on t; take the phase as an angle with a momentum of its own"),
    ("generating-first-order", {"W": None, "F2": "theta*P1", "new_p": ["P1", "P2"]},
     "key new_p: 2 new momenta for 1 old"),
    ("generating-first-order", {"small": ["eps", "mu"], "parameters": {"eps": "real", "mu": "real"}},
     "key small: should be one name"),
    ("adiabatic-invariant", {"order": 0}, "key slow: one slow time is wanted; without one, claim an order from 1"),
    ("adiabatic-invariant", {"slow": ["u", "v"], "parameters": dict.fromkeys(["eps", "u", "v"], "real")},
     "key slow: one slow time is wanted; without one, claim an order from 1"),
    ("action-angle", {"H": "p**2 + q**2 + t"}, "key H: depends on t; actions are those of motions with a fixed energy"),
    ("action-angle", {"energy": "q"}, f"key energy: {NO_NAME_OF_ENERGY} q"),
    ("action-angle", {"energy": "F"}, f"key energy: {NO_NAME_OF_ENERGY} F"),
    ("action-angle", {"H": "p**2 + E*q**2"}, f"key energy: {NO_NAME_OF_ENERGY} E"),
    ("action-angle", {**MAP, "new_q": ["u", "v"], "new_p": ["I", "J"]},
     "key new_q: 2 angles for 1 coordinate"),
    ("action-angle", {**MAP, "new_q": ["u"], "new_p": ["I"]},
     "key transformation: should say what u, I are, or what q, p are"),
    ("frequency", {"actions": ["I", "J"]}, "key actions: should name one action for each coordinate, or be left out"),
    ("positive-real", {"variables": ["s", "z"]}, "key variables: should be one name, that of the complex frequency"),
    ("positive-real", {"H": "1/(s**13 + 1)"}, "key H: has a degree above 12"),
    ("leaving-condition", {"contact": "r - R + r_dot"},
     "key contact: a contact f ≥ 0 depends on coordinates and time only"),
    ("first-order", {"exact": []}, "key exact: at least one expression is needed"),
    ("first-order", {"order": 9}, "key order: should be a whole number from -8 to 8"),
    ("first-order", {"order": Decimal("1.5")}, "key order: should be a whole number from -8 to 8"),
    ("solution", {"solution": {"z": "1"}}, "key rates: give solution or rates, not both"),
    ("solution", {"q": None, "L": None, "x": ["z"], "X": ["1"]},
     "key rates: belong to equations of second order; give q with L, or q with equations"),
    ("solution", {"q": None, "L": None, "equations": ["z_ddot + g"]},
     "key equations: are in the coordinates q; declare them"),
    ("solution", {"L": None}, "key L: missing; give L, or equations"),
    ("solution", {"initial": {"g": "0"}}, "key initial: should give values of z, z_dot"),
    ("solution", {"initial": {"z_dot": "0"}},
     "key initial: should give the place of every coordinate that the rate depends on"),
    ("solution", {**FREE_FALL, "initial": {"g": "0"}}, "key initial.g: should be one of z, z_dot"),
    ("conserved-or-not", {"q": None, "p": None, "H": None, "parameters": {"q": "real", "p": "real"}},
     "key L: missing; give q with L, q and p with H, or x with X"),
    ("differential", {"given": {"x": "d_x"}},
     "key given.x: should be a declared symbol that is none of the variables"),
    ("differential", {"given": {"w": "d_x"}},
     "key given.w: should be a declared symbol that is none of the variables"),
    ("differential", {"given": {"u": "atan(tan(d_x))"}},
     "key given.u: should be a sum of the differentials with coefficients"),
    ("legendre-hamiltonian", {"dimensions": {"x": "length", "mass": "mass"}},
     "key dimensions.mass: is not declared; the names here are x, p, m, k"),
    ("legendre-hamiltonian", {"dimensions": {"x": "length", "x_dot": "velocity"}},
     "key dimensions.x_dot: follows from that of its coordinate and of the time; leave it out"),
    ("legendre-hamiltonian", {"dimensions": {"m": "mass", "x": "length", "k": "kg/s^2", "p": "length"}},
     "key dimensions.p: p is declared as length, and follows from L or H as momentum; mend one of them"),
    ("legendre-hamiltonian", {"dimensions": {"m": "mass", "x": "length", "k": "kg"}},
     f"{CLASH} the terms of a sum differ: m*x_dot**2/2 is energy or torque, -k*x**2/2 is {IMPOSSIBLE}"),
    ("legendre-hamiltonian", {"L": "m*x_dot**2/2 + m*cos(x)", "dimensions": {"m": "mass", "x": "length"}},
     f"{CLASH} in cos(x) a number is needed: x is length; numbers have no dimension"),
]  # fmt: skip


def of(kind, changes):
    keys = {key: value for key, value in {**GOOD[kind], **changes}.items() if value is not None}
    return claim_from({"id": "a", "kind": kind, **keys})


@pytest.mark.parametrize("kind", GOOD)
def test_what_is_changed_holds_before(kind):
    assert examine(of(kind, {})).verdict.holds


@pytest.mark.parametrize(("kind", "changes", "told"), REFUSED)
def test_what_is_changed_is_refused_and_told_why(kind, changes, told):
    with pytest.raises(InvalidClaim) as refused:
        examine(of(kind, changes))
    assert refused.value.error.brief.split("\n")[0] == told
