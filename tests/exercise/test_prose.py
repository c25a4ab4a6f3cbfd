"""Prose around an answer is passed over, in four languages and in Markdown; words that change it are not."""

from __future__ import annotations

import pytest
import sympy as sp

from canon import coordinates
from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from
from canon.expression.parse import LanguageError
from canon.expression.prose import without_prose
from canon.expression.remarks import without_remarks
from canon.expression.sentences.closing_sentence import start_of_closing, with_constancy
from canon.expression.text.scope import Scope

SPRING = {
    "kind": "euler-lagrange",
    "q": ["x"],
    "L": "m*x_dot**2/2 - k*x**2/2",
    "parameters": {"m": "positive", "k": "positive"},
}
CENTRAL = {
    "kind": "legendre-hamiltonian",
    "q": ["r", "phi"],
    "p": ["p_r", "p_phi"],
    "L": "m*(r_dot**2 + r**2*phi_dot**2)/2 + k/r",
    "parameters": {"m": "positive", "k": "positive"},
}
AROUND = [
    "**Equation of motion:** $m x'' {} k x = 0$",
    "### Final answer\n\n$$m\\ddot{{x}} {} kx = 0$$",
    "Thus: **m x'' {} k x = 0**",
    "✅ **m x'' {} k x = 0**",
    "> $m\\ddot{{x}} {} kx = 0$",
    "- For x: m x'' {} k x = 0",
    "x: m x'' {} k x = 0",
    "\\text{{Thus, }} m\\ddot x {} kx = 0",
    "\\text{{Therefore}}\\quad m\\ddot x {} kx = 0",
    "$$m\\ddot{{x}} {} kx = 0$$\n\nThis is simple harmonic motion.",
    "m x'' {} k x = 0, which is the well-known oscillator equation.",
    "0 = m x'' {} k x (Hooke's law)",
    "0 = m x'' {} k x, where k is the spring constant",
    "0 = m x'' {} k x for all t",
    "Using Lagrange's equation we get m x'' {} k x = 0",
    "I get m x'' {} k x = 0",
    "Die Bewegungsgleichung lautet m x'' {} k x = 0",
    "Bewegungsgleichung: m x'' {} k x = 0",
    "Eq. of motion: m x'' {} k x = 0",
    "Ans.: m x'' {} k x = 0",
    "daraus folgt m x'' {} k x = 0",
    "Équation du mouvement : m x'' {} k x = 0",
    "donc m x'' {} k x = 0",
    "por lo tanto m x'' {} k x = 0",
    "x'' {} ω² x = 0 mit ω² = k/m",
    "m\\ddot x {} kx = 0\\quad\\text{{q.e.d.}}",
    "--> m x'' {} k x = 0",
]


def judged(question: dict[str, object], **keys: object):
    claim = claim_from({"id": "a", **question, **keys})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


@pytest.mark.parametrize("typed", AROUND)
def test_words_around_an_equation(typed: str) -> None:
    assert judged(SPRING, claim=[typed.format("+")]).status == "holds"
    assert judged(SPRING, claim=[typed.format("-")]).status == "fails"


@pytest.mark.parametrize(
    "typed",
    [
        "not: m x'' + k x = 0",
        "mass x'' + k x = 0",
        "the following is wrong: m x'' + k x = 0",
        "Falsch: m x'' + k x = 0",
        "kinetic energy = m x'' + k x = 0",
        "m x'' + k x = 0 approximately",
        "m x'' + k x = 0, which is not right",
        "* * m x'' + k x = 0",
        "\\text{restoring force} = m\\ddot x + k x = 0",
    ],
)
def test_words_that_may_change_it(typed: str) -> None:
    assert judged(SPRING, claim=[typed]).status == "invalid"


def test_columns_stay_where_they_are() -> None:
    found = judged(SPRING, claim=["Bewegungsgleichung: m x'' + b x = 0"])
    assert "column 29: b is not declared" in found.known


def test_a_text_of_words_alone_is_left() -> None:
    scope = Scope()
    for text in ("holonomic", "it follows that", "the energy is conserved", "", "- x", "-> "):
        assert without_prose(text, scope) == text


@pytest.mark.parametrize(
    "typed",
    [
        "d/dt(∂L/∂x') - ∂L/∂x = 0; m x'' = {}k x",
        "∂L/∂x' = m x', ∂L/∂x = {}k x, m x'' = {}k x",
        r"\frac{d}{dt}\frac{\partial L}{\partial\dot x}-\frac{\partial L}{\partial x} = 0 \implies m\ddot x = {}kx",
        r"\begin{align*}\frac{\partial L}{\partial x} &= {}kx\\ \Rightarrow\quad m\ddot x &= -kx\end{align*}",
        "L = T - V = m x'^2/2 - k x^2/2\nm x'' = {}k x",
    ],
)
def test_a_derivation_before_the_result(typed: str) -> None:
    assert judged(SPRING, claim=[typed.replace("{}", "-")]).status == "holds"
    assert judged(SPRING, claim=[typed.replace("{}", "+")]).status == "fails"


