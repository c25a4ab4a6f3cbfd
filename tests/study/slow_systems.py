"""Systems with slow times: what happens to them happens long after a hundred periods."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

from canon import Hamiltonian, coordinates, time

if TYPE_CHECKING:
    from canon.expression.symbols.symbol import Coordinate

Potential = Callable[..., sp.Expr]


@dataclass(frozen=True)
class SlowSystem:
    """H, a start, a span and an accuracy of the energy."""

    hamiltonian: Hamiltonian
    y0: tuple[float, ...]
    span: float
    accuracy: float = 1e-9


def moving_in(
    potential: Potential, y0: tuple[float, ...], span: float, accuracy: float = 1e-9, masses=None
) -> SlowSystem:
    """H = Σ p²/2m + V(q), V a function of the coordinates."""
    n = len(y0) // 2
    q = coordinates(",".join("xyzuvwab"[:n]) + ",")
    m = masses or (1,) * n
    H = sum((each.momentum**2 / (2 * mass) for each, mass in zip(q, m, strict=True)), sp.Integer(0))
    return made(H + potential(*q), q, y0, span, accuracy)


def made(
    H: sp.Expr, q: tuple[Coordinate, ...], y0: tuple[float, ...], span: float, accuracy: float = 1e-9
) -> SlowSystem:
    return SlowSystem(Hamiltonian(H, q, [each.momentum for each in q]), y0, span, accuracy)


def kozai(e: float, degrees: float, weak: int, span: float, accuracy: float = 1e-10) -> SlowSystem:
    """Kozai's motion about a star in the quadrupole of a far body: e grows slowly and falls again."""
    i, v = math.radians(degrees), math.sqrt((1 + e) / (1 - e))
    return moving_in(
        lambda x, y, z: -1 / sp.sqrt(x**2 + y**2 + z**2) + (z**2 - (x**2 + y**2) / 2) / weak,
        (1 - e, 0.0, 0.0, 0.0, v * math.cos(i), v * math.sin(i)),
        span,
        accuracy,
    )


def plane_kepler(disturbance: Potential, e: float, span: float, accuracy: float = 1e-9) -> SlowSystem:
    v = math.sqrt((1 + e) / (1 - e))
    return moving_in(
        lambda x, y: -1 / sp.sqrt(x**2 + y**2) + disturbance(x, y), (1 - e, 0.0, 0.0, v), span, accuracy
    )


def fput(cubic: sp.Expr, quartic: sp.Expr, amplitude: float, span: float) -> SlowSystem:
    """Eight masses on springs that are not quite linear, all energy in the slowest mode."""
    n = 8

    def potential(*q: sp.Expr) -> sp.Expr:
        links = zip((sp.Integer(0), *q), (*q, sp.Integer(0)), strict=True)
        stretch = [b - a for a, b in links]
        return sum((d**2 / 2 + cubic * d**3 / 3 + quartic * d**4 / 4 for d in stretch), sp.Integer(0))

    places = tuple(amplitude * math.sin(math.pi * k / (n + 1)) for k in range(1, n + 1))
    return moving_in(potential, (*places, *(0.0,) * n), span)


def resonant(first: float, second: float, coupling: Potential, y0: tuple[float, ...], span: float):
    return moving_in(lambda x, y: first * x**2 / 2 + second * y**2 / 2 + coupling(x, y), y0, span)


def foucault() -> SlowSystem:
    x, y = q = coordinates("x y")
    H = (x.momentum**2 + y.momentum**2 + x**2 + y**2) / 2 + sp.Rational(1, 1000) * (
        y * x.momentum - x * y.momentum
    )
    return made(H + (x**2 + y**2) ** 2 / 40, q, (1.0, 0.0, 0.0, 0.01), 2e4)


def magnetic_drift() -> SlowSystem:
    """Fast gyration, and a slow drift about the hill of the potential."""
    x, y = q = coordinates("x y")
    H = ((x.momentum + 5 * y / 2) ** 2 + (y.momentum - 5 * x / 2) ** 2) / 2 + sp.cos(x) / 50 + sp.cos(y) / 70
    return made(H, q, (0.5, 0.2, 0.3, 0.4), 2e4)


