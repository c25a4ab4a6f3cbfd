"""An answer has a value wherever the right one has, up to isolated points: every kind of claim, as it was written."""

import re
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import pytest

from canon import judge
from canon.exercise import Claim, InvalidClaim
from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.reading import Reading
from canon.exercise.sheet.sheet import sheet_from

DATA = Path(__file__).parents[1] / "data" / "claims"
WITHOUT_EXPRESSION = {"constraint-class", "parameters", "separable"}
ANSWERS = {kind: said.answer for kind, said in KINDS.items()} | {
    "positive-real": ("H",),
    "linearisation": ("claim",),
}

NOWHERE = {
    "nothing else": "7/({h})",
    "a zero over zero": "{r} + 0/({h})",
    "a factor that cancels": "({r})*({h})/({h})",
    "no logarithm": "{r} + 0*log({h})",
    "hyperbolic": "{r} + 0/(cosh({v})**2 - sinh({v})**2 - 1)",
    "trigonometric": "{r} + 1/(tan({v}) - sin({v})/cos({v}))",
    "zero to a power": "{r} + 0*({v} - {v})**-1",
    "an angle at the origin": "{r} + ({h})*atan2({h}, {h})",
    "no piece applies": "Piecewise(({r}, sin({v}) > 1))",
    "an impossible piece": "Piecewise(({r}, {v}**2 < 0))",
}
ON_A_PART = {"far out": "Piecewise(({r}, {v} > 10**200))"}
ISOLATED = {"a modulus in nothing": "({r}) + 0*{v}/Abs({v})", "a factor": "({r})*{v}/{v}"}


def listed(value):
    if hasattr(value, "items"):
        return {key: listed(item) for key, item in value.items()}
    return [listed(item) for item in value] if isinstance(value, list | tuple) else value


def shortest():
    found = defaultdict(list)
    for path in sorted(DATA.glob("*.json")):
        for claim in sheet_from(path.read_bytes()).claims:
            keys = str(listed(claim.keys))
            answered = any(key in claim.keys for key in ANSWERS[claim.kind])
            if claim.expect == "holds" and answered and not claim.errors and "$" not in keys:
                found[claim.kind].append((len(keys), claim.id, claim))
    return {kind: min(claims)[2] for kind, claims in found.items()}


CLAIMS = shortest()
ASKED = [kind for kind in KINDS if kind not in WITHOUT_EXPRESSION]


def first_text(value, path=()):
    """Return where the first expression of an answer stands: the value, where brackets are asked for."""
    if isinstance(value, str):
        return path, value
    if isinstance(value, dict):
        key = "value" if "value" in value else next(iter(value))
        return first_text(value[key], (*path, key))
    return first_text(value[0], (*path, 0))


def with_form(claim, form):
    keys = listed(claim.keys)
    answer = next(key for key in ANSWERS[claim.kind] if key in keys)
    (*outer, last), text = first_text(keys[answer], (answer,))
    left, equals, right = text.rpartition("=")
    reading = Reading(claim)
    names = {*reading.scope.names, reading.time.name}
    v = next((word for word in re.findall(r"[A-Za-z_]\w*", text) if word in names), reading.time.name)
    changed = form.format(r=right.strip(), v=v, h=f"({v} + 1)**2 - {v}**2 - 2*{v} - 1")
    place = keys
    for step in outer:
        place = place[step]
    place[last] = f"{left}{equals}{changed}"
    return replace(claim, keys=keys)


@pytest.mark.parametrize("kind", ASKED)
def test_what_has_a_value_nowhere_fails_in_every_kind(kind):
    for form in NOWHERE.values():
        verdict = judge(with_form(CLAIMS[kind], form))
        assert verdict.fails, (form, verdict)
        assert re.search("has a value nowhere|has no value around", verdict.feedback), verdict


@pytest.mark.parametrize("kind", ASKED)
def test_what_has_a_value_far_out_only_fails_in_every_kind(kind):
    verdict = judge(with_form(CLAIMS[kind], ON_A_PART["far out"]))
    assert verdict.fails, verdict
    assert "value" in verdict.feedback


