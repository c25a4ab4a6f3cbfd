"""What is read in one way only, and what could be two things and is asked about: each form with its neighbour."""

from __future__ import annotations

import pytest
import sympy as sp

from canon.expression import LanguageError, Scope, parse_expression
from canon.expression.symbols.symbol import Coordinate

_STEADY = {
    name: sp.Symbol(name, real=True) for name in ("a", "b", "l", "g", "n", "e", "beta", "alpha", "gamma", "v")
}
_MOVING = {name: Coordinate(name, real=True) for name in ("x", "theta", "phi_1")}
SCOPE = Scope({**_STEADY, **_MOVING})


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("g sinθ/l", "g*sin(theta)/l"),
        ("cosθ/l²", "cos(theta)/l**2"),
        ("sinθ/(2l)", "sin(theta)/(2*l)"),
        ("cosθ/sinθ", "cos(theta)/sin(theta)"),
        (r"$\cos\theta/\sin\theta$", "cos(theta)/sin(theta)"),
        (r"$x^{2}$", "x**2"),
        ("-g/l sinθ", "-g*sin(theta)/l"),
        (r"$g\sin\theta/l$", "g*sin(theta)/l"),
        (r"$\sin\theta/(2l)$", "sin(theta)/(2*l)"),
        ("sinθ(lθ̇² + g)", "sin(theta)*(l*theta_dot**2 + g)"),
        (r"$\cos\alpha(a + b)$", "cos(alpha)*(a + b)"),
        (r"$\cos\theta(x - vt)$", "cos(theta)*(x - v*t)"),
        ("2π(x + a)", "2*pi*(x + a)"),
        ("|x||a|", "Abs(x)*Abs(a)"),
        ("a|x|", "a*Abs(x)"),
        (r"$\phi1$", "phi_1"),
        (r"$\dot\phi1$", "phi_1_dot"),
        ("x(θ - at)", "x*theta - a*x*t"),
        ("e^2/l", "e**2/l"),
        ("e^n", "e**n"),
        ("e**(gamma*t)", "e**(gamma*t)"),
        ("asin(x)", "asin(x)"),
        ("a sin x", "a*sin(x)"),
    ],
)
def test_what_has_one_reading_is_read(typed: str, meant: str) -> None:
    assert sp.expand(parse_expression(typed, SCOPE) - parse_expression(meant, SCOPE)) == 0


@pytest.mark.parametrize(
    ("typed", "asked"),
    [
        ("sinθ/2", "divide the function or its argument"),
        ("sinθ/n", "divide the function or its argument"),
        ("sin x/l", "divide the function or its argument"),
        ("sinθ/(2n)", "divide the function or its argument"),
        (r"$\sin\theta/n$", r"sin\(theta\)/n or sin\(theta/n\)"),
        (r"$\sin^2\theta/2$", r"sin\(theta\)\^2/2 or sin\(theta/2\)\^2"),
        ("sinβ(x - vt)", "still belong to the argument"),
        (r"$\cos\beta(x - vt)$", "still belong to the argument"),
        ("|a|x|b|", "open or close"),
        ("x(a - t)", "applied to this"),
        ("e^(γt)", "Euler's number"),
        ("e^{-γt} e", "Euler's number"),
        (r"$e^{\gamma t}$", "Euler's number"),
        (r"$e^{i\beta}$", "Euler's number"),
        ("asin x", "asin or a sin"),
        (r"$x^{(2)}$", "derivative of x, or a power"),
    ],
)
def test_what_has_two_readings_is_asked_about(typed: str, asked: str) -> None:
    with pytest.raises(LanguageError, match=asked):
        parse_expression(typed, SCOPE)
