"""The further kinds: what their page says, exact deciders against numbers, and what must stay undecided or invalid."""

import random
import re
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from hypothesis import example, given, settings
from hypothesis import strategies as st

from canon.exercise.check import judged
from canon.exercise.judge import InvalidClaim, judge
from canon.exercise.judges.positive_real import is_positive_real_at
from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.sheet import Claim, sheet_from
from canon.proof.domain.verdict import Status

PAGE = (Path(__file__).parents[2] / "docs" / "sheets_kinds.md").read_text("utf-8")
SAID = re.findall(r"^# (holds|fails)(?:: (.*))?\n\[\[claim\]\]\nid = \"(.*)\"", PAGE, re.MULTILINE)
SECTIONS = {
    part.split("`")[1]: part for part in re.split(r"^## ", PAGE, flags=re.MULTILINE) if part.startswith("`")
}
BLOCKS = re.findall(r"^```toml\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)


def verdict(kind, **keys):
    return judge(Claim("a", kind, keys))


# --- the page -------------------------------------------------------------------------------------


def test_what_the_page_says_is_what_canon_says():
    claims = [claim for block in BLOCKS for claim in sheet_from(block.encode(), toml=True).claims]
    told = list(judged(claims, jobs=2))
    assert [(t.status, t.feedback, t.id) for t in told] == SAID


def test_the_page_names_every_key_of_its_kinds_and_has_a_true_and_a_false_claim_of_each():
    for kind, section in SECTIONS.items():
        for key in (*KINDS[kind].required, *KINDS[kind].optional):
            assert re.search(rf"`{key}`|\(`?{key}`?[,)]|`{key} ", section), (kind, key)
        said = re.findall(r"^# (holds|fails)", section, re.MULTILINE)
        assert {"holds", "fails"} <= set(said), kind
    assert len(SECTIONS) == 16


@pytest.mark.parametrize(
    ("kind", "keys", "status", "told"),
    [
        ("routhian", {"q": ["r", "s"], "L": "r_dot**2 + s_dot**2", "cyclic": ["s"], "momenta": ["l", "k"], "R": "1",
                      "convention": "L-pq"}, "invalid", "2 momenta for 1 ignorable coordinate"),
        ("poisson-bracket", {"q": ["q"], "p": ["p", "r"], "pairs": [{"f": "q", "g": "p", "value": "1"}]},
         "invalid", "2 momenta for 1 coordinate"),
        ("canonicity", {"q": ["q"], "p": ["p"], "Q": ["q**2"], "P": ["p"], "valence": "q"},
         "invalid", "a valence is the same at all points"),
        ("generating-F1", {"q": ["q"], "p": ["p"], "new_q": ["Q"], "new_p": ["P"], "F": "q*Q",
                           "map": {"Q": "Q", "P": "-q"}}, "invalid", "the variables on the left"),
        ("reaction", {"q": ["x"], "L": "x_dot**2/2", "constraints": ["x = 1"], "multipliers": ["N"],
                      "values": {"N": "2*N"}}, "invalid", "coordinates, velocities and time only"),
        ("degrees-of-freedom", {"q": ["x", "y"], "constraints": ["x_dot**2 + y_dot**2 = 1"], "dof": "1"},
         "undecided", "affine in the velocities"),
        ("conserved-or-not", {"q": ["x"], "L": "x_dot**2/2", "conserved": ["x_dot + Abs(x)/x"], "domain": ["Ne(x, 0)"]},
         "undecided", "may jump"),
        ("linearisation", {"q": ["x"], "L": "x_dot**2/2", "equilibrium": {"x": "t"}, "claim": ["x_ddot"]},
         "invalid", "by parameters only"),
        ("first-order", {"exact": ["x"], "small": ["x"], "parameters": {"x": "real"}, "claim": ["x"], "order": 9},
         "invalid", "from -8 to 8"),
        ("first-order", {"exact": ["x"], "small": ["x"], "parameters": {"x": "real"}, "claim": ["x"],
                         "domain": ["x > 1"]}, "undecided", "away from zero"),
        ("first-order", {"exact": ["Abs(x)"], "small": ["x"], "parameters": {"x": "real"}, "claim": ["x"]},
         "undecided", "not certainly analytic"),
        ("jacobi-identity", {"x": ["a", "b"], "pairs": [{"u": "a", "v": "b", "value": "1"},
                                                        {"u": "b", "v": "a", "value": "1"}]},
         "invalid", "zero by antisymmetry"),
        ("parameters", {"of": "equality", "find": ["a"], "values": []}, "invalid", "should be one of canonicity"),
        ("parameters", {"of": "poisson-bracket", "q": ["q"], "p": ["p"], "find": ["q"], "values": [],
                        "pairs": [{"f": "q", "g": "p", "value": "1"}]}, "invalid", "q is no parameter"),
        ("positive-real", {"variables": ["s"], "H": "1/(s**13 + 1)", "is": ["passive"]},
         "invalid", "a degree above 12"),
    ],
)  # fmt: skip
def test_what_the_page_says_is_refused(kind, keys, status, told):
    (judgement,) = judged([Claim("a", kind, keys)])
    assert judgement.status == status
    assert told in judgement.known


# --- positive real: exact against numbers -----------------------------------------------------------

coefficients = st.lists(st.integers(-3, 6), min_size=1, max_size=4).filter(any)


def least_real_part(above, below):
    """Return the least Re H found at many points of the open right half plane, near poles and the axis too."""
    points = [complex(x, y) for x in (1e-3, 0.1, 1, 10) for y in np.linspace(-8, 8, 161)]
    for root in (*np.roots(below), *np.roots(np.polyadd(above, below))):
        points += [root + d * np.exp(1j * a) for d in (1e-2, 0.1, 0) for a in np.linspace(0, 2 * np.pi, 40)]
    inside = [z for z in points if z.real > 1e-6 and abs(np.polyval(below, z)) > 1e-9]
    return min((np.polyval(above, z) / np.polyval(below, z)).real for z in inside)


@settings(max_examples=50, deadline=None)
@example([1, 0, 0], [2, 1, 1])
@given(coefficients, coefficients)
def test_positive_real_against_values_in_the_right_half_plane(above, below):
    s = sp.Symbol("s")
    fault = is_positive_real_at(sp.Poly(above, s, domain="QQ"), sp.Poly(below, s, domain="QQ"))
    least = least_real_part(above, below)
    if fault is None:
        assert least > -1e-6
    elif fault.value != "-1":  # a place on the axis is named, where H is negative
        w = float(Fraction(fault.place.removeprefix("j*sqrt(").removesuffix(")")))
        z = 1j * np.sqrt(w)
        assert (np.polyval(above, z) / np.polyval(below, z)).real == pytest.approx(float(fault.value))
        assert float(fault.value) < 0
    else:
        assert least < 1e-3


def test_sums_of_passive_elements_are_passive_and_one_negative_element_spoils_them():
    chance = random.Random(3)
    for _ in range(4):
        k = [chance.randint(1, 5) for _ in range(5)]
        H = f"{k[0]}/s + {k[1]}*s + {k[2]} + {k[3]}*s/(s**2 + {k[4]})"
        claim = {"variables": ["s"], "H": H}
        assert verdict("positive-real", **claim, **{"is": ["passive"]}).holds
        spoiled = {**claim, "H": H.replace(f"{k[3]}*s/(", f"-{k[3]}*s/(")}
        assert verdict("positive-real", **spoiled, **{"is": ["passive"]}).fails
        assert verdict("positive-real", **spoiled, **{"is": ["not passive"]}).holds


# --- expansions: against SymPy's series ---------------------------------------------------------------

ATOMS = (
    "sin(e)",
    "cos(2*e)",
    "exp(-e)",
    "1/(1 + a*e)",
    "sqrt(1 + e)",
    "log(1 + e)",
    "e**2",
    "a*e",
    "b",
    "tan(e)",
)


@settings(max_examples=12, deadline=None)
@given(st.lists(st.sampled_from(ATOMS), min_size=2, max_size=4), st.integers(1, 3), st.integers(1, 4))
def test_expansions_against_series(atoms, order, slip):
    text = " + ".join(f"({x})*({y})" for x, y in pairwise(atoms))
    e, a, b = sp.symbols("e a b")
    right = sp.series(sp.sympify(text, locals={"e": e, "a": a, "b": b}), e, 0, order + 1).removeO()
    keys = {"exact": [text], "small": ["e"], "order": order, "parameters": dict.fromkeys("eab", "real")}
    assert verdict("first-order", **keys, claim=[str(sp.expand(right))]).holds
    wrong = verdict("first-order", **keys, claim=[f"{sp.expand(right)} + a*e**{slip}"])
    assert wrong.fails if slip <= order else wrong.holds
    if wrong.fails:
        ordinal = ("zeroth", "first", "second")[slip - 1]
        assert wrong.feedback.startswith(f"right to {ordinal} order in e only")


@pytest.mark.parametrize(
    "exact", ["Abs(e)", "sqrt(e)", "sqrt(e**2 + e**4)", "exp(-1/e**2)", "log(e)", "Max(e, 0)"]
)
def test_what_has_no_expansion_is_undecided(exact):
    keys = {"small": ["e"], "claim": ["0"], "parameters": {"e": "real"}}
    assert verdict("first-order", exact=[exact], **keys).undecided


# --- constraints: Frobenius against made-up integrals --------------------------------------------------

monomials = st.tuples(st.integers(0, 2), st.integers(0, 2), st.integers(0, 2))


@settings(max_examples=4, deadline=None)
@given(st.lists(monomials, min_size=1, max_size=3), monomials)
def test_multiples_of_differentials_are_holonomic_and_a_twist_makes_them_nonholonomic(terms, factor):
    x, y, z = v = sp.symbols("x y z")
    f = z + sum(x**i * y**j * z**k for i, j, k in terms)
    mu = 1 + x ** (2 * factor[0]) * y ** (2 * factor[1]) * z ** (2 * factor[2])
    form = [sp.expand(mu * f.diff(s)) for s in v]

    def text(form):
        return " + ".join(f"({c})*{s}_dot" for c, s in zip(form, v, strict=True))

    keys = {"q": ["x", "y", "z"]}
    assert verdict("constraint-class", **keys, constraints=[text(form)], **{"class": ["holonomic"]}).holds
    twisted = [form[0] + y * form[2] + 7 * y, form[1], form[2]]
    w, curl = (
        twisted,
        [
            twisted[(i + 2) % 3].diff(v[(i + 1) % 3]) - twisted[(i + 1) % 3].diff(v[(i + 2) % 3])
            for i in range(3)
        ],
    )
    integrable = sp.expand(sum(a * c for a, c in zip(w, curl, strict=True))) == 0
    said = verdict("constraint-class", **keys, constraints=[text(twisted)], **{"class": ["nonholonomic"]})
    assert said.fails if integrable else said.holds
    for counting, count in (("velocities", 2), ("positions", 2 if integrable else 3)):
        freedom = {"counting": counting, "constraints": [text(twisted)], **keys}
        assert verdict("degrees-of-freedom", **freedom, dof=str(count)).holds
        assert verdict("degrees-of-freedom", **freedom, dof=str(count - 1)).fails


@pytest.mark.parametrize(
    "constraints",
    [["(x - t)**2"], ["(x_dot - t)**2"], ["x", "x + (y - t)**2"]],
)
def test_constraints_that_are_degenerate_where_they_hold_are_not_called_scleronomic(constraints):
    said = verdict("constraint-class", q=["x", "y"], constraints=constraints, **{"class": ["scleronomic"]})
    assert said.status is not Status.HOLDS


def test_a_latex_constraint():
    keys = {"q": ["x", "y"], "parameters": {"a": "positive"}}
    assert verdict(
        "constraint-class", **keys, constraints=["$x^2 + y^2 = a^2$"], **{"class": ["holonomic"]}
    ).holds
    assert verdict(
        "constraint-class", **keys, constraints=[r"$x^2 + y^2 \geq a^2$"], **{"class": ["unilateral"]}
    ).holds


# --- nothing is taken for right because it says nothing -------------------------------------------------

PENDULUM = {
    "q": ["r", "theta"],
    "L": "m*(r_dot**2 + r**2*theta_dot**2)/2 + m*g*r*cos(theta)",
    "parameters": {"m": "positive", "g": "positive", "l": "positive"},
    "multipliers": ["lam"],
    "constraints": ["r - l"],
}


@pytest.mark.parametrize(
    ("kind", "keys"),
    [
        ("conserved-or-not", {"q": ["x"], "L": "x_dot**2", "conserved": []}),
        ("first-order", {"exact": [], "claim": [], "small": ["e"], "parameters": {"e": "real"}}),
        ("reaction", {**PENDULUM, "constraints": ["r + l"], "values": {"lam": "7"},
                      "parameters": {**PENDULUM["parameters"], "r": "positive"}}),
        ("reaction", {**PENDULUM, "values": {"lam": "lam"}}),
        ("reaction", {**PENDULUM, "values": {"lam": "-m*g"}, "integrals": ["theta_dot = 1"]}),
        ("kinetic-energy", {"q": ["x"], "bodies": [{"m": "1", "r": ["x"]}], "T": "0",
                            "constraints": ["x + 1"], "parameters": {"x": "positive"}}),
        ("variation", {"q": ["x"], "L": "x_dot**2/2", "boundary": "x_dot", "integrand": "-x_ddot*delta_x"}),
        ("differential", {"x": ["x"], "f": "x**2", "claim": "2*x"}),
        ("generalized-force", {"q": ["x", "y"], "power": "x_dot*y_dot", "Q": ["0", "0"]}),
        ("positive-real", {"variables": ["s"], "H": "exp(-s)", "is": ["passive"]}),
        ("positive-real", {"variables": ["s"], "H": "1/s", "is": ["lovely"]}),
    ],
)  # fmt: skip
def test_claims_that_say_nothing_are_invalid(kind, keys):
    with pytest.raises(InvalidClaim):
        verdict(kind, **keys)


def test_values_of_one_multiplier_do_not_hold_by_naming_it():
    assert verdict("reaction", **PENDULUM, values={"lam": "-m*g*cos(theta) - m*l*theta_dot**2"}).holds
    assert verdict("reaction", **PENDULUM, force=["lam", "0"]).holds
    assert verdict("reaction", **PENDULUM, force=["-lam", "0"]).fails


def test_first_order_equations_have_as_many_constants_as_coordinates():
    keys = {"q": ["x"], "equations": ["x_dot + x"], "solution": {"x": "A*exp(-t)"}}
    assert verdict("solution", **keys, constants=["A"]).holds
    assert verdict("solution", **{**keys, "solution": {"x": "(A + B)*exp(-t)"}}, constants=["A", "B"]).fails


def test_a_verdict_to_first_order_says_so():
    said = verdict("first-order", exact=["sin(x)"], claim=["x"], small=["x"], parameters={"x": "real"})
    assert said.question == "right to first order in x"
    assert said.certificate == "exact to first order in x"


# --- arbitrary functions ------------------------------------------------------------------------------

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
