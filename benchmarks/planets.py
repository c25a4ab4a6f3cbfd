"""Work against accuracy on the outer solar system: splittings and Gauss, CPU time a period of Jupiter.

For each accuracy the longest step that keeps max |ΔE/E| below it over 1000 periods, of the steps tried, and the
CPU time of a run that keeps ten samples: the median of five.
"""

from __future__ import annotations

import argparse
import statistics
from typing import TYPE_CHECKING

from canon import SABA, Gauss, Splitting, WisdomHolman, propagate
from canon.flow import SBAB
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.scene import find

if TYPE_CHECKING:
    from canon.flow.method.method import FixedStep
    from canon.flow.trajectory import Trajectory

METHODS = (
    WisdomHolman(),
    WisdomHolman(corrector=5),
    WisdomHolman(corrector=7),
    WisdomHolman(corrector=11),
    WisdomHolman(corrector=17),
    WisdomHolman(corrector=11, commutator=True),
    WisdomHolman(coordinates="democratic-heliocentric"),
    WisdomHolman(corrector=11, coordinates="democratic-heliocentric"),
    SABA(2),
    SABA(3),
    SABA(4),
    SABA(4, commutator=True),
    SBAB(3),
    SABA("8-6-4"),
    SABA("10-6-4"),
    Splitting("srkn-6b"),
    Splitting("kahan-li-8"),
    Gauss(4),
    Gauss(6),
    Gauss(8),
)
ACCURACIES = (1e-4, 1e-8, 1e-12)
STEPS_A_PERIOD = (
    4,
    5,
    6,
    7,
    8,
    9,
    10,
    11,
    12,
    14,
    16,
    18,
    20,
    24,
    28,
    32,
    40,
    50,
    64,
    80,
    100,
    130,
    160,
    200,
    260,
    330,
)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--periods", type=int, default=1000)
    parser.add_argument("--precision", default="double")
    given = parser.parse_args()
    planets = find("outer-solar-system")
    start, period = planets.starts[0], planets.time_scale(planets.values)
    span = (0.0, given.periods * period)

    def run(method: FixedStep, steps: int, samples: int) -> Trajectory:
        return propagate(
            planets.hamiltonian, span, [*start.q, *start.p], method=method, step=period / steps * (1 + 1e-9),
            precision=given.precision, parameters=planets.values, samples=samples,
        )  # fmt: skip

    print(f"{'method':54} {'accuracy':>8} {'steps a period':>14} {'max |dE/E|':>10} {'µs a period':>11}")
    for method in METHODS:
        wanted = list(ACCURACIES)
        for steps in STEPS_A_PERIOD:
            if not wanted:
                break
            try:
                error = float(abs(run(method, steps, 1000).energy_error).max())
            except NonFiniteStateError:  # stages that are too far apart to be iterated
                continue
            while wanted and error <= wanted[0]:
                cpu = statistics.median(run(method, steps, 10).cpu_seconds for _ in range(5))
                cost = cpu / given.periods * 1e6
                print(f"{method!s:54} {wanted.pop(0):8.0e} {steps:14} {error:10.1e} {cost:11.2f}", flush=True)


if __name__ == "__main__":
    main()
