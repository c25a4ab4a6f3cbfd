"""LaTeX at its edges: Unicode's letters, declared functions, derivatives of functions, brackets that do not close."""

from __future__ import annotations

import pytest
import sympy as sp

from canon import coordinates, parameters
from canon.expression import LanguageError, Scope, parse_expression
from canon.expression.latex.words import words_of
from canon.expression.symbols.symbol import Momentum

x, theta = coordinates("x theta")
a, b, c, g, hbar, l, m = PARAMETERS = parameters("a b c g hbar l m")
P = Momentum("p_x", real=True)
SCOPE = Scope({s.name: s for s in (x, theta, *PARAMETERS, P)}, {"V": ("x",)})
V = sp.Function("V", real=True)


def named(*names: str) -> Scope:
    return Scope({name: sp.Symbol(name, real=True) for name in names})


@pytest.mark.parametrize(
    ("typed", "meant", "other"),
    [
        ("$\\frac{p_x^2}{2mℓ^2}$", P**2 / (2 * m * l**2), "$\\frac{p_x^2}{2m} ℓ^2$"),
        (r"$\frac{p_x}{ℏ}$", P / hbar, r"$p_x ħ$"),
        (r"$\sin V(x)$", sp.sin(V(x)), r"$V(\sin x)$"),
        (r"$V^2(x)$", V(x) ** 2, r"$V(x^2)$"),
        (r"$\frac{d}{dt}\sin\theta$", theta.dot * sp.cos(theta), r"$\frac{d}{dt}\cos\theta$"),
        (r"$m\,d\theta/dt$", m * theta.dot, r"$d^2\theta/dt^2$"),
        ("$2x⁻¹m$", 2 * m / x, "$2x m$"),
        ("$x⁻²$", x**-2, "$x²$"),
        (r"$2 \cdot (3)$", sp.Integer(6), r"$2 \cdot (4)$"),
        (
            r"$\begin{cases} (x) & x > 0 \\ 0 & \text{otherwise} \end{cases}$",
            sp.Piecewise((x, x > 0), (0, True)),
            r"$\begin{cases} (x) & x < 0 \\ 0 & \text{otherwise} \end{cases}$",
        ),
    ],
)  # fmt: skip
def test_what_is_read_is_what_is_printed(typed: str, meant: sp.Expr, other: str) -> None:
    assert parse_expression(typed, SCOPE) == meant != parse_expression(other, SCOPE)


@pytest.mark.parametrize(
    ("typed", "column", "told"),
    [
        (r"$\sin\theta\frac{g}{l}$", 12, r"the argument of sin\? sin\(theta\) \(…\) or sin\(theta \(…\)\)"),
        (r"$\cos x\left(a + b\right)$", 13, "still belong to the argument of cos"),
        (r"$\sin V(x) a$", 12, r"sin\(V\(x\)\) a or sin\(V\(x\) a\)"),
        (r"$\frac{dV}{dx^a}$", 8, r"d is not declared; a derivative is written \\frac\{dV\}\{dx\}"),
        (r"$\sin\frac{d}{dt}x$", 2, "sin needs its argument"),
        (r"$V^{-1}(x)$", 2, r"V takes no subscript and no inverse; write V\(…\)"),
        (r"$V^2(x)^2$", 9, "two exponents of V; write one"),
        (r"$\frac{d}{dt}\sin\theta\dot x$", 2, "the derivative of what"),
        (r"$m/dt$", 4, "d is not declared"),
        (r"$a^{-1}/bc$", 8, r"a\^-1/b c can be \(a\^-1/b\) c or a\^-1/\(b c\)"),
        (r"$x_{}$", 4, "an empty subscript"),
        (r"$x_{{}}$", 4, "an empty subscript"),
        (r"$\dot{x_1}_2$", 11, r"a second subscript; write one, q_\{12\}"),
        (r"$x\theta (2)$", 10, r"\(2\) may be a factor, or the number of the equation"),
        (r"$\begin{cases} (x & x > 0 \\ 0 & \text{otherwise} \end{cases}$", 16, r"^column 16: \( is never closed\n"),
        (r"$\begin{cases} x & x > (0 \\ 0 & \text{otherwise} \end{cases}$", 24, r"^column 24: \( is never closed\n"),
        (r"$\begin{cases} {(x & x > 0 \\ 0 & \text{otherwise} \end{cases}$", 16, r"^column 16: \{ is never closed\n"),
        (r"$(x & \\ m$", 2, r"\( is never closed"),
    ],
)  # fmt: skip
def test_what_is_refused_says_where_and_why(typed: str, column: int, told: str) -> None:
    with pytest.raises(LanguageError, match=told) as caught:
        parse_expression(typed, SCOPE)
    assert caught.value.column == column


@pytest.mark.parametrize(
    ("typed", "scope", "told"),
    [
        (
            r"$\theta$",
            named("vartheta", "th"),
            "this could be vartheta or th; both are declared; rename one of them",
        ),
        ("$i x$", named("x", "I"), "i is not declared, and I is; write I for the symbol"),
        ("$xasinh$", named("x", "a"), "xasinh can be read in several ways; put spaces between the names"),
        (r"$\frac{d x}{d a}$", named("x", "a", "d"), r"d is declared, so this is a derivative or a quotient"),
    ],
)
def test_what_names_leave_open_is_asked(typed: str, scope: Scope, told: str) -> None:
    with pytest.raises(LanguageError, match=told):
        parse_expression(typed, scope)


def test_one_spelling_of_a_letter_and_one_reading_of_a_word_are_enough() -> None:
    assert parse_expression(r"$\theta$", named("vartheta")) == sp.Symbol("vartheta", real=True)
    assert parse_expression("$i x$", named("x")) == sp.I * sp.Symbol("x", real=True)
    assert parse_expression("$xasinh x$", named("x")) == sp.Symbol("x", real=True) * sp.asinh(
        sp.Symbol("x", real=True)
    )


def test_a_declared_d_that_stands_in_a_denominator_alone_is_a_factor() -> None:
    scope = named("x", "m", "d")
    m, d = scope.names["m"], scope.names["d"]
    assert (
        parse_expression(r"$\frac{m x}{d x}$", scope) == m / d != parse_expression(r"$\frac{m x}{d}$", scope)
    )
    with pytest.raises(LanguageError, match="neither a quotient nor a derivative"):
        parse_expression(r"$\frac{m x}{d x}$", named("x", "m"))


def test_the_reader_of_words_has_its_own_bound() -> None:
    assert len(words_of("x" + "+x" * 9, SCOPE).words) == 19
    with pytest.raises(LanguageError, match="50001 characters, and at most 50000 are read; split the claim"):
        words_of("x" + " " * 50_000, SCOPE)
