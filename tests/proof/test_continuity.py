"""Jumps that derivatives do not show: staircases are found with their place, angles and kinks are left in peace."""

import mpmath as mp
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import (
    Abs,
    Heaviside,
    I,
    Max,
    Piecewise,
    acos,
    acot,
    acoth,
    arg,
    asin,
    atan,
    atan2,
    atanh,
    cos,
    cot,
    exp,
    log,
    pi,
    sign,
    sin,
    sqrt,
    tan,
    tanh,
)  # fmt: skip

from canon import (
    CanonicalTransformation,
    GeneratingFunction,
    Hamiltonian,
    Lagrangian,
    coordinates,
    equal,
    is_constant_of_motion,
)  # fmt: skip
from canon import time as time_
from canon.mechanics import is_gauge_equivalent
from canon.mechanics.canonical.new_hamiltonian import is_new_hamiltonian
from canon.mechanics.hamilton.symmetry import is_symmetry
from canon.proof.analytic import is_analytic, proved_sign
from canon.proof.continuity.constant_steps import is_locally_constant
from canon.proof.continuity.continuity import continuity
from canon.proof.continuity.one_sided import cuts_of
from canon.proof.continuity.turns_of_angles import continuity_but_for_turns
from canon.proof.continuity.winding_centre import common_zero
from canon.proof.domain.domain import Domain

q, p, x, y, t, P = sp.symbols("q p x y t P", real=True)
w, m = sp.symbols("w m", positive=True)
ALL = (q, p, x, y, t, P)
H = p**2 / 2 + q**2 / 2
whole = st.integers(-3, 3)

# what jumps, and a neighbour that does not
FAULTS = [
    (sign(q), Abs(q)),
    (atan2(0, q), atan2(0, 1 + q**2)),
    (atan2(q, q), atan2(q, 1 + q**2)),
    (atan2(q**2, q) - atan(q), atan2(q**2, 1 + q**2)),
    (atan2(Abs(q), q), atan2(Abs(q), 1)),
    (atan2(q, Abs(q)), atan2(q, 1 + Abs(q))),
    (atan2(q - 1, q**2 - 1), atan2(1, q + 1)),
    (atan2(q**2, sp.sinh(q)) - atan(q**2 / sp.sinh(q)), atan2(1 + q**2, sp.sinh(q))),
    (atan2(Max(q, -q), q), atan2(sqrt(1 + q**2), q)),
    (H + sign(q), H + q * sign(q)),
    (p * sign(q), p * q * sign(q)),
    (Heaviside(q), q * Heaviside(q)),
    (Max(q, 0) / q, Max(q, 0)),
    (Abs(p - q) / (p - q), Abs(p - q)),
    (Piecewise((q, q > 0), (q + 1, True)), Piecewise((q, q > 0), (2 * q, True))),
    (Piecewise((1, q > 1), (2, q > 0), (3, True)), Piecewise((q, q > 1), (1, q > 0), (q + 1, True))),
    (Piecewise((7, q**2 + p**2 > 1), (2, True)), Piecewise((q**2 + p**2, q**2 + p**2 > 1), (1, True))),
    (sqrt(q**2) / q, sqrt(q**2)),
    (sqrt(t**2 - 2 * t + 1) / (t - 1), sqrt(t**2 - 2 * t + 1)),
    (sqrt(1 - sin(t) ** 2) / cos(t), sqrt(1 - sin(t) ** 2)),
    (q - atan(tan(pi * q)) / pi, q - sin(pi * q) / pi),
    (atan(1 / q) + atan(q), atan(1 / q) + atan(q) - pi * sign(q) / 2),
    (atan(1 / q), atan(1 / q**2)),
    (H * (atan(1 / q) + atan(q)), q * atan(1 / q)),
    (atan(tan(q + p)), asin(sin(q + p))),
    (atan(tan(q * p)) - q * p, tan(q * p) - q * p),
    (atan(w * tan(t / 2)), atan(w * sin(t / 2))),
    (atan(2 * q / (1 - q**2)) - 2 * atan(q), atan(2 * q / (1 + q**2))),
    (acot(cot(t)), acos(cos(t))),
    (acot(q), acot(q**2 + 1)),
    (atan2(sin(t), cos(t)), atan2(sin(t), 2 + cos(t))),
    (arg(exp(I * t)), arg(exp(I * t) + 2)),
    (-I * log(exp(I * w * t)), -I * log(3 + exp(I * w * t))),
    (sqrt(exp(I * t)), sqrt(exp(I * t) + 2)),
    (sign(atan(1 / q)), Abs(atan(1 / q))),
    (log(q) - log(-q), log(q) + q),
    (H + log(q**2) - 2 * log(q), H + log(q**2)),
    (sqrt(q) / sqrt(-q), sqrt(q) * sqrt(-q)),
    (atanh(q) - atanh(1 / q), atanh(q)),
    (acoth(q) - atanh(q), acoth(q)),
    (H + atan(q / p) + atan(p / q), H + atan(q / p)),
    (atan2(q, p) - atan2(-q, -p), atan2(q, p)),
    (atan(q / p) - t + atan2(q, p) + atan2(p, q), atan(q / p) - t),
    (atan(q / p) - t + sign(q), atan(q / p) - t + Abs(q)),
    (atan(1 / (x * p - y * q)), atan(x * p - y * q)),
]


