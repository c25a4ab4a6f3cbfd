"""Pendulums: simple, sliding mass, spherical, double with point masses and with rods.

Angles are counted from the downward vertical; the potential energy is zero at the height of the pivot.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from canon.scene.formula_functions import cos, sin
from canon.scene.picture import Picture, ring
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    from sympy import Expr

    from canon.array import Array

__all__ = ["SCENES", "quarter_of_swing"]

GRAVITY = Parameter("g", 9.80665, "m/s²", "standard acceleration of free fall")


def _small_swing(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi * math.sqrt(value["l"] / value["g"])


def below(length: Expr, angle: Expr) -> tuple[Expr, Expr]:
    """Return the point at this distance from the origin and angle from the downward vertical."""
    return (length * sin(angle), -length * cos(angle))


def swing(amplitude: float, value: Mapping[str, float], t: Array) -> Array:
    """Return θ(t) of a pendulum let go at rest: sin(θ/2) = k cd(√(g/l) t, k), k = sin(θ₀/2)."""
    import numpy as np
    from scipy.special import ellipj

    k = math.sin(amplitude / 2.0)
    _, cn, dn, _ = ellipj(math.sqrt(value["g"] / value["l"]) * t, k * k)
    return 2.0 * np.arcsin(k * cn / dn)


def quarter_of_swing(amplitude: float, rate: float) -> float:
    """Return the quarter of a pendulum's period, K(sin²(θ₀/2))/ω; ω is its rate at small swings."""
    from scipy.special import ellipk

    return float(ellipk(math.sin(amplitude / 2.0) ** 2)) / rate


def _simple_picture(s: SimpleNamespace) -> Picture:
    bob = below(s.l, s.theta)
    return Picture(masses=(bob,), bars=(((0.0, 0.0), bob),))


def _simple(s: SimpleNamespace) -> Expr:
    return s.m * s.l**2 * s.theta.dot**2 / 2 + s.m * s.g * s.l * cos(s.theta)


CHAOS = "chaotic and fast: round-off of many more steps than a regular motion takes"

SIMPLE = Scene(
    name="simple-pendulum",
    title="Simple pendulum: a point mass on a massless rod in a plane",
    coordinates="theta",
    angles="theta",
    parameters=(Parameter("m", 1.0, "kg", "mass of the bob"), Parameter("l", 1.0, "m", "length"), GRAVITY),
    starts=(
        Start("wide", "released at rest at 2 rad", q=(2.0,), v=(0.0,)),
        Start("small", "released at rest at 0.1 rad", q=(0.1,), v=(0.0,)),
        Start("rotating", "going over the top", q=(0.0,), v=(7.0,)),
    ),
    time_scale=_small_swing,
    time_unit="s",
    source="Landau & Lifshitz, Mechanics (3rd ed.), § 11 problem 1",
    L_of=_simple,
    picture_of=_simple_picture,
    solutions=(
        Solution(
            "angle by Jacobi's elliptic functions", "wide", lambda s: s.theta, lambda v, t: swing(2.0, v, t)
        ),
        Solution(
            "quarter of the period, √(l/g) K(sin θ₀/2)",
            "wide",
            lambda s: s.t,
            lambda v, _t: quarter_of_swing(2.0, math.sqrt(v["g"] / v["l"])),
            event=lambda s: s.theta,
            bound=1e-14,
        ),
    ),
)


def _sliding(s: SimpleNamespace) -> Expr:
    kinetic = s.m * (s.r.dot**2 + s.r**2 * s.theta.dot**2) / 2
    return kinetic + s.m * s.g * s.r * cos(s.theta) - s.k * s.r**2 / 2


