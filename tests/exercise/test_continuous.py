"""Answers that jump, say a number, or are not real: each beside a right answer of the same form."""

import pytest
import sympy as sp

from canon.exercise import check
from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import Claim, Sheet
from canon.mechanics.algebra.possible_motion import _knows_no_turns

OSCILLATOR = {"q": "q", "p": "p", "H": "p**2/2 + q**2/2"}
ENERGY = "p**2/2 + q**2/2"
IDENTITY = {"q": "q", "p": "p", "new_q": "Q", "new_p": "P", "map": {"Q": ["q"], "P": ["p"]}}
EXCHANGE = IDENTITY | {"map": {"Q": ["p"], "P": ["-q"]}}
POSITIVE = {"m": "positive", "w": "positive"}
ANGLE = {
    **IDENTITY,
    "parameters": POSITIVE,
    "map": {"Q": ["atan(m*w*q/p)"], "P": ["(p**2 + m**2*w**2*q**2)/(2*m*w)"]},
}
SPIN = {
    "x": ["a", "b", "c"],
    "pairs": [
        {"u": "a", "v": "b", "value": "c"},
        {"u": "b", "v": "c", "value": "a"},
        {"u": "c", "v": "a", "value": "b"},
    ],
}
FREE = {"q": "theta", "equations": ["theta_ddot"], "parameters": {"w": "positive"}}
GAUGE = {"q": "x", "L1": "x_dot**2/2", "L2": "x_dot**2/2 + x*x_dot", "relation": "gauge"}
PARTICLE = {"q": "x", "bodies": [{"m": "m", "r": ["x"]}], "parameters": {"m": "positive"}}
STEPS = ("sign({})", "atan(1/{0}) + atan({0})", "{0} - atan(tan(pi*{0}))/pi", "log({0}) - log(-{0})", "Max({0}, 0)/{0}",
         "Piecewise((1, {0} > 0), (2, True))", "atan2(sin({0}), cos({0})) - {0}",
         "atan2(0, {0})")  # fmt: skip


def said(kind, **keys):
    return judge(Claim("a", kind, keys))


# kind, keys, key, right answer with a place for what is added, the variable of the step
DETERMINED_BY_DERIVATIVES = [
    ("constant-of-motion", OSCILLATOR, "I", ENERGY + " + {}", "q"),
    ("conserved-or-not", OSCILLATOR, "conserved", [ENERGY + " + {}"], "p"),
    ("generating-F1", EXCHANGE, "F", "q*Q + {}", "Q"),
    ("generating-F2", IDENTITY, "F", "q*P + {}", "q"),
    ("generating-F3", IDENTITY, "F", "-p*Q + {}", "p"),
    ("generating-F4", EXCHANGE, "F", "p*P + {}", "P"),
    ("transformed-hamiltonian-K", {**EXCHANGE, "H": ENERGY}, "K", "P**2/2 + Q**2/2 + {}", "Q"),
    ("lagrangian-equivalence", GAUGE, "F", "x**2/2 + {}", "x"),
    ("gibbs-appell", PARTICLE, "S", "m*x_ddot**2/2 + {}", "x_ddot"),
    ("gibbs-appell", PARTICLE, "S", "m*x_ddot**2/2 + {}", "x"),
    ("jacobi-identity", SPIN, "casimirs", ["a**2 + b**2 + c**2 + {}"], "a"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "keys", "key", "form", "variable"), DETERMINED_BY_DERIVATIVES)
def test_a_staircase_added_to_a_right_answer_fails_and_a_number_does_not(kind, keys, key, form, variable):
    def answer(added):
        return [form[0].format(added)] if isinstance(form, list) else form.format(added)

    assert said(kind, **keys, **{key: answer("7")}).holds
    for step in STEPS:
        verdict = said(kind, **keys, **{key: answer(step.format(variable))})
        assert verdict.fails, step
        assert "jumps" in verdict.feedback, step


@pytest.mark.parametrize("step", STEPS)
def test_a_number_on_each_piece_is_no_constant_of_the_motion(step):
    for kind, keys, key in (
        ("constant-of-motion", OSCILLATOR, "I"),
        ("conserved-or-not", OSCILLATOR, "conserved"),
        ("jacobi-identity", SPIN, "casimirs"),
    ):
        quantity = step.format("a" if kind == "jacobi-identity" else "q")
        verdict = said(kind, **keys, **{key: quantity if key == "I" else [quantity]})
        assert verdict.fails
        assert "number on each piece" in verdict.feedback


