"""Scenes in motion: against other integrators on other equations, and against everything known of them."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import heyoka as hy
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from canon import Gauss, propagate
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.mechanics.at_scale.constrained import constrained, constrained_motion
from canon.mechanics.at_scale.numeric_functions import acceleration_function
from canon.mechanics.at_scale.second_order import derivation, derivation_of_lagrangian
from canon.scene import SCENES, Integral, SceneError, Solution, find, names
from canon.scene.equations_of_motion import scene_equations
from canon.scene.known_truths import Check, check, conserved, integrals_along, solutions_met
from canon.scene.scene_motion import first_zero, run, start_state

EACH = pytest.mark.parametrize("name", names())
FAST = 5.0
"""Periods of the runs of the default tests."""


def by_newtons_second_law(scene, span):
    """The end of the motion by DOP853 on M q̈ = f + Aᵀλ, solved numerically at every step by LAPACK."""
    start, values, n = scene.start(), scene.values_by_symbol(), len(scene.q)
    if scene.bodies_of:
        forces = scene.forces_of(scene.symbols) if scene.forces_of else None
        V = scene.V_of(scene.symbols) if scene.V_of else 0
        equations = derivation(scene.bodies_of(scene.symbols), scene.q, V, forces=forces)
    else:
        equations = derivation_of_lagrangian(scene.lagrangian)
    y0 = [*start.q, *start.v]
    if scene.holonomic_of or scene.nonholonomic_of:
        bound = scene.constrained
        motion = constrained_motion(constrained(equations, bound.holonomic, bound.nonholonomic), values)
        y0 = np.concatenate(motion.projected(start.q, start.v, 0.0))

        def acceleration(q, v, t):
            return motion.accelerations(q, v, t)[0]
    else:
        acceleration = acceleration_function(equations, values)

    def rate(t, y):
        return np.concatenate([y[n:], acceleration(y[:n].tolist(), y[n:].tolist(), t)])

    return solve_ivp(rate, (0.0, span), y0, method="DOP853", rtol=1e-12, atol=1e-13).y[:n, -1]


@pytest.mark.parametrize("name", [s.name for s in SCENES if s.H_of is None and s.starts[0].v])
def test_the_motion_is_that_of_another_integrator_on_other_equations(name):
    scene = find(name)
    motion = run(scene, periods=1.0, samples=7)
    other = by_newtons_second_law(scene, scene.period)
    size = np.abs(motion.q).max()
    np.testing.assert_allclose(motion.q[:, -1] / size, other / size, atol=1e-9)


@pytest.mark.parametrize("name", ["henon-heiles", "toda", "kepler", "hyperbolic"])
def test_hamiltonian_scenes_move_as_by_gauss(name):
    scene = find(name)
    motion = run(scene, periods=1.0, samples=3)
    other = propagate(
        scene.hamiltonian,
        (0.0, scene.period),
        scene.state(),
        method=Gauss(6),
        step=scene.period / 400.0,
        parameters=scene.values,
        samples=1,
    )
    np.testing.assert_allclose(motion.x[:, -1], other.final, atol=1e-12)


def heyokas(model, y0, span):
    integrator = hy.taylor_adaptive(model, y0)
    integrator.propagate_until(span)
    return integrator.state


def test_pendulum_against_heyokas_model():
    scene = find("simple-pendulum")
    motion = run(scene, "wide", periods=3.0, samples=1)
    model = hy.model.pendulum(gconst=scene.values["g"], length=scene.values["l"])
    found = heyokas(model, [2.0, 0.0], 3.0 * scene.period)
    np.testing.assert_allclose(motion.q[0, -1], found[0], atol=1e-12)


def test_restricted_problem_against_heyokas_model():
    """heyoka's cr3bp has the same momenta in the same turning frame, the Earth at +µ: turned by half a turn."""
    scene = find("restricted-three-body")
    motion = run(scene, "Arenstorf", periods=0.5, samples=1)
    x, y, p_x, p_y = scene.state("Arenstorf")
    model = hy.model.cr3bp(mu=scene.values["mu"])
    state = heyokas(model, [-x, -y, 0.0, -p_x, -p_y, 0.0], 0.5 * scene.period)
    np.testing.assert_allclose(motion.q[:, -1], -state[:2], atol=1e-9)


def test_figure_eight_against_heyokas_model():
    scene = find("figure-eight")
    motion = run(scene, periods=0.4, samples=1)
    q, p = np.split(scene.state(), 2)
    state = []
    for body in range(3):
        state += [*q[2 * body : 2 * body + 2], 0.0, *p[2 * body : 2 * body + 2], 0.0]
    found = heyokas(hy.model.nbody(3), state, 0.4 * scene.period)
    places = found.reshape(3, 6)[:, :2].ravel()
    np.testing.assert_allclose(motion.q[:, -1], places, atol=1e-11)


