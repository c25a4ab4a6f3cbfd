"""Kinks: moduli, maxima, steps, pieces and dry friction are met as events, so that no order is lost."""

import math

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.interpolate import Akima1DInterpolator, CubicSpline, make_interp_spline

from canon import (
    AccuracyWarning,
    Event,
    Hamiltonian,
    Lagrangian,
    VectorField,
    coordinates,
    propagate,
    time,
)  # fmt: skip
from canon.flow import NonFiniteStateError, sampled_function
from canon.flow.checked_request import hamilton_equations_of
from canon.flow.kinked.regimes import kinks_of

x, y = coordinates("x y")
px, py = x.momentum, y.momentum
t = Hamiltonian(px, [x], [px]).t
BOTH = pytest.mark.parametrize(("method", "bound"), [("taylor", 2e-14), ("DOP853", 5e-10)])


def one(V):
    return Hamiltonian(px**2 / 2 + V, [x], [px])


def zigzag(when):
    """The motion of p²/2 + |x| from (1, 0): arcs of parabolas, of period 4√2."""
    quarter = math.sqrt(2)
    s = when % (4 * quarter)
    arc, half = (s, 1) if s < quarter else (s - 2 * quarter, -1) if s < 3 * quarter else (s - 4 * quarter, 1)
    return half * (1 - arc**2 / 2), -half * arc


@BOTH
def test_modulus_has_closed_form_and_energy(method, bound):
    motion = propagate(one(sp.Abs(x)), (0, 20 * 4 * 2**0.5), [1, 0], method=method, samples=700)
    assert abs(motion.energy_error).max() < max(1e-15, bound / 50)
    exact = np.array([zigzag(s) for s in motion.t]).T
    assert abs(motion.y - exact).max() < bound * 20  # the period's phase


@pytest.mark.slow
def test_modulus_keeps_its_energy_over_1000_periods():
    motion = propagate(one(sp.Abs(x)), (0, 4000 * 2**0.5), [1, 0])
    assert abs(motion.energy_error).max() < 1e-14


def test_modulus_in_quad():
    motion = propagate(one(sp.Abs(x)), (0, 30), [1, 0], precision="quad", samples=40)
    assert abs(motion.energy_error).max() < 1e-30


@BOTH
@pytest.mark.parametrize(
    "V",
    [
        x**2 / 2 + 3 * sp.Max(x, 0) ** 2 / 2,
        x**2 / 2 + 3 * x**2 * sp.Heaviside(x) / 2,
        sp.Piecewise((2 * x**2, x > 0), (x**2 / 2, True)),
        sp.Piecewise((x**2 / 2, x <= 0), (2 * x**2, x > 0)),
        2 * x**2 - 3 * sp.Min(x, 0) ** 2 / 2,
    ],
    ids=["Max", "Heaviside", "Piecewise", "Piecewise without default", "Min"],
)
def test_two_springs_have_the_period_of_both(V, method, bound):
    """π of the soft spring and π/2 of the hard one; the amplitudes are as 2 : 1."""
    period = math.pi * 1.5
    motion = propagate(one(V), (0, 20 * period), [-1, 0], method=method)
    assert abs(motion.y[:, -1] - [-1, 0]).max() < bound * 10
    assert motion["x"].max() == pytest.approx(0.5, abs=1e-3)


def hertz_contact(E):
    """How long a ball of energy E is in a contact of potential x^(5/2)."""
    return math.sqrt(2) * E ** (2 / 5 - 1 / 2) * 2 / 5 * float(mpmath.beta(0.4, 0.5))


@pytest.mark.parametrize(("method", "bound"), [("taylor", 1e-14), ("DOP853", 1e-9)])
def test_hertz_contact_lasts_as_long_as_it_should(method, bound):
    """The force x^(3/2) has no Taylor series where the contact begins."""
    H = one(sp.Max(x, 0) ** sp.Rational(5, 2))
    motion = propagate(H, (0, 4), [-1, "1.5"], method=method, events=[Event(x)])
    begun, ended = (met.t for met in motion.events)
    assert begun == pytest.approx(2 / 3, abs=bound)
    assert ended - begun == pytest.approx(hertz_contact(1.125), abs=bound * 10)


@BOTH
def test_square_drive_grows_as_summed_by_hand(method, bound):
    """x'' = −x + sign(sin t)/5: the amplitude grows by 4/5 in each period."""
    motion = propagate(one(x**2 / 2 - x * sp.sign(sp.sin(t)) / 5), (0, 40 * math.pi), [0, 0], method=method)
    assert motion["x"][-1] == pytest.approx(-20 * 0.8, abs=bound * 100)