RIGHT = [
    ("constant-of-motion", {**OSCILLATOR, "I": "atan(q/p) - t"}),
    ("constant-of-motion", {**OSCILLATOR, "I": "atan2(q, p) - t"}),
    ("constant-of-motion", {**OSCILLATOR, "I": "acos(p/sqrt(p**2 + q**2)) - t", "domain": ["q > 0"]}),
    ("constant-of-motion", {"q": "q", "p": "p", "H": "p**2/2 + Abs(q)", "I": "p**2/2 + Abs(q)"}),
    ("constant-of-motion", {"q": "q", "p": "p", "H": "p**2/2 + sign(q)", "I": "p**2/2 + sign(q)"}),
    ("constant-of-motion", {**OSCILLATOR, "I": f"({ENERGY})*Abs(q)/q", "domain": ["q < 0"]}),
    ("constant-of-motion", {**OSCILLATOR, "I": f"{ENERGY} + atan2(0, 1 + q**2)"}),
    ("constant-of-motion", {**OSCILLATOR, "I": f"{ENERGY} + atan2(0, q)", "domain": ["q > 0"]}),
    ("generating-F1", {**ANGLE, "F": "m*w*q**2*cot(Q)/2"}),
    ("generating-F2", {
        **ANGLE, "parameters": POSITIVE | {"p": "positive", "P": "positive"},
        "F": "q*sqrt(2*m*w*P - m**2*w**2*q**2)/2 + P*asin(q*sqrt(m*w/(2*P)))",
    }),
    ("transformed-hamiltonian-K", {**ANGLE, "H": "p**2/(2*m) + m*w**2*q**2/2", "K": "w*P"}),
    ("lagrangian-equivalence", {
        "q": ["x", "y"], "L1": "0", "L2": "(x*y_dot - y*x_dot)/(x**2 + y**2)", "relation": "gauge", "F": "atan2(y, x)",
    }),
    ("lagrangian-equivalence", {
        "q": "x", "L1": "x_dot**2/2", "L2": "x_dot**2/2 + sign(x)*x_dot", "relation": "equations",
    }),
    ("invariance", {"q": "q", "p": "p", "of": "hamilton-equations", "Q": ["2*q"], "P": ["p"]}),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "keys"), RIGHT, ids=[f"{k}-{i}" for i, (k, _) in enumerate(RIGHT)])
def test_angles_kinks_and_given_steps_still_hold(kind, keys):
    assert said(kind, **keys).holds


WRONG = [
    ("transformed-hamiltonian-K", {**ANGLE, "H": "p**2/(2*m) + m*w**2*q**2/2", "K": "w*P + sign(Q)"}, "K jumps"),
    ("constant-of-motion", {**OSCILLATOR, "I": f"({ENERGY})*sign(q)"}, "jumps at"),
    ("constant-of-motion", {**OSCILLATOR, "I": "atan(q/p) - t + sign(q)"}, "jumps at"),
    ("constant-of-motion", {**OSCILLATOR, "I": f"{ENERGY} + atan(q/p) + atan(p/q)"}, "jumps"),
    ("lagrangian-equivalence", {
        "q": "x", "L1": "x_dot**2/2", "L2": "x_dot**2/2 + sign(x)", "relation": "equations",
    }, "L2 at rest jumps"),
    ("invariance", {
        "q": "q", "p": "p", "of": "hamilton-equations", "Q": ["q"], "P": ["p*(atan(1/q) + atan(q))"],
    }, "{Q, P} jumps"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "keys", "words"), WRONG, ids=[f"{k}-{w}" for k, _, w in WRONG])
def test_jumps_in_other_places(kind, keys, words):
    verdict = said(kind, **keys)
    assert verdict.fails
    assert words in verdict.feedback


def test_a_surface_that_the_domain_leaves_out_is_not_decided():
    keys = {**OSCILLATOR, "domain": ["Ne(q, 0)"]}
    assert said("constant-of-motion", **keys, I=f"{ENERGY} + sign(q)").undecided
    assert said("constant-of-motion", **keys, I=ENERGY).holds


MOTIONS = [
    ("theta = atan(tan(w*t))", "atan(tan(w*t))", "w*t", "jumps"),
    ("half turns", "atan(w*tan(t))*0 + 2*atan(tan(w*t/2))", "2*(w*t/2)", "jumps"),
    ("atan2", "atan2(sin(w*t), cos(w*t))", "w*t + 2*pi", "jumps"),
    ("logarithm", "-I*log(exp(I*w*t))", "-I*(I*w*t)", "jumps"),
    ("arc cotangent", "acot(cot(t))", "t", "jumps"),
    ("sign", "t + sign(t)", "t + 1", "jumps"),
    ("pieces", "Piecewise((t, t < 1), (t + 5, True))", "Piecewise((t, t < 1), (t, True))", "jumps"),
    ("modulus", "Abs(t)", "t", "velocity"),
    ("root", "sqrt(t**2 - 2*t + 1)", "t - 1", "velocity"),
    ("larger", "Max(t, 0)", "Max(t, t)", "velocity"),
    ("folded", "acos(cos(t))", "-t", "velocity"),
    ("bent", "Piecewise((t, t < 1), (2*t - 1, True))", "2*t - 1", "velocity"),
    ("imaginary", "I*t", "-I*I*t", "not real"),
    ("mixed", "t + I", "t + I**4", "not real"),
]


