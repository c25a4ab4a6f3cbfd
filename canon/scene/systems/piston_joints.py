"""The piston engine with all its bodies: seven coordinates, six constraints, joint forces as multipliers."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import TYPE_CHECKING

from canon.scene.formula_functions import Integer, cos, sin
from canon.scene.parts import multiplier
from canon.scene.scene import Scene, Solution, Start
from canon.scene.systems.slider_crank import (
    PARAMETERS,
    REACHED,
    SPEED,
    TURNS,
    VALUES,
    drawn,
    inertia,
    quarter_turn,
    ratios,
    speed_at_a_quarter,
    square_at_a_quarter,
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

    return [
        PlanarBody(s.m1, (s.x1, s.y1), s.J1, s.theta),
        PlanarBody(s.m2, (s.x2, s.y2), s.J2, s.phi),
        Particle(s.m3, (s.s, Integer(0))),
    ]


def _joints(s: SimpleNamespace) -> Sequence[Expr]:
    length = s.a + s.b
    return [
        s.s - s.r * cos(s.theta) - length * cos(s.phi),
        s.e - s.r * sin(s.theta) + length * sin(s.phi),
        s.x1 - s.c * cos(s.theta),
        s.y1 - s.c * sin(s.theta),
        s.x2 - s.r * cos(s.theta) - s.a * cos(s.phi),
        s.y2 - s.b * sin(s.phi) - s.e,
    ]


def _piston_force(value: Mapping[str, float], _t: Array) -> float:
    """Return λ₁ = m₃ s̈ + P at θ = π/2, s̈ = k_s′ θ̇² + k_s θ̈, I θ̈ = −I′ θ̇²/2 − P k_s − M."""
    from sympy import Float, Symbol, pi

    from canon.mechanics.algebra.substitution import exchanged

    theta = Symbol("theta", real=True)
    s = SimpleNamespace(**{k: Float(v, 30) for k, v in value.items()}, theta=theta)
    I, k_s = inertia(s), ratios(s)[1]

    def at(f: Expr) -> float:
        return float(exchanged(f, {theta: pi / 2}))

    square, ratio = square_at_a_quarter(value), at(k_s)
    acceleration = -(at(I.diff(theta)) * square / 2.0 + value["P"] * ratio + value["M"]) / at(I)
    return value["m3"] * (at(k_s.diff(theta)) * square + ratio * acceleration) + value["P"]


def _at_the_top() -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the seven coordinates and velocities at θ = 0."""
    v = VALUES
    length = v["a"] + v["b"]
    phi = math.asin(-v["e"] / length)
    k_phi = v["r"] / (length * math.cos(phi))
    speeds = (0.0, v["c"], -v["a"] * math.sin(phi) * k_phi, v["b"] * math.cos(phi) * k_phi)
    piston = -length * math.sin(phi) * k_phi
    place = (
        v["c"], 0.0, v["r"] + v["a"] * math.cos(phi), v["b"] * math.sin(phi) + v["e"], 0.0, phi,
        v["r"] + length * math.cos(phi),
    )  # fmt: skip
    return place, tuple(SPEED * rate for rate in (*speeds, 1.0, k_phi, piston))


def _picture(s: SimpleNamespace) -> Picture:
    return drawn((s.r * cos(s.theta), s.r * sin(s.theta)), (s.s, s.e), s)


WHOLE = Scene(
    name="piston-engine-joints",
    title="Piston engine with all its bodies: seven coordinates, six constraints, joint forces as multipliers",
    coordinates="x1 y1 x2 y2 theta phi s",
    angles="theta",
    parameters=PARAMETERS,
    conditions=(TURNS,),
    starts=(
        Start(
            "running",
            "100 rad/s at the top, nothing drives it",
            q=_at_the_top()[0],
            v=_at_the_top()[1],
            made_for="a b c e r",
        ),
    ),
    time_scale=turn,
    time_unit="s",
    source="Lagrange's equations of the first kind; reactions by Newton's second law body by body",
    bodies_of=_bodies,
    forces_of=lambda s: [*[0 * s.M] * 4, -s.M, 0 * s.M, -s.P],
    holonomic_of=_joints,
    solutions=(
        speed_at_a_quarter(1e-12),
        Solution(
            "force on the piston at θ = π/2, λ₁ = m₃ s̈ + P",
            "running",
            lambda _s: multiplier(1),
            _piston_force,
            event=quarter_turn,
            periods=1.0,
            bound=1e-11,
            condition=REACHED,
        ),
    ),
    picture_of=_picture,
    shown=1.0,
)

SCENES = (WHOLE,)
"""The piston engine with reactions."""
