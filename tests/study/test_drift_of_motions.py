"""Drift of motions: truncation is told from round-off by what rounding can do with the steps and the precision."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from canon import (
    RK4,
    Event,
    Gauss,
    Hamiltonian,
    Lagrangian,
    Splitting,
    Taylor,
    coordinates,
    drift,
    propagate,
    time,
)
from canon.flow.method.method import DOP853
from canon.mechanics import UnilateralLagrangian
from canon.study.energy_drift.drift import Growth
from canon.study.energy_drift.error_series import error_series

PENDULUM = {"span": 2000.0, "y0": [1.0, 0.0]}
KEPLER = {"span": 400.0, "y0": [0.4, 0.0, 0.0, 2.0]}
"""Eccentricity 0.6, period 2π."""


def pendulum():
    x = coordinates("x")
    return Hamiltonian(x.momentum**2 / 2 - sp.cos(x), [x], [x.momentum])


def kepler():
    x, y = coordinates("x y")
    return Hamiltonian(
        (x.momentum**2 + y.momentum**2) / 2 - 1 / sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
    )


def moved(system, of, samples=4096, **how):
    return propagate(system, t_span=(0, of["span"]), y0=of["y0"], samples=samples, **how)


TOLD = [
    (kepler, KEPLER, {"method": Splitting("verlet"), "step": 0.0067}, Growth.BOUNDED, "truncation"),
    (kepler, KEPLER, {"method": RK4(), "step": 0.0067}, Growth.SECULAR, "truncation"),
    (kepler, KEPLER, {"method": Taylor(1e-6)}, Growth.SECULAR, "truncation"),
    (kepler, KEPLER, {"method": Taylor(1e-10)}, Growth.SECULAR, "truncation"),
    (kepler, KEPLER, {"method": Taylor()}, Growth.ROUND_OFF, "round-off"),
    (
        kepler,
        KEPLER,
        {"method": Splitting("kahan-li-8"), "step": 0.00167, "precision": "double"},
        Growth.ROUND_OFF,
        "round-off",
    ),
    (pendulum, PENDULUM, {"method": Splitting("kahan-li-8"), "step": 0.05}, Growth.ROUND_OFF, "round-off"),
    (pendulum, PENDULUM, {"method": Splitting("verlet"), "step": 0.01}, Growth.BOUNDED, "truncation"),
    (pendulum, PENDULUM, {"method": Gauss(1), "step": 0.05}, Growth.BOUNDED, "truncation"),
]


@pytest.mark.parametrize(("system", "of", "how", "growth", "cause"), TOLD)
def test_what_makes_the_error_is_told(system, of, how, growth, cause):
    found = drift(moved(system(), of, **how))
    assert (found.verdict, found.cause) == (growth, cause), found
    assert cause in str(found)
    assert str(how["method"]) in found.way


@pytest.mark.parametrize(
    "how",
    [
        {"method": Splitting("kahan-li-8"), "step": 0.03},
        {"method": DOP853(1e-4)},
        {"method": Taylor(1e-3)},
        {"method": RK4(), "step": 0.01},
    ],
)
def test_truncation_is_never_called_round_off(how):
    """Kepler's motion with eccentricity 0.9 and steps that are too large for its pericentre."""
    of = {"span": 200.0, "y0": [0.1, 0.0, 0.0, float(np.sqrt(19.0))]}
    motion = moved(kepler(), of, **how)
    assert np.abs(motion.energy_error).max() > 1e-8
    for found in (drift(motion), drift(motion.t, motion.energy_error)):
        assert found.verdict is not Growth.ROUND_OFF
        assert found.cause != "round-off"
    assert drift(motion).cause == "truncation"


def test_the_same_series_without_its_motion_answers_less():
    motion = moved(kepler(), KEPLER, method=Taylor())
    assert drift(motion.t, motion.energy_error).verdict is Growth.WANDERING
    assert drift(motion).verdict is Growth.ROUND_OFF


def test_a_drift_that_rounding_to_one_side_could_make_is_left_open():
    """RK4 with small steps in plain doubles: half the step tells, canon does not guess."""
    motion = moved(pendulum(), PENDULUM, method=RK4(), step=0.002, precision="double")
    found = drift(motion)
    assert found.verdict is Growth.SECULAR
    assert error_series(motion).walk < found.bound < 100.0 * error_series(motion).bias
    assert found.cause == ""
    assert "half the step" in found.reason


def test_rounding_is_measured_by_the_terms_of_the_energy():
    """Kepler's parabola, nearly: the energy is 1e-6 of its terms, and rounding 1e6 times larger relative to it."""
    of = {"span": 3.0, "y0": [1.0, 0.0, 0.0, float(np.sqrt(2.0 - 2e-6))]}
    series = error_series(moved(kepler(), of, samples=300, method=Taylor()))
    motion = moved(kepler(), of, samples=300, method=Taylor())
    plain = 2.0**-53 * np.sqrt(motion.steps)
    assert series.walk > 1e5 * plain
    assert drift(motion).cause != "truncation"