@pytest.mark.parametrize(("wrong", "right", "words"), [m[1:] for m in MOTIONS], ids=[m[0] for m in MOTIONS])
def test_a_free_motion_is_continuous_smooth_and_real(wrong, right, words):
    verdict = said("solution", **FREE, solution={"theta": wrong})
    assert verdict.fails
    assert words in verdict.feedback
    assert said("solution", **FREE, solution={"theta": right}).holds


def test_motions_of_hamiltons_equations():
    free, both = {"q": "q", "p": "p", "H": "p**2/2"}, "hamilton-equations"
    assert said(both, **free, solution={"q": "t + 1", "p": "1"}).holds
    assert said(both, **free, solution={"q": "t + sign(t)", "p": "1"}).fails
    assert said(both, **free, solution={"q": "atan(tan(t))", "p": "1"}).fails
    assert said(both, **OSCILLATOR, solution={"q": "exp(I*t)", "p": "I*exp(I*t)"}).fails
    assert said(both, **OSCILLATOR, solution={"q": "(exp(I*t) + exp(-I*t))/2", "p": "-sin(t)"}).holds
    bent = {"q": "Piecewise((t - t**2/2, t <= 2), (0, True))", "p": "1 - t"}
    assert said(both, q="q", p="p", H="p**2/2 + q", solution=bent, domain=["t > 0", "t < 2"]).holds


def test_whole_turns_of_an_angle_do_not_count():
    keys = {"q": ["r", "phi"], "p": ["p_r", "l"], "H": "p_r**2/2 + l**2/(2*r**2) + r**2/2",
            "parameters": {"r": "positive", "A": "positive", "B": "positive"}}  # fmt: skip
    r = "sqrt(B**2*cos(t)**2 + A**2*sin(t)**2)"
    motion = {
        "r": r,
        "phi": "atan2(A*sin(t), B*cos(t))",
        "p_r": f"(A**2 - B**2)*sin(t)*cos(t)/{r}",
        "l": "A*B",
    }
    verdict = said("hamilton-equations", **keys, solution=motion)
    assert verdict.holds
    assert verdict.assumed == ("phi is an angle of which whole turns do not count",)
    half = motion | {"phi": "atan(A*sin(t)/(B*cos(t)))"}
    assert said("hamilton-equations", **keys, solution=half).fails


def test_a_law_knows_of_turns_unless_it_is_the_same_after_one():
    theta, x, p = sp.symbols("theta x p", real=True)
    assert all(_knows_no_turns(law, theta) for law in (p * (5 + 4 * sp.cos(theta)), x * p, sp.tan(theta)))
    assert not any(
        _knows_no_turns(law, theta) for law in (theta * p, sp.cos(theta / 2), theta - sp.sin(theta))
    )


def test_half_turns_of_an_angle_count():
    for step in ("atan2(t**2, t) - atan(t)", "atan2(Abs(t), t)", "atan2(t, t)"):
        assert said("solution", **FREE, solution={"theta": f"t + {step}"}).fails, step
    assert said(
        "solution", **FREE, solution={"theta": "t + atan2(t**2, 1 + t**2) - atan(t**2/(1 + t**2))"}
    ).holds


def test_an_angle_that_passes_the_origin_does_not_hold():
    """Sine and cosine of 2 t and t vanish together at π/2; t² and sinh t at 0, where no factor shows it."""
    for y, x in (("t**2", "sinh(t)"), ("sin(2*t)", "2*cos(t)")):
        step = f"t + atan2({y}, {x}) - atan(({y})/({x}))"
        assert not said("solution", **FREE, solution={"theta": step}).holds, step


def test_motions_that_end_are_claimed_where_they_are_real():
    circle = {"q": "x", "equations": ["x*x_dot + t"]}
    verdict = said("solution", **circle, solution={"x": "sqrt(1 - t**2)"})
    assert verdict.holds
    assert "where it is real" in verdict.assumed[0]
    assert said("solution", **circle, solution={"x": "sqrt(-1 - t**2)"}).fails


