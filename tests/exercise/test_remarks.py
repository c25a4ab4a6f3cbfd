"""Remarks around an answer, names of its own, and equations of first order: each beside what must not pass."""

from __future__ import annotations

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from

SPRING = {
    "kind": "euler-lagrange", "q": ["x"], "L": "m*x_dot**2/2 - k*x**2/2",
    "parameters": {"m": "positive", "k": "positive"},
}  # fmt: skip
THROWN = {
    "kind": "euler-lagrange", "q": ["x", "y"], "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y",
    "parameters": {"m": "positive", "g": "positive"},
}  # fmt: skip


def judged(question: dict[str, object], *said: str, **keys: object):
    claim = claim_from({"id": "a", **question, "claim": list(said), **keys})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


@pytest.mark.parametrize(
    "typed",
    [
        "(b) m x'' = {}k x", "(iii) m x'' = {}k x", "m x'' = {}k x (harmonic oscillator)", "m x'' = {}k x [N]",
        "m x'' = {}k x (Newton).", r"m\ddot x = {}k x \quad\text{{(equation of motion)}}",
        "0 = {}k x - m x'' [kg m/s^2]",
        r"$m\ddot x = {}k x\ \mathrm{{(by Newton)}}$",
    ],
)  # fmt: skip
def test_remarks_are_passed_over(typed: str) -> None:
    assert judged(SPRING, typed.format("-")).status == "holds"
    assert judged(SPRING, typed.format("+")).status == "fails"


@pytest.mark.parametrize(
    "typed",
    ["m x'' = -k x (plus damping term)", "m x'' = -k x (not quite)", "m x'' = -k x (delta)", "m x'' = -k x [m]",
     r"m\ddot x = -k x + \text{other terms}", "m x'' = -k x [cm]"],
)  # fmt: skip
def test_what_may_say_something_is_asked_about(typed: str) -> None:
    assert judged(SPRING, typed).status == "invalid"


def test_a_declared_letter_before_a_formula_is_asked_about() -> None:
    keys = {**SPRING, "parameters": {"m": "positive", "k": "positive", "a": "positive"}}
    assert "letter of a part, or a factor" in judged(keys, "(a) m x'' = -k x").known
    assert judged(keys, "m x'' = -k x (a k)").status == "fails"


@pytest.mark.parametrize("typed", ["m x'' = F = {}k x", "F = m x'' = {}k x", r"m\ddot x = F_s = {}kx"])
def test_a_name_of_ones_own_in_a_chain_is_passed_over(typed: str) -> None:
    found = judged(SPRING, typed.format("-"))
    assert found.status == "holds"
    assert any("a name of your own" in told for told in found.warnings)
    assert judged(SPRING, typed.format("")).status == "fails"


@pytest.mark.parametrize(
    "said", [["F = -k x"], ["m x'' = F = -k x", "F = 3"], ["0 = F = 0"], ["F = F = m x'' = -k x"]]
)
def test_such_a_name_is_no_equation(said: list[str]) -> None:
    assert judged(SPRING, *said).status in ("fails", "invalid")


@pytest.mark.parametrize(
    "said",
    [
        ["v = x'", "m v' = {}k x"], ["x' = v", "v' = {}k/m x"], ["x' = v, m dv/dt = {}k x"], ["x' = p/m", "p' = {}k x"],
        ["u = x'", "d/dt(m u) = {}k x"], [r"\dot x = v", r"\dot v = {}\frac{{k}}{{m}} x"],
        ["x' = 2 v", "v' = {}k x/(2m)"],
        [r"\begin{{cases}}\dot x = v\\ \dot v = {}\frac{{k}}{{m}} x\end{{cases}}"],
    ],
)  # fmt: skip
def test_equations_of_first_order(said: list[str]) -> None:
    assert judged(SPRING, *(each.format("-") for each in said)).status == "holds"
    assert judged(SPRING, *(each.format("+") for each in said)).status == "fails"


@pytest.mark.parametrize(
    "said",
    [
        ["u = x'", "d/dt(m u) + m x'' = -k x"],  # once taken for a constant by d/dt
        ["x' = 2 v", "v' = -k/m x"],
        ["w = k/m", "x'' - sqrt(w^2) x = 0"],
        ["w = -k/m", "x'' = sqrt(w^2) x"],  # once read as positive
    ],
)
def test_what_moves_is_no_constant(said: list[str]) -> None:
    assert judged(SPRING, *said).status == "fails"


@pytest.mark.parametrize(
    "said", [["x' = c", "m x'' = -k x"], ["m x'' = -k x", "x' = A"], ["x' = v", "v = x'"]]
)
def test_a_rate_is_not_set_to_what_nobody_gave(said: list[str]) -> None:
    assert judged(SPRING, *said).status == "invalid"


@pytest.mark.parametrize(
    "typed",
    [r"\ddot x + \omega^2 x = 0,\ \omega^2 = {}",
     r"\ddot{{x}} + \omega_0^2 x = 0 \quad\text{{with}}\quad \omega_0^2 = {}",
     r"\ddot{{x}} + w x = 0 \text{{ where }} w = {}", r"$\ddot{{x}} + \omega^2 x = 0$, where $\omega^2 = {}$"],
)  # fmt: skip
def test_abbreviations_in_latex(typed: str) -> None:
    assert judged(SPRING, typed.format("k/m")).status == "holds"
    assert judged(SPRING, typed.format("m/k")).status == "fails"


@pytest.mark.parametrize(
    "said", [["a_x = 0", "a_y = {}g"], ["v_x' = 0", "dv_y/dt = {}g"], [r"\dot{{v}}_x = 0", "vy' = {}g"]]
)
def test_components_of_velocity_and_acceleration(said: list[str]) -> None:
    assert judged(THROWN, *(each.format("-") for each in said)).status == "holds"
    assert judged(THROWN, *(each.format("+") for each in said)).status == "fails"


def test_a_declared_letter_is_a_factor() -> None:
    keys = {
        **SPRING,
        "parameters": {"m": "positive", "k": "positive", "a": "real"},
        "L": "m*x_dot**2/2 - a*x**2/2",
    }
    assert judged(keys, "m x'' = -ax").status == "holds"
    assert judged(keys, "m x'' = ax").status == "fails"


def test_a_rate_by_its_letter_is_asked_for() -> None:
    assert "write x' or x''" in judged(SPRING, "m a = -k x").known


@pytest.mark.parametrize("typed", ["m*xdd {} k*x = 0", "d/dt(m*xd) {} k*x = 0", "m xdd {} kx = 0"])
def test_rates_as_programs_write_them(typed: str) -> None:
    assert judged(SPRING, typed.format("+")).status == "holds"
    assert judged(SPRING, typed.format("-")).status == "fails"


def test_xd_may_be_a_product() -> None:
    keys = {**SPRING, "parameters": {"m": "positive", "k": "positive", "d": "real"}}
    assert "can be read as" in judged(keys, "m x'' + k x + xd = 0").known
