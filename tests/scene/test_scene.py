"""What every scene keeps, and what the door refuses."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import fields, replace

import numpy as np
import pytest
import sympy as sp

from canon.expression.symbols.symbol import time
from canon.mechanics.hamilton.legendre_pair import lagrangian
from canon.proof.vanish import equal, vanishes
from canon.scene import SCENES, Condition, Parameter, SceneError, Start, find, names
from canon.scene.equations_of_motion import scene_equations
from canon.scene.known_truths import conserved
from canon.scene.scene_motion import start_state

LONG_PROOFS = {"outer-solar-system", "toda-6"}

PROVED_BY_PAIRS = {("outer-solar-system", "angular momentum, z")}
"""Fifteen distances at once are too many for one proof; tests/scene/test_bodies.py takes them one by one."""

EACH = pytest.mark.parametrize("scene", SCENES, ids=names())


def test_names_are_unique_and_found():
    assert len(set(names())) == len(SCENES)
    for scene in SCENES:
        assert find(scene.name) is scene
        assert find(scene.name.upper().replace("-", " ")) is scene


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.slow) if name in LONG_PROOFS else name for name in names()],
)
def test_every_known_integral_holds_and_its_wrong_twin_fails(name):
    scene = find(name)
    q, p = scene.q[-1], scene.p[-1]
    for integral in scene.integrals:
        if (name, integral.name) in PROVED_BY_PAIRS:
            continue
        twin = replace(integral, build=lambda s, right=integral.build: right(s) + q * p)
        assert conserved(scene, integral).holds
        assert conserved(scene, twin).fails


@EACH
def test_every_start_is_a_finite_state_with_finite_rates(scene):
    values = scene.values_by_symbol()
    for start in scene.starts:
        y = scene.state(start.name)
        assert y.shape == (2 * len(scene.q),)
        known = {**values, **dict(zip((*scene.q, *scene.p), y, strict=True))}
        if not scene.is_free:
            equation = scene_equations(scene)
            at = dict(zip(equation.field.x, start_state(scene, start, equation), strict=True))
            at[equation.field.t] = 0.0
            rates = equation.field.graph.evaluate(equation.field.rates, at)
        else:
            at = {symbol: sp.Float(value) for symbol, value in {**known, time: 0.0}.items()}
            rates = [float(rate.xreplace(at)) for rate in scene.hamiltonian.vector_field]
        assert np.isfinite(np.array(rates, dtype=float)).all()
        if start.v is not None:
            np.testing.assert_allclose(rates[: len(scene.q)], start.v, rtol=1e-12, atol=1e-12)


@EACH
def test_the_time_scale_is_a_time(scene):
    assert 0.0 < scene.period < np.inf


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(scene.name, marks=pytest.mark.slow) if scene.name == "triple-pendulum" else scene.name
        for scene in SCENES
        if scene.L_of and scene.is_free
    ],
)
def test_legendre_there_and_back(name):
    scene = find(name)
    again = lagrangian(scene.hamiltonian)
    assert vanishes(again.L - scene.lagrangian.L).holds


@pytest.mark.parametrize("name", [scene.name for scene in SCENES if scene.L_of and scene.bodies_of])
def test_the_lagrangian_is_that_of_the_bodies(name):
    """The written L against T by the chain rule from where the bodies are and how they are turned."""
    scene = find(name)
    bodies = replace(scene, L_of=None).lagrangian
    assert equal(scene.lagrangian.L, bodies.L).holds
    assert equal(scene.lagrangian.L, bodies.L + scene.q[0].dot ** 2).fails


@EACH
def test_every_parameter_refuses_nonsense(scene):
    """No mass, length or stiffness of the scenes may be negative, none may be infinite or missing."""
    for c in scene.parameters:
        for value in (float("nan"), float("inf")):
            with pytest.raises(SceneError, match="is not a finite number"):
                scene.with_parameters(**{c.name: value})
        if c.sign != "real":
            with pytest.raises(SceneError, match=f"{c.name} = -1 makes no sense"):
                scene.with_parameters(**{c.name: -1.0})
        if np.isfinite(c.most):
            with pytest.raises(SceneError, match="is at most"):
                scene.with_parameters(**{c.name: 2.0 * c.most})


def test_conditions_between_parameters():
    with pytest.raises(SceneError, match="no body is flatter than a disc"):
        find("lagrange-top").with_parameters(C=5e-4)
    with pytest.raises(SceneError, match="below the critical one"):
        find("driven-oscillator").with_parameters(c=4.0)
    with pytest.raises(SceneError, match="m = 1 makes no sense: never"):
        replace(
            find("simple-pendulum"),
            parameters=(Parameter("m", 1.0, "kg", "mass"),),
            conditions=(Condition("never", lambda _: False),),
        )


def test_bound_and_forced_scenes_have_no_hamiltonian():
    for name in ("rolling-disc", "damped-oscillator"):
        with pytest.raises(SceneError, match="no Hamiltonian says how it moves"):
            _ = find(name).hamiltonian


def test_parameters_replace_defaults_and_change_nothing_else():
    pendulum = find("simple-pendulum")
    longer = pendulum.with_parameters(l=4.0)
    assert longer.values == {**pendulum.values, "l": 4.0}
    assert longer.period == pytest.approx(2.0 * pendulum.period)
    assert pendulum.values["l"] == 1.0


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"m": -1.0}, "m = -1 makes no sense: mass of the bob must be positive"),
        ({"l": 0.0}, "length must be positive"),
        ({"g": float("nan")}, "g = nan is not a finite number"),
        ({"lenght": 1.0}, "has no parameter 'lenght'"),
    ],
)
def test_nonsense_parameters_are_refused(values, message):
    with pytest.raises(SceneError, match=message):
        find("simple-pendulum").with_parameters(**values)


def test_unknown_names_come_with_near_ones():
    with pytest.raises(SceneError, match="did you mean henon-heiles"):
        find("henon-heils")
    with pytest.raises(SceneError, match="did you mean chaotic"):
        find("henon-heiles").start("chaotik")
    with pytest.raises(SceneError, match="it has none"):
        find("henon-heiles").with_parameters(m=1.0)


def test_a_start_needs_velocities_or_momenta():
    with pytest.raises(SceneError, match="velocities or momenta, and not both"):
        Start("a", "", q=(0.0,), v=(0.0,), p=(0.0,))
    with pytest.raises(SceneError, match="velocities or momenta, and not both"):
        Start("a", "", q=(0.0,))
    with pytest.raises(SceneError, match="4 finite numbers"):
        Start("a", "", q=(0.0, 1.0), v=(0.0,))
    with pytest.raises(SceneError, match="finite"):
        Parameter("m", float("inf"), "kg", "mass")


def test_looking_up_a_scene_builds_nothing():
    code = (
        "import sys, canon.scene as s; s.find('kepler').values; print(len(s.names()));"
        "assert not {'sympy', 'numpy', 'scipy', 'heyoka'} & set(sys.modules), 'loaded'"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_default_state_is_the_first_start():
    hamiltonian = find("henon-heiles").hamiltonian
    at = dict(zip((*hamiltonian.q, *hamiltonian.p), find("henon-heiles").state(), strict=True))
    assert float(hamiltonian.H.subs(at)) == pytest.approx(1.0 / 12.0, abs=1e-15)
    assert isinstance(hamiltonian.H, sp.Expr)


@pytest.mark.parametrize(
    ("question", "built"),
    [
        (lambda scene: scene.values, set()),
        (lambda scene: scene.lagrangian.equations, {"q", "symbols", "lagrangian"}),
        (lambda scene: scene.hamiltonian.H, {"q", "p", "symbols", "lagrangian", "hamiltonian"}),
        (scene_equations, {"q", "symbols", "lagrangian"}),
    ],
)
def test_a_question_builds_what_it_needs_and_nothing_else(question, built):
    scene = replace(find("spherical-pendulum"))
    question(scene)
    assert set(vars(scene)) - {f.name for f in fields(scene)} == built
    if "hamiltonian" not in built and "lagrangian" in built:
        assert not {"accelerations", "jacobi_energy"} & set(vars(scene.lagrangian))


@pytest.mark.parametrize(
    ("name", "solution"),
    [
        ("sliding-mass-pendulum", "horizontal place: harmonic"),
        ("harmonic-oscillator", "place: 10 cm cos ωt"),
        ("isotropic-oscillator", "x: 10 cm cos ωt"),
        ("kepler", "x by Kepler's equation"),
        ("routh-two-degree", "q2 = A cos ωt"),
        ("unicycle", "y on the circle"),
        ("crossed-fields", "x: cycloid"),
        ("penning-trap", "z: axial oscillation"),
    ],
)
def test_a_solution_comes_back_after_the_time_scale_and_not_before(name, solution):
    scene = find(name)
    (known,) = (each for each in scene.solutions if each.name == solution)
    period = scene.time_scale(scene.values)
    at = np.linspace(0.0, period, 61)
    values = np.asarray(known.value(scene.values, at)) - known.value(scene.values, np.zeros(1))
    assert abs(values[-1]) < 1e-12 * abs(values).max()
    assert (abs(values[1:-1]) > 1e-12 * abs(values).max()).all()
