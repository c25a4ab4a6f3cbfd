"""Choices, studies and work diagrams of systems that are no Hamiltonians: what should stay is the balance of energy."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from canon import RK4, Lagrangian, Taylor, choose, coordinates, drift, time, work_precision
from canon.study.energy_drift.drift import Growth
from canon.study.energy_drift.drift_study import drift_study
from canon.study.errors import StudyError


def damped_and_driven() -> Lagrangian:
    x = coordinates("x")
    return Lagrangian(x.dot**2 / 2 - x**2 / 2, [x], forces=[-x.dot / 100 + sp.cos(time / 3) / 5])


def exact(t):
    """x″ + x′/100 + x = cos(t/3)/5 from x = 1 at rest."""
    gain = 0.2 / (8.0 / 9.0 + 1j / 300.0)
    root = -0.005 + 1j * np.sqrt(1.0 - 0.005**2)
    forced, rate = gain.real, (gain * 1j / 3.0).real
    a = 1.0 - forced
    b = (-rate - root.real * a) / root.imag
    free = np.exp(root.real * t) * (a * np.cos(root.imag * t) + b * np.sin(root.imag * t))
    return (gain * np.exp(1j * t / 3.0)).real + free


def test_the_choice_for_a_position_is_kept():
    choice = choose(damped_and_driven(), 300.0, [1.0, 0.0], accuracy=1e-7, observable="position")
    assert choice.reached
    assert {str(each.method).partition("(")[0] for each in choice.candidates} == {"Taylor", "DOP853", "RK4"}
    motion = choice.run()
    assert np.abs(motion.q[0] - exact(motion.t)).max() <= 1e-7 * np.abs(motion.q).max()


@pytest.mark.parametrize("method", [RK4(), Taylor()])
def test_the_choice_for_the_balance_of_energy_is_kept(method):
    choice = choose(damped_and_driven(), 2000.0, [1.0, 0.0], accuracy=1e-7, methods=[method])
    assert choice.reached
    motion = choice.run()
    assert choice.predicted_error / 5.0 < np.abs(motion.energy_error).max() <= 1e-7
    assert np.abs(motion.energy_change).max() > 0.1


def test_the_balance_drifts_by_truncation_and_wanders_by_rounding():
    found = drift_study(damped_and_driven(), [1.0, 0.0], span=2000.0, step=0.05)
    runge_kutta, taylor = (row.drift for row in found.rows)
    assert runge_kutta.verdict is not Growth.ROUND_OFF
    assert runge_kutta.bound > 1e-8
    assert taylor.bound < 1e-12
    with pytest.raises(StudyError, match="no Hamiltonian the energy has a name"):
        drift_study(damped_and_driven(), [1.0, 0.0], span=100.0, step=0.05, observables=["momenta"])


def test_work_and_precision_of_a_damped_motion():
    found = work_precision(
        damped_and_driven(), 50.0, [1.0, 0.0], methods=[RK4()], steps=[0.1, 0.05], repetitions=1
    )
    coarse, fine = found.rows
    assert np.log2(coarse.position_error / fine.position_error) == pytest.approx(4.0, abs=0.2)


def test_drift_takes_a_damped_motion():
    motion = choose(damped_and_driven(), 2000.0, [1.0, 0.0], accuracy=1e-6, methods=[RK4()]).run()
    assert drift(motion).cause == "truncation"
    assert drift(motion).bound == pytest.approx(np.abs(motion.energy_error).max())
