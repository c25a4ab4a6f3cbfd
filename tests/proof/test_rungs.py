"""The rungs of proofs one by one: what each decides, where it stops, and what it says then."""

import time

import pytest
import sympy as sp
from sympy import Abs, Eq, Max, Piecewise, cos, exp, log, pi, sin, sqrt

from canon.proof import Domain, equal
from canon.proof.analytic import is_analytic, proved_sign
from canon.proof.domain.domain import EVERYWHERE
from canon.proof.refute.tiny_values import other_forms
from canon.proof.rungs import groups as groups_
from canon.proof.rungs.cases import cases, eliminations
from canon.proof.rungs.groups import groups
from canon.proof.rungs.ladder import MOST_CASES, prove_each, prove_zero, refusal
from canon.proof.rungs.periods import period_of

x, y, z, a, b, c, u = sp.symbols("x y z a b c u", real=True)
n = sp.Symbol("n", integer=True)


def prove(expr, *conditions, seconds=10.0):
    return prove_zero(expr, Domain(conditions), time.monotonic() + seconds)


@pytest.mark.parametrize(
    ("reason", "said"),
    [
        (OverflowError("int too large to convert to float"), "a number is too large to be computed with"),
        (
            ValueError("Exceeds the limit for integer string conversion"),
            "a number is too large to be computed with",
        ),
        (ZeroDivisionError("fmpq"), "a denominator vanishes"),
        (TypeError("invalid comparison of complex I.\nmore"), "invalid comparison of complex I"),
        (NotImplementedError(), "it has no meaning there"),
    ],
    ids=repr,
)
def test_a_refusal_is_said_in_words(reason, said):
    assert refusal(reason) == said


def test_what_was_not_reached_in_time_is_said_to_be_so():
    late = prove_each([x, sin(x) ** 2 + cos(x) ** 2 - 1], EVERYWHERE, time.monotonic() - 1)
    assert [attempt.holds for attempt in late] == [False, False]
    assert all(attempt.obstacles == ["not finished in time"] and attempt.capped for attempt in late)
    early = prove_each([x, sin(x) ** 2 + cos(x) ** 2 - 1], EVERYWHERE, time.monotonic() + 10)
    assert [attempt.holds for attempt in early] == [False, True]


@pytest.mark.parametrize("many", [2, 5])
def test_a_claim_is_cut_into_no_more_cases_than_are_meant(many):
    names = sp.symbols(f"s1:{many + 1}", real=True)
    larger = sp.Add(*(Max(s, 1) for s in names))
    plain = sp.Add(*((s + 1 + Abs(s - 1)) / 2 for s in names))
    attempt = prove(larger - plain)
    assert attempt.holds is (many == 2)
    assert (f"more than {MOST_CASES} cases" in attempt.obstacles) is (many > 2)
    assert not prove(larger - plain + x).holds


CUBE = sp.cbrt(2)
NESTED = sqrt(4 + 2 * CUBE - 4 * CUBE**2)
"""|∛4 − 2|, which is 2 − ∛4."""


def test_a_conjugate_that_is_zero_proves_nothing_of_a_number_that_is_not():
    assert prove(NESTED - (2 - CUBE**2)).holds
    assert not prove(NESTED - (CUBE**2 - 2)).holds
    assert not prove(NESTED + (CUBE**2 - 2) + sp.Rational(1, 10**30)).holds


def test_groups_are_given_up_where_their_terms_are_many(monkeypatch):
    roots = [sqrt(x**2 + k) for k in range(1, 6)]
    product = sp.Add(*roots) * sp.Add(*roots[:4])
    found = groups(product)
    assert len(found) > 2
    assert sp.expand(sp.Add(*found) - product) == 0
    monkeypatch.setattr(groups_, "MOST_TERMS", 10)
    assert groups(product) is None


@pytest.mark.parametrize(
    ("f", "period"),
    [
        (cos(x + pi * (2 * n**2 + n)), 1),
        (cos(x + pi * n**2), 2),
        (cos(x + pi * n**2 / 3), 6),
        (cos(x + pi * (n**3 + 2 * n)), 2),
        ((3 + 4 * sp.I) ** n, 1),
        (sp.I**n * (3 + 4 * sp.I) ** n, 4),
    ],
    ids=str,
)
def test_the_period_of_whole_angles(f, period):
    """1 where all is a sign, or where nothing comes back."""
    assert period_of(f, n) == period
    if f.has(x):
        for k in range(3):
            later = f.subs(n, k + (period if period > 1 else 2)).subs(x, 1)
            assert abs(sp.N(later - f.subs(n, k).subs(x, 1), 30)) < 1e-25


