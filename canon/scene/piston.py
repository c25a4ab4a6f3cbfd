"""The piston engine: its crank alone, with the whole inertia function or its first harmonics; all bodies with joints.

Crank radius r, rod length l, the piston's line at the distance e from the crank's axis; θ from the line of the piston,
s = r cos θ + l cos φ, r sin θ = e + l sin φ. The rod's centre of mass is a from the crank pin and b from the piston,
a + b = l. A resistance M acts against the crank, the gas pressure P against the piston's rise.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.parts import Condition, multiplier
from canon.scene.picture import Picture, ring
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import SimpleNamespace

    import numpy as np
    from numpy.typing import NDArray
    from sympy import Expr

    from canon.mechanics.body import Body

    Array = NDArray[np.float64]

__all__ = ["SCENES"]

_VALUES = {
    "m1": 1.2, "J1": 2.0e-3, "c": 0.01, "m2": 0.5, "J2": 1.4e-3, "a": 0.05, "b": 0.10, "m3": 0.35, "r": 0.04,
    "e": 0.004,
}  # fmt: skip
_PARAMETERS = (
    Parameter("m1", _VALUES["m1"], "kg", "mass of the crank"),
    Parameter("J1", _VALUES["J1"], "kg m²", "central moment of inertia of the crank"),
    Parameter("c", _VALUES["c"], "m", "from the axis to the crank's centre of mass"),
    Parameter("m2", _VALUES["m2"], "kg", "mass of the rod"),
    Parameter("J2", _VALUES["J2"], "kg m²", "central moment of inertia of the rod"),
    Parameter("a", _VALUES["a"], "m", "from the crank pin to the rod's centre of mass"),
    Parameter("b", _VALUES["b"], "m", "from the rod's centre of mass to the piston"),
    Parameter("m3", _VALUES["m3"], "kg", "mass of the piston"),
    Parameter("r", _VALUES["r"], "m", "radius of the crank"),
    Parameter("e", _VALUES["e"], "m", "offset of the piston's line", sign="real"),
    Parameter("P", 0.0, "N", "force of the gas on the piston, towards the crank", sign="real"),
    Parameter("M", 0.0, "N m", "resistance to the crank", sign="real"),
)
_TURNS = Condition(
    "the crank turns all the way round only where r + |e| is less than the rod",
    lambda v: v["r"] + abs(v.get("e", 0.0)) < v["a"] + v["b"],
)
_SPEED = 100.0


def _turn(_value: Mapping[str, float]) -> float:
    return 2.0 * math.pi / _SPEED


def _rod_sine(s: SimpleNamespace) -> Expr:
    """Return sin φ = (r sin θ − e)/l."""
    from sympy import sin

    return (s.r * sin(s.theta) - s.e) / (s.a + s.b)


def _rod_cosine(s: SimpleNamespace) -> Expr:
    from sympy import sqrt

    return sqrt(1 - _rod_sine(s) ** 2)


def _ratios(s: SimpleNamespace) -> tuple[Expr, Expr]:
    """Return k_φ = φ̇/θ̇ and k_s = ṡ/θ̇."""
    from sympy import cos, sin

    k_phi = s.r * cos(s.theta) / ((s.a + s.b) * _rod_cosine(s))
    return k_phi, -s.r * sin(s.theta) - (s.a + s.b) * _rod_sine(s) * k_phi


def _inertia(s: SimpleNamespace) -> Expr:
    """Return I(θ) = J₀ + m_A r² + (m₃ + m_B) k_s² + J_AB k_φ², the rod as two masses and J_AB = J₂ − m₂ a b."""
    length = s.a + s.b
    k_phi, k_s = _ratios(s)
    at_pin, at_piston = s.m2 * s.b / length, s.m2 * s.a / length
    rest = s.J1 + s.m1 * s.c**2 + at_pin * s.r**2
    return rest + (s.m3 + at_piston) * k_s**2 + (s.J2 - s.m2 * s.a * s.b) * k_phi**2


def _bodies(s: SimpleNamespace) -> Sequence[Body]:
    from sympy import asin, cos, sin

    from canon.mechanics.body import Particle, PlanarBody

    across, along = _rod_sine(s), _rod_cosine(s)
    crank = (s.c * cos(s.theta), s.c * sin(s.theta))
    rod = (s.r * cos(s.theta) + s.a * along, s.b * across + s.e)
    piston = (s.r * cos(s.theta) + (s.a + s.b) * along, s.e)
    return [
        PlanarBody(s.m1, crank, s.J1, s.theta),
        PlanarBody(s.m2, rod, s.J2, -asin(across)),
        Particle(s.m3, piston),
    ]


def _drawn(pin: tuple[Expr, Expr], piston: tuple[Expr, Expr], s: SimpleNamespace) -> Picture:
    from sympy import Integer

    w, h = s.r / 2, s.r * 2 / 5
    corners = ((-w, -h), (w, -h), (w, h), (-w, h), (-w, -h))
    box = tuple((piston[0] + x, piston[1] + y) for x, y in corners)
    zero = Integer(0)
    circle = ring((zero, zero), (s.r, zero), (zero, s.r))
    return Picture(masses=(pin, piston), bars=(((zero, zero), pin, piston), box), ground=(circle,))


def _crank_picture(s: SimpleNamespace) -> Picture:
    from sympy import cos, sin

    pin = (s.r * cos(s.theta), s.r * sin(s.theta))
    return _drawn(pin, (pin[0] + (s.a + s.b) * _rod_cosine(s), s.e), s)


def _reduced_energy(value: Mapping[str, float], angle: float) -> float:
    """Return I(θ) in numbers."""
    from types import SimpleNamespace

    from sympy import Float

    return float(
        _inertia(SimpleNamespace(**{k: Float(v, 30) for k, v in value.items()}, theta=Float(angle, 30)))
    )


def _speed_at_quarter(value: Mapping[str, float], _t: Array) -> float:
    """Return θ̇ at θ = π/2 from I(θ) θ̇² = I(0) ω², where neither P nor M acts."""
    ratio = _reduced_energy(value, 0.0) / _reduced_energy(value, math.pi / 2.0)
    return _SPEED * math.sqrt(ratio)


def _half_pi() -> Expr:
    from sympy import pi

    return pi / 2


ENGINE = Scene(
    name="piston-engine",
    title="Piston engine by its crank angle alone: L = I(θ) θ̇²/2 with the whole inertia function",
    coordinates="theta",
    angles="theta",
    parameters=_PARAMETERS,
    conditions=(_TURNS,),
    starts=(Start("running", "100 rad/s at the top, nothing drives it", q=(0.0,), v=(_SPEED,)),),
    time_scale=_turn,
    time_unit="s",
    source="kinetic energy by the transmission ratios φ̇/θ̇ and ṡ/θ̇; bodies by their places",
    L_of=lambda s: _inertia(s) * s.theta.dot**2 / 2,
    bodies_of=_bodies,
    forces_of=lambda s: [-s.P * _ratios(s)[1] - s.M],
    integrals=(
        Integral(
            "energy less the work −P s − M θ", lambda s: _inertia(s) * s.theta.dot**2 / 2 + _given_work(s)
        ),
    ),
    solutions=(
        Solution(
            "θ̇ at θ = π/2 by I(θ) θ̇² = I(0) ω²",
            "running",
            lambda s: s.theta.dot,
            _speed_at_quarter,
            event=lambda s: s.theta - _half_pi(),
            periods=1.0,
            bound=1e-13,
        ),
    ),
    picture_of=_crank_picture,
    shown=1.0,
)


def _given_work(s: SimpleNamespace) -> Expr:
    from sympy import cos

    return s.P * (s.r * cos(s.theta) + (s.a + s.b) * _rod_cosine(s)) + s.M * s.theta


def _harmonics(s: SimpleNamespace) -> tuple[Expr, Expr]:
    """Return A and B of I(θ) ≈ A − B cos 2θ, to first order in r/l, at e = 0."""
    length = s.a + s.b
    sliding = (s.m3 + s.m2 * s.a / length) * s.r**2
    turning = (s.J2 - s.m2 * s.a * s.b) * (s.r / length) ** 2
    rest = s.J1 + s.m1 * s.c**2 + s.m2 * s.b / length * s.r**2
    return rest + (sliding + turning) / 2, (sliding - turning) / 2


def _first_order(s: SimpleNamespace) -> Expr:
    from sympy import cos

    A, B = _harmonics(s)
    return (A - B * cos(2 * s.theta)) * s.theta.dot**2 / 2


_FIRST = tuple(c for c in _PARAMETERS if c.name not in ("e", "P"))

TRUNCATED = Scene(
    name="piston-engine-first-order",
    title="Piston engine with the first harmonics of its inertia, I(θ) ≈ A − B cos 2θ",
    coordinates="theta",
    angles="theta",
    parameters=_FIRST,
    conditions=(_TURNS,),
    starts=(Start("running", "100 rad/s at the top, nothing drives it", q=(0.0,), v=(_SPEED,)),),
    time_scale=_turn,
    time_unit="s",
    source="first order in r/l and no offset",
    L_of=_first_order,
    forces_of=lambda s: [-s.M],
    picture_of=lambda s: _truncated_picture(s),
    solutions=(
        Solution(
            "θ̇ at θ = π/2: ω √((A − B)/(A + B))",
            "running",
            lambda s: s.theta.dot,
            lambda v, _t: _harmonic_speed(v),
            event=lambda s: s.theta - _half_pi(),
            periods=1.0,
            bound=1e-13,
        ),
    ),
    shown=1.0,
)


def _truncated_picture(s: SimpleNamespace) -> Picture:
    from types import SimpleNamespace

    return _crank_picture(SimpleNamespace(**vars(s), e=0 * s.r))


def _harmonic_speed(value: Mapping[str, float]) -> float:
    from types import SimpleNamespace

    A, B = _harmonics(SimpleNamespace(**value))
    return _SPEED * math.sqrt(float((A - B) / (A + B)))


def _constant_torque(value: Mapping[str, float], t: Array) -> Array:
    """Return λ = B ω² sin 2θ, the torque that keeps θ = ω t."""
    from types import SimpleNamespace

    import numpy as np

    _, B = _harmonics(SimpleNamespace(**value))
    return float(B) * value["w"] ** 2 * np.sin(2.0 * value["w"] * t)


DRIVEN = Scene(
    name="piston-engine-constant-speed",
    title="Piston engine kept at constant speed, θ = ω t: the driving torque is a multiplier, B ω² sin 2θ",
    coordinates="theta",
    parameters=(
        *(c for c in _FIRST if c.name != "M"),
        Parameter("w", _SPEED, "rad/s", "angular velocity"),
    ),
    conditions=(_TURNS,),
    starts=(Start("running", "at the top", q=(0.0,), v=(_SPEED,)),),
    time_scale=lambda value: 2.0 * math.pi / value["w"],
    time_unit="s",
    source="first order in r/l and no offset; I(θ) ≈ A − B cos 2θ",
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


def _whole_bodies(s: SimpleNamespace) -> Sequence[Body]:
    from sympy import Integer

    from canon.mechanics.body import Particle, PlanarBody

    return [
        PlanarBody(s.m1, (s.x1, s.y1), s.J1, s.theta),
        PlanarBody(s.m2, (s.x2, s.y2), s.J2, s.phi),
        Particle(s.m3, (s.s, Integer(0))),
    ]


def _joints(s: SimpleNamespace) -> Sequence[Expr]:
    from sympy import cos, sin

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
    """Return λ₁ = m₃ s̈ at θ = π/2, s̈ = k_s′ θ̇² + k_s θ̈, I θ̈ = −I′ θ̇²/2."""
    from types import SimpleNamespace

    from sympy import Float, Symbol, pi, sympify

    from canon.mechanics.substitution import exchanged

    theta = Symbol("theta", real=True)
    s = SimpleNamespace(**{k: Float(v, 30) for k, v in value.items()}, theta=theta)
    inertia, k_s = _inertia(s), _ratios(s)[1]

    def at(f: Expr, angle: Expr | int) -> float:
        return float(exchanged(f, {theta: sympify(angle, strict=True)}))

    quarter = pi / 2
    square = _SPEED**2 * at(inertia, 0) / at(inertia, quarter)
    slowing = at(inertia.diff(theta), quarter) / (2.0 * at(inertia, quarter))
    change = at(k_s.diff(theta), quarter) - at(k_s, quarter) * slowing
    return value["m3"] * change * square


def _at_the_top() -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return the seven coordinates and velocities at θ = 0."""
    v = _VALUES
    length = v["a"] + v["b"]
    phi = math.asin(-v["e"] / length)
    k_phi = v["r"] / (length * math.cos(phi))
    speeds = (0.0, v["c"], -v["a"] * math.sin(phi) * k_phi, v["b"] * math.cos(phi) * k_phi)
    piston = -length * math.sin(phi) * k_phi
    place = (
        v["c"], 0.0, v["r"] + v["a"] * math.cos(phi), v["b"] * math.sin(phi) + v["e"], 0.0, phi,
        v["r"] + length * math.cos(phi),
    )  # fmt: skip
    return place, tuple(_SPEED * rate for rate in (*speeds, 1.0, k_phi, piston))


