"""Oscillators: harmonic in one and two degrees of freedom, and with a hardening spring."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.picture import Picture
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    from sympy import Expr

    from canon.array import Array

__all__ = ["SCENES"]

_MASS = Parameter("m", 0.25, "kg", "mass")
_STIFFNESS = Parameter("k", 10.0, "N/m", "stiffness of the spring")


def _period(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi * math.sqrt(value["m"] / value["k"])


def _harmonic(value: Mapping[str, float], t: Array) -> Array:
    import numpy as np

    return 0.1 * np.cos(math.sqrt(value["k"] / value["m"]) * t)


def on_a_table(s: SimpleNamespace) -> Picture:
    """Return a mass on a table with a spring to the wall, 0.3 m long when slack."""
    table = ((-0.3, 0.02), (-0.3, -0.02), (0.15, -0.02))
    return Picture(masses=((s.x, 0.0),), springs=(((-0.3, 0.0), (s.x, 0.0)),), ground=(table,))


HARMONIC = Scene(
    name="harmonic-oscillator",
    title="Harmonic oscillator: a mass on a spring",
    coordinates="x",
    parameters=(_MASS, _STIFFNESS),
    starts=(Start("released", "drawn by 10 cm and released", q=(0.1,), v=(0.0,)),),
    time_scale=_period,
    time_unit="s",
    source="Landau & Lifshitz, Mechanics (3rd ed.), § 21",
    L_of=lambda s: s.m * s.x.dot**2 / 2 - s.k * s.x**2 / 2,
    solutions=(Solution("place: 10 cm cos ωt", "released", lambda s: s.x, _harmonic, periods=100.0),),
    picture_of=on_a_table,
)


def _fradkin(s: SimpleNamespace) -> Expr:
    return s.x.momentum * s.y.momentum / s.m + s.k * s.x * s.y


ISOTROPIC = Scene(
    name="isotropic-oscillator",
    title="Isotropic oscillator: a mass drawn to a centre in a plane, its orbit an ellipse about it",
    coordinates="x y",
    parameters=(_MASS, _STIFFNESS),
    starts=(Start("ellipse", "thrown sideways", q=(0.1, 0.0), v=(0.0, 0.3)),),
    time_scale=_period,
    time_unit="s",
    source="Fradkin, Am. J. Phys. 33, 207 (1965), doi:10.1119/1.1971373",
    L_of=lambda s: s.m * (s.x.dot**2 + s.y.dot**2) / 2 - s.k * (s.x**2 + s.y**2) / 2,
    integrals=(
        Integral("angular momentum", lambda s: s.x * s.y.momentum - s.y * s.x.momentum),
        Integral("Fradkin tensor, xy", _fradkin),
    ),
    solutions=(Solution("x: 10 cm cos ωt", "ellipse", lambda s: s.x, _harmonic),),
    picture_of=lambda s: Picture(masses=((s.x, s.y),), springs=(((0.0, 0.0), (s.x, s.y)),)),
)


def _hardening(value: Mapping[str, float], t: Array) -> Array:
    """Return x = A cn(Ωt, κ), Ω² = (k + b A²)/m, κ² = b A²/(2 (k + b A²))."""
    import numpy as np
    from scipy.special import ellipj

    stiffness = value["k"] + value["b"] * 0.1**2
    phase = np.sqrt(stiffness / value["m"]) * t
    return 0.1 * ellipj(phase, value["b"] * 0.1**2 / (2.0 * stiffness))[1]


HARDENING = Scene(
    name="duffing-oscillator",
    title="Duffing's oscillator without damping and drive: a mass on a hardening spring",
    coordinates="x",
    parameters=(
        _MASS,
        _STIFFNESS,
        Parameter("b", 2000.0, "N/m³", "cubic stiffness", sign="nonnegative"),
    ),
    starts=(Start("released", "drawn by 10 cm and released", q=(0.1,), v=(0.0,)),),
    time_scale=_period,
    time_unit="s",
    source="Landau & Lifshitz, Mechanics (3rd ed.), § 28",
    L_of=lambda s: s.m * s.x.dot**2 / 2 - s.k * s.x**2 / 2 - s.b * s.x**4 / 4,
    solutions=(Solution("place: A cn(Ωt, κ)", "released", lambda s: s.x, _hardening),),
    picture_of=on_a_table,
)

SCENES = (HARMONIC, ISOTROPIC, HARDENING)
"""The oscillators."""
