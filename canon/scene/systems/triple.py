"""The triple pendulum: three point masses on massless rods in a plane."""

from __future__ import annotations

import math
from itertools import accumulate
from typing import TYPE_CHECKING

from canon.scene.formula_functions import Add, cos
from canon.scene.picture import Picture
from canon.scene.scene import Parameter, Scene, Start
from canon.scene.systems.pendulum import CHAOS, GRAVITY, below

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import SimpleNamespace

    from sympy import Expr

    from canon.expression.symbols.symbol import Coordinate
    from canon.mechanics.lagrange.body import Body

__all__ = ["SCENES"]


def _arms(s: SimpleNamespace) -> list[tuple[Expr, Expr, Coordinate]]:
    """Return mass, length and angle of each arm, from above."""
    return [(s.m1, s.l1, s.theta1), (s.m2, s.l2, s.theta2), (s.m3, s.l3, s.theta3)]


def _places(s: SimpleNamespace) -> list[tuple[Expr, Expr]]:
    steps = [below(length, angle) for _, length, angle in _arms(s)]
    return list(accumulate(steps, lambda a, b: (a[0] + b[0], a[1] + b[1])))


def _bodies(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import Particle

    return [Particle(arm[0], place) for arm, place in zip(_arms(s), _places(s), strict=True)]


def _height(s: SimpleNamespace) -> Expr:
    return Add(*(arm[0] * s.g * place[1] for arm, place in zip(_arms(s), _places(s), strict=True)))


def _triple(s: SimpleNamespace) -> Expr:
    """Return L with Mᵢⱼ = lᵢ lⱼ cos(θᵢ − θⱼ) Σ m of what hangs below both."""
    arms = _arms(s)
    below_both = [Add(*(m for m, _, _ in arms[i:])) for i in range(3)]
    kinetic = [
        below_both[max(i, j)] * a * b * cos(u - w) * u.dot * w.dot / 2
        for i, (_, a, u) in enumerate(arms)
        for j, (_, b, w) in enumerate(arms)
    ]
    heights = [below_both[i] * s.g * length * cos(angle) for i, (_, length, angle) in enumerate(arms)]
    return Add(*kinetic, *heights)


def _picture(s: SimpleNamespace) -> Picture:
    places = tuple(_places(s))
    return Picture(masses=places, bars=(((0.0, 0.0), *places),))


def _upper_swing(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi * math.sqrt(value["l1"] / value["g"])


TRIPLE = Scene(
    name="triple-pendulum",
    title="Triple pendulum: three point masses on massless rods in a plane",
    coordinates="theta1 theta2 theta3",
    angles="theta1 theta2 theta3",
    parameters=(
        Parameter("m1", 0.5, "kg", "upper mass"),
        Parameter("m2", 0.3, "kg", "middle mass"),
        Parameter("m3", 0.2, "kg", "lower mass"),
        Parameter("l1", 0.6, "m", "upper length"),
        Parameter("l2", 0.4, "m", "middle length"),
        Parameter("l3", 0.3, "m", "lower length"),
        GRAVITY,
    ),
    starts=(
        Start("regular", "released at rest at small angles", q=(0.2, 0.25, 0.3), v=(0.0, 0.0, 0.0)),
        Start("chaotic", "released at rest, raised", q=(1.6, 1.8, 2.0), v=(0.0, 0.0, 0.0)),
    ),
    time_scale=_upper_swing,
    time_unit="s",
    source="from the places of the masses",
    L_of=_triple,
    bodies_of=_bodies,
    V_of=_height,
    picture_of=_picture,
    energy_bound=1e-12,
    energy_why=CHAOS,
)

SCENES = (TRIPLE,)
"""The triple pendulum."""
