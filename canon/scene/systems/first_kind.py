"""Systems with Lagrange's equations of the first kind: reactions as multipliers, and where a reaction vanishes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import cos, sin
from canon.scene.parts import multiplier
from canon.scene.picture import Picture, ring
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start
from canon.scene.systems.pendulum import GRAVITY, swing

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    from sympy import Expr

    from canon.array import Array

__all__ = ["SCENES"]

_WIDE = 2.0


def _small_swing(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi * math.sqrt(value["l"] / value["g"])


def _tension(value: Mapping[str, float], t: Array) -> Array:
    """Return λ = −S/(2 l) with the tension S = m g (3 cos θ − 2 cos θ₀)."""
    import numpy as np

    angle = swing(_WIDE, value, t)
    pull = value["m"] * value["g"] * (3.0 * np.cos(angle) - 2.0 * math.cos(_WIDE))
    return -pull / (2.0 * value["l"])


def _sine(value: Mapping[str, float], t: Array) -> Array:
    import numpy as np

    return value["l"] * np.sin(swing(_WIDE, value, t))


PENDULUM = Scene(
    name="pendulum-multiplier",
    title="Simple pendulum in Cartesian coordinates, y downwards: its tension is a multiplier",
    coordinates="x y",
    parameters=(Parameter("m", 1.0, "kg", "mass of the bob"), Parameter("l", 1.0, "m", "length"), GRAVITY),
    starts=(
        Start(
            "wide",
            "released at rest at 2 rad",
            q=(math.sin(_WIDE), math.cos(_WIDE)),
            v=(0.0, 0.0),
        ),
    ),
    time_scale=_small_swing,
    time_unit="s",
    source="Lagrange's equations of the first kind; closed form as for the simple pendulum",
    L_of=lambda s: s.m * (s.x.dot**2 + s.y.dot**2) / 2 + s.m * s.g * s.y,
    holonomic_of=lambda s: [s.x**2 + s.y**2 - s.l**2],
    integrals=(
        Integral("energy m v²/2 − m g y", lambda s: s.m * (s.x.dot**2 + s.y.dot**2) / 2 - s.m * s.g * s.y),
    ),
    solutions=(
        Solution("x = l sin θ by Jacobi's elliptic functions", "wide", lambda s: s.x, _sine),
        Solution(
            "multiplier: the tension m g (3 cos θ − 2 cos θ₀)", "wide", lambda _s: multiplier(), _tension
        ),
    ),
    picture_of=lambda s: Picture(masses=((s.x, -s.y),), bars=(((0.0, 0.0), (s.x, -s.y)),)),
)


def _hemisphere(s: SimpleNamespace) -> Expr:
    return s.m * (s.r.dot**2 + s.r**2 * s.theta.dot**2) / 2 - s.m * s.g * s.r * cos(s.theta)


def _hemisphere_picture(s: SimpleNamespace) -> Picture:
    return Picture(
        masses=((s.r * sin(s.theta), s.r * cos(s.theta)),), ground=(ring((0.0, 0.0), (s.a, 0.0), (0.0, s.a)),)
    )


_TOP_RATE, _ASIDE = 1e-3, 0.5


def _leaving_from_the_top(value: Mapping[str, float], _t: Array) -> float:
    """Return cos θ = 2/3 + a θ̇₀²/(3 g)."""
    return 2.0 / 3.0 + value["a"] * _TOP_RATE**2 / (3.0 * value["g"])


HEMISPHERE = Scene(
    name="hemisphere",
    title="A particle slides off a smooth sphere: it leaves where cos θ = 2/3",
    coordinates="r theta",
    parameters=(
        Parameter("m", 0.1, "kg", "mass"),
        Parameter("a", 0.5, "m", "radius of the sphere"),
        GRAVITY,
    ),
    starts=(
        Start("aside", "let go at rest, 0.5 rad from the top", q=(0.5, _ASIDE), v=(0.0, 0.0)),
        Start("top", "hardly pushed at the top", q=(0.5, 0.0), v=(0.0, _TOP_RATE)),
    ),
    time_scale=lambda value: 2.0 * math.pi * math.sqrt(value["a"] / value["g"]),
    time_unit="s",
    source="Goldstein, Poole & Safko, Classical Mechanics (3rd ed.), § 2.4",
    L_of=_hemisphere,
    holonomic_of=lambda s: [s.r - s.a],
    integrals=(
        Integral(
            "energy m v²/2 + m g r cos θ",
            lambda s: s.m * (s.r.dot**2 + s.r**2 * s.theta.dot**2) / 2 + s.m * s.g * s.r * cos(s.theta),
        ),
    ),
    solutions=(
        Solution(
            "it leaves from rest at θ₀ where cos θ = (2/3) cos θ₀",
            "aside",
            lambda s: cos(s.theta),
            lambda _v, _t: 2.0 / 3.0 * math.cos(_ASIDE),
            event=lambda _s: multiplier(),
            bound=1e-13,
        ),
        Solution(
            "it leaves from the top where cos θ = 2/3 + a θ̇₀²/(3 g)",
            "top",
            lambda s: cos(s.theta),
            _leaving_from_the_top,
            event=lambda _s: multiplier(),
            bound=1e-13,
        ),
    ),
    horizon=0.2,
    shown=0.2,
    picture_of=_hemisphere_picture,
)

SCENES = (PENDULUM, HEMISPHERE)
"""The scenes with reactions."""
