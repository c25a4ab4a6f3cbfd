"""Systems of every sort through one door, held against equations written independently and integrated by SciPy."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

from canon import (
    DOP853,
    RK4,
    ConstrainedLagrangian,
    Event,
    Gauss,
    Lagrangian,
    Splitting,
    coordinates,
    drift,
    flow_jacobian,
    parameters,
    propagate,
)
from canon.scene import SceneError, find
from canon.scene.scene_motion import run
from canon.study import Growth
from tests.flow.moving_systems import CASES

t = sp.Symbol("t", real=True)
x, y, theta = coordinates("x y theta")
m, l, g, c, w = parameters("m l g c w", positive=True)


@functools.cache
def reference(name: str) -> np.ndarray:
    case = CASES[name]
    found = solve_ivp(case.rates, case.span, case.y0, method="DOP853", rtol=1e-12, atol=1e-13)
    assert found.success
    return found.y[:, -1]


def test_there_are_many_cases() -> None:
    assert len(CASES) >= 50


@pytest.mark.parametrize("name", CASES)
def test_taylor_agrees_with_equations_written_by_hand(name: str) -> None:
    case = CASES[name]
    motion = propagate(case.system, y0=case.y0, t_span=case.span, parameters=case.values, samples=50)
    np.testing.assert_allclose(motion.final, reference(name), rtol=1e-9, atol=1e-9)
    if case.energy:
        defect = motion.energy_change - motion.work
        np.testing.assert_allclose(
            motion.energy_defect, defect, atol=1e-13 * max(1.0, abs(motion.energy).max())
        )
        assert abs(defect).max() < 1e-13 * max(1.0, abs(motion.energy).max())
    if hasattr(case.system, "holonomic"):
        assert abs(motion.residuals).max() < 3e-14
    for what, written in case.shown.items():
        np.testing.assert_allclose(
            motion[what],
            [written(t, s) for t, s in zip(motion.t, motion.y.T, strict=True)],
            rtol=1e-11,
            atol=1e-12,
        )


@pytest.mark.parametrize(("method", "step"), [(DOP853(), None), (RK4(), 1 / 512), (Gauss(4), 1 / 16)])
@pytest.mark.parametrize(
    "name", ["a damped driven pendulum", "Lorenz's equations", "a pendulum in Cartesian coordinates"]
)
def test_every_method_for_any_equations_agrees(name: str, method: Any, step: float | None) -> None:
    case = CASES[name]
    motion = propagate(
        case.system,
        y0=case.y0,
        t_span=case.span,
        parameters=case.values,
        method=method,
        step=step,
        samples=50,
    )
    np.testing.assert_allclose(motion.final, reference(name), rtol=3e-6, atol=3e-6)


def test_a_wrong_force_is_seen_in_the_motion_and_not_in_the_balance() -> None:
    case = CASES["a damped driven pendulum"]
    wrong = Lagrangian(case.system.L, [theta], forces=[-2 * c * theta.dot + sp.cos(w * t)])
    motion = propagate(wrong, y0=case.y0, t_span=case.span, parameters=case.values)
    assert abs(motion.final - reference("a damped driven pendulum")).max() > 1e-2
    assert abs(motion.energy_error).max() < 1e-13


def test_energy_balance_shows_the_error_of_a_crude_method() -> None:
    case = CASES["a damped driven pendulum"]
    arguments = {"y0": case.y0, "t_span": case.span, "parameters": case.values}
    crude = propagate(case.system, method=RK4(), step=0.1, **arguments)
    assert abs(crude.energy_error).max() > 1e-7
    assert abs(crude.energy_change).max() > 0.1


def test_splittings_are_for_hamiltonians() -> None:
    case = CASES["a damped driven pendulum"]
    with pytest.raises(ValueError, match=r"verlet is made for a Hamiltonian.*Taylor, DOP853, RK4"):
        propagate(
            case.system,
            y0=case.y0,
            t_span=case.span,
            parameters=case.values,
            method=Splitting("verlet"),
            step=0.1,
        )


def test_starts_by_name_are_those_in_order() -> None:
    case = CASES["a damped driven pendulum"]
    named = propagate(case.system, y0={"theta": 0.5, theta.dot: -0.2}, t_span=(0, 1), parameters=case.values)
    ordered = propagate(case.system, y0=(0.5, -0.2), t_span=(0, 1), parameters=case.values)
    np.testing.assert_array_equal(named.y, ordered.y)
    np.testing.assert_array_equal(named["theta"], named.q[0])
    np.testing.assert_allclose(named["p_theta"], 4.5 * named.v[0], rtol=1e-15)
    np.testing.assert_array_equal(named.p[0], named["p_theta"])


@pytest.mark.parametrize(
    ("y0", "error", "sentence"),
    [
        ({"theta": 0.5}, KeyError, "no value for theta_dot"),
        ({"theta": 0.5, "theta_dot": 0, "psi": 1}, KeyError, "psi, which is no variable"),
        ({"theta": 0.5, theta: 0.5, "theta_dot": 0}, ValueError, "theta twice"),
        ((0.5, 0.0, 0.0), ValueError, r"shape \(3,\); the state is \(theta, theta_dot\)"),
        ((0.5, np.nan), ValueError, "not finite"),
    ],
)
def test_starts_that_make_no_sense(y0: Any, error: type[Exception], sentence: str) -> None:
    case = CASES["a damped driven pendulum"]
    with pytest.raises(error, match=sentence):
        propagate(case.system, y0=y0, t_span=case.span, parameters=case.values)


@pytest.mark.parametrize(
    ("changed", "error", "sentence"),
    [
        ({"gg": 1.0}, KeyError, "no parameter gg.*is g meant"),
        ({"g": 1.0}, ValueError, "give g twice"),
        ({theta: 1.0}, ValueError, "theta moves and is no parameter"),
        ({c: -0.1}, ValueError, "c was made as a positive symbol"),
        ({c: "no number"}, ValueError, "no finite real number"),
    ],
)
def test_parameters_that_make_no_sense(changed: Any, error: type[Exception], sentence: str) -> None:
    case = CASES["a damped driven pendulum"]
    with pytest.raises(error, match=sentence):
        propagate(case.system, y0=case.y0, t_span=case.span, parameters=case.values | changed)


def test_a_parameter_without_a_number() -> None:
    case = CASES["a damped driven pendulum"]
    with pytest.raises(KeyError, match="no number for c, w"):
        propagate(case.system, y0=case.y0, t_span=case.span, parameters={m: 2, l: 1.5, g: 9.8})


@pytest.mark.parametrize(
    ("y0", "sentence"),
    [
        ((0.6, -0.7, 0.8, 0.6), "holonomic constraint 1 is -0.15"),
        ((0.6, -0.8, 0.8, 0.5), "rate of constraint 1 is 0.16"),
    ],
)
def test_starts_off_the_constraints_are_refused(y0: Any, sentence: str) -> None:
    case = CASES["a pendulum in Cartesian coordinates"]
    with pytest.raises(ValueError, match=sentence):
        propagate(case.system, y0=y0, t_span=case.span, parameters=case.values)


def test_redundant_constraints_move_as_without_them() -> None:
    case = CASES["a pendulum in Cartesian coordinates"]
    twice = ConstrainedLagrangian(case.system.lagrangian, [*case.system.holonomic, 3 * (x**2 + y**2 - l**2)])
    given = {"y0": case.y0, "t_span": case.span, "parameters": case.values}
    once, both = propagate(case.system, **given), propagate(twice, **given)
    np.testing.assert_allclose(both.y, once.y, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(both.reactions, once.reactions, rtol=1e-10, atol=1e-10)
    assert not both.multipliers[1].any()


def test_the_tension_of_a_pendulum() -> None:
    case = CASES["a pendulum in Cartesian coordinates"]
    motion = propagate(case.system, y0=case.y0, t_span=case.span, parameters=case.values)
    pull = (
        -2 * (motion["x_dot"] ** 2 + motion["y_dot"] ** 2 - 9.8 * motion["y"]) / 2
    )  # m (v² − g y)/l², f = r² − l²
    np.testing.assert_allclose(motion.multipliers[0], pull, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(motion["lambda_1"], pull, rtol=1e-12, atol=1e-12)


def test_no_energy_is_known_of_a_vector_field() -> None:
    case = CASES["Lorenz's equations"]
    motion = propagate(case.system, y0=case.y0, t_span=(0, 1))
    with pytest.raises(AttributeError, match="no energy is known"):
        _ = motion.energy
    assert motion.error_estimate().relative[-1] < 1e-12


@pytest.mark.parametrize("name", ["unicycle", "damped-oscillator", "pendulum-multiplier", "driven-duffing"])
def test_scenes_move_by_value_and_by_name(name: str) -> None:
    scene = find(name)
    named = propagate(name, (0, scene.period), samples=20)
    value = propagate(scene, y0=scene.starts[0].name, t_span=(0, scene.period), samples=20)
    np.testing.assert_array_equal(named.y, value.y)
    along = run(scene, periods=1.0, samples=20)
    np.testing.assert_allclose(named.q, along.q, rtol=1e-11, atol=1e-11)
    assert abs(named.energy_error).max() < 1e-13


def test_a_scene_without_forces_moves_by_its_hamiltonian() -> None:
    scene = find("kepler")
    named = propagate("kepler", (0, 1), method=Splitting("verlet"), step=0.01)
    given = propagate(
        scene.hamiltonian,
        y0=scene.state(),
        t_span=(0, 1),
        method=Splitting("verlet"),
        step=0.01,
        parameters=scene.values,
    )
    np.testing.assert_array_equal(named.y, given.y)
    by_name = dict(
        zip((s.name for s in (*scene.hamiltonian.q, *scene.hamiltonian.p)), scene.state(), strict=True)
    )
    again = propagate(scene, y0=by_name, t_span=(0, 1), method=Splitting("verlet"), step=0.01)
    np.testing.assert_array_equal(again.y, given.y)
    np.testing.assert_allclose(again["x_dot"], again.v[0])


def test_scenes_and_parameters_that_are_not_there() -> None:
    with pytest.raises(SceneError, match="kepler"):
        propagate("keppler", (0, 1))
    with pytest.raises(KeyError, match="unicycle has no parameter q"):
        propagate("unicycle", (0, 1), parameters={"q": 1})
    with pytest.raises(TypeError, match="is no system that can be propagated"):
        propagate(sp.Symbol("x"), y0=[0, 1], t_span=(0, 1))


def test_backward_runs_events_dense_output_and_resumption() -> None:
    case = CASES["a damped driven pendulum"]
    given = {"y0": case.y0, "parameters": case.values}
    whole = propagate(case.system, t_span=(0, 4), dense=True, events=[Event(theta)], **given)
    back = propagate(case.system, t_span=(4, 0), y0=whole.final, parameters=case.values)
    np.testing.assert_allclose(back.final, case.y0, rtol=1e-12, atol=1e-12)
    half = propagate(case.system, t_span=(0, 2), **given)
    np.testing.assert_allclose(half.resume(4).final, whole.final, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(whole(2.0), half.final, rtol=1e-12, atol=1e-12)
    assert abs(half.resume(4).energy_error).max() < 1e-13
    assert whole.events
    assert max(abs(whole(met.t)[0]) for met in whole.events) < 1e-13
    observed = propagate(case.system, t_span=(0, 2), observables={"power": -c * theta.dot**2}, **given)
    np.testing.assert_allclose(observed["power"], -0.4 * observed.v[0] ** 2, rtol=1e-14)


@pytest.mark.parametrize(("method", "step"), [("taylor", None), ("RK4", 0.01), ("DOP853", None)])
def test_orbits_side_by_side_with_parameters_of_their_own(method: str, step: float | None) -> None:
    near = (
        1e-9 if method == "DOP853" else 1e-12
    )  # its steps are chosen by all variables, the parameters among them
    case, damping = CASES["a damped driven pendulum"], np.array([0.1, 0.4, 0.9])
    given = {"y0": case.y0, "t_span": (0, 2), "method": method, "step": step, "samples": 10}
    fan = propagate(case.system, parameters=case.values | {c: damping}, **given)
    assert fan.y.shape == (2, 11, 3)
    for i, each in enumerate(damping):
        alone = propagate(case.system, parameters=case.values | {c: float(each)}, **given)
        np.testing.assert_allclose(fan.y[:, :, i], alone.y, rtol=near, atol=near)
        np.testing.assert_allclose(fan.work[:, i], alone.work, rtol=10 * near, atol=near)


def test_constraints_that_depend_on_one_another_at_the_start_only() -> None:
    crossing = ConstrainedLagrangian(Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y]), [y - x**2, y + x**2])
    with pytest.raises(ValueError, match="does not follow from them at t ="):
        propagate(crossing, y0=(0, 0, 1, 0), t_span=(0, 1))


def test_a_degenerate_lagrangian_is_refused() -> None:
    with pytest.raises(ValueError, match=r"singular at the start along x_dot, y_dot.*Use fewer coordinates"):
        propagate(Lagrangian((x.dot + y.dot) ** 2 / 2 - x**2, [x, y]), y0=(1, 0, 0, 0), t_span=(0, 1))


def test_residuals_stay_at_round_off_over_long_spans() -> None:
    case = CASES["a double pendulum in Cartesian coordinates"]
    motion = propagate(case.system, y0=case.y0, t_span=(0, 200), parameters=case.values, samples=200)
    assert abs(motion.residuals).max() < 1e-13
    assert abs(motion.energy_error).max() < 1e-12


@pytest.mark.parametrize(
    "name", ["a damped driven pendulum", "Lorenz's equations", "Chaplygin's sleigh by Gibbs and Appell"]
)
@pytest.mark.parametrize(("method", "step"), [("taylor", None), ("RK4", 1 / 64)])
def test_jacobians_are_the_quotients_of_differences(name: str, method: str, step: float | None) -> None:
    case = CASES[name]
    given = {"t_span": (0, 1), "parameters": case.values, "method": method, "step": step, "samples": 1}
    M = flow_jacobian(case.system, y0=case.y0, **given).final
    assert M.shape == (len(case.y0), len(case.y0))
    for j, beside in enumerate(1e-5 * np.eye(len(case.y0))):
        ahead, behind = (
            propagate(case.system, y0=np.array(case.y0) + d, **given).final for d in (beside, -beside)
        )
        np.testing.assert_allclose(M[:, j], (ahead - behind) / 2e-5, rtol=1e-6, atol=1e-7)


def test_a_bead_leaves_the_hoop_where_its_force_vanishes() -> None:
    """By hand: m v²/R = m g y/R with v² = v0² + 2 g (R − y), so that y = (2 g R + v0²)/(3 g)."""
    free = Lagrangian((x.dot**2 + y.dot**2) / 2 - g * y, [x, y])
    hoop = ConstrainedLagrangian(free, [x**2 + y**2 - l**2])
    leaving = Event(sp.Symbol("lambda_1", real=True), -1, "stop")
    on = propagate(hoop, (0, 10), (0, 1, 0.1, 0), parameters={g: 9.8, l: 1}, events=[leaving])
    assert on.stopped
    np.testing.assert_allclose(on["y"][-1], (2 * 9.8 + 0.01) / (3 * 9.8), rtol=1e-13)
    off = propagate(free, (on.t[-1], on.t[-1] + 0.3), on.final, parameters={g: 9.8})
    assert (np.hypot(off["x"], off["y"])[1:] > 1).all()
    held = propagate(hoop, (0, on.t[-1] + 0.3), (0, 1, 0.1, 0), parameters={g: 9.8, l: 1})
    assert held.multipliers[0, -1] < 0  # a wire would have to hold the bead back


def test_drift_is_judged_by_the_energy_balance() -> None:
    case = CASES["a damped driven pendulum"]
    kept = drift(propagate(case.system, (0, 300), case.y0, parameters=case.values, samples=1000))
    assert kept.verdict is Growth.ROUND_OFF
    lost = propagate(
        case.system, (0, 300), case.y0, parameters=case.values, method="RK4", step=0.1, samples=1000
    )
    assert drift(lost).verdict is not Growth.ROUND_OFF


def test_a_ball_with_drag_bounces() -> None:
    """Between impacts v' = −g − c v in closed form; heights of the fall by the same solution."""
    ball = Lagrangian(m * y.dot**2 / 2 - m * g * y, [y], forces=[-c * y.dot])
    values, wall = {m: 2, g: 9.8, c: 0.6}, Event(y, -1, "bounce")
    motion = propagate(ball, (0, 2), (1.0, 0.0), parameters=values, events=[wall])
    rate, first = 0.3, motion.events[0]
    fallen = 1 - 9.8 / rate * first.t + 9.8 / rate**2 * (1 - np.exp(-rate * first.t))
    assert abs(fallen) < 1e-13
    np.testing.assert_allclose(first.after, [0, -first.y[1]], atol=1e-13)
    assert (motion["y"] > -1e-12).all()
    assert len(motion.events) >= 2