@pytest.mark.parametrize(
    "typed", ["L = T - V = m x'^2/2 + k x^2/2\nm x'' = -k x", "d/dt(∂L/∂x') - ∂L/∂x = 0"]
)
def test_what_is_given_is_not_given_anew(typed: str) -> None:
    assert judged(SPRING, claim=[typed]).status == "invalid"


@pytest.mark.parametrize(
    "typed",
    [
        "H = p_r²/(2m) + p_φ²/(2mr²) {} k/r, where p_r = m r'",
        "p_r = m r', p_phi = m r^2 phi'\nH = p_r²/(2m) + p_φ²/(2mr²) {} k/r",
        r"$$H = \frac{p_r^2}{2m}+\frac{p_\phi^2}{2mr^2}{}\frac kr$$ where $p_r = m\dot r$ and $p_\phi = mr^2\dot\phi$.",
        r"H = \sum_i p_i\dot q_i - L = \frac{p_r^2}{2m}+\frac{p_\phi^2}{2mr^2}{}\frac kr",
    ],
)
def test_momenta_said_beside_a_hamiltonian(typed: str) -> None:
    assert judged(CENTRAL, H=typed.replace("{}", "-")).status == "holds"
    assert judged(CENTRAL, H=typed.replace("{}", "+")).status == "fails"


def test_wrong_momenta_beside_a_hamiltonian() -> None:
    typed = "H = p_r²/(2m) + p_φ²/(2mr²) - k/r, where p_r = 2 m r'"
    assert judged(CENTRAL, H=typed).status == "invalid"


ANGULAR = {
    "kind": "poisson-bracket",
    "q": ["x", "y", "z"],
    "p": ["p_x", "p_y", "p_z"],
}


@pytest.mark.parametrize("name", ["L_z = ", "{f, g} = ", "= "])
def test_a_bracket_by_names_of_ones_own(name: str) -> None:
    pair = {"f": "y*p_z - z*p_y", "g": "z*p_x - x*p_z"}
    right = judged(ANGULAR, pairs=[{**pair, "value": f"{name}x p_y - y p_x"}])
    assert right.status == "holds"
    assert name != "L_z = " or any("is taken for" in told for told in right.warnings)
    assert judged(ANGULAR, pairs=[{**pair, "value": f"{name}y p_x - x p_y"}]).status == "fails"


def test_a_bracket_of_other_functions_is_refused() -> None:
    pair = {"f": "y*p_z - z*p_y", "g": "z*p_x - x*p_z"}
    for name in (
        "{x, p_x}",
        "{L_y, L_x}",
        "{g, f}",
        "{L_x, L_x}",
        "L_z = L_x",
        "[L_x, L_y] = i ħ L_z",
        "i",
        "I",
    ):
        assert judged(ANGULAR, pairs=[{**pair, "value": f"{name} = x p_y - y p_x"}]).status == "invalid", name


@pytest.mark.parametrize("typed", ["{}x^2 + C", "F = {}x² + const", "{}x^2 + \\text{{const.}}"])
def test_a_gauge_term_up_to_a_constant(typed: str) -> None:
    question = {
        **{key: SPRING[key] for key in ("q", "parameters")},
        "kind": "lagrangian-equivalence",
        "L1": SPRING["L"],
        "L2": "m*x_dot**2/2 - k*x**2/2 + x*x_dot",
        "relation": "gauge",
    }
    assert judged(question, F=typed.format("1/2 ")).status == "holds"
    assert judged(question, F=typed.format("1/3 ")).status == "fails"


@pytest.mark.parametrize(
    "typed",
    [
        "E = m x'^2/2 {} k x^2/2",
        "m x'^2/2 {} k x^2/2 = const",
        "m x'²/2 {} 0,5 k x² = E",
        "½ m v_x² {} 0{{,}}5 k x^2",
    ],
)
def test_a_constant_of_the_motion_by_any_name(typed: str) -> None:
    question = {**SPRING, "kind": "conserved-or-not"}
    assert judged(question, conserved=[typed.format("+")]).status == "holds"
    assert judged(question, conserved=[typed.format("-")]).status == "fails"


@pytest.mark.parametrize(
    "typed", ["10 m/s.", "v = 10 m/s.", r"10~\mathrm{m/s}", r"10\,\mathrm{ms}^{-1}", "36 km/h."]
)
def test_units_at_the_end_of_a_sentence(typed: str) -> None:
    question = {"kind": "number", "unit": "m/s", "value": 10}
    assert judged(question, claim=typed).status == "holds"
    assert judged(question, claim=typed.replace("10", "11").replace("36", "37")).status == "fails"


