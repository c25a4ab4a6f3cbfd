"""Constrained motion in numbers: against the symbolic multipliers, and on the constraints for a long time."""

import numpy as np
import pytest
import sympy as sp

from canon.expression.symbols.symbol import coordinates, parameters, time
from canon.mechanics.at_scale.constrained import constrained, constrained_motion
from canon.mechanics.at_scale.second_order import derivation
from canon.mechanics.lagrange.body import Particle, PlanarBody
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.dependence import DependentConstraintsError
from canon.mechanics.lagrange.force import gravity, lagrangian_of_bodies

m, M, l, g, a, J, w = parameters("m M l g a J w", positive=True)
x, y, u, v, theta = coordinates("x y u v theta")


def double_pendulum():
    bodies = [Particle(m, (x, y)), Particle(M, (u, v))]
    rods = [x**2 + y**2 - l**2, (u - x) ** 2 + (v - y) ** 2 - a**2]
    return bodies, (x, y, u, v), rods, []


def sleigh():
    body = PlanarBody(m, (x + a * sp.cos(theta), y + a * sp.sin(theta)), J, theta)
    return [body], (x, y, theta), [], [x.dot * sp.sin(theta) - y.dot * sp.cos(theta)]


def driven_bead():
    return [Particle(m, (x, y))], (x, y), [x * sp.sin(w * time) - y * sp.cos(w * time)], []


SYSTEMS = [double_pendulum, sleigh, driven_bead]


def motion_of(system, **rates):
    bodies, q, holonomic, nonholonomic = system()
    equations = constrained(derivation(bodies, q, field=(0, -g)), holonomic, nonholonomic)
    values = dict(zip(equations.parameters, np.linspace(0.7, 1.3, len(equations.parameters)), strict=True))
    return equations, values, constrained_motion(equations, values, **rates)


@pytest.mark.parametrize("system", SYSTEMS)
def test_agrees_with_symbolic_multipliers(system):
    bodies, q, holonomic, nonholonomic = system()
    _, values, motion = motion_of(system)
    L = lagrangian_of_bodies(bodies, q, gravity(bodies, (0, -g)))
    symbolic = ConstrainedLagrangian(L, holonomic, nonholonomic)
    chance = np.random.default_rng(4)
    place, speed = chance.uniform(0.3, 1, len(q)), chance.uniform(-1, 1, len(q))
    at = {**values, time: 0.4, **dict(zip(q, place, strict=True))}
    at |= dict(zip(L.velocities, speed, strict=True))
    here = {s: sp.Float(number, 30) for s, number in at.items()}
    found, multipliers = motion.accelerations(place, speed, 0.4)
    assert np.allclose(found, [float(e.xreplace(here)) for e in symbolic.accelerations], rtol=1e-9)
    expected = [float(e.xreplace(here)) for e in symbolic.multipliers]
    assert np.allclose(multipliers, expected, rtol=1e-9)
    assert not np.allclose(multipliers, -np.array(expected), rtol=1e-2)


@pytest.mark.parametrize("system", SYSTEMS)
def test_projection_lands_on_the_constraints(system):
    _, q, _, _ = system()
    _, values, motion = motion_of(system)
    near = {
        double_pendulum: [0.0, -values.get(l, 0), 0.1, -values.get(l, 0) - values.get(a, 0)],
        sleigh: [0.3, 0.2, 0.7],
        driven_bead: [np.cos(0.4 * values.get(w, 0)), np.sin(0.4 * values.get(w, 0))],
    }[system]
    chance = np.random.default_rng(8)
    place, speed = near + chance.uniform(0.01, 0.05, len(q)), chance.uniform(-1, 1, len(q))
    before = np.concatenate(motion.residual(place, speed, 0.4))
    assert np.abs(before).max() > 1e-3
    after = np.concatenate(motion.residual(*motion.projected(place, speed, 0.4), 0.4))
    assert np.abs(after).max() < 3e-15
    again = motion.projected(*motion.projected(place, speed, 0.4), 0.4)
    assert np.allclose(again, motion.projected(place, speed, 0.4), rtol=0, atol=1e-14)


def test_projection_from_afar_says_so():
    _, _, motion = motion_of(double_pendulum)
    with pytest.raises(ArithmeticError, match="start nearer"):
        motion.projected([0.6, 0.8, 0.9, 0.7], [0.0] * 4, 0.0)


