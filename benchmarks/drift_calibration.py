"""How often the drift statistics are wrong: verdicts, error bars and intervals on series of known kinds.

Run:  python -m benchmarks.drift_calibration [series per kind, default 1000]

Synthetic series (4097 samples over one run) are those of tests/study/series.py and some harder ones; real ones
come from Hénon–Heiles orbits on random points of the section at energy 1/12, 500 periods each. "right" is the
verdict that the kind deserves; that of a walk is wandering, as nothing is said here of rounding. Secular is claimed
falsely in at most 1 %, a walk in about 1 % of bounded series. The harder kinds show where the assumptions end: noise
with a memory of a twentieth of the run or more can't be told from a random walk by that run. Of the real series, those
of symplectic methods must not be called secular, and those of RK4 must be.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

sys.path.insert(0, str(Path(__file__).parent.parent))

from canon.study.energy_drift.drift import Drift, Growth, drift
from canon.study.energy_drift.growth import slope_of, walk_of
from tests.study import series
from tests.study.test_noise import draws

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

SHARE = series.SHARE


def slow(random: np.random.Generator) -> series.Array:
    """2 to 5 turns in the run, and nothing else."""
    return 1e-6 * np.sin(2.0 * np.pi * random.uniform(2.0, 5.0) * SHARE + random.uniform(0.0, 6.0))


def rather_slow(random: np.random.Generator) -> series.Array:
    return 1e-6 * np.sin(2.0 * np.pi * random.uniform(10.0, 20.0) * SHARE + random.uniform(0.0, 6.0))


def memory(share: float) -> Callable[[np.random.Generator], series.Array]:
    """Bounded noise with a memory of that share of the run."""

    def make(random: np.random.Generator) -> series.Array:
        return 1e-8 * series.remembering(random, share)

    return make


def weak_walk(random: np.random.Generator) -> series.Array:
    return 1e-13 * series.walk(random) + 1e-13 * series.noise(random)


def exponential(random: np.random.Generator) -> series.Array:
    return 1e-13 * np.exp(random.uniform(8.0, 15.0) * SHARE) + 1e-13 * series.oscillation(random)


HARDER: dict[str, tuple[Growth, Callable[[np.random.Generator], series.Array]]] = {
    "10–20 turns in the run": (Growth.BOUNDED, rather_slow),
    "2–5 turns in the run": (Growth.UNDECIDED, slow),
    "memory of 1/100 of the run": (Growth.BOUNDED, memory(1.0 / 100.0)),
    "1/41, as long as a window": (Growth.BOUNDED, memory(1.0 / 41.0)),
    "memory of 1/20 of the run": (Growth.BOUNDED, memory(1.0 / 20.0)),
    "walk under equal noise": (Growth.WANDERING, weak_walk),
    "exponential": (Growth.DIVERGED, exponential),
}


def kinds() -> Iterator[tuple[str, Growth, float | None, Callable[[np.random.Generator], series.Array]]]:
    for name, make in series.BOUNDED.items():
        yield name, Growth.BOUNDED, None, make
    for name, make in series.ROUND_OFF.items():
        yield name, Growth.WANDERING, 0.5, make
    for name, (exponent, make) in series.SECULAR.items():
        yield name, Growth.SECULAR, exponent, make
    for name, (growth, make) in HARDER.items():
        yield name, growth, None, make


def share(part: float, whole: int) -> str:
    return f"{100.0 * part / whole:6.1f} %"


def verdict_row(name: str, right: Growth, exponent: float | None, found: list[Drift]) -> str:
    count = Counter(each.verdict for each in found)
    cells = [share(count[growth], len(found)) for growth in Growth]
    covered = ""
    if exponent is not None:
        inside = [each.exponent_interval[0] <= exponent <= each.exponent_interval[1] for each in found]
        covered = share(sum(inside), len(found))
    mark = share(count[right], len(found))
    return f"{name:28s} {right.value:10s} {mark}  " + " ".join(cells) + f"  {covered:>8s}"


def print_verdicts(number: int) -> None:
    print(f"verdicts on {number} series a kind")
    head = " ".join(f"{growth.value:>8s}" for growth in Growth)
    print(f"{'kind':28s} {'deserves':10s} {'right':>8s}  {head}  exponent in its interval")
    for name, right, exponent, make in kinds():
        random = np.random.default_rng(20)
        found = [drift(series.TIMES, make(random)) for _ in range(number)]
        print(verdict_row(name, right, exponent, found))


def print_levels(number: int) -> None:
    print(
        f"\nslope and walk tests on {number} draws of the model, by variance of the walk per block over the scatter's"
    )
    print(
        f"{'ratio':>8s} {'slope, level 1 %':>18s} {'level 5 %':>10s} {'slope/error':>12s} {'walk found':>11s}"
    )
    for ratio in (0.0, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0, np.inf):
        means = draws(ratio, number, seed=21)
        slopes = [slope_of(each, 0.01) for each in means]
        one, five = (sum(s.probability < level for s in slopes) for level in (0.01, 0.05))
        spread = np.std([s.value / s.error for s in slopes])
        walks = sum(walk_of(each).evidence > 5.4 for each in means)
        print(
            f"{ratio:8g} {share(one, number):>18s} {share(five, number):>10s} {spread:12.2f}"
            f" {share(walks, number):>11s}"
        )


def print_orbits(number: int) -> None:
    from canon import RK4, Splitting, Taylor
    from canon.scene import find
    from canon.scene.systems.henon_heiles import on_the_section
    from canon.study.energy_drift.drift_study import drift_study

    scene = find("henon-heiles")
    random = np.random.default_rng(22)
    methods = (Splitting("kahan-li-8"), Splitting("verlet"), RK4(), Taylor())
    counts: dict[str, Counter[Growth]] = {str(method): Counter() for method in methods}
    done = 0
    while done < number:
        y, p_y = random.uniform(-0.4, 0.5), random.uniform(-0.4, 0.4)
        if 1.0 / 6.0 - p_y**2 - y**2 + 2.0 * y**3 / 3.0 <= 0.0:
            continue
        state = scene.state(on_the_section("random", "", 1.0 / 12.0, y, p_y))
        for row in drift_study(scene, state, methods=methods, periods=500.0, samples=8192).rows:
            assert row.drift is not None
            counts[str(row.method)][row.drift.verdict] += 1
        done += 1
    print(f"\nverdicts on {number} orbits of Hénon–Heiles, 500 periods, about 50 steps a period")
    print(f"{'method':28s} " + " ".join(f"{growth.value:>10s}" for growth in Growth))
    for name, count in counts.items():
        print(f"{name:28s} " + " ".join(f"{share(count[growth], number):>10s}" for growth in Growth))


def main() -> None:
    number = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    started = time.perf_counter()
    print_verdicts(number)
    print_levels(4 * number)
    print_orbits(max(1, number // 5))
    print(f"\n{time.perf_counter() - started:.0f} s")


if __name__ == "__main__":
    main()
