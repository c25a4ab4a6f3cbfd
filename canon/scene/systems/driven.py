"""Driven and damped systems: a sprung mass, pendulums and Duffing's oscillator, with the work done on them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import cos, exp, sin
from canon.scene.parts import Condition
from canon.scene.picture import Picture
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start
from canon.scene.systems.oscillator import on_a_table
from canon.scene.systems.pendulum import GRAVITY, below

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import SimpleNamespace

    from sympy import Expr

    from canon.array import Array
    from canon.mechanics.lagrange.body import Body

__all__ = ["SCENES"]


def _drive(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi / value["W"]


def _damped_motion(value: Mapping[str, float], t: Array) -> Array:
    """Return x(t) from rest at 0: the steady swing Re[F/(k − m W² + i c W) e^(iWt)] and what dies out."""
    import numpy as np

    m, c, k, W = value["m"], value["c"], value["k"], value["W"]
    steady = value["F"] / complex(k - m * W * W, c * W)
    decay, rate = c / (2.0 * m), math.sqrt(k / m - (c / (2.0 * m)) ** 2)
    x0, v0 = -steady.real, W * steady.imag
    transient = np.exp(-decay * t) * (x0 * np.cos(rate * t) + (v0 + decay * x0) / rate * np.sin(rate * t))
    return np.asarray((steady * np.exp(1j * W * t)).real + transient)


def _driven_forces(s: SimpleNamespace) -> Sequence[Expr]:
    return [s.F * cos(s.W * s.t) - s.c * s.x.dot]


OSCILLATOR = Scene(
    name="driven-oscillator",
    title="A mass on a spring with a damper, driven near its resonance",
    coordinates="x",
    parameters=(
        Parameter("m", 0.25, "kg", "mass"),
        Parameter("k", 10.0, "N/m", "stiffness of the spring"),
        Parameter("c", 0.2, "N s/m", "damping", sign="nonnegative"),
        Parameter("F", 0.3, "N", "amplitude of the force", sign="real"),
        Parameter("W", 6.0, "rad/s", "angular frequency of the force"),
    ),
    conditions=(
        Condition(
            "the damping is below the critical one, 2 √(k m)", lambda v: v["c"] ** 2 < 4.0 * v["k"] * v["m"]
        ),
    ),
    starts=(Start("at rest", "at rest where the spring is slack", q=(0.0,), v=(0.0,)),),
    time_scale=_drive,
    time_unit="s",
    source="Landau & Lifshitz, Mechanics (3rd ed.), § 26",
    L_of=lambda s: s.m * s.x.dot**2 / 2 - s.k * s.x**2 / 2,
    forces_of=_driven_forces,
    solutions=(
        Solution(
            "place: steady swing and transient",
            "at rest",
            lambda s: s.x,
            _damped_motion,
            periods=50.0,
            condition=Condition(
                "where c = 0 it is off resonance, k ≠ m W²",
                lambda v: v["c"] > 0.0 or v["k"] != v["m"] * v["W"] * v["W"],
            ),
        ),
    ),
    picture_of=on_a_table,
)

DUFFING = Scene(
    name="driven-duffing",
    title="Duffing's oscillator in a double well, damped and driven: chaos",
    coordinates="x",
    parameters=(
        Parameter("c", 0.25, "", "damping", sign="nonnegative"),
        Parameter("F", 0.4, "", "amplitude of the force", sign="real"),
        Parameter("W", 1.0, "", "angular frequency of the force"),
    ),
    starts=(Start("well", "at rest in the right-hand well", q=(1.0,), v=(0.0,)),),
    time_scale=_drive,
    time_unit="",
    source="Guckenheimer & Holmes, Nonlinear Oscillations, Dynamical Systems, and Bifurcations, § 2.2",
    L_of=lambda s: s.x.dot**2 / 2 + s.x**2 / 2 - s.x**4 / 4,
    forces_of=_driven_forces,
    energy_bound=1e-12,
    energy_why="the work is a sum over the whole run, hundreds of times the energy",
)


def _pendulum(s: SimpleNamespace) -> Expr:
    return s.m * s.l**2 * s.theta.dot**2 / 2 + s.m * s.g * s.l * cos(s.theta)


def _torque(s: SimpleNamespace) -> Sequence[Expr]:
    return [s.M * cos(s.W * s.t) - s.c * s.theta.dot]


def _pendulum_picture(s: SimpleNamespace) -> Picture:
    bob = below(s.l, s.theta)
    return Picture(masses=(bob,), bars=(((0.0, 0.0), bob),))


FORCED = Scene(
    name="forced-pendulum",
    title="Forced pendulum: a damped pendulum under a periodic torque, chaotic",
    coordinates="theta",
    angles="theta",
    parameters=(
        Parameter("m", 1.0, "kg", "mass of the bob"),
        Parameter("l", 1.0, "m", "length"),
        Parameter("c", 1.5657777, "N m s", "damping", sign="nonnegative"),
        Parameter("M", 11.276, "N m", "amplitude of the torque", sign="real"),
        Parameter("W", 2.0877037, "rad/s", "angular frequency of the torque"),
        GRAVITY,
    ),
    starts=(Start("hanging", "at rest at 0.2 rad", q=(0.2,), v=(0.0,)),),
    time_scale=_drive,
    time_unit="s",
    source="Baker & Gollub, Chaotic Dynamics, ch. 3: damping 1/2, torque 1.15, frequency 2/3 in units of √(g/l)",
    L_of=_pendulum,
    forces_of=_torque,
    picture_of=_pendulum_picture,
    energy_bound=1e-12,
    energy_why="the work is a sum over the whole run, thousands of times the energy",
)


def _parametric_body(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import Particle

    return [Particle(s.m, _parametric_bob(s))]


def _parametric_bob(s: SimpleNamespace) -> tuple[Expr, Expr]:
    return (s.l * sin(s.theta), s.a * cos(s.W * s.t) - s.l * cos(s.theta))


def _parametric(s: SimpleNamespace) -> Expr:
    pivot = -s.a * s.W * sin(s.W * s.t)
    square = s.l**2 * s.theta.dot**2 + 2 * s.l * s.theta.dot * pivot * sin(s.theta) + pivot**2
    return s.m * square / 2 - s.m * s.g * _parametric_bob(s)[1]


def _parametric_picture(s: SimpleNamespace) -> Picture:
    pivot = (0 * s.a, s.a * cos(s.W * s.t))
    bob = _parametric_bob(s)
    return Picture(masses=(bob,), bars=((pivot, bob),))


PARAMETRIC = Scene(
    name="parametric-pendulum",
    title="Kapitza's pendulum: its pivot shakes so fast that it stands upside down",
    coordinates="theta",
    angles="theta",
    parameters=(
        Parameter("m", 0.1, "kg", "mass of the bob"),
        Parameter("l", 0.2, "m", "length"),
        Parameter("a", 0.02, "m", "amplitude of the pivot", sign="nonnegative"),
        Parameter("W", 200.0, "rad/s", "angular frequency of the pivot"),
        GRAVITY,
    ),
    starts=(
        Start("inverted", "at rest 0.3 rad from upside down", q=(math.pi - 0.3,), v=(0.0,)),
        Start("hanging", "at rest at 0.3 rad", q=(0.3,), v=(0.0,)),
    ),
    time_scale=_drive,
    time_unit="s",
    source="Landau & Lifshitz, Mechanics (3rd ed.), § 30 problem 1: upside down is stable where a² W² > 2 g l",
    L_of=_parametric,
    bodies_of=_parametric_body,
    V_of=lambda s: s.m * s.g * _parametric_bob(s)[1],
    picture_of=_parametric_picture,
    energy_bound=1e-10,
    energy_why="the work goes to and fro with every shake, and is summed",
    solutions=(
        Solution(
            "upside down it swings slowly, with ω² = (a W/l)²/2 − g/l: first pass (Kapitza's average)",
            "inverted",
            lambda s: s.t,
            lambda v, _t: math.pi / 2.0 / math.sqrt((v["a"] * v["W"] / v["l"]) ** 2 / 2.0 - v["g"] / v["l"]),
            event=lambda s: s.theta - _pi(),
            bound=0.1,
            periods=60.0,
            source="an average, good to the ratio of the frequencies",
            condition=Condition(
                "upside down is stable, a² W² > 2 g l",
                lambda v: (v["a"] * v["W"]) ** 2 > 2.0 * v["g"] * v["l"],
            ),
        ),
    ),
)


def _pi() -> Expr:
    from sympy import pi

    return pi


def _growing(s: SimpleNamespace) -> Expr:
    """Return the amplitude squared times its decay, (½ m v² + …) e^(c t/m): constant for a damped oscillator."""
    m, k, c, x, v = s.m, s.k, s.c, s.x, s.x.dot
    return (m * v**2 + c * x * v + k * x**2) * exp(c * s.t / m)


DAMPED = Scene(
    name="damped-oscillator",
    title="A mass on a spring with a damper, left to itself",
    coordinates="x",
    parameters=(
        Parameter("m", 0.25, "kg", "mass"),
        Parameter("k", 10.0, "N/m", "stiffness of the spring"),
        Parameter("c", 0.2, "N s/m", "damping", sign="nonnegative"),
    ),
    conditions=OSCILLATOR.conditions,
    starts=(Start("released", "drawn by 10 cm and released", q=(0.1,), v=(0.0,)),),
    time_scale=lambda value: 2.0 * math.pi * math.sqrt(value["m"] / value["k"]),
    time_unit="s",
    source="Landau & Lifshitz, Mechanics (3rd ed.), § 25; the integral by differentiation",
    L_of=OSCILLATOR.L_of,
    forces_of=lambda s: [-s.c * s.x.dot],
    integrals=(
        Integral("(m v² + c x v + k x²) e^(c t/m)", _growing, 1e-11, "what is left of the energy is tiny"),
    ),
    horizon=30.0,
    picture_of=on_a_table,
)

SCENES = (OSCILLATOR, DAMPED, DUFFING, FORCED, PARAMETRIC)
"""The driven and damped scenes."""