def test_a_bound_particle_bounces_along_its_constraint() -> None:
    on = ConstrainedLagrangian(Lagrangian((x.dot**2 + y.dot**2) / 2 - g * y, [x, y]), [y - x**2 / 2])
    stopped = propagate(
        on, (0, 5), (1, 0.5, 0, 0), parameters={g: 9.8}, events=[Event(x + 0.5, -1, "bounce")]
    )
    met = stopped.events[0]
    np.testing.assert_allclose(met.after[2:], -met.y[2:], rtol=1e-12)
    assert abs(stopped.residuals).max() < 1e-13
    assert np.ptp(stopped.energy) < 1e-13 * abs(stopped.energy).max()
    with pytest.raises(ValueError, match="vector field does not"):
        propagate(CASES["Lorenz's equations"].system, (0, 1), (1, 1, 1), events=[Event(x, 0, "bounce")])


@pytest.mark.parametrize("mass", [1e-30, 1e-15, 1e15, 1e30])
def test_small_and_large_masses_move_alike(mass: float) -> None:
    case = CASES["a pendulum in Cartesian coordinates"]
    motion = propagate(case.system, case.span, case.y0, parameters=case.values | {m: mass})
    np.testing.assert_allclose(motion.final, reference("a pendulum in Cartesian coordinates"), rtol=1e-9)
    assert abs(motion.residuals).max() < 3e-14
    case = CASES["a pendulum by Newton and Euler"]
    motion = propagate(case.system, case.span, case.y0, parameters=case.values | {m: mass})
    np.testing.assert_allclose(motion.final, reference("a pendulum by Newton and Euler"), rtol=1e-9)
    np.testing.assert_allclose(motion["S"][0], mass * 9.8 * np.cos(0.5), rtol=1e-14)


