"""Print how much faster a study of 64 cases runs on two processes than on one, and orbits side by side on two cores.

The same cases are run one after the other in one process, then on a pool of two, the start of the workers left out and
told apart. Beside it stands what the machine gives two plain processes that only compute, at the same time and on the
same work: on a busy machine, or one whose processors share a core, that is less than 2 too. Repeated in turn; the
largest speed-up counts, as everything else that runs only ever takes away from it. Orbits side by side are timed by the
clock in processes that may use one core or two: whole calls, of which the look at the energies is done on one.
"""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import sympy as sp

from canon import Gauss, Hamiltonian, Splitting, propagate
from canon.study.cases.case import key_of
from canon.study.cases.checkpointed_run import advance
from canon.study.cases.run_study import run_study
from canon.study.cases.store import Store
from canon.study.cases.study import Study

CASES = 64
SECONDS_A_CASE = float(os.environ.get("SECONDS_A_CASE", "1.0"))
ROUNDS = int(os.environ.get("ROUNDS", "3"))
PROCESSES = 2
ORBITS, STEPS = (10_000, 100_000), 10_000
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1"}
"""Otherwise NumPy's thread for products of matrices keeps a core busy for seconds after its start and each use."""


def study(steps: int) -> Study:
    """Return 64 cases of nearly equal cost."""
    states = [[0.0, 0.1 + 0.002 * k, 0.4, 0.1] for k in range(CASES // 2)]
    h = 0.01
    common = {"system": "henon-heiles", "start": states, "samples": 1024}
    quick = Study.of(**common, method=Splitting("kahan-li-8"), step=h, span=h * steps)
    slow = Study.of(**common, method=Gauss(4), step=h, span=h * steps // 4)
    return Study((*quick.cases, *slow.cases))


def steps_for(seconds: float) -> int:
    """Return how many steps a case may have to take so long on average."""
    trial = study(100_000)
    for case in trial.cases[:: CASES // 2]:
        advance(case)  # compiled before it is timed
    begun = time.perf_counter()
    for case in trial.cases[:: CASES // 2]:
        advance(case)
    return int(100_000 * seconds * 2 / (time.perf_counter() - begun))


def busy(seconds: float) -> int:
    """Count for a while: what a process gets done that shares nothing with another."""
    end, count = time.perf_counter() + seconds, 0
    while time.perf_counter() < end:
        count += sum(range(10_000)) > 0
    return count


def wall(executor: ProcessPoolExecutor | None, cases: Study, path: Path) -> float:
    begun = time.perf_counter()
    status = run_study(cases, Store(path), executor)
    if (status.finished, status.failed, status.pending) != (CASES, 0, 0):
        sys.exit(f"the study did not run: {status}")
    return time.perf_counter() - begun


def outcomes(path: Path) -> dict[str, str]:
    return {key: record.outcome for key, record in Store(path).records().items()}


def orbits_on(cores: int, orbits: int) -> float:
    """Return the seconds by the clock that pendulums side by side take for many steps on so many cores."""
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:cores])
    os.cpu_count = lambda: cores  # as many threads as there are cores for them
    q, p = sp.symbols("q p", real=True)
    H = Hamiltonian(p**2 / 2 - sp.cos(q), [q], [p])
    starts = np.array([np.linspace(0.1, 1.5, orbits), np.zeros(orbits)])

    def run(steps: int) -> float:
        begun = time.perf_counter()
        propagate(H, (0, steps / 10), starts, method=Splitting("verlet"), step=0.1, samples=1)
        return time.perf_counter() - begun

    run(10)  # compiled before it is timed
    return run(STEPS)


def on_two_cores() -> None:
    """Print how much sooner orbits arrive on two cores than on one, in turn, the quickest of three each."""
    print(f"\norbits side by side, {STEPS} steps, whole calls by the clock")
    for orbits in ORBITS:
        times = {1: float("inf"), 2: float("inf")}
        for cores in (1, 2) * ROUNDS:
            given = [sys.executable, __file__, "--orbits", str(cores), str(orbits)]
            done = subprocess.run(
                given, capture_output=True, text=True, check=True, env=os.environ | ONE_THREAD
            )
            times[cores] = min(times[cores], float(done.stdout))
        print(
            f"{orbits:7d} orbits: one core {times[1]:6.2f} s, two {times[2]:6.2f} s: {times[1] / times[2]:.2f} ×"
        )


def main() -> None:
    cases = study(steps_for(SECONDS_A_CASE))
    assert len({key_of(case) for case in cases.cases}) == CASES
    spawn = multiprocessing.get_context("spawn")
    with tempfile.TemporaryDirectory() as folder, ProcessPoolExecutor(PROCESSES, spawn) as pool:
        begun = time.perf_counter()
        # Each worker imports canon and compiles both loops once.
        for future in [pool.submit(advance, case) for case in study(20_000).cases[:: CASES // 8]]:
            future.result()
        print(f"workers started, canon imported and loops compiled in {time.perf_counter() - begun:.1f} s")
        speed_ups: list[float] = []
        for k in range(ROUNDS):
            one, two = Path(folder) / f"one{k}.sqlite", Path(folder) / f"two{k}.sqlite"
            alone = busy(1.0)
            together = sum(future.result() for future in [pool.submit(busy, 1.0) for _ in range(PROCESSES)])
            serial, parallel = wall(None, cases, one), wall(pool, cases, two)
            if outcomes(one) != outcomes(two):
                sys.exit("two processes gave other results than one")
            speed_ups.append(serial / parallel)
            print(
                f"round {k + 1}: one process {serial:6.1f} s, two {parallel:6.1f} s: {speed_ups[-1]:.2f} × "
                f"(the machine gives two plain processes {together / alone:.2f} ×)"
            )
    print(
        f"speed-up of {CASES} cases on {PROCESSES} processes: {max(speed_ups):.2f} ×; results equal bit for bit"
    )


if __name__ == "__main__":
    if sys.argv[1:2] == ["--orbits"]:
        print(orbits_on(*map(int, sys.argv[2:])))
    else:
        main()
        on_two_cores()
