"""Motions driven in time: the time as a coordinate, and an energy that is conserved again."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from canon import RK4, Gauss, Hamiltonian, Splitting, Taylor, coordinates, propagate
from canon.expression.symbols.symbol import time
from canon.scene import find
from canon.study.energy_drift.drift import Growth
from canon.study.energy_drift.drift_study import drift_study
from canon.study.motion.extended_phase_space import driven

X = coordinates("x")
SHAKEN = Hamiltonian(X.momentum**2 / 2 + X**2 / 2 - X * sp.cos(2 * time) / 4, [X], [X.momentum])
START = np.array([1.0, 0.5])


@pytest.mark.parametrize("method", [Splitting("verlet"), Splitting("kahan-li-8"), Gauss(3), RK4()])
def test_the_steps_are_those_of_the_original(method):
    timed = driven(SHAKEN)
    with_time = propagate(timed.hamiltonian, (0.0, 30.0), timed.state(START), method=method, step=0.05)
    alone = propagate(SHAKEN, (0.0, 30.0), START, method=method, step=0.05)
    np.testing.assert_allclose(timed.original(with_time.y), alone.y, atol=1e-13)
    np.testing.assert_allclose(with_time.q[1], with_time.t, atol=1e-13)


def test_what_is_lost_is_the_work_done_from_outside():
    """Second route: −p_τ is ∫ ∂H/∂t dt by Simpson's rule over a motion with many samples."""
    timed = driven(SHAKEN)
    motion = propagate(timed.hamiltonian, (0.0, 10.0), timed.state(START), method=Taylor(), samples=2000)
    power = motion.q[0] * np.sin(2.0 * motion.t) / 2.0
    h = motion.t[1] - motion.t[0]
    work = h / 3.0 * (power[0] + power[-1] + 4.0 * power[1:-1:2].sum() + 2.0 * power[2:-1:2].sum())
    assert work == pytest.approx(-motion.p[1, -1], rel=1e-8)
    assert motion.energy_error[-1] == pytest.approx(0.0, abs=1e-13)


def test_symplectic_methods_keep_the_energy_less_the_work_and_runge_kutta_does_not():
    study = drift_study(
        SHAKEN, START, methods=[Splitting("verlet"), Gauss(2), RK4()], step=0.1, span=3000.0, samples=2**14
    )
    verlet, gauss, runge_kutta = (row.drift for row in study.rows)
    assert verlet.verdict is Growth.BOUNDED
    assert gauss.verdict is Growth.BOUNDED
    assert runge_kutta.verdict is Growth.SECULAR
    assert study.rows[0].final.shape == (2,)
    assert "less the work" in study.title


def test_functions_of_the_time_can_be_followed():
    """For H = p²/2 + t x the momentum p + t²/2 is constant; p + t²/4 is not."""
    y = coordinates("y")
    falling = Hamiltonian(y.momentum**2 / 2 + time * y, [y], [y.momentum])
    right, wrong = y.momentum + time**2 / 2, y.momentum + time**2 / 4
    for functions, bound in (({"momentum": right}, 1e-12), ({"momentum": wrong}, None)):
        (row,) = drift_study(
            falling, [0.0, 1.0], methods=[Gauss(2)], step=0.01, span=10.0, samples=512, observables=functions
        ).rows
        assert (row.drift.bound < 1e-12) == (bound is not None)


def test_a_scene_driven_in_time_is_judged():
    study = drift_study(find("parametric-pendulum"), methods=[Gauss(2), RK4()], periods=200.0)
    symplectic, runge_kutta = (row.drift.verdict for row in study.rows)
    assert symplectic in (Growth.BOUNDED, Growth.ROUND_OFF)
    assert runge_kutta is Growth.SECULAR


@pytest.mark.parametrize("name", ["hemisphere", "damped-oscillator"])
def test_scenes_with_constraints_and_forces_are_judged_by_the_balance_of_energy(name):
    runge_kutta, taylor = drift_study(name, span=5.0, step=0.01, samples=256).rows
    assert taylor.drift.bound < 1e-13
    assert runge_kutta.drift.bound < 1e-5
