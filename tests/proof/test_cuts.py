"""Cuts and branches of functions that are seldom written, what lies beside poles, and what is left open."""

import time

import pytest
import sympy as sp
from sympy import (
    Abs,
    Heaviside,
    Max,
    Ne,
    Piecewise,
    acsc,
    acsch,
    asec,
    asech,
    atan,
    atan2,
    besselj,
    cot,
    coth,
    csc,
    csch,
    exp,
    log,
    sech,
    sign,
    sinh,
    sqrt,
    tanh,
)

from canon.proof import Domain, equal
from canon.proof.continuity import one_sided
from canon.proof.continuity.beside_poles import meet_beside_poles
from canon.proof.continuity.branching import open_surfaces
from canon.proof.continuity.constant_steps import step_between_pieces
from canon.proof.continuity.continuity import continuity, meets
from canon.proof.continuity.hidden_jumps import hidden_jump
from canon.proof.continuity.jumps import continued, find_jump, real_sides
from canon.proof.continuity.one_sided import cuts_of
from canon.proof.domain.domain import EVERYWHERE

q, p, t = sp.symbols("q p t", real=True)
r = sp.Symbol("r", positive=True)
l = sp.Symbol("l", negative=True)
w = sp.Symbol("w", complex=True)
n = sp.Symbol("n", integer=True)


def soon():
    return time.monotonic() + 5


def gaps(f, *conditions):
    return {sp.expand(surface.gap) for surface in open_surfaces(f, [q], Domain(conditions))}


@pytest.mark.parametrize(
    ("left", "right", "wrong"),
    [
        (coth(q) ** 2 - csch(q) ** 2, sp.Integer(1), sp.Integer(-1)),
        (coth(q) * sech(q), csch(q), -csch(q)),
        (csch(q) * sinh(q), sp.Integer(1), sinh(q)),
        (coth(2 * q), (coth(q) ** 2 + 1) / (2 * coth(q)), (coth(q) ** 2 - 1) / (2 * coth(q))),
    ],
    ids=str,
)
def test_hyperbolic_functions_with_poles(left, right, wrong):
    assert equal(left, right).holds
    assert equal(left, wrong).fails


@pytest.mark.parametrize("f", [asec, acsc, asech, acsch], ids=str)
def test_inverses_of_reciprocals_are_continuous_where_they_are_real(f):
    inside = {asec: q > 1, acsc: q > 1, asech: Abs(2 * q - 1) < 1, acsch: q > 0}[f]
    assert continuity(p * f(q), [q, p], Domain((inside,))).holds
    assert continuity(p * f(q) + sign(q - sp.Rational(1, 2)), [q, p]).fails


@pytest.mark.parametrize(
    ("f", "surfaces"),
    [
        (tanh(cot(q)), {sp.sin(q)}),
        (tanh(csc(q)), {sp.sin(q)}),
        (tanh(1 / q), {q}),
        (sqrt(-q) / sqrt(q), {q}),
        (sqrt(-w * q) / sqrt(w * q), set()),
        (sqrt(1 + q**2), set()),
    ],
    ids=str,
)
def test_surfaces_that_are_left_open(f, surfaces):
    assert gaps(f) == surfaces


@pytest.mark.parametrize("large", [400, 4])
def test_long_functions_are_looked_at_as_they_stand(large, monkeypatch):
    for room in ("beside_poles", "branching", "one_sided"):
        monkeypatch.setattr(f"canon.proof.continuity.{room}.LARGE", large)
    short, rest = large > 4, 1 + p
    assert (q in gaps(sqrt(-q * rest) / sqrt(q * rest))) is short
    assert meet_beside_poles(q * rest, q * rest, q, [q], Domain((sp.Eq(q, 0),)), 1.0) is short
    assert [cut.gap for cut in cuts_of(sqrt(q**2 + p * q**2), [q])] == ([q] if short else [])
    assert any(cut.gap == q for cut in cuts_of(atan2(q * rest, t * rest), [q, t])) is short


