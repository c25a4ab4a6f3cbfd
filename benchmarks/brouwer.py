"""Energy error over 10⁸ and 10⁹ steps of Kepler's motion, e = 0.2: does it grow as Brouwer's law says, and how fast?

``python benchmarks/brouwer.py`` prints the stored results; ``--run`` computes and stores them anew (about two
hours of processor time), ``--run Gauss`` those of methods whose names begin so, ``--run --steps 1e9`` those of so
many steps, ``--steps 1e6 --orbits 2`` something shorter, which is not stored.

Orbits of one ellipse, turned and started at random, run side by side. An energy of n steps that are wrong by
rounding alone makes a random walk: its error has a mean of nought and grows as n^½ (D. Brouwer, Astron. J. 46
(1937) 149–153, doi:10.1086/105423). Printed are, in units of u√n with u = 2⁻⁵³, the root mean square error
at the end and that of the increments over a thousandth of the run; the exponent of the increments' growth with the
number of steps they span, with the standard deviation that resampling the orbits gives; and the mean
increment over its standard error: beyond ±3 there is a drift.
"""

from __future__ import annotations

import argparse
import platform
import time
from datetime import date
from importlib.metadata import version
from pathlib import Path

import numpy as np

from canon import Gauss, Splitting, WisdomHolman, propagate
from canon.scene import find

STORED = Path(__file__).parent / "results" / "brouwer.txt"
ECCENTRICITY, UNIT, SAMPLES = 0.2, 2.0**-53, 1000
LAGS = (1, 2, 5, 10, 20, 50, 100, 200)
CASES = (
    (Splitting("kahan-li-8"), "compensated", 250.3, {10**8: 32, 10**9: 8}),
    (Splitting("sofroniou-spaletta-10"), "compensated", 125.3, {10**8: 32, 10**9: 8}),
    (Gauss(6), "compensated", 40.3, {10**8: 6, 10**9: 2}),
    (Gauss(8), "compensated", 25.3028, {10**8: 6, 10**9: 4}),
    (WisdomHolman(), "compensated", 2.3028, {10**8: 8, 10**9: 8}),
    (WisdomHolman(), "compensated", 2.3, {10**8: 32}),
    (WisdomHolman(), "compensated", 40.3, {10**8: 32}),
    (WisdomHolman(), "extended", 2.3, {10**8: 8}),
)
"""Method, precision, steps a period, orbits by the number of steps.

The method's own error lies below the rounding of one step. A whole number of steps would be in resonance with the
motion, which all have the same period; of two or three steps 2.3 is in resonance too, as the 23 places of ten periods
come again and again.
"""


def starts(orbits: int, seed: int = 1) -> np.ndarray:
    """Return states (x, y, p_x, p_y) on ellipses with a = k = m = 1, turned and started at random."""
    random = np.random.default_rng(seed)
    u, turn = random.uniform(0, 2 * np.pi, (2, orbits))
    e, root = ECCENTRICITY, np.sqrt(1 - ECCENTRICITY**2)
    along = np.array([np.cos(u) - e, root * np.sin(u)])
    speed = np.array([-np.sin(u), root * np.cos(u)]) / (1 - e * np.cos(u))
    c, s = np.cos(turn), np.sin(turn)
    return np.concatenate([[c * x - s * y, s * x + c * y] for x, y in (along, speed)])


def growth(error: np.ndarray) -> np.ndarray:
    """Return the root mean square of increments of (samples, orbits) over each lag, by orbit: (lags, orbits)."""
    return np.array([(np.diff(error[::lag], axis=0) ** 2).mean(axis=0) for lag in LAGS])


def exponent(squares: np.ndarray) -> float:
    """Fit the exponent to mean squares (lags, orbits); long lags, of which there are few, weigh less."""
    slope, _ = np.polyfit(np.log(LAGS), np.log(squares.mean(axis=1)) / 2, 1, w=1 / np.sqrt(LAGS))
    return float(slope)


def named(method: Splitting | Gauss | WisdomHolman, precision: str) -> str:
    """Return the word a row begins with."""
    return str(method) if precision == "compensated" else f"{method},{precision}"


def row(
    method: Splitting | Gauss | WisdomHolman, precision: str, steps_a_period: float, steps: int, orbits: int
) -> str:
    """Run one method and describe its error."""
    kepler = find("kepler")
    step = 2 * np.pi / steps_a_period
    begun = time.process_time()
    motion = propagate(
        kepler.hamiltonian, (0.0, steps * step), starts(orbits), method=method, step=step,
        precision=precision, parameters=dict.fromkeys(kepler.values, 1), samples=SAMPLES,
    )  # fmt: skip
    spent = time.process_time() - begun
    error = motion.energy_error / UNIT
    block = motion.steps / SAMPLES
    squares = growth(error)
    random = np.random.default_rng(2)
    drawn = [exponent(squares[:, random.integers(0, orbits, orbits)]) for _ in range(400)]
    increments = np.diff(error, axis=0).ravel()
    bias = increments.mean() / increments.std() * np.sqrt(len(increments))
    at_end = np.sqrt((error[-1] ** 2).mean() / motion.steps)
    walk = np.sqrt(squares[0].mean() / block)
    return (
        f"{named(method, precision):22} {steps_a_period:7} {motion.steps:9.0e} {orbits:6} {walk:9.3f} {at_end:11.3f} "
        f"{exponent(squares):8.3f} ± {np.std(drawn):.3f} {bias:+8.1f} {abs(error).max() * UNIT:12.1e} {spent:8.0f}"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--run", nargs="?", const="", metavar="METHOD")
    parser.add_argument("--steps", type=float)
    parser.add_argument("--orbits", type=int)
    given = parser.parse_args()
    if given.run is None:
        print(STORED.read_text(encoding="utf-8"), end="")
        return
    tools = ", ".join(f"{name} {version(name)}" for name in ("numpy", "llvmlite"))
    head = f"python benchmarks/brouwer.py --run, {date.today()}, {platform.machine()}"
    columns = "steps/T     steps orbits  walk/u√n end rms/u√n         exponent   bias/σ   max |dE/E|    CPU s"
    lines = [f"{head}, Python {platform.python_version()}, {tools}", f"{'method':22} {columns}"]
    print(*lines, sep="\n", flush=True)
    stored = {
        (name, float(each), float(steps)): line
        for line in STORED.read_text(encoding="utf-8").splitlines()[2:]
        for name, each, steps, *_ in [line.split()]
    }
    is_short = given.orbits is not None or given.steps not in (None, 1e8, 1e9)
    for number in (int(given.steps or 1e8),) if is_short else (10**8, 10**9):
        for method, precision, steps_a_period, by_steps in CASES:
            key = named(method, precision), steps_a_period, number
            asked = key[0].startswith(given.run) and given.steps in (None, number)
            if asked and (is_short or number in by_steps):
                orbits = given.orbits or by_steps.get(number, 2)
                lines.append(row(method, precision, steps_a_period, number, orbits))
            elif key in stored and not is_short:
                lines.append(stored[key])
            else:
                continue
            print(lines[-1], flush=True)
    if not is_short:
        STORED.parent.mkdir(exist_ok=True)
        STORED.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
