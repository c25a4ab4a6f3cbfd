"""What a cheat tried on the reading of prose, remarks, names of ones own and derivations: none of it holds."""

from __future__ import annotations

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from

PARAMETERS = {"m": "positive", "k": "positive"}
L = "m*x_dot**2/2 - k*x**2/2"
SPRING = {"kind": "euler-lagrange", "q": ["x"], "parameters": PARAMETERS, "L": L}
LEGENDRE = {"kind": "legendre-hamiltonian", "q": ["x"], "p": ["p"], "parameters": PARAMETERS, "L": L}
EQUAL = {"kind": "equality-only", "parameters": {"x": "positive"}, "lhs": "x"}


def status(question: dict[str, object], **keys: object) -> str:
    claim = claim_from({"id": "a", **question, **keys})
    assert not claim.errors
    return [judgement.status for judgement, _ in judgements(claim)][-1]


@pytest.mark.parametrize(
    "typed",
    [
        r"\mathrm{sinc}(x)",
        r"\mathrm{erf}(x)",
        r"\text{floor}(x)",
        r"\mathrm{mol}\, x",
        "x --(2)",
        "x -- (2)",
    ],
)
def test_what_stands_before_or_behind_is_no_prose(typed: str) -> None:
    assert status(EQUAL, rhs=typed) != "holds"


def test_two_minus_signs_before_a_number_in_brackets_are_asked_about() -> None:
    assert status({**EQUAL, "lhs": "x + 2"}, rhs="x --(2)") == "invalid"
    assert status({**EQUAL, "lhs": "x + 2"}, rhs="x -(-2)") == "holds"


@pytest.mark.parametrize(
    "typed",
    [
        r"\mathrm{erf}(m\ddot x) = -k x",
        r"\text{Double}\; m\ddot x = -kx",
        r"\mathrm{mass}\,\ddot x = -\frac km x",
        "m x'' = -k x with friction c x'",
        "m x'' = -k x , where friction -c x' is added",
        r"m\ddot x = -kx \text{ with friction } -c\dot x",
        r"m\ddot x = -kx \text{ for } -c\dot x",
        "We can't have m x'' = -k x",
        "It is impossible that m x'' = -k x",
        "the opposite of this: m x'' = -k x",
        "Error: m x'' = -k x",
        "kein: m x'' = -k x",
        "m x'' = -k x, which fails",
        "m x'' = -k x, where k stands for the negative constant",
        "m x'' = -k x for k zero",
        "m x'' = -k x (deux fois)",
        "m x'' = -k x (double this)",
        "d/dt(∂L/∂x') = 0, m x'' = -k x",
        "∂L/∂x = 0, m x'' = -k x",
        "∂L/∂x = ∂L/∂x', m x'' = -k x",
        "d/dt(∂L/∂x') = 2 ∂L/∂x, m x'' = -k x",
        "d/dt(∂L/∂x') = -∂L/∂x, m x'' = -k x",
        r"\frac{d}{dt}\frac{\partial L}{\partial\dot x}+\frac{\partial L}{\partial x}=0 \implies m\ddot x=-kx",
        "L = 5 = m x'^2/2 - k x^2/2\nm x'' = -k x",
        "L = T + V = m x'^2/2 - k x^2/2\nm x'' = -k x",
        "∂L/∂x'",
    ],
)
def test_equations_beside_what_changes_them(typed: str) -> None:
    assert status(SPRING, claim=[typed]) == "invalid"


@pytest.mark.parametrize("word", ["to", "is", "es", "from", "est", "so", "hence"])
def test_a_declared_word_is_a_factor(word: str) -> None:
    declared = {**SPRING, "parameters": {**PARAMETERS, word: "positive"}}
    assert status(declared, claim=[f"{word} m x'' = -k x"]) != "holds"
    assert (
        status({**declared, "L": f"{word}*m*x_dot**2/2 - k*x**2/2"}, claim=[f"{word} m x'' = -k x"])
        == "holds"
    )


def test_a_declared_word_in_latex_is_a_factor() -> None:
    declared = {**SPRING, "parameters": {**PARAMETERS, "so": "positive"}}
    assert status(declared, claim=[r"\text{so} m \ddot x = -k x"]) != "holds"