def test_extremes_of_three_and_pieces_of_two_bounds():
    jumping = Piecewise((1, q > 0), (2, q < 0), (3, True))
    meeting = Piecewise((1, q > 0), (1, q < 0), (3, True))
    assert [cut.gap for cut in cuts_of(jumping, [q])] == [q]
    assert continuity(jumping, [q]).fails
    assert continuity(meeting, [q]).holds
    assert continuity(Max(q, p, t), [q, p, t]).holds
    assert cuts_of(atan(1 / w), [w]) == []


@pytest.mark.parametrize(("symbol", "place"), [(r, 1), (l, -1), (q, 1)])
def test_jumps_are_found_where_a_symbol_of_one_sign_may_be(symbol, place):
    found = continuity(sign(symbol - place), [symbol])
    assert found.fails
    assert found.counterexample.point == {symbol.name: str(place)}
    assert continuity(sign(symbol + place), [symbol]).fails is (symbol == q)


def test_sides_of_a_surface_are_looked_at_inside_the_domain():
    for domain, sides in ((EVERYWHERE, 1), (Domain((q > -5,)), 1), (Domain((q > 0,)), None)):
        assert real_sides(sqrt(q), q, [q], domain, soon()) == sides
    cube = q**3 - sp.Rational(65, 224) ** 3
    assert real_sides(sqrt(cube), cube, [q], EVERYWHERE, soon()) == 1
    assert real_sides(sqrt(n) + q, n, [n], EVERYWHERE, soon()) is None


@pytest.mark.parametrize("deep", [1, 2, 6])
def test_functions_within_functions_are_continued(deep):
    nested = sp.Integer(1)
    for _ in range(deep):
        nested = 1 + Max(0, q * nested)
    above, below = (continued(nested, q, [q], up=up) for up in (True, False))
    assert above.subs(q, 2) == nested.subs(q, 2) == 2 ** (deep + 1) - 1
    assert below.subs(q, -2) == nested.subs(q, -2) == 1


def test_values_beside_a_place_where_a_side_has_none_do_not_meet():
    assert not meets(1 / (1 - sign(q)), q, [q], EVERYWHERE, 1.0)
    assert meets(1 / (2 - sign(q) ** 2), q, [q], EVERYWHERE, 1.0)
    assert not meets(1 / (2 - sign(q)), q, [q], EVERYWHERE, 1.0)


def test_an_angle_whose_point_keeps_away_from_the_centre():
    assert continuity(atan2(Abs(q), q - 3), [q]).holds
    assert continuity(atan2(q, q - 3), [q]).fails


def test_without_time_a_function_with_pieces_is_left_open():
    late = continuity(log(q) + q, [q], budget=0.0)
    assert late.undecided
    assert "was not decided in 0 s" in late.feedback
    assert continuity(log(q) + q, [q]).holds


def test_steps_between_pieces_are_looked_for_where_pieces_are_plane():
    step = atan(1 / q) + atan(q)
    found = step_between_pieces(step, [q], EVERYWHERE, soon())
    assert {found.before, found.after} == {"1.5707963", "-1.5707963"}
    assert step_between_pieces(step, [q], Domain((Ne(q**2, 1),)), soon()) is None
    assert step_between_pieces(besselj(0, 1) * Heaviside(q), [q], EVERYWHERE, soon()) is None
    assert step_between_pieces(step, [q], EVERYWHERE, time.monotonic() - 1) is None


def test_a_root_beside_a_pole_has_no_jump_to_certify():
    for f, jumps in ((sqrt(-q) / sqrt(q), True), (sqrt(q) * sqrt(-q) / q**2, False), (exp(1 / q), False)):
        found = [hidden_jump(f, s, [q], EVERYWHERE, soon()) for s in open_surfaces(f, [q], EVERYWHERE)]
        assert (found != [] and found[0] is not None) is jumps


def test_a_jump_is_not_looked_for_without_time():
    cut = cuts_of(sign(q), [q])[0]
    assert find_jump(sign(q), cut, [q], EVERYWHERE, soon()).after == "1"
    assert find_jump(sign(q), cut, [q], EVERYWHERE, time.monotonic() - 1) is None
    assert real_sides(sqrt(q), q, [q], EVERYWHERE, time.monotonic() - 1) is None
    assert one_sided.proportion(2 * q, q) == 2
