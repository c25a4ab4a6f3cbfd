"""Bodies and chains: data against what is known of the orbits, integrals along a run, forces pair by pair."""

from __future__ import annotations

import math

import numpy as np
import pytest
import sympy as sp

from canon import Splitting, propagate
from canon.proof.vanish import vanishes
from canon.scene import find


def test_angular_momentum_of_the_solar_system_pair_by_pair():
    """The rate of change is a sum over pairs of bodies; each pair's part vanishes, and none is left over."""
    scene = find("outer-solar-system")
    masses = [getattr(scene.symbols, f"m{i}") for i in range(6)]
    rate = scene.hamiltonian.rate(scene.constants()["angular momentum, z"])
    pairs = []
    for j in range(6):
        for i in range(j):
            others = {m: sp.S.Zero for k, m in enumerate(masses) if k not in (i, j)}
            pairs.append(rate.xreplace(others))
            assert pairs[-1] != 0
            assert vanishes(pairs[-1]).holds
    assert sp.expand(rate - sp.Add(*pairs)) == 0


def test_the_planets_are_where_planets_are():
    """Semi-major axes (au) and eccentricities from places and velocities, against the mean elements of the planets."""
    scene = find("outer-solar-system")
    y = scene.state()
    places, momenta = y[:18].reshape(6, 3), y[18:].reshape(6, 3)
    sun = momenta[0] / scene.values["m0"]
    known = {1: (5.20, 0.048), 2: (9.56, 0.055), 3: (19.2, 0.047), 4: (30.1, 0.009), 5: (39.5, 0.249)}
    for body, (axis, eccentricity) in known.items():
        mass = scene.values[f"m{body}"]
        mu = scene.values["G"] * (scene.values["m0"] + mass)
        r, v = places[body] - places[0], momenta[body] / mass - sun
        energy = v @ v / 2.0 - mu / np.linalg.norm(r)
        vector = np.cross(v, np.cross(r, v)) / mu - r / np.linalg.norm(r)
        assert -mu / (2.0 * energy) == pytest.approx(axis, rel=0.02)
        assert np.linalg.norm(vector) == pytest.approx(eccentricity, abs=0.015)
    assert scene.period / 365.25 == pytest.approx(11.86, rel=0.01)


def test_the_centre_of_mass_of_the_solar_system_rests_at_the_origin():
    scene = find("outer-solar-system")
    places, momenta = scene.state().reshape(2, 6, 3)
    masses = np.array([scene.values[f"m{i}"] for i in range(6)])
    jupiter = masses[1] * np.linalg.norm(places[1])
    assert np.linalg.norm(masses @ places) < 1e-15 * jupiter
    assert np.linalg.norm(momenta.sum(axis=0)) < 1e-15 * np.linalg.norm(momenta[1])
    assert np.linalg.norm(masses[1:] @ places[1:]) > 0.5 * jupiter


def test_newtons_force_on_jupiter():
    scene = find("outer-solar-system")
    y = scene.state()
    at = {**scene.values_by_symbol(), **dict(zip((*scene.q, *scene.p), y, strict=True))}
    numbers = {symbol: sp.Float(value) for symbol, value in at.items()}
    places = y[:18].reshape(6, 3)
    masses = np.array([scene.values[f"m{i}"] for i in range(6)])
    away = places - places[1]
    others = [0, 2, 3, 4, 5]
    force = sum(
        scene.values["G"] * masses[1] * masses[k] * away[k] / np.linalg.norm(away[k]) ** 3 for k in others
    )
    found = [float(scene.hamiltonian.p_dot[3 + axis].xreplace(numbers)) for axis in range(3)]
    np.testing.assert_allclose(found, force, rtol=1e-12)


def test_the_figure_eight_closes_after_its_period():
    """After a third of the period each mass stands where another one was."""
    scene = find("figure-eight")
    motion = propagate(
        scene.hamiltonian,
        (0.0, scene.period),
        scene.state(),
        method=Splitting("kahan-li-8"),
        step=scene.period / 6000.0,
        samples=3,
    )
    start, third, _, end = (motion.q[:, i].reshape(3, 2) for i in range(4))
    np.testing.assert_allclose(end, start, atol=1e-5)
    distances = [min(np.linalg.norm(place - other) for other in start) for place in third]
    assert max(distances) < 1e-5
    assert np.linalg.norm(third - start) > 1.0


@pytest.mark.parametrize("name", ["toda", "figure-eight"])
def test_integrals_stay_along_a_run(name):
    scene = find(name)
    constants = scene.constants()
    motion = propagate(
        scene.hamiltonian,
        (0.0, 200.0 * scene.period),
        scene.state(),
        method=Splitting("kahan-li-8"),
        step=scene.period / 400.0,
        observables=constants,
    )
    for change in motion.changes.values():
        assert np.abs(change).max() < 1e-11
    twin = propagate(
        scene.hamiltonian,
        (0.0, 20.0 * scene.period),
        scene.state(),
        method=Splitting("kahan-li-8"),
        step=scene.period / 400.0,
        observables={"twin": scene.p[0] ** 3},
    )
    assert np.abs(twin.changes["twin"]).max() > 1e-2


def test_toda_energies_are_as_described():
    scene = find("toda")
    for name, energy in (("moderate", 1.3), ("wild", 7.0)):
        y = scene.state(name)
        q, p = y[:3], y[3:]
        found = p @ p / 2.0 + np.exp(q - np.roll(q, -1)).sum() - 3.0
        assert found == pytest.approx(energy, rel=0.1)


def test_toda_near_rest_swings_with_its_period():
    """Small motions are those of a ring of unit springs, both modes of angular frequency √3."""
    q = find("toda").q
    hessian = sp.hessian(find("toda").hamiltonian.H, q).subs(dict.fromkeys(q, 0))
    assert sorted(hessian.eigenvals(multiple=True)) == [0, 3, 3]
    assert find("toda").period == pytest.approx(2.0 * math.pi / math.sqrt(3.0))


def test_the_linear_chain_swings_in_its_lowest_mode():
    scene = find("fput").with_parameters(alpha=0.0)
    y = scene.state()
    half = propagate(
        scene.hamiltonian,
        (0.0, scene.period / 2.0),
        y,
        method=Splitting("kahan-li-8"),
        step=0.1,
        parameters=scene.values,
        samples=1,
    )
    np.testing.assert_allclose(half.final[:31], -y[:31], atol=1e-10)


def test_the_chain_gives_energy_to_its_second_mode():
    """Fig. 1 of the report of 1955: the second mode reaches more than a third of the energy, then gives it back."""
    scene = find("fput")
    motion = propagate(
        scene.hamiltonian,
        (0.0, 170.0 * scene.period),
        scene.state(),
        method=Splitting("blanes-moan-4"),
        step=0.2,
        parameters=scene.values,
        samples=400,
    )
    i = np.arange(1, 32)
    energies = []
    for mode in (1, 2):
        shape = math.sqrt(2.0 / 32.0) * np.sin(math.pi * mode * i / 32.0)
        rate = 2.0 * math.sin(math.pi * mode / 64.0)
        energies.append(((shape @ motion.p) ** 2 + rate**2 * (shape @ motion.q) ** 2) / 2.0)
    first, second = energies
    assert second.max() > first[0] / 3.0
    assert first.min() < 0.2 * first[0]
    late = motion.t > 130.0 * scene.period
    assert first[late].max() > 0.9 * first[0]


def test_the_spring_pendulum_is_in_resonance():
    value = find("spring-pendulum").values
    assert value["k"] * value["l"] == pytest.approx(3.0 * value["m"] * value["g"], rel=2e-3)
