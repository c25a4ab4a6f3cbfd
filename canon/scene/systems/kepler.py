"""Kepler's problem in a plane, Cartesian coordinates, per unit of reduced mass."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import sqrt
from canon.scene.picture import Picture, ring
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    from sympy import Expr

    from canon.array import Array

__all__ = ["SCENES"]

SUN = 0.01720209895**2 * 365.25**2
"""Gaussian gravitational constant squared: G times the mass of the Sun in au³/a² (Julian years)."""


def _hamiltonian(s: SimpleNamespace) -> Expr:
    return (s.x.momentum**2 + s.y.momentum**2) / 2 - s.mu / sqrt(s.x**2 + s.y**2)


def _angular_momentum(s: SimpleNamespace) -> Expr:
    return s.x * s.y.momentum - s.y * s.x.momentum


def _runge_lenz_x(s: SimpleNamespace) -> Expr:
    return s.y.momentum * _angular_momentum(s) / s.mu - s.x / sqrt(s.x**2 + s.y**2)


def _runge_lenz_y(s: SimpleNamespace) -> Expr:
    return -s.x.momentum * _angular_momentum(s) / s.mu - s.y / sqrt(s.x**2 + s.y**2)


def perihelion(eccentricity: float, mu: float = SUN, semi_major_axis: float = 1.0) -> Start:
    """Return the start at perihelion on the positive x axis, moving in the direction of positive y.

    Parameters
    ----------
    eccentricity
        0 ≤ e < 1.
    mu
        Gravitational parameter.
    semi_major_axis
        Half the longest diameter of the orbit.

    Examples
    --------
    >>> perihelion(0.6).q
    (0.4, 0.0)
    """
    if not 0.0 <= eccentricity < 1.0:
        raise ValueError(f"an ellipse has an eccentricity from 0 to below 1, not {eccentricity}")
    speed = math.sqrt(mu / semi_major_axis * (1.0 + eccentricity) / (1.0 - eccentricity))
    return Start(
        name=f"e={eccentricity:g}",
        about=f"perihelion of an orbit of eccentricity {eccentricity:g}",
        q=(semi_major_axis * (1.0 - eccentricity), 0.0),
        p=(0.0, speed),
        made_for="mu",
    )


def _on_the_ellipse(value: Mapping[str, float], t: Array, eccentricity: float) -> tuple[Array, Array]:
    """Return x = cos E − e, y = √(1 − e²) sin E with Kepler's equation E − e sin E = n t, solved by Newton's method."""
    import numpy as np

    mean = math.sqrt(value["mu"]) * t
    anomaly = mean + eccentricity * np.sin(mean)
    for _ in range(50):
        missing = anomaly - eccentricity * np.sin(anomaly) - mean
        anomaly = anomaly - missing / (1.0 - eccentricity * np.cos(anomaly))
    return np.cos(anomaly) - eccentricity, math.sqrt(1.0 - eccentricity**2) * np.sin(anomaly)


def _year(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi / math.sqrt(value["mu"])


KEPLER = Scene(
    name="kepler",
    title="Kepler's problem: a planet and the Sun, semi-major axis 1 au",
    coordinates="x y",
    parameters=(Parameter("mu", SUN, "au³/a²", "gravitational parameter G(M + m)"),),
    starts=(perihelion(0.6), perihelion(0.0167), perihelion(0.9)),
    time_scale=_year,
    time_unit="a",
    source="Goldstein, Poole & Safko, Classical Mechanics (3rd ed.), § 3.7–3.9",
    H_of=_hamiltonian,
    energy_bound=1e-12,
    energy_why="kinetic and potential energy at the perihelion of e = 0.9 are 20 times their sum",
    solutions=(
        Solution(
            "x by Kepler's equation", "e=0.6", lambda s: s.x, lambda v, t: _on_the_ellipse(v, t, 0.6)[0]
        ),
        Solution(
            "y by Kepler's equation", "e=0.6", lambda s: s.y, lambda v, t: _on_the_ellipse(v, t, 0.6)[1]
        ),
        Solution(
            "x by Kepler's equation, e = 0.9",
            "e=0.9",
            lambda s: s.x,
            lambda v, t: _on_the_ellipse(v, t, 0.9)[0],
            bound=1e-11,
        ),
    ),
    picture_of=lambda s: Picture(masses=((s.x, s.y),), ground=(ring((0.0, 0.0), (0.03, 0.0), (0.0, 0.03)),)),
    integrals=(
        Integral("angular momentum", _angular_momentum),
        Integral("Runge–Lenz vector, x", _runge_lenz_x),
        Integral(
            "Runge–Lenz vector, y",
            _runge_lenz_y,
            1e-12,
            "its terms at the perihelion of e = 0.9 are many times its size",
        ),
    ),
)

SCENES = (KEPLER,)
"""Kepler's problem."""
