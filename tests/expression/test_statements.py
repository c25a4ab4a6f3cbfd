"""Statements: one field taken apart at its equality signs, every column kept."""

import re
import time

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from canon.expression.parse import LanguageError, Scope, statements_of
from canon.expression.text.markup import unmarked
from canon.expression.text.statement import opened, unwrapped


def said(text):
    return [[side.said for side in statement.sides] for statement in statements_of(text, Scope())]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x**2", [["x**2"]]),
        ("H = p**2/2", [["H", "p**2/2"]]),
        ("L = T - V = x'**2/2", [["L", "T-V", "x'**2/2"]]),
        ("x' = p/m; p' = -k*x", [["x'", "p/m"], ["p'", "-k*x"]]),
        ("x' = p/m, p' = -k*x", [["x'", "p/m"], ["p'", "-k*x"]]),
        ("x' = p/m and p' = -k*x\n", [["x'", "p/m"], ["p'", "-k*x"]]),
        ("p = m*v ⇒ H = p**2/2", [["p", "m*v"], ["H", "p**2/2"]]),
        ("{L_z, x} = y", [["{L_z,x}", "y"]]),
        ("F_2(q, P) = q*P", [["F_2(q,P)", "q*P"]]),
        ("x == 1", [["x", "1"]]),
        ("0 < x <= 1", [["0<x<=1"]]),
        ("x != 1", [["x!=1"]]),
        ("atan2(x = 1, y)", [["atan2(x=1,y)"]]),
        ("land = 1", [["land", "1"]]),
        ("(x = 1", [["(x=1"]]),
        ("", [[""]]),
    ],
)
def test_taken_apart(text, expected):
    assert said(text) == expected


@given(st.text("ab=;, \n(){}'and", max_size=60))
def test_nothing_is_lost_and_every_column_stays(text):
    assume(
        not re.search(r"^\s*\(?[ab]\)[ \t]|[ \t]\([ab]\)\s*$", text)
    )  # the letter of a part: test_remarks.py
    try:
        statements = statements_of(text, Scope())
    except LanguageError as error:
        assume("a drawing of the formula" not in error.reason)
        raise
    at = 0
    for statement in statements:
        for side in statement.sides:
            piece = side.text.strip()
            assert text[side.column - 1 :].startswith(piece)
            assert side.column - 1 >= at or not piece
            at = max(at, len(side.text))
    shown = "".join(side.text.strip() for s in statements for side in s.sides)
    assert [c for c in shown if c in "b("] == [c for c in unwrapped(text) if c in "b("]


@pytest.mark.parametrize(
    "text", ["=" * 50_000, "x=1," * 12_000, "x=1;" * 12_000, "," * 50_000, "(" * 50_000, "x\n" * 25_000]
)
def test_what_nobody_writes_costs_no_time(text):
    start = time.process_time()
    try:
        found = len(statements_of(text, Scope()))
    except LanguageError:
        found = 0
    assert found <= 100
    assert time.process_time() - start < 2.0


def test_no_blank_is_needed_behind_a_comma():
    assert said("x' = p,p' = -x") == said("x' = p, p' = -x") == [["x'", "p"], ["p'", "-x"]]


def test_rows_of_a_table_in_mathml_are_statements():
    row = "<mtr><mtd><mi>{}</mi><mo>=</mo><mn>{}</mn></mtd></mtr>"
    table = f"<math><mtable>{row.format('x', 1)}{row.format('y', 2)}</mtable></math>"
    assert said(table) == [["x", "1"], ["y", "2"]]
    assert said(table.replace("</mtr><mtr>", "")) != [["x", "1"], ["y", "2"]]


def test_a_definition_in_brackets_is_taken_out_where_they_close():
    assert opened("x = a (k = b)") == "x = a ,k = b "
    assert opened("x = a (k = b) c)") == "x = a (k = b) c)"


@pytest.mark.parametrize(
    ("typed", "bare"), [("**__`2*m`__**", "2*m"), ("**__`*2*m*`__**", "*2*m*"), ("**2*m", "**2*m")]
)
def test_three_marks_may_stand_around_a_formula(typed, bare):
    assert unmarked(typed) == bare


def test_a_lone_dash_between_two_letters_is_the_bar_of_a_drawn_fraction():
    drawn = "    a    \nH = - + b\n    m    "
    with pytest.raises(LanguageError, match="a drawing of the formula over several lines") as caught:
        unmarked(drawn)
    assert caught.value.column == 11
    assert unmarked(drawn.replace("-", "*")) == drawn.replace("-", "*")
