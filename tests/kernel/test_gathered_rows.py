"""Long sums that were written out become sums over rows again: nothing is lost, and what differs stays apart."""

from __future__ import annotations

import functools
import itertools
from unittest import mock

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon import Gauss, Hamiltonian, Splitting, Taylor, propagate
from canon.expression.symbols.repeated_sum import sums_within, written_out
from canon.flow import checked_request
from canon.kernel.program.repeated import gathered_rows
from canon.kernel.program.repeated.gathered_rows import gathered

T = sp.Symbol("t", real=True)
SITES = 80


def variables(count):
    return sp.symbols(f"q0:{count}", real=True), sp.symbols(f"p0:{count}", real=True)


def chain(count, bond=lambda d: d**2 / 2 + d**4 / 40):
    q, p = variables(count)
    bonds = [bond(b - a) for a, b in zip((0, *q), (*q, 0), strict=True)]
    return Hamiltonian(sp.Add(*(x**2 / 2 for x in p), *bonds), q, p)


def bodies(count, mass=lambda k: 1, law=lambda r: -1 / r):
    """Bodies, x0 y0 z0 x1 …, every pair a term."""
    x = [sp.symbols(f"x{k} y{k} z{k}", real=True) for k in range(count)]
    p = sp.symbols(f"p0:{3 * count}", real=True)
    pairs = [
        mass(i) * mass(k) * law(sp.sqrt(sum((a - b) ** 2 for a, b in zip(x[i], x[k], strict=True))))
        for i, k in itertools.combinations(range(count), 2)
    ]
    kinetic = [each**2 / (2 * mass(k // 3)) for k, each in enumerate(p)]
    return Hamiltonian(sp.Add(*kinetic, *pairs), [s for body in x for s in body], p)


def rows_of(H):
    return gathered(H.H, (*H.q, *H.p), H.t)


FORMS = (
    lambda a, b, c: c * a**2,
    lambda a, b, c: sp.cos(c * (b - a)),
    lambda a, b, c: (b - a) ** 2 / 2 + c,
    lambda a, b, c: c / sp.sqrt(1 + (a - b) ** 2),
    lambda a, b, c: a * b * sp.exp(-T),
    lambda a, b, c: sp.Symbol("k") * (a - 2 * b) ** 3,
)


@settings(max_examples=50, deadline=None)
@given(
    st.lists(st.tuples(st.sampled_from(FORMS), st.integers(1, 3)), min_size=1, max_size=4),
    st.permutations(range(16)),
    st.integers(1, 5),
)
def test_nothing_of_a_sum_is_lost(forms, order, stride):
    q, p = variables(SITES)
    x = [q[16 * (k // 16) + order[k % 16]] for k in range(SITES)]
    terms = [form(x[k], x[(k + stride) % SITES], c) for form, c in forms for k in range(SITES)]
    whole = sp.Add(*terms, *(each**2 / 2 for each in p), *(each**4 for each in p))
    with mock.patch.object(gathered_rows, "_MANY", 100):
        made = gathered(whole, (*q, *p), T)
    assert sums_within(made)
    assert written_out(made) == whole
    for each in sums_within(made):  # a sum is of coordinates or of momenta
        held = each.free_symbols
        assert held.isdisjoint(q) or held.isdisjoint(p)


def test_what_has_the_same_rows_is_one_sum():
    made = rows_of(chain(600))
    sums = sums_within(made)
    assert sorted(each.length for each in sums) == [599, 600]
    assert len(sp.Add.make_args(made)) == 6  # the bonds to the walls stand beside them


def test_x10_comes_after_x9():
    """SymPy writes -x10 + x9 and -x8 + x9: by names the bonds would be of two shapes."""
    q, p = variables(1200)
    bonds = [(b - a) ** 4 for a, b in itertools.pairwise(q)]
    assert [each.length for each in sums_within(gathered(sp.Add(*bonds), (*q, *p), T))] == [1199]


def test_factors_of_their_own_are_a_column():
    q, p = variables(1000)
    whole = sp.Add(*(sp.Rational(k + 1, 7) * x**2 for k, x in enumerate(q)))
    (found,) = sums_within(gathered(whole, (*q, *p), T))
    assert len(found.columns) == 2
    assert found.doit() == whole


def test_a_factor_before_a_long_sum_is_one_of_each_term():
    q, p = variables(1000)
    k = sp.Symbol("k", positive=True)
    whole = k * sp.Add(*(sp.sin(x) for x in q)) / 2
    (found,) = sums_within(gathered(whole, (*q, *p), T))
    assert found.doit() == sp.expand(whole)


@pytest.mark.parametrize("mass", [lambda k: 1, lambda k: sp.Symbol(f"m{k}", positive=True)])
def test_all_pairs_are_pairs(mass):
    H = bodies(46, mass)
    pairs = [each for each in sums_within(rows_of(H)) if each.pairs]
    assert [len(each.columns[0]) for each in pairs] == [46]
    assert written_out(rows_of(H)) == H.H


def test_a_pair_that_is_missing_leaves_rows():
    H = bodies(46)
    pair = next(
        each for each in sp.Add.make_args(H.H) if each.has(H.q[0]) and each.has(H.q[3]) and each.has(H.q[4])
    )
    less = gathered(H.H - pair, (*H.q, *H.p), T)
    assert not any(each.pairs for each in sums_within(less))
    assert written_out(less) == H.H - pair


def test_other_shapes_stay_apart():
    q, p = variables(1000)
    whole = sp.Add(*(sp.cos(x) if k % 2 else sp.sin(x) for k, x in enumerate(q)))
    assert sorted(each.length for each in sums_within(gathered(whole, (*q, *p), T))) == [500, 500]


def test_short_and_deep_sums_stay_as_they_are():
    q, p = variables(999)
    short = sp.Add(*(x**2 for x in q))
    assert gathered(short, (*q, *p), T) is short
    q, p = variables(12)
    deep = sp.Add(*(functools.reduce(lambda f, _: sp.sin(f + 1), range(60), x) for x in q))
    with mock.patch.object(gathered_rows, "_MANY", 10):
        assert gathered(deep, (*q, *p), T) is deep


@pytest.mark.parametrize(
    ("method", "tolerance"),
    [(Splitting("kahan-li-8"), 1e-13), (Gauss(3), 1e-12), (Taylor(), 1e-13)],
)
def test_the_motion_is_that_of_the_sum_as_it_was_written(method, tolerance):
    H = chain(SITES)
    start = np.concatenate([np.sin(np.arange(SITES)), np.cos(np.arange(SITES))])
    how = {"method": method, "samples": 3, "observables": {"end": H.q[-1] ** 2, "sum": sp.Add(*H.q)}}
    if method.engine.takes_step:
        how["step"] = 0.05
    before = propagate(H, (0, 1), start, **how)
    checked_request._kept_system.cache_clear()
    with mock.patch.object(gathered_rows, "_MANY", 100):
        made = propagate(H, (0, 1), start, **how)
        assert checked_request.hamilton_equations_of(H, {}).sums
    checked_request._kept_system.cache_clear()
    assert abs(made.y - before.y).max() < tolerance
    assert abs(made.energy - before.energy).max() < 1e-11
    for name in ("end", "sum"):
        assert abs(made[name] - before[name]).max() < 1e-11


def test_a_pair_with_a_law_of_its_own_leaves_rows():
    H = bodies(46)
    pair = next(each for each in sp.Add.make_args(H.H) if each.has(H.q[0]) and each.has(H.q[3]))
    other = gathered(H.H - pair + pair**3, (*H.q, *H.p), H.t)
    assert not any(each.pairs for each in sums_within(other))
    assert pair**3 in sp.Add.make_args(other)
    assert written_out(other) == H.H - pair + pair**3


def test_work_grows_as_the_sum_does(calls):
    def work(count):
        H = chain(count)
        return calls(lambda: rows_of(H))

    assert work(2000) < 2.2 * work(1000)
