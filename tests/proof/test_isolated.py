"""Linear bounds on one symbol mean the same however they are written."""

import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.proof.domain.domain import Domain
from canon.proof.domain.relations import isolated
from canon.proof.vanish import vanishes

x, y = sp.symbols("x y", real=True)
FRACTIONS = st.fractions(-3, 3, max_denominator=7)


@given(FRACTIONS.filter(bool), FRACTIONS, FRACTIONS, st.sampled_from([sp.Lt, sp.Le, sp.Gt, sp.Ge]))
@settings(max_examples=60, deadline=None)
def test_the_same_points_satisfy_it(slope, constant, at, relation):
    a, b, place = map(sp.Rational, (slope, constant, at))
    condition = relation(a * x + b, 0, evaluate=False)
    assert isolated(condition).lhs == x
    assert isolated(condition).subs(x, place) == condition.subs(x, place)


def test_what_is_not_a_bound_on_one_symbol_stays():
    for condition in (x - y > 0, x**2 < 1, sp.Ne(2 * x, 1), x < 1):
        assert isolated(condition) == condition


def test_branches_are_found_behind_any_form_of_a_bound():
    residual = sp.asin(sp.sin(x)) - sp.pi + x
    assert vanishes(residual, Domain((2 * x > sp.pi, x - 3 * sp.pi / 2 < 0))).holds
    assert vanishes(residual, Domain((2 * x > sp.pi, x - 2 * sp.pi < 0))).fails
