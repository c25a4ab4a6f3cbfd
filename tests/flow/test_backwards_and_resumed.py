"""Motions that go back in time on constraints, that are resumed on an event, and walls at which the masses jump."""

import numpy as np
import pytest
import sympy as sp
from sympy import Rational

from canon import (
    DOP853,
    RK4,
    ConstrainedLagrangian,
    Event,
    Gauss,
    Hamiltonian,
    Lagrangian,
    Splitting,
    Taylor,
    coordinates,
    propagate,
    time,
)

x, y = coordinates("x y")
STEPS = [
    {"method": Splitting("verlet"), "step": 0.125},
    {"method": Gauss(2), "step": 0.125},
    {"method": Taylor()},
    {"method": DOP853()},
]


@pytest.mark.parametrize(
    ("method", "step", "bound"), [(Taylor(), None, 1e-14), (DOP853(), None, 1e-9), (RK4(), 0.01, 1e-6)]
)
def test_constraints_pull_backwards_too(method, step, bound):
    """ẍ = −2α ẋ − α² x dies out for α > 0 forwards, and grows backwards."""
    free = Lagrangian((x.dot**2 + y.dot**2) / 2 - 10 * y, [x, y])
    pendulum = ConstrainedLagrangian(free, holonomic=[x**2 + y**2 - 1])
    there, back = (
        propagate(pendulum, (0, sign * 20), [0.6, -0.8, 0, 0], method=method, step=step, samples=20)
        for sign in (1, -1)
    )
    assert np.abs(back.residuals).max() < bound
    assert back["x"] == pytest.approx(there["x"], abs=100 * bound)


@pytest.mark.parametrize("how", STEPS)
@pytest.mark.parametrize("action", ["record", {x.momentum: x.momentum + 1}])
def test_an_event_at_the_instant_of_a_break_is_met_once(how, action):
    free = Hamiltonian(x.momentum**2 / 2, [x], [x.momentum])
    kick = [Event(time - 5, action=action)]
    whole = propagate(free, (0, 10), [0.0, 1.0], events=kick, samples=10, **how)
    resumed = propagate(free, (0, 5), [0.0, 1.0], events=kick, samples=5, **how).resume(10)
    assert [met.t for met in whole.events] == [met.t for met in resumed.events] == [5]
    assert resumed.final == pytest.approx(whole.final, rel=1e-13)
    later = propagate(free, (0, 7), [0.0, 1.0], events=kick, samples=7, **how).resume(10)
    assert len(later.events) == 1


@pytest.mark.parametrize("method", [Taylor(), DOP853()])
@pytest.mark.parametrize(
    ("height", "momentum", "end"),
    [(10, -1, -2), (-10, 5.25**0.5, 8 * 5.25**0.5), (Rational(1, 4), 0.125**0.5, 8 * 0.125**0.5)],
)
def test_a_wall_at_which_the_mass_jumps(method, height, momentum, end):
    """H = p²/2 on the left, 2 p² + h on the right; from p = 1, E = 1/2."""
    p = x.momentum
    wall = Hamiltonian(p**2 / 2 + sp.Heaviside(x) * (Rational(3, 2) * p**2 + height), [x], [p])
    motion = propagate(wall, (0, 3), [-1.0, 1.0], method=method)
    assert motion.final == pytest.approx([end, momentum], rel=1e-12)
    assert abs(motion.energy_error).max() < 1e-13
