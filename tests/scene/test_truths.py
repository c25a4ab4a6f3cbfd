"""Each scene's equations against an independent route: positions of the masses, closed forms, Newton's law."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
import sympy as sp
from sympy import cos, sin

from canon.expression.symbols.symbol import time, time_derivative
from canon.proof.vanish import equal, vanishes
from canon.scene import SCENES, find
from canon.scene.known_truths import solutions_met
from canon.scene.parts import SceneError

if TYPE_CHECKING:
    from canon.scene.parts import Parameter
    from canon.scene.scene import Scene


def particle(mass, position, coordinates):
    """Kinetic energy of a point mass from its position, by the chain rule."""
    return mass * sum(time_derivative(x, coordinates) ** 2 for x in position) / 2


def rod(mass, end, other, coordinates):
    """Kinetic energy of a uniform rod, integrated over its length."""
    s = sp.Symbol("s", real=True)
    velocity = [time_derivative(a + s * (b - a), coordinates) for a, b in zip(end, other, strict=True)]
    return mass * sp.integrate(sp.expand(sum(v**2 for v in velocity)), (s, 0, 1)) / 2


def double_arms(scene):
    s = scene.symbols
    middle = (s.l1 * sin(s.theta1), -s.l1 * cos(s.theta1))
    end = (middle[0] + s.l2 * sin(s.theta2), middle[1] - s.l2 * cos(s.theta2))
    return s, middle, end


def simple():
    scene = find("simple-pendulum")
    s = scene.symbols
    place = (s.l * sin(s.theta), -s.l * cos(s.theta))
    return scene, particle(s.m, place, scene.q) - s.m * s.g * place[1]


def sliding():
    scene = find("sliding-mass-pendulum")
    s = scene.symbols
    place = (s.r * sin(s.theta), -s.r * cos(s.theta))
    spring = s.k * (place[0] ** 2 + place[1] ** 2) / 2
    return scene, particle(s.m, place, scene.q) - s.m * s.g * place[1] - spring


def spherical():
    scene = find("spherical-pendulum")
    s = scene.symbols
    place = (s.l * sin(s.theta) * cos(s.phi), s.l * sin(s.theta) * sin(s.phi), -s.l * cos(s.theta))
    return scene, particle(s.m, place, scene.q) - s.m * s.g * place[2]


def double():
    scene = find("double-pendulum")
    s, middle, end = double_arms(scene)
    kinetic = particle(s.m1, middle, scene.q) + particle(s.m2, end, scene.q)
    return scene, kinetic - s.m1 * s.g * middle[1] - s.m2 * s.g * end[1]


def rods():
    scene = find("double-pendulum-rods")
    s, middle, end = double_arms(scene)
    kinetic = rod(s.m1, (sp.S.Zero, sp.S.Zero), middle, scene.q) + rod(s.m2, middle, end, scene.q)
    return scene, kinetic - s.m1 * s.g * middle[1] / 2 - s.m2 * s.g * (middle[1] + end[1]) / 2


@pytest.mark.parametrize("route", [simple, sliding, spherical, double, rods])
def test_the_lagrangian_is_that_of_the_masses_where_they_are(route):
    scene, L = route()
    assert equal(scene.lagrangian.L, L).holds
    assert equal(scene.lagrangian.L, L + scene.symbols.g * scene.q[0].dot ** 2).fails


def test_point_masses_and_rods_are_different_pendulums():
    assert vanishes(find("double-pendulum").lagrangian.L - find("double-pendulum-rods").lagrangian.L).fails


def test_the_double_pendulum_as_printed():
    """Equal masses and lengths: 2 θ̈ + φ̈ cos(θ−φ) + φ̇² sin(θ−φ) + 2 (g/l) sin θ = 0, and its partner."""
    scene = find("double-pendulum")
    s = scene.symbols
    a, b = s.theta1, s.theta2
    alike = {s.m2: s.m1, s.l2: s.l1}
    first, second = (e.xreplace(alike) / (s.m1 * s.l1**2) for e in scene.lagrangian.equations)
    assert vanishes(
        first - (2 * a.ddot + b.ddot * cos(a - b) + b.dot**2 * sin(a - b) + 2 * s.g / s.l1 * sin(a))
    ).holds
    assert vanishes(
        second - (b.ddot + a.ddot * cos(a - b) - a.dot**2 * sin(a - b) + s.g / s.l1 * sin(b))
    ).holds


def test_kepler_obeys_newton():
    scene = find("kepler")
    s = scene.symbols
    r = sp.sqrt(s.x**2 + s.y**2)
    for q, force in zip(scene.q, scene.hamiltonian.p_dot, strict=True):
        assert equal(force, -s.mu * q / r**3).holds
    for start in scene.starts:
        x, y, p_x, p_y = scene.state(start.name)
        energy = (p_x**2 + p_y**2) / 2 - scene.values["mu"] / math.hypot(x, y)
        assert -scene.values["mu"] / (2.0 * energy) == pytest.approx(1.0, rel=1e-14)
        vector = scene.constants()["Runge–Lenz vector, x"].subs(
            {**scene.values_by_symbol(), **dict(zip((*scene.q, *scene.p), (x, y, p_x, p_y), strict=True))}
        )
        assert start.name == f"e={float(vector):.6g}"


def test_kepler_lasts_a_year():
    """One au, one solar mass: the Gaussian year of 365.2568983 days, in Julian years."""
    assert find("kepler").period == pytest.approx(365.2568983 / 365.25, rel=1e-9)


def test_the_routh_system_moves_as_its_closed_form():
    scene = find("routh-two-degree")
    s = scene.symbols
    t, A, B, P = sp.symbols("t A B P", real=True)
    rate = sp.sqrt(2 * s.d + s.b * P**2)
    q2 = A * cos(rate * t + B)
    phase = rate * t + B
    q1 = P * s.a * t + s.b * P * A**2 * (t / 2 + sin(2 * phase) / (4 * rate))
    motion = {s.q1: q1, s.q1.momentum: P, s.q2: q2, s.q2.momentum: q2.diff(t)}
    assert scene.hamiltonian.is_solution(motion).holds
    assert scene.hamiltonian.is_solution({**motion, s.q1: P * s.a * t}).fails


def test_henon_heiles_forces():
    scene = find("henon-heiles")
    x, y = scene.q
    assert scene.hamiltonian.p_dot[0].equals(-x - 2 * x * y)
    assert scene.hamiltonian.p_dot[1].equals(-y - x**2 + y**2)
    saddle = {x: 0, y: 1, **dict.fromkeys(scene.p, 0)}
    assert scene.hamiltonian.H.subs(saddle) == sp.Rational(1, 6)


def test_the_hyperbolic_system_moves_as_its_closed_form():
    scene = find("hyperbolic")
    s = scene.symbols
    t, A, B, C, D = sp.symbols("t A B C D", real=True)
    q1, q2 = A * sp.exp(t), B * sp.exp(-t)
    motion = {
        s.q1: q1,
        s.q2: q2,
        s.q1.momentum: C * sp.exp(-t) + s.a * A * sp.exp(t),
        s.q2.momentum: D * sp.exp(t) + s.b * B * sp.exp(-t),
    }
    assert scene.hamiltonian.is_solution(motion).holds


@pytest.mark.parametrize("name", ["harmonic-oscillator", "isotropic-oscillator"])
def test_oscillators_swing_with_their_period(name):
    scene = find(name)
    t = sp.Symbol("t", real=True)
    rate = sp.sqrt(scene.symbols.k / scene.symbols.m)
    motion = {}
    for index, q in enumerate(scene.q):
        motion[q] = cos(rate * t + index)
        motion[q.momentum] = scene.symbols.m * motion[q].diff(t)
    assert scene.hamiltonian.is_solution(motion).holds
    assert float((2 * sp.pi / rate).subs(scene.values_by_symbol())) == pytest.approx(scene.period)


def test_the_conical_pendulum_stays_on_its_cone():
    scene = find("spherical-pendulum")
    y = scene.state("conical")
    at = {**scene.values_by_symbol(), **dict(zip((*scene.q, *scene.p), y, strict=True))}
    rates = np.array([float(rate.subs(at)) for rate in scene.hamiltonian.vector_field])
    assert abs(rates[0]) < 1e-14
    assert abs(rates[2]) < 1e-14


@pytest.mark.parametrize("name", ["piston-engine", "piston-engine-first-order", "piston-engine-joints"])
@pytest.mark.parametrize(
    "changed", [{"M": 2.0}, {"M": -1.5}, {"m3": 0.5, "J1": 1e-3}, {"P": 300.0, "M": 1.0}]
)
def test_the_crank_has_the_known_speed_whatever_acts_on_it(name, changed):
    scene = find(name)
    known = {c.name for c in scene.parameters}
    given = {key: value for key, value in changed.items() if key in known}
    met = list(solutions_met(scene.with_parameters(**given)))
    assert met
    assert all(each.passed for each in met), str(met)
    idle = scene.solutions[0].value(scene.values, np.zeros(1))
    assert scene.solutions[0].value(scene.values | given, np.zeros(1)) != pytest.approx(idle, rel=1e-4)


def test_the_first_order_engine_is_the_whole_one_of_a_short_crank() -> None:
    """Their I(θ) agree up to r², where the piston's line has no offset."""
    s = find("piston-engine").symbols
    whole, first = find("piston-engine").L_of(s).subs(s.e, 0), find("piston-engine-first-order").L_of(s)
    for order in range(3):
        assert equal(*(sp.diff(L, s.r, order).subs(s.r, 0) for L in (whole, first))).holds


