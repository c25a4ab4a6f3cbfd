"""Words and signs around formulas, and shapes of keys, as people give them: each beside what must not pass."""

from __future__ import annotations

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from


def judged(**keys: object):
    claim = claim_from({"id": "a", **keys})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


PENDULUM = {
    "kind": "euler-lagrange", "q": ["theta"], "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
    "parameters": {"m": "positive", "g": "positive", "l": "positive"},
}  # fmt: skip
PAIR = {
    "kind": "euler-lagrange",
    "q": ["x", "y"],
    "L": "x_dot**2/2 + y_dot**2/2 - k*x*y",
    "parameters": {"k": "real"},
}
ROLLING = {"kind": "constraint-class", "q": ["x", "y", "z"], "constraints": ["x_dot - z*y_dot"]}


@pytest.mark.parametrize(
    "said",
    [
        "We get {}", "therefore {}", "Thus, {}", "Hence: {}", "So {}", "it follows that {}", "so we find {}", "=> {}",
        "⇒ {}", "∴ {}", "• {}", "{} ✓", "{}. ∎", "{}  q.e.d.", "therefore => {}", "1) {}", "a) {}", "ii) {}", "* {}",
        "eq. (3): {}", "Equation 2: {}", "E-L: {}", "Euler-Lagrange: {}", "Newton's equation: {}", "{} \\checkmark",
    ],
)  # fmt: skip
def test_words_that_say_nothing_are_passed_over(said: str) -> None:
    assert judged(**PENDULUM, claim=[said.format("θ'' + g/l sin θ = 0")]).status == "holds"
    assert judged(**PENDULUM, claim=[said.format("θ'' - g/l sin θ = 0")]).status == "fails"


@pytest.mark.parametrize("said", ["no) {}", "not: {}", "wrong: {}", "k) {}", "* * {}", "3: {}"])
def test_words_that_may_say_something_are_not(said: str) -> None:
    assert judged(**PENDULUM, claim=[said.format("θ'' + g/l sin θ = 0")]).status == "invalid"


@pytest.mark.parametrize(
    "typed",
    ["d2θ/dt2 {} g/l sin θ = 0", "d2theta/dt2 {} g/l*sin(theta) = 0",
     r"\frac{{\partial^2\theta}}{{\partial t^2}} {} \frac gl\sin\theta = 0",
     r"\partial_t^2\theta {} \frac gl\sin\theta = 0", "θ'' {} g/l sin θ ≡ 0", "θ'' {} w² sin θ = 0 with w² = g/l"],
)  # fmt: skip
def test_other_ways_to_write_an_equation(typed: str) -> None:
    assert judged(**PENDULUM, claim=[typed.format("+")]).status == "holds"
    assert judged(**PENDULUM, claim=[typed.format("-")]).status == "fails"


def test_words_before_dollars() -> None:
    assert judged(**PENDULUM, claim=[r"We get $\ddot\theta + \frac gl\sin\theta = 0$"]).status == "holds"


def test_declared_names_are_no_words() -> None:
    free = {"kind": "equality-only", "parameters": {"so": "real", "then": "real"}}
    assert judged(**free, lhs="so*then", rhs="then*so").status == "holds"
    assert judged(**free, lhs="so - then", rhs="then - so").status == "fails"


def test_words_linear_format() -> None:
    assert judged(**PENDULUM, claim=["θ ̈+g/l sin\u2061〖θ〗=0"]).status == "holds"
    assert judged(**PENDULUM, claim=["θ ̇+g/l sin\u2061〖θ〗=0"]).status == "fails"


@pytest.mark.parametrize(
    "said",
    ["diff(x,t,2) = -k*y, diff(y,t,2) = -k*x", "D[x[t],{t,2}] == -k y[t], D[y[t],{t,2}] == -k x[t]"],
)
def test_commas_between_equations_with_commas_inside(said: str) -> None:
    assert judged(**PAIR, claim=said).status == "holds"
    assert judged(**PAIR, claim=said.replace("-k", "k", 1)).status == "fails"


@pytest.mark.parametrize(
    "said", ["nonholonomic", ["nonholonomic, scleronomic"], "nonholonomic and bilateral"]
)
def test_one_word_or_several_in_one_text(said: object) -> None:
    assert judged(**ROLLING, **{"class": said}).status == "holds"
    assert judged(**ROLLING, **{"class": "nonholonomic and rheonomic"}).status == "fails"


def test_a_list_of_one_table_needs_no_brackets() -> None:
    asked = {"kind": "poisson-bracket", "q": ["x"], "p": ["p"]}
    assert judged(**asked, pairs={"f": "x", "g": "p", "value": "1"}).status == "holds"
    assert judged(**asked, pairs={"f": "x", "g": "p", "value": "-1"}).status == "fails"


@pytest.mark.parametrize("name", ["T", "K", "E_kin", "T_kin"])
def test_names_of_the_kinetic_energy(name: str) -> None:
    asked = {
        "kind": "kinetic-energy",
        "q": ["x"],
        "bodies": [{"m": "m", "r": ["x", "0"]}],
        "parameters": {"m": "positive"},
    }
    assert judged(**asked, T=f"{name} = ½ m x'²").status == "holds"
    assert judged(**asked, T=f"{name} = m x'²").status == "fails"


@pytest.mark.parametrize(
    "said",
    [
        "θ'' + ω₀² sin θ = 0, ω₀² = {}",
        "θ'' + ω² sin θ = 0 where ω² = {}",
        "ω² = {}; θ'' = -ω² sin θ",
        "θ'' + ω² sin θ = 0, with ω = √({})",
    ],
)
def test_what_an_answer_abbreviates_is_put_in(said: str) -> None:
    assert judged(**PENDULUM, claim=said.format("g/l")).status == "holds"
    assert judged(**PENDULUM, claim=said.format("l/g")).status == "fails"
    assert judged(**PENDULUM, claim=[said.format("g/l")]).status == "holds"


@pytest.mark.parametrize(
    ("said", "status"),
    [
        ("H = p²/(2I) - mgl cosθ, I = ml²", "holds"),
        ("H = p²/(2I) - mgl cosθ, I = 2ml²", "fails"),
        ("H = T + V, T = p²/(2ml²), V = -mgl cosθ", "holds"),
        ("H = T + V, T = p²/(2ml²), V = mgl cosθ", "fails"),
        ("H = p²/(2I) - mgl cosθ", "fails"),
    ],
)
def test_an_expression_with_abbreviations(said: str, status: str) -> None:
    asked = {**PENDULUM, "kind": "legendre-hamiltonian", "p": ["p"]}
    assert judged(**asked, H=said).status == status


def test_a_list_of_definitions_alone_is_the_answer() -> None:
    asked = {"kind": "canonicity", "q": ["q"], "p": ["p"], "parameters": {"a": "real"}}
    assert judged(**asked, Q="Q = q cos a - p sin a", P="P = q sin a + p cos a").status == "holds"
    assert judged(**PENDULUM, claim=["ω² = g/l"]).status == "invalid"
