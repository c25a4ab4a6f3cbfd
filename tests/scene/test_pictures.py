"""Pictures of scenes: what is rigid keeps its shape wherever it moves, and what has weight hangs where it should."""

import itertools

import numpy as np
import pytest
import sympy as sp

from canon.expression.symbols.symbol import velocity
from canon.scene import SCENES, find
from canon.scene.picture import ring

DRAWN = [scene for scene in SCENES if scene.picture_of is not None and scene.picture_of(scene.symbols).bars]
STRETCHED = (
    "fput",
    "swinging-atwood",
    "table-hole",
    "pendulum-multiplier",
    "piston-engine-joints",
    "block-in-pipe",
)
"""Scenes with strings that grow longer, or with more coordinates than places."""


def lengths(scene, seeds):
    """Return the lengths of all bars between one joint and the next, at states drawn by seeds."""
    given = {parameter.name: float(parameter.value) for parameter in scene.parameters}
    bars = [[list(point) for point in bar[:8]] for bar in scene.picture_of(scene.symbols).bars]
    used = {s for bar in bars for point in bar for c in point for s in sp.sympify(c).free_symbols}
    symbols = sorted(used, key=str)
    placed = sp.lambdify(symbols, bars, "math")
    for seed in seeds:
        draw = np.random.default_rng(seed)
        joints = placed(*(given.get(s.name, draw.uniform(0.1, 1.0)) for s in symbols))
        yield np.concatenate([np.linalg.norm(np.diff(bar, axis=0), axis=1) for bar in joints])


@pytest.mark.parametrize("scene", DRAWN, ids=lambda scene: scene.name)
def test_bars_keep_their_lengths(scene):
    """In three states each bar is as long, unless it is a string that stretches."""
    first, *others = lengths(scene, range(3))
    alike = [np.allclose(other, first, rtol=1e-9, atol=1e-12) for other in others]
    assert alike == [scene.name not in STRETCHED] * 2


@pytest.mark.parametrize(("name", "times"), [("lagrange-top", 2), ("kovalevskaya-top", 1)])
def test_a_weight_is_drawn_as_high_as_its_energy_says(name, times):
    """V = m g z of the centre of mass, which lies at l from the fixed point; Lagrange's top is drawn to 2 l."""
    scene = find(name)
    s = scene.symbols
    (mass,) = scene.picture_of(s).masses
    assert sp.simplify(scene.V_of(s) - s.m * s.g * mass[-1] / times) == 0
    assert sp.simplify(sum(c**2 for c in mass) - (times * s.l) ** 2) == 0


def test_a_link_is_drawn_twice_as_far_as_its_centre_of_mass() -> None:
    """From joint to joint of the manipulator, whose first link has c₁ = L₁/2 and whose second is drawn with 2 c₂."""
    scene = find("two-link-manipulator")
    s = scene.symbols
    ((shoulder, elbow, hand),) = scene.picture_of(s).bars
    for body, ends in zip(scene.bodies_of(s), ((shoulder, elbow), (elbow, hand)), strict=True):
        middle = [(a + b) / 2 for a, b in zip(*ends, strict=True)]
        apart = [(m - r).subs(s.c1, s.L1 / 2) for m, r in zip(middle, body.r, strict=True)]
        assert [sp.simplify(each) for each in apart] == [0, 0]


EXTENDED = (
    "lagrange-top",
    "kovalevskaya-top",
    "chaplygin-sleigh",
    "rolling-disc",
    "unicycle",
    "roller",
    "roller-second-kind",
    "hollow-cylinder",
    "hollow-cylinder-second-kind",
    "inertia-wheel-pendulum",
    "cart-pendulum",
    "motor-shaft",
    "rack-and-pinion",
)
"""Scenes whose one dot is not all that has mass."""


def points_of_mass():
    drawn = (scene for scene in SCENES if scene.picture_of is not None and scene.L_of is not None)
    return [scene for scene in drawn if len(scene.picture_of(scene.symbols).masses) == 1]


@pytest.mark.parametrize("scene", points_of_mass(), ids=lambda scene: scene.name)
def test_a_point_of_mass_has_the_kinetic_energy_of_its_way_in_the_picture(scene):
    """T = m ṙ²/2, by the velocities that the picture says, at a state drawn by a seed."""
    s = scene.symbols
    q = [getattr(s, name) for name in scene.coordinates.split()]
    way = sp.Matrix(scene.picture_of(s).masses[0]).jacobian(q)
    masses = sp.hessian(sp.sympify(scene.L_of(s)), [velocity(each) for each in q])
    apart = masses - getattr(s, "m", sp.S.One) * way.T * way
    draw = np.random.default_rng(1)
    values = {
        each: draw.uniform(0.1, 1.0) for each in sorted(apart.free_symbols | masses.free_symbols, key=str)
    }
    size = max(abs(f) for f in masses.subs(values))
    alike = bool(max(abs(f) for f in apart.subs(values)) < 1e-9 * size)
    assert alike == (scene.name not in EXTENDED)


SPRINGS = {"toda": 3, "toda-6": 6, "block-in-pipe": 1, "driven-oscillator": 1, "damped-oscillator": 1}
SPRINGS |= {f"{name}-oscillator": 1 for name in ("harmonic", "isotropic", "duffing")}
SPRINGS |= {"sliding-mass-pendulum": 1, "spring-pendulum": 1}


@pytest.mark.parametrize(
    "scene", [scene for scene in SCENES if scene.picture_of is not None], ids=lambda scene: scene.name
)
def test_springs_hold_masses_and_the_ground_rests(scene):
    """Each end of a spring is a mass or at rest, no ground moves, and lines go on from one point to another."""
    s = scene.symbols
    picture = scene.picture_of(s)
    q = {getattr(s, name) for name in scene.coordinates.split()}

    def rests(point):
        return not any(sp.sympify(c).free_symbols & q for c in point)

    assert len(set(picture.springs)) == SPRINGS.get(scene.name, 0)
    for one, other in picture.springs:
        assert one != other
        assert all(rests(end) or end in picture.masses for end in (one, other))
    assert all(rests(point) for line in picture.ground for point in line)
    lines = (*picture.ground, *picture.bars)
    assert all(one != other for line in lines for one, other in itertools.pairwise(line))


def test_a_ring_is_closed_and_round():
    points = np.array(ring((1.0, 2.0), (3.0, 0.0), (0.0, 3.0)), dtype=float)
    assert points.shape == (37, 2)
    np.testing.assert_allclose(points[0], points[-1], atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(points - [1.0, 2.0], axis=1), 3.0)
