"""Systems in a turning frame: Foucault's pendulum, and a small body near two that circle one another."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import sin, sqrt
from canon.scene.picture import Picture, ring
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start
from canon.scene.systems.pendulum import GRAVITY

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    import numpy as np
    from numpy.typing import NDArray
    from sympy import Expr

    from canon.array import Array

__all__ = ["SCENES"]


def _vertical_rotation(s: SimpleNamespace) -> Expr:
    return s.w * sin(s.latitude)


def _foucault(s: SimpleNamespace) -> Expr:
    coriolis = s.m * _vertical_rotation(s) * (s.x * s.y.dot - s.y * s.x.dot)
    swing = s.m * (s.x.dot**2 + s.y.dot**2) / 2 - s.m * s.g * (s.x**2 + s.y**2) / (2 * s.l)
    return swing + coriolis


def _foucault_motion(value: Mapping[str, float], t: Array) -> NDArray[np.complex128]:
    """Return x + iy = a e^(−iΩt) (cos ωt + i (Ω/ω) sin ωt), ω² = g/l + Ω², Ω = w sin(latitude)."""
    import numpy as np

    turn = value["w"] * math.sin(value["latitude"])
    rate = math.sqrt(value["g"] / value["l"] + turn**2)
    return 3.0 * np.exp(-1j * turn * t) * (np.cos(rate * t) + 1j * turn / rate * np.sin(rate * t))


def _foucault_period(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi * math.sqrt(value["l"] / value["g"])


FOUCAULT = Scene(
    name="foucault-pendulum",
    title="Foucault's pendulum in the Panthéon: its plane turns by w sin(latitude), once in 31 h 47 min",
    coordinates="x y",
    parameters=(
        Parameter("m", 28.0, "kg", "mass of the bob"),
        Parameter("l", 67.0, "m", "length"),
        Parameter("w", 7.2921159e-5, "rad/s", "angular velocity of the Earth"),
        Parameter(
            "latitude",
            math.radians(48.8462),
            "rad",
            "latitude",
            sign="real",
            least=-math.pi / 2.0,
            most=math.pi / 2.0,
        ),
        GRAVITY,
    ),
    starts=(
        Start(
            "released", "let go at rest, 3 m aside; x to the east, y to the north", q=(3.0, 0.0), v=(0.0, 0.0)
        ),
    ),
    time_scale=_foucault_period,
    time_unit="s",
    source="Landau & Lifshitz, Mechanics (3rd ed.), § 39 problem 3; small swings, terms in w² left out",
    L_of=_foucault,
    integrals=(Integral("canonical angular momentum", lambda s: s.x * s.y.momentum - s.y * s.x.momentum),),
    solutions=(
        Solution(
            "east: real part of the closed form",
            "released",
            lambda s: s.x,
            lambda v, t: _foucault_motion(v, t).real,
            periods=1000.0,
            bound=1e-11,
        ),
        Solution(
            "north: imaginary part of the closed form",
            "released",
            lambda s: s.y,
            lambda v, t: _foucault_motion(v, t).imag,
            periods=1000.0,
            bound=1e-11,
        ),
    ),
    shown=800.0,
    picture_of=lambda s: Picture(masses=((s.x, s.y),), ground=(ring((0.0, 0.0), (3.0, 0.0), (0.0, 3.0)),)),
)


def _restricted(s: SimpleNamespace) -> Expr:
    x, y, mu = s.x, s.y, s.mu
    r1 = sqrt((x + mu) ** 2 + y**2)
    r2 = sqrt((x - 1 + mu) ** 2 + y**2)
    momenta = (x.momentum**2 + y.momentum**2) / 2
    return momenta + y * x.momentum - x * y.momentum - (1 - mu) / r1 - mu / r2


def _jacobi(s: SimpleNamespace) -> Expr:
    """Return 2 Ω(x, y) − ẋ² − ẏ², Ω = (x² + y²)/2 + (1 − µ)/r₁ + µ/r₂."""
    x, y, mu = s.x, s.y, s.mu
    r1 = sqrt((x + mu) ** 2 + y**2)
    r2 = sqrt((x - 1 + mu) ** 2 + y**2)
    speed = (x.momentum + y) ** 2 + (y.momentum - x) ** 2
    return x**2 + y**2 + 2 * (1 - mu) / r1 + 2 * mu / r2 - speed


ARENSTORF_MU = 0.012277471
ARENSTORF_PERIOD = 17.0652165601579625588917206249
_SPEED = -2.00158510637908252240537862224

RESTRICTED = Scene(
    name="restricted-three-body",
    title="Restricted three-body problem: a spacecraft near the Earth and the Moon, which circle one another",
    coordinates="x y",
    parameters=(Parameter("mu", ARENSTORF_MU, "", "mass of the Moon as a part of both", most=0.5),),
    starts=(
        Start(
            "Arenstorf",
            "a closed orbit of four loops",
            q=(0.994, 0.0),
            p=(0.0, _SPEED + 0.994),
            made_for="mu",
        ),
        Start(
            "tadpole",
            "near the Lagrangian point L4, at rest in the turning frame",
            q=(0.5 - ARENSTORF_MU + 0.01, math.sqrt(0.75)),
            p=(-math.sqrt(0.75), 0.5 - ARENSTORF_MU + 0.01),
            made_for="mu",
        ),
        Start(
            "L4",
            "in the Lagrangian point L4",
            q=(0.5 - ARENSTORF_MU, math.sqrt(0.75)),
            p=(-math.sqrt(0.75), 0.5 - ARENSTORF_MU),
            made_for="mu",
        ),
    ),
    time_scale=lambda _value: 2.0 * math.pi,
    time_unit="",
    source="Hairer, Nørsett & Wanner, Solving Ordinary Differential Equations I (2nd ed.), § II.0: Arenstorf orbit",
    H_of=_restricted,
    integrals=(
        Integral("Jacobi's integral", _jacobi, 1e-11, "the Arenstorf orbit passes close by the Moon"),
    ),
    solutions=(
        Solution(
            "the Arenstorf orbit closes: x",
            "Arenstorf",
            lambda s: s.x,
            lambda _v, _t: 0.994,
            periods=ARENSTORF_PERIOD / (2.0 * math.pi),
            samples=1,
            bound=1e-9,
            source="published to 30 digits; the orbit magnifies round-off by about 10⁵",
        ),
        Solution(
            "L4 is at rest: x",
            "L4",
            lambda s: s.x,
            lambda v, _t: 0.5 - v["mu"],
            bound=1e-11,
        ),
    ),
    energy_bound=1e-11,
    energy_why="the Arenstorf orbit passes close by the Moon",
    picture_of=lambda s: Picture(
        masses=((s.x, s.y),),
        ground=(
            ring((-s.mu, 0.0), (0.04, 0.0), (0.0, 0.04)),
            ring((1 - s.mu, 0.0), (0.012, 0.0), (0.0, 0.012)),
        ),
    ),
)

SCENES = (FOUCAULT, RESTRICTED)
"""The scenes in turning frames."""
