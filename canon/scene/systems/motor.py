"""Motors and drives: a motor's shaft, a pair of gears, rack and pinion, and the DC motor with its circuit."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.parts import Condition, multiplier
from canon.scene.picture import Picture, wheel
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import SimpleNamespace

    from sympy import Expr, Symbol

    from canon.array import Array

__all__ = ["SCENES", "admittance"]

_DRIVE = Parameter("T", 0.5, "N m", "torque of the motor", sign="real")
_LOAD = Parameter("M", 0.2, "N m", "torque of the load", sign="real")


def _one(_value: Mapping[str, float]) -> float:
    return 1.0


SHAFT = Scene(
    name="motor-shaft",
    title="Motor shaft: J φ̈ = T − M",
    coordinates="phi",
    parameters=(Parameter("J", 0.02, "kg m²", "moment of inertia"), _DRIVE, _LOAD),
    starts=(Start("at rest", "switched on at rest", q=(0.0,), v=(0.0,)),),
    time_scale=_one,
    time_unit="s",
    source="Egeland & Gravdahl, Modeling and Simulation for Automatic Control, ch. 3",
    L_of=lambda s: s.J * s.phi.dot**2 / 2,
    forces_of=lambda s: [s.T - s.M],
    integrals=(Integral("angular momentum less (T − M) t", lambda s: s.phi.momentum - (s.T - s.M) * s.t),),
    solutions=(
        Solution(
            "φ = (T − M) t²/(2 J)",
            "at rest",
            lambda s: s.phi,
            lambda v, t: (v["T"] - v["M"]) * t**2 / (2.0 * v["J"]),
        ),
    ),
    horizon=10.0,
    shown=0.5,
    picture_of=lambda s: Picture(
        bars=wheel((0 * s.phi, 0 * s.phi), 1.0, s.phi), masses=((0 * s.phi, 0 * s.phi),)
    ),
)


def _gear_acceleration(value: Mapping[str, float]) -> float:
    """Return φ̈₁ = (T − M r₁/r₂)/(J₁ + J₂ r₁²/r₂²)."""
    ratio = value["r1"] / value["r2"]
    return (value["T"] - value["M"] * ratio) / (value["J1"] + value["J2"] * ratio**2)


def _gear_picture(s: SimpleNamespace) -> Picture:
    zero = 0 * s.r1
    centre = (s.r1 + s.r2, zero)
    first, second = wheel((zero, zero), s.r1, s.phi1), wheel(centre, s.r2, -s.phi2)
    return Picture(masses=((zero, zero), centre), bars=(*first, *second))


GEARS = Scene(
    name="gear-pair",
    title="Two gears that roll on one another, r1 φ1 = r2 φ2: the force between the teeth is a multiplier",
    coordinates="phi1 phi2",
    parameters=(
        Parameter("J1", 0.01, "kg m²", "moment of inertia of the driving gear and the motor"),
        Parameter("J2", 0.2, "kg m²", "moment of inertia of the driven gear and its load"),
        Parameter("r1", 0.03, "m", "radius of the driving gear"),
        Parameter("r2", 0.12, "m", "radius of the driven gear"),
        _DRIVE,
        _LOAD,
    ),
    starts=(Start("at rest", "switched on at rest", q=(0.0, 0.0), v=(0.0, 0.0)),),
    time_scale=_one,
    time_unit="s",
    source="rolling without slipping; Newton–Euler: J1 φ̈1 = T − F r1, J2 φ̈2 = F r2 − M",
    L_of=lambda s: (s.J1 * s.phi1.dot**2 + s.J2 * s.phi2.dot**2) / 2,
    forces_of=lambda s: [s.T, -s.M],
    holonomic_of=lambda s: [s.r1 * s.phi1 - s.r2 * s.phi2],
    solutions=(
        Solution(
            "φ1 = a t²/2, a = (T − M r1/r2)/(J1 + J2 r1²/r2²)",
            "at rest",
            lambda s: s.phi1,
            lambda v, t: _gear_acceleration(v) * t**2 / 2.0,
        ),
        Solution(
            "force between the teeth F = −λ = (T − J1 a)/r1",
            "at rest",
            lambda _s: -multiplier(),
            lambda v, _t: (v["T"] - v["J1"] * _gear_acceleration(v)) / v["r1"],
        ),
    ),
    horizon=10.0,
    shown=0.5,
    picture_of=_gear_picture,
)


def _rack_acceleration(value: Mapping[str, float]) -> float:
    """Return ẍ = (T/r − F)/(m + J/r²)."""
    return (value["T"] / value["r"] - value["F"]) / (value["m"] + value["J"] / value["r"] ** 2)


def _rack_picture(s: SimpleNamespace) -> Picture:
    zero = 0 * s.r
    pinion = wheel((zero, zero), s.r, s.phi)
    rack = ((s.x - 10 * s.r, -s.r), (s.x + 10 * s.r, -s.r))
    return Picture(masses=((s.x, -s.r),), bars=(*pinion, rack))


RACK = Scene(
    name="rack-and-pinion",
    title="Rack and pinion, x = r φ: a motor drives a sliding rack against a force",
    coordinates="phi x",
    parameters=(
        Parameter("J", 0.002, "kg m²", "moment of inertia of the pinion and the motor"),
        Parameter("m", 3.0, "kg", "mass of the rack"),
        Parameter("r", 0.02, "m", "radius of the pinion"),
        _DRIVE,
        Parameter("F", 10.0, "N", "force against the rack", sign="real"),
    ),
    starts=(Start("at rest", "switched on at rest", q=(0.0, 0.0), v=(0.0, 0.0)),),
    time_scale=_one,
    time_unit="s",
    source="rolling without slipping; Newton–Euler: J φ̈ = T − f r, m ẍ = f − F",
    L_of=lambda s: s.J * s.phi.dot**2 / 2 + s.m * s.x.dot**2 / 2,
    forces_of=lambda s: [s.T, -s.F],
    holonomic_of=lambda s: [s.r * s.phi - s.x],
    solutions=(
        Solution(
            "x = a t²/2, a = (T/r − F)/(m + J/r²)",
            "at rest",
            lambda s: s.x,
            lambda v, t: _rack_acceleration(v) * t**2 / 2.0,
        ),
        Solution(
            "force between the teeth f = −λ = F + m a",
            "at rest",
            lambda _s: -multiplier(),
            lambda v, _t: v["F"] + v["m"] * _rack_acceleration(v),
        ),
    ),
    horizon=10.0,
    shown=0.3,
    picture_of=_rack_picture,
)


def admittance(s: SimpleNamespace, frequency: Symbol) -> Expr:
    """Return the transfer function i/u of the DC motor without load, J s/(J L s² + J R s + K²).

    With T_m = J R/K² and T_a = L/R it is (T_m s/R)/(1 + T_m s + T_m T_a s²).

    Parameters
    ----------
    s
        The symbols J, R, L, K.
    frequency
        The complex frequency of Laplace's transform.

    Examples
    --------
    >>> from sympy import symbols
    >>> from canon.scene import find
    >>> admittance(find("dc-motor").symbols, symbols("s"))
    J*s/(J*L*s**2 + J*R*s + K**2)
    """
    return s.J * frequency / (s.J * s.L * frequency**2 + s.J * s.R * frequency + s.K**2)


def _motor_forces(s: SimpleNamespace) -> Sequence[Expr]:
    return [s.u - s.R * s.q.dot, -s.M]


def _current_and_speed(value: Mapping[str, float], t: Array) -> tuple[Array, Array]:
    """Return i(t) and ω(t) from rest: L i̇ + R i + K ω = u, J ω̇ = K i − M."""
    import numpy as np

    L, R, K, J = (value[name] for name in ("L", "R", "K", "J"))
    half, product = R / (2.0 * L), K * K / (J * L)
    root = math.sqrt(half * half - product)
    fast, slow = -half - root, -product / (half + root)
    steady = value["M"] / K
    rise = value["u"] / L
    first = (rise + slow * steady) / (fast - slow)
    second = -steady - first
    current = steady + first * np.exp(fast * t) + second * np.exp(slow * t)
    change = first * fast * np.exp(fast * t) + second * slow * np.exp(slow * t)
    return current, (value["u"] - R * current - L * change) / K


MOTOR = Scene(
    name="dc-motor",
    title="DC motor as an electromechanical system: L = L q̇²/2 + J φ̇²/2 + K φ q̇, q the charge, q̇ the current",
    coordinates="q phi",
    parameters=(
        Parameter("L", 2.0e-3, "H", "inductance of the armature"),
        Parameter("R", 1.5, "Ω", "resistance of the armature"),
        Parameter("K", 0.05, "N m/A", "torque per current, and voltage per angular velocity"),
        Parameter("J", 2.0e-4, "kg m²", "moment of inertia"),
        Parameter("u", 12.0, "V", "voltage", sign="real"),
        Parameter("M", 0.05, "N m", "torque of the load", sign="real"),
    ),
    conditions=(
        Condition(
            "the closed form is for 4 T_a < T_m, J R² > 4 L K²: it runs up without swinging",
            lambda v: v["J"] * v["R"] ** 2 > 4.0 * v["L"] * v["K"] ** 2,
        ),
    ),
    starts=(Start("switched on", "12 V at rest", q=(0.0, 0.0), v=(0.0, 0.0)),),
    time_scale=lambda value: value["J"] * value["R"] / value["K"] ** 2,
    time_unit="s",
    source="Egeland & Gravdahl, Modeling and Simulation for Automatic Control, ch. 3; period: T_m = J R/K²",
    L_of=lambda s: s.L * s.q.dot**2 / 2 + s.J * s.phi.dot**2 / 2 + s.K * s.phi * s.q.dot,
    forces_of=_motor_forces,
    integrals=(
        Integral(
            "J ω − K q + M t",
            lambda s: s.J * s.phi.dot - s.K * s.q + s.M * s.t,
            1e-12,
            "its terms grow with t",
        ),
        Integral(
            "flux L i + K φ + R q − u t",
            lambda s: s.L * s.q.dot + s.K * s.phi + s.R * s.q - s.u * s.t,
            1e-12,
            "its terms grow with t",
        ),
    ),
    solutions=(
        Solution(
            "current", "switched on", lambda s: s.q.dot, lambda v, t: _current_and_speed(v, t)[0], bound=1e-11
        ),
        Solution(
            "angular velocity",
            "switched on",
            lambda s: s.phi.dot,
            lambda v, t: _current_and_speed(v, t)[1],
            bound=1e-11,
        ),
    ),
    horizon=100.0,
    shown=5.0,
    energy_bound=1e-12,
    energy_why="the work grows with t",
)

SCENES = (SHAFT, GEARS, RACK, MOTOR)
"""The drives."""
