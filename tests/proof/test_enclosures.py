"""Values in balls: what has none, what is not decided and what is not modelled are told apart, and said in verdicts."""

import time

import pytest
import sympy as sp
from sympy import And, DiracDelta, LambertW, Not, Piecewise, Rational, Xor, besselj, sqrt

from canon.proof import equal
from canon.proof.definedness.formula_around import formula_around, holds_around, neighbourhood
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, holds_at, precision, value
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import LONGEST_PRINTED, Status, Verdict
from canon.proof.refute.refute import look_for_counterexample
from canon.proof.refute.root_branches import search_branches

x, y = sp.symbols("x y", real=True)
NOUGHT = (sqrt(2) + sqrt(3)) ** 2 - 5 - 2 * sqrt(6)
"""Zero, which no ball tells from a tiny number."""
AT_NOUGHT = {x: sp.Integer(0), y: Rational(1, 2)}


@pytest.mark.parametrize(
    ("expr", "reason", "said"),
    [
        (x**y, None, "0"),
        (x ** (-y), Undefined, "a power of zero"),
        (x**NOUGHT, NotDecided, "a power of zero"),
        (NOUGHT**y, NotDecided, "a power of something near zero"),
        (DiracDelta(x), Undefined, "DiracDelta"),
        (DiracDelta(NOUGHT, evaluate=False), NotDecided, "the impulse of something near zero"),
        (DiracDelta(y), None, "0"),
        (LambertW(-y / 4, y), Unmodelled, "LambertW of a branch that is not an integer"),
        (LambertW(sp.Integer(-1) / 8, -2 * y), None, "-3.26168"),
        (besselj(0, x), Unmodelled, "besselj is not modelled"),
        (sp.Symbol("z"), Unmodelled, "z has no value"),
    ],
    ids=str,
)
def test_a_value_or_the_reason_why_there_is_none(expr, reason, said):
    with precision(128):
        if reason is None:
            assert abs(value(expr, AT_NOUGHT) - float(said)) < 1e-5
            return
        with pytest.raises(reason, match=said):
            value(expr, AT_NOUGHT)


BOTH = And(x > 0, y > 0)
EITHER = Xor(x > 0, y > 0)


def test_conditions_are_decided_at_a_point_and_around_it():
    for there, both in (({x: 1, y: 2}, True), ({x: -1, y: 2}, False)):
        point = {s: sp.Integer(number) for s, number in there.items()}
        for holds in (holds_at, holds_around):
            assert holds(BOTH, point) is both
            assert holds(Not(BOTH), point) is not both
            with pytest.raises(Unmodelled, match="is not modelled"):
                holds(EITHER, point)
    corner = {x: sp.Integer(0), y: sp.Integer(1)}
    assert holds_at(Not(BOTH), corner)
    with pytest.raises(NotDecided):
        holds_around(Not(BOTH), corner)


def test_a_long_modulus_is_known_around_a_point_without_being_multiplied_out():
    short, long = (sp.Add(*(x**k * (y + k) for k in range(1, many))) for many in (3, 60))
    point = {x: sp.Integer(1), y: sp.Integer(1)}
    for gap in (short, long):
        assert formula_around(abs(gap - 1), point) == gap - 1
    assert neighbourhood([abs(short - 1)], point)[1] == {sp.expand(short) - 1: 1}
    assert neighbourhood([abs(long - 1)], point)[1] == {long - 1: 1}


@pytest.mark.parametrize("wrong", [besselj(1, x), 2 * besselj(0, x)], ids=str)
def test_a_verdict_says_which_function_is_not_modelled(wrong):
    """It said that no point was found where both sides have a value."""
    found = equal(besselj(0, x), wrong)
    assert found.undecided
    assert "besselj is not modelled" in str(found)
    assert "no point" not in str(found)


def test_what_was_seen_at_first_is_said_where_no_time_is_left_for_more(monkeypatch):
    """It said that no point was found where both sides have a value."""
    p = sp.Symbol("p", positive=True)
    doubled = 2 ** (2 * p - 1) / sqrt(sp.pi) * sp.gamma(p) * sp.gamma(p + Rational(1, 2))
    monkeypatch.setattr("canon.proof.vanish.SEARCH_SHARE", 0.0)
    for left, right, said in (
        (sp.gamma(2 * p), doubled, "agreement at "),
        (besselj(0, x), besselj(1, x), "besselj is not modelled"),
    ):
        found = equal(left, right)
        assert found.undecided
        assert said in str(found)
        assert "no point" not in str(found)


def test_a_verdict_says_which_condition_is_not_modelled():
    found = equal(Piecewise((x, EITHER), (y, True)), x)
    assert found.undecided
    assert "the condition (x > 0) ^ (y > 0) is not modelled" in str(found)
    assert equal(Piecewise((x, BOTH), (y, True)), x, Domain((x > 1, y > 1))).holds


def test_what_is_left_over_is_printed_where_it_is_short():
    few, many = (sp.Add(*sp.symbols(f"a:{n}")) for n in (LONGEST_PRINTED, 2 * LONGEST_PRINTED))
    assert f"left over: {few}" in str(Verdict(Status.UNDECIDED, residual=few))
    said = str(Verdict(Status.UNDECIDED, residual=many))
    assert f"left over: an expression of {2 * LONGEST_PRINTED - 1} operations (in .residual)" in said


@pytest.mark.parametrize(
    ("expr", "conditions", "found"),
    [
        (y, (sp.Eq(x**2, 2), x > 0, y >= x, y <= x), "sqrt(2)"),
        (x, (sp.Eq(x**2 - 2 * x, 1), x < 0), "1 - sqrt(2)"),
        (x, (sp.Eq(x**2 + x, -1),), None),
        (x**2 - 2, (sp.Eq(x**2, 2),), None),
    ],
    ids=str,
)
def test_a_claim_is_refuted_at_a_root_of_an_equality_that_is_real(expr, conditions, found):
    search = search_branches(expr, sp.Integer(0), Domain(conditions), time.monotonic() + 5)
    if found is None:
        assert search.counterexample is None
        return
    assert found in search.counterexample.point.values()
    assert search_branches(expr, expr, Domain(conditions), time.monotonic() + 5).counterexample is None


def test_functions_that_nothing_that_is_put_in_can_be_leave_a_claim_open():
    V, N = sp.Function("V"), sp.Function("N", integer=True)
    low = Domain((V(x) < -(10**6),))
    for left, right in ((V(x), V(x) + x), (sp.Matrix([V(x)]), sp.Matrix([V(x) + x]))):
        assert equal(left, right, low, budget=0.3).undecided
    assert equal(V(x), V(x) + x, Domain((V(x) > -5,))).fails
    assert equal(N(x), 2 * N(x), budget=0.3).undecided
    assert equal(V(x), 2 * V(x)).fails


def test_without_time_nothing_is_looked_at():
    points = [{x: sp.Integer(1)}]
    for deadline, tried in ((time.monotonic() + 5, 1), (time.monotonic() - 1, 0)):
        search = look_for_counterexample(x, x + 1, points, highest=64, deadline=deadline)
        assert search.tried == tried
        assert (search.counterexample is None) is not bool(tried)
