"""Perturbed celestial mechanics: Lagrange's points, Kepler with a uniform force, a flat planet, spin and orbit."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import cos, sin, sqrt
from canon.scene.parts import Condition
from canon.scene.picture import Picture
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start
from canon.scene.systems.pendulum import quarter_of_swing
from canon.scene.systems.rotating import RESTRICTED

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    from sympy import Expr

    from canon.array import Array

__all__ = ["SCENES", "collinear_point"]

EARTH_MOON = 0.012150585609624
_HEIGHT = math.sqrt(0.75)


def collinear_point(mu: float, number: int) -> float:
    """Return x of the Lagrangian point L1, L2 or L3, where the force along the axis of both masses vanishes.

    Parameters
    ----------
    mu
        Mass of the smaller body, at 1 − µ, as a part of both.
    number
        1 between both, 2 beyond the smaller, 3 beyond the larger body.

    Examples
    --------
    >>> [round(collinear_point(0.012150585609624, number), 9) for number in (1, 2, 3)]
    [0.836915126, 1.155682165, -1.005062646]

    Source: V. Szebehely, Theory of Orbits (1967), section 4.3.
    """
    low, high = {1: (-mu, 1.0 - mu), 2: (1.0 - mu, 2.0 - mu), 3: (-2.0 - mu, -mu)}[number]

    def force(x: float) -> float:
        one, two = x + mu, x - 1.0 + mu
        return x - (1.0 - mu) * one / abs(one) ** 3 - mu * two / abs(two) ** 3

    while True:
        middle = (low + high) / 2.0
        if middle in (low, high):
            return middle
        low, high = (middle, high) if force(middle) < 0.0 else (low, middle)


def _at_rest(name: str, about: str, x: float, y: float) -> Start:
    return Start(name, about, q=(x, y), p=(-y, x), made_for="mu")


def _stays(number: int) -> Solution:
    return Solution(
        f"L{number} is at rest: x",
        f"L{number}",
        lambda s: s.x,
        lambda v, _t: collinear_point(v["mu"], number),
        periods=1.0,
        bound=1e-6,
        source="the root of the force on the axis; a departure grows up to 10⁸ times in a period",
    )


LAGRANGE_POINTS = Scene(
    name="lagrange-points",
    title="The five points of Lagrange in the restricted problem of the Earth and the Moon",
    coordinates="x y",
    parameters=(Parameter("mu", EARTH_MOON, "", "mass of the Moon as a part of both", most=0.5),),
    starts=(
        *(
            _at_rest(f"L{n}", f"in the Lagrangian point L{n}", collinear_point(EARTH_MOON, n), 0.0)
            for n in (1, 2, 3)
        ),
        _at_rest("L4", "in the Lagrangian point L4, 60° ahead of the Moon", 0.5 - EARTH_MOON, _HEIGHT),
        _at_rest("L5", "in the Lagrangian point L5, 60° behind the Moon", 0.5 - EARTH_MOON, -_HEIGHT),
    ),
    time_scale=lambda _value: 2.0 * math.pi,
    time_unit="",
    source="V. Szebehely, Theory of Orbits (1967), ch. 4 and 5; µ of NASA's JPL three-body periodic orbits",
    H_of=RESTRICTED.H_of,
    integrals=RESTRICTED.integrals,
    solutions=(
        *map(_stays, (1, 2, 3)),
        *(
            Solution(
                f"{name} is at rest: y", name, lambda s: s.y, lambda _v, _t, y=y: y, periods=1.0, bound=1e-12
            )
            for name, y in (("L4", _HEIGHT), ("L5", -_HEIGHT))
        ),
    ),
    horizon=1.0,
    shown=1.0,
    picture_of=RESTRICTED.picture_of,
)


def _distance(s: SimpleNamespace) -> Expr:
    return sqrt(s.x**2 + s.y**2 + s.z**2)


def _kinetic(s: SimpleNamespace) -> Expr:
    return (s.x.momentum**2 + s.y.momentum**2 + s.z.momentum**2) / 2


def _around_z(s: SimpleNamespace) -> Expr:
    return s.x * s.y.momentum - s.y * s.x.momentum


def _redmond(s: SimpleNamespace) -> Expr:
    """Return the component of the Runge–Lenz vector along F, with F (x² + y²)/2."""
    x, y, z = s.x, s.y, s.z
    around_x, around_y = y * z.momentum - z * y.momentum, z * x.momentum - x * z.momentum
    along = x.momentum * around_y - y.momentum * around_x - s.k * z / _distance(s)
    return along + s.F * (x**2 + y**2) / 2


_FIELD = 0.02

STARK = Scene(
    name="stark-kepler",
    title="Stark–Kepler: a body drawn to a centre and by a uniform force; it separates in parabolic coordinates",
    coordinates="x y z",
    parameters=(
        Parameter("k", 1.0, "", "strength of the centre"),
        Parameter("F", _FIELD, "", "the force along z", sign="real"),
    ),
    starts=(
        Start("inclined", "an ellipse that the force turns", q=(1.0, 0.0, 0.0), p=(0.0, 0.6, 0.6)),
        Start(
            "circle",
            "a circle about the z axis beside the centre",
            q=(math.sqrt(1.0 - _FIELD**2), 0.0, _FIELD),
            p=(0.0, math.sqrt(1.0 - _FIELD**2), 0.0),
            made_for="k F",
        ),
    ),
    time_scale=lambda value: 2.0 * math.pi / math.sqrt(value["k"]),
    time_unit="",
    source="P. J. Redmond, Phys. Rev. 133, B1352 (1964), doi:10.1103/PhysRev.133.B1352; "
    "Landau & Lifshitz, Mechanics (3rd ed.), § 48 problem 1",
    H_of=lambda s: _kinetic(s) - s.k / _distance(s) - s.F * s.z,
    integrals=(
        Integral("angular momentum about the force", _around_z),
        Integral("Redmond's integral, A_z + F (x² + y²)/2", _redmond),
    ),
    solutions=(
        Solution("the circle is raised by F r³/k: z", "circle", lambda s: s.z, lambda v, _t: v["F"] / v["k"]),
    ),
    horizon=100.0,
    picture_of=lambda s: Picture(masses=((s.x, s.y, s.z),)),
)


def _flat_planet(s: SimpleNamespace) -> Expr:
    r = _distance(s)
    return _kinetic(s) - s.mu / r * (1 - s.J2 * (s.R / r) ** 2 * (3 * s.z**2 / r**2 - 1) / 2)


_MU, _EQUATOR = 398600.4418, 6378.1363
_PLACE, _TILT = 7000.0, math.radians(50.0)
_CIRCULAR = math.sqrt(_MU / _PLACE)


def _tangent_of_node(s: SimpleNamespace) -> Expr:
    x, y, z = s.x, s.y, s.z
    return (y * z.momentum - z * y.momentum) / (x * z.momentum - z * x.momentum)


def _secular_node(value: Mapping[str, float], t: Array) -> Array:
    """Return tan h, dh/dt = −(3/2) J₂ n (R/p)² cos i, with p = a of a circular orbit."""
    import numpy as np

    n = math.sqrt(value["mu"] / _PLACE**3)
    return np.tan(-1.5 * value["J2"] * n * (value["R"] / _PLACE) ** 2 * math.cos(_TILT) * t)


SATELLITE = Scene(
    name="j2-satellite",
    title="Satellite of a flattened planet: its node goes back by 3/2 J2 n (R/p)² cos i",
    coordinates="x y z",
    parameters=(
        Parameter("mu", _MU, "km^3/s^2", "G times the mass of the Earth"),
        Parameter("R", _EQUATOR, "km", "radius at the equator"),
        Parameter("J2", 1.08262668e-3, "", "flattening of the field", sign="real"),
    ),
    starts=(
        Start(
            "circular",
            "at its node on the x axis with the speed of a circle of 7000 km, inclined by 50°",
            q=(_PLACE, 0.0, 0.0),
            p=(0.0, _CIRCULAR * math.cos(_TILT), _CIRCULAR * math.sin(_TILT)),
            made_for="mu",
        ),
        Start(
            "polar",
            "over the poles: the node stays",
            q=(_PLACE, 0.0, 0.0),
            p=(0.0, 0.0, _CIRCULAR),
        ),
    ),
    time_scale=lambda value: 2.0 * math.pi * math.sqrt(_PLACE**3 / value["mu"]),
    time_unit="s",
    source="D. Brouwer, Astron. J. 64, 378 (1959), doi:10.1086/107958; constants of EGM96",
    H_of=_flat_planet,
    integrals=(Integral("angular momentum about the axis", _around_z),),
    solutions=(
        Solution(
            "the tangent of the node after 30 periods, of first order in J2",
            "circular",
            _tangent_of_node,
            _secular_node,
            periods=30.0,
            samples=1,
            bound=0.005,
            source="an average, good to terms of the order J2 beside 1",
        ),
        Solution("over the poles it stays in its plane: y", "polar", lambda s: s.y, lambda _v, _t: 0.0),
    ),
    shown=150.0,
    picture_of=lambda s: Picture(masses=((s.x, s.y, s.z),)),
)


def _strengths(e: Expr | float) -> tuple[Expr | float, Expr | float, Expr | float]:
    """Return H(1/2, e), H(1, e) and H(3/2, e) to the order e⁴: the strengths of the resonances."""
    return -e / 2 + e**3 / 16, 1 - 5 * e**2 / 2 + 13 * e**4 / 16, 7 * e / 2 - 123 * e**3 / 16


def _spin_orbit(s: SimpleNamespace) -> Expr:
    waves = [H * cos(2 * s.theta - number * s.n * s.t) for number, H in enumerate(_strengths(s.e), start=1)]
    return s.theta.momentum**2 / 2 - s.w**2 * s.n**2 * sum(waves) / 4


_SWING, _ECCENTRICITY, _ASPHERICITY = 0.1, 0.2056, 0.0187


def _in_step() -> float:
    """Return θ̇ in units of n that is 3/2 on average, with what the two other resonances add at t = 0."""
    half, one, _ = _strengths(_ECCENTRICITY)
    return 1.5 + float(_ASPHERICITY**2 * math.cos(2.0 * _SWING) * (one + half / 2.0) / 2.0)


def _quarter(value: Mapping[str, float]) -> float:
    """Return the quarter of a libration in the 3:2 resonance: that of a pendulum with (w n)² H(3/2, e)."""
    rate = value["w"] * value["n"] * math.sqrt(float(_strengths(value["e"])[2]))
    return quarter_of_swing(2.0 * _SWING, rate)


SPIN_ORBIT = Scene(
    name="spin-orbit",
    title="Spin and orbit of Mercury, which turns three times in two of its years",
    coordinates="theta",
    angles="theta",
    parameters=(
        Parameter("n", 2.0 * math.pi, "1/yr", "mean motion; the unit of time is a year of the planet"),
        Parameter("e", _ECCENTRICITY, "", "eccentricity", most=0.3),
        Parameter("w", _ASPHERICITY, "", "√(3 (B − A)/C): how far it is from round"),
    ),
    starts=(
        Start(
            "3:2",
            "0.1 rad aside in the 3:2 resonance",
            q=(_SWING,),
            p=(2.0 * math.pi * _in_step(),),
            made_for="n e w",
        ),
        Start(
            "synchronous", "0.1 rad aside in the 1:1 resonance", q=(_SWING,), p=(2.0 * math.pi,), made_for="n"
        ),
    ),
    time_scale=lambda value: 2.0 * math.pi / value["n"],
    time_unit="yr",
    source="P. Goldreich & S. Peale, Astron. J. 71, 425 (1966), doi:10.1086/109947; C. D. Murray & S. F. Dermott, "
    "Solar System Dynamics, section 5.4: H(p, e) to the order e⁴; overlap: J. Wisdom, S. Peale, F. Mignard, "
    "Icarus 58, 137 (1984), doi:10.1016/0019-1035(84)90032-0",
    H_of=_spin_orbit,
    conditions=(
        Condition(
            "the resonances lie apart where w is below 1/(2 + √(14 e))",
            lambda v: v["w"] < 1.0 / (2.0 + math.sqrt(14.0 * v["e"])),
        ),
    ),
    solutions=(
        Solution(
            "first pass of the long axis through perihelion in the 3:2 resonance",
            "3:2",
            lambda s: s.t,
            lambda v, _t: _quarter(v),
            event=lambda s: sin(s.theta - 3 * s.n * s.t / 2),
            bound=0.003,
            periods=60.0,
            source="an average over the other resonances",
        ),
    ),
    horizon=300.0,
    shown=80.0,
)

SCENES = (LAGRANGE_POINTS, STARK, SATELLITE, SPIN_ORBIT)
"""The scenes of perturbed celestial mechanics."""
