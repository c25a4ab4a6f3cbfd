"""Candidates that are not built: their values are those of the trees, and what is told is what the trees would tell."""

from itertools import islice

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.exercise.diagnose.diagnosis_search import diagnosis
from canon.exercise.diagnose.repairs.slips import plain_variants, variants
from canon.exercise.diagnose.repairs.unbuilt import Joined, Place, Values, Within, built, product
from canon.exercise.report.sentences import sentence
from canon.proof.domain.balls import NotDecided, Undefined, precision, value
from tests.exercise.slips_of_students import wrong_answers

x, y, m = SYMBOLS = sp.symbols("x y m", positive=True)
POINT = {x: sp.Rational(3, 7), y: sp.Rational(5, 11), m: sp.Rational(13, 9)}
SAMPLE = 12


def expressions():
    leaves = st.sampled_from((x, y, m, sp.Integer(2), sp.Rational(1, 3), x**2))
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            st.lists(inner, min_size=2, max_size=3).map(lambda terms: sp.Add(*terms)),
            st.lists(inner, min_size=2, max_size=3).map(lambda factors: sp.Mul(*factors)),
            inner.map(sp.sin),
            inner.map(sp.cosh),
            inner.map(sp.sqrt),
            inner.map(lambda f: 1 / (1 + f**2)),
        ),
        max_leaves=7,
    )


def of_trees():
    memo = {}
    return lambda f: value(f, POINT, memo)


def known(get, *what):
    try:
        return get(*what)
    except (Undefined, NotDecided):
        return None


@given(expressions())
@settings(max_examples=50, deadline=None)
def test_values_are_those_of_the_trees(f):
    with precision(256):
        of = of_trees()
        at = Values(of)
        for new, change in variants(f, SYMBOLS):
            here, there = known(at, new), known(of, built(new))
            assert (here is None) == (there is None), (f, change)
            if here is not None:
                assert (here - there).contains(0), (f, change)
                assert here.rad() < 2.0**20 * (there.rad() + 2.0**-120 * (1 + abs(there))), (f, change)


@given(expressions())
@settings(max_examples=50, deadline=None)
def test_a_slip_in_a_term_is_what_the_difference_says(f):
    """The second route: a sum with a term multiplied is the sum and a multiple of the term besides."""
    found = {sp.expand(built(new)) for new, _ in plain_variants(f)}
    terms = f.args if f.is_Add else ()
    for term in terms:
        for factor in (-1, 2, sp.Rational(1, 2), 3):
            assert sp.expand(f + (factor - 1) * term) in found


def test_what_stands_beside_a_changed_operand_is_valued_once():
    asked = []

    def of(f):
        asked.append(f)
        return value(f, POINT)

    at, place = Values(of), Place(x + y + m, 0)
    for factor in range(2, 6):
        at(Within(place, product(place.operand, sp.Integer(factor))))
    assert all(asked.count(beside) == 1 for beside in place.beside)


def test_a_factor_that_vanishes_is_divided_out_by_the_tree():
    zero = {x: sp.Integer(0), y: sp.Integer(3)}
    at = Values(lambda f: value(f, zero))
    assert (at(product(x * y, 1 / x)) - 3).is_zero()
    with pytest.raises((Undefined, NotDecided)):
        at(product(y, 1 / x))


def test_sums_of_changed_terms_are_valued_and_built():
    form = Joined(sp.Add, (Within(Place(sp.sin(x) + y, 0), x), m))
    assert built(form) in (x + y + m, sp.sin(x) + x + m)
    with precision(128):
        assert (Values(of_trees())(form) - of_trees()(built(form))).contains(0)


def test_what_is_told_is_what_the_trees_tell(monkeypatch):
    """Slips of students are explained alike where every candidate is built before it is valued."""
    findings = [answer.finding for answer in islice(wrong_answers("open", each=1), SAMPLE)]
    told = [found and sentence(found) for found in map(diagnosis, findings)]
    assert sum(map(bool, told)) > SAMPLE // 2
    monkeypatch.setattr(Values, "__call__", lambda self, f: self._of(built(f)))
    assert told == [found and sentence(found) for found in map(diagnosis, findings)]
