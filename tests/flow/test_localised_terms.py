"""Steps of Taylor's method where its series know too little: symmetric starts, pulses, bumps, small units."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from scipy.special import ellipj, ellipk

from canon import DOP853, RK4, AccuracyWarning, Gauss, Hamiltonian, Splitting, Taylor, coordinates, propagate
from canon import time as t
from canon.flow.adaptive.state_unit import state_unit
from canon.flow.checked_request import hamilton_equations_of
from canon.flow.run.sampling_plan import adaptive_plan, sampling

x = coordinates("x")


def moving(V: sp.Expr) -> Hamiltonian:
    return Hamiltonian(x.momentum**2 / 2 + V, [x], [x.momentum])


def test_a_pendulum_released_from_the_horizontal_keeps_its_digits():
    motion = propagate(moving(-sp.cos(x)), y0=[math.pi / 2, 0], t_span=(0, 10), samples=50)
    k = 0.5  # sin²(θ₀/2)
    sn = ellipj(ellipk(k) - motion.t, k)[0]
    assert abs(motion.y[0] - 2 * np.arcsin(math.sqrt(k) * sn)).max() < 1e-14


@pytest.mark.parametrize("power", [8, 24])
def test_a_flat_well_entered_from_its_middle(power):
    H = moving(x**power / power)
    motion = propagate(H, y0=[0, 1], t_span=(0, 10), samples=20)
    # A coordinate that is shifted by a hundredth of nothing has no vanishing coefficients: a second route.
    direct = propagate(H, y0=[0, 1], t_span=(0, 10), samples=20, precision=60)
    assert abs(motion.y - direct.y).max() < 2e-13
    assert abs(motion.energy_error).max() < 1e-14


@pytest.mark.parametrize("width", [0.1, 1e-3, 1e-6])
def test_a_pulse_kicks_by_its_area(width):
    """ṗ = exp(−((t − 50)/w)²): p ends at w √π, x at p times what is left."""
    w = sp.Rational(Fraction(width))
    motion = propagate(
        moving(-x * sp.exp(-(((t - 50) / w) ** 2)) / w), y0=[0, 1], t_span=(0, 100), samples=10
    )
    kick = math.sqrt(math.pi)
    missed = abs(motion.y[:, -1] - [100 + 50 * kick, 1 + kick])
    estimate = motion.error_estimate()
    assert (missed <= estimate.error[:, -1]).all()
    assert estimate.relative[-1] < 1e-14 / width + 1e-13  # a double near 50 is off by 7e-15, beside the width


@pytest.mark.parametrize("width", [0.1, 0.001])
@pytest.mark.parametrize("end", [50, -50])
def test_a_bump_is_climbed_wherever_the_orbit_comes_from(width, end):
    """Against a step of its size: the speed over tanh's upper half is √(v² − 2 h)."""
    u = (x - math.copysign(20, end)) / sp.Float(width, 17)
    H = moving(sp.tanh(u) * sp.Rational(1, 100))
    motion = propagate(H, y0=[0, 1], t_span=(0, end), samples=10)
    way = math.copysign(1, end)
    assert motion.y[1, -1] == pytest.approx(math.sqrt(1 - way * 0.04), rel=1e-13)


def test_an_exponential_that_stays_in_sight_costs_no_looking(monkeypatch):
    from canon.flow.adaptive.held_steps import HeldSteps

    asked = list[int]()
    monkeypatch.setattr(HeldSteps, "integrator", lambda *_: asked.append(1))
    propagate(moving((1 - sp.exp(-x)) ** 2), y0=["1/2", 0], t_span=(0, 100), samples=10)
    assert not asked


@pytest.mark.parametrize("exponent", [-300, -30, -10, 30])
@pytest.mark.parametrize("precision", ["double", "quad"])
def test_small_and_large_numbers_keep_their_digits(exponent, precision):
    size = 10.0**exponent
    motion = propagate(moving(x**2 / 2), y0=[size, 0], t_span=(0, 50), samples=10, precision=precision)
    assert abs(motion.y[0] / size - np.cos(motion.t)).max() < 2e-14
    assert motion.error_estimate().relative[-1] < 1e-13


