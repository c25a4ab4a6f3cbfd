"""SIGKILL in the middle of runs, a full disk, two processes: nothing finished is lost, not a bit changes."""

from __future__ import annotations

import json
import random
import signal
import subprocess
import sys
import time

import pytest

from canon import Gauss, Splitting, Taylor
from canon.study.cases.run_study import resume, run_study, status_of
from canon.study.cases.store import Store
from canon.study.cases.study import Study

LONG = Study.of(
    system=["henon-heiles", "kepler"],
    method=[Splitting("kahan-li-8"), Gauss(2), Taylor()],
    step=0.05,
    span=400.0,
    samples=512,
    parts=16,
)

PROGRAM = """
import sys
from tests.study.test_interrupted import LONG
from canon.study.cases.run_study import run_study

run_study(LONG, sys.argv[1], progress=lambda status: print(status, flush=True), checkpoint_seconds=0.0)
"""

SLOWLY = f"import time\n{PROGRAM}".replace("flush=True)", "flush=True) or time.sleep(0.02)")


def outcomes(store):
    return {key: (record.outcome, record.failure) for key, record in store.records().items()}


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    store = Store(tmp_path_factory.mktemp("study") / "whole.sqlite")
    assert run_study(LONG, store).finished == 6
    return outcomes(store)


def begin(path, program=PROGRAM):
    return subprocess.Popen([sys.executable, "-c", program, str(path)], stdout=subprocess.PIPE, text=True)


def kill_after(program, lines, seconds=0.0):
    """Kill a program some time after it printed so many lines; tell whether it was still at work."""
    seen = sum(bool(program.stdout.readline()) for _ in range(lines))
    time.sleep(seconds)
    program.send_signal(signal.SIGKILL)
    status = program.wait()
    program.stdout.close()
    return seen == lines and status == -signal.SIGKILL


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="it is killed as POSIX does")
def test_killed_inside_a_run_of_every_method_it_ends_the_same(tmp_path, uninterrupted):
    store = Store(tmp_path / "killed.sqlite")
    draw = random.Random(1)
    methods, kept = set(), {}
    for finished in range(3):
        program = begin(store.path, SLOWLY)
        while finished and f"{finished} finished" not in program.stdout.readline():
            pass
        assert kill_after(program, lines=draw.randint(2, 6), seconds=draw.uniform(0.0, 0.03))
        found = outcomes(store)
        assert kept.items() <= found.items() <= uninterrupted.items()
        kept = found
        ((key, part),) = store.parts_done().items()
        assert 0 < part < 16
        methods.add(next(iter(json.loads(store.cases()[key])["method"])))
    assert methods == {"splitting", "gauss", "taylor"}
    assert resume(store, checkpoint_seconds=1000.0).pending == 0
    assert outcomes(store) == uninterrupted
    assert store.parts_done() == {}


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="it is killed as POSIX does")
def test_killed_at_any_moment_it_ends_the_same(tmp_path, uninterrupted):
    store = Store(tmp_path / "killed.sqlite")
    draw = random.Random(2)
    kept, inside = {}, 0
    for _ in range(24):
        kill_after(begin(store.path), lines=draw.randint(1, 4), seconds=draw.uniform(0.0, 0.01))
        found, parts = outcomes(store), store.parts_done()
        assert kept.items() <= found.items() <= uninterrupted.items()
        assert all(0 < part < 16 for part in parts.values())
        kept, inside = found, inside + bool(parts)
    assert inside >= 8
    assert resume(store).pending == 0
    assert outcomes(store) == uninterrupted


def test_progress_tells_how_much_of_a_run_is_done(tmp_path):
    seen = []
    study = Study(LONG.cases[:2])
    run_study(study, tmp_path / "seen.sqlite", progress=seen.append, checkpoint_seconds=0.0)
    assert [status.finished + status.partly for status in seen] == [k / 16 for k in range(1, 33)]
    assert [status.begun for status in seen] == ([1] * 15 + [0]) * 2


@pytest.mark.slow
def test_two_processes_on_one_study(tmp_path, uninterrupted):
    path = tmp_path / "shared.sqlite"
    both = [begin(path) for _ in range(2)]
    for program in both:
        program.communicate()
        assert program.returncode == 0
    assert status_of(Store(path)).finished == 6
    assert outcomes(Store(path)) == uninterrupted


FULL_DISK = """
import resource, sys
from pathlib import Path
from tests.study.test_interrupted import LONG
from canon.study.cases.run_study import run_study
from canon.study.cases.store import StoreError

run_study(type(LONG)(LONG.cases[:1]), sys.argv[1])
limit = Path(sys.argv[1]).stat().st_size + 20_000
resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
try:
    run_study(LONG, sys.argv[1], checkpoint_seconds=0.0)
except StoreError as error:
    print(error)
"""


@pytest.mark.slow
@pytest.mark.skipif(
    sys.platform == "win32", reason="no limit on the size of files stands in for a full disk there"
)
def test_a_disk_that_fills_up_in_mid_study(tmp_path, uninterrupted):
    """A limit on the size of files stands in for a full disk."""
    path = tmp_path / "full.sqlite"
    said, _ = begin(path, FULL_DISK).communicate()
    assert "the disk is full" in said
    assert "what was finished before is kept: make room and run again" in said
    store = Store(path)
    assert 1 <= len(store.records()) < 6
    assert outcomes(store).items() <= uninterrupted.items()
    run_study(LONG, store)
    assert outcomes(store) == uninterrupted
