"""Scenes that can't be, told with what to do instead, and parts of scenes that few have."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from canon.proof.vanish import equal
from canon.scene import SceneError, Start, find
from canon.scene.describe import description
from canon.scene.equations_of_motion import scene_equations
from canon.scene.known_truths import solutions_met
from canon.scene.parts import Solution
from canon.scene.scene_motion import run
from canon.scene.systems.henon_heiles import on_the_section
from canon.scene.systems.kepler import perihelion
from canon.scene.systems.lattice import toda

PENDULUM = find("simple-pendulum")


def test_forces_without_potential_are_shown():
    damped = replace(PENDULUM, forces_of=lambda s: [-s.theta.dot / 10])
    shown = {section.title: section for section in description(damped)}
    assert [str(each) for each in shown["Forces without potential"].formulas] == ["Q_theta = -theta_dot/10"]
    assert "Hamiltonian" not in shown
    assert "Forces without potential" not in {section.title for section in description(PENDULUM)}


def test_a_scene_of_a_hamiltonian_alone_has_a_lagrangian_too():
    kepler = find("kepler")
    x, y = kepler.q
    wanted = (x.dot**2 + y.dot**2) / 2 + kepler.symbols.mu / sp.sqrt(x**2 + y**2)
    assert equal(kepler.lagrangian.L, wanted).holds
    assert equal(kepler.lagrangian.L, wanted - 2 * kepler.symbols.mu / sp.sqrt(x**2 + y**2)).fails


def test_a_lagrangian_that_is_not_quadratic_in_the_velocities_needs_its_hamiltonian():
    quartic = replace(
        PENDULUM, L_of=lambda s: PENDULUM.L_of(s) + s.theta.dot**4, forces_of=lambda s: [-s.theta.dot]
    )
    with pytest.raises(
        SceneError, match="not quadratic in the velocities; give the scene its Hamiltonian by H_of"
    ):
        scene_equations(quartic)
    assert scene_equations(replace(PENDULUM, forces_of=lambda s: [-s.theta.dot])) is not None


def test_a_start_on_constraints_needs_velocities():
    scene = find("pendulum-multiplier")
    assert scene.is_constrained
    start = scene.starts[0]
    moving = Start("moved", "by momenta", start.q, p=tuple(0.0 for _ in start.q))
    with pytest.raises(
        SceneError, match="the start 'moved' of pendulum-multiplier has constraints: give it velocities"
    ):
        run(replace(scene, starts=(moving,)), "moved", 0.1)
    assert run(scene, start.name, 0.1).t[-1] > 0.0


@pytest.mark.parametrize(("value", "met"), [(math.nan, None), (math.inf, None), (0.0, False)])
def test_a_known_motion_has_finite_values(value, met):
    start = PENDULUM.starts[0].name
    known = Solution("the angle", start, lambda s: s.theta, lambda _, t: np.full_like(t, value))
    scene = replace(PENDULUM, solutions=(known,))
    if met is None:
        with pytest.raises(
            SceneError, match="simple-pendulum: the angle is not finite with these parameters"
        ):
            list(solutions_met(scene))
    else:
        assert [check.passed for check in solutions_met(scene)] == [met]


@pytest.mark.parametrize("eccentricity", [-0.1, 1.0, 1.5, math.nan])
def test_an_ellipse_has_an_eccentricity_below_one(eccentricity):
    with pytest.raises(ValueError, match="an ellipse has an eccentricity from 0 to below 1, not"):
        perihelion(eccentricity)
    start = perihelion(0.5, mu=1.0)
    assert start.p[1] ** 2 / 2 - 1 / start.q[0] == pytest.approx(-0.5)


def test_a_start_on_a_section_has_the_energy_for_it():
    with pytest.raises(
        ValueError, match=r"y = 0.9, p_y = 0.1 lie outside the section of energy 0.08.*larger energy"
    ):
        on_the_section("far", "", 1 / 12, y=0.9, p_y=0.1)
    start = on_the_section("near", "", 1 / 12, y=0.1, p_y=0.1)
    energy = (start.p[0] ** 2 + start.p[1] ** 2 + start.q[1] ** 2) / 2 - start.q[1] ** 3 / 3
    assert energy == pytest.approx(1 / 12)


@pytest.mark.parametrize("masses", [0, 2])
def test_two_masses_make_no_ring(masses):
    with pytest.raises(SceneError, match=f"three masses at least make a ring, not {masses}"):
        toda(masses, ())
    assert len(toda(3, ()).q) == 3