@pytest.mark.parametrize(
    "typed", ["m x'' = -k x --(c)", "m x'' = -k x; for -c x'", "m x'' = -k x for the c x'"]
)
def test_terms_behind_a_formula(typed: str) -> None:
    declared = {**SPRING, "parameters": {**PARAMETERS, "c": "real"}}
    assert status(declared, claim=[typed]) != "holds"


@pytest.mark.parametrize(
    "typed",
    [
        "H = p^2/(2m) + V, V = k x^2/2, V = 3",
        "T + V, T = p^2/(2m), T = p^2/m, V = k x^2/2",
        "p^2/(2m) + V, V = k x^2/2, m = 3",
        "p^2/(2m) + V, V = k x^2/2, k x = 5 p",
        "p^2/(2m) + V, V = k x^2/2, kx = 5 p",
        "p^2/(2m) + V, V = k x^2/2, p = 2",
        "H = p^2/(2m) + V, V = k x^2/2, H = p^2/m",
        "H = p^2/(2m) + k x^2/2, with the potential -k x",
    ],
)
def test_statements_beside_a_hamiltonian_are_not_lost(typed: str) -> None:
    assert status(LEGENDRE, H=typed) == "invalid"


def test_statements_beside_a_gauge_term_are_not_lost() -> None:
    question = {
        "kind": "lagrangian-equivalence", "relation": "gauge", "q": ["x"], "parameters": PARAMETERS,
        "L1": L, "L2": f"{L} + x*x_dot",
    }  # fmt: skip
    assert status(question, F="F = u/2, u = x^2") == "holds"
    assert status(question, F="F = u/2, u = x^2, u = 5") == "invalid"


@pytest.mark.parametrize(
    "said",
    [
        ["m x'^2/2 + k x^2/2 = C", "p = m x'"],
        ["E = m x'^2/2 + k x^2/2", "p = m x'"],
        ["E = m x'^2", "m x'^2/2 + k x^2/2"],
        ["m x'^2/2 + k x^2/2", "J = x"],
    ],
)
def test_every_named_constant_is_judged(said: list[str]) -> None:
    assert status({**SPRING, "kind": "conserved-or-not"}, conserved=said) == "fails"


def test_velocities_by_their_letters_in_hamiltons_equations() -> None:
    question = {
        "kind": "hamilton-equations",
        "q": ["x"],
        "p": ["p"],
        "parameters": PARAMETERS,
        "H": "p**2/(2*m) + k*x**2/2",
    }
    for typed in ("v_x = p/m", "x' = v_x = p/m"):
        assert status(question, q_dot=[typed], p_dot=["p' = -k x"]) == "holds"
        assert status(question, q_dot=[typed.replace("p/m", "p m")], p_dot=["p' = -k x"]) == "fails"


def test_a_heading_is_of_its_own_equation() -> None:
    thrown = {
        "kind": "euler-lagrange", "q": ["x", "y"], "parameters": {"g": "positive"},
        "L": "x_dot**2/2 + y_dot**2/2 - g*y",
    }  # fmt: skip
    assert status(thrown, claim=["x: x'' = 0", "y: y'' = -g"]) == "holds"
    assert status(thrown, claim=["y: x'' = 0", "x: y'' = -g"]) == "invalid"


def test_a_place_is_no_angle() -> None:
    """On the sheet y = b cos x the reaction vanishes at one of the places that cos x is the same at."""
    question = {
        "kind": "leaving-condition", "q": ["x", "y"], "parameters": {"m": "positive", "g": "positive", "b": "positive"},
        "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y", "contact": "y - b*cos(x)",
    }  # fmt: skip
    assert status(question, leaves="x = acos(g/(b*x_dot**2))") != "holds"


def test_coordinates_in_terms_of_others_are_told_where_they_stand() -> None:
    question = {"kind": "lagrange-bracket", "variables": ["u", "v"], "q": ["v*si0nh(u)"], "p": ["u"]}
    claim = claim_from({"id": "a", **question, "pairs": [{"f": "u", "g": "v", "value": "1"}]})
    assert [judgement.status for judgement, _ in judgements(claim)] == ["invalid"]
