"""Work at a wanted accuracy over 1000 periods, beside every other library that is installed.

For each problem, contender and accuracy: the cheapest setting tried (steps a period, or tolerance) that keeps
max |ΔE/E| at 3137 instants below it, and the processor time a period of a run that keeps the last state only: the
median of runs that take turns. A short run is the second of two in a row: the first finds the processor's caches full
of what the others did. Two times are told of every contender alike, on a problem that is set up and compiled: the loop
alone, which is the call that integrates, and the whole of a further call, from the numbers of a start to the numbers of
an end: of canon ``canon.flow.prepare(…).propagate(y0)``, which checks the start and measures the energies, of REBOUND a
copy of a simulation and its energies, and so on. Others are installed into an environment of
their own, compiled for the machine where that can be asked for; canon needs none of them::

    pip install galpy pyhamsys diffrax gala jitcode desolver    # jitcode needs a C compiler
    pip install numbalsoda                                      # needs a Fortran compiler
    CFLAGS=-march=native pip install --no-binary rebound rebound
    python benchmarks/peers.py --store

Without ``--run`` or ``--store`` the stored table is printed.
"""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from peer_libraries import LIBRARIES
from peer_problems import (
    DEAR,
    DEAR_PERIODS,
    INSTANTS,
    PATIENCE,
    PERIODS,
    PROBLEMS,
    TOLERANCES,
    TURNS,
    Contender,
    Problem,
    Run,
    installed,
    parser_of,
    steps,
    tell,
    timed,
)  # fmt: skip

from canon import SABA, Gauss, Splitting, Taylor, WisdomHolman
from canon.flow import prepare

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.flow import PreparedMotion, Trajectory

STORED = Path(__file__).parent / "results" / "peers.txt"
ACCURACIES = (1e-4, 1e-8, 1e-12)
SHORT = 0.1
"""Seconds of a run that is taken twice."""


# canon ---------------------------------------------------------------------------------------------


def canon_methods(problem: Problem) -> Iterator[Contender]:
    splittings = ["mclachlan-4", "blanes-moan-4", "blanes-moan-6", "srkn-6a", "srkn-6b", "kahan-li-8",
                  "sofroniou-spaletta-10"]  # fmt: skip
    methods: list[Any] = [Splitting(name) for name in splittings]
    if problem.scene == "kepler":
        methods.append(WisdomHolman())
    if problem.scene == "outer-solar-system":
        methods = [WisdomHolman(), WisdomHolman(corrector=11), WisdomHolman(corrector=11, commutator=True),
                   SABA(2), SABA(4), SABA("8-6-4"), SABA("10-6-4")]  # fmt: skip
    if problem.scene == "henon-heiles":
        methods += [SABA("8-6-4"), SABA("10-6-4")]
    if problem.scene == "double-pendulum":
        methods = [Gauss(s) for s in (2, 3, 4, 5, 6, 8)]
    made: dict[Any, PreparedMotion] = {}

    def motion_of(method: Any, instants: int, **settings: Any) -> Trajectory:
        """Return a motion; what is not the start's is worked out once, as other libraries' problems are."""
        key = str(method), instants, *settings.values()
        if key not in made:
            made[key] = prepare(
                problem.hamiltonian, (0.0, problem.span), method=method, parameters=problem.values,
                samples=instants, **settings,
            )  # fmt: skip
        return made[key].propagate(problem.y0)

    for method in methods:

        def run(setting: int, instants: int, method: Any = method) -> Run:
            step = problem.span / problem.periods / setting * (1 + 1e-10)
            motion = motion_of(method, instants, step=step, precision="double")
            # A run of fewer steps than instants shows every step.
            return motion.cpu_seconds, np.pad(motion.energy, (0, instants + 1 - len(motion.energy)), "edge")

        fewest = (
            [1, 2, 3] if isinstance(method, type(WisdomHolman())) and problem.scene != "henon-heiles" else []
        )
        yield Contender(f"canon {method}", [*fewest, *steps(problem)], run)

    def taylor(setting: float, instants: int) -> Run:
        motion = motion_of(Taylor(setting), instants)
        return motion.cpu_seconds, motion.energy

    yield Contender("canon Taylor", TOLERANCES, taylor)