SPRING = {
    "q": "x",
    "equations": ["m*x_ddot + k*x"],
    "parameters": {"m": "positive", "k": "positive", "C": "real"},
}
IMAGINARY = ["I*x*sqrt(k/m)", "sqrt(-x**2*k/m)", "x*sqrt(-k/m)", "sqrt(-2*C**2 - k*x**2)/sqrt(m)"]


@pytest.mark.parametrize("rate", IMAGINARY)
def test_velocities_are_real(rate):
    verdict = said("solution", **SPRING, rates={"x": rate})
    assert verdict.fails
    assert "not real" in verdict.feedback


def test_velocities_may_be_real_on_a_part():
    verdict = said("solution", **SPRING, rates={"x": "sqrt(2*C - k*x**2)/sqrt(m)"})
    assert verdict.holds
    assert "where it is real" in verdict.assumed[0]
    runaway = {**SPRING, "equations": ["m*x_ddot - k*x"]}
    assert said("solution", **runaway, rates={"x": "-I*I*x*sqrt(k/m)"}).holds


def test_velocities_by_quadrature_do_not_jump():
    keys = {"q": "x", "equations": ["x_ddot"]}
    assert said("solution", **keys, rates={"x": "sign(x)"}).fails
    assert said("solution", **keys, rates={"x": "c"}, parameters={"c": "real"}).holds


TWO = {"q": ["x", "y"], "p": ["a", "b"], "H": "(a**2 + b**2 + x**2 + 2*y**2)/2"}
OF_ANGLES = [  # jumps by another number at each place, right answer of the same form
    (OSCILLATOR, "exp(atan2(q, p) - t)", "atan2(q, p) - t"),
    (OSCILLATOR, "(p**2 + q**2)*(atan(q/p) - t)", "(p**2 + q**2) - atan(q/p) + t"),
    (OSCILLATOR, "sin((atan2(q, p) - t)/2)", "sin(atan2(q, p) - t)"),
    (TWO, "sin(sqrt(2)*atan2(x, a) - atan2(sqrt(2)*y, b))", "sqrt(2)*atan2(x, a) - atan2(sqrt(2)*y, b)"),
]


@pytest.mark.parametrize(("system", "wrong", "right"), OF_ANGLES, ids=str)
def test_a_constant_of_the_motion_has_the_same_value_after_each_turn_but_for_turns_of_an_angle(
    system, wrong, right
):
    refused = said("constant-of-motion", **system, I=wrong)
    assert refused.fails
    assert "jumps at" in refused.feedback
    assert said("constant-of-motion", **system, I=right).holds
    assert said("conserved-or-not", **system, not_conserved=[wrong]).undecided
    assert said("conserved-or-not", **system, not_conserved=[right]).fails


def test_angles_of_the_system_may_stand_in_its_energy():
    H = "(a**2 + b**2)/2 + cos(2*atan2(y, x))/(x**2 + y**2)"
    assert said("constant-of-motion", q=["x", "y"], p=["a", "b"], H=H, I=H).holds


def test_what_a_proof_assumed_is_among_the_warnings():
    sheet = Sheet("one", (Claim("a", "constant-of-motion", {**OSCILLATOR, "I": "atan2(q, p) - t"}),))
    (told,) = check(sheet).judgements
    assert told.status == "holds"
    assert "is an angle that winds around p = 0, q = 0" in told.warnings[0]


WEDGE = {"q": "q", "p": "p", "H": "p**2/2 + Piecewise((q, q > 0), (-q, True))"}
TURNED = {"q": ["x", "y"], "p": ["a", "b"], "H": "(a**2 + b**2)/2 + cos(2*atan2(y, x))/(x**2 + y**2)"}
L_SQUARED = "(x*b - y*a)**2/2 + cos(2*atan2(y, x))"
STEP = {"q": "q", "p": "p", "H": "p**2/2 + Piecewise((1, q > 0), (0, True))"}


@pytest.mark.parametrize(
    ("system", "wrong", "status", "right"),
    [
        (WEDGE, "(p**2/2 + Abs(q))*(2 + sign(q))", "fails", "p**2/2 + Abs(q)"),
        (WEDGE, "p**2 + 2*Abs(q) + sign(q)", "fails", WEDGE["H"]),
        (TURNED, f"{L_SQUARED} + sign(y)", "undecided", L_SQUARED),
        (TURNED, f"({L_SQUARED})*(2 + sign(y))", "undecided", TURNED["H"]),
    ],
)
def test_what_is_given_in_pieces_that_meet_excuses_no_jump(system, wrong, status, right):
    assert said("constant-of-motion", **system, I=wrong).status.value == status
    assert said("constant-of-motion", **system, I=right).holds


def test_what_is_given_with_a_jump_excuses_its_own():
    assert said("constant-of-motion", **STEP, I=STEP["H"]).holds