def double_pendulum() -> SlowSystem:
    """Small swings that beat: nearly equal frequencies, as the lower mass is light."""
    a, b = q = coordinates("alpha beta")
    m = sp.Rational(1, 200)
    d = sp.cos(a - b)
    det = 1 + m - m * d**2
    T = (m * a.momentum**2 + (1 + m) * b.momentum**2 - 2 * m * d * a.momentum * b.momentum) / (2 * m * det)
    return made(T - (1 + m) * sp.cos(a) - m * sp.cos(b), q, (0.1, 0.0, 0.0, 0.0), 2e4)


def slow_partner(V: Potential, y0: tuple[float, float], mass: float = 1e4) -> SlowSystem:
    """V(x, u) where u is a heavy oscillator a thousand times slower, so that x crosses its separatrix."""
    return moving_in(
        lambda x, u: V(x, u) + mass * sp.Rational(1, 10**6) * u**2 / 2,
        (y0[0], 1.0, y0[1], 0.0),
        3e4,
        masses=(1, mass),
    )


SMALL = sp.Rational(1, 1000)

SYSTEMS: dict[str, SlowSystem] = {
    "kozai 86": kozai(0.02, 86.0, 20000, 8e4),
    "kozai 70": kozai(0.02, 70.0, 20000, 8e4),
    "kozai 60, strong": kozai(0.01, 60.0, 2000, 2e4, 1e-8),
    "kozai 50": kozai(0.001, 50.0, 20000, 8e4),
    "kozai, weak": kozai(0.02, 80.0, 100000, 3e5, 1e-9),
    "beats": resonant(
        1.0, 1.0, lambda x, y: SMALL * x * y + (x**4 + 4 * y**4) / 100, (1.0, 0.0, 0.0, 0.0), 2e4
    ),
    "1:1": resonant(1.0, 1.001, lambda x, y: SMALL * x**2 * y**2, (1.0, 0.001, 0.0, 0.0), 5e4),
    "1:2": resonant(1.0, 4.0, lambda x, y: 5 * SMALL * x**2 * y, (0.001, 1.0, 0.0, 0.0), 2e4),
    "1:3": resonant(1.0, 9.0, lambda x, y: 5 * SMALL * x**3 * y, (1.0, 0.01, 0.0, 0.0), 3e4),
    "1:4": resonant(1.0, 16.0, lambda x, y: SMALL * x**4 * y, (2.0, 0.0, 0.0, 0.0), 3e4),
    "1:2, from the slow mode": resonant(
        1.0, 4.0, lambda x, y: 2 * SMALL * x**2 * y, (1.0, 0.0, 0.0, 0.0), 3e4
    ),
    "1:2, detuned": resonant(1.0, 4.005, lambda x, y: 5 * SMALL * x**2 * y, (0.01, 1.0, 0.0, 0.0), 3e4),
    "three waves": moving_in(
        lambda x, y, z: (x**2 + 4 * y**2 + 9 * z**2) / 2 + SMALL * x * y * z,
        (0.01, 0.01, 1.0, 0.0, 0.0, 0.0),
        5e4,
    ),
    "hénon–heiles, low": moving_in(
        lambda x, y: (x**2 + y**2) / 2 + x**2 * y - y**3 / 3, (0.04, 0.0, 0.0, 0.001), 5e4
    ),
    "two pendulums": moving_in(
        lambda x, y: -sp.cos(x) - sp.cos(y) + SMALL * (x - y) ** 2 / 2, (1.5, 0.0, 0.0, 0.0), 2e4
    ),
    "pendulum near its top": moving_in(
        lambda x, y: -sp.cos(x) + y**2 / 2 + SMALL * y * sp.sin(x), (math.pi - 1e-8, 0.1, 0.0, 0.0), 1e4
    ),
    "double well, low over its saddle": moving_in(
        lambda x, y: x**4 / 4 - x**2 / 2 + y**2 / 2 + SMALL * x**2 * y, (0.01, 0.1, 0.0, 0.0), 2e4, 1e-8
    ),
    "fput, cubic": fput(sp.Rational(1, 4), sp.Integer(0), 1.0, 1e4),
    "fput, quartic": fput(sp.Integer(0), sp.Rational(1, 4), 1.0, 1e4),
    "slow gravity": slow_partner(lambda x, u: -(1 + u / 2) * sp.cos(x), (2.0, 0.0)),
    "slow tilt": slow_partner(lambda x, u: x**4 / 4 - x**2 / 2 + x * u / 3, (1.2, 0.0)),
    "slow hardening": slow_partner(lambda x, u: (2 + sp.Rational(19, 10) * u) ** 2 * x**2 / 2, (1.0, 0.0)),
    "elastic pendulum": moving_in(
        lambda x, y: 3 * (sp.sqrt(x**2 + y**2) - 1) ** 2 / 2 + y, (1e-4, -1.5, 0.0, 0.0), 1e4
    ),
    "wilberforce": resonant(1.0, 1.0, lambda x, y: SMALL * x * y / 2, (1.0, 0.0, 0.0, 0.0), 3e4),
    "oblate planet": plane_kepler(lambda x, y: -SMALL / sp.sqrt(x**2 + y**2) ** 3, 0.3, 2e4),
    "relativistic": plane_kepler(lambda x, y: -SMALL / (x**2 + y**2), 0.5, 2e4),
    "tidal": plane_kepler(lambda x, y: -SMALL / 100 / (x**2 + y**2) ** 3, 0.4, 5e4),
    "stark": moving_in(
        lambda x, y, z: -1 / sp.sqrt(x**2 + y**2 + z**2) + SMALL * z / 20,
        (0.9, 0.0, 0.1, 0.0, 0.6, 0.8),
        4e4,
        1e-8,
    ),
    "zeeman": moving_in(
        lambda x, y, z: -1 / sp.sqrt(x**2 + y**2 + z**2) + SMALL * (x**2 + y**2) / 8,
        (0.9, 0.0, 0.0, 0.0, 0.6, 0.85),
        4e4,
        1e-8,
    ),
    "logarithmic": moving_in(
        lambda x, y: sp.log(x**2 + y**2 / sp.Rational(49, 50) + sp.Rational(1, 100)) / 2,
        (1.0, 0.01, 0.0, 0.05),
        2e4,
    ),
    "isotropic, disturbed": moving_in(
        lambda x, y, z: (x**2 + y**2 + z**2) / 2 + SMALL * (x**2 * y**2 + 2 * z**4),
        (1.0, 0.5, 0.01, 0.0, 0.3, 0.0),
        3e4,
    ),
    "toda, disturbed": moving_in(
        lambda x, y: (
            (sp.exp(2 * sp.sqrt(3) * x + 2 * y) + sp.exp(2 * y - 2 * sp.sqrt(3) * x) + sp.exp(-4 * y)) / 24
            + SMALL * x**4
        ),
        (0.5, 0.1, 0.0, 0.2),
        2e4,
    ),
    "foucault": foucault(),
    "magnetic drift": magnetic_drift(),
    "double pendulum": double_pendulum(),
    "gravity that changes": moving_in(
        lambda x: -(1 + sp.Rational(3, 10) * sp.sin(time / 1000)) * sp.cos(x), (2.5, 0.0), 1e4, 1e-8
    ),
    "weight that is lost": moving_in(lambda x: (1 + time / 2000) * x**2 / 2, (1.0, 0.0), 1e4, 1e-8),
    "well that tilts": moving_in(
        lambda x: x**4 / 4 - x**2 / 2 + x * sp.sin(time / 2000) / 2, (1.2, 0.0), 2e4, 1e-8
    ),
    "swing that is pumped": moving_in(
        lambda x: -(1 + sp.cos(2 * time) / 500) * sp.cos(x), (1e-4, 0.0), 2e4, 1e-8
    ),
    "weak resonant drive": moving_in(
        lambda x: x**2 / 2 + x**4 / 400 - x * sp.cos(time) / 500, (0.5, 0.0), 1e4, 1e-8
    ),
}
