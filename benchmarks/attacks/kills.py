"""Kills: SIGKILL to a study or one of its workers at any moment; what was finished stays, nothing is left running."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from canon.study.cases.chunk_damage import damaged_chunks
from canon.study.cases.run_study import run_study
from canon.study.cases.store import Store, StoreError
from canon.study.cases.study import read_study

from .count import Count
from .service import _family

if TYPE_CHECKING:
    Outcomes = dict[str, tuple[str, str]]

STUDY = """
[[study]]
system = ["henon-heiles", "kepler"]
method = ["kahan-li-8", { gauss = 2 }, "taylor"]
step = 0.05
span = 400.0
samples = 512
parts = 16
keep = ["motion"]
"""
CANON = [sys.executable, "-P", "-c", "import sys; from canon.cli import main; sys.exit(main(sys.argv[1:]))"]
ENDING = 2.0
"""Seconds after which nothing of a killed study runs any more."""


def kills(count: int, folder: Path, seed: int = 1) -> Count:
    """Kill a study ``count`` times, by one process and by two, the study itself or a worker of it."""
    found, draw = Count("kills of studies"), random.Random(seed)
    file = folder / "study.toml"
    file.write_text(STUDY)
    whole = Store(folder / "whole.sqlite")
    run_study(read_study(file), whole)
    expected, kept, at_work = _outcomes(whole), {}, 0
    for number in range(count):
        jobs, target = draw.choice(((1, "study"), (2, "study"), (2, "worker")))
        killed, told = _one_kill(file, jobs, target, draw)
        at_work += killed
        attack = f"seed {seed}, kill {number} of a {target}, {jobs} jobs"
        if told:
            found.add(
                *told,
            )
            continue
        outcome, store = _after(file.with_suffix(".sqlite"), expected, kept)
        found.add(
            outcome if outcome in ("other numbers", "lost") else f"{target} killed, {jobs} jobs: {outcome}",
            attack,
        )
        kept = _outcomes(store) if store else {}
        if kept.keys() == expected.keys():
            _forget(file)
            kept = {}
    run_study(read_study(file), file.with_suffix(".sqlite"))
    found.add(
        "ended with the same numbers"
        if _outcomes(Store(file.with_suffix(".sqlite"))) == expected
        else "other numbers",
        f"seed {seed}, at the end",
    )
    found.figures.append(f"{at_work} of {count} were at work when they were killed")
    return found


def _one_kill(file: Path, jobs: int, target: str, draw: random.Random) -> tuple[bool, tuple[str, str] | None]:
    """Run the study and kill it, or a worker; return whether it was at work, and what went wrong."""
    command = [*CANON, "study", "run", str(file), "--jobs", str(jobs), "--checkpoint", "0"]
    with (file.parent / "said").open("w+") as said:
        program = subprocess.Popen(command, stdout=said, stderr=said, start_new_session=True)
        time.sleep(draw.uniform(0.0, 4.0 if draw.random() < 0.8 else 12.0))
        family = _family(program.pid)
        workers = [pid for pid in family if not _keeps_semaphores(pid)]
        victim = program.pid if target == "study" or not workers else draw.choice(workers)
        with suppress(ProcessLookupError):
            os.kill(victim, signal.SIGKILL)
        at_work = program.poll() is None
        try:
            status = program.wait(120)
        except subprocess.TimeoutExpired:
            os.killpg(program.pid, signal.SIGKILL)
            return at_work, ("left running", f"{target}, {jobs} jobs: it hangs")
        said.seek(0)
        printed = said.read()
    if "Traceback" in printed:
        return at_work, ("traceback", printed[-1500:])
    if status not in ((-signal.SIGKILL, 0) if target == "study" else (-signal.SIGKILL, 0, 1, 2, 3)):
        return at_work, ("wrong status", f"{target}, {jobs} jobs: {status}: {printed[-500:]}")
    end = time.monotonic() + ENDING
    while any(map(_runs, family)) and time.monotonic() < end:
        time.sleep(0.05)
    left = [pid for pid in family if _runs(pid)]
    return at_work, ("left running", f"{target}, {jobs} jobs: {left}") if left else None


def _after(path: Path, expected: Outcomes, kept: Outcomes) -> tuple[str, Store | None]:
    """Return what a kill left: as before, and more of the same."""
    if not path.exists():
        return "before the file was there", None
    try:
        store = Store(path)
        found = _outcomes(store)
        damaged = damaged_chunks(store)
    except StoreError:
        return "lost", None
    if not kept.items() <= found.items():
        return "lost", store
    if not found.items() <= expected.items() or damaged:
        return "other numbers", store
    return "what was finished is there", store


def _outcomes(store: Store) -> Outcomes:
    return {key: (record.outcome, record.failure) for key, record in store.records().items()}


def _forget(file: Path) -> None:
    import shutil

    for old in file.parent.glob("study.sqlite*"):
        shutil.rmtree(old) if old.is_dir() else old.unlink()


def _keeps_semaphores(pid: int) -> bool:
    """Whether a process is Python's own for semaphores: it holds no work, and complains itself where it was killed."""
    try:
        return b"resource_tracker" in Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return False


def _runs(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False
