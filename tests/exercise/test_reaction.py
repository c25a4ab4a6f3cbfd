"""Reactions, multipliers and the loss of contact: for every Lagrangian, on motions that exist, and wrong twins."""

import pytest

from canon.exercise.claim_verdict import InvalidClaim, judge
from canon.exercise.sheet.sheet import Claim


def verdict(kind, **keys):
    return judge(Claim("a", kind, keys))


PENDULUM = {
    "q": ["r", "theta"],
    "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 + m*g*r*cos(theta)",
    "parameters": {"m": "positive", "g": "positive", "l": "positive"},
    "multipliers": ["lam"],
    "constraints": ["r - l"],
}


def test_values_of_one_multiplier_do_not_hold_by_naming_it():
    assert verdict("reaction", **PENDULUM, values={"lam": "-m*g*cos(theta) - m*l*theta_dot**2"}).holds
    assert verdict("reaction", **PENDULUM, force=["lam", "0"]).holds
    assert verdict("reaction", **PENDULUM, force=["-lam", "0"]).fails


ANY = {
    "q": ["x", "y"],
    "L": "L(x, y, x_dot, y_dot, t)",
    "functions": {"L": ["x", "y", "x_dot", "y_dot", "t"], "a": ["x", "y"], "b": ["x", "y"]},
    "constraints": ["a(x, y)*x_dot + b(x, y)*y_dot"],
    "multipliers": ["lam"],
}


def left_side(v, x):
    """Return d/dt ∂L/∂v − ∂L/∂x of an arbitrary Lagrangian as text."""
    slopes = (("x_dot", "x_ddot"), ("y_dot", "y_ddot"), ("x", "x_dot"), ("y", "y_dot"))
    terms = [f"Derivative({ANY['L']}, {v}, {s})*{rate}" for s, rate in slopes]
    return " + ".join(terms) + f" + Derivative({ANY['L']}, {v}, t) - Derivative({ANY['L']}, {x})"


def test_the_rule_of_multipliers_for_every_lagrangian_and_its_wrong_twins():
    right = f"{left_side('y_dot', 'y')} - lam*b(x, y)"
    assert verdict("nonholonomic", **ANY, claim=[right]).holds
    for old, new in (
        ("- lam*b", "+ lam*b"),
        ("lam*b", "lam*a"),
        ("*x_dot +", "*x_dot*2 +"),
        (", t) - ", ", t)*0 - "),
    ):
        assert verdict("nonholonomic", **ANY, claim=[right.replace(old, new)]).fails, (old, new)


def test_a_condition_on_a_function_is_kept():
    keys = {
        "q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2", "parameters": {"m": "positive"},
        "functions": {"f": ["t"], "h": ["x"]}, "constraints": ["y - x"], "multipliers": ["lam"],
        "domain": ["f(t) > 0", "h(x) > 0"],
    }  # fmt: skip
    assert verdict("reaction", **keys, values={"lam": "Abs(f(t)) - f(t) + Abs(h(x)) - h(x)"}).holds
    assert verdict("reaction", **keys, values={"lam": "Abs(f(t)) + f(t)"}).fails
    assert verdict("multiplier-holonomic", **keys, claim=["lam + Abs(f(t)) - f(t)"]).holds
    assert verdict("multiplier-holonomic", **keys, claim=["lam + Abs(f(t)) + f(t)"]).fails


def said(kind, **keys):
    """Return the verdict on a claim as a word; invalid where nothing can be judged."""
    try:
        return judge(Claim("a", kind, keys)).status.value
    except InvalidClaim:
        return "invalid"


@pytest.mark.parametrize(("constraints", "expected"), [
    (["x", "x - 1"], "invalid"),
    (["x**2 + 1"], "invalid"),
    (["x", "y - 1"], "holds"),
    (["x**2 - 1"], "holds"),
])  # fmt: skip
def test_the_rest_as_a_force_of_constraints_that_no_point_satisfies(constraints, expected):
    keys = {"q": ["x", "y"], "L": "(x_dot**2 + y_dot**2)/2", "multipliers": ["u", "v"][: len(constraints)]}
    assert said("reaction", **keys, constraints=constraints, force=["x_ddot", "y_ddot"]) == expected


SPHERE = {
    "q": ["r", "theta"],
    "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 - m*g*r*cos(theta)",
    "parameters": {"m": "positive", "g": "positive", "a": "positive"},
}


@pytest.mark.parametrize(("energy", "value", "expected"), [
    ("-5", "m*g*(3*cos(theta) + 10)", "invalid"),  # less than the least energy: no motion is meant
    ("5", "m*g*(3*cos(theta) - 10)", "holds"),
    ("5", "m*g*(3*cos(theta) + 10)", "fails"),
])  # fmt: skip
def test_energies_that_no_motion_has(energy, value, expected):
    integral = f"m*a**2*theta_dot**2/2 + m*g*a*cos(theta) = {energy}*m*g*a"
    keys = {**SPHERE, "constraints": ["r - a"], "multipliers": ["N"], "integrals": [integral]}
    assert said("reaction", **keys, values={"N": value}) == expected


@pytest.mark.parametrize(("leaves", "expected"), [
    ("1 = 0", "invalid"),
    ("m*g = 0", "invalid"),
    ("sin(theta)**2 + cos(theta)**2 = 1", "fails"),
    ("a*theta_dot**2 = g*cos(theta)", "holds"),
    ("a*theta_dot**2 = -g*cos(theta)", "fails"),
])  # fmt: skip
def test_conditions_that_hold_nowhere_or_everywhere_say_nothing(leaves, expected):
    assert said("leaving-condition", **SPHERE, contact="r - a", leaves=leaves) == expected
