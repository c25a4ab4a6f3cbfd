"""The piston engine by its crank angle alone: the whole inertia function, its first harmonics, constant speed."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import TYPE_CHECKING

from canon.scene.formula_functions import asin, cos, sin
from canon.scene.parts import Condition, multiplier
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start
from canon.scene.systems.slider_crank import (
    PARAMETERS,
    SPEED,
    TURNS,
    drawn,
    inertia,
    quarter_turn,
    ratios,
    rod_cosine,
    rod_sine,
    speed_at_a_quarter,
    turn,
)

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr

    from canon.array import Array
    from canon.mechanics.lagrange.body import Body
    from canon.scene.picture import Picture

__all__ = ["SCENES"]


def _bodies(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import Particle, PlanarBody

    across, along = rod_sine(s), rod_cosine(s)
    crank = (s.c * cos(s.theta), s.c * sin(s.theta))
    rod = (s.r * cos(s.theta) + s.a * along, s.b * across + s.e)
    piston = (s.r * cos(s.theta) + (s.a + s.b) * along, s.e)
    return [
        PlanarBody(s.m1, crank, s.J1, s.theta),
        PlanarBody(s.m2, rod, s.J2, -asin(across)),
        Particle(s.m3, piston),
    ]


def _crank_picture(s: SimpleNamespace) -> Picture:
    pin = (s.r * cos(s.theta), s.r * sin(s.theta))
    return drawn(pin, (pin[0] + (s.a + s.b) * rod_cosine(s), s.e), s)


def _given_work(s: SimpleNamespace) -> Expr:
    return s.P * (s.r * cos(s.theta) + (s.a + s.b) * rod_cosine(s)) + s.M * s.theta


ENGINE = Scene(
    name="piston-engine",
    title="Piston engine by its crank angle alone: L = I(θ) θ̇²/2 with the whole inertia function",
    coordinates="theta",
    angles="theta",
    parameters=PARAMETERS,
    conditions=(TURNS,),
    starts=(Start("running", "100 rad/s at the top, nothing drives it", q=(0.0,), v=(SPEED,)),),
    time_scale=turn,
    time_unit="s",
    source="kinetic energy by the transmission ratios φ̇/θ̇ and ṡ/θ̇; bodies by their places",
    L_of=lambda s: inertia(s) * s.theta.dot**2 / 2,
    bodies_of=_bodies,
    forces_of=lambda s: [-s.P * ratios(s)[1] - s.M],
    integrals=(
        Integral(
            "energy less the work −P s − M θ", lambda s: inertia(s) * s.theta.dot**2 / 2 + _given_work(s)
        ),
    ),
    solutions=(speed_at_a_quarter(1e-13),),
    picture_of=_crank_picture,
    shown=1.0,
)


def _harmonics(s: SimpleNamespace) -> tuple[Expr, Expr]:
    """Return A and B of I(θ) ≈ A − B cos 2θ, to the lowest order in r/l, at e = 0."""
    length = s.a + s.b
    sliding = (s.m3 + s.m2 * s.a / length) * s.r**2
    turning = (s.J2 - s.m2 * s.a * s.b) * (s.r / length) ** 2
    rest = s.J1 + s.m1 * s.c**2 + s.m2 * s.b / length * s.r**2
    return rest + (sliding + turning) / 2, (sliding - turning) / 2


def _first_order(s: SimpleNamespace) -> Expr:
    A, B = _harmonics(s)
    return (A - B * cos(2 * s.theta)) * s.theta.dot**2 / 2


def _truncated_picture(s: SimpleNamespace) -> Picture:
    return _crank_picture(SimpleNamespace(**vars(s), e=0 * s.r))


def _harmonic_speed(value: Mapping[str, float], _t: Array) -> float:
    """Return √(((A − B) ω² − π M)/(A + B))."""
    return math.sqrt(_harmonic_square(value))


def _harmonic_square(value: Mapping[str, float]) -> float:
    A, B = _harmonics(SimpleNamespace(**value))
    return float(((A - B) * SPEED**2 - math.pi * value["M"]) / (A + B))


_FIRST = tuple(c for c in PARAMETERS if c.name not in ("e", "P"))

TRUNCATED = Scene(
    name="piston-engine-first-order",
    title="Piston engine with the first harmonics of its inertia, I(θ) ≈ A − B cos 2θ",
    coordinates="theta",
    angles="theta",
    parameters=_FIRST,
    conditions=(TURNS,),
    starts=(Start("running", "100 rad/s at the top, nothing drives it", q=(0.0,), v=(SPEED,)),),
    time_scale=turn,
    time_unit="s",
    source="lowest order in r/l and no offset",
    L_of=_first_order,
    forces_of=lambda s: [-s.M],
    picture_of=_truncated_picture,
    solutions=(
        Solution(
            "θ̇ at θ = π/2: √(((A − B) ω² − π M)/(A + B))",
            "running",
            lambda s: s.theta.dot,
            _harmonic_speed,
            event=quarter_turn,
            periods=1.0,
            bound=1e-13,
            condition=Condition("the crank reaches θ = π/2 against M", lambda v: _harmonic_square(v) > 0.0),
        ),
    ),
    shown=1.0,
)


def _constant_torque(value: Mapping[str, float], t: Array) -> Array:
    """Return λ = B ω² sin 2θ, the torque that keeps θ = ω t."""
    import numpy as np

    _, B = _harmonics(SimpleNamespace(**value))
    return float(B) * value["w"] ** 2 * np.sin(2.0 * value["w"] * t)


DRIVEN = Scene(
    name="piston-engine-constant-speed",
    title="Piston engine kept at constant speed, θ = ω t: the driving torque is a multiplier, B ω² sin 2θ",
    coordinates="theta",
    parameters=(
        *(c for c in _FIRST if c.name != "M"),
        Parameter("w", SPEED, "rad/s", "angular velocity"),
    ),
    conditions=(TURNS,),
    starts=(Start("running", "at the top", q=(0.0,), v=(SPEED,)),),
    time_scale=lambda value: 2.0 * math.pi / value["w"],
    time_unit="s",
    source="lowest order in r/l and no offset; I(θ) ≈ A − B cos 2θ",
    L_of=_first_order,
    holonomic_of=lambda s: [s.theta - s.w * s.t],
    solutions=(
        Solution(
            "driving torque B ω² sin 2θ", "running", lambda _s: multiplier(), _constant_torque, bound=1e-10
        ),
    ),
    picture_of=_truncated_picture,
    horizon=100.0,
    shown=1.0,
    energy_bound=1e-10,
    energy_why="the work of the drive goes to and fro, and is summed",
)


SCENES = (ENGINE, TRUNCATED, DRIVEN)
"""The piston engines of one degree of freedom."""