@pytest.mark.parametrize(("f", "neighbour"), FAULTS, ids=[str(f)[:60] for f, _ in FAULTS])
def test_a_jump_is_found_and_its_neighbour_is_none(f, neighbour):
    found = continuity(f, ALL)
    assert found.fails
    assert "jumps" in found.feedback
    assert found.counterexample is not None
    assert found.counterexample.left != found.counterexample.right
    assert not continuity(neighbour, ALL).fails
    assert continuity(neighbour, ALL).holds


ANGLES = [
    atan(m * w * q / p) - w * t,
    atan2(m * w * q, p) - w * t,
    atan2(y, x),
    acot(p / q),
    P * atan2(y - 1, x + 2),
    atan(p * sqrt(q**2 + 1) / q),
    sin(2 * atan(q / p)),
    log(p + I * m * w * q) - I * w * t,
    atan2(-p * (x * q - y * p) - y / sqrt(x**2 + y**2), q * (x * q - y * p) - x / sqrt(x**2 + y**2)),
]


@pytest.mark.parametrize("f", ANGLES, ids=str)
def test_an_angle_is_taken_as_it_is_and_named(f):
    found = continuity(f, (*ALL,))
    assert found.holds
    assert "winds around" in found.assumed[0]


TURNING = [  # steps by another number at each place, and by a fixed one
    (sp.exp(atan2(q, p) - t), atan2(q, p) - t),
    ((q**2 + p**2) * (atan2(q, p) - t), sp.sqrt(2) * atan(q / p) - t),
    (sin(atan2(q, p) / 2 - t), sin(2 * atan2(q, p) - t)),
]


@pytest.mark.parametrize(("other", "same"), TURNING, ids=str)
def test_the_same_value_after_each_turn_or_a_fixed_step(other, same):
    assert continuity_but_for_turns(other, [q, p, t]).fails
    assert continuity_but_for_turns(same, [q, p, t]).holds


SMOOTH = [
    2 * atan(exp(t)),
    asin(tanh(t)),
    q * sqrt(2 * P - q**2) / 2 + P * asin(q / sqrt(2 * P)),
    P * acot(sqrt(2 * P - q**2) / q),
    log(q) - t,
    1 / q,
    tan(t),
    Abs(q) ** 3 / q,
    q / sqrt(q**2 + p**2),
    asin(sin(q)),
    sign(q) ** 2 * H,
    Piecewise((sin(q) / q, sp.Ne(q, 0)), (1, True)),
]


@pytest.mark.parametrize("f", SMOOTH, ids=str)
def test_kinks_poles_and_right_branches_do_not_jump(f):
    found = continuity(f, ALL)
    assert (found.holds, found.assumed) == (True, ())


@settings(max_examples=50)
@given(cut=whole, slope=whole, offset=whole)
def test_two_straight_pieces_jump_unless_they_meet(cut, slope, offset):
    pieces = Piecewise((2 * x, x > cut), (slope * x + offset, True))
    jumps = 2 * cut != slope * cut + offset
    assert continuity(pieces, [x]).fails is jumps
    assert continuity(pieces, [x]).holds is not jumps
    assert continuity(pieces, [x], Domain((x > 3,))).holds


@settings(max_examples=50)
@given(rate=st.integers(1, 40), shift=whole, slope=whole)
def test_the_place_and_height_of_every_step_of_a_staircase(rate, shift, slope):
    f = slope * x + atan(tan(rate * x + shift))
    found = continuity(f, [x]).counterexample
    assert found is not None
    place = mp.mpf(sp.Rational(found.point["x"]).p) / sp.Rational(found.point["x"]).q
    assert abs(mp.cos(rate * place + shift)) < 1e-2
    before, after = (mp.mpf(text) for text in (found.left, found.right))
    assert abs(before - after - mp.pi) < 1e-6


@settings(max_examples=50)
@given(a=whole, b=whole, c=st.integers(1, 3))
def test_one_sided_limits_agree_with_values_beside_the_jump(a, b, c):
    f = (x**2 + b) * sign(c * x - a) + x * Max(x - b, 0)
    found = continuity(f, [x])
    assert found.fails is (a**2 + b * c**2 != 0)
    if found.fails:
        assert found.counterexample is not None
        beside = [f.subs(x, sp.Rational(a, c) + side * sp.Rational(1, 10**9)) for side in (-1, 1)]
        values = [float(text) for text in (found.counterexample.left, found.counterexample.right)]
        assert [float(v) for v in beside] == pytest.approx(values, abs=1e-6)