def driven(**how):
    """An oscillator that starts with an energy of ½ and is driven to one of 139, all of it work."""
    x = coordinates("x")
    forced = Lagrangian(x.dot**2 / 2 - x**2 / 2, [x], forces=[-x.dot / 50 + sp.cos(time) / 3])
    return propagate(forced, (0, 3000), [1.0, 0.0], samples=8192, **how)


def test_rounding_is_measured_by_the_energy_and_the_work_on_the_way():
    found = drift(driven(precision="quad"))
    assert (found.verdict, found.cause) == (Growth.ROUND_OFF, "round-off")
    motion = driven()
    assert error_series(motion).walk > 139.0 / 0.5 * 2.0**-53 * np.sqrt(motion.steps)
    assert drift(motion).cause == ""
    assert "half the step" in drift(motion).reason


@pytest.mark.parametrize("how", [{"method": Taylor(1e-8)}, {"method": RK4(), "step": 0.05}])
def test_truncation_of_a_driven_motion_is_told_still(how):
    assert drift(driven(**how)).cause == "truncation"


def test_a_followed_observable_a_backward_motion_and_one_of_many_orbits():
    x, y = kepler().q
    spin = x * y.momentum - y * x.momentum
    how = {"method": RK4(), "step": 0.01}
    motion = moved(kepler(), KEPLER, observables={"spin": spin}, **how)
    assert drift(motion, observable="spin").verdict is Growth.SECULAR
    assert drift(motion, observable="spin").bound == pytest.approx(np.abs(motion.changes["spin"]).max() / 0.8)
    with pytest.raises(ValueError, match="has not followed 'area', only energy, spin"):
        drift(motion, observable="area")
    back = propagate(kepler(), t_span=(0, -400), y0=KEPLER["y0"], samples=4096, **how)
    assert drift(back).verdict is Growth.SECULAR
    starts = np.array([KEPLER["y0"], [0.5, 0.0, 0.0, 1.7]]).T
    many = propagate(kepler(), t_span=(0, 400), y0=starts, samples=4096, **how)
    with pytest.raises(ValueError, match="2 orbits: say which one"):
        drift(many)
    assert drift(many, orbit=0).slope == pytest.approx(drift(motion).slope, rel=1e-6)
    assert abs(drift(many, orbit=1).slope) < abs(drift(many, orbit=0).slope)


def test_what_was_followed_inside_the_loop_is_judged_by_every_step():
    how = {"method": Splitting("verlet"), "step": 0.0067}
    inside = moved(kepler(), KEPLER, samples=512, cadence=1, **how)
    found = drift(inside)
    assert found.verdict is Growth.BOUNDED
    assert found.bound == inside.statistics["energy"].largest.max() / abs(inside.energy[0])
    assert found.bound >= np.abs(inside.energy_error).max()


def test_what_is_no_error_is_refused():
    x = coordinates("x")
    driven = Hamiltonian(x.momentum**2 / 2 + x**2 / 2 - x * sp.cos(time / 3), [x], [x.momentum])
    motion = propagate(driven, t_span=(0, 100), y0=[1.0, 0.0], method=Taylor(), samples=1000)
    with pytest.raises(ValueError, match="H depends on t, so its change is no error; drift_study"):
        drift(motion)
    few = moved(pendulum(), PENDULUM, samples=100, method=Taylor())
    with pytest.raises(ValueError, match="101 samples are too few"):
        drift(few)
    with pytest.raises(ValueError, match=r"drift\(motion\) takes a motion"):
        drift(np.linspace(0.0, 1.0, 500))


@pytest.mark.parametrize("as_lagrangian", [False, True])
def test_energy_that_a_ball_loses_at_its_bounces_is_no_error_of_a_method(as_lagrangian):
    x = coordinates("x")
    v = x.dot if as_lagrangian else x.momentum
    falling = Lagrangian(v**2 / 2 - x, [x]) if as_lagrangian else Hamiltonian(v**2 / 2 + x, [x], [v])
    for kept, verdict in ((1, Growth.ROUND_OFF), (sp.Rational(99, 100), None)):
        bounce = Event(x, -1, {v: -kept * v})
        motion = propagate(falling, (0, 60), [1.0, 0.0], events=[bounce], samples=1000)
        if verdict is not None:
            assert drift(motion).verdict in (verdict, Growth.BOUNDED)
            continue
        with pytest.raises(
            ValueError, match=r"x = 0 has changed the energy from 1 to 0\.9801 at t = 1\.41421"
        ):
            drift(motion)


def test_what_impacts_take_is_work_and_refraction_is_none():
    y = coordinates("y")
    ball = UnilateralLagrangian(Lagrangian(y.dot**2 / 2 - y, [y]), [y], restitution=[sp.Rational(9, 10)])
    assert drift(propagate(ball, (0, 20), [1.0, 0.0], samples=512)).bound < 1e-12
    step = Hamiltonian(y.momentum**2 / 2 + y**2 / 2 + sp.Heaviside(y) / 10, [y], [y.momentum])
    assert drift(propagate(step, (0, 50), [1.0, 0.3], samples=512)).bound < 1e-12
