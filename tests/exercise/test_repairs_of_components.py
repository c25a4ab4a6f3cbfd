"""Repairs of one component by itself: values at points, quotients, lacking factors, orders, or none."""

import pytest
import sympy as sp
from flint import acb

from canon.exercise.diagnose.asymptotic import _vanishes_to
from canon.exercise.diagnose.change import Mistake
from canon.exercise.diagnose.effort import Effort
from canon.exercise.diagnose.repairs.component_screen import POINTS, Screen
from canon.exercise.diagnose.repairs.lost_factor import _simple
from canon.exercise.diagnose.repairs.repair import _as_sums, lacking, repair
from canon.exercise.explained_judgement import _short
from canon.exercise.question.question import Part
from canon.proof.domain.domain import EVERYWHERE, Domain

x, y, v, e = sp.symbols("x y v e", real=True)


def test_a_point_at_which_what_is_put_in_has_no_value_is_left_out():
    first, *_ = EVERYWHERE.points([x], POINTS, seed=11, but_functions=True)
    assert len(Screen(Part("", v, x, {v: 1 / x}), EVERYWHERE).points) == POINTS
    assert len(Screen(Part("", v, x, {v: 1 / (x - first[x])}), EVERYWHERE).points) == POINTS - 1


def test_a_quotient_is_told_where_enough_points_tell_it():
    screen = Screen(Part("", x, x), EVERYWHERE)
    points = [point[x] for point in EVERYWHERE.points([x], POINTS, seed=11, but_functions=True)]
    assert screen.quotient(3 * x, x, x) == 2
    assert screen.quotient(3 * x, x, x**2) is None
    one, two = (sp.Mul(*(x - at for at in points[:n])) for n in (1, 2))
    assert screen.quotient(x + 2 * one, x, one) == 2  # two points are left
    assert screen.quotient(x + 2 * two, x, two) is None


def test_nothing_is_repaired_where_there_is_no_point_to_look_at():
    part = Part("f", x, 2 * x)
    assert repair(part, EVERYWHERE, Effort(5.0)).change.mistake is Mistake.WRONG_FACTOR
    assert repair(part, Domain((sp.Eq(x, sp.sqrt(2)),)), Effort(5.0)) is None


@pytest.mark.parametrize(
    ("term", "mistake"), [("l/g*x", "UPSIDE_DOWN"), ("x", "FACTOR_MISSING"), ("g/l*x", "FACTOR_MISSING")]
)
def test_a_fraction_is_upside_down_only_where_it_stands(term, mistake):
    g, l = sp.symbols("g l")
    found = lacking(sp.sympify(term, {"x": x, "g": g, "l": l}), g**2 / l**2)
    assert found.mistake.name == mistake


def test_simple_rationals_are_told_from_other_numbers():
    assert _simple(acb(3) / 4) == 3 / sp.Integer(4)
    assert [_simple(z) for z in (acb(2).sqrt(), acb(1) / acb(0), acb(1, 1), acb(1) / 65)] == [None] * 4


def test_long_products_are_not_multiplied_out_to_look_at_their_terms():
    long, short = sp.Mul(*(x + k * y for k in range(1, 120))), x * (x + y)
    assert [set(terms) for terms in _as_sums(short)][-1] == {x**2, x * y}
    assert max(len(terms) for terms in _as_sums(long)) < 120


@pytest.mark.parametrize(
    ("f", "vanishes"), [(e**2 * x, True), (e**2 + e * x, False), (x + e**2, False), (1 / e, False)]
)
def test_first_coefficients_vanish_or_not(f, vanishes):
    assert _vanishes_to(f, e, 2, EVERYWHERE, Effort(5.0)) is vanishes


def test_a_residual_that_nobody_reads_is_not_shown():
    assert _short(sp.sin(x) - 1) == "sin(x) - 1"
    assert _short(sp.Add(*(sp.sin(k * x) for k in range(1, 2_000)))) == "(too long to be shown)"
