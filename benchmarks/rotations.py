"""Rotating bodies and charges in fields: what their own splittings cost at a wanted accuracy, beside heyoka and Gauss.

Run ``python benchmarks/rotations.py``; ``--long`` takes 10⁸ steps for round-off in place of 10⁷. The steps of each
method are halved, and heyoka's tolerance is divided by ten, until the energy stays within the accuracy over a thousand
periods; between mirrors, where Boris's push keeps the energy whatever it does, the place along the axis is
asked for. Times are those of the last run, the best of three, in parts of heyoka's.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon import Gauss, Hamiltonian, Taylor, coordinates, propagate
from canon.flow import Boris, LiePoissonSplitting, MagneticSplitting
from canon.mechanics import VERTICAL, heavy_top, rotating_body
from canon.scene import find

if TYPE_CHECKING:
    from canon.flow import Method, Trajectory

REPEATS, PERIODS, FINEST = 3, 1000, 14
ACCURACIES = (1e-4, 1e-8)
UNIT = 2.0**-53


@dataclass(frozen=True)
class Case:
    """A motion, its period, and the methods made for it."""

    name: str
    system: Any
    start: list[float]
    period: float
    methods: tuple[Method, ...]
    place: str = ""

    def run(self, method: Method, step: float | None = None) -> Trajectory:
        span = PERIODS * self.period
        return propagate(self.system, (0, span), self.start, method=method, step=step, samples=PERIODS // 5)

    def error(self, motion: Trajectory) -> float:
        """Return the largest error of the energy, or of the place in parts of its largest value."""
        if not self.place:
            return float(abs(motion.energy_error).max())
        true = self.run(Taylor())
        at = np.searchsorted(motion.t, true.t - 1e-6 * self.period)
        assert abs(motion.t[at] - true.t).max() < 1e-6 * self.period
        return float(abs(motion[self.place][at] - true[self.place]).max() / abs(true[self.place]).max())


def cases() -> list[Case]:
    """The motions: a body with three moments of inertia, a fast top, a mirror's charge, one in a Penning trap."""
    body = LiePoissonSplitting(4), LiePoissonSplitting(6), Gauss(4)
    charge = Boris(2), Boris(4), MagneticSplitting(4), MagneticSplitting(6), Gauss(4)
    top, mirror, trap = find("lagrange-top").values, *charges()
    weight = top["m"] * top["g"] * top["l"]
    fast = heavy_top([top["A"], top["A"], top["C"]], weight * VERTICAL[2])
    spin = 150.0
    return [
        Case("free body, attitude", rotating_body([1, 2, 3]), [0.5, 1, 0.4, 1, 0, 0, 0], 10.0, body),
        Case(
            "Lagrange's fast top",
            fast,
            [0, 0, top["C"] * spin, 0, math.sin(0.5), math.cos(0.5)],
            2 * math.pi * top["A"] / (top["C"] * spin),
            body,
        ),
        Case(
            "asymmetric top",
            heavy_top([1, 2, 3], VERTICAL[0] + VERTICAL[2]),
            [0.5, 1, 1, 0.6, 0, 0.8],
            5.0,
            body,
        ),
        Case("charge in a mirror", mirror, [0.05, 0, 0, 0, 0.075, 0.05], 2 * math.pi, charge, "z"),
        Case("Penning trap", trap, [1.0, 0, 0.5, 0, 5.0, 0], 2 * math.pi / 10, charge),
    ]


def charges() -> tuple[Hamiltonian, Hamiltonian]:
    """A charge between two magnetic mirrors, and one in a trap whose field turns it ten times as fast as it swings."""
    x, y, z = coordinates("x y z")
    p = [s.momentum for s in (x, y, z)]

    def hamiltonian(field: Any, phi: Any) -> Hamiltonian:
        A = [-y * field / 2, x * field / 2, 0]
        return Hamiltonian(sum((a - b) ** 2 for a, b in zip(p, A, strict=True)) / 2 + phi, [x, y, z], p)

    return hamiltonian(1 + z**2 / 4, 0), hamiltonian(10, (z**2 - (x**2 + y**2) / 2) / 2)


def cheapest(case: Case, method: Method, accuracy: float) -> float | None:
    """Return the processor seconds of the cheapest run that keeps the energy; None where none of those tried does."""
    for halving in range(FINEST):
        if isinstance(method, Taylor):
            setting: dict[str, Any] = {"method": Taylor(10.0 ** -(3 + halving))}
        else:
            setting = {"method": method, "step": case.period / (5 * 2**halving)}
        try:
            motion = case.run(**setting)
        except ArithmeticError:
            continue
        if case.error(motion) <= accuracy:
            return min(motion.cpu_seconds, *(case.run(**setting).cpu_seconds for _ in range(REPEATS - 1)))
    return None


def at_wanted_accuracy() -> None:
    print(f"{PERIODS} periods, energy (in the mirror: place) to")
    print(
        f"{'system':22} {'method':16}"
        + "".join(f"{accuracy:>10.0e}" for accuracy in ACCURACIES)
        + "   × heyoka"
    )
    for case in cases():
        heyoka = [cheapest(case, Taylor(), accuracy) for accuracy in ACCURACIES]
        for method in case.methods:
            found = [cheapest(case, method, accuracy) for accuracy in ACCURACIES]
            ratios = [
                f"{own / other:10.2f}" if own is not None and other is not None else f"{'–':>10}"
                for own, other in zip(found, heyoka, strict=True)
            ]
            print(f"{case.name:22} {method!s:16}{''.join(ratios)}")


def round_off(steps: int) -> None:
    """Print how far Casimir functions and speeds wander, in rounding units, and the energy early and late."""
    for case in cases():
        method = case.methods[0]
        step = case.period / 40
        motion = propagate(case.system, (0, steps * step), case.start, method=method, step=step, samples=1999)
        error = abs(motion.energy_error)
        said = f"|ΔE/E| {error[1:200].max():.1e} early, {error[-200:].max():.1e} late"
        if isinstance(method, LiePoissonSplitting):
            y = motion.y.astype(np.longdouble) + motion.carried
            size = (y[3:] ** 2).sum(axis=0)
            said += f", norm of the attitude {float(abs(size - size[0]).max()) / UNIT:.0f} u"
        print(f"{case.name:22} {method!s:16} {motion.steps:.0e} steps: {said}")


def main() -> None:
    at_wanted_accuracy()
    print()
    round_off(10**8 if "--long" in sys.argv else 10**7)


if __name__ == "__main__":
    main()
