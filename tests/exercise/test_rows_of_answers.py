"""Bullets, labels and numbers around the rows of an answer: each beside a wrong twin, and what is asked about."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from canon.exercise.explained_judgement import judgements
from canon.exercise.sheet.sheet import claim_from

if TYPE_CHECKING:
    from collections.abc import Mapping

PENDULUM = {
    "kind": "euler-lagrange",
    "q": ["theta"],
    "L": "l**2*theta_dot**2/2 + g*l*cos(theta)",
    "parameters": {"g": "positive", "l": "positive"},
}
THROWN = {
    "kind": "euler-lagrange",
    "q": ["x", "y"],
    "L": "m*(x_dot**2 + y_dot**2)/2 - k*x**2/2 - m*g*y",
    "parameters": {"m": "positive", "k": "positive", "g": "positive"},
}
SPRING = {
    "kind": "legendre-hamiltonian",
    "q": ["x"],
    "p": ["p"],
    "L": "m*x_dot**2/2 - k*x**2/2",
    "parameters": {"m": "positive", "k": "positive"},
}
RATES = {
    "kind": "hamilton-equations",
    "q": ["x"],
    "p": ["p"],
    "H": "p**2/(2*m) + k*x**2/2",
    "parameters": {"m": "positive", "k": "positive"},
}
NUMBER = {"kind": "number", "value": "3", "tolerance": "1 %"}


def judged(question: Mapping[str, object], **keys: object):
    claim = claim_from({"id": "a", **question, **keys})
    assert not claim.errors
    return [judgement for judgement, _ in judgements(claim)][-1]


def right_and_wrong(
    question: Mapping[str, object], typed: str, signs: str = "-+", key: str = "claim"
) -> None:
    """Assert that a text holds with the first sign in place of ``@``, and fails with the second."""
    for sign, status in zip(signs, ("holds", "fails"), strict=True):
        found = judged(question, **{key: typed.replace("@", sign)})
        assert found.status == status, (typed.replace("@", sign), found.known)


def asked(question: Mapping[str, object], typed: str, said: str, key: str = "claim") -> None:
    """Assert that a text is asked about."""
    found = judged(question, **{key: typed})
    assert found.status == "invalid", typed
    assert said in found.known, (typed, found.known)


FORMULA = r"\ddot\theta = @\frac{g}{l}\sin\theta"


@pytest.mark.parametrize(
    "typed",
    [
        "- ${}$", "* ${}$", "• ${}$", "– ${}$", "— ${}$", "+ ${}$", r"- \({}\)", r"- \[{}\]", "- $${}$$", "•${}$",
        "a) - ${}$", "(1) - ${}$", "1. - ${}$", "Equation of motion:\n- ${}$", "Equation of motion:\n\n- ${}$.",
        "- ${}$ (1)", "- ${}$,", "we get - ${}$", "so - ${}$", "therefore - ${}$", "The equation of motion is - ${}$",
        "Equation of motion - ${}$", "Equation of motion: - ${}$", "- Equation of motion: ${}$", "EOM – ${}$",
        "Answer — ${}$", "We find – ${}$", "  - ${}$", "The answer is — ${}$", "> - ${}$", "**Answer:** - ${}$",
        "thus,\n- ${}$", "∴ - ${}$", "=> - ${}$", "- **θ'' = @(g/l) sin θ**", "- `θ'' = @(g/l) sin θ`", "-\t${}$",
        "- (1) ${}$", "Result:- ${}$", "Hence —${}$",
    ],
)  # fmt: skip
def test_a_mark_before_dollars_is_a_bullet(typed: str) -> None:
    right_and_wrong(PENDULUM, typed.replace("{}", FORMULA))


@pytest.mark.parametrize(
    "typed",
    [
        "- $m\\ddot x = @kx$\n- $m\\ddot y = -mg$",
        "* $m\\ddot x = @kx$\n* $m\\ddot y = -mg$",
        "• $m\\ddot x = @kx$\n• $m\\ddot y = -mg$",
        "+ $m\\ddot x = @kx$\n+ $m\\ddot y = -mg$",
        "– $m\\ddot x = @kx$\n– $m\\ddot y = -mg$",
        "The equations of motion:\n- $m\\ddot x = @kx$\n- $m\\ddot y = -mg$",
        "- $m\\ddot x = @kx$\n\n- $m\\ddot y = -mg$",
        "- x'' = @k/m x\n- y'' = -g",
        "* x'' = @k/m x\n* y'' = -g",
        "• x'' = @k/m x\n• y'' = -g",
        "Equations:\n- x'' = @k/m x\n- y'' = -g",
        "- x: m x'' = @k x\n- y: m y'' = -m g",
        "1. - $m\\ddot x = @kx$\n2. - $m\\ddot y = -mg$",
        "$m\\ddot x = @kx$\n- $m\\ddot y = -mg$",
        "- \\(m\\ddot x = @kx\\)\n- \\(m\\ddot y = -mg\\)",
        "- $m\\ddot x = @kx$,\n- $m\\ddot y = -mg$.",
        "- $m\\ddot x = @kx$, - $m\\ddot y = -mg$",
        "- $m\\ddot x = @kx$; - $m\\ddot y = -mg$",
    ],
)
def test_several_rows_with_one_mark_are_a_list(typed: str) -> None:
    right_and_wrong(THROWN, typed)


@pytest.mark.parametrize(
    "typed", ["- $\\frac{p^2}{2m}@\\frac12kx^2$", "The Hamiltonian is - $\\frac{p^2}{2m}@\\frac12kx^2$"]
)
def test_an_expression_in_dollars_behind_a_bullet(typed: str) -> None:
    right_and_wrong(SPRING, typed, "+-", key="H")


def test_components_behind_bullets() -> None:
    said = {"q_dot": "- $\\frac{p}{m}$", "p_dot": "- $-kx$"}
    assert judged(RATES, **said).status == "holds"
    assert judged(RATES, **{**said, "p_dot": "- $kx$"}).status == "fails"
    assert judged(RATES, **{**said, "q_dot": "- $-\\frac{p}{m}$"}).status == "fails"


@pytest.mark.parametrize(
    "typed",
    [
        "- θ'' = -(g/l) sin θ",
        "– θ'' = (g/l) sin θ",
        "a) - θ'' = -(g/l) sin θ",
        "Equation of motion:\n- θ'' = -(g/l) sin θ",
        "-$\\ddot\\theta = \\frac gl\\sin\\theta$",
        "- $\\ddot\\theta$ = $\\frac gl\\sin\\theta$",
        "- \\ddot\\theta = -\\frac gl\\sin\\theta",
        "- -θ'' = (g/l) sin θ",
        "∴ - θ'' = (g/l) sin θ",
        r"1 - $\ddot\theta=-\frac gl\sin\theta$",
        "⇒ - θ'' = (g/l) sin θ",
        r"\therefore - \ddot\theta = \frac gl\sin\theta",
    ],
)
def test_a_dash_that_may_be_a_minus_is_asked_about(typed: str) -> None:
    asked(PENDULUM, typed, "or a minus")


@pytest.mark.parametrize(
    "typed",
    ["we get - θ'' = -(g/l) sin θ", "so - θ'' = (g/l) sin θ", "therefore – θ'' = (g/l) sin θ",
     "The equation of motion is - θ'' = (g/l) sin θ", "Equation of motion: - θ'' = (g/l) sin θ",
     r"Hence -$\ddot\theta=\frac gl\sin\theta$", r"The answer is -$\ddot\theta=\frac gl\sin\theta$"],
)  # fmt: skip
def test_a_dash_behind_words_that_lead_to_an_equation_is_asked_about(typed: str) -> None:
    asked(PENDULUM, typed, "or is it a minus")


@pytest.mark.parametrize(
    "typed",
    ["Equation of motion - θ'' = @(g/l) sin θ", "EOM – θ'' = @(g/l) sin θ", "Answer — θ'' = @(g/l) sin θ",
     "Solution -- θ'' = @(g/l) sin θ", "Equation of motion - \\ddot\\theta = @\\frac gl\\sin\\theta"],
)  # fmt: skip
def test_a_dash_behind_a_title(typed: str) -> None:
    right_and_wrong(PENDULUM, typed)


@pytest.mark.parametrize(
    "typed",
    ["-θ'' = @(g/l) sin θ", "-\\ddot\\theta = @\\frac gl\\sin\\theta", "- \\frac gl\\sin\\theta = @\\ddot\\theta",
     "− θ'' = @(g/l) sin θ", "$- \\ddot\\theta = @\\frac gl\\sin\\theta$",
     "$$\n- \\ddot\\theta = @\\frac gl\\sin\\theta\n$$",
     "θ'' =\n- (-1)*(@1)*(-g/l) sin θ", "so -θ'' = @(g/l) sin θ"],
)  # fmt: skip
def test_a_minus_stays_a_minus(typed: str) -> None:
    right_and_wrong(PENDULUM, typed, "+-")


def test_numbers_behind_a_dash() -> None:
    for typed in ("- $3$", "- $-3$", "The answer is - $3$", "Answer - 3"):
        asked(NUMBER, typed, "minus")
    assert judged(NUMBER, claim="Answer — 3").status == "holds"
    assert judged(NUMBER, claim="Answer — -3").status == "fails"
    assert judged({**NUMBER, "value": "-3"}, claim="- 3").status == "holds"
    assert judged({**NUMBER, "value": "-3"}, claim="Answer: - 3").status == "holds"
    assert judged({**NUMBER, "value": "-3"}, claim="-$3$").status == "holds"


@pytest.mark.parametrize(
    "number",
    ["-- (1)", "--- (i)", "— (1)", "-(i)", "- (1)", "– (2)", "... (1)", "…(3)", "- (2.1)", "-- (1a)", "-(ii)",
     ".....(4)", "-- (a)", "-- (*)"],
)  # fmt: skip
def test_numbers_of_an_equation_whose_right_side_is_zero(number: str) -> None:
    right_and_wrong(PENDULUM, f"θ'' @ (g/l) sin θ = 0 {number}", "+-")
    right_and_wrong(PENDULUM, f"θ'' @ (g/l) sin θ = 0 {number}.", "+-")


@pytest.mark.parametrize(
    "number",
    [r"\dots(1)$", r"\ldots (1)$", r"\cdots (2)$", r"\quad\dots(1)$", r"--- (1)$", r"-- (i)$", "$ (1)", "$ (ii)",
     "$ -- (1)", "$ - (1)", "$ ... (1)", "$, (1)", "$. (3)", "$ \\dots (1)"],
)  # fmt: skip
def test_numbers_behind_a_formula_in_latex(number: str) -> None:
    right_and_wrong(PENDULUM, rf"$\ddot\theta=@\frac gl\sin\theta {number}")


def test_numbers_of_rows() -> None:
    right_and_wrong(THROWN, "m x'' = @k x -- (1)\nm y'' = -m g -- (2)")
    right_and_wrong(THROWN, "m x'' = @k x -- (1), m y'' = -m g -- (2)")
    right_and_wrong(THROWN, "$m \\ddot x = @k x$ (1)\n$m \\ddot y = -m g$ (2)")
    right_and_wrong(THROWN, "m x'' @ k x = 0 - (1)\nm y'' + m g = 0 - (2)", "+-")
    right_and_wrong(THROWN, "m x'' = @k x ... (1); m y'' = -m g ... (2)")


@pytest.mark.parametrize(
    "typed",
    [
        "θ'' = -(g/l) sin θ - (1)",
        "θ'' = -(g/l) sin θ - (i)",
        "θ'' = -(g/l) sin θ - (e)",
        "θ'' = -(g/l) sin θ - (I)",
        "θ'' = -(g/l) sin θ - (2)",
        "g = - sin θ θ'' l – (1)",
    ],
)
def test_one_dash_before_a_number_is_asked_about(typed: str) -> None:
    asked(PENDULUM, typed, "the number of this equation, or is it taken away")


def test_dashes_before_numbers_of_values() -> None:
    assert judged(NUMBER, claim="x = 3 -- (1)").status == "holds"
    assert judged(NUMBER, claim="x = 2 -- (1)").status == "fails"
    assert judged(NUMBER, claim="x = 4 -- (1)").status == "fails"
    assert judged(NUMBER, claim="x = 4 — (1)").status == "fails"
    assert judged(NUMBER, claim="4 - (1)").status == "holds"
    assert judged(NUMBER, claim="1 - (1)").status == "fails"
    for typed in ("x = 3 - (1)", "x = 4 - (1)"):
        asked(NUMBER, typed, "or is it taken away")
    for typed in ("3 -- (1)", "2 -- (1)", "2 --- (1)"):
        asked(NUMBER, typed, "or is it taken away")
    damped = {
        **PENDULUM,
        "L": "l**2*theta_dot**2/2 + g*l*cos(theta) + c*theta",
        "parameters": dict.fromkeys("glc", "real"),
    }
    for typed in (
        "l² θ'' + g l sin θ = 0 - (c)",
        "l² θ'' + g l sin θ = 0 -- (c)",
        "l² θ'' = -g l sin θ -(c)",
    ):
        asked(damped, typed, "or is it taken away")
    asked(SPRING, "H = p²/2m + ½kx² - (1)", "or is it taken away", key="H")


@pytest.mark.parametrize(
    "typed",
    [
        r"\begin{align} x:\quad & m\ddot x = @kx\\ y:\quad & m\ddot y = -mg \end{align}",
        r"\begin{align*} x: && m\ddot x &= @kx\\ y: && m\ddot y &= -mg \end{align*}",
        r"\begin{array}{ll} x: & m\ddot x = @kx \\ y: & m\ddot y = -mg \end{array}",
        r"\begin{cases} x: & m\ddot x = @kx \\ y: & m\ddot y = -mg \end{cases}",
        r"$x$: $m\ddot x = @kx$; $y$: $m\ddot y = -mg$",
        "$x$: $m\\ddot x = @kx$\n$y$: $m\\ddot y = -mg$",
        r"x: m\ddot x = @kx \\ y: m\ddot y = -mg",
        "$x:\\ m\\ddot x = @kx$\n$y:\\ m\\ddot y = -mg$",
        "x-direction: m x'' = @kx\ny-direction: m y'' = -mg",
        "x-component: $m\\ddot x = @kx$\ny-component: $m\\ddot y = -mg$",
        "$x$-direction: $m\\ddot x = @kx$; $y$-direction: $m\\ddot y = -mg$",
        r"\begin{align}\text{x-direction: } & m\ddot x = @kx\\ \text{y-direction: } & m\ddot y = -mg \end{align}",
        r"\begin{align}\text{For } x: & m\ddot x = @kx\\ \text{For } y: & m\ddot y = -mg \end{align}",
        "For $x$: $m\\ddot x = @kx$\nFor $y$: $m\\ddot y = -mg$",
        "horizontal: m x'' = @kx\nvertical: m y'' = -mg",
        "x: m x'' = @kx\ny: m y'' = -mg",
        "x equation: m x'' = @kx; y equation: m y'' = -mg",
    ],
)
def test_labels_of_rows(typed: str) -> None:
    right_and_wrong(THROWN, typed)
    right_and_wrong(THROWN, typed.replace("-mg", "#mg").replace("@", "-").replace("#", "@"))


@pytest.mark.parametrize(
    "typed",
    [
        r"$\theta$: $\ddot\theta=@\frac gl\sin\theta$",
        r"\theta: \ddot\theta=@\frac gl\sin\theta",
        "For θ: θ'' = @g/l sin θ",
        "θ: θ'' = @g/l sin θ",
        r"- $\theta$: $\ddot\theta=@\frac gl\sin\theta$",
        "θ-direction: θ'' = @g/l sin θ",
    ],
)
def test_labels_of_one_equation(typed: str) -> None:
    right_and_wrong(PENDULUM, typed)


def test_a_name_before_a_colon_that_is_no_label_is_asked_about() -> None:
    asked(THROWN, r"x:\quad m\ddot y = -mg \\ y:\quad m\ddot x = -kx", "is x: the label of this equation")
    asked(PENDULUM, r"$\theta$: $g = 0$", "the label of this equation")


@pytest.mark.parametrize(
    "said", ["wrong: {}", "wrong equation: {}", "not: {}", "k = 0: {}", "no direction: {}"]
)
def test_other_words_before_a_colon_are_no_labels(said: str) -> None:
    assert judged(PENDULUM, claim=said.format("θ'' = -(g/l) sin θ")).status in ("invalid", "fails")
    formula = r"$\ddot\theta = -\frac gl\sin\theta$"
    assert judged(PENDULUM, claim=said.format(formula)).status in ("invalid", "fails")


@pytest.mark.parametrize(
    "typed",
    ["x'' @ (k/m)x = 0. y'' = -g.", "x'' @ (k/m)x = 0.  y'' + g = 0.", r"\ddot x @ \frac km x = 0. \ddot y = -g",
     r"$\ddot x @ \frac km x = 0. \ddot y = -g$", "y'' = -2.0*g + 1.0*g + 0.0. x'' @ (k/m)x = 0."],
)  # fmt: skip
def test_a_sentence_ends_behind_a_number(typed: str) -> None:
    right_and_wrong(THROWN, typed, "+-")


def test_a_full_stop_that_may_belong_to_a_number() -> None:
    asked(THROWN, "x'' + (k/m)x = 1. y'' = -g.", "or does a sentence end")
    programs = {**PENDULUM, "L": "theta_dot**2/2 + 2*cos(theta)"}
    right_and_wrong(programs, "1. theta'' = @2. sin(theta)")


@pytest.mark.parametrize(
    "said",
    ["{} (pendulum)", "{} (exact)", "{} (nonlinear ODE)", "{} (small angles)", "{} (θ-direction)", "{} (ans)",
     "{} (SHM).", "Ans. {}", "Q1: {}", "E–L: {}", "Euler–Lagrange equation: {}", "For θ: {}",
     "Euler-Lagrange equations: {}", "Q 2a: {}", "Answer. {}", "Exercise 3: {}", "Ans.: {}", "Q1: {} (pendulum)"],
)  # fmt: skip
def test_remarks_around_a_row(said: str) -> None:
    for formula in ("θ'' = @(g/l) sin θ", r"$\ddot\theta = @\frac gl\sin\theta$"):
        right_and_wrong(PENDULUM, said.replace("{}", formula))


@pytest.mark.parametrize(
    "said",
    [
        "{} (wrong)",
        "{} (not exact)",
        "{} (minus)",
        "{} (twice)",
        "{} (no pendulum)",
        "{} (wrong direction)",
        "{} (no direction)",
        "{} (not-direction)",
        "{} (anti direction)",
    ],
)
def test_other_remarks_are_left(said: str) -> None:
    for formula in ("θ'' = -(g/l) sin θ", r"$\ddot\theta = -\frac gl\sin\theta$"):
        assert judged(PENDULUM, claim=said.replace("{}", formula)).status == "invalid"


def test_remarks_of_declared_letters_are_factors() -> None:
    letters = {"kind": "equality-only", "lhs": "x*a*n*s", "parameters": dict.fromkeys("xans", "real")}
    assert judged(letters, rhs="x*(ans)").status == "holds"
    assert judged(letters, rhs="x (ans)").status != "fails"


def test_remarks_behind_rows() -> None:
    right_and_wrong(THROWN, "$m\\ddot x = @kx$ (x-direction)\n$m\\ddot y = -mg$ (y-direction)")
    right_and_wrong(THROWN, "m x'' = @k x (horizontal)\nm y'' = -m g (vertical)")
    assert judged(NUMBER, claim="3 (exact)").status == "holds"
    assert judged(NUMBER, claim="4 (exact)").status == "fails"


@pytest.mark.parametrize(
    "typed",
    [
        r"\begin{enumerate}\item $m\ddot x = @kx$ \item $m\ddot y = -mg$\end{enumerate}",
        "\\begin{itemize}\n\\item $m\\ddot x = @kx$\n\\item $m\\ddot y = -mg$\n\\end{itemize}",
        r"\begin{enumerate}[(a)]\item[(a)] $m\ddot x = @kx$ \item[(b)] $m\ddot y = -mg$\end{enumerate}",
        "m x'' = \u2010k x\nm y'' = @m g".replace("\u2010", "-"),
        "m x\u200b'' = @k x\u200b; m y'' = \u2010m g",
        "m x'' = @\u00adk x; m y'' = \u2011m g",
        "m x'' = \u2011k x; m y'' = @m g",
        r"\mathbf{m\ddot x = @kx, \quad m\ddot y = -mg}",
        "- \\item $m\\ddot x = @kx$\n- \\item $m\\ddot y = -mg$",
        r"{\color{red} m\ddot x = @kx, \quad m\ddot y = -mg}",
    ],
)
def test_dress_of_rows(typed: str) -> None:
    right_and_wrong(THROWN, typed)


@pytest.mark.parametrize(
    "typed",
    [r"\mathbf{\ddot\theta=@\frac gl\sin\theta}", r"$\boldsymbol{\ddot\theta=@\frac gl\sin\theta}$",
     r"{\color{red}\ddot\theta=@\frac gl\sin\theta}", r"${\color{blue}\ddot\theta=@\frac gl\sin\theta}$",
     r"\cancel{m}l\ddot\theta=@\cancel{m}g\sin\theta", r"$\cancel{l}\ddot\theta l=@\cancel{l}g\sin\theta$",
     r"\begin{enumerate}\item $\ddot\theta=@\frac gl\sin\theta$\end{enumerate}"],
)  # fmt: skip
def test_dress_of_one_equation(typed: str) -> None:
    right_and_wrong(PENDULUM, typed)


@pytest.mark.parametrize(
    "typed",
    [r"\cancel{m}l\ddot\theta + g=-\cancel{m}g\sin\theta", r"\cancel{m}l\ddot\theta=-g\sin\theta",
     r"\cancel{m}l\ddot\theta=-\cancel{n}g\sin\theta", r"\cancel{l\ddot\theta}+\ddot\theta l=-g\sin\theta"],
)  # fmt: skip
def test_what_is_struck_out_otherwise_is_not_read(typed: str) -> None:
    assert judged(PENDULUM, claim=typed).status == "invalid"