def test_small_numbers_with_events_and_between_samples():
    from canon import Event

    size = 1e-20
    motion = propagate(
        moving(x**2 / 2), y0=[size, 0], t_span=(0, 7), samples=3, dense=True, events=[Event(x)]
    )
    assert [met.t for met in motion.events] == pytest.approx([math.pi / 2, 1.5 * math.pi], rel=1e-14)
    assert motion.events[0].y == pytest.approx([0, -size], abs=1e-14 * size)
    assert motion(1.0)[0] == pytest.approx(size * math.cos(1), rel=1e-14)


@pytest.mark.parametrize(("start", "unit"), [((1.0, 0.0), 1), ((2.0**-9, 0.0), 2.0**-9), ((0.0, 0.0), 1)])
def test_the_unit_of_a_state_is_a_power_of_two_below_it(start, unit):
    system = hamilton_equations_of(moving(x**2 / 2), {})
    plan = adaptive_plan(sampling((Fraction(0), Fraction(1)), 2, None))
    assert state_unit(system, np.array(start)[:, np.newaxis], plan) == unit


def test_a_tolerance_is_kept_at_a_symmetric_start():
    motion = propagate(
        moving(-sp.cos(x)), y0=[math.pi / 2, 0], t_span=(0, 10), samples=20, method=Taylor(1e-6)
    )
    exact = propagate(moving(-sp.cos(x)), y0=[math.pi / 2, 0], t_span=(0, 10), samples=20)
    assert abs(motion.y - exact.y).max() < 1e-5


@pytest.mark.parametrize("method", [{}, {"method": Splitting("verlet"), "step": 0.05}])
def test_a_starting_energy_of_round_off_is_none(method):
    """cos(π/2) is 6e−17 in doubles, and no error is measured by it."""
    motion = propagate(moving(-sp.cos(x)), y0=[math.pi / 2, 0], t_span=(0, 20), samples=100, **method)
    assert not motion.relative
    assert abs(motion.energy_error).max() < 1e-2
    assert np.isfinite(motion.error_estimate().relative).all()


def test_a_parabola_has_no_energy_and_a_starting_energy_that_is_small_is_one():
    y = coordinates("y")
    kepler = Hamiltonian(
        (x.momentum**2 + y.momentum**2) / 2 - 1 / sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
    )
    for speed, relative in ((math.sqrt(2), False), (math.sqrt(2) + 1e-10, True)):
        motion = propagate(kepler, y0=[1, 0, 0, speed], t_span=(0, 10), samples=10)
        assert 0 < abs(motion.energy[0]) < 1e-9
        assert motion.relative is relative


def test_a_jump_is_told_where_the_terms_vanish_at_the_start():
    """A wrong twin: steps of 1.9 blow the released pendulum's energy up, and that is warned of."""
    with pytest.warns(AccuracyWarning):
        propagate(moving(-sp.cos(x)), y0=[math.pi / 2, 0], t_span=(0, 20), method=RK4(), step=2.5, samples=8)


@pytest.mark.parametrize("width", [0.1, 1e-3])
@pytest.mark.parametrize("terms", ["pulse", "bump"])
def test_dop853_does_not_pass_over_what_it_cannot_see(width, terms):
    w = sp.Rational(Fraction(width))
    if terms == "pulse":
        motion = propagate(
            moving(-x * sp.exp(-(((t - 50) / w) ** 2)) / w), y0=[0, 1], t_span=(0, 100), method=DOP853()
        )
        assert motion.final[1] == pytest.approx(1 + math.sqrt(math.pi), rel=1e-9)
    else:
        motion = propagate(moving(sp.tanh((x - 20) / w) / 100), y0=[0, 1], t_span=(0, 50), method=DOP853())
        assert motion.final[1] == pytest.approx(math.sqrt(1 - 0.04), rel=1e-9)