@BOTH
def test_step_in_the_potential_refracts_by_snell(method, bound):
    H = Hamiltonian((px**2 + py**2) / 2 + sp.Heaviside(x - 1) / 4, [x, y], [px, py])
    motion = propagate(H, (0, 3), [0.01, 0, 1, 0.5], method=method)
    assert motion.p[:, -1] == pytest.approx([math.sqrt(0.5), 0.5], abs=bound)
    assert [str(met.event) for met in motion.events] == ["is refracted at x - 1 = 0"]
    slow = propagate(H, (0, 6), [0, 0, 0.5, 0.5], method=method)
    assert slow.p[:, -1] == pytest.approx([-0.5, 0.5], abs=bound)
    assert "reflected" in str(slow.events[0].event)


def test_samples_on_either_side_of_a_step_are_of_the_motion_on_their_side() -> None:
    motion = propagate(one(sp.Heaviside(x - 1) / 4), (0, 2), [0, 1], samples=331)
    slow = math.sqrt(0.5)
    np.testing.assert_allclose(motion.p[0], np.where(motion.t < 1, 1, slow), atol=1e-14)
    np.testing.assert_allclose(
        motion["x"], np.where(motion.t < 1, motion.t, 1 + slow * (motion.t - 1)), atol=1e-14
    )


