"""Systems to be controlled: a pendulum with an inertia wheel, a block in a swinging pipe, a pendulum on a cart."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import Integer, cos, sin
from canon.scene.parts import Condition
from canon.scene.picture import Picture, wheel
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start
from canon.scene.systems.pendulum import GRAVITY, below

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import SimpleNamespace

    from sympy import Expr

    from canon.array import Array
    from canon.mechanics.lagrange.body import Body

__all__ = ["SCENES"]


def _wheel_bodies(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import PlanarBody

    rod = PlanarBody(s.m1, below(s.l / 2, s.theta), s.m1 * s.l**2 / 12, s.theta)
    return [rod, PlanarBody(s.m2, below(s.l, s.theta), s.J2, s.theta + s.psi)]


def _wheel_pendulum(s: SimpleNamespace) -> Expr:
    return (
        (s.m1 / 3 + s.m2) * s.l**2 * s.theta.dot**2 / 2
        + s.J2 * (s.theta.dot + s.psi.dot) ** 2 / 2
        - _wheel_height(s)
    )


def _wheel_height(s: SimpleNamespace) -> Expr:
    return -(s.m1 / 2 + s.m2) * s.g * s.l * cos(s.theta)


def _wheel_picture(s: SimpleNamespace) -> Picture:
    end = below(s.l, s.theta)
    rim, spoke = wheel(end, s.l / 4, s.theta + s.psi)
    return Picture(masses=(end,), bars=(((Integer(0), Integer(0)), end), rim, spoke))


INERTIA_WHEEL = Scene(
    name="inertia-wheel-pendulum",
    title="Pendulum with an inertia wheel: a motor turns the wheel at its end and so moves the pendulum",
    coordinates="theta psi",
    angles="theta psi",
    parameters=(
        Parameter("m1", 0.2, "kg", "mass of the rod"),
        Parameter("m2", 0.3, "kg", "mass of the wheel"),
        Parameter("l", 0.3, "m", "length of the rod"),
        Parameter("J2", 1.0e-3, "kg m²", "moment of inertia of the wheel"),
        Parameter("M", 0.02, "N m", "torque of the motor between rod and wheel", sign="real"),
        GRAVITY,
    ),
    starts=(
        Start("at rest", "hanging, the motor is switched on", q=(0.0, 0.0), v=(0.0, 0.0)),
        Start("aside", "let go at 1 rad, the motor is on", q=(1.0, 0.0), v=(0.0, 0.0)),
    ),
    time_scale=lambda value: 2.0 * math.pi * math.sqrt(value["l"] / value["g"]),
    time_unit="s",
    source="the motor works on the relative angle, Q = (0, M); Spong, Corke & Lozano, Automatica 37, 1845 (2001)",
    L_of=_wheel_pendulum,
    bodies_of=_wheel_bodies,
    V_of=_wheel_height,
    forces_of=lambda s: [0 * s.M, s.M],
    integrals=(
        Integral("angular momentum of the wheel less M t", lambda s: s.psi.momentum - s.M * s.t),
        Integral("energy less the work M ψ", lambda s: _energy(s) - s.M * s.psi),
    ),
    horizon=30.0,
    picture_of=_wheel_picture,
)


def _energy(s: SimpleNamespace) -> Expr:
    turning = (s.m1 / 3 + s.m2) * s.l**2 * s.theta.dot**2 / 2
    return turning + s.J2 * (s.theta.dot + s.psi.dot) ** 2 / 2 + _wheel_height(s)


def _block(s: SimpleNamespace) -> Expr:
    kinetic = s.m * (s.y.dot**2 + s.y**2 * s.theta.dot**2) / 2
    return kinetic + s.m * s.g * s.y * cos(s.theta) - s.k * (s.y - s.l) ** 2 / 2


def _block_body(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import Particle

    return [Particle(s.m, below(s.y, s.theta))]


def _block_height(s: SimpleNamespace) -> Expr:
    return -s.m * s.g * s.y * cos(s.theta) + s.k * (s.y - s.l) ** 2 / 2


def _block_picture(s: SimpleNamespace) -> Picture:
    place, end = below(s.y, s.theta), below(2 * s.l, s.theta)
    return Picture(masses=(place,), bars=((place, end),), springs=(((0.0, 0.0), place),))


BLOCK = Scene(
    name="block-in-pipe",
    title="Block on a spring and a damper in a swinging pipe",
    coordinates="theta y",
    angles="theta",
    parameters=(
        Parameter("m", 1.0, "kg", "mass of the block"),
        Parameter("k", 80.0, "N/m", "stiffness of the spring"),
        Parameter("c", 1.5, "N s/m", "damping along the pipe", sign="nonnegative"),
        Parameter("l", 0.5, "m", "natural length of the spring"),
        GRAVITY,
    ),
    starts=(
        Start("aside", "pipe let go at 1 rad, spring slack", q=(1.0, 0.5), v=(0.0, 0.0)),
        Start("bouncing", "pipe at rest, block pulled down", q=(0.0, 0.8), v=(0.0, 0.0)),
    ),
    time_scale=lambda value: 2.0 * math.pi * math.sqrt(value["l"] / value["g"]),
    time_unit="s",
    source="virtual work of the damper gives Q_y = −c ẏ; hanging it is a damped oscillator",
    L_of=_block,
    bodies_of=_block_body,
    V_of=_block_height,
    forces_of=lambda s: [0 * s.c, -s.c * s.y.dot],
    solutions=(
        Solution(
            "bouncing: y about l + m g/k, damped",
            "bouncing",
            lambda s: s.y,
            lambda v, t: _bounce(v, t),
            periods=5.0,
            condition=Condition(
                "the damping is below the critical one, 2 √(k m)",
                lambda v: v["c"] ** 2 < 4.0 * v["k"] * v["m"],
            ),
        ),
    ),
    picture_of=_block_picture,
)


def _bounce(value: Mapping[str, float], t: Array) -> Array:
    import numpy as np

    rest = value["l"] + value["m"] * value["g"] / value["k"]
    decay = value["c"] / (2.0 * value["m"])
    rate = math.sqrt(value["k"] / value["m"] - decay**2)
    phase = rate * t
    swing = np.cos(phase) + decay / rate * np.sin(phase)
    return rest + (0.8 - rest) * np.exp(-decay * t) * swing


def _cart_bodies(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import Particle, PlanarBody

    centre = (s.x + s.l / 2 * sin(s.theta), s.l / 2 * cos(s.theta))
    return [Particle(s.m0, (s.x, Integer(0))), PlanarBody(s.m1, centre, s.m1 * s.l**2 / 12, s.theta)]


def _cart(s: SimpleNamespace) -> Expr:
    return (
        (s.m0 + s.m1) * s.x.dot**2 / 2
        + s.m1 * s.l * s.x.dot * s.theta.dot * cos(s.theta) / 2
        + s.m1 * s.l**2 * s.theta.dot**2 / 6
        - _cart_height(s)
    )


def _cart_height(s: SimpleNamespace) -> Expr:
    return s.m1 * s.g * s.l / 2 * cos(s.theta)


def _cart_picture(s: SimpleNamespace) -> Picture:
    w, h = s.l / 4, s.l / 8
    corners = ((-w, -h), (w, -h), (w, 0), (-w, 0), (-w, -h))
    box = tuple((s.x + a, b) for a, b in corners)
    end = (s.x + s.l * sin(s.theta), s.l * cos(s.theta))
    return Picture(masses=(end,), bars=(box, ((s.x, 0.0), end)))


CART = Scene(
    name="cart-pendulum",
    title="Inverted pendulum: a uniform rod on a cart that a force pushes; θ clockwise from the upward vertical",
    coordinates="x theta",
    angles="theta",
    parameters=(
        Parameter("m0", 1.0, "kg", "mass of the cart"),
        Parameter("m1", 0.3, "kg", "mass of the rod"),
        Parameter("l", 0.6, "m", "length of the rod"),
        Parameter("F", 0.0, "N", "force on the cart", sign="real"),
        GRAVITY,
    ),
    starts=(
        Start("falling", "let go 0.1 rad from upright", q=(0.0, 0.1), v=(0.0, 0.0)),
        Start("hanging", "let go 0.5 rad from hanging", q=(0.0, math.pi - 0.5), v=(0.0, 0.0)),
    ),
    time_scale=lambda value: 2.0 * math.pi * math.sqrt(2.0 * value["l"] / (3.0 * value["g"])),
    time_unit="s",
    source="by Lagrange and by Newton–Euler; Åström & Murray, Feedback Systems, § 3.2",
    L_of=_cart,
    bodies_of=_cart_bodies,
    V_of=_cart_height,
    forces_of=lambda s: [s.F, 0 * s.F],
    integrals=(
        Integral("horizontal momentum less F t", lambda s: s.x.momentum - s.F * s.t),
        Integral(
            "energy less the work F x",
            lambda s: _cart_energy(s) - s.F * s.x,
            1e-10,
            "the rod turns over and over",
        ),
    ),
    picture_of=_cart_picture,
)


def _cart_energy(s: SimpleNamespace) -> Expr:
    return _cart(s) + 2 * _cart_height(s)


SCENES = (INERTIA_WHEEL, BLOCK, CART)
"""The systems to be controlled."""
