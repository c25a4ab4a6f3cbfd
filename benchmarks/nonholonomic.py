"""The nonholonomic leapfrog over 10⁶ steps: constraints, energy early and late, and canon's verdict on it.

Run ``python benchmarks/nonholonomic.py``. Taylor's method runs a tenth of the span, to round-off.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import sympy as sp

from canon import ConstrainedLagrangian, Lagrangian, coordinates, drift, propagate
from canon.flow import NonholonomicLeapfrog
from canon.scene import find

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

STEPS, UNIT = 10**6, 2.0**-53


class Case(NamedTuple):
    """A system, its start, and the step of orders 2 and 4."""

    name: str
    system: ConstrainedLagrangian
    start: Sequence[float]
    step: float
    values: Mapping[Any, float]


def particle() -> Case:
    x, y, z = coordinates("x y z")
    L = Lagrangian((x.dot**2 + y.dot**2 + z.dot**2 - x**2 - y**2) / 2, [x, y, z])
    rolls = ConstrainedLagrangian(L, nonholonomic=[z.dot - y * x.dot])
    return Case("nonholonomic particle: integrable, reversible", rolls, [1, 0, 0, 0, 1, 0], 0.1, {})


def disc() -> Case:
    scene = find("rolling-disc")
    start = scene.start("wobbling")
    return Case(
        "wobbling disc: integrable, reversible",
        scene.constrained,
        [*start.q, *start.v],
        0.005,
        scene.values_by_symbol(),
    )


def contact_oscillators() -> Case:
    q = coordinates("x y0 z0 y1 z1 y2 z2")
    Y, Z = q[1::2], q[2::2]
    coupled = [Z[i] * Z[(i + 1) % 3] for i in range(3)] + [a * b for a, b in zip(Y, Z, strict=True)]
    L = Lagrangian(sum(s.dot**2 - s**2 for s in q) / 2 - sum(c**2 for c in coupled) / 2, list(q))
    rolls = q[0].dot + sum(a * b.dot for a, b in zip(Y, Z, strict=True))
    places, speeds = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], [0.5, -0.2, 0.3, 0.4, -0.6, 0.1]
    along = -sum(a * b for a, b in zip(places[1::2], speeds[1::2], strict=True))
    system = ConstrainedLagrangian(L, nonholonomic=[rolls])
    return Case("contact oscillators: chaotic, reversible", system, [*places, along, *speeds], 0.1, {})


def turned_plane(phase: float) -> Case:
    x, y, u, w = q = coordinates("x y u w")
    L = Lagrangian((sum(s.dot**2 for s in q) - x**2 - y**2 - u**2 / 4 - w**2) / 2, list(q))
    system = ConstrainedLagrangian(L, nonholonomic=[y.dot - (0.8 * u + 0.5 * w) * x.dot])
    c, s = np.cos(phase), np.sin(phase)
    name = "plane turned by two oscillators, " + ("out of phase" if phase else "in phase")
    return Case(name, system, [0.5, 0.2, 1, c, 0.3, 0.3 * (0.8 + 0.5 * c), 0, -s], 0.1, {})


def slip(motion: Any, case: Case) -> float:
    """Return the largest A q̇ in rounding units of the largest Σ |A q̇|."""
    q, worst = case.system.lagrangian.q, 0.0
    for g, residual in zip(case.system.nonholonomic, motion.residuals, strict=True):
        row = [sp.lambdify(q, g.subs(case.values).diff(s.dot))(*motion.q) for s in q]
        size = sum(abs(a * b) for a, b in zip(row, motion.v, strict=True)).max()
        worst = max(worst, float(abs(residual).max() / size / UNIT))
    return worst


def main() -> None:
    print(
        f"{STEPS:.0e} steps; slip in units of 2**-53; times a step, and in parts of Taylor's over the same span"
    )
    for case in (particle(), disc(), contact_oscillators(), turned_plane(0.0), turned_plane(1.0)):
        print(case.name)
        span = STEPS * case.step
        setting = {"parameters": case.values}
        taylor = propagate(case.system, (0, span / 10), case.start, samples=10, **setting).cpu_seconds * 10
        for order in (2, 4):
            motion = propagate(
                case.system, (0, span), case.start, method=NonholonomicLeapfrog(order), step=case.step,
                samples=2000, **setting,
            )  # fmt: skip
            error = abs(motion.energy_error)
            print(
                f"  order {order}, step {case.step:<5}  |ΔE/E| {error[1:201].max():.1e} early, "
                f"{error[-200:].max():.1e} late  {drift(motion).verdict!s:9}  slip {slip(motion, case):.1f} u  "
                f"{motion.cpu_seconds / motion.steps * 1e9:6.0f} ns  {motion.cpu_seconds / taylor:.2f} × Taylor"
            )


if __name__ == "__main__":
    main()
