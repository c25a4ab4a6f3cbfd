"""Slow systems that were written after the choice of methods was finished, to be tried on it as they are.

Some of them do nothing for most of the span and then much at once: resonances that a drive sweeps through late, saddles
that are approached slowly, close planets, beats of three frequencies.
"""

from __future__ import annotations

import math

import sympy as sp

from canon import coordinates, time
from tests.study.slow_systems import SMALL, SlowSystem, kozai, made, moving_in, plane_kepler, resonant

__all__ = ["UNSEEN_SYSTEMS"]

HALF = sp.Rational(1, 2)


def swept(first: str, last: str, end: int, nonlinear: str = "0", strength: str = "1/200") -> SlowSystem:
    """An oscillator whose drive passes its frequency on the way from the first to the last frequency."""
    a, b, c, f = (sp.Rational(each) for each in (first, last, nonlinear, strength))
    phase = a * time + (b - a) * time**2 / (2 * end)
    return moving_in(lambda x: x**2 / 2 + c * x**4 / 4 - f * x * sp.cos(phase), (0.1, 0.0), float(end), 1e-8)


def two_planets(mass: str, second: float, span: float) -> SlowSystem:
    """Two planets of one mass about a fixed star of mass 1."""
    m = sp.Rational(mass)
    v = 1.0 / math.sqrt(second)
    return moving_in(
        lambda x, y, z, u: (
            -m / sp.sqrt(x**2 + y**2) - m / sp.sqrt(z**2 + u**2) - m**2 / sp.sqrt((x - z) ** 2 + (y - u) ** 2)
        ),
        (1.0, 0.0, 0.0, second, 0.0, float(m), -float(m) * v, 0.0),
        span,
        1e-8,
        masses=(m, m, m, m),
    )


def turning_frame(V, turning: str, y0: tuple[float, ...], span: float) -> SlowSystem:
    """H in a frame that turns: T + V − Ω (x p_y − y p_x)."""
    x, y = q = coordinates("x y")
    H = (
        (x.momentum**2 + y.momentum**2) / 2
        - sp.Rational(turning) * (x * y.momentum - y * x.momentum)
        + V(x, y)
    )
    return made(H, q, y0, span, 1e-8)


def spherical_pendulum() -> SlowSystem:
    theta, phi = q = coordinates("theta phi")
    H = theta.momentum**2 / 2 + phi.momentum**2 / (2 * sp.sin(theta) ** 2) + sp.cos(theta)
    return made(H + SMALL * sp.cos(phi) * sp.sin(theta), q, (2.5, 0.0, 0.0, 0.2), 2e4, 1e-8)


def swinging_atwood() -> SlowSystem:
    r, theta = q = coordinates("r theta")
    H = r.momentum**2 / 8 + theta.momentum**2 / (2 * r**2) + r * (3 - sp.cos(theta))
    return made(H, q, (1.0, 0.3, 0.0, 0.0), 1e4, 1e-8)


def rotator_and_oscillator() -> SlowSystem:
    """A pendulum whose rotation comes into resonance with a slow exchange with two oscillators."""
    return moving_in(
        lambda a, x, y: (
            -sp.cos(a) + x**2 / 2 + sp.Rational(101, 100) * y**2 / 2 + SMALL * (x + y) * sp.sin(a)
        ),
        (0.2, 0.5, 0.0, 1.8, 0.0, 0.0),
        2e4,
        1e-8,
    )


def chain(links: int, light: str) -> SlowSystem:
    """Masses on linear springs, one of them a little lighter: beats of all the modes."""
    y0 = (0.3, *(0.0,) * (2 * links - 1))

    def potential(*q: sp.Expr) -> sp.Expr:
        pairs = zip((sp.Integer(0), *q), (*q, sp.Integer(0)), strict=True)
        return sum(((b - a) ** 2 / 200 for a, b in pairs), sum((x**2 / 2 for x in q), sp.Integer(0)))

    return moving_in(potential, y0, 2e4, 1e-8, masses=(1,) * (links - 1) + (sp.Rational(light),))


