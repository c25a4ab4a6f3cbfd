"""Systems of every sort with their equations written by hand, to hold what canon derives and integrates against."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import heyoka as hy
import numpy as np
import sympy as sp
from sympy.physics import mechanics as me

from canon import (
    ConstrainedLagrangian,
    GibbsAppell,
    Lagrangian,
    VectorField,
    coordinates,
    parameters,
    routhian,
)
from canon.mechanics.lagrange.body import Particle, PlanarBody, RigidBody, euler_rotation
from canon.mechanics.lagrange.newton_euler import Load, NewtonEuler, weights

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["CASES", "Case"]

t = sp.Symbol("t", real=True)
x, y, z, theta, phi, r, psi, s1, s2 = coordinates("x y z theta phi r psi s1 s2")
m, l, g, k, c, w, a, I = parameters("m l g k c w a I", positive=True)
cos, sin = sp.cos, sp.sin


@dataclass(frozen=True)
class Case:
    """A system, its start, and equations ẏ = f(t, y) of the same state, written by hand.

    ``energy``: whether one is known. ``shown``: what else is a function of the state, by name.
    """

    system: Any
    y0: tuple[float, ...]
    rates: Callable[[float, Any], Any]
    values: dict[Any, float] = field(default_factory=dict)
    span: tuple[float, float] = (0.0, 3.0)
    energy: bool = True
    shown: dict[str, Callable[[float, Any], Any]] = field(default_factory=dict)


def second_order(acceleration: Callable[[float, Any, Any], Any]) -> Callable[[float, Any], Any]:
    """Return the rates of (q, q̇)."""

    def rates(time: float, state: Any) -> Any:
        n = len(state) // 2
        return [*state[n:], *acceleration(time, state[:n], state[n:])]

    return rates


def _double_pendulum(_t: float, q: Any, v: Any) -> Any:
    d = q[0] - q[1]
    M = np.array([[2.0, np.cos(d)], [np.cos(d), 1.0]])
    f = [
        -np.sin(d) * v[1] ** 2 - 2 * 9.8 * np.sin(q[0]) - 0.3 * v[0],
        np.sin(d) * v[0] ** 2 - 9.8 * np.sin(q[1]),
    ]
    return np.linalg.solve(M, f)


def _cart(_t: float, q: Any, v: Any) -> Any:
    M = np.array([[3.0, np.cos(q[1])], [np.cos(q[1]), 1.0]])
    return np.linalg.solve(M, [np.sin(q[1]) * v[1] ** 2 - 0.5 * v[0] + np.sin(_t), -9.8 * np.sin(q[1])])


def _sphere(_t: float, q: Any, v: Any) -> Any:
    pull = np.dot(v, v) - 9.8 * q[2]  # per unit of mass and length 1
    return [-pull * q[0], -pull * q[1], -pull * q[2] - 9.8]


def _on_parabola(_t: float, q: Any, v: Any) -> Any:
    acceleration = -(4 * q[0] * v[0] ** 2 + 2 * 9.8 * q[0]) / (1 + 4 * q[0] ** 2)
    return [acceleration, 2 * v[0] ** 2 + 2 * q[0] * acceleration]


def _driven_wire(_t: float, q: Any, v: Any) -> Any:
    # along the wire r̈ − ω² r = 0, across it 2 ω ṙ
    e, n = np.array([np.cos(2 * _t), np.sin(2 * _t)]), np.array([-np.sin(2 * _t), np.cos(2 * _t)])
    return 2 * 2 * np.dot(v, e) * n


def _double_in_plane(_t: float, q: Any, v: Any) -> Any:
    # M a − Aᵀλ = f, A a = −γ in numbers
    (x1, y1, x2, y2), (u1, w1, u2, w2) = q, v
    A = np.array([[2 * x1, 2 * y1, 0, 0], [2 * (x1 - x2), 2 * (y1 - y2), 2 * (x2 - x1), 2 * (y2 - y1)]])
    gamma = np.array([2 * (u1**2 + w1**2), 2 * ((u2 - u1) ** 2 + (w2 - w1) ** 2)])
    f = np.array([0, -9.8, 0, -9.8])
    return f + A.T @ np.linalg.solve(A @ A.T, -gamma - A @ f)


def _driven_pivot(_t: float, q: Any, v: Any) -> Any:
    pivot, rate, bent = 0.3 * np.sin(2 * _t), 0.6 * np.cos(2 * _t), -1.2 * np.sin(2 * _t)
    d, e = q[0] - pivot, v[0] - rate
    lam = (-(e**2) - v[1] ** 2 + d * bent + 9.8 * q[1]) / (d**2 + q[1] ** 2)
    return [lam * d, -9.8 + lam * q[1]]


def _euler_angles(_t: float, state: Any) -> Any:
    _, b, e, p, q, n = state
    return [
        (p * np.sin(e) + q * np.cos(e)) / np.sin(b),
        p * np.cos(e) - q * np.sin(e),
        n - (p * np.sin(e) + q * np.cos(e)) * np.cos(b) / np.sin(b),
        (2.0 - 3.0) * q * n / 1.0,
        (3.0 - 1.0) * n * p / 2.0,
        (1.0 - 2.0) * p * q / 3.0,
    ]


def _of_lagrangians() -> dict[str, Case]:
    oscillator = x.dot**2 / 2 - x**2 / 2
    return {
        "a damped driven pendulum": Case(
            Lagrangian(
                m * l**2 * theta.dot**2 / 2 + m * g * l * cos(theta),
                [theta],
                forces=[-c * theta.dot + cos(w * t)],
            ),
            (0.5, -0.2),
            lambda t, y: [y[1], (-2 * 9.8 * 1.5 * np.sin(y[0]) - 0.4 * y[1] + np.cos(2 * t)) / 4.5],
            {m: 2, l: 1.5, g: 9.8, c: 0.4, w: 2},
        ),
        "an oscillator": Case(Lagrangian(oscillator, [x]), (0.3, 1.0), second_order(lambda t, q, v: -q)),
        "van der Pol's oscillator": Case(
            Lagrangian(oscillator, [x], forces=[c * (1 - x**2) * x.dot]),
            (0.1, 0.0),
            second_order(lambda t, q, v: -q + 1.5 * (1 - q**2) * v),
            {c: 1.5},
            (0.0, 8.0),
        ),
        "Duffing's oscillator": Case(
            Lagrangian(x.dot**2 / 2 + x**2 / 2 - x**4 / 4, [x], forces=[-c * x.dot + a * cos(w * t)]),
            (1.0, 0.0),
            second_order(lambda t, q, v: q - q**3 - 0.2 * v + 0.3 * np.cos(1.2 * t)),
            {c: 0.2, a: 0.3, w: 1.2},
        ),
        "smoothed dry friction": Case(
            Lagrangian(oscillator, [x], forces=[-c * sp.tanh(5 * x.dot)]),
            (1.0, 0.0),
            second_order(lambda t, q, v: -q - 0.1 * np.tanh(5 * v)),
            {c: 0.1},
        ),
        "a projectile with quadratic drag": Case(
            Lagrangian(
                m * (x.dot**2 + y.dot**2) / 2 - m * g * y,
                [x, y],
                forces=[-c * sp.sqrt(x.dot**2 + y.dot**2) * v for v in (x.dot, y.dot)],
            ),
            (0.0, 0.0, 3.0, 4.0),
            second_order(lambda t, q, v: -0.05 * np.hypot(*v) * v - np.array([0, 9.8])),
            {m: 2, c: 0.1, g: 9.8},
        ),
        "a pendulum whose length changes": Case(
            Lagrangian(theta.dot**2 * (1 + t / 10) ** 2 / 2 + g * (1 + t / 10) * cos(theta), [theta]),
            (0.5, 0.0),
            second_order(lambda t, q, v: -(0.2 * v + 9.8 * np.sin(q)) / (1 + t / 10)),
            {g: 9.8},
        ),
        "a pendulum on a shaken support": Case(
            Lagrangian(
                theta.dot**2 / 2 - a * w * sin(w * t) * theta.dot * sin(theta) + g * cos(theta), [theta]
            ),
            (0.5, 0.0),
            second_order(lambda t, q, v: -(9.8 - 0.2 * 9 * np.cos(3 * t)) * np.sin(q)),
            {g: 9.8, a: 0.2, w: 3},
        ),
        "a bead on a turning hoop": Case(
            Lagrangian(theta.dot**2 / 2 + w**2 * sin(theta) ** 2 / 2 + g * cos(theta), [theta]),
            (0.5, 0.0),
            second_order(lambda t, q, v: (16 * np.cos(q) - 9.8) * np.sin(q)),
            {g: 9.8, w: 4},
        ),
        "a damped double pendulum": Case(
            Lagrangian(
                theta.dot**2
                + phi.dot**2 / 2
                + theta.dot * phi.dot * cos(theta - phi)
                + g * (2 * cos(theta) + cos(phi)),
                [theta, phi],
                forces=[-c * theta.dot, 0],
            ),
            (0.8, -0.3, 0.0, 0.5),
            second_order(_double_pendulum),
            {g: 9.8, c: 0.3},
        ),
        "a pendulum on a driven cart": Case(
            Lagrangian(
                3 * x.dot**2 / 2 + theta.dot**2 / 2 + x.dot * theta.dot * cos(theta) + g * cos(theta),
                [x, theta],
                forces=[-c * x.dot + sin(t), 0],
            ),
            (0.0, 0.5, 0.1, 0.0),
            second_order(_cart),
            {g: 9.8, c: 0.5},
        ),
        "a charge in a magnetic field with drag": Case(
            Lagrangian(
                (x.dot**2 + y.dot**2) / 2 + k * (x * y.dot - y * x.dot) / 2,
                [x, y],
                forces=[-c * x.dot, -c * y.dot],
            ),
            (0.2, 0.0, 0.0, 1.0),
            second_order(lambda t, q, v: [3 * v[1] - 0.1 * v[0], -3 * v[0] - 0.1 * v[1]]),
            {k: 3, c: 0.1},
        ),
        "a relativistic oscillator": Case(
            Lagrangian(-sp.sqrt(1 - x.dot**2) - k * x**2 / 2, [x]),
            (1.0, 0.0),
            second_order(lambda t, q, v: -1.5 * q * (1 - v**2) ** 1.5),
            {k: 1.5},
        ),
        "an indefinite kinetic energy": Case(
            Lagrangian(x.dot * y.dot - x * y, [x, y]),
            (1.0, 0.5, 0.0, 2.0),
            second_order(lambda t, q, v: -q),
        ),
        "a mass that grows": Case(
            Lagrangian(sp.exp(c * t) * oscillator, [x]),
            (1.0, 0.0),
            second_order(lambda t, q, v: -q - 0.3 * v),
            {c: 0.3},
        ),
        "Kepler's problem with drag": Case(
            Lagrangian(
                (r.dot**2 + r**2 * phi.dot**2) / 2 + k / r, [r, phi], forces=[-c * r.dot, -c * r**2 * phi.dot]
            ),
            (1.0, 0.0, 0.0, 1.1),
            second_order(
                lambda t, q, v: [
                    q[0] * v[1] ** 2 - 1 / q[0] ** 2 - 0.05 * v[0],
                    -2 * v[0] * v[1] / q[0] - 0.05 * v[1],
                ]
            ),
            {k: 1, c: 0.05},
        ),
        "a spherical pendulum": Case(
            Lagrangian((theta.dot**2 + sin(theta) ** 2 * phi.dot**2) / 2 + g * cos(theta), [theta, phi]),
            (1.0, 0.0, 0.0, 2.0),
            second_order(
                lambda t, q, v: [
                    np.sin(q[0]) * np.cos(q[0]) * v[1] ** 2 - 9.8 * np.sin(q[0]),
                    -2 * v[0] * v[1] / np.tan(q[0]),
                ]
            ),
            {g: 9.8},
        ),
        "two masses, springs and dampers": Case(
            Lagrangian(
                (x.dot**2 + 2 * y.dot**2) / 2 - k * (x**2 + (y - x) ** 2) / 2,
                [x, y],
                forces=[-c * (x.dot - y.dot), -c * (y.dot - x.dot)],
            ),
            (1.0, 0.0, 0.0, 0.0),
            second_order(
                lambda t, q, v: [
                    -2 * q[0] + 2 * (q[1] - q[0]) - 0.3 * (v[0] - v[1]),
                    -(q[1] - q[0]) - 0.15 * (v[1] - v[0]),
                ]
            ),
            {k: 2, c: 0.3},
        ),
    }


def _of_constraints() -> dict[str, Case]:
    falling = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 - m * g * y, [x, y])
    in_space = Lagrangian((x.dot**2 + y.dot**2 + z.dot**2) / 2 - g * z, [x, y, z])
    blade = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 + k * theta.dot**2 / 2, [x, y, theta])
    rod = x**2 + y**2 - l**2
    pull = {"lambda_1": lambda t, s: -2 * (s[2] ** 2 + s[3] ** 2 - 9.8 * s[1]) / 2}
    pendulum = Case(
        ConstrainedLagrangian(falling, [rod]),
        (0.6, -0.8, 0.8, 0.6),
        second_order(
            lambda t, q, v: [
                -q[0] * (np.dot(v, v) - 9.8 * q[1]),
                -9.8 - q[1] * (np.dot(v, v) - 9.8 * q[1]),
            ]
        ),
        {m: 2, l: 1, g: 9.8},
        shown=pull,
    )
    two = Lagrangian((x.dot**2 + y.dot**2 + s1.dot**2 + s2.dot**2) / 2 - g * (y + s2), [x, y, s1, s2])
    return {
        "a pendulum in Cartesian coordinates": pendulum,
        "a pendulum whose constraint is given twice": Case(
            ConstrainedLagrangian(falling, [rod, 3 * rod]),
            pendulum.y0,
            pendulum.rates,
            pendulum.values,
            shown={"lambda_1": pull["lambda_1"], "lambda_2": lambda t, s: 0.0},
        ),
        "a spherical pendulum in Cartesian coordinates": Case(
            ConstrainedLagrangian(in_space, [x**2 + y**2 + z**2 - 1]),
            (0.6, 0.0, -0.8, 0.4, 1.0, 0.3),
            second_order(_sphere),
            {g: 9.8},
        ),
        "a great circle": Case(
            ConstrainedLagrangian(
                Lagrangian((x.dot**2 + y.dot**2 + z.dot**2) / 2, [x, y, z]), [x**2 + y**2 + z**2 - 1]
            ),
            (1.0, 0.0, 0.0, 0.0, 1.2, 0.5),
            second_order(lambda t, q, v: -np.dot(v, v) * q),
        ),
        "a bead on a parabola": Case(
            ConstrainedLagrangian(falling, [y - x**2]),
            (0.5, 0.25, 1.0, 1.0),
            second_order(_on_parabola),
            {m: 2, g: 9.8},
        ),
        "a bead on a turning wire": Case(
            ConstrainedLagrangian(
                Lagrangian(m * (x.dot**2 + y.dot**2) / 2, [x, y]), [y * cos(w * t) - x * sin(w * t)]
            ),
            (1.0, 0.0, 0.1, 2.0),
            second_order(_driven_wire),
            {m: 1.5, w: 2},
            (0.0, 1.5),
        ),
        "a pendulum in Cartesian coordinates on a driven pivot": Case(
            ConstrainedLagrangian(falling, [(x - a * sin(w * t)) ** 2 + y**2 - l**2]),
            (0.6, -0.8, 0.6 + 0.4, 0.3),
            second_order(_driven_pivot),
            {m: 2, l: 1, g: 9.8, a: 0.3, w: 2},
        ),
        "a double pendulum in Cartesian coordinates": Case(
            ConstrainedLagrangian(two, [rod, (s1 - x) ** 2 + (s2 - y) ** 2 - l**2]),
            (0.6, -0.8, 1.4, -1.4, 0.0, 0.0, 0.3, 0.4),
            second_order(_double_in_plane),
            {l: 1, g: 9.8},
        ),
        "Atwood's machine with friction": Case(
            ConstrainedLagrangian(
                Lagrangian(
                    (3 * x.dot**2 + y.dot**2) / 2 + g * (3 * x + y), [x, y], forces=[-c * x.dot, -c * y.dot]
                ),
                [x + y - l],
            ),
            (0.5, 0.5, 0.0, 0.0),
            second_order(lambda t, q, v: np.array([1.0, -1.0]) * (2 * 9.8 - 0.2 * v[0] + 0.2 * v[1]) / 4),
            {l: 1, g: 9.8, c: 0.2},
            (0.0, 1.0),
        ),
        "Chaplygin's sleigh with its centre at the blade": Case(
            ConstrainedLagrangian(blade, nonholonomic=[x.dot * sin(theta) - y.dot * cos(theta)]),
            (0.0, 0.0, 0.3, 2 * np.cos(0.3), 2 * np.sin(0.3), 0.7),
            lambda t, s: [s[3], s[4], s[5], -1.4 * np.sin(s[2]), 1.4 * np.cos(s[2]), 0.0],
            {m: 1.3, k: 0.6},
        ),
        "a skate on an incline": Case(
            ConstrainedLagrangian(
                Lagrangian(blade.L + m * g * x, [x, y, theta]),
                nonholonomic=[x.dot * sin(theta) - y.dot * cos(theta)],
            ),
            (0.0, 0.0, 0.3, 0.5 * np.cos(0.3), 0.5 * np.sin(0.3), 0.7),
            second_order(
                lambda t, q, v: [
                    2 * np.cos(q[2]) ** 2 - _ahead(q, v) * np.sin(q[2]) * v[2],
                    2 * np.cos(q[2]) * np.sin(q[2]) + _ahead(q, v) * np.cos(q[2]) * v[2],
                    0.0,
                ]
            ),
            {m: 1.3, k: 0.6, g: 2},
        ),
        "a rolling upright disc that is driven": Case(
            ConstrainedLagrangian(
                Lagrangian(
                    m * (x.dot**2 + y.dot**2) / 2 + k * theta.dot**2 / 2 + I * phi.dot**2 / 2,
                    [x, y, theta, phi],
                    forces=[0, 0, a, c],
                ),
                nonholonomic=[x.dot - l * phi.dot * cos(theta), y.dot - l * phi.dot * sin(theta)],
            ),
            (0.0, 0.0, 0.2, 0.0, 0.5 * np.cos(0.2), 0.5 * np.sin(0.2), 0.3, 1.0),
            second_order(
                lambda t, q, v: [
                    0.5 * (0.4 / (0.7 + 2 * 0.25) * np.cos(q[2]) - v[3] * v[2] * np.sin(q[2])),
                    0.5 * (0.4 / (0.7 + 2 * 0.25) * np.sin(q[2]) + v[3] * v[2] * np.cos(q[2])),
                    0.3 / 0.6,
                    0.4 / (0.7 + 2 * 0.25),
                ]
            ),
            {m: 2, k: 0.6, I: 0.7, l: 0.5, a: 0.3, c: 0.4},
        ),
        "Pars's particle": Case(
            ConstrainedLagrangian(
                Lagrangian((x.dot**2 + y.dot**2 + z.dot**2) / 2, [x, y, z]), nonholonomic=[z.dot - y * x.dot]
            ),
            (0.0, 0.4, 0.0, 1.0, 0.7, 0.4),
            second_order(
                lambda t, q, v: [
                    -q[1] * v[0] * v[1] / (1 + q[1] ** 2),
                    0.0,
                    v[1] * v[0] - q[1] ** 2 * v[0] * v[1] / (1 + q[1] ** 2),
                ]
            ),
        ),
        "a particle that a belt carries": Case(
            ConstrainedLagrangian(
                Lagrangian((x.dot**2 + y.dot**2) / 2 - k * (x**2 + y**2) / 2, [x, y]),
                nonholonomic=[x.dot - a * cos(t)],
            ),
            (0.0, 1.0, 0.5, 0.0),
            second_order(lambda t, q, v: [-0.5 * np.sin(t), -2 * q[1]]),
            {k: 2, a: 0.5},
        ),
    }


def _ahead(q: Any, v: Any) -> float:
    """Return the speed along a blade."""
    return v[0] * np.cos(q[2]) + v[1] * np.sin(q[2])


def _of_bodies() -> dict[str, Case]:
    u1, u2, p, q, n, S, X, Y = sp.symbols("u1 u2 p q n S X Y", real=True)
    blade = PlanarBody(m, (x + l * cos(theta), y + l * sin(theta)), I, theta)
    turning = [
        (p * sin(psi) + q * cos(psi)) / sin(theta),
        p * cos(psi) - q * sin(psi),
        n - (p * sin(psi) + q * cos(psi)) * cos(theta) / sin(theta),
    ]
    top = RigidBody(m, (0, 0, 0), sp.diag(1, 2, 3), rotation=euler_rotation(phi, theta, psi))
    bob = Particle(m, (l * sin(theta), -l * cos(theta)))
    bar = PlanarBody(m, (l * sin(theta), -l * cos(theta)), I, theta)
    hung = second_order(lambda t, q, v: -9.8 / 1.5 * np.sin(q))
    return {
        "Chaplygin's sleigh by Gibbs and Appell": Case(
            GibbsAppell([blade], [x, y, theta], u=[u1, u2], q_dot=[u1 * cos(theta), u1 * sin(theta), u2]),
            (0.0, 0.0, 0.2, 1.0, 0.5),
            lambda t, s: [
                s[3] * np.cos(s[2]),
                s[3] * np.sin(s[2]),
                s[4],
                0.3 * s[4] ** 2,
                -1.2 * 0.3 * s[3] * s[4] / (0.4 + 1.2 * 0.09),
            ],
            {m: 1.2, l: 0.3, I: 0.4},
            shown={"x_dot": lambda t, s: s[3] * np.cos(s[2])},
        ),
        "a free body by Gibbs and Appell": Case(
            GibbsAppell([top], [phi, theta, psi], u=[p, q, n], q_dot=turning),
            (0.1, 1.0, 0.2, 0.5, 1.0, 0.3),
            _euler_angles,
            {m: 1.0},
            (0.0, 2.0),
        ),
        "a damped pendulum by Gibbs and Appell": Case(
            GibbsAppell([bob], [theta], -m * g * l * cos(theta), forces=[-c * theta.dot]),
            (0.5, 0.0),
            second_order(lambda t, q, v: -9.8 / 1.5 * np.sin(q) - 0.3 * v / (2 * 2.25)),
            {m: 2, l: 1.5, g: 9.8, c: 0.3},
        ),
        "a driven bead by Gibbs and Appell": Case(
            GibbsAppell([Particle(m, (r * cos(w * t), r * sin(w * t)))], [r]),
            (1.0, 0.1),
            second_order(lambda t, q, v: 4 * q),
            {m: 2, w: 2},
        ),
        "a pendulum by Newton and Euler": Case(
            NewtonEuler(
                [bob], [theta], [*weights([bob], (0, -g)), Load(0, (-S * sin(theta), S * cos(theta)))], [S]
            ),
            (0.5, 0.0),
            hung,
            {m: 2, l: 1.5, g: 9.8},
            shown={"S": lambda t, s: 2 * (9.8 * np.cos(s[0]) + 1.5 * s[1] ** 2)},
        ),
        "a hanging bar by Newton and Euler": Case(
            NewtonEuler([bar], [theta], [*weights([bar], (0, -g)), Load(0, (X, Y), at=(0, 0))], [X, Y]),
            (0.5, 0.0),
            second_order(lambda t, q, v: -2 * 9.8 * 1.5 * np.sin(q) / (0.7 + 4.5)),
            {m: 2, l: 1.5, g: 9.8, I: 0.7},
        ),
        "a sliding block by Newton and Euler": Case(
            NewtonEuler(
                [Particle(m, (x, 0))], [x], [Load(0, (-k * x - c * x.dot, -m * g)), Load(0, (0, S))], [S]
            ),
            (0.5, 0.0),
            second_order(lambda t, q, v: (-3 * q - 0.3 * v) / 2),
            {m: 2, g: 9.8, c: 0.3, k: 3},
            shown={"S": lambda t, s: 2 * 9.8},
        ),
        "Kepler's problem by Routh": Case(
            routhian(Lagrangian(m * (r.dot**2 + r**2 * phi.dot**2) / 2 + k / r, [r, phi])),
            (1.0, 0.3, 0.1, 2.4),
            lambda t, s: [s[2], 2.4 / (2 * s[0] ** 2), 1.44 / s[0] ** 3 - 1 / s[0] ** 2, 0.0],
            {m: 2, k: 2},
            shown={"phi_dot": lambda t, s: 2.4 / (2 * s[0] ** 2)},
        ),
        "a damped spherical pendulum by Routh": Case(
            routhian(
                Lagrangian(
                    (theta.dot**2 + sin(theta) ** 2 * phi.dot**2) / 2 + g * cos(theta),
                    [theta, phi],
                    forces=[-c * theta.dot, 0],
                )
            ),
            (1.0, 0.0, 0.2, 1.1),
            lambda t, s: [
                s[2],
                1.1 / np.sin(s[0]) ** 2,
                1.21 * np.cos(s[0]) / np.sin(s[0]) ** 3 - 9.8 * np.sin(s[0]) - 0.2 * s[2],
                0.0,
            ],
            {g: 9.8, c: 0.2},
        ),
    }


def _of_lists() -> dict[str, Case]:
    u, v = hy.make_vars("u", "v")
    q1, u1 = me.dynamicsymbols("q1 u1")
    p1, p2 = me.dynamicsymbols("p1 p2")
    M, length, G, damping = sp.symbols("M ell G damping")
    frame, point = me.ReferenceFrame("N"), me.Point("O")
    point.set_vel(frame, 0)
    arm = frame.orientnew("A", "Axis", [q1, frame.z])
    arm.set_ang_vel(frame, u1 * frame.z)
    bob = point.locatenew("P", -length * arm.y)
    bob.v2pt_theory(point, frame, arm)
    kane = me.KanesMethod(frame, q_ind=[q1], u_ind=[u1], kd_eqs=[q1.diff() - u1])
    kane.kanes_equations([me.Particle("bob", bob, M)], [(bob, -M * G * frame.y)])
    hung = M * length**2 * q1.diff() ** 2 / 2 + M * G * length * sp.cos(q1)
    forces = [(arm, -damping * q1.diff() * frame.z)]
    arm_of = me.ReferenceFrame("B")
    arm_of.set_ang_vel(frame, q1.diff() * frame.z)
    numbers = {M: 2, length: 1.5, G: 9.8}
    return {
        "Lorenz's equations": Case(
            VectorField((10 * (y - x), x * (28 - z) - y, x * y - sp.Rational(8, 3) * z), (x, y, z)),
            (1.0, 1.0, 1.0),
            lambda t, y: [10 * (y[1] - y[0]), y[0] * (28 - y[2]) - y[1], y[0] * y[1] - 8 / 3 * y[2]],
            span=(0.0, 1.5),
            energy=False,
        ),
        "Lotka's and Volterra's equations": Case(
            VectorField((x * (a - y), y * (x - c)), (x, y)),
            (1.0, 0.5),
            lambda t, y: [y[0] * (1.5 - y[1]), y[1] * (y[0] - 0.8)],
            {a: 1.5, c: 0.8},
            energy=False,
        ),
        "a field that depends on time": Case(
            VectorField((y, -x + sp.cos(t)), (x, y)),
            (1.0, 0.5),
            lambda t, y: [y[1], -y[0] + np.cos(t)],
            energy=False,
        ),
        "one equation": Case(
            VectorField((x * (1 - x),), (x,)), (0.1,), lambda t, y: [y[0] * (1 - y[0])], energy=False
        ),
        "Euler's equations of a free top": Case(
            VectorField((-y * z, z * x, -x * y / 3), (x, y, z)),
            (0.5, 1.0, 0.3),
            lambda t, y: [-y[1] * y[2], y[2] * y[0], -y[0] * y[1] / 3],
            energy=False,
        ),
        "heyoka's own list": Case(
            [(u, v), (v, hy.cos(hy.time) - hy.par[0] * hy.sin(u))],
            (0.05, 0.025),
            lambda t, y: [y[1], np.cos(t) - 9.8 * np.sin(y[0])],
            {"par[0]": 9.8},
            energy=False,
        ),
        "SymPy's LagrangesMethod with a torque": Case(
            me.LagrangesMethod(hung, [q1], forcelist=[(arm_of, forces[0][1])], frame=frame),
            (0.5, 0.2),
            second_order(lambda t, q, v: -9.8 / 1.5 * np.sin(q) - 0.3 * v / 4.5),
            {**numbers, damping: 0.3},
        ),
        "SymPy's LagrangesMethod with a constraint": Case(
            me.LagrangesMethod(
                M * (p1.diff() ** 2 + p2.diff() ** 2) / 2 - M * G * p2,
                [p1, p2],
                hol_coneqs=[p1**2 + p2**2 - length**2],
            ),
            (0.9, -1.2, 0.8, 0.6),
            second_order(lambda t, q, v: np.array([0, -9.8]) - q * (np.dot(v, v) - 9.8 * q[1]) / 2.25),
            numbers,
        ),
        "SymPy's KanesMethod": Case(
            kane, (0.5, 0.2), second_order(lambda t, q, v: -9.8 / 1.5 * np.sin(q)), numbers, energy=False
        ),
    }


CASES = _of_lagrangians() | _of_constraints() | _of_bodies() | _of_lists()
"""By name."""
