"""Bodies that attract one another by Newton's law: the figure eight and the outer solar system."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import Add, Integer, sqrt
from canon.scene.parts import Condition
from canon.scene.picture import Picture
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import SimpleNamespace

    from sympy import Expr, Symbol

    from canon.expression.symbols.symbol import Coordinate

__all__ = ["SCENES"]

Place = tuple["Coordinate", ...]


def _places(s: SimpleNamespace, count: int, axes: str) -> list[Place]:
    """Return the coordinates of the bodies, each a tuple along the axes."""
    return [tuple(getattr(s, f"{axis}{body}") for axis in axes) for body in range(count)]


def _momenta(places: Sequence[Place]) -> list[tuple[Symbol, ...]]:
    return [tuple(x.momentum for x in place) for place in places]


def _newtonian(places: Sequence[Place], masses: Sequence[Expr], G: Expr) -> Expr:
    """Return H = Σ p²/2m − Σ G mᵢ mⱼ/rᵢⱼ."""
    kinetic = [x.momentum**2 / (2 * m) for place, m in zip(places, masses, strict=True) for x in place]
    potential = [
        -G
        * masses[i]
        * masses[j]
        / sqrt(Add(*((a - b) ** 2 for a, b in zip(places[i], places[j], strict=True))))
        for j in range(len(places))
        for i in range(j)
    ]
    return Add(*kinetic, *potential)


def _total_momentum(places: Sequence[Place], axis: int) -> Expr:
    return Add(*(p[axis] for p in _momenta(places)))


def _angular_momentum_z(places: Sequence[Place]) -> Expr:
    both = zip(places, _momenta(places), strict=True)
    return Add(*(place[0] * p[1] - place[1] * p[0] for place, p in both))


def _eight_places(s: SimpleNamespace) -> list[Place]:
    return _places(s, 3, "xy")


def _eight_hamiltonian(s: SimpleNamespace) -> Expr:
    return _newtonian(_eight_places(s), [Integer(1)] * 3, Integer(1))


def _eight_period(_value: Mapping[str, float]) -> float:
    return 6.32591398


_AT = (0.97000436, -0.24308753)
_MIDDLE_SPEED = (-0.93240737, -0.86473146)

FIGURE_EIGHT = Scene(
    name="figure-eight",
    title="Three equal masses that chase one another along a figure eight",
    coordinates="x0 y0 x1 y1 x2 y2",
    parameters=(),
    starts=(
        Start(
            "eight",
            "one mass midway between the others, masses and G one",
            q=(*_AT, -_AT[0], -_AT[1], 0.0, 0.0),
            p=(*(-v / 2.0 for v in _MIDDLE_SPEED), *(-v / 2.0 for v in _MIDDLE_SPEED), *_MIDDLE_SPEED),
        ),
    ),
    time_scale=_eight_period,
    shown=1.0,
    picture_of=lambda s: Picture(masses=tuple(_eight_places(s))),
    solutions=(
        Solution(
            "after its period the first mass is back: x",
            "eight",
            lambda s: s.x0,
            lambda _v, _t: _AT[0],
            periods=1.0,
            samples=1,
            bound=1e-7,
            source="published to 8 digits",
        ),
        Solution(
            "after a third of its period it is where the third was: x",
            "eight",
            lambda s: s.x0,
            lambda _v, _t: 0.0,
            periods=1.0 / 3.0,
            samples=1,
            bound=1e-7,
            source="published to 8 digits",
        ),
    ),
    time_unit="",
    source="Chenciner & Montgomery, Ann. Math. 152, 881 (2000), doi:10.2307/2661357; initial data by Simó",
    H_of=_eight_hamiltonian,
    integrals=(
        Integral("total momentum, x", lambda s: _total_momentum(_eight_places(s), 0)),
        Integral("total momentum, y", lambda s: _total_momentum(_eight_places(s), 1)),
        Integral("angular momentum", lambda s: _angular_momentum_z(_eight_places(s))),
    ),
)

_PLANETS = (
    ("Sun with the inner planets", 1.00000597682, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    (
        "Jupiter",
        0.000954786104043,
        (-3.5023653, -3.8169847, -1.5507963),
        (0.00565429, -0.00412490, -0.00190589),
    ),
    ("Saturn", 0.000285583733151, (9.0755314, -3.0458353, -1.6483708), (0.00168318, 0.00483525, 0.00192462)),
    (
        "Uranus",
        0.0000437273164546,
        (8.3101420, -16.2901086, -7.2521278),
        (0.00354178, 0.00137102, 0.00055029),
    ),
    (
        "Neptune",
        0.0000517759138449,
        (11.4707666, -25.7294829, -10.8169456),
        (0.00288930, 0.00114527, 0.00039677),
    ),
    (
        "Pluto",
        1.0 / 1.3e8,
        (-15.5387357, -25.2225594, -3.1902382),
        (0.00276725, -0.00170702, -0.00136504),
    ),
)
"""Mass (Suns), place (au) and velocity (au/d) on 5 September 1994, 0h, relative to the Sun."""


def _planet_places(s: SimpleNamespace) -> list[Place]:
    return _places(s, len(_PLANETS), "xyz")


def _planets_hamiltonian(s: SimpleNamespace) -> Expr:
    masses = [getattr(s, f"m{body}") for body in range(len(_PLANETS))]
    return _newtonian(_planet_places(s), masses, s.G)


def _orbit_of_jupiter(value: Mapping[str, float]) -> float:
    """Return the period of the ellipse that Jupiter's place and velocity at the start belong to."""
    mu = value["G"] * (value["m0"] + value["m1"])
    return 2.0 * math.pi * math.sqrt((-mu / (2.0 * _energy_of_jupiter(value))) ** 3 / mu)


