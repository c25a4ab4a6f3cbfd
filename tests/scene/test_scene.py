"""What every scene keeps, and what the door refuses."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
import sympy as sp

from canon.proof.vanish import vanishes
from canon.scene import SCENES, Parameter, SceneError, Start, find, names

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
    [
        pytest.param(name, marks=pytest.mark.slow) if name == "outer-solar-system" else name
        for name in names()
    ],
)
def test_every_known_integral_holds_and_its_wrong_twin_fails(name):
    scene = find(name)
    hamiltonian = scene.hamiltonian
    q, p = scene.q[-1], scene.p[-1]
    for title, constant in scene.constants().items():
        if (name, title) in PROVED_BY_PAIRS:
            continue
        assert vanishes(hamiltonian.rate(constant)).holds
        assert vanishes(hamiltonian.rate(constant + q * p)).fails


@EACH
def test_every_start_is_a_finite_state_with_finite_rates(scene):
    values = scene.values_by_symbol()
    for start in scene.starts:
        y = scene.state(start.name)
        assert y.shape == (2 * len(scene.q),)
        known = {**values, **dict(zip((*scene.q, *scene.p), y, strict=True))}
        at = {symbol: sp.Float(value) for symbol, value in known.items()}
        rates = [float(rate.xreplace(at)) for rate in scene.hamiltonian.vector_field]
        assert np.isfinite(rates).all()
        if start.v is not None:
            np.testing.assert_allclose(rates[: len(scene.q)], start.v, rtol=1e-12, atol=1e-12)


@EACH
def test_the_time_scale_is_a_time(scene):
    assert 0.0 < scene.period < np.inf


@pytest.mark.parametrize("name", [scene.name for scene in SCENES if scene.L_of])
def test_legendre_there_and_back(name):
    scene = find(name)
    again = scene.hamiltonian.lagrangian()
    assert vanishes(again.L - scene.lagrangian.L).holds


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
