"""Prose around an answer is passed over, in four languages and in Markdown; words that change it are not."""

from __future__ import annotations

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from
from canon.expression.prose import without_prose
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
    "$$m\\ddot{{x}} {} kx = 0$$\n\nThis is simple harmonic motion with frequency ω.",
    "m x'' {} k x = 0, which is the well-known oscillator equation.",
    "0 = m x'' {} k x (Hooke's law)",
    "0 = m x'' {} k x, where k is the spring constant",
    "0 = m x'' {} k x for all t",
    "Using Lagrange's equation we get m x'' {} k x = 0",
    "I get m x'' {} k x = 0",
    "Die Bewegungsgleichung lautet m x'' {} k x = 0",
    "Bewegungsgleichung: m x'' {} k x = 0",
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