@pytest.mark.parametrize("samples", [64, 100, 200, 1000])
@pytest.mark.parametrize("way", [1, -1])
def test_a_sample_at_the_instant_of_a_step_has_the_energy_of_the_motion(samples: int, way: int) -> None:
    """However the samples are: at x = 1 itself H has half of the step."""
    motion = propagate(one(sp.Heaviside(x - 1) / 4), (0, 2 * way), [0, way], samples=samples)
    assert abs(motion.energy_error).max() < 1e-15
    assert motion.p[0, samples // 2] == pytest.approx(way * math.sqrt(0.5), abs=1e-14)


def test_moving_step_refracts_in_its_own_frame():
    speed = sp.Rational(1, 10)
    motion = propagate(one(sp.Heaviside(x - speed * t) / 4), (0, 3), [-1, 1])
    assert motion.p[0, -1] == pytest.approx(0.1 + math.sqrt(0.9**2 - 0.5), abs=1e-14)


def friction(mu, force=0):
    return Lagrangian(x.dot**2 / 2, [x], forces=[force - mu * sp.sign(x.dot)])


@BOTH
def test_dry_friction_takes_an_amplitude_each_half_swing_and_sticks(method, bound):
    motion = propagate(friction(sp.Rational(1, 8), -x), (0, 40), [1, 0], method=method)
    turns = [met for met in motion.events if "sticks" in str(met.event)]
    assert [met.t for met in turns] == pytest.approx([4 * math.pi], abs=bound * 100)
    assert motion.y[:, -1] == pytest.approx([0, 0], abs=bound * 10)
    assert abs(motion.energy_error).max() < bound * 10


@BOTH
def test_driven_block_sticks_and_slips_when_it_should(method, bound):
    """x'' = sin t − 0.8 sign(x'): it slips at arcsin 0.8, and sticks where cos t₁ − cos t = 0.8 (t − t₁)."""
    motion = propagate(friction(sp.Rational(4, 5), sp.sin(t)), (0, 12), [0, 0], method=method)
    slips = math.asin(0.8)
    sticks = float(mpmath.findroot(lambda s: mpmath.cos(slips) - mpmath.cos(s) - 0.8 * (s - slips), 2.9))
    expected = [slips, sticks, slips + math.pi, sticks + math.pi, slips + 2 * math.pi]
    assert [met.t for met in motion.events][:5] == pytest.approx(expected, abs=bound * 100)


def test_block_on_a_belt_sticks_to_it():
    """The belt's speed 1/4: the block follows it until the spring pulls as friction does, at x = 1/2."""
    L = Lagrangian(x.dot**2 / 2 - x**2 / 2, [x], forces=[-sp.sign(x.dot - sp.Rational(1, 4)) / 2])
    motion = propagate(L, (0, 4), [0, 0.25])
    assert motion.events[0].t == pytest.approx(2, abs=1e-14)
    assert motion.events[0].y == pytest.approx([0.5, 0.25], abs=1e-14)


def test_nested_kinks():
    H = Hamiltonian((px**2 + py**2) / 2 + sp.Abs(x) + sp.Abs(y) + sp.Abs(sp.Abs(x) - 1) / 3, [x, y], [px, py])
    for start in ([1, 0.7, 0, 0.3], [0.9, 0.7, 0.8, 0.3]):
        motion = propagate(H, (0, 40), start)
        assert abs(motion.energy_error).max() < 5e-15
        back = propagate(H, (40, 0), motion.y[:, -1])
        assert abs(back.y[:, -1] - start).max() < 1e-11


@pytest.mark.parametrize(("side", "seen"), [(-1, {"x"}), (1, {"x", "y"})])
def test_what_stands_beside_a_zero_is_not_watched(side, seen):
    """Max(x, 0)² |y| has no kink at y = 0 while x is negative."""
    ridge = Hamiltonian((px**2 + py**2) / 2 + sp.Max(x, 0) ** 2 * sp.Abs(y), [x, y], [px, py])
    kinks = kinks_of(hamilton_equations_of(ridge, {}))
    watched = [str(kinks.system.graph.to_sympy(g)) for g in kinks.functions]
    for above in (1, -1):
        signs = tuple({"x": side, "y": above}[name] for name in watched)
        assert {watched[k] for k in kinks.mattering(signs)} == seen


def test_vector_field_with_a_sign():
    """ẋ = −sign x comes to zero at t = 1 and stays there."""
    motion = propagate(VectorField((-sp.sign(x), sp.Max(x, 0)), (x, y)), (0, 3), [1, 0])
    assert motion.y[:, -1] == pytest.approx([0, 0.5], abs=1e-15)


def push(walls, at, way):
    """The force at a place, at a wall on the side to which it goes."""
    return -mpmath.fsum(c * (mpmath.sign(at - a) or way) for a, c in walls)


def by_hand(walls, start, until):
    """p²/2 + Σ c |x − a| from kink to kink in 40 digits: arcs of parabolas."""
    with mpmath.workdps(40):
        at, p, now = mpmath.mpf(start[0]), mpmath.mpf(start[1]), mpmath.mpf(0)
        places = sorted(a for a, _ in walls)
        while True:
            # From rest at a wall it goes to the left where it is pushed there to the left of it; the walls attract.
            way = mpmath.sign(p) or (-1 if push(walls, at, -1) < 0 else 1)
            F = push(walls, at, way)
            times = []
            for a in places:
                d = p**2 - 2 * F * (at - a)
                roots = [(-p + s * mpmath.sqrt(d)) / F for s in (1, -1)] if F and d >= 0 else []
                roots += [(a - at) / p] if not F and p else []
                times += [(s, a) for s in roots if s > mpmath.mpf(10) ** -30]
            step, wall = min(times, default=(mpmath.inf, None))
            if now + step >= until:
                step = until - now
                return float(at + p * step + F * step**2 / 2), float(p + F * step)
            at, p, now = mpmath.mpf(wall), p + F * step, now + step


@settings(max_examples=50, deadline=None)
@example([(0, 2), (2, 1)], 0.0, 2.0)  # it comes to rest at a wall
@given(
    st.lists(
        st.tuples(st.integers(-4, 4), st.integers(1, 4)), min_size=1, max_size=3, unique_by=lambda w: w[0]
    ),
    st.floats(-2, 2).map(lambda at: round(at, 3)),
    st.floats(0.3, 2),
)
def test_polygons_move_as_by_hand(walls, at, p):
    V = sum(c * sp.Abs(x - a) for a, c in walls)
    motion = propagate(one(V), (0, 10), [at, p], samples=5)
    assert motion.y[:, -1] == pytest.approx(by_hand(walls, (at, p), 10), abs=1e-12)


def test_events_at_a_kink_are_met_once():
    expected = propagate(one(sp.Abs(x)), (0, 20), [1, 0], events=[Event(px)])
    assert len(expected.events) == 7
    for method in ("taylor", "DOP853"):
        motion = propagate(one(sp.Abs(x)), (0, 20), [1, 0], events=[Event(x), Event(px)], method=method)
        zeros = [met.t for met in motion.events if met.event.function == x]
        assert zeros == pytest.approx([math.sqrt(2) * (2 * k + 1) for k in range(7)], abs=1e-10)


def test_an_event_at_a_kink_where_a_slice_ends():
    """The ball comes to x = 0 at t = 1, which is a sample too."""
    motion = propagate(one(sp.Max(x, 0) ** sp.Rational(5, 2)), (0, 5), [-1, 1], events=[Event(x)])
    assert [met.t for met in motion.events] == pytest.approx([1, 1 + hertz_contact(0.5)], abs=1e-13)


def test_bounce_beside_friction():
    L = Lagrangian(x.dot**2 / 2, [x], forces=[-sp.sign(x.dot) / 8])
    motion = propagate(L, (0, 3), [0, -1], events=[Event(x + 1, -1, "bounce")])
    energy = 0.5 - motion["x"][0] / 8 - (1 + 1 + motion["x"][-1]) / 8
    assert motion["x_dot"][-1] ** 2 / 2 == pytest.approx(energy, abs=1e-14)
    assert abs(motion.energy_error).max() < 1e-14


def test_stop_and_resume_and_many_orbits_have_the_same_bits():
    H = one(sp.Abs(x) + sp.Max(x, 0) ** 2)
    whole = propagate(H, (0, 20), [1, 0.5], samples=40)
    part = propagate(H, (0, 10), [1, 0.5], samples=20).resume(until=20)
    assert abs(whole.y - part.y).max() < 1e-13
    side = propagate(H, (0, 20), [[1, 0.25], [0.5, 0]], samples=40)
    assert (side.y[:, :, 0] == whole.y).all()
    met = propagate(H, (0, 20), [1, 0.5], events=[Event(px - x / 2, -1, "stop")])
    assert met.t[-1] == met.events[-1].t


def test_dense_output_and_error_estimate():
    motion = propagate(one(sp.Abs(x)), (0, 20), [1, 0], dense=True, samples=50)
    times = np.array([0.3, 1.5, 7.7, 19.9])
    exact = np.array([zigzag(s) for s in times]).T
    assert abs(motion(times) - exact).max() < 1e-13
    found = np.array([zigzag(s) for s in motion.t]).T
    assert abs(motion.y - found).max() < 1e-13
    assert motion.error_estimate().digits.min() > 12


def test_no_speed_across_a_jump_of_h_is_told():
    with pytest.raises(NonFiniteStateError, match=r"where x - 1 = 0: H jumps where the motion begins"):
        propagate(one(x * sp.Heaviside(x - 1)), (0, 1), [1, 0])
    assert np.isfinite(propagate(one(x * sp.Heaviside(x - 1)), (0, 1), [0.5, 0]).y).all()


@pytest.mark.parametrize("speed", [1.0, -0.3, 0.1])
def test_a_start_on_a_jump_of_h_asks_for_the_side(speed):
    """Heaviside(0) = ½ would count as energy that is gone at once; a switch in time is no such jump."""
    step = one(sp.Heaviside(x) / 5)
    with pytest.raises(NonFiniteStateError, match=r"where x = 0: H jumps where the motion begins: begin a"):
        propagate(step, (0, 1), [0, speed])
    beside = propagate(step, (0, 1), [1e-9, speed])
    assert beside.y[1, -1] == speed or speed < 0
    assert abs(beside.energy_error).max() < 1e-15
    switched = propagate(one(x**2 / 2 - x * sp.Heaviside(time) / 5), (0, 1), [0.7, speed])
    assert switched["x"][-1] == pytest.approx(0.2 + 0.5 * np.cos(1) + speed * np.sin(1), abs=1e-14)


def test_what_is_not_determined_is_told():
    with pytest.raises(NonFiniteStateError, match="not determined"):
        propagate(one(-sp.Abs(x)), (0, 1), [0, 0])
    resting = propagate(one(sp.Abs(x)), (0, 1), [0, 0])
    assert not resting.y.any()
    with pytest.raises(ValueError, match="has no value where none"):
        propagate(one(sp.Piecewise((x, x > 0))), (0, 1), [1, 0])


def test_steps_of_one_size_say_that_they_pass_over_kinks():
    with pytest.warns(AccuracyWarning, match="steps over the kinks at x = 0"):
        coarse = propagate(one(sp.Abs(x)), (0, 20), [1, 0], method="RK4", step=0.1)
    assert abs(coarse.energy_error).max() > 1e-4


def test_splines_move_as_in_scipy():
    """The start lies on a knot, which the motion only touches when it comes back."""
    at = np.linspace(-3, 3, 9)
    H = one(sampled_function(x, at, -np.cos(at)))
    motion = propagate(H, (0, 12), [1.5, 0])
    assert abs(motion.energy_error).max() < 1e-14
    spline = CubicSpline(at, -np.cos(at))
    by_scipy = solve_ivp(
        lambda _, y: [y[1], -spline(y[0], 1)], (0, 12), [1.5, 0], "DOP853", rtol=1e-12, atol=1e-12
    )
    assert motion.final == pytest.approx(by_scipy.y[:, -1], abs=1e-7)  # SciPy steps over the knots
    value = sp.lambdify(x, sampled_function(x, spline))
    places = np.linspace(-4, 4, 33) + 0.01
    assert [value(float(a)) for a in places] == pytest.approx(spline(places), abs=1e-14)
    smoother = make_interp_spline(at, np.cos(at), k=5)
    value = sp.lambdify(x, sampled_function(x, smoother))
    inside = np.linspace(-2.9, 2.9, 20)
    assert [value(float(a)) for a in inside] == pytest.approx(smoother(inside), abs=1e-13)


def test_samples_that_make_no_spline_are_refused():
    for at, values, words in [
        ([0, 1, 2], [0, 1, 4], "at least 4"),
        ([0, 2, 1, 3], [0, 1, 4, 9], "are to rise"),
        ([0, 1, 2, 3], [0, 1, math.nan, 9], "finite"),
    ]:
        with pytest.raises(ValueError, match=words):
            sampled_function(x, at, values)
    with pytest.raises(TypeError, match="no spline"):
        sampled_function(x, math.sin)


@pytest.mark.parametrize("made", [CubicSpline, make_interp_spline])
def test_splines_that_are_something_else_beyond_their_ends_are_refused(made):
    """A periodic one, to be followed, is a table of as many periods; one that ends goes on if it is told to."""
    at = np.linspace(0, 2 * np.pi, 13)
    values = np.cos(at)
    values[-1] = values[0]
    with pytest.raises(ValueError, match=r"is periodic, .* over as many periods"):
        sampled_function(x, made(at, values, bc_type="periodic"))
    ending = made(at, values)
    ending.extrapolate = False
    with pytest.raises(ValueError, match=r"no values beyond 0 … 6\.28.*extrapolate = True"):
        sampled_function(x, ending)
    ending.extrapolate = True
    assert float(sampled_function(x, ending).subs(x, 7.0)) == pytest.approx(float(ending(7.0)), abs=1e-13)


def test_akimas_spline_ends_where_its_samples_do_unless_told_otherwise():
    at = np.linspace(-2, 2, 9)
    with pytest.raises(ValueError, match="extrapolate=False"):
        sampled_function(x, Akima1DInterpolator(at, at**2))
    spline = Akima1DInterpolator(at, at**2, extrapolate=True)
    assert float(sampled_function(x, spline).subs(x, 2.5)) == pytest.approx(float(spline(2.5)), abs=1e-13)


def test_a_periodic_table_over_several_periods_moves_as_in_scipy():
    """The remedy that the refusal of a periodic spline names."""
    at = np.linspace(0, 2 * np.pi, 13)
    values = np.cos(at)
    values[-1] = values[0]
    spline = CubicSpline(at, values, bc_type="periodic")
    wide = np.concatenate([at[:-1] + 2 * np.pi * k for k in range(-1, 3)])
    motion = propagate(one(sampled_function(x, wide, spline(wide))), (0, 5.5), [0.5, 2.0])
    by_scipy = solve_ivp(
        lambda _, y: [y[1], -spline(y[0], 1)],
        (0, 5.5),
        [0.5, 2.0],
        "DOP853",
        rtol=1e-11,
        atol=1e-12,
        max_step=0.01,
    )
    assert motion.final == pytest.approx(
        by_scipy.y[:, -1], abs=1e-4
    )  # the ends of the wide table are not-a-knot


def test_the_error_of_what_rests_in_a_kink_is_known_at_once():
    """A neighbour beside it would meet the kink a million times."""
    both = Hamiltonian(
        (x.momentum**2 + y.momentum**2) / 2 + sp.Abs(x) - sp.cos(y), [x, y], [x.momentum, y.momentum]
    )
    motion = propagate(both, (0, 10), [0, 1, 0, 0])
    error = motion.error_estimate().error
    assert not motion["x"].any()
    assert error[[0, 2]].max() < 1e-300
    assert 0 < error[1].max() < 1e-14


@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_a_damper_whose_force_has_no_series_where_the_motion_turns(method):
    """DOP853 said that the motion is not determined, and Taylor's way back ended in an error of heyoka's."""
    damped = Lagrangian(
        x.dot**2 / 2 - x**2 / 2, [x], forces=[-(sp.Abs(x.dot) ** sp.Rational(3, 2)) * sp.sign(x.dot) / 5]
    )
    motion = propagate(damped, (0, 7), [1.0, 0.0], method=method)
    back = propagate(damped, (7, 0), motion.final, method=method)
    np.testing.assert_allclose(back.final, [1, 0], atol=1e-9)
    turn = np.flatnonzero(np.diff(np.sign(motion.v[0, 1:]))) + 1
    np.testing.assert_allclose(motion.t[turn], [3.158, 6.30], atol=0.02)
    assert abs(motion.energy_error).max() < 1e-10
