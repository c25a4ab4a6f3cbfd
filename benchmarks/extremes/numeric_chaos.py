"""Chaos: where single trajectories stop meaning anything."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from canon import RK4, Gauss, Hamiltonian, Splitting, coordinates, propagate
from extremes.numeric_tools import Problem, by_taylor, motion_row
from extremes.row import Outcome, Row

if TYPE_CHECKING:
    from collections.abc import Iterator

x, y = coordinates("x y")


def rows() -> Iterator[Row]:
    """Yield the rows."""
    for kind, how in (
        ("taylor", {}),
        ("gauss", {"method": Gauss(6), "step": 0.02}),
        ("rk4", {"method": RK4(), "step": 0.01}),
    ):
        yield motion_row(
            f"double-pendulum-{kind}",
            f"a double pendulum from 115° and 143°, t = 0 … 100, {kind}: Lyapunov time about 3",
            double,
            how,
            samples=100,
            others=("SciPy DOP853", "heyoka") if kind == "taylor" else (),
            limit=90,
        )
    yield Row(
        "double-pendulum-lyapunov",
        "its Lyapunov time over t = 0 … 60, against the growth of the tangent map (QR of "
        "the Jacobian, t = 0 … 2000)",
        lyapunov,
        limit=120,
    )
    yield motion_row(
        "henon-heiles-chaotic",
        "Hénon and Heiles, E = 1/6, chaotic, t = 0 … 400",
        partial(henon, 1.0),
        {},
        samples=100,
        limit=90,
    )
    yield motion_row(
        "henon-heiles-regular",
        "Hénon and Heiles, E = 1/100, regular, t = 0 … 1000: no chaos may be reported",
        partial(henon, 0.24),
        {"method": Splitting("kahan-li-8"), "step": 0.1},
        samples=100,
        limit=90,
    )


def double() -> Problem:
    px, py = x.momentum, y.momentum
    H = (
        (px**2 - 2 * sp.cos(x - y) * px * py + 2 * py**2) / (2 + 2 * sp.sin(x - y) ** 2)
        - 2 * sp.cos(x)
        - sp.cos(y)
    )
    found = Hamiltonian(H, [x, y], [px, py])
    start = (2.0, 2.5, 0.0, 0.0)
    return Problem(found, start, (0.0, 100.0), by_taylor(found, start, "quad"))


def lyapunov() -> Outcome:
    """Compare with Benettin's method: neighbours pulled back to a fixed distance, averaged over a long time."""
    given = double()
    told = propagate(given.hamiltonian, (0, 60), given.y0, samples=60).error_estimate().lyapunov_time
    state, beside, total, pieces, apart = np.array(given.y0), np.array([1e-8, 0, 0, 0]), 0.0, 400, 1e-8
    for _ in range(pieces):
        pair = propagate(given.hamiltonian, (0, 5), np.stack([state, state + beside], axis=1), samples=1).y[
            :, -1
        ]
        grown = pair[:, 1] - pair[:, 0]
        total += np.log(np.linalg.norm(grown) / apart)
        state, beside = pair[:, 0], grown * (apart / np.linalg.norm(grown))
    true = 5 * pieces / total
    # Over 20 Lyapunov times the growth of one orbit is known to a factor of about 1 ± 1/√20.
    return Outcome(f"e-fold in {told:.3g}; long-time average {true:.3g}", abs(told / true - 1), 0.5)


def henon(size: float) -> Problem:
    H = (x.momentum**2 + y.momentum**2) / 2 + (x**2 + y**2) / 2 + x**2 * y - y**3 / 3
    found = Hamiltonian(H, [x, y], [x.momentum, y.momentum])
    start = (0.0, 0.1 * size, 0.5581 * size, 0.1 * size)
    return Problem(found, start, (0.0, 400.0 if size == 1.0 else 1000.0), by_taylor(found, start, "quad"))
