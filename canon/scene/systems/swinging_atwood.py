"""Atwood's machine with a swinging mass, integrable where the other mass is three times as large."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import Rational, cos, sin
from canon.scene.picture import Picture
from canon.scene.scene import Integral, Parameter, Scene, Start
from canon.scene.systems.pendulum import GRAVITY

if TYPE_CHECKING:
    from types import SimpleNamespace

    from sympy import Expr

__all__ = ["SCENES"]


def _machine(s: SimpleNamespace) -> Expr:
    """Return L with M = 3 m: (M + m) ṙ²/2 + m r² θ̇²/2 − M g r + m g r cos θ."""
    return 2 * s.m * s.r.dot**2 + s.m * s.r**2 * s.theta.dot**2 / 2 - s.m * s.g * s.r * (3 - cos(s.theta))


def _tufillaro(s: SimpleNamespace) -> Expr:
    """Return r² θ̇ (ṙ cos(θ/2) − (r θ̇/2) sin(θ/2)) + g r² sin(θ/2) cos²(θ/2)."""
    half, r = s.theta / 2, s.r
    swing = r.dot * cos(half) - Rational(1, 2) * r * s.theta.dot * sin(half)
    return r**2 * s.theta.dot * swing + s.g * r**2 * sin(half) * cos(half) ** 2


def _picture(s: SimpleNamespace) -> Picture:
    bob, weight = (s.r * sin(s.theta), -s.r * cos(s.theta)), (-1 + 0 * s.r, s.r - 2)
    return Picture(
        masses=(bob, weight), bars=(((0.0, 0.0), bob), ((0.0, 0.0), (-1.0, 0.0)), ((-1.0, 0.0), weight))
    )


MACHINE = Scene(
    name="swinging-atwood",
    title="Swinging Atwood's machine: one mass swings, the other, three times as heavy, hangs; integrable",
    coordinates="r theta",
    parameters=(Parameter("m", 1.0, "kg", "the swinging mass, a third of the hanging one"), GRAVITY),
    starts=(
        Start("level", "at rest with the string level", q=(1.0, math.pi / 2.0), v=(0.0, 0.0)),
        Start("pushed", "at rest at 60°, pushed aside", q=(1.0, math.pi / 3.0), v=(0.0, 2.0)),
    ),
    time_scale=lambda value: 2.0 * math.pi / math.sqrt(value["g"]),
    time_unit="s",
    source="N. B. Tufillaro, Am. J. Phys. 54, 142 (1986), doi:10.1119/1.14710",
    L_of=_machine,
    integrals=(Integral("Tufillaro's integral", _tufillaro),),
    horizon=100.0,
    picture_of=_picture,
)

SCENES = (MACHINE,)
"""The swinging Atwood's machine."""