def test_units_of_time_and_length_do_not_matter() -> None:
    """The same pendulum with lengths in units of 1e-10 and times in units of 1e12."""
    case = CASES["a pendulum in Cartesian coordinates"]
    L, T = 1e10, 1e-12
    start = np.array(case.y0) * [L, L, L / T, L / T]
    motion = propagate(case.system, (0, 3 * T), start, parameters={m: 2, l: L, g: 9.8 * L / T**2})
    scaled = motion.final / [L, L, L / T, L / T]
    np.testing.assert_allclose(scaled, reference("a pendulum in Cartesian coordinates"), rtol=1e-9)
    assert abs(motion.residuals[0]).max() < 3e-14 * L**2


@pytest.mark.parametrize("scale", [1e-20, 1e20])
def test_the_balance_is_as_good_in_any_unit_of_energy(scale: float) -> None:
    case = CASES["two masses, springs and dampers"]
    scaled = Lagrangian(scale * case.system.L, case.system.q, forces=[scale * Q for Q in case.system.forces])
    motion = propagate(scaled, case.span, case.y0, parameters=case.values)
    np.testing.assert_allclose(
        motion.final, reference("two masses, springs and dampers"), rtol=1e-9, atol=1e-9
    )
    assert abs(motion.energy_error).max() < 1e-14
    assert abs(motion.work[-1]) > 0.05 * motion.energy[0]