@pytest.mark.parametrize("kind", ASKED)
def test_isolated_points_do_no_harm_in_any_kind(kind):
    assert judge(CLAIMS[kind]).holds
    for form in ISOLATED.values():
        assert judge(with_form(CLAIMS[kind], form)).holds, form


def equality(right, **keys):
    return judge(
        Claim("a", "equality-only", {"parameters": {"q": "real"}, "lhs": "sin(q)", "rhs": right, **keys})
    )


def test_latex_is_looked_at_as_it_was_written():
    hidden = r"(q+1)^2-q^2-2q-1"
    assert equality(r"$\sin q$").holds
    assert equality(rf"$\sin q + \frac{{0}}{{{hidden}}}$").fails
    assert equality(rf"$\frac{{({hidden})\sin q}}{{{hidden}}}$").fails
    assert equality(r"$\frac{q\sin q}{q}$").holds


def test_one_sentence_says_what_takes_the_value():
    assert equality("sin(q) + 0/(q - q)").feedback == (
        "rhs has a value nowhere: its denominator -q + q is zero everywhere"
    )
    verdict = equality("Piecewise((sin(q), q < 3))")
    assert verdict.feedback.startswith("rhs has no value around q = ")
    assert int(verdict.counterexample.point["q"].partition("/")[0]) > 3


@pytest.mark.parametrize(
    "right", ["sin(q) + 0/0", "sin(q) + 0*0**-1", "sin(q) + 0*1/(2 - 2)", "sin(q)*tan(pi/2)"]
)
def test_numbers_without_a_value_cannot_be_read(right):
    with pytest.raises(InvalidClaim, match=r"division by zero|infinite or undefined"):
        equality(right)


def test_numbers_too_large_cannot_be_read():
    with pytest.raises(InvalidClaim, match="an exponent beyond 1000"):
        equality("9**9**9")
    assert equality("sin(q)*2**10/1024").holds