def test_a_domain_that_leaves_the_surface_out_by_a_sign_has_no_jump():
    for f in (sign(q), atan(1 / q) + atan(q), log(q) - log(-q)):
        assert continuity(f, [q], Domain((q > 0,))).holds
    nonzero = sp.Symbol("n", real=True, nonzero=True)
    assert continuity(nonzero**2 + sign(nonzero), [nonzero]).undecided
    assert continuity(H + sign(q), ALL, Domain((sp.Ne(q, 0),))).undecided
    assert continuity(atan(tan(q)), [q], Domain((q > -pi / 2, q < pi / 2))).holds


def test_what_was_not_proved_to_be_avoidable_stays_open():
    unknown = atan2((p**2 + q**2) * sin(q), (p**2 + q**2) * cos(q))
    assert continuity(unknown, [q, p]).undecided
    assert continuity(atan(q / p) + pi * Heaviside(-p), [q, p]).undecided
    assert continuity(H * sqrt(1 - sin(q) ** 2) / cos(q), [q, p]).undecided


def test_what_is_given_may_jump():
    step = H + sign(q)
    assert continuity(step, [q, p]).fails
    assert "as what is given does" in continuity(step, [q, p], given=[sign(q) + p**2]).assumed[0]
    assert continuity(step, [q, p], given=[sign(p)]).fails
    assert continuity(step + sign(p), [q, p], given=[sign(q)]).fails


def test_locally_constant_functions():
    for f in (
        sign(q),
        atan(1 / q) + atan(q),
        log(q) - log(-q),
        q - atan(tan(pi * q)) / pi,
        sin(q) ** 2 + cos(q) ** 2,
    ):
        assert is_locally_constant(f, [q, p])
    for f in (Abs(q), atan(1 / q), log(q), q - atan(tan(q)) / pi, p * sign(q)):
        assert not is_locally_constant(f, [q, p])


def test_the_centre_of_an_angle():
    assert common_zero((q - 1, p + 2), [q, p], Domain()) == "p = -2, q = 1"
    assert "= 0" in common_zero((q**2 + p**2 - 1, q**3 - p + p**3), [q, p], Domain())
    assert common_zero((q**2 + p**2 + 1, q**3 - p + p**3), [q, p], Domain()) == ""
    assert common_zero((q**2 + p**2 - 1, q**3 - p + p**3), [q, p], Domain((q > 2,))) == ""


def test_continuations_equal_the_function_on_their_side():
    for f in (sign(q), Heaviside(q), Abs(q), Max(q, 0), atan(1 / q), acot(q), atan2(q, -3), atan(cot(q))):
        (cut,) = cuts_of(f, [q])
        for place in (sp.Rational(1, 7), sp.Rational(-1, 7)):
            side = cut.above if cut.gap.subs(q, place) > 0 else cut.below
            assert equal(side.subs(q, place), f.subs(q, place)).holds


def test_an_arc_of_something_infinite_is_not_analytic():
    assert not is_analytic([atan(1 / q)], Domain())
    assert not is_analytic([atan(tan(q))], Domain())
    assert is_analytic([atan(1 / q)], Domain((q > 0,)))
    assert is_analytic([atan(q / (q**2 + 1))], Domain())


def test_the_library_minds_jumps():
    oscillator = Hamiltonian(H, q, p)
    for staircase in (sign(q), q - atan(tan(pi * q)) / pi, atan(1 / q) + atan(q), log(q) - log(-q)):
        assert is_constant_of_motion(staircase, oscillator).fails
        assert is_constant_of_motion(H + staircase, oscillator).fails
        assert staircase.has(tan) or is_constant_of_motion(H + staircase, oscillator, Domain((q > 0,))).holds
    assert is_constant_of_motion(atan(q / p) - time_, oscillator).holds
    assert is_constant_of_motion(sp.Integer(3), oscillator).holds
    assert is_constant_of_motion(p**2 / 2 + sign(q), Hamiltonian(p**2 / 2 + sign(q), q, p)).holds

    new_q, new_p = sp.symbols("Q R", real=True)
    exchange = CanonicalTransformation(q, p, p, -q)

    def generates(kind, F):
        return GeneratingFunction(kind, F, q, p, new_q, new_p).generates(exchange)

    assert generates(1, q * new_q).holds
    assert generates(1, q * new_q + sign(new_q)).fails
    assert generates(4, p * new_p + atan(1 / p) + atan(p)).fails
    assert is_new_hamiltonian(exchange, H, (new_q**2 + new_p**2) / 2, [new_q, new_p]).holds
    assert is_new_hamiltonian(exchange, H, (new_q**2 + new_p**2) / 2 + sign(new_q), [new_q, new_p]).fails


