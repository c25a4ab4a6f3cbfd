"""Scales: masses, lengths, energies, denormal numbers, angles of many turns."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from mpmath import mp, mpf

from canon import Hamiltonian, Splitting, Taylor, coordinates, propagate
from extremes.numeric_tools import Problem, by_taylor, motion_row, truth_from
from extremes.row import Row, refused

if TYPE_CHECKING:
    from collections.abc import Iterator

x, y = coordinates("x y")
SPLIT = Splitting("kahan-li-8")


def rows() -> Iterator[Row]:
    """Yield the rows."""
    for exponent in (12, -12):
        yield motion_row(
            f"mass-ratio-1e{exponent}",
            f"two bodies of mass ratio 1e{exponent} about each other, 3 revolutions, Taylor()",
            partial(two_bodies, exponent),
            {},
        )
        yield motion_row(
            f"mass-ratio-1e{exponent}-split",
            f"the same, ratio 1e{exponent}, splitting of order 8",
            partial(two_bodies, exponent),
            {"method": SPLIT, "step": 0.02},
            others=(),
        )
    for exponent in (150, -150):
        size = 10.0**exponent
        yield Row(
            f"lengths-1e{exponent}",
            f"a circular orbit of radius 1e{exponent} and speed 1: r³ is beyond 1e±308",
            partial(refuses, exponent),
            _plainly(partial(circle, exponent)),
        )
        yield motion_row(
            f"lengths-1e{exponent}-extended",
            "the same with precision='extended', as the error proposes",
            partial(circle, exponent),
            {"method": SPLIT, "step": 0.02 * size, "precision": "extended"},
            others=(),
        )
        yield motion_row(
            f"energy-1e{2 * exponent}",
            f"an oscillator of amplitude 1e{exponent}, energy 1e{2 * exponent}, splitting of order 8",
            partial(oscillator, size),
            {"method": SPLIT, "step": 0.1},
        )
    yield motion_row(
        "lengths-1e60",
        "the circular orbit with radius 1e60, splitting of order 8",
        partial(circle, 60),
        {"method": SPLIT, "step": 0.02e60},
    )
    yield Row(
        "lengths-1e60-taylor",
        "the same, Taylor(): its 20th coefficient is beyond 1e-308",
        lambda: refused(lambda: propagated(circle(60)), ValueError, holds="time scale of 1e+60"),
    )
    for size in (1e-310, 1e-318):
        yield motion_row(
            f"denormal-{size!r}",
            f"an oscillator of amplitude {size!r}, a denormal number; splitting of order 8",
            partial(oscillator, size),
            {"method": SPLIT, "step": 0.1},
        )
    for angle in (1e8, 1e16, 1e22):
        for name, how in (("taylor", {}), ("split", {"method": SPLIT, "step": 0.05})):
            yield motion_row(
                f"angle-{angle:g}-{name}",
                f"a pendulum that starts at an angle of {angle:g} rad, {name}; doubles there are "
                f"{np.spacing(angle):.2g} apart",
                partial(pendulum, angle),
                how,
                others=("SciPy DOP853", "heyoka") if name == "taylor" else (),
            )
    yield Row(
        "angle-1e16-double-double",
        "the same from 1e16 rad in double-double, whose sines end at 2⁴⁵",
        lambda: refused(
            lambda: propagated(pendulum(1e16), method=SPLIT, step=0.05, precision="double-double"),
            ValueError,
            holds="double-double has sines",
        ),
    )
    yield motion_row(
        "angle-1e16-quad",
        "the same from 1e16 rad, Taylor in quadruple precision",
        partial(pendulum, 1e16),
        {"precision": "quad"},
        others=(),
        limit=120,
    )
    yield motion_row(
        "angle-spun-up",
        "a pendulum with p = 1e4 turns 1600 times in t = 1",
        partial(spinning, 1e4),
        {},
    )


def _plainly(problem: object) -> dict[str, object]:
    from extremes.numeric_tools import dop853, heyoka

    return {"SciPy DOP853": lambda: dop853(problem(), 10), "heyoka": lambda: heyoka(problem(), 10)}


def propagated(given: Problem, **how: object) -> object:
    return propagate(given.hamiltonian, given.span, given.y0, samples=10, **how).final


def refuses(exponent: int) -> object:
    first = refused(
        lambda: propagated(circle(exponent), method=SPLIT, step=0.02 * 10.0**exponent),
        ValueError,
        holds="1e±308",
    )
    second = refused(lambda: propagated(circle(exponent), method=Taylor()), ValueError, holds="1e±308")
    return first if first.right is False else second


def two_bodies(exponent: int) -> Problem:
    a, b, c, d = coordinates("a b c d")
    p = [s.momentum for s in (a, b, c, d)]
    m = sp.Rational(10) ** exponent
    H = Hamiltonian(
        (p[0] ** 2 + p[1] ** 2) / 2
        + (p[2] ** 2 + p[3] ** 2) / (2 * m)
        - m / sp.sqrt((a - c) ** 2 + (b - d) ** 2) / (1 + m),
        [a, b, c, d],
        p,
    )
    # Relative motion r̈ = −r/r³ from r = 1 with speed 1.1, the centre of mass at rest.
    ratio = float(m / (1 + m)), float(1 / (1 + m))
    mu = float(m / (1 + m))
    start = (ratio[0], 0.0, -ratio[1], 0.0, 0.0, 1.1 * mu, 0.0, -1.1 * mu)
    return Problem(H, start, (0.0, 25.0), by_taylor(H, start, 40))


def circle(exponent: int) -> Problem:
    mu = sp.Rational(10) ** exponent
    H = Hamiltonian(
        (x.momentum**2 + y.momentum**2) / 2 - mu / sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
    )
    start = (mu, 0, 0, 1)

    def at(t: float) -> list[mpf]:
        r = mpf(10) ** exponent
        angle = mpf(t) / r
        return [r * mp.cos(angle), r * mp.sin(angle), -mp.sin(angle), mp.cos(angle)]

    return Problem(H, start, (0.0, 20.0 * 10.0**exponent), _digits(at))


def _digits(at: object) -> object:
    def truth(t: np.ndarray) -> np.ndarray:
        with mp.workdps(60):
            return truth_from(at)(t)

    return truth


def oscillator(size: float) -> Problem:
    H = Hamiltonian(x.momentum**2 / 2 + x**2 / 2, [x], [x.momentum])
    return Problem(
        H,
        (size, 0.0),
        (0.0, 50.0),
        _digits(lambda t: [mpf(size) * mp.cos(mpf(t)), -mpf(size) * mp.sin(mpf(t))]),
    )


def pendulum(angle: float) -> Problem:
    H = Hamiltonian(x.momentum**2 / 2 - sp.cos(x), [x], [x.momentum])
    return Problem(H, (angle, 0.0), (0.0, 10.0), by_taylor(H, (angle, 0.0), 60))


def spinning(momentum: float) -> Problem:
    H = Hamiltonian(x.momentum**2 / 2 - sp.cos(x), [x], [x.momentum])
    return Problem(H, (0.0, momentum), (0.0, 1.0), by_taylor(H, (0.0, momentum), "quad"))
