"""Formulas that SymPy draws: those on one line are read, drawings over several lines are told as such."""

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.expression.parse import LanguageError, Scope, parse_expression, statements_of
from canon.expression.symbols.symbol import coordinates, parameters

(theta,) = (coordinates("theta"),)
m, l, k = parameters("m l k", positive=True)
SCOPE = Scope({s.name: s for s in (theta, m, l, k)})
of_time = sp.Function("theta")(sp.Symbol("t"))
leaves = st.sampled_from(
    [m, l, k, of_time, of_time.diff(sp.Symbol("t")), sp.Integer(2), sp.pi, sp.Rational(1, 2)]
)
formulas = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.builds(lambda a, b: a + b, inner, inner),
        st.builds(lambda a, b: a * b, inner, inner),
        st.builds(lambda a, b: a / (1 + b**2), inner, inner),
        st.builds(lambda a, n: a**n, inner, st.sampled_from([2, 3, k, sp.Rational(1, 3)])),
        inner.map(sp.sin),
        inner.map(lambda a: sp.exp(-a)),
        inner.map(lambda a: sp.sqrt(1 + a**2)),
        inner.map(sp.Abs),
    ),
    max_leaves=4,
)


@settings(max_examples=60, deadline=None)
@given(formulas, st.booleans())
def test_a_drawing_is_read_rightly_or_told(formula, unicode):
    drawn = sp.pretty(formula, use_unicode=unicode, wrap_line=False)
    if "\n" in drawn:
        with pytest.raises(LanguageError, match=r"latex\("):
            statements_of(drawn, SCOPE)
        return
    found = [parse_expression(s.sides[0].text, SCOPE) for s in statements_of(drawn, SCOPE)]
    right = formula.subs(of_time.diff(sp.Symbol("t")), theta.dot).subs(of_time, theta)
    assert len(found) == 1
    point = {theta: sp.Rational(3, 7), theta.dot: sp.Rational(5, 3), m: 2, l: 3, k: sp.Rational(1, 5)}
    assert abs((found[0] - right).subs(point).evalf(20)) < 1e-15, drawn


@pytest.mark.parametrize(
    "text", ["g\n-\nl", " n\nx ", "  ___\n\\/ l ", "[m]\n[ ]\n[l]", "   / 2\\\nsin\\m /"]
)
def test_small_drawings_are_told(text):
    with pytest.raises(LanguageError, match="a drawing of the formula over several lines"):
        statements_of(text, SCOPE)


def test_lines_of_equations_are_no_drawing():
    assert len(statements_of("x' = p/m\n   p' = -k*x", SCOPE)) == 2