def _whole_picture(s: SimpleNamespace) -> Picture:
    from sympy import cos, sin

    return _drawn((s.r * cos(s.theta), s.r * sin(s.theta)), (s.s, s.e), s)


WHOLE = Scene(
    name="piston-engine-joints",
    title="Piston engine with all its bodies: seven coordinates, six constraints, joint forces as multipliers",
    coordinates="x1 y1 x2 y2 theta phi s",
    angles="theta",
    parameters=_PARAMETERS,
    conditions=(_TURNS,),
    starts=(
        Start("running", "100 rad/s at the top, nothing drives it", q=_at_the_top()[0], v=_at_the_top()[1]),
    ),
    time_scale=_turn,
    time_unit="s",
    source="Lagrange's equations of the first kind; reactions by Newton's second law body by body",
    bodies_of=_whole_bodies,
    forces_of=lambda s: [*[0 * s.M] * 4, -s.M, 0 * s.M, -s.P],
    holonomic_of=_joints,
    solutions=(
        Solution(
            "θ̇ at θ = π/2 by I(θ) θ̇² = I(0) ω²",
            "running",
            lambda s: s.theta.dot,
            _speed_at_quarter,
            event=lambda s: s.theta - _half_pi(),
            periods=1.0,
            bound=1e-12,
        ),
        Solution(
            "force on the piston at θ = π/2, λ₁ = m₃ s̈",
            "running",
            lambda _s: multiplier(1),
            _piston_force,
            event=lambda s: s.theta - _half_pi(),
            periods=1.0,
            bound=1e-11,
        ),
    ),
    picture_of=_whole_picture,
    shown=1.0,
)

SCENES = (ENGINE, TRUNCATED, DRIVEN, WHOLE)
"""The piston engines."""
