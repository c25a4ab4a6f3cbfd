"""Forms of Lisp: read where all of a text is one, and nothing else is taken for them."""

from __future__ import annotations

import pytest
import sympy as sp

from canon import coordinates, parameters
from canon.expression import LanguageError, Scope, parse_expression
from canon.expression.programs.prefix_forms import with_signs_between

x, theta = coordinates("x theta")
m, k = parameters("m k")
NAMES = {s.name: s for s in (x, theta, m, k)}
SCOPE = Scope(NAMES, {"V": ("x",)})
V = sp.Function("V", real=True)


@pytest.mark.parametrize(
    ("typed", "meant", "other"),
    [
        ("(* m (/ x))", m / x, "(* m x)"),
        ("(* m (square x))", m * x**2, "(* m (cube x))"),
        ("(* m (cube x))", m * x**3, "(* m (square x))"),
        ("(/ k m 2)", k / (2 * m), "(/ k (/ m 2))"),
        ("(* 1/2 (- x))", -x / 2, "(* 1/2 x)"),
        ("(* m (sin theta))", m * sp.sin(theta), "(* m (cos theta))"),
        ("(* m (ln k) (abs x))", m * sp.log(k) * sp.Abs(x), "(* m (ln k) x)"),
        ("(* m (V x))", m * V(x), "(* m x)"),
        ("(* m (x t))", m * x, "(* m (theta t))"),
        ("(* m ((D x) t))", m * x.dot, "(* m (((expt D 2) x) t))"),
        ("(* m (((expt D 2) x) t))", m * x.ddot, "(* m ((D x) t))"),
    ],
)
def test_forms_of_lisp_are_read(typed: str, meant: sp.Expr, other: str) -> None:
    assert parse_expression(typed, SCOPE) == meant != parse_expression(other, SCOPE)


@pytest.mark.parametrize(
    "typed",
    [
        "(* x m))",
        "(* x m",
        "(* x m) k",
        "(* x ())",
        "(* )",
        "(* x+1 m)",
        "(* m (force x))",
        "(* m (x k))",
        "(* m ((D m) t))",
        "(* m (((expt D 3) x) t))",
        "(* m " + "(" * 40 + "x" + ")" * 41,
    ],
)
def test_what_is_no_form_of_lisp_is_left_and_refused(typed: str) -> None:
    assert with_signs_between(typed, SCOPE) == typed
    with pytest.raises(LanguageError):
        parse_expression(typed, SCOPE)


def test_a_declared_letter_is_no_operator() -> None:
    scope = Scope({**NAMES, "D": parameters("D")})
    assert with_signs_between("(* m ((D x) t))", scope) == "(* m ((D x) t))"
    assert with_signs_between("(* m D)", scope) == "(m)*(D)"
