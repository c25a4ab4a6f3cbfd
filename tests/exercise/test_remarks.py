"""Remarks around an answer, names of its own, and equations of first order: each beside what must not pass."""

from __future__ import annotations

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from

SPRING = {
    "kind": "euler-lagrange",
    "q": ["x"],
    "L": "m*x_dot**2/2 - k*x**2/2",
    "parameters": {"m": "positive", "k": "positive"},
}
THROWN = {
    "kind": "euler-lagrange",
    "q": ["x", "y"],
    "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y",
    "parameters": {"m": "positive", "g": "positive"},
}


def judged(question: dict[str, object], *said: str, **keys: object):
    claim = claim_from({"id": "a", **question, **({"claim": list(said)} if said else {}), **keys})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


@pytest.mark.parametrize(
    "typed",
    [
        "(b) m x'' = {}k x",
        "(iii) m x'' = {}k x",
        "m x'' = {}k x (harmonic oscillator)",
        "m x'' = {}k x [N]",
        "m x'' = {}k x (Newton).",
        r"m\ddot x = {}k x \quad\text{{(equation of motion)}}",
        "0 = {}k x - m x'' [kg m/s^2]",
        r"$m\ddot x = {}k x\ \mathrm{{(by Newton)}}$",
    ],
)
def test_remarks_are_passed_over(typed: str) -> None:
    assert judged(SPRING, typed.format("-")).status == "holds"
    assert judged(SPRING, typed.format("+")).status == "fails"


@pytest.mark.parametrize(
    "typed",
    [
        "m x'' = -k x (plus damping term)",
        "m x'' = -k x (not quite)",
        "m x'' = -k x (delta)",
        "m x'' = -k x [m]",
        r"m\ddot x = -k x + \text{other terms}",
        "m x'' = -k x [cm]",
    ],
)
def test_what_may_say_something_is_asked_about(typed: str) -> None:
    assert judged(SPRING, typed).status == "invalid"


def test_a_declared_letter_before_a_formula_is_asked_about() -> None:
    keys = {**SPRING, "parameters": {"m": "positive", "k": "positive", "a": "positive"}}
    assert "(a) may be a factor, or the number of the equation" in judged(keys, "(a) m x'' = -k x").known
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
        ["v = x'", "m v' = {}k x"],
        ["x' = v", "v' = {}k/m x"],
        ["x' = v, m dv/dt = {}k x"],
        ["x' = p/m", "p' = {}k x"],
        ["u = x'", "d/dt(m u) = {}k x"],
        [r"\dot x = v", r"\dot v = {}\frac{{k}}{{m}} x"],
        ["x' = 2 v", "v' = {}k x/(2m)"],
        [r"\begin{{cases}}\dot x = v\\ \dot v = {}\frac{{k}}{{m}} x\end{{cases}}"],
    ],
)
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


@pytest.mark.parametrize("said", [["x' = c", "m x'' = -k x"], ["m x'' = -k x", "x' = A"]])
def test_a_rate_is_not_set_to_what_nobody_gave(said: list[str]) -> None:
    assert judged(SPRING, *said).status == "invalid"


@pytest.mark.parametrize(
    "typed",
    [
        r"\ddot x + \omega^2 x = 0,\ \omega^2 = {}",
        r"\ddot{{x}} + \omega_0^2 x = 0 \quad\text{{with}}\quad \omega_0^2 = {}",
        r"\ddot{{x}} + w x = 0 \text{{ where }} w = {}",
        r"$\ddot{{x}} + \omega^2 x = 0$, where $\omega^2 = {}$",
    ],
)
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


KEPLER = {
    "kind": "legendre-hamiltonian",
    "q": ["r", "phi"],
    "p": ["p_r", "p_phi"],
    "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 + k/r",
    "parameters": {"m": "positive", "k": "positive"},
}
PLUMB = {
    "kind": "multiplier-holonomic",
    "q": ["x", "y"],
    "L": "m*(x_dot**2 + y_dot**2)/2 - m*g*y",
    "parameters": {"m": "positive", "g": "positive", "l": "positive"},
    "constraints": ["x**2 + y**2 - l**2"],
    "multipliers": ["lam"],
}