def run(motion, place, speed, h, steps, project):
    """RK4; the largest constraint and its rate over all steps."""
    worst = 0.0
    for step in range(steps):
        t = step * h
        k1, _ = motion.accelerations(place, speed, t)
        k2, _ = motion.accelerations(place + h / 2 * speed, speed + h / 2 * k1, t + h / 2)
        k3, _ = motion.accelerations(place + h / 2 * speed + h**2 / 4 * k1, speed + h / 2 * k2, t + h / 2)
        k4, _ = motion.accelerations(place + h * speed + h**2 / 2 * k2, speed + h * k3, t + h)
        place = place + h * speed + h**2 / 6 * (k1 + k2 + k3)
        speed = speed + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        if project:
            place, speed = motion.projected(place, speed, t + h)
        worst = max(worst, *(np.abs(r).max() for r in motion.residual(place, speed, t + h)))
    return worst


def pendulum(**rates):
    equations = constrained(derivation([Particle(m, (x, y))], (x, y), field=(0, -g)), [x**2 + y**2 - l**2])
    return constrained_motion(equations, {m: 1.0, l: 1.0, g: 1.0}, **rates)


def test_projection_keeps_the_constraint_at_round_off():
    start = np.array([0.8, -0.6]), np.array([0.3, 0.4])
    steps, h = 2000, 0.05
    assert run(pendulum(), *start, h, steps, project=True) < 2e-15
    drifted = run(pendulum(), *start, h, steps, project=False)
    assert drifted > 1e-5
    assert run(pendulum(alpha=5.0, beta=5.0), *start, h, steps, project=False) < drifted / 10


@pytest.mark.slow
@pytest.mark.parametrize("speed", np.linspace(0.1, 2.8, 10).round(1))
def test_projection_for_many_steps_from_ten_starts(speed):
    """Each step is projected on its own, so that many short runs say what one long one does."""
    start = np.array([0.8, -0.6]), speed * np.array([0.6, 0.8])
    assert run(pendulum(), *start, 0.05, 20_000, project=True) < 4e-15


@pytest.mark.parametrize(
    ("holonomic", "nonholonomic", "rows"),
    [
        ([x**2 + y**2 - l**2, x - 1, 3 * (x**2 + y**2)], [], (1, 3)),
        ([x - y, x + y, x * y - 1], [], (1, 2, 3)),
        ([x - y], [x.dot - y.dot], (1, 2)),
        ([l - 1 + 0 * x], [y.dot], (1,)),
    ],
)
def test_dependent_rows_are_named(holonomic, nonholonomic, rows):
    with pytest.raises(DependentConstraintsError, match="leave one of them out") as caught:
        constrained(derivation([Particle(m, (x, y))], (x, y)), holonomic, nonholonomic)
    assert caught.value.rows == rows


def test_independent_rows_are_taken():
    space = derivation([Particle(m, (x, y))], (x, y))
    assert len(constrained(space, [x**2 + y**2 - l**2, x - y]).A) == 2
    assert len(constrained(space, [sp.log(x - 5) - y], [x.dot - 2 * y.dot]).A) == 2


@pytest.mark.parametrize(
    ("holonomic", "nonholonomic", "words"),
    [([x.dot], [], "holds velocities"), ([], [x.dot**2], "not affine")],
)
def test_refusals(holonomic, nonholonomic, words):
    with pytest.raises(ValueError, match=words):
        constrained(derivation([Particle(m, (x, y))], (x, y)), holonomic, nonholonomic)
    free = constrained(derivation([Particle(m, (x, y))], (x, y)), [x - y])
    with pytest.raises(KeyError, match="no number for m"):
        constrained_motion(free, {})


def test_a_curve_that_begins_beyond_the_points_looked_at():
    """On y = √(x − 5): ẍ = −y′ (g + y″ ẋ²)/(1 + y′²), and the curve pushes with −m ẍ/y′ along its normal (−y′, 1)."""
    curve = constrained(derivation([Particle(m, (x, y))], (x, y), field=(0, -g)), [y - sp.sqrt(x - 5)])
    a, push = constrained_motion(curve, {m: 2, g: 10}).accelerations([9.0, 2.0], [4.0, 1.0], 0.0)
    slope, bend = 1 / 4, -1 / 32
    along = -slope * (10 + bend * 16) / (1 + slope**2)
    assert a == pytest.approx([along, slope * along + bend * 16])
    assert push == pytest.approx([-2 * along / slope])