@pytest.mark.parametrize("speed", [100.0, 30.0])
def test_a_turn_of_the_engine_is_its_time_scale(speed: float) -> None:
    scene = find("piston-engine-constant-speed").with_parameters(w=speed)
    (kept,) = scene.holonomic_of(scene.symbols)
    (angle,) = sp.solve(kept.subs(scene.symbols.w, speed), scene.symbols.theta)
    assert float(angle.subs(time, scene.period)) == pytest.approx(2 * math.pi, rel=1e-14)


def test_what_is_not_known_at_these_values_is_not_asked():
    stalled = find("piston-engine").with_parameters(M=1e4)
    assert not list(solutions_met(stalled))
    assert not list(solutions_met(find("piston-engine-joints").with_parameters(r=0.03)))
    assert len(list(solutions_met(find("piston-engine").with_parameters(r=0.03)))) == 1


def with_another(scene: Scene, c: Parameter) -> Scene:
    """Return a scene with another value of a parameter, as far as its conditions allow."""
    try:
        return scene.with_parameters(**{c.name: 1.07 * c.value or 0.4})
    except SceneError:
        return scene.with_parameters(**{c.name: 0.93 * c.value})


QUICK = {"kepler", "bead-hoop", "simple-pendulum", "spherical-pendulum", "table-hole"}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(scene.name, marks=[] if scene.name in QUICK else [pytest.mark.slow])
        for scene in SCENES
        if scene.solutions
    ],
)
def test_what_is_known_of_a_scene_is_known_at_other_values_or_not_claimed(name):
    """Every parameter in turn, a little larger, or smaller where no body is so; one that is 0 becomes 0.4."""
    scene = find(name)
    for c in scene.parameters:
        for met in solutions_met(with_another(scene, c)):
            assert met.passed, f"{c.name}: {met}"
    assert scene.with_parameters(**scene.values).solutions == scene.solutions