def test_gauge_terms_and_symmetries_of_the_library_mind_jumps():
    s = coordinates("s")
    free = Lagrangian(s.dot**2 / 2, [s])
    assert is_gauge_equivalent(free, Lagrangian(s.dot**2 / 2 + s * s.dot, [s]), s**2 / 2).holds
    assert is_gauge_equivalent(free, Lagrangian(s.dot**2 / 2 + s * s.dot, [s]), s**2 / 2 + sign(s)).fails
    assert is_symmetry(free, [time_], K=s).holds
    assert is_symmetry(free, [time_], K=s + sign(s)).fails


def test_motions_of_the_library_are_real_and_continuous():
    free, oscillator = Hamiltonian(p**2 / 2, q, p), Hamiltonian(H, q, p)
    assert free.is_solution({q: 3 * time_, p: sp.Integer(3)}).holds
    assert free.is_solution({q: atan(tan(time_)), p: sp.Integer(1)}).fails
    assert free.is_solution({q: time_ + sign(time_), p: sp.Integer(1)}).fails
    assert oscillator.is_solution({q: exp(I * time_), p: I * exp(I * time_)}).fails
    assert oscillator.is_solution({q: (exp(I * time_) + exp(-I * time_)) / 2, p: -sin(time_)}).holds


def test_a_jump_is_told_by_the_values_of_the_whole_function():
    """They were those of the part of it that jumps: "from -0.5 to 0.5" where q = 1/2 is the step."""
    found = continuity(p + q - atan(tan(sp.pi * q)) / sp.pi, [q, p])
    shown = found.counterexample
    place, before, after = (sp.Rational(shown.point["p"]), float(shown.left), float(shown.right))
    assert found.fails
    assert shown.point["q"] == "1/2"
    assert abs(before - place) < 1e-6
    assert abs(after - place - 1) < 1e-6


t = sp.Symbol("t", real=True)
NONZERO = [
    (abs(t), (sp.Ne(t, 0),), (t < 5,)),
    (abs(t) ** sp.Rational(4, 3), (sp.Ne(t, 0),), (t < 5,)),
    (1 - sp.cos(t) ** 2, (t > 0, t < sp.Rational(31, 10)), (t > 0, t < sp.Rational(32, 10))),
    (1 - sp.cos(t), (t > 0, t < sp.pi), (t >= 0, t < sp.pi)),
    (sp.sqrt(1 - sp.cos(t) ** 2), (t > 0, t < sp.pi), (t > 0, t < 4)),
    (1 - sp.sin(t) ** 2, (t > -sp.pi / 2, t < sp.pi / 2), (t >= -sp.pi / 2, t < sp.pi / 2)),
    (sp.sqrt(t**2 - 2 * t + 1), (sp.Ne(t, 1),), (sp.Ne(t, 2),)),
]
"""What is positive on a first domain, and zero at a place of a second."""


@pytest.mark.parametrize(("f", "inside", "beyond"), NONZERO)
def test_what_vanishes_with_a_root_of_it_alone_is_positive_where_the_root_is_not_zero(f, inside, beyond):
    assert proved_sign(f, Domain(inside)) == "+"
    assert proved_sign(f, Domain(beyond)) != "+"


POWERS = [(abs(t) ** sp.Rational(4, 3), True), (abs(t) ** sp.Rational(2, 3), True), (t**2, True), (abs(t) ** 3, True),
          (abs(t), False), (exp(abs(t)) - 1, False), (abs(t) + t**2, False), (abs(sin(t)), False)]  # fmt: skip


@pytest.mark.parametrize(("below", "holds"), POWERS)
@pytest.mark.parametrize("conditions", [(), (sp.Ne(t, 0),), (t > -1, t < 1)])
def test_poles_are_left_aside_and_jumps_beside_them_are_not(below, holds, conditions):
    """A quotient is infinite on both sides of t = 0, or goes to zero, or its limits are ±1."""
    assert continuity(t / below, [t], Domain(conditions)).holds == holds
    assert continuity(t / below, [t], Domain((t > 0, t < 1))).holds


def test_a_quotient_that_turns_at_a_zero_of_its_root_is_not_continuous():
    f = sp.sin(t) / sp.sqrt(1 - sp.cos(t) ** 2)
    assert continuity(f, [t], Domain((t > 0, t < sp.Rational(31, 10)))).holds
    assert not continuity(f, [t], Domain((t > 0, t < sp.Rational(32, 10)))).holds
    assert not continuity(f, [t], Domain((t > -1, t < 1))).holds
    assert not continuity(t / abs(t), [t], Domain((t > -1, t < 1))).holds