def test_an_exponent_that_may_turn_beyond_a_half_turn_is_not_its_logarithm():
    claim = log(exp(sqrt(x))), sqrt(x)
    assert equal(*claim, Domain((x > 0,))).holds
    assert equal(*claim).fails
    near = equal(*claim, Domain((x > -9,)), budget=1.0)
    assert not near.fails
    assert equal(claim[0], -claim[1], Domain((x > -9,))).fails


def test_the_largest_of_functions_that_grow():
    positive = Domain((x > 0,))
    assert equal(Max(exp(x), exp(-x)), exp(x), positive).holds
    assert equal(Max(exp(sqrt(x)), exp(sqrt(x) - 1)), exp(sqrt(x)), positive).holds
    assert equal(Max(exp(sqrt(x)), exp(sqrt(x) - 1)), exp(sqrt(x) - 1), positive).fails
    both = Domain((x > 0, y > 0))
    larger = Max(exp(sqrt(x)), exp(sqrt(x) + y))
    assert not equal(larger, exp(sqrt(x) + y), both, budget=0.5).fails
    assert equal(larger, exp(sqrt(x)), both, budget=0.5).fails


def test_pieces_that_never_apply_are_no_cases():
    never = Piecewise((x, (x > 0) | (y > 0)), (y, x > 0), (z, True))
    assert y not in [case.expr for case in cases(never, EVERYWHERE)]
    assert equal(never, Piecewise((x, (x > 0) | (y > 0)), (z, True))).holds
    assert equal(never, Piecewise((x, y > 0), (y, x > 0), (z, True))).fails


def test_an_equality_with_a_factor_that_may_vanish_is_cut_by_it():
    either = Domain((Eq(sqrt(2) * a * x - b * x, 0),))
    assert equal((cos(x) - 1) * (sqrt(2) * a - b), 0, either).holds
    assert not equal((cos(x) - 2) * (sqrt(2) * a - b), 0, either).holds


def test_a_slope_that_is_zero_in_disguise_is_not_divided_by():
    nought = (sqrt(2) + sqrt(3)) ** 2 - 5 - 2 * sqrt(6)
    domain = Domain((Eq(nought * x + y, 1),))
    assert [s for s, _, _ in eliminations(domain, set())] == [y]
    assert prove(y**2 - 1, *domain.conditions).holds
    assert not prove(y**2 - 2, *domain.conditions).holds


@pytest.mark.parametrize(
    ("assumed", "right"),
    [
        ({"negative": True}, -x),
        ({"positive": True}, x),
        ({"nonpositive": True}, -x),
        ({"nonnegative": True}, x),
    ],
)
def test_what_a_removed_symbol_was_declared_to_be_is_kept(assumed, right):
    bound = Domain((Eq(sp.Symbol("b", **assumed), x),))
    assert equal(Abs(x), right, bound).holds
    assert equal(Abs(x), -right, bound).fails


@pytest.mark.parametrize("most", [1, 60])
def test_what_begins_anew_too_often_is_left_open(most, monkeypatch):
    for room in ("analytic", "rungs.ladder", "refute.tiny_values"):
        monkeypatch.setattr(f"canon.proof.{room}.MOST_STARTS", most)
    halves = sin(5 * x / 6) - sin(x / 2) * cos(x / 3) - cos(x / 2) * sin(x / 3)
    attempt = prove(halves)
    assert attempt.holds is (most > 1)
    assert ("arguments without a common part" in attempt.obstacles) is (most == 1)
    together = prove_each([halves, halves * y], EVERYWHERE, time.monotonic() + 10)
    assert all(each.holds is (most > 1) for each in together)
    assert proved_sign(2 + halves, EVERYWHERE) == ("+" if most > 1 else "")
    assert bool(list(other_forms(halves + x, EVERYWHERE, time.monotonic() + 10))) is (most > 1)


def test_elliptic_functions_are_analytic_but_for_poles_inside():
    from canon.expression.symbols.jacobi_functions import jacobi_am, jacobi_sn

    for f in (jacobi_sn, jacobi_am):
        assert is_analytic([f(x, y)], EVERYWHERE)
        assert not is_analytic([f(1 / x, y)], EVERYWHERE)
        assert is_analytic([f(1 / x, y)], Domain((x > 1,)))