@pytest.mark.parametrize(
    ("typed", "right"),
    [
        ("sech(x)", "1/cosh(x)"),
        (r"\operatorname{sech} x", "1/cosh(x)"),
        ("csch(x)", "1/sinh(x)"),
        ("coth(x)", "1/tanh(x)"),
        (r"\coth x", "1/tanh(x)"),
        ("sen(x)", "sin(x)"),
        ("arctg(x)", "atan(x)"),
        ("0,25*x", "x/4"),
        ("9{,}81 x", "981*x/100"),
    ],
)
def test_functions_and_decimals_of_other_countries(typed: str, right: str) -> None:
    question = {"kind": "equality-only", "parameters": {"x": "positive"}}
    assert judged(question, lhs=right, rhs=typed).status == "holds"
    assert judged(question, lhs=f"2*{right}", rhs=typed).status == "fails"


@pytest.mark.parametrize("typed", ["1,000*x", "x + 1, 5", "sin(0,5)"])
def test_commas_that_are_no_decimals(typed: str) -> None:
    question = {"kind": "equality-only", "parameters": {"x": "positive"}}
    assert judged(question, lhs="x", rhs=typed).status == "invalid"


@pytest.mark.parametrize("typed", ["m*diff(x(t), t$2) {} k*x(t) = 0", "m*diff(x(t),[t$2]) {} k*x(t) = 0"])
def test_second_derivatives_of_maple(typed: str) -> None:
    assert judged(SPRING, claim=[typed.format("+")]).status == "holds"
    assert judged(SPRING, claim=[typed.format("-")]).status == "fails"


def test_a_wrong_answer_at_the_end_of_a_chain_is_told() -> None:
    found = judged(
        {
            "kind": "hamilton-equations",
            "q": ["x"],
            "p": ["p"],
            "H": "p**2/2 + k*x**4/4",
            "parameters": {"k": "positive"},
        },
        q_dot=["p"],
        p_dot=["p' = -∂H/∂x = -2 k x³"],
    )
    assert (found.status, found.feedback) == ("fails", "dp/dt should be half what it is")


NAMES = Scope({"x": coordinates("x"), "k": sp.Symbol("k", positive=True)})


def test_three_headings_are_passed_over() -> None:
    headed = "Result: Solution: Equation of motion: x'' = -x"
    assert without_prose(headed, NAMES).strip() == "x'' = -x"
    assert without_prose(f"Answer: {headed}", NAMES).strip() == "Equation of motion: x'' = -x"


def test_a_long_sentence_may_lead_to_a_formula() -> None:
    sentence = "Hence we then find that the final form of the equation of motion of the system reads x'' = -x"
    assert without_prose(sentence, NAMES).strip() == "x'' = -x"
    assert without_prose(sentence.replace("final", "half"), NAMES).strip().startswith("the half form of")


@pytest.mark.parametrize(
    ("said", "closes"),
    [
        ("x = 1 since the energy is conserved", True),
        ("x = 1 since the energy is 2 joules", False),
        ("x = 1 since dF/dt = 0", True),
        ("x = 1 since dF/dt = 0 and dG/dt = 0", False),
        ("x = 1 since the force is conserved", True),
        ("x = 1 since the force k is conserved", False),
    ],
)
def test_a_reason_with_a_number_or_a_name_restricts(said: str, closes: bool) -> None:
    assert start_of_closing(said, 0, NAMES) == (5 if closes else len(said))


@pytest.mark.parametrize(
    ("said", "written"),
    [
        (r"m\dot x is conserved", r"m\dot x = \mathrm{const}"),
        (r"$m\dot x$ is conserved", r"$m\dot x = \mathrm{const}$"),
        (r"m\dot x is not conserved", r"m\dot x is not conserved"),
    ],
)
def test_what_is_conserved_is_constant_with_dollars_and_without(said: str, written: str) -> None:
    assert with_constancy(said, NAMES) == written


@pytest.mark.parametrize(
    ("typed", "left"),
    [
        (r"$x' = 2 \cdot (3)$", r"$x' = 2 \cdot (3)$"),
        (r"$x' = \log (2)$", r"$x' = \log (2)$"),
        (r"$x' = 2x \quad (3)$", r"$x' = 2x          $"),
    ],
)
def test_a_number_behind_what_takes_an_argument_is_that(typed: str, left: str) -> None:
    assert without_remarks(typed, NAMES) == left


@pytest.mark.parametrize("letter", [r"\theta", r"\vartheta"])
def test_a_number_behind_a_letter_is_asked_about(letter: str) -> None:
    with pytest.raises(LanguageError, match=r"\(3\) may be a factor, or the number of the equation"):
        without_remarks(rf"$x' = 2{letter} (3)$", NAMES)
