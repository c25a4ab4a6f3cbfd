"""Separatrices, stiffness, steps beyond stability, coordinates that are singular."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp
from mpmath import mp, mpf

from canon import RK4, Gauss, Hamiltonian, Splitting, coordinates, propagate
from canon.flow import NonFiniteStateError
from extremes.numeric_tools import Problem, by_taylor, motion_row
from extremes.row import Row, refused

if TYPE_CHECKING:
    from collections.abc import Iterator

x, y = coordinates("x y")
PENDULUM = Hamiltonian(x.momentum**2 / 2 - sp.cos(x), [x], [x.momentum])
SPLIT = Splitting("kahan-li-8")


def rows() -> Iterator[Row]:
    """Yield the rows."""
    for name, momentum in (("below", 2 - 2.5e-13), ("above", 2 + 2.5e-13), ("on", 2.0)):
        for kind, how in (("taylor", {}), ("split", {"method": SPLIT, "step": 0.1})):
            yield motion_row(
                f"separatrix-{name}-{kind}",
                f"a pendulum with p = {momentum!r} at the bottom, {name} the separatrix, t = 0 … 60, {kind}",
                partial(swing, 0.0, momentum, 60.0),
                how,
                others=("SciPy DOP853", "heyoka") if kind == "taylor" else (),
            )
    yield motion_row(
        "upright",
        "a pendulum at rest at the double nearest to π, t = 0 … 60",
        partial(swing, float(np.pi), 0.0, 60.0),
        {},
    )
    for kind, how in (
        ("taylor", {}),
        ("split", {"method": SPLIT, "step": 5e-6}),
        ("gauss", {"method": Gauss(6), "step": 2e-5}),
        ("gauss-coarse", {"method": Gauss(2), "step": 1e-3}),
    ):
        yield motion_row(
            f"stiff-spring-{kind}",
            f"a spring pendulum with k = 1e10 (ω = 1e5), t = 0 … 1, {kind}",
            stiff,
            how,
            others=("SciPy DOP853", "heyoka") if kind == "taylor" else (),
            limit=120,
        )
    yield Row(
        "step-beyond-stability",
        "an oscillator, Verlet with h ω = 2.01 over 10⁴ steps: the limit is 2",
        lambda: refused(
            lambda: (
                propagate(OSCILLATOR, (0, 20100), [1.0, 0.0], method=Splitting("verlet"), step=2.01).final
            ),
            NonFiniteStateError,
        ),
    )
    for name, h in (("2.001", 2.001), ("1.999", 1.999), ("1.5", 1.5)):
        yield motion_row(
            f"step-{name}",
            f"an oscillator, Verlet with h ω = {name} over 200 steps (closed form)",
            partial(oscillator, 200 * h),
            {"method": Splitting("verlet"), "step": h},
            others=(),
        )
    yield motion_row(
        "rk4-unstable",
        "an oscillator, RK4 with h ω = 2.9 (limit 2.83), 60 steps",
        partial(oscillator, 174.0),
        {"method": RK4(), "step": 2.9},
        others=(),
    )
    yield motion_row(
        "resonant-step",
        "Hénon and Heiles, E = 1/12, Verlet with h ω = 2π/3, a third-order resonance of the step, 200 steps",
        henon,
        {"method": Splitting("verlet"), "step": 2 * float(np.pi) / 3},
        others=(),
    )
    for momentum in (0.0, 1e-3, 1e-8):
        for kind, how in (("taylor", {}), ("gauss", {"method": Gauss(6), "step": 0.01})):
            yield motion_row(
                f"pole-{momentum:g}-{kind}",
                f"a spherical pendulum in θ, φ with p_φ = {momentum:g}: past the pole, {kind} "
                "(truth in Taylor, 40 digits)",
                partial(sphere, momentum),
                how,
                others=("SciPy DOP853", "heyoka") if kind == "taylor" else (),
                limit=90,
            )
    yield Row(
        "pole-start",
        "a spherical pendulum that starts at the pole, sin θ = 0",
        lambda: refused(
            lambda: propagate(sphere(0.0).hamiltonian, (0, 1), [0.0, 0.0, 1.0, 0.0]).final,
            ValueError,
            holds="not finite",
        ),
    )
    yield motion_row(
        "polar-kepler",
        "Kepler's motion in r, φ with L = 1e-4 from r = 1: turning at r = 5e-9",
        polar,
        {},
        limit=90,
    )


OSCILLATOR = Hamiltonian(x.momentum**2 / 2 + x**2 / 2, [x], [x.momentum])


def swing(angle: float, momentum: float, until: float) -> Problem:
    return Problem(PENDULUM, (angle, momentum), (0.0, until), by_taylor(PENDULUM, (angle, momentum), 60))


def stiff() -> Problem:
    """Unit mass, length 1, g = 9.81; the spring 1e-6 longer than in balance."""
    k, g = 10**10, sp.Rational(981, 100)
    H = (x.momentum**2 + y.momentum**2) / 2 + g * y + sp.Rational(k, 2) * (sp.sqrt(x**2 + y**2) - 1) ** 2
    found = Hamiltonian(H, [x, y], [x.momentum, y.momentum])
    r = 1 + 1e-6
    start = (r * 0.6, -r * 0.8, 0.0, 0.0)
    return Problem(found, start, (0.0, 1.0), by_taylor(found, start, "quad"))


def oscillator(until: float) -> Problem:
    def truth(t: np.ndarray) -> np.ndarray:
        with mp.workdps(40):
            return np.array([[mp.cos(mpf(float(s))), -mp.sin(mpf(float(s)))] for s in t], dtype=object).T

    return Problem(OSCILLATOR, (1.0, 0.0), (0.0, until), truth)


def henon() -> Problem:
    H = (x.momentum**2 + y.momentum**2) / 2 + (x**2 + y**2) / 2 + x**2 * y - y**3 / 3
    found = Hamiltonian(H, [x, y], [x.momentum, y.momentum])
    start = (0.1, 0.1, 0.3, 0.1)
    return Problem(found, start, (0.0, 400 * float(np.pi) / 3), by_taylor(found, start, "quad"))


def sphere(momentum: float) -> Problem:
    H = Hamiltonian(
        x.momentum**2 / 2 + y.momentum**2 / (2 * sp.sin(x) ** 2) - sp.cos(x), [x, y], [x.momentum, y.momentum]
    )
    start = (0.5, 0.0, 0.0, momentum)
    return Problem(H, start, (0.0, 20.0), by_taylor(H, start, 40))


def polar() -> Problem:
    H = Hamiltonian(x.momentum**2 / 2 + y.momentum**2 / (2 * x**2) - 1 / x, [x, y], [x.momentum, y.momentum])
    start = (1.0, 0.0, 0.0, 1e-4)
    return Problem(H, start, (0.0, 5.0), by_taylor(H, start, 60))