def _elastic(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi * math.sqrt(value["m"] / value["k"])


def _horizontal_place(value: Mapping[str, float], t: Array) -> Array:
    import numpy as np

    return 0.4 * math.sin(0.8) * np.cos(math.sqrt(value["k"] / value["m"]) * t)


def _sprung_picture(s: SimpleNamespace) -> Picture:
    bob = below(s.r, s.theta)
    return Picture(masses=(bob,), springs=(((0.0, 0.0), bob),))


SLIDING_MASS = Scene(
    name="sliding-mass-pendulum",
    title="Pendulum with a sliding mass: a bead on a swinging rod, held by a spring of zero natural length",
    coordinates="r theta",
    parameters=(
        Parameter("m", 0.5, "kg", "mass of the bead"),
        Parameter("k", 20.0, "N/m", "stiffness of the spring"),
        GRAVITY,
    ),
    starts=(
        Start("swinging", "drawn aside and released", q=(0.4, 0.8), v=(0.0, 0.0)),
        Start("hanging", "pulled down and released", q=(0.35, 0.0), v=(0.0, 0.0)),
    ),
    time_scale=_elastic,
    time_unit="s",
    source="a spring of zero natural length makes x and y independent oscillators: closed form",
    L_of=_sliding,
    picture_of=_sprung_picture,
    solutions=(
        Solution(
            "horizontal place: harmonic",
            "swinging",
            lambda s: s.r * sin(s.theta),
            _horizontal_place,
            bound=1e-11,
        ),
    ),
    integrals=(Integral("energy of the horizontal oscillator", lambda s: _horizontal(s)),),
)


def _horizontal(s: SimpleNamespace) -> Expr:
    """Return p_x²/2m + k x²/2 with x = r sin θ, p_x = p_r sin θ + p_θ cos θ / r."""
    p_x = s.r.momentum * sin(s.theta) + s.theta.momentum * cos(s.theta) / s.r
    return p_x**2 / (2 * s.m) + s.k * (s.r * sin(s.theta)) ** 2 / 2


def _spring(s: SimpleNamespace) -> Expr:
    kinetic = s.m * (s.r.dot**2 + s.r**2 * s.theta.dot**2) / 2
    return kinetic + s.m * s.g * s.r * cos(s.theta) - s.k * (s.r - s.l) ** 2 / 2


SPRING = Scene(
    name="spring-pendulum",
    title="Spring pendulum: a bob on a swinging spring, tuned so that bouncing and swinging feed one another",
    coordinates="r theta",
    parameters=(
        Parameter("m", 0.5, "kg", "mass of the bob"),
        Parameter("k", 20.0, "N/m", "stiffness of the spring"),
        Parameter("l", 0.735, "m", "natural length of the spring"),
        GRAVITY,
    ),
    starts=(
        Start("bouncing", "pulled down, hardly aside", q=(1.08, 0.02), v=(0.0, 0.0)),
        Start("swinging", "drawn aside and released", q=(0.95, 0.7), v=(0.0, 0.0)),
    ),
    time_scale=_elastic,
    time_unit="s",
    source="Vitt & Gorelik, Zh. Tekh. Fiz. 3, 294 (1933): resonance two to one, k l = 3 m g",
    L_of=_spring,
    picture_of=_sprung_picture,
)


def _spherical(s: SimpleNamespace) -> Expr:
    kinetic = s.m * s.l**2 * (s.theta.dot**2 + s.phi.dot**2 * sin(s.theta) ** 2) / 2
    return kinetic + s.m * s.g * s.l * cos(s.theta)


def _spherical_picture(s: SimpleNamespace) -> Picture:
    bob = (s.l * sin(s.theta) * cos(s.phi), s.l * sin(s.theta) * sin(s.phi), -s.l * cos(s.theta))
    equator = ring((0.0, 0.0, 0.0), (s.l, 0.0, 0.0), (0.0, s.l, 0.0))
    return Picture(masses=(bob,), bars=(((0.0, 0.0, 0.0), bob),), ground=(equator,))


SPHERICAL = Scene(
    name="spherical-pendulum",
    title="Spherical pendulum: a point mass on a massless rod in space",
    coordinates="theta phi",
    angles="theta phi",
    parameters=(Parameter("m", 1.0, "kg", "mass of the bob"), Parameter("l", 1.0, "m", "length"), GRAVITY),
    starts=(
        Start("precessing", "thrown sideways from 1 rad", q=(1.0, 0.0), v=(0.0, 2.0)),
        Start(
            "conical",
            "circling at 1 rad",
            q=(1.0, 0.0),
            v=(0.0, math.sqrt(GRAVITY.value / math.cos(1.0))),
            made_for="l g",
        ),
    ),
    time_scale=_small_swing,
    time_unit="s",
    source="Landau & Lifshitz, Mechanics (3rd ed.), § 14 problem 1",
    L_of=_spherical,
    picture_of=_spherical_picture,
    solutions=(
        Solution("angle of the cone stays", "conical", lambda s: s.theta, lambda _v, _t: 1.0, periods=1.0),
        Solution(
            "rate of the cone, √(g/(l cos θ))",
            "conical",
            lambda s: s.phi,
            lambda v, t: t * math.sqrt(v["g"] / (v["l"] * math.cos(1.0))),
        ),
    ),
    integrals=(Integral("angular momentum about the vertical", lambda s: s.phi.momentum),),
)


def _double(s: SimpleNamespace) -> Expr:
    a, b = s.theta1, s.theta2
    kinetic = (
        (s.m1 + s.m2) * s.l1**2 * a.dot**2 / 2
        + s.m2 * s.l2**2 * b.dot**2 / 2
        + s.m2 * s.l1 * s.l2 * a.dot * b.dot * cos(a - b)
    )
    return kinetic + (s.m1 + s.m2) * s.g * s.l1 * cos(a) + s.m2 * s.g * s.l2 * cos(b)


def _rods(s: SimpleNamespace) -> Expr:
    a, b = s.theta1, s.theta2
    kinetic = (
        (s.m1 / 3 + s.m2) * s.l1**2 * a.dot**2 / 2
        + s.m2 * s.l2**2 * b.dot**2 / 6
        + s.m2 * s.l1 * s.l2 * a.dot * b.dot * cos(a - b) / 2
    )
    return kinetic + (s.m1 / 2 + s.m2) * s.g * s.l1 * cos(a) + s.m2 * s.g * s.l2 * cos(b) / 2


def _double_picture(s: SimpleNamespace) -> Picture:
    middle = below(s.l1, s.theta1)
    end = tuple(a + b for a, b in zip(middle, below(s.l2, s.theta2), strict=True))
    return Picture(masses=(middle, end), bars=(((0.0, 0.0), middle, end),))


def _upper_swing(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi * math.sqrt(value["l1"] / value["g"])


DOUBLE = Scene(
    name="double-pendulum",
    title="Double pendulum: two point masses on massless rods in a plane",
    coordinates="theta1 theta2",
    angles="theta1 theta2",
    parameters=(
        Parameter("m1", 1.0, "kg", "upper mass"),
        Parameter("m2", 0.5, "kg", "lower mass"),
        Parameter("l1", 1.0, "m", "upper length"),
        Parameter("l2", 0.8, "m", "lower length"),
        GRAVITY,
    ),
    starts=(
        Start("regular", "released at rest at small angles", q=(0.3, 0.4), v=(0.0, 0.0)),
        Start("chaotic", "released at rest with both arms raised", q=(2.0, 2.5), v=(0.0, 0.0)),
    ),
    time_scale=_upper_swing,
    time_unit="s",
    source="Landau & Lifshitz, Mechanics (3rd ed.), § 5 problem 1",
    L_of=_double,
    picture_of=_double_picture,
    energy_bound=1e-12,
    energy_why=CHAOS,
)

DOUBLE_RODS = replace(
    DOUBLE,
    name="double-pendulum-rods",
    title="Double pendulum of two uniform rods in a plane",
    source="kinetic energy of each rod by König's theorem, central inertia m l²/12",
    L_of=_rods,
)

SCENES = (SIMPLE, SLIDING_MASS, SPRING, SPHERICAL, DOUBLE, DOUBLE_RODS)
"""The pendulums."""
