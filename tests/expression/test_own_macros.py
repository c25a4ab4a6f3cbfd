"""Macros that a writer of LaTeX makes, labelled braces, and quantities of siunitx: written out, or told."""

from __future__ import annotations

import pytest
import sympy as sp

from canon import coordinates, parameters
from canon.expression import LanguageError, Scope, parse_expression
from canon.expression.own_macros import without_macros
from canon.expression.siunitx import without_siunitx

x = coordinates("x")
PARAMETERS = parameters("a b c g k l m n omega")
a, b, *_, m, n, omega = PARAMETERS
SCOPE = Scope({s.name: s for s in (x, *PARAMETERS)})
LETTERS = "abcgklmn"
EIGHT = "".join(rf"\newcommand{{\q{letter}}}{{{letter}}}" for letter in LETTERS)
USED = "+".join(rf"\q{letter}" for letter in LETTERS)


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        (r"\def\w{ab}\sqrt\w", sp.sqrt(a * b)),
        (r"\def\w{ab}\frac m\w", m / (a * b)),
        (r"\def\w{ab}\frac\w m", a * b / m),
        (r"\def\w{ab}m\w", a * b * m),
        (r"\underbrace{a}_{T}x", a * x),
        (EIGHT + USED, sum(SCOPE.names[letter] for letter in LETTERS)),
        (r"\def\w{\omega}" + "+".join([r"\w"] * 24), 24 * omega),
        (r"\SI{2}{\square\metre}\,x", 2 * x),
    ],
)
def test_what_is_written_out_has_the_value_of_what_is_printed(typed: str, meant: sp.Expr) -> None:
    assert sp.simplify(parse_expression(typed, SCOPE) - meant) == 0


@pytest.mark.parametrize(
    ("typed", "told"),
    [
        (r"\def\w{ab}x^\w", r"column 1: \\def is not read; macros are not read"),
        (r"\newcommand{\rate}[2]{\frac{d #1}{d #2}}\rate{x}", r"column 1: \\newcommand is not read"),
        (EIGHT + r"\newcommand{\qx}{x}" + USED + r"+\qx", r"column \d+: \\newcommand is not read"),
        (r"\def\w{\omega}" + "+".join([r"\w"] * 25), r"column 1: \\def is not read"),
        (r"x^\underbrace{a}_{T}", r"\\underbrace is not read"),
        (r"2\underbrace{3}_{T}", r"\\underbrace is not read"),
        (r"\SI{3}{\metre/s}\,x", r"column 1: \\SI is not read"),
    ],
)
def test_what_can_not_be_written_out_is_told(typed: str, told: str) -> None:
    with pytest.raises(LanguageError, match=told):
        parse_expression(typed, SCOPE)


def test_of_nine_macros_the_last_is_left() -> None:
    typed = EIGHT + r"\newcommand{\qx}{x}" + USED + r"+\qx"
    assert without_macros(typed, SCOPE).strip() == r"\newcommand{\qx}{x}a+b+c+g+k+l+m+n+\qx"


@pytest.mark.parametrize(
    ("typed", "written"),
    [
        (r"\SI{2}{\square\metre}", r"{2\,\unit{m^{2}}}"),
        (r"\SI{2}{\cubic\metre\per\square\second}", r"{2\,\unit{m^{3}/s^{2}}}"),
        (r"\SI{2}{\square\square\metre}", r"\SI{2}{\square\square\metre}"),
        (r"\SI{2}{\metre\square}", r"\SI{2}{\metre\square}"),
        (r"\SI{3}{\metre/s}", r"\SI{3}{\metre/s}"),
    ],
)
def test_powers_before_a_unit(typed: str, written: str) -> None:
    assert without_siunitx(typed) == written