def _energy_of_jupiter(value: Mapping[str, float]) -> float:
    """Return the energy of Jupiter about the Sun, for its reduced mass: below 0 on an ellipse."""
    _, _, place, velocity = _PLANETS[1]
    mu = value["G"] * (value["m0"] + value["m1"])
    return math.hypot(*velocity) ** 2 / 2.0 - mu / math.hypot(*place)


def _planets_start() -> Start:
    """Return places and momenta of all bodies; their centre of mass rests at the origin, not the Sun as in the source.

    Otherwise it moves 2465 au off in a million years, and all places lose three digits.
    """
    masses = [mass for _, mass, _, _ in _PLANETS]
    centre = _mean([place for _, _, place, _ in _PLANETS], masses)
    drift = _mean([velocity for _, _, _, velocity in _PLANETS], masses)
    return Start(
        "1994",
        "5 September 1994, 0h; the centre of mass rests",
        q=tuple(x - c for _, _, place, _ in _PLANETS for x, c in zip(place, centre, strict=True)),
        p=tuple(m * (v - d) for _, m, _, velocity in _PLANETS for v, d in zip(velocity, drift, strict=True)),
        made_for=" ".join(("G", *(f"m{body}" for body in range(len(_PLANETS))))),
    )


def _mean(vectors: Sequence[Sequence[float]], masses: Sequence[float]) -> list[float]:
    """Return the mean of some vectors, weighted by mass."""
    whole, columns = math.fsum(masses), zip(*vectors, strict=True)
    return [math.fsum(m * x for m, x in zip(masses, column, strict=True)) / whole for column in columns]


OUTER_SOLAR_SYSTEM = Scene(
    name="outer-solar-system",
    title="The outer solar system: the Sun, Jupiter, Saturn, Uranus, Neptune, Pluto",
    coordinates=" ".join(f"{axis}{body}" for body in range(len(_PLANETS)) for axis in "xyz"),
    parameters=(
        Parameter("G", 2.95912208286e-4, "au³/d²", "gravitational constant times the mass of the Sun"),
        *(
            Parameter(f"m{i}", mass, "Suns", f"mass of {name}")
            for i, (name, mass, _, _) in enumerate(_PLANETS)
        ),
    ),
    starts=(_planets_start(),),
    conditions=(
        Condition(
            "the Sun holds Jupiter, at its place and velocity of 1994, where G (m0 + m1) > r v²/2",
            lambda v: _energy_of_jupiter(v) < 0.0,
        ),
    ),
    time_scale=_orbit_of_jupiter,
    shown=21.0,
    picture_of=lambda s: Picture(masses=tuple(_planet_places(s))),
    time_unit="d",
    source="Hairer, Lubich & Wanner, Geometric Numerical Integration (2nd ed.), § I.2.4",
    H_of=_planets_hamiltonian,
    integrals=(
        Integral("total momentum, x", lambda s: _total_momentum(_planet_places(s), 0)),
        Integral("total momentum, y", lambda s: _total_momentum(_planet_places(s), 1)),
        Integral("total momentum, z", lambda s: _total_momentum(_planet_places(s), 2)),
        Integral("angular momentum, z", lambda s: _angular_momentum_z(_planet_places(s))),
    ),
)

SCENES = (FIGURE_EIGHT, OUTER_SOLAR_SYSTEM)
"""The systems of bodies."""