UNSEEN_SYSTEMS: dict[str, SlowSystem] = {
    "kozai 65, e nearly none": kozai(0.0005, 65.0, 10000, 1e5),
    "kozai 88": kozai(0.05, 88.0, 40000, 1e5, 1e-8),
    "kozai 75, very weak": kozai(0.01, 75.0, 400000, 6e5, 1e-8),
    "sweep up, met late": swept("1/2", "6/5", 10000),
    "sweep down, met late": swept("3/2", "9/10", 10000),
    "sweep of a soft spring, captured": swept("11/10", "7/10", 20000, nonlinear="-1/20"),
    "sweep of a hard spring, captured": swept("9/10", "13/10", 20000, nonlinear="1/10"),
    "sweep met at the very end": swept("1/5", "1", 12000),
    "planets, near 2:1": two_planets("1/2000", 1.588, 2e4),
    "planets, close": two_planets("1/20000", 1.15, 1e4),
    "planets, far": two_planets("1/500", 3.0, 2e4),
    "bar that turns": turning_frame(
        lambda x, y: sp.log(x**2 + sp.Rational(11, 10) * y**2 + 1) / 2, "1/5", (0.6, 0.0, 0.1, 0.4), 2e4
    ),
    "anisotropic trap that turns": turning_frame(
        lambda x, y: (x**2 + sp.Rational(51, 50) * y**2) / 2 + (x**4 + y**4) / 100,
        "1/3",
        (0.7, 0.0, 0.0, 0.1),
        2e4,
    ),
    "spherical pendulum, pulled": spherical_pendulum(),
    "swinging atwood": swinging_atwood(),
    "pendulum and two oscillators": rotator_and_oscillator(),
    "chain of four": chain(4, "99/100"),
    "chain of six": chain(6, "49/50"),
    "2:3": resonant(4.0, 9.0, lambda x, y: SMALL * x**3 * y**2, (0.02, 1.0, 0.0, 0.0), 4e4),
    "1:1, quartic": resonant(
        1.0, 1.0, lambda x, y: (x**4 + 3 * x**2 * y**2) / 200, (1e-3, 1.0, 0.0, 0.0), 2e4
    ),
    "1:1:2": moving_in(
        lambda x, y, z: (x**2 + y**2 + 4 * z**2) / 2 + SMALL * (x**2 - y**2) * z,
        (0.0, 0.01, 0.7, 0.01, 0.0, 0.0),
        4e4,
    ),
    "contopoulos": resonant(1.0, 0.9, lambda x, y: -x * y**2 / 10 - x**3 / 50, (0.3, 0.01, 0.0, 0.0), 3e4),
    "barbanis": resonant(1.6, 0.9, lambda x, y: -x * y**2 / 20, (0.5, 0.001, 0.0, 0.0), 3e4),
    "well opened slowly": moving_in(
        lambda x: x**4 / 4 - sp.tanh((time - 7000) / 1500) * x**2 / 2, (0.3, 0.0), 1e4, 1e-8
    ),
    "gravity switched late": moving_in(
        lambda x: -(1 + HALF * sp.tanh((time - 9000) / 300)) * sp.cos(x), (2.9, 0.0), 1e4, 1e-8
    ),
    "narrow parametric resonance": moving_in(
        lambda x: (1 + sp.cos(2 * time) / 800) * x**2 / 2 + x**4 / 400, (1e-3, 0.0), 2e4, 1e-8
    ),
    "frequency through a subharmonic": moving_in(
        lambda x: (1 + sp.cos(sp.Rational(9, 4) * time - time**2 / 60000) / 60) * x**2 / 2 + x**4 / 100,
        (0.01, 0.0),
        15000.0,
        1e-8,
    ),
    "tides, precessing": plane_kepler(
        lambda x, y: SMALL * (x**2 - 2 * y**2) / 40 - SMALL / (x**2 + y**2), 0.1, 4e4, 1e-8
    ),
    "stark in the plane": plane_kepler(lambda x, y: SMALL * x / 20, 0.05, 4e4, 1e-8),
    "two wells, a slow partner": moving_in(
        lambda x, u: x**4 / 4 - x**2 / 2 + 10 * u**2 / 2000 + SMALL * x**2 * u,
        (0.05, 2.0, 0.0, 0.0),
        2e4,
        1e-8,
        masses=(1, 10),
    ),
    "isosceles swing": moving_in(
        lambda x, y: (
            2 * (sp.sqrt((x - 1) ** 2 + y**2) - 1) ** 2 + 2 * (sp.sqrt((x + 1) ** 2 + y**2) - 1) ** 2 + y / 5
        ),
        (1e-4, -0.8, 0.0, 0.0),
        1e4,
        1e-8,
    ),
    "nearly a hexagonal trap": moving_in(
        lambda x, y: (x**2 + y**2) / 2 + (x**3 - 3 * x * y**2) / 30 + SMALL * x**2,
        (0.5, 0.01, 0.0, 0.01),
        3e4,
    ),
}
