"""The Hénon–Heiles system, between order and chaos."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import Rational
from canon.scene.scene import Scene, Start

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import SimpleNamespace

    from sympy import Expr

__all__ = ["SCENES"]


def _hamiltonian(s: SimpleNamespace) -> Expr:
    kinetic = (s.x.momentum**2 + s.y.momentum**2) / 2
    return kinetic + (s.x**2 + s.y**2) / 2 + s.x**2 * s.y - Rational(1, 3) * s.y**3


def _small_oscillation(_value: Mapping[str, float]) -> float:
    return 2.0 * math.pi


def on_the_section(name: str, about: str, energy: float, y: float, p_y: float) -> Start:
    """Return the start on the section x = 0, p_x > 0 with this energy.

    Raises
    ------
    ValueError
        Where the energy does not suffice for y and p_y.

    Examples
    --------
    >>> on_the_section("regular", "", 1 / 12, y=0.1, p_y=0.1).q
    (0.0, 0.1)
    """
    left = 2.0 * energy - p_y**2 - y**2 + 2.0 * y**3 / 3.0
    if left < 0.0:
        raise ValueError(
            f"y = {y:g}, p_y = {p_y:g} lie outside the section of energy {energy:g}; "
            "take a point nearer to the origin, or a larger energy"
        )
    return Start(name, about, q=(0.0, y), p=(math.sqrt(left), p_y))


HENON_HEILES = Scene(
    name="henon-heiles",
    title="Hénon–Heiles: a star in the meridian plane of a galaxy",
    coordinates="x y",
    parameters=(),
    starts=(
        on_the_section("regular", "energy 1/12, on an invariant curve", 1.0 / 12.0, y=0.1, p_y=0.1),
        on_the_section("chaotic", "energy 1/8, in the chaotic sea", 1.0 / 8.0, y=-0.25, p_y=0.0),
    ),
    time_scale=_small_oscillation,
    time_unit="",
    source="Hénon & Heiles, Astron. J. 69, 73 (1964), doi:10.1086/109234",
    H_of=_hamiltonian,
    shown=40.0,
)

SCENES = (HENON_HEILES,)
"""The Hénon–Heiles system."""