@EACH
def test_everything_known_is_met(name):
    for each in check(find(name), periods=FAST):
        assert each.passed, str(each)


@pytest.mark.slow
@EACH
def test_everything_known_is_met_for_a_thousand_periods(name):
    for each in check(find(name), periods=1000.0):
        assert each.passed, str(each)
        assert (
            each.why
            or each.error <= 1e-13
            or each.name in {s.name for s in find(name).solutions} | {"constraints"}
        )


@pytest.mark.parametrize(
    "name", ["damped-oscillator", "driven-oscillator", "forced-pendulum", "parametric-pendulum"]
)
def test_energy_follows_the_work_and_not_otherwise(name):
    """The energy itself changes by far more than what it and the work differ by."""
    scene = find(name)
    motion = run(scene, periods=FAST)
    energy = motion.values([motion.equation.energy])[0]
    assert np.abs(energy - energy[0]).max() > 1e-3 * np.abs(energy).max()
    kept = integrals_along(motion)[0]
    assert kept.name == "energy less the work done"
    assert kept.passed


def test_a_wrong_power_is_noticed():
    scene = find("damped-oscillator")
    motion = run(scene, periods=FAST)
    graph = motion.equation.field.graph
    twice = graph.scaled(Fraction(2), motion.equation.work)
    wrong = replace(motion, equation=replace(motion.equation, work=twice))
    assert not integrals_along(wrong)[0].passed


def test_wrong_twins_of_known_things_fail():
    scene = find("simple-pendulum")
    wrong = replace(
        scene,
        integrals=(Integral("the momentum", lambda s: s.theta.momentum),),
        solutions=(Solution("harmonic", "wide", lambda s: s.theta, lambda v, t: 2.0 * np.cos(3.0 * t)),),
    )
    assert conserved(wrong, wrong.integrals[0]).fails
    assert [each.passed for each in integrals_along(run(wrong, "wide"))] == [True, False]
    assert not next(iter(solutions_met(wrong))).passed


def test_a_number_that_is_none_never_passes():
    assert not Check("x", float("nan"), 1.0, "relative", "").passed


def test_what_never_happens_is_said():
    scene = find("simple-pendulum")
    with pytest.raises(NonFiniteStateError, match="does not vanish before"):
        first_zero(scene, "small", scene.q[0] - 1, periods=2)
    never = replace(
        scene,
        solutions=(
            Solution(
                "never", "small", lambda s: s.t, lambda v, t: 1.0, event=lambda s: s.theta - 1, periods=1.0
            ),
        ),
    )
    found = list(solutions_met(never))
    assert not found[0].passed
    assert "does not vanish" in found[0].about


def test_starts_are_put_onto_the_constraints():
    scene = find("rolling-disc")
    slipping = replace(scene.start("circle"), v=(0.0, 0.0, 0.0, 3.0, -5.0))
    motion = run(scene, slipping, periods=0.1, samples=2)
    assert np.abs(motion.values(motion.equation.residuals)).max() < 1e-14
    assert motion.observed(scene.q[0].dot)[0] != 0.0


def test_refused_questions():
    scene = find("henon-heiles")
    with pytest.raises(SceneError, match="give a positive, finite number"):
        run(scene, periods=0.0)
    with pytest.raises(SceneError, match="no start 'regularr'"):
        run(scene, "regularr")
    from sympy import Symbol

    with pytest.raises(SceneError, match="holds w, which the scene lacks"):
        scene_equations(scene).node(Symbol("w"), "the claim")


@pytest.mark.parametrize("name", [scene.name for scene in SCENES if scene.angles])
def test_angles_may_be_turned_back(name):
    """The rates of change are the same a whole turn further."""
    scene = find(name)
    equation = scene_equations(scene)
    field = equation.field
    at = dict(zip(field.x, start_state(scene, scene.starts[-1], equation) + 0.01, strict=True)) | {
        field.t: 0.3
    }
    rates = field.graph.evaluate(field.rates, at)
    assert set(scene.angles.split()) <= set(scene.coordinates.split())
    for s in scene.q:
        if s.name in scene.angles.split():
            further = field.graph.evaluate(field.rates, {**at, s: at[s] + 2.0 * np.pi})
            np.testing.assert_allclose(further, rates, rtol=1e-9, atol=1e-9 * np.abs(rates).max())


def test_angles_that_are_turned_back_keep_their_digits():
    scene = find("simple-pendulum")
    kept, lost = (run(each, "rotating", 300.0, 307) for each in (scene, replace(scene, angles="")))
    assert kept.turns[0, -1] == round(kept.q[0, -1] / (2.0 * np.pi)) > 100
    assert np.abs(kept.x[0]).max() < 10.0
    np.testing.assert_allclose(kept.q, lost.q, rtol=1e-9)
    assert integrals_along(kept)[0].error < 1e-13
    assert integrals_along(lost)[0].error > 1e-12
