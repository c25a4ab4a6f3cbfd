"""Print how much faster a study of 64 cases runs on two processes than on one.

The same cases are run one after the other in one process, then on a pool of two, the start of the workers left out and
told apart. Beside it stands what the machine gives two plain processes that only compute, at the same time and on the
same work: on a busy machine, or one whose processors share a core, that is less than 2 too. Repeated in turn; the
largest speed-up counts, as everything else that runs only ever takes away from it.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from canon import Gauss, Splitting
from canon.study.cases.case import key_of
from canon.study.cases.checkpointed_run import advance
from canon.study.cases.run_study import run_study
from canon.study.cases.store import Store
from canon.study.cases.study import Study

CASES = 64
SECONDS_A_CASE = float(os.environ.get("SECONDS_A_CASE", "1.0"))
ROUNDS = int(os.environ.get("ROUNDS", "3"))
PROCESSES = 2


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
    main()
