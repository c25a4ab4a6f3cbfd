"""What a pilot and an error series look at: all samples, and the steps of one orbit."""

import numpy as np
import pytest

from canon import RK4, ConstrainedLagrangian, Hamiltonian, Lagrangian, Taylor, coordinates, propagate
from canon.flow.method.setting import Setting
from canon.study.energy_drift.error_series import error_series
from canon.study.method_choice.choice_question import Question
from canon.study.method_choice.pilot_run import change_of, pilot, unit_of

x, y = coordinates("x y")


@pytest.mark.parametrize("steps", [600, 1023])
def test_a_pilot_of_constraints_sees_its_last_steps(steps):
    """The error of RK4 grows to the end: of 600 steps 88 were not looked at."""
    free = Lagrangian((x.dot**2 + y.dot**2) / 2 - 10 * y, [x, y])
    pendulum = ConstrainedLagrangian(free, holonomic=[x**2 + y**2 - 1])
    span, start = steps * 0.02, np.array([0.6, -0.8, 0, 0])
    question = Question(pendulum, start, {}, span)
    found = pilot(question, Setting(RK4(), step=0.02), span)
    motion = propagate(pendulum, (0, span), start, method=RK4(), step=0.02, samples=steps)
    true = np.abs(change_of(motion, question) / unit_of(motion, question)).max()
    assert found.bound == pytest.approx(true, rel=1e-3)


def test_rounding_is_that_of_one_orbits_steps():
    oscillator = Hamiltonian((x.momentum**2 + x**2) / 2, [x], [x.momentum])
    alone, many = (
        propagate(oscillator, (0, 100), start, method=Taylor(), samples=64)
        for start in ([1.0, 0.0], np.array([[1.0, 1.0, 1.0], [0.0, 0.0, 0.0]]))
    )
    one, first = error_series(alone), error_series(many, orbit=0)
    assert (first.walk, first.bias) == (pytest.approx(one.walk), pytest.approx(one.bias))
