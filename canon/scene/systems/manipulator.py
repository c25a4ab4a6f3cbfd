"""A manipulator with two links in a vertical plane, a motor at each joint."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import cos
from canon.scene.picture import Picture
from canon.scene.scene import Integral, Parameter, Scene, Start
from canon.scene.systems.pendulum import CHAOS, GRAVITY, below

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import SimpleNamespace

    from sympy import Expr

    from canon.mechanics.lagrange.body import Body

__all__ = ["SCENES"]


def _bodies(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import PlanarBody

    elbow, middle = below(s.L1, s.q1), below(s.c2, s.q1 + s.q2)
    second = (elbow[0] + middle[0], elbow[1] + middle[1])
    return [PlanarBody(s.m1, below(s.c1, s.q1), s.I1, s.q1), PlanarBody(s.m2, second, s.I2, s.q1 + s.q2)]


def _kinetic(s: SimpleNamespace) -> Expr:
    both = s.q1.dot + s.q2.dot
    first = (s.m1 * s.c1**2 + s.I1 + s.m2 * s.L1**2) * s.q1.dot**2
    second = (s.m2 * s.c2**2 + s.I2) * both**2
    return (first + second) / 2 + s.m2 * s.L1 * s.c2 * cos(s.q2) * s.q1.dot * both


def _height(s: SimpleNamespace) -> Expr:
    shoulder = (s.m1 * s.c1 + s.m2 * s.L1) * s.g * cos(s.q1)
    return -shoulder - s.m2 * s.g * s.c2 * cos(s.q1 + s.q2)


def _picture(s: SimpleNamespace) -> Picture:
    elbow, reach = below(s.L1, s.q1), below(2 * s.c2, s.q1 + s.q2)
    hand = (elbow[0] + reach[0], elbow[1] + reach[1])
    return Picture(masses=(elbow, hand), bars=(((0.0, 0.0), elbow, hand),))


def _swing(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi * math.sqrt(value["L1"] / value["g"])


MANIPULATOR = Scene(
    name="two-link-manipulator",
    title="Manipulator with two links: q1 from the downward vertical, q2 from the first link, a motor at each joint",
    coordinates="q1 q2",
    angles="q1 q2",
    parameters=(
        Parameter("m1", 4.0, "kg", "mass of the first link"),
        Parameter("m2", 2.5, "kg", "mass of the second link"),
        Parameter("L1", 0.5, "m", "length of the first link"),
        Parameter("c1", 0.25, "m", "from the shoulder to the first centre of mass"),
        Parameter("c2", 0.2, "m", "from the elbow to the second centre of mass"),
        Parameter("I1", 0.09, "kg m²", "central moment of inertia of the first link"),
        Parameter("I2", 0.035, "kg m²", "central moment of inertia of the second link"),
        Parameter("M1", 8.0, "N m", "torque of the shoulder's motor", sign="real"),
        Parameter("M2", 3.0, "N m", "torque of the elbow's motor", sign="real"),
        GRAVITY,
    ),
    starts=(
        Start("lifting", "hanging at rest, both motors on", q=(0.0, 0.0), v=(0.0, 0.0)),
        Start("folded", "let go folded", q=(0.8, 1.5), v=(0.0, 0.0)),
    ),
    time_scale=_swing,
    time_unit="s",
    source="Spong, Hutchinson & Vidyasagar, Robot Modeling and Control, ch. 7: two-link planar manipulator",
    L_of=lambda s: _kinetic(s) - _height(s),
    bodies_of=_bodies,
    V_of=_height,
    forces_of=lambda s: [s.M1, s.M2],
    integrals=(
        Integral(
            "energy less the work M1 q1 + M2 q2",
            lambda s: _kinetic(s) + _height(s) - s.M1 * s.q1 - s.M2 * s.q2,
            1e-12,
            CHAOS,
        ),
    ),
    picture_of=_picture,
    horizon=10.0,
    shown=3.0,
    energy_bound=1e-12,
    energy_why=CHAOS,
)

SCENES = (MANIPULATOR,)
"""The manipulator."""