@pytest.mark.parametrize(
    "number",
    [r"\quad(2)", r"\qquad (2)", r"\hfill(2)", r"\hspace{1cm}[2]", r"\quad(3.14)", r".\quad\text{(2)}"],
)
def test_a_number_behind_a_wide_gap_is_that_of_the_equation(number: str) -> None:
    typed = r"H=\frac{p_r^2}{2m}+\frac{p_\phi^2}{2mr^2}-\frac{k}{%s}%s"
    assert judged(KEPLER, H=typed % ("r", number)).status == "holds"
    assert judged(KEPLER, H=typed % ("2r", number)).status == "fails"


@pytest.mark.parametrize(
    "typed",
    [
        r"\ddot x = -\frac{kx}{m}\; (2)",
        r"\ddot x=-x\frac{k}{m} [2]",
        "[2] m x'' + k x = 0",
        "2. m x'' + k x = 0",
        "(2.1) m x'' + k x = 0",
        "x'' = -k/m*sqrt(x^2) (3.14)",
    ],
)
def test_a_single_number_may_be_a_factor(typed: str) -> None:
    assert "may be a factor, or the number of the equation" in judged(SPRING, typed).known


@pytest.mark.parametrize(
    "typed",
    [
        "{}m x'' + k x = 0 (1)",
        "{}m x'' + k x = 0   (*)",
        r"(2)\quad {}m\ddot x + kx = 0",
        "(I) {}m x'' + k x = 0",
        "(2a) {}m x'' = -k x",
    ],
)
def test_numbers_that_can_be_nothing_else(typed: str) -> None:
    assert judged(SPRING, typed.format("")).status == "holds"
    assert judged(SPRING, typed.format("2 ")).status == "fails"


@pytest.mark.parametrize(
    "said",
    ["λ = 0", "λ = (m g y + m(x'^2+y'^2))/(2 l^2)", "lambda = m", "λ₁ = 0", "lam_1 = 0", "T = 17 m g"],
)
def test_a_multiplier_in_another_spelling_is_no_abbreviation(said: str) -> None:
    assert judged(PLUMB, "x*y'' - y*x'' + g*x = 0", said).status != "holds"
    assert judged(PLUMB, "x*y'' - y*x'' + g*x = 0", "λ = (m g y - m(x'^2+y'^2))/(2 l^2)").status == "holds"


@pytest.mark.parametrize("said", ["I = m l²", r"I = ml^2"])
def test_a_moment_of_inertia_is_no_imaginary_unit(said: str) -> None:
    keys = {
        "kind": "euler-lagrange",
        "q": ["theta"],
        "L": "m*l**2*theta_dot**2/2 + m*g*l*cos(theta)",
        "parameters": {"m": "positive", "g": "positive", "l": "positive"},
    }
    assert judged(keys, rf"I\ddot\theta = -mgl\sin\theta, \quad {said}").status == "holds"
    assert judged(keys, rf"I\ddot\theta = mgl\sin\theta, \quad {said}").status == "fails"


def test_a_definition_that_nothing_uses_is_told() -> None:
    found = judged(SPRING, "m x'' = -k x", "ω = m/k")
    assert found.status == "holds"
    assert any("ω = m/k in claim is passed over" in told for told in found.warnings)


@pytest.mark.parametrize(
    ("typed", "right", "wrong"),
    [
        ("F = {}k x, F = m x''", "-", "+"),
        ("a = {}k x/m, a = x''", "-", "+"),
        ("x' = v, v' = a, a = {}w x, w = k/m", "-", "+"),
        (r"F = m\ddot x,\quad F = {}kx", "-", "+"),
        ("m x'' = {}b x (b = k)", "-", "+"),
        ("x' = v, v = x', m v' = {}k x", "-", "+"),
    ],
)
def test_names_defined_by_one_another(typed: str, right: str, wrong: str) -> None:
    assert judged(SPRING, typed.format(right)).status == "holds"
    assert judged(SPRING, typed.format(wrong)).status == "fails"


@pytest.mark.parametrize(
    "typed",
    ["p_r²/(2m) + p_φ²/(2J) - {}U, J = m r², U = k/r", "H = T + {}V, T = p_r²/(2m) + p_φ²/(2mr²), V = -k/r"],
)
def test_a_hamiltonian_and_what_its_letters_stand_for(typed: str) -> None:
    assert judged(KEPLER, H=typed.format("")).status == "holds"
    assert judged(KEPLER, H=typed.format("2 ")).status == "fails"


def test_an_answer_of_definitions_alone_says_nothing() -> None:
    assert judged(SPRING, "x' = v", "v = x'").status == "fails"
