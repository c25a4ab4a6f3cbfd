"""Formulas set in MathML as they were written: what stands where on the page."""

from __future__ import annotations

from xml.etree.ElementTree import tostring

import pytest

from canon import coordinates, parameters
from canon.expression.mathml import formula
from canon.expression.text.scope import Scope

SCOPE = Scope({s.name: s for s in (*coordinates("x y"), *parameters("a n"))}, {"f": ("x",)})
ROWS = (
    '<mtable columnalign="left">'
    "<mtr><mtd><mi>x</mi></mtd><mtd><mrow><mi>x</mi><mo>&gt;</mo><mn>0</mn></mrow></mtd></mtr>"
    "<mtr><mtd><mn>0</mn></mtd><mtd><mtext>otherwise</mtext></mtd></mtr></mtable>"
)


def shown(text: str) -> str:
    found = formula(text, SCOPE)
    assert found is not None
    return tostring(found, encoding="unicode")


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("(x, a)", "(x,a)"),
        ("Integral(x**2, x)", "∫x2dx"),
        ("Integral(x**2, (x, 0, a))", "∫0ax2dx"),
        ("Piecewise((x, x > 0), 0)", "Piecewise\u2061((x,x>0),0)"),
    ],
)
def test_what_stands_on_the_line(text: str, line: str) -> None:
    found = formula(text, SCOPE)
    assert found is not None
    assert "".join(found.itertext()) == line


def test_the_order_of_a_derivative_stands_above_whether_it_is_a_number_or_not() -> None:
    assert "<msup><mo>d</mo><mn>2</mn></msup>" in shown("Derivative(f(x), (x, 2))")
    assert "<msup><mo>d</mo><mi>n</mi></msup>" in shown("Derivative(f(x), (x, a))")
    assert "<msup><mi>x</mi><mi>a</mi></msup>" in shown("Derivative(f(x), (x, a))")
    assert "<msup>" not in shown("Derivative(f(x), x)")


def test_pieces_stand_in_a_table_where_each_has_its_condition() -> None:
    assert ROWS in shown("Piecewise((x, x > 0), (0, True))")
    assert "<mtable" not in shown("Piecewise((x, x > 0), 0)")
