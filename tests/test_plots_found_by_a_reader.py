"""Pictures that left things out, named them wrongly or drew them at the wrong place, each beside one that was right."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from canon import RK4, Hamiltonian, Lagrangian, Splitting, Taylor, coordinates, propagate
from canon.flow import megno
from canon.plot import (
    COLOURS,
    plot_chaos_map,
    plot_drift_by_step,
    plot_energy_error,
    plot_ensemble_fan,
    plot_integral_drift,
    plot_phase_portrait,
)
from canon.study.energy_drift.drift import drift
from canon.study.energy_drift.drift_rows import DriftRow
from canon.study.energy_drift.integral_drift import IntegralDrift

x, y = coordinates("x y")
px = x.momentum
quartic = Hamiltonian(px**2 / 2 + x**4 / 4, [x], [px])
pendulum = Hamiltonian(px**2 / 2 - sp.cos(x), [x], [px])
STEPS = {"method": Splitting("verlet"), "step": 0.1, "samples": 250}


def test_what_is_called_a_momentum_is_one():
    spring = Lagrangian(5 * x.dot**2 / 2 - 5 * x**2 / 2, [x])
    axes = plot_phase_portrait(propagate(spring, (0, 6), {"x": 1, "x_dot": 0}, samples=100))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x", "p_x")
    assert abs(axes.lines[0].get_ydata()).max() == pytest.approx(5.0, rel=1e-3)
    own = plot_phase_portrait(propagate(quartic, (0, 6), [1, 0], samples=100))
    assert (own.get_xlabel(), own.get_ylabel()) == ("x", "p_x")


def test_a_vector_field_has_no_momenta():
    def lorenz(t, state):
        a, b, c = state
        return [10 * (b - a), a * (28 - c) - b, a * b - 8 * c / 3]

    motion = propagate(lorenz, (0, 5), [1.0, 1.0, 1.0], samples=100)
    axes = plot_phase_portrait(motion)
    assert (axes.get_xlabel(), axes.get_ylabel()) == tuple(motion.record.names[:2])
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), motion.y[1])


def test_energy_errors_back_in_time_and_of_ensembles():
    there, back = (propagate(quartic, (0, t), [1.0, 0.0], **STEPS) for t in (50, -50))
    lines = [plot_energy_error(motion).lines[0] for motion in (there, back)]
    np.testing.assert_allclose(*(line.get_ydata() for line in lines), rtol=1e-5)  # the method is symmetric
    starts = np.array([[1.0, 1.1, 1.2, 1.3], [0.0] * 4])
    many = propagate(quartic, (0, 50), starts, **STEPS)
    worst = plot_energy_error(many).lines[0].get_ydata().max()
    single = [propagate(quartic, (0, 50), start, **STEPS) for start in starts.T]
    assert worst == pytest.approx(max(plot_energy_error(one).lines[0].get_ydata().max() for one in single))


def test_a_fan_back_in_time_has_times_that_a_logarithm_shows():
    starts = np.array([[1.0, 1.1, 1.2, 1.3], [0.0] * 4])
    fans = [plot_ensemble_fan(propagate(quartic, (0, t), starts, **STEPS)) for t in (50, -50)]
    forward, back = (fan.lines[0].get_xdata() for fan in fans)
    np.testing.assert_allclose(back, forward)


def test_all_drifts_of_formal_integrals_are_drawn():
    drifts = [IntegralDrift((0.1, 0.2), (k * 1e-3, k * 2e-3), 2, 1.0, (True, True)) for k in range(1, 10)]
    lines = plot_integral_drift(*drifts).lines[::2]
    assert [line.get_ydata()[0] for line in lines] == [each.drifts[0] for each in drifts]
    assert len({(line.get_color(), line.get_marker()) for line in lines}) == 9 > len(COLOURS)


def test_a_map_of_chaos_hides_no_orbit():
    starts = np.array([[0.1, 0.2, 1.0, 2.0], [0.0, 0.0, 0.1, 0.1]])
    found = megno(pendulum, (0, 100), starts, method=Splitting("verlet"), step=0.1)
    with pytest.raises(ValueError, match="2 orbits are at one place, 0 across and 0 up"):
        plot_chaos_map(found, [0, 0, 1, 1], [0, 0, 0, 1])
    shown = plot_chaos_map(found, [0, 1, 0, 1], [0, 0, 1, 1]).collections[0].get_array()
    np.testing.assert_array_equal(shown.ravel(), found.value)


def test_a_map_of_orbits_that_have_all_left_is_grey():
    open_one = Hamiltonian(px**2 / 2 + x**3 / 3, [x], [px])
    starts = np.array([[-2.0, -1.0], [0.0, 0.0]])
    found = megno(open_one, (0, 50), starts, method=Splitting("verlet"), step=0.01)
    assert plot_chaos_map(found, [0, 1], [0, 0]).collections[0].get_array().mask.all()


def test_an_oscillation_that_widens_is_drawn_as_fast_as_it_widens():
    t = np.linspace(0, 1000, 8001)
    widening = drift(t, 1e-9 * (1 + t / 200) * np.sin(6.1 * t))
    rising = drift(t, 1e-9 * (np.sin(6.1 * t) + t / 200))
    rows = [DriftRow(RK4(), 0.1, t, t, drift=widening), DriftRow(Taylor(), 0.1, t, t, drift=rising)]
    drawn = [line.get_ydata()[0] for line in plot_drift_by_step(rows, what="slope").lines]
    assert drawn == [widening.amplitude_slope, rising.slope]