def test_what_comes_out_undefined_is_undecided():
    keys = {"q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "map": {"Q": ["q"], "P": ["p"]}}
    assert judge(Claim("a", "generating-F2", {**keys, "F": "q*P"})).holds
    assert judge(Claim("a", "generating-F2", {**keys, "F": "q*P + P*0**P"})).undecided


def test_the_domain_of_the_claim_counts():
    assert equality("Piecewise((sin(q), q < 3))", domain=["q < 2"]).holds
    assert equality("Piecewise((sin(q), q < 3))", domain=["q < 4"]).fails
    assert equality("Piecewise((sin(q), Ne(q, 3)))").holds


def test_what_is_given_may_have_a_value_on_a_part_only():
    keys = {"q": ["x"], "L": "x_dot**2/2 - Piecewise((x**2/2, x > 0))"}
    held = judge(Claim("a", "euler-lagrange", {**keys, "claim": ["Piecewise((x_ddot + x, x > 0))"]}))
    assert not held.fails
    assert judge(Claim("a", "euler-lagrange", {**keys, "claim": ["x_ddot + x"], "domain": ["x > 0"]})).holds
    narrower = judge(Claim("a", "euler-lagrange", {**keys, "claim": ["Piecewise((x_ddot + x, x > 1))"]}))
    assert narrower.fails


def test_new_variables_have_only_the_values_of_the_map():
    keys = {
        "q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "H": "(p**2 + q**2)/2",
        "map": {"Q": ["atan2(q, p)"], "P": ["(p**2 + q**2)/2"]},
    }  # fmt: skip
    assert judge(Claim("a", "transformed-hamiltonian-K", {**keys, "K": "P"})).holds
    assert not judge(Claim("a", "transformed-hamiltonian-K", {**keys, "K": "Piecewise((P, P > 0))"})).fails
    assert judge(Claim("a", "transformed-hamiltonian-K", {**keys, "K": "Piecewise((P, P > 10**200))"})).fails


def test_a_given_without_a_value_is_no_ground_to_hold():
    keys = {"q": ["x"], "L": "x_dot**2/2 + 0/(x - x)", "claim": ["x_ddot"]}
    verdict = judge(Claim("a", "euler-lagrange", keys))
    assert verdict.fails
    assert verdict.feedback.startswith("L has a value nowhere")


@pytest.mark.parametrize(
    ("below", "second", "holds"),
    [
        ("1 + (tan(q) - sin(q)/cos(q))/(1 + q**2)", "P - p + h*(q + Q)/2", True),
        ("1 + (tan(q) - sin(q)/cos(q))/(1 + q**2)", "P - p + h*(q - Q)/2", False),
        ("1 + q**2", "P - p + h*(q + Q)/2", True),
    ],
)
def test_zeros_of_denominators_are_no_part_of_an_implicit_map(below, second, holds):
    keys = {"q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "parameters": {"h": "positive"}}
    verdict = judge(
        Claim("a", "canonicity", {**keys, "implicit": [f"(Q - q - h*(p + P)/2)/({below})", second]})
    )
    assert verdict.holds if holds else verdict.fails


CIRCLE = {
    "q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y", "constraints": ["x**2 + y**2 - l**2"],
    "multipliers": ["lam"], "parameters": {"m": "positive", "g": "positive", "l": "positive"},
}  # fmt: skip
SPHERE = {
    "q": ["r", "th"], "L": "m*(r_dot**2 + r**2*th_dot**2)/2 - m*g*r*cos(th)", "contact": "r - a",
    "integrals": ["m*a**2*th_dot**2/2 + m*g*a*cos(th) - m*g*a"],
    "parameters": {"m": "positive", "g": "positive", "a": "positive"},
}  # fmt: skip
LAMBDA = "(m*g*y - m*(x_dot**2 + y_dot**2))/(2*l**2)"
EQUATION = "2*l**2*lam + m*(x_dot**2 + y_dot**2) - m*g*y"
HELD = [
    ("reaction", CIRCLE, lambda f: {"values": {"lam": f}}, LAMBDA, ("x**2 + y**2 - l**2", "x*x_dot + y*y_dot"), "x"),
    ("multiplier-holonomic", CIRCLE, lambda f: {"claim": [f]}, EQUATION, ("x**2 + y**2 - l**2",), "y"),
    ("leaving-condition", SPHERE, lambda f: {"leaves": f}, "3*cos(th) - 2", ("r - a", "r_dot"), "r"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "keys", "answer", "right", "held", "free"), HELD, ids=[h[0] for h in HELD])
def test_what_has_no_value_where_the_constraints_hold_fails(kind, keys, answer, right, held, free):
    forms = ("({r})*({h})/({h})", "({r})/({h})", "{r} + 0*log({h})", "{r} + ({h})*atan2({h}, {h})")
    for form in forms:
        for zero in held:
            verdict = judge(Claim("a", kind, {**keys, **answer(form.format(r=right, h=zero))}))
            assert verdict.fails, (form, zero)
            assert "where the constraints hold, has a value nowhere" in verdict.feedback
    for form in ("({r})*{v}/{v}", "{r} + ({h})/(1 + ({h})**2)", "({r})*(1 + {h})/(1 + 2*({h}))"):
        honest = form.format(r=right, v=free, h=held[0])
        assert judge(Claim("a", kind, {**keys, **answer(honest)})).holds, form


def test_a_constant_where_something_vanishes_has_a_value_there():
    keys = {"q": ["q"], "p": ["p"], "H": "p**2/2 + q**2/2", "restrict": ["p - 1"]}
    assert not judge(Claim("a", "constant-of-motion", {**keys, "I": "(p**2 + q**2)*(p - 1)/(p - 1)"})).holds
    assert judge(Claim("a", "constant-of-motion", {**keys, "I": "(p**2 + q**2)*p/p"})).holds
