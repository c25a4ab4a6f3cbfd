"""Derivatives in the shorthand of LaTeX's package physics, each with one that means something else."""

from __future__ import annotations

import pytest
import sympy as sp

from canon import coordinates, parameters
from canon.expression import LanguageError, Scope, parse_equation

NAMES = {s.name: s for s in (*coordinates("x theta"), *parameters("m k g l"))}
SCOPE = Scope(NAMES, {"V": ("x",), "W": ("x", "theta")})


@pytest.mark.parametrize(
    ("typed", "meant", "other"),
    [
        (r"m\dv[2]{x}{t} + kx = 0", "m*x_ddot + k*x", r"m\dv{x}{t} + kx = 0"),
        (r"$\odv[2]{\theta}{t} = -\frac{g}{l}\sin\theta$", "theta_ddot + g/l*sin(theta)", r"\dv[2]{\theta}{t} = 0"),
        (r"m\ddot x = -\pdv{V}{x}", "m*x_ddot + Derivative(V(x), x)", r"m\ddot x = \pdv{V}{x}"),
        (r"\pdv[2]{V}{x}", "Derivative(V(x), x, x)", r"\pdv{V}{x}"),
        (r"\partialderivative{W}{x}{\theta}", "Derivative(W(x, theta), x, theta)", r"\pdv[2]{W}{x}"),
        (r"\dv{t}\qty(m l^2 \dv{\theta}{t}) = 0", "m*l**2*theta_ddot", r"\dv{t}\qty(m l^2 \theta) = 0"),
        (r"\derivative{x}{t}", "x_dot", r"\derivative[2]{x}{t}"),
    ],
)  # fmt: skip
def test_derivatives_are_read(typed: str, meant: str, other: str) -> None:
    value = parse_equation(meant, SCOPE)
    assert sp.expand(parse_equation(typed, SCOPE) - value) == 0
    assert sp.expand(parse_equation(other, SCOPE) - value) != 0


@pytest.mark.parametrize("typed", [r"\dv x t", r"\pdv*{V}{x}", r"\pdv{}{}", r"\dv{m}{k}", r"\dv[0]{x}{t}"])
def test_what_is_none_is_refused(typed: str) -> None:
    with pytest.raises(LanguageError):
        parse_equation(typed, SCOPE)
