"""Orbits: a projectile, a planet in polar, cylindrical and spherical coordinates, two masses and a hole in a table."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import Integer, Rational, cos, sin, sqrt
from canon.scene.picture import Picture, Point, ring
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start
from canon.scene.systems.kepler import SUN
from canon.scene.systems.pendulum import GRAVITY

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import SimpleNamespace

    from sympy import Expr

    from canon.array import Array
    from canon.mechanics.lagrange.body import Body

__all__ = ["SCENES"]

_SPEED, _ELEVATION = 30.0, math.radians(40.0)

PROJECTILE = Scene(
    name="projectile",
    title="Projectile without drag, y upwards",
    coordinates="x y",
    parameters=(Parameter("m", 0.15, "kg", "mass"), GRAVITY),
    starts=(
        Start(
            "thrown",
            "30 m/s, 40° upwards",
            q=(0.0, 0.0),
            v=(_SPEED * math.cos(_ELEVATION), _SPEED * math.sin(_ELEVATION)),
        ),
    ),
    time_scale=lambda value: 2.0 * _SPEED * math.sin(_ELEVATION) / value["g"],
    time_unit="s",
    source="Goldstein, Poole & Safko, Classical Mechanics (3rd ed.), § 1.6",
    L_of=lambda s: s.m * (s.x.dot**2 + s.y.dot**2) / 2 - s.m * s.g * s.y,
    integrals=(
        Integral("horizontal momentum", lambda s: s.x.momentum),
        Integral("p_y + m g t", lambda s: s.y.momentum + s.m * s.g * s.t),
    ),
    solutions=(
        Solution(
            "x = v t cos α",
            "thrown",
            lambda s: s.x,
            lambda _v, t: _SPEED * math.cos(_ELEVATION) * t,
            periods=1.0,
        ),
        Solution(
            "y = v t sin α − g t²/2",
            "thrown",
            lambda s: s.y,
            lambda v, t: _SPEED * math.sin(_ELEVATION) * t - v["g"] * t**2 / 2.0,
            periods=1.0,
        ),
        Solution(
            "its greatest height (v sin α)²/(2 g)",
            "thrown",
            lambda s: s.y,
            lambda v, _t: (_SPEED * math.sin(_ELEVATION)) ** 2 / (2.0 * v["g"]),
            event=lambda s: s.y.momentum,
            periods=1.0,
        ),
    ),
    horizon=1.0,
    shown=1.0,
    picture_of=lambda s: Picture(masses=((s.x, s.y),), ground=(((-5.0, 0.0), (95.0, 0.0)),)),
)

_MU = Parameter("mu", SUN, "au³/a²", "gravitational parameter G(M + m)")
_CIRCULAR = math.sqrt(SUN)
_ECCENTRICITY = 0.6
_NEAR = 1.0 - _ECCENTRICITY
_FAST = math.sqrt(SUN * (1.0 + _ECCENTRICITY) / _NEAR)
_TILT = 0.4


def _year(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi / math.sqrt(value["mu"])


def _planet(s: SimpleNamespace, place: Sequence[Expr]) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import Particle

    del s
    return [Particle(Integer(1), place)]


def _polar_place(s: SimpleNamespace) -> tuple[Expr, Expr]:
    return (s.r * cos(s.phi), s.r * sin(s.phi))


def _conic(s: SimpleNamespace) -> Expr:
    """Return r (1 + e cos φ)."""
    return s.r * (1 + Rational(str(_ECCENTRICITY)) * cos(s.phi))


def _focus(dimension: int) -> tuple[tuple[Point, ...], ...]:
    rest = (0.0,) * (dimension - 2)
    return (ring((0.0, 0.0, *rest), (0.03, 0.0, *rest), (0.0, 0.03, *rest)),)


POLAR = Scene(
    name="orbit-polar",
    title="A planet about the Sun in polar coordinates",
    coordinates="r phi",
    angles="phi",
    parameters=(_MU,),
    starts=(
        Start("circular", "on a circle of 1 au", q=(1.0, 0.0), v=(0.0, _CIRCULAR), made_for="mu"),
        Start(
            "e=0.6",
            "perihelion of an ellipse",
            q=(_NEAR, 0.0),
            v=(0.0, _FAST / _NEAR),
            made_for="mu",
        ),
    ),
    time_scale=_year,
    time_unit="a",
    source="Goldstein, Poole & Safko, Classical Mechanics (3rd ed.), § 3.7–3.8",
    L_of=lambda s: (s.r.dot**2 + s.r**2 * s.phi.dot**2) / 2 + s.mu / s.r,
    bodies_of=lambda s: _planet(s, _polar_place(s)),
    V_of=lambda s: -s.mu / s.r,
    integrals=(Integral("angular momentum", lambda s: s.phi.momentum),),
    solutions=(
        Solution("the radius of the circle stays", "circular", lambda s: s.r, lambda _v, _t: 1.0),
        Solution("φ = n t on the circle", "circular", lambda s: s.phi, lambda v, t: math.sqrt(v["mu"]) * t),
        Solution(
            "the orbit: r (1 + e cos φ) = a (1 − e²)",
            "e=0.6",
            _conic,
            lambda _v, _t: 1.0 - _ECCENTRICITY**2,
        ),
    ),
    picture_of=lambda s: Picture(masses=(_polar_place(s),), ground=_focus(2)),
)


def _cylindrical_place(s: SimpleNamespace) -> tuple[Expr, Expr, Expr]:
    return (s.rho * cos(s.phi), s.rho * sin(s.phi), s.z)


def _cylindrical_potential(s: SimpleNamespace) -> Expr:
    return -s.mu / sqrt(s.rho**2 + s.z**2)


CYLINDRICAL = Scene(
    name="orbit-cylindrical",
    title="A planet about the Sun in cylindrical coordinates, its orbit tilted",
    coordinates="rho phi z",
    angles="phi",
    parameters=(_MU,),
    starts=(
        Start(
            "tilted",
            "on a circle of 1 au, tilted by 0.4 rad",
            q=(1.0, 0.0, 0.0),
            v=(0.0, _CIRCULAR * math.cos(_TILT), _CIRCULAR * math.sin(_TILT)),
            made_for="mu",
        ),
    ),
    time_scale=_year,
    time_unit="a",
    source="Kepler's problem in other coordinates",
    L_of=lambda s: (s.rho.dot**2 + s.rho**2 * s.phi.dot**2 + s.z.dot**2) / 2 - _cylindrical_potential(s),
    bodies_of=lambda s: _planet(s, _cylindrical_place(s)),
    V_of=_cylindrical_potential,
    integrals=(
        Integral("angular momentum about z", lambda s: s.phi.momentum),
        Integral(
            "angular momentum squared",
            lambda s: (
                (s.rho * s.z.momentum - s.z * s.rho.momentum) ** 2
                + s.phi.momentum**2 * (1 + s.z**2 / s.rho**2)
            ),
        ),
    ),
    solutions=(
        Solution(
            "z = sin(tilt) sin n t",
            "tilted",
            lambda s: s.z,
            lambda v, t: math.sin(_TILT) * _sine_at(v, t),
        ),
    ),
    picture_of=lambda s: Picture(masses=(_cylindrical_place(s),), ground=_focus(3)),
)


def _sine_at(value: Mapping[str, float], t: Array) -> Array:
    import numpy as np

    return np.sin(math.sqrt(value["mu"]) * t)


def _spherical_place(s: SimpleNamespace) -> tuple[Expr, Expr, Expr]:
    across = s.r * sin(s.theta)
    return (across * cos(s.phi), across * sin(s.phi), s.r * cos(s.theta))


def _spherical(s: SimpleNamespace) -> Expr:
    turning = s.theta.dot**2 + s.phi.dot**2 * sin(s.theta) ** 2
    return (s.r.dot**2 + s.r**2 * turning) / 2 + s.mu / s.r


def _square(s: SimpleNamespace) -> Expr:
    return s.theta.momentum**2 + s.phi.momentum**2 / sin(s.theta) ** 2


SPHERICAL = Scene(
    name="orbit-spherical",
    title="A planet about the Sun in spherical coordinates, its orbit tilted",
    coordinates="r theta phi",
    angles="theta phi",
    parameters=(_MU,),
    starts=(
        Start(
            "tilted",
            "on a circle of 1 au, tilted by 0.4 rad",
            q=(1.0, math.pi / 2.0, 0.0),
            v=(0.0, -_CIRCULAR * math.sin(_TILT), _CIRCULAR * math.cos(_TILT)),
            made_for="mu",
        ),
        Start(
            "ellipse",
            "perihelion of an ellipse with e = 0.6, tilted by 0.4 rad",
            q=(_NEAR, math.pi / 2.0, 0.0),
            v=(0.0, -_FAST / _NEAR * math.sin(_TILT), _FAST / _NEAR * math.cos(_TILT)),
            made_for="mu",
        ),
    ),
    time_scale=_year,
    time_unit="a",
    source="Landau & Lifshitz, Mechanics (3rd ed.), § 48",
    L_of=_spherical,
    bodies_of=lambda s: _planet(s, _spherical_place(s)),
    V_of=lambda s: -s.mu / s.r,
    integrals=(
        Integral("angular momentum about z", lambda s: s.phi.momentum),
        Integral("angular momentum squared", _square),
    ),
    solutions=(
        Solution(
            "z = sin(tilt) sin n t",
            "tilted",
            lambda s: s.r * cos(s.theta),
            lambda v, t: math.sin(_TILT) * _sine_at(v, t),
        ),
    ),
    picture_of=lambda s: Picture(masses=(_spherical_place(s),), ground=_focus(3)),
)


def _table_place(s: SimpleNamespace) -> tuple[Expr, Expr, Expr]:
    return (s.r * cos(s.theta), s.r * sin(s.theta), 0 * s.l)


def _table_bodies(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import Particle

    return [Particle(s.m1, _table_place(s)), Particle(s.m2, (0 * s.l, 0 * s.l, s.r - s.l))]


def _table_picture(s: SimpleNamespace) -> Picture:
    place, hole, hanging = _table_place(s), (0.0, 0.0, 0.0), (0.0, 0.0, s.r - s.l)
    edge = ring(hole, (s.l, 0.0, 0.0), (0.0, s.l, 0.0))
    return Picture(masses=(place, hanging), bars=((place, hole, hanging),), ground=(edge,))


_TABLE = {"m1": 0.2, "m2": 0.3, "g": GRAVITY.value}
_RADIUS = 0.4


def _circling(value: Mapping[str, float]) -> float:
    """Return the rate on the circle that carries the hanging mass, m1 r ω² = m2 g."""
    return math.sqrt(value["m2"] * value["g"] / (value["m1"] * _RADIUS))


HOLE = Scene(
    name="table-hole",
    title="Two masses on a string through a hole in a table: one slides on it, the other hangs",
    coordinates="r theta",
    angles="theta",
    parameters=(
        Parameter("m1", _TABLE["m1"], "kg", "mass on the table"),
        Parameter("m2", _TABLE["m2"], "kg", "mass that hangs"),
        Parameter("l", 1.0, "m", "length of the string"),
        GRAVITY,
    ),
    starts=(
        Start("rosette", "thrown slower than on the circle", q=(_RADIUS, 0.0), v=(0.0, 3.0)),
        Start(
            "circle",
            "on the circle that carries the other mass",
            q=(_RADIUS, 0.0),
            v=(0.0, _circling(_TABLE)),
            made_for="m1 m2 g",
        ),
    ),
    time_scale=lambda value: 2.0 * math.pi / _circling(value),
    time_unit="s",
    source="a central force of constant size; both bodies by their places",
    L_of=lambda s: (
        (s.m1 + s.m2) * s.r.dot**2 / 2 + s.m1 * s.r**2 * s.theta.dot**2 / 2 - s.m2 * s.g * (s.r - s.l)
    ),
    bodies_of=_table_bodies,
    V_of=lambda s: s.m2 * s.g * (s.r - s.l),
    integrals=(Integral("angular momentum", lambda s: s.theta.momentum),),
    solutions=(
        Solution("the circle stays", "circle", lambda s: s.r, lambda _v, _t: _RADIUS),
        Solution("rate on the circle", "circle", lambda s: s.theta, lambda v, t: _circling(v) * t),
    ),
    picture_of=_table_picture,
)

SCENES = (PROJECTILE, POLAR, CYLINDRICAL, SPHERICAL, HOLE)
"""The orbits."""
