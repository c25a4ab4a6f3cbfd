"""Heavy tops with a fixed point: Lagrange's, symmetric about its axis, and Kovalevskaya's.

Euler's angles as Goldstein has them: precession φ, nutation θ from the vertical, spin ψ; γ is the vertical along the
body's axes, γ₁ = sin θ sin ψ, γ₂ = sin θ cos ψ, γ₃ = cos θ.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from canon.scene.formula_functions import cos, sin
from canon.scene.parts import Condition
from canon.scene.picture import Picture, ring
from canon.scene.scene import Integral, Parameter, Scene, Solution, Start
from canon.scene.systems.pendulum import GRAVITY

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import SimpleNamespace

    from sympy import Expr

    from canon.array import Array
    from canon.mechanics.lagrange.body import Body

__all__ = ["SCENES"]


def _axes(s: SimpleNamespace) -> list[tuple[Expr, Expr, Expr]]:
    """Return the body's axes along fixed ones."""
    from canon.mechanics.algebra.substitution import entry
    from canon.mechanics.lagrange.body import euler_rotation

    R = euler_rotation(s.phi, s.theta, s.psi)
    return [(entry(R, 0, i), entry(R, 1, i), entry(R, 2, i)) for i in range(3)]


def _symmetric_body(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import RigidBody, euler_rotation

    return [RigidBody(s.m, (), (s.A, s.A, s.C), euler_rotation(s.phi, s.theta, s.psi))]


def _lagrange(s: SimpleNamespace) -> Expr:
    spin = s.psi.dot + s.phi.dot * cos(s.theta)
    turning = s.A * (s.theta.dot**2 + s.phi.dot**2 * sin(s.theta) ** 2) + s.C * spin**2
    return turning / 2 - s.m * s.g * s.l * cos(s.theta)


def _height(s: SimpleNamespace) -> Expr:
    return s.m * s.g * s.l * cos(s.theta)


_NUTATING = (0.5, 0.0, 150.0)
"""θ, φ̇ and ψ̇ at the start, θ̇ = 0: the axis falls, and comes to rest again at the same height (cusps)."""


def _nutation(value: Mapping[str, float], t: Array) -> Array:
    """Return cos θ = u₁ + (u₂ − u₁) sn²(K + λt), u₁ < u₂ < u₃ the roots of u̇² = f(u) (Whittaker, § 71)."""
    import numpy as np
    from scipy.special import ellipj, ellipk

    theta, precession, rest = _NUTATING
    A, C, weight = value["A"], value["C"], value["m"] * value["g"] * value["l"]
    spin = C * (rest + precession * math.cos(theta)) / A
    b = precession * math.sin(theta) ** 2 + spin * math.cos(theta)
    u0, beta = math.cos(theta), 2.0 * weight / A
    # f = (1 − u²)(α − βu) − (b − a u)² with f(u₀) = 0, divided by u − u₀
    alpha = beta * u0 + (b - spin * u0) ** 2 / (1.0 - u0 * u0)
    quotient = np.polydiv([beta, -alpha - spin**2, 2.0 * b * spin - beta, alpha - b * b], [1.0, -u0])[0]
    low, high = sorted(float(x) for x in np.roots(quotient).real)
    modulus = (u0 - low) / (high - low)
    sn, _, _, _ = ellipj(ellipk(modulus) + math.sqrt(beta * (high - low)) / 2.0 * t, modulus)
    return low + (u0 - low) * sn**2


def _slow_precession(value: Mapping[str, float], spin: float, theta: float) -> float:
    """Return the slower root Ω of A Ω² cos θ − C ω₃ Ω + m g l = 0."""
    a, b = value["A"] * math.cos(theta), -value["C"] * spin
    c = value["m"] * value["g"] * value["l"]
    return 2.0 * c / (-b + math.sqrt(b * b - 4.0 * a * c))


_STEADY_SPIN, _STEADY_TILT = 150.0, 0.5
_TOP = {"m": 0.1, "l": 0.04, "A": 2.2e-4, "C": 0.8e-4, "g": GRAVITY.value}
_OMEGA = _slow_precession(_TOP, _STEADY_SPIN, _STEADY_TILT)


def _turn(value: Mapping[str, float]) -> float:
    """Return the period of nutation of a fast top, 2π A/(C ω₃)."""
    return 2.0 * math.pi * value["A"] / (value["C"] * _STEADY_SPIN)


def _top_picture(s: SimpleNamespace) -> Picture:
    first, second, third = _axes(s)
    centre = tuple(s.l * x for x in third)
    rim = ring(centre, [s.l * x / 2 for x in first], [s.l * x / 2 for x in second], count=24)
    end = tuple(2 * x for x in centre)
    spoke = (centre, tuple(c + s.l * x / 2 for c, x in zip(centre, first, strict=True)))
    return Picture(masses=(end,), bars=(((0.0, 0.0, 0.0), end), rim, spoke))


LAGRANGE = Scene(
    name="lagrange-top",
    title="Lagrange's top: a symmetric top that spins about a fixed point",
    coordinates="theta phi psi",
    angles="phi psi",
    parameters=(
        Parameter("m", _TOP["m"], "kg", "mass"),
        Parameter("l", _TOP["l"], "m", "distance of the centre of mass from the fixed point"),
        Parameter("A", _TOP["A"], "kg m²", "moment of inertia across the axis, about the fixed point"),
        Parameter("C", _TOP["C"], "kg m²", "moment of inertia about the axis"),
        GRAVITY,
    ),
    conditions=(
        Condition(
            "A holds m l² at least, as it is taken about the fixed point",
            lambda v: v["A"] >= v["m"] * v["l"] ** 2,
        ),
        Condition(
            "C is at most 2 (A − m l²), as no body is flatter than a disc",
            lambda v: v["C"] <= 2.0 * (v["A"] - v["m"] * v["l"] ** 2),
        ),
    ),
    starts=(
        Start("cusps", "let go with its axis at rest", q=(0.5, 0.0, 0.0), v=(0.0, 0.0, _NUTATING[2])),
        Start(
            "steady",
            "slow regular precession at 0.5 rad",
            q=(_STEADY_TILT, 0.0, 0.0),
            v=(0.0, _OMEGA, _STEADY_SPIN - _OMEGA * math.cos(_STEADY_TILT)),
            made_for="m l g A C",
        ),
        Start("loops", "pushed against its precession", q=(0.6, 0.0, 0.0), v=(0.0, -5.0, 150.0)),
    ),
    time_scale=_turn,
    time_unit="s",
    source="Goldstein, Poole & Safko, Classical Mechanics (3rd ed.), § 5.7; Whittaker, Analytical Dynamics, § 71",
    L_of=_lagrange,
    bodies_of=_symmetric_body,
    V_of=_height,
    integrals=(
        Integral("angular momentum about the vertical", lambda s: s.phi.momentum),
        Integral("angular momentum about the axis", lambda s: s.psi.momentum),
    ),
    solutions=(
        Solution("cos θ by Jacobi's sn", "cusps", lambda s: cos(s.theta), _nutation, bound=1e-11),
        Solution(
            "tilt of the regular precession stays", "steady", lambda s: s.theta, lambda _v, _t: _STEADY_TILT
        ),
        Solution(
            "rate of the regular precession",
            "steady",
            lambda s: s.phi,
            lambda v, t: _slow_precession(v, _STEADY_SPIN, _STEADY_TILT) * t,
        ),
    ),
    picture_of=_top_picture,
)


def _kovalevskaya_body(s: SimpleNamespace) -> Sequence[Body]:
    from canon.mechanics.lagrange.body import RigidBody, euler_rotation

    return [RigidBody(s.m, (), (2 * s.C, 2 * s.C, s.C), euler_rotation(s.phi, s.theta, s.psi))]


def _kovalevskaya(s: SimpleNamespace) -> Expr:
    spin = s.psi.dot + s.phi.dot * cos(s.theta)
    turning = s.C * (s.theta.dot**2 + s.phi.dot**2 * sin(s.theta) ** 2) + s.C * spin**2 / 2
    return turning - _kovalevskaya_height(s)


def _kovalevskaya_height(s: SimpleNamespace) -> Expr:
    return s.m * s.g * s.l * sin(s.theta) * sin(s.psi)


def _kovalevskaya_integral(s: SimpleNamespace) -> Expr:
    """Return |(ω₁ + iω₂)² − (m g l/C)(γ₁ + iγ₂)|²."""
    theta, psi, c = s.theta, s.psi, s.m * s.g * s.l / s.C
    precession = (s.phi.momentum - s.psi.momentum * cos(theta)) / (2 * s.C * sin(theta) ** 2)
    nutation = theta.momentum / (2 * s.C)
    w1 = precession * sin(theta) * sin(psi) + nutation * cos(psi)
    w2 = precession * sin(theta) * cos(psi) - nutation * sin(psi)
    real = w1**2 - w2**2 - c * sin(theta) * sin(psi)
    imaginary = 2 * w1 * w2 - c * sin(theta) * cos(psi)
    return real**2 + imaginary**2


def _swing(value: Mapping[str, float]) -> float:
    return 2.0 * math.pi * math.sqrt(2.0 * value["C"] / (value["m"] * value["g"] * value["l"]))


def _kovalevskaya_picture(s: SimpleNamespace) -> Picture:
    first, second, third = _axes(s)
    origin = (0.0, 0.0, 0.0)
    centre = tuple(s.l * x for x in first)
    rim = ring(origin, centre, [s.l * x for x in second], count=24)
    axis = (tuple(-s.l * x for x in third), tuple(s.l * x for x in third))
    return Picture(masses=(centre,), bars=(rim, axis, (origin, centre)))


_POLES = "the axis passes near the vertical, where Euler's angles turn fast"

KOVALEVSKAYA = Scene(
    name="kovalevskaya-top",
    title="Kovalevskaya's top: A = B = 2 C, the centre of mass in the equator; integrable",
    coordinates="theta phi psi",
    angles="phi psi",
    parameters=(
        Parameter("m", 0.8, "kg", "mass"),
        Parameter("l", 0.0075, "m", "distance of the centre of mass from the fixed point"),
        Parameter("C", 2.0e-4, "kg m²", "moment of inertia about the axis, half of those across it"),
        GRAVITY,
    ),
    conditions=(
        Condition(
            "C holds 2 m l² at least: B + C − A = C is 2 ∫x² dm along the axis through the centre of mass",
            lambda v: v["C"] >= 2.0 * v["m"] * v["l"] ** 2,
        ),
    ),
    starts=(
        Start("tumbling", "centre of mass below, pushed", q=(1.2, 0.0, -1.0), v=(4.0, 8.0, 3.0)),
        Start("slow", "hardly pushed", q=(1.3, 0.0, -1.3), v=(1.0, 2.0, 0.5)),
    ),
    time_scale=_swing,
    time_unit="s",
    source="Kowalevski, Acta Math. 12, 177 (1889), doi:10.1007/BF02592182; Whittaker, Analytical Dynamics, § 74",
    L_of=_kovalevskaya,
    bodies_of=_kovalevskaya_body,
    V_of=_kovalevskaya_height,
    integrals=(
        Integral("angular momentum about the vertical", lambda s: s.phi.momentum),
        Integral("Kovalevskaya's integral", _kovalevskaya_integral, 1e-12, _POLES),
    ),
    energy_bound=1e-12,
    energy_why=_POLES,
    picture_of=_kovalevskaya_picture,
)

SCENES = (LAGRANGE, KOVALEVSKAYA)
"""The tops."""
