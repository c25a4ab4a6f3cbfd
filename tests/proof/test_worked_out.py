"""Facts about expressions as they are written: the same whatever SymPy's lots are."""

from __future__ import annotations

import time

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy.core.cache import clear_cache
from sympy.core.facts import InconsistentAssumptions
from sympy.core.random import seed

from canon.exercise.claim_verdict import judge
from canon.exercise.sheet.sheet import claim_from
from canon.expression.as_written import as_written
from canon.expression.text.scope import Scope
from canon.proof.definedness.definedness import lack_of_value
from canon.proof.definedness.formula_around import put_in
from canon.proof.definedness.hazards import hazards
from canon.proof.domain.domain import EVERYWHERE
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.worked_out import known, worked_out

LOTS = range(60)


def nothing():
    """(x + 1)² − x² − 2 x − 1 at x = 0, nothing cancelled."""
    x = sp.Symbol("x", real=True)
    return put_in(as_written("(x + 1)**2 - x**2 - 2*x - 1", Scope({"x": x})), {x: sp.S.Zero})


def drawn(lot):
    """Let SymPy forget what it knows, and draw the order of its rules anew."""
    clear_cache()
    seed(lot)


def test_sympy_itself_contradicts_itself_of_it():
    """The reason for all this: where SymPy mends it, this test says so."""
    told = set()
    for lot in range(150):
        drawn(lot)
        try:
            told.add(nothing().is_zero)
        except InconsistentAssumptions:
            told.add(None)
    assert told > {True}


@pytest.mark.parametrize("lot", LOTS)
def test_what_is_written_as_a_sum_of_zeros_is_zero(lot):
    drawn(lot)
    f = nothing()
    whole = sp.Pow(f, -1, evaluate=False)
    assert known("is_zero", f) is True
    assert known("is_positive", f) is False
    assert str(hazards(anatomy([whole]).parts)[-1]) == f"its denominator {f} is zero"
    drawn(lot)
    assert lack_of_value(whole, EVERYWHERE, time.monotonic() + 10).proved


def test_pieces_of_which_none_has_a_value_have_none_together() -> None:
    x = sp.Symbol("x", real=True)
    nowhere = 1 / ((x + 1) ** 2 - x**2 - 2 * x - 1)
    lack = lack_of_value(
        sp.Piecewise((nowhere, x > 0), (2 * nowhere, True)), EVERYWHERE, time.monotonic() + 10
    )
    assert lack.proved
    assert lack.sentence("f") == "f has a value nowhere: none of its pieces has one"
    half = sp.Piecewise((nowhere, x > 0), (x, True))
    assert lack_of_value(half, EVERYWHERE, time.monotonic() + 10) is None


@pytest.mark.parametrize("lot", range(12))
def test_an_answer_without_a_value_on_the_motion_never_holds(lot):
    """It has one elsewhere, but the claim is about motions with x = 0 only."""
    drawn(lot)
    claim = {
        "id": "a", "kind": "constant-of-motion", "q": ["x", "y"], "p": ["p_x", "p_y"],
        "H": "(p_x^2 + p_y^2)/2 + x^2/2", "I": "p_y + x/((x + 1)**3 - x**3 - 3*x**2 - 3*x - 1)",
        "restrict": ["x = 0", "p_x = 0"],
    }  # fmt: skip
    assert not judge(claim_from(claim)).holds
    assert judge(claim_from({**claim, "I": "p_y + x/((x + 1)**3 - x**3 - 3*x**2 - 3*x + 1)"})).holds


numbers = st.integers(-3, 3).map(sp.Integer)
written = st.recursive(
    numbers,
    lambda inner: st.one_of(
        st.builds(lambda a, b: sp.Add(a, b, evaluate=False), inner, inner),
        st.builds(lambda a, b: sp.Mul(a, b, evaluate=False), inner, inner),
        st.builds(lambda a, n: sp.Pow(a, n, evaluate=False), inner, st.integers(1, 3).map(sp.Integer)),
    ),
    max_leaves=8,
)


def value_of(f):
    """The number that is written, by Python."""
    if f.is_Integer:
        return int(f)
    a, b = (value_of(part) for part in f.args) if len(f.args) == 2 else (value_of(f.args[0]), None)
    return {sp.Add: lambda: a + b, sp.Mul: lambda: a * b, sp.Pow: lambda: a**b}[f.func]()


@settings(max_examples=200, deadline=None)
@given(written, st.integers(0, 1000))
def test_numbers_are_known_by_their_value(f, lot):
    seed(lot)
    number = value_of(f)
    assert worked_out(f) == number
    assert known("is_zero", f) is (number == 0)
    assert known("is_positive", f) is (number > 0)
    assert known("is_negative", f) is (number < 0)
