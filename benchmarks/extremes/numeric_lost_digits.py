"""Digits that could be lost unsaid: pulses, bumps, symmetric starts, energies of zero, units of 1e±30."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import sympy as sp
from mpmath import mp, mpf

from canon import DOP853, RK4, Gauss, Hamiltonian, Splitting, coordinates
from canon import time as t
from extremes.numeric_scales import _digits
from extremes.numeric_tools import Problem, by_taylor, motion_row

if TYPE_CHECKING:
    from collections.abc import Iterator

    from extremes.row import Row

x, y = coordinates("x y")
WIDTHS = (1, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6)
ADAPTIVE: dict[str, dict[str, Any]] = {
    "taylor": {},
    "tolerance": {"tolerance": 1e-9},
    "quad": {"precision": "quad"},
    "dop853": {"method": DOP853()},
}
STEPPED: dict[str, dict[str, Any]] = {
    "split": {"method": Splitting("kahan-li-8"), "step": 0.1},
    "gauss": {"method": Gauss(6), "step": 0.1},
    "rk4": {"method": RK4(), "step": 0.05},
}
METHODS = ADAPTIVE | STEPPED


def rows() -> Iterator[Row]:
    """Yield the rows."""
    for width in WIDTHS:
        for name, how in METHODS.items():
            said = (
                f"a force exp(−((t − 50)/w)²)/w for the time w = {width:g} about t = 50, {name}; truth by erf"
            )
            yield _row(f"pulse-{width:g}-{name}", said, partial(pulse, width), how)
        for name, how in STEPPED.items():
            said = f"a force w²/((t − 50)² + w²)/w for w = {width:g}, steps that pass over it, {name}; truth by atan"
            yield _row(f"swell-{width:g}-{name}", said, partial(swell, width), how)
        for shape in ("gauss", "tanh", "lorentz"):
            for name in ("taylor", "quad", "dop853"):
                said = f"a {shape} hill {width:g} wide at x = 20, met at t = 20 with p = 1, {name}; heyoka, 50 digits"
                yield _row(f"hill-{shape}-{width:g}-{name}", said, partial(hill, shape, width), METHODS[name])
    for power in (4, 6, 8, 10, 12, 16, 20, 24):
        for name in ("taylor", "tolerance", "quad"):
            said = f"from the origin into x^{power}/{power}: most Taylor coefficients vanish, {name}; heyoka, 60 digits"
            yield _row(f"symmetric-{power}-{name}", said, partial(flat, power), METHODS[name])
    for name, how in METHODS.items():
        said = f"a pendulum released from the horizontal: its energy is 6e-17, {name}; heyoka, 50 digits"
        yield _row(f"zero-pendulum-{name}", said, released, how)
        said = f"a parabolic comet, whose energy is 0 but for rounding, {name}; heyoka, 50 digits"
        yield _row(f"zero-parabola-{name}", said, parabola, how)
    for name, how in METHODS.items():
        said = f"a slow body with its rest energy, √(1 + p²) with p = 1e-6, {name}; heyoka, 50 digits"
        yield _row(f"rest-energy-{name}", said, slow_body, how)
    for exponent in (-30, -20, -10, 10, 20, 30):
        for name in ("taylor", "quad", "dop853", "split", "gauss"):
            said = f"{name}: an oscillator of mass 1e{exponent} and amplitude 1; truth by cos"
            yield _row(f"mass-1e{exponent}-{name}", said, partial(oscillator, exponent, 0), METHODS[name])
            said = f"{name}: an oscillator of mass 1 and amplitude 1e{exponent}; truth by cos"
            yield _row(
                f"amplitude-1e{exponent}-{name}", said, partial(oscillator, 0, exponent), METHODS[name]
            )


def _row(name: str, tried: str, problem: Any, how: dict[str, Any]) -> Row:
    return motion_row(name, tried, problem, how, samples=20, others=(), limit=120.0)


def pulse(width: float) -> Problem:
    w = sp.Rational(width)
    force = sp.exp(-(((t - 50) / w) ** 2)) / w
    H = Hamiltonian(x.momentum**2 / 2 - x * force, [x], [x.momentum])

    def area(z: mpf) -> mpf:
        """Return ∫ of √π/2 (1 + erf), which is 0 far before the pulse."""
        return mp.sqrt(mp.pi) / 2 * (z * (1 + mp.erf(z)) + mp.exp(-(z**2)) / mp.sqrt(mp.pi))

    def at(s: float) -> list[mpf]:
        wide = mpf(width)
        z, z0 = (mpf(s) - 50) / wide, -50 / wide
        p = 1 + mp.sqrt(mp.pi) / 2 * (mp.erf(z) - mp.erf(z0))
        return [mpf(s) + wide * (area(z) - area(z0)) - mp.sqrt(mp.pi) / 2 * (1 + mp.erf(z0)) * mpf(s), p]

    return Problem(H, (0.0, 1.0), (0.0, 100.0), _digits(at))


def swell(width: float) -> Problem:
    w = sp.Rational(width)
    H = Hamiltonian(x.momentum**2 / 2 - x * w / ((t - 50) ** 2 + w**2), [x], [x.momentum])

    def at(s: float) -> list[mpf]:
        wide = mpf(width)
        z, z0 = (mpf(s) - 50) / wide, -50 / wide
        area = [u * mp.atan(u) - mp.log(1 + u**2) / 2 for u in (z, z0)]
        return [mpf(s) + wide * (area[0] - area[1]) - mp.atan(z0) * mpf(s), 1 + mp.atan(z) - mp.atan(z0)]

    return Problem(H, (0.0, 1.0), (0.0, 100.0), _digits(at))


def slow_body() -> Problem:
    H = Hamiltonian(sp.sqrt(1 + x.momentum**2) + (1 - sp.exp(-x / 2)) ** 2 / 2**40, [x], [x.momentum])
    start = (0.0625, 2.0**-20)
    return Problem(H, start, (0.0, 20.0), by_taylor(H, start, 50))


def hill(shape: str, width: float) -> Problem:
    u = (x - 20) / sp.Rational(width)
    form = {"gauss": sp.exp(-(u**2)), "tanh": sp.tanh(u), "lorentz": 1 / (1 + u**2)}[shape]
    H = Hamiltonian(x.momentum**2 / 2 + form / 100, [x], [x.momentum])
    return Problem(H, (0.0, 1.0), (0.0, 40.0), by_taylor(H, (0.0, 1.0), 50))


def flat(power: int) -> Problem:
    H = Hamiltonian(x.momentum**2 / 2 + x**power / power, [x], [x.momentum])
    return Problem(H, (0.0, 1.0), (0.0, 10.0), by_taylor(H, (0.0, 1.0), 60))


def released() -> Problem:
    H = Hamiltonian(x.momentum**2 / 2 - sp.cos(x), [x], [x.momentum])
    start = (float(sp.pi / 2), 0.0)
    return Problem(H, start, (0.0, 20.0), by_taylor(H, start, 50))


def parabola() -> Problem:
    H = Hamiltonian(
        (x.momentum**2 + y.momentum**2) / 2 - 1 / sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
    )
    start = (1.0, 0.0, 0.0, 2.0**0.5)
    return Problem(H, start, (0.0, 20.0), by_taylor(H, start, 50))


def oscillator(mass: int, amplitude: int) -> Problem:
    m = sp.Rational(10) ** mass
    H = Hamiltonian(x.momentum**2 / (2 * m) + m * x**2 / 2, [x], [x.momentum])
    size = 10.0**amplitude

    def at(s: float) -> list[mpf]:
        return [mpf(size) * mp.cos(mpf(s)), -(mpf(10) ** mass) * mpf(size) * mp.sin(mpf(s))]

    return Problem(H, (size, 0.0), (0.0, 50.0), _digits(at))