@pytest.mark.parametrize("method", [Splitting("kahan-li-8"), Gauss(4)])
def test_steps_over_a_pulse_are_told_by_the_estimate(method):
    """Steps of half the size pass over it too; the true motion is Taylor's."""
    H = moving(x**2 / 2 - x / 2 * sp.exp(-(((t - sp.Rational(50013, 1000)) * 1000) ** 2)))
    motion = propagate(H, y0=[1, 0], t_span=(0, 100), method=method, step=0.025, samples=20)
    exact = propagate(H, y0=[1, 0], t_span=(0, 100), samples=20)
    missed = abs(motion.y - exact.y).max()
    estimate = motion.error_estimate()
    assert missed > 1e-4
    assert (abs(motion.y - exact.y) <= estimate.error).all()
    assert estimate.companion.startswith("Taylor")


@pytest.mark.parametrize("method", [Splitting("kahan-li-8"), RK4(), Gauss(4)])
@pytest.mark.parametrize("force", [1 / ((1000 * (t - 5)) ** 2 + 1), 1 / ((1000 * (x - 5)) ** 2 + 1)])
def test_steps_past_a_divisor_that_nearly_vanishes_are_told_by_the_estimate(method, force):
    H = moving(x**2 / 2 + force / 10 if force.has(x) else x**2 / 2 - x * force / 10)
    motion = propagate(H, y0=[0, 10], t_span=(0, 10), method=method, step=0.0625, samples=20)
    exact = propagate(H, y0=[0, 10], t_span=(0, 10), samples=20, precision="extended")
    estimate = motion.error_estimate()
    assert (abs(motion.y - exact.y) <= estimate.error).all()
    assert estimate.companion.startswith("Taylor")


def test_divisors_that_are_seen_well_need_no_other_companion():
    motion = propagate(
        moving(-1 / sp.sqrt(x**2 + 1)), y0=[0, 1], t_span=(0, 10), method=RK4(), step=0.0625, samples=20
    )
    assert motion.error_estimate().companion.startswith("RK4")


def test_a_first_step_that_ends_at_a_sample():
    """Its end is halved out of the span, and so are the samples: a grid of times must not hold it twice."""
    V = sp.cos(x) + sp.Rational(21, 32) * x * sp.exp(-((128 * t - 80) ** 2))
    slow = Hamiltonian(x.momentum**2 / (2**41 * (9 * x**2 / 8 + 1)) - V, [x], [x.momentum])
    motion = propagate(slow, y0=[math.pi / 2, 2.0**20], t_span=(0, 10), samples=8)
    assert motion.error_estimate().relative[-1] < 1e-13


def test_a_rest_energy_is_no_sign_of_an_error():
    H = Hamiltonian(sp.sqrt(1 + x.momentum**2) + (1 - sp.exp(-x / 2)) ** 2 / 2**40, [x], [x.momentum])
    motion = propagate(H, y0=[1 / 16, 2.0**-20], t_span=(0, 20), samples=8)
    assert motion.error_estimate().relative[-1] < 1e-14


@pytest.mark.parametrize("end", [3, -3])
def test_a_pulse_between_fixed_steps_is_known_to_the_estimate_in_both_directions(end):
    """ṗ = −1/(1 + (128 (t ∓ 3/8))²): a pulse a quarter as wide as a step, which half the step sees no better."""
    met = sp.Rational(3, 8) * (1 if end > 0 else -1)
    H = moving(x / (32 * (1 + (128 * (t - met)) ** 2)))
    motion = propagate(H, y0=[1, 0], t_span=(0, end), method=Splitting("verlet"), step=1 / 32, samples=8)
    area = np.arctan(128 * (motion.t - float(met))) - math.atan(-128 * float(met))
    estimate = motion.error_estimate()
    assert "Taylor" in estimate.companion
    assert (abs(motion.y[1] + area / (32 * 128)) <= estimate.error[1]).all()