# the comparison ------------------------------------------------------------------------------------


def search(problem: Problem, contender: Contender) -> None:
    """Find the first setting that keeps each accuracy."""
    wanted, spent = list(ACCURACIES), 0.0
    for setting in contender.settings:
        try:
            seconds, found = contender.run(setting, INSTANTS)
            error = problem.error(found) if found.shape[-1] == INSTANTS + 1 else np.inf
            if contender.grows:
                error *= PERIODS / DEAR_PERIODS
        except (ArithmeticError, RuntimeError):
            continue
        while wanted and error <= wanted[0]:
            contender.chosen[wanted.pop(0)] = setting
        spent += seconds
        if not wanted or spent > PATIENCE:
            return


def in_time(c: Contender, accuracy: float, turn: int) -> bool:
    """Take a contender's turn, where it is not too dear; return False where it does not come to an end."""
    costs = c.costs.setdefault(accuracy, [])
    try:
        if turn and costs[0] < SHORT:
            c.run(c.chosen[accuracy], 1)
        if not turn or costs[0] < 1:
            whole, (seconds, _) = timed(lambda: c.run(c.chosen[accuracy], 1))
            costs.append(seconds)
            c.calls.setdefault(accuracy, []).append(whole)
    except RuntimeError:
        return False
    return True


def compare(key: tuple[str, str, int, int]) -> Iterator[str]:
    """Compare everything on one problem."""
    problem = Problem(*key)
    short = Problem(*key, DEAR_PERIODS)
    contenders = [*canon_methods(problem)]
    for library, methods in LIBRARIES.items():
        if importlib.util.find_spec(library):
            contenders += methods(short if library in DEAR else problem)
    for contender in contenders:
        search(problem, contender)
    for accuracy in ACCURACIES:
        able = [c for c in contenders if accuracy in c.chosen]
        for turn in range(TURNS + 1):
            able = [c for c in able if in_time(c, accuracy, turn)]
        yield f"{problem.name}, max |ΔE/E| ≤ {accuracy:.0e}"
        ranked = sorted(able, key=lambda c: c.cost(accuracy))
        loops, wholes = dict[str, float](), dict[str, float]()
        for c in able:
            loops[c.library] = min(loops.get(c.library, np.inf), c.cost(accuracy))
            wholes[c.library] = min(wholes.get(c.library, np.inf), c.call(accuracy))
        for c in ranked:
            cost, call = c.cost(accuracy), c.call(accuracy)
            if c in ranked[:3] or cost == loops[c.library] or call == wholes[c.library]:
                setting = f"{c.name:38} {c.chosen[accuracy]:10.4g}"
                yield f"    {setting} {cost:12.3f} µs a period, {call:.3f} the whole call"
        if "canon" in loops and len(loops) > 1:
            loop, whole = (
                best["canon"] / min(cost for library, cost in best.items() if library != "canon")
                for best in (loops, wholes)
            )
            yield f"    canon {loop:.2f} × the cheapest other, {whole:.2f} × by the whole call"
        missing = sorted({c.library for c in contenders} - set(loops))
        if missing:
            yield f"    not reached within {PATIENCE:g} s of settings tried: {', '.join(missing)}"


def main() -> None:
    """Print the table."""
    given = parser_of(__doc__, PROBLEMS).parse_args()

    def lines() -> Iterator[str]:
        yield from installed(LIBRARIES)
        for name in given.problems or PROBLEMS:
            yield from compare(PROBLEMS[name])

    tell(given, STORED, lines)


if __name__ == "__main__":
    main()
