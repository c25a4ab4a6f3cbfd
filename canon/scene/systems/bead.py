"""Beads on turning wires: a parabola and a hoop, driven so that they turn at a constant rate."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import cos, sin
from canon.scene.picture import Picture
from canon.scene.scene import Parameter, Scene, Solution, Start
from canon.scene.systems.pendulum import GRAVITY

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import SimpleNamespace

    from sympy import Expr

    from canon.mechanics.lagrange.body import Body

__all__ = ["SCENES"]

Place = tuple["Expr", "Expr", "Expr"]


def _on_the_parabola(s: SimpleNamespace, r: Expr | float) -> Place:
    return (r * cos(s.w * s.t), r * sin(s.w * s.t), s.c * r**2)


def _parabola(s: SimpleNamespace) -> Expr:
    x = s.x
    kinetic = s.m * ((1 + 4 * s.c**2 * x**2) * x.dot**2 + s.w**2 * x**2) / 2
    return kinetic - s.m * s.g * s.c * x**2


def _parabola_body(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import Particle

    return [Particle(s.m, _on_the_parabola(s, s.x))]


def _parabola_picture(s: SimpleNamespace) -> Picture:
    wire = tuple(_on_the_parabola(s, k / 20.0) for k in range(-10, 11))
    return Picture(masses=(_on_the_parabola(s, s.x),), bars=(wire,))


def _small_slide(value: Mapping[str, float]) -> float:
    square = value["w"] ** 2
    gap = abs(2.0 * value["g"] * value["c"] - square)
    # where w² = 2 g c, up to rounding, nothing swings: the turns of the wire are what there is
    return 2.0 * math.pi / math.sqrt(gap if gap > 1e-12 * square else square)


PARABOLA = Scene(
    name="bead-parabola",
    title="Bead on a parabolic wire z = c x² that turns about the vertical: w² against 2 g c",
    coordinates="x",
    parameters=(
        Parameter("m", 0.05, "kg", "mass of the bead"),
        Parameter("c", 1.0, "1/m", "curvature of the wire, z = c x²"),
        Parameter("w", 3.0, "rad/s", "angular velocity of the wire"),
        GRAVITY,
    ),
    starts=(Start("released", "let go at 40 cm from the axis", q=(0.4,), v=(0.0,)),),
    time_scale=_small_slide,
    time_unit="s",
    source="the rheonomic position map; Jacobi's energy is conserved, T + V is not",
    L_of=_parabola,
    bodies_of=_parabola_body,
    V_of=lambda s: s.m * s.g * s.c * s.x**2,
    picture_of=_parabola_picture,
)


def _on_the_hoop(s: SimpleNamespace, angle: Expr | float) -> Place:
    across = s.a * sin(angle)
    return (across * cos(s.w * s.t), across * sin(s.w * s.t), s.a - s.a * cos(angle))


def _hoop(s: SimpleNamespace) -> Expr:
    kinetic = s.m * s.a**2 * (s.phi.dot**2 + s.w**2 * sin(s.phi) ** 2) / 2
    return kinetic - s.m * s.g * s.a * (1 - cos(s.phi))


def _hoop_body(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import Particle

    return [Particle(s.m, _on_the_hoop(s, s.phi))]


def _hoop_picture(s: SimpleNamespace) -> Picture:
    turns = [2.0 * math.pi * k / 36.0 for k in range(37)]
    return Picture(masses=(_on_the_hoop(s, s.phi),), bars=(tuple(_on_the_hoop(s, turn) for turn in turns),))


_HOOP = {"a": 0.2, "w": 10.0, "g": GRAVITY.value}


def _balance(value: Mapping[str, float]) -> float:
    """Return the angle where the bead stays on the turning hoop, cos φ = g/(a w²)."""
    return math.acos(value["g"] / (value["a"] * value["w"] ** 2))


HOOP = Scene(
    name="bead-hoop",
    title="Bead on a hoop that turns about its vertical diameter: it rests aside where w² > g/a",
    coordinates="phi",
    angles="phi",
    parameters=(
        Parameter("m", 0.05, "kg", "mass of the bead"),
        Parameter("a", _HOOP["a"], "m", "radius of the hoop"),
        Parameter("w", _HOOP["w"], "rad/s", "angular velocity of the hoop"),
        GRAVITY,
    ),
    starts=(
        Start("low", "let go near the bottom", q=(0.2,), v=(0.0,)),
        Start(
            "balance",
            "at rest on the hoop where cos φ = g/(a w²)",
            q=(_balance(_HOOP),),
            v=(0.0,),
            made_for="a w g",
        ),
    ),
    time_scale=lambda value: 2.0 * math.pi / value["w"],
    time_unit="s",
    source="Goldstein, Poole & Safko, Classical Mechanics (3rd ed.), ch. 2 exercise 18",
    L_of=_hoop,
    bodies_of=_hoop_body,
    V_of=lambda s: s.m * s.g * _on_the_hoop(s, s.phi)[2],
    solutions=(
        Solution("it stays where cos φ = g/(a w²)", "balance", lambda s: s.phi, lambda v, _t: _balance(v)),
    ),
    picture_of=_hoop_picture,
    energy_bound=1e-12,
    energy_why="what the motor's turning and gravity add to Jacobi's energy nearly cancels",
)


SCENES = (PARABOLA, HOOP)
"""The beads on turning wires."""
