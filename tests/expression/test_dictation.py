"""Dictation: a formula in words is read where a listener would hear one, and left alone where two could be heard."""

from __future__ import annotations

import pytest
import sympy as sp

from canon import coordinates, parameters
from canon.expression import LanguageError, Scope, parse_equation
from canon.expression.sentences.dictation import written_from_dictation

x, y, theta = coordinates("x y theta")
a, b, c, k, m = PARAMETERS = parameters("a b c k m")
SCOPE = Scope({s.name: s for s in (x, y, theta, *PARAMETERS)})


@pytest.mark.parametrize(
    ("said", "meant", "other"),
    [
        ("m times the quantity x dot squared plus y dot squared", m * (x.dot**2 + y.dot**2), "m times x dot squared"),
        ("m the quantity x plus a", m * (x + a), "m the quantity x minus a"),
        ("the quantity x squared minus a squared", x**2 - a**2, "the quantity x squared plus a squared"),
        ("minus m times the quantity x plus a", -m * (x + a), "m times the quantity x plus a"),
        ("x dot equals k times the quantity x plus a", x.dot - k * (x + a), "x dot equals k times x, plus a"),
        ("m times the quantity k times x plus a", m * (k * x + a), "m times the quantity k times x minus a"),
        ("x dot equals minus a, plus b", x.dot + a - b, "x dot equals minus a, minus b"),
        ("m times the sine of theta", m * sp.sin(theta), "m times the cosine of theta"),
    ],
)  # fmt: skip
def test_what_is_said_is_read(said: str, meant: sp.Expr, other: str) -> None:
    assert sp.expand(parse_equation(said, SCOPE) - meant) == 0
    assert sp.expand(parse_equation(other, SCOPE) - meant) != 0


@pytest.mark.parametrize(
    "said",
    [
        "x double dot equals minus k times x, over m",
        "theta dot, times a plus b",
        "a plus b, times c",
        "x double dot equals minus a, plus b minus c",
        "m over the quantity x plus a",
        "m times the quantity x squared plus a",
        "m times the quantity x plus a times k",
        "a plus m times the quantity x plus b",
        "a minus m times the quantity x plus b",
        "m times the quantity sine of theta plus a",
        "m times the quantity",
        "a plus minus b times x",
        "x dot equals",
        "x double dot equals minus the x times k",
        "sine of theta times x",
    ],
)
def test_what_could_be_heard_as_two_is_left_and_refused(said: str) -> None:
    assert written_from_dictation(said, SCOPE) == said
    with pytest.raises(LanguageError):
        parse_equation(said, SCOPE)
