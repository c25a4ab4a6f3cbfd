"""A study on a cluster: dask's scheduler and worker processes on loopback, killed in mid-case or out of memory."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import distributed
import numpy as np
import pytest

from canon import Gauss, Splitting, Taylor
from canon.cli import main
from canon.study import StudyError
from canon.study.cases.run_study import run_study, status_of
from canon.study.cases.store import Store
from canon.study.cases.study import Study

from .kept_studies import all_of

STUDY = Study.of(
    system=["henon-heiles", "simple-pendulum"],
    method=[Splitting("verlet"), Gauss(2), Taylor()],
    step=[0.05, 0.1],
    span=300.0,
    samples=512,
    parts=4,
)


def outcomes(store):
    return {key: (record.outcome, record.failure) for key, record in store.records().items()}


BEYOND_THE_GUARD = 600.0
"""Seconds that dask waits for its scheduler: more than a test may take."""


@pytest.fixture
def start(tmp_path):
    """Return what starts a scheduler and workers, each with further arguments, and returns the scheduler's file."""
    address_file = tmp_path / "scheduler.json"
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(sys.path),
        "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1",
    }
    started = []

    def begin(module, *arguments):
        command = [sys.executable, "-m", f"distributed.cli.{module}", *arguments]
        process = subprocess.Popen(command, cwd=tmp_path, env=environment, stderr=subprocess.DEVNULL)
        started.append(process)

    def scheduler_and(*workers):
        begin(
            "dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
            "--scheduler-file", str(address_file),
        )  # fmt: skip
        for number, arguments in enumerate(workers):
            begin(
                "dask_worker", "--scheduler-file", str(address_file), "--nthreads", "1", "--no-dashboard",
                "--name", f"worker{number}", "--local-directory", str(tmp_path / f"worker{number}"), *arguments,
            )  # fmt: skip
        return address_file

    yield scheduler_and
    for process in reversed(started):
        process.terminate()  # a nanny ends its worker
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait(30)


@pytest.fixture
def cluster(start):
    """Return the scheduler's file; two workers join it."""
    return start(["--no-nanny"], ["--no-nanny"])


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="it is killed as POSIX does")
def test_a_cluster_of_which_a_worker_is_killed_gives_the_same(tmp_path, cluster):
    here = Store(tmp_path / "here.sqlite")
    run_study(STUDY, here)
    store = Store(tmp_path / "cluster.sqlite")
    with distributed.Client(scheduler_file=str(cluster), timeout=BEYOND_THE_GUARD) as client:
        client.wait_for_workers(2)
        pids = client.run(os.getpid)
        assert len(set(pids.values())) == 2
        legs = []

        def kill_one(status):
            legs.append(status)
            if len(legs) == 5:
                os.kill(next(iter(pids.values())), signal.SIGKILL)

        status = run_study(STUDY, store, client.get_executor(), progress=kill_one, checkpoint_seconds=0.0)
        wait_for_one_worker(client)
        file = tmp_path / "small.toml"
        file.write_text('[[study]]\nsystem = "henon-heiles"\nmethod = "verlet"\nstep = 0.1\nspan= 300\n')
        assert main(["study", "run", str(file), "--dask", client.scheduler.address]) == 0
    assert (status.finished, status.failed, status.pending) == (10, 0, 0)
    assert len(legs) == 40  # each part came back once
    assert outcomes(store) == outcomes(here)


def wait_for_one_worker(client):
    """Return once the scheduler has noticed the worker that was killed: it hears of it some time after."""
    while len(client.scheduler_info()["workers"]) != 1:
        time.sleep(0.1)


LONG = Study.of(
    system="henon-heiles", method=["kahan-li-8", "taylor"], step=0.01, span=4000.0, samples=512, parts=8,
    keep=["motion", {"section": "x"}],
)  # fmt: skip


def extent(motion):
    return abs(motion.y).max(axis=1)


@pytest.mark.skipif(sys.platform == "win32", reason="it is killed as POSIX does")
def test_a_worker_killed_in_mid_case_changes_no_bit_of_what_is_kept(tmp_path, cluster):
    """Two cases are under way, one at least with a checkpoint; the worker that is killed is running one of them."""
    keep, here, there = {"extent": extent}, tmp_path / "here.sqlite", Store(tmp_path / "cluster.sqlite")
    run_study(LONG, here, keep=keep)
    with distributed.Client(scheduler_file=str(cluster), timeout=BEYOND_THE_GUARD) as client:
        client.wait_for_workers(2)
        pids, killed = client.run(os.getpid), []

        def kill_a_busy_one(status):
            begun = there.parts_done()
            if killed or status.finished or not begun:
                return
            busy = [address for address, tasks in client.processing().items() if tasks]
            if busy:
                os.kill(pids[busy[0]], signal.SIGKILL)
                killed.append(begun)

        status = run_study(
            LONG,
            there,
            client.get_executor(),
            kill_a_busy_one,
            checkpoint_seconds=0.0,
            in_flight=2,
            keep=keep,
        )
        wait_for_one_worker(client)
    (begun,) = killed
    assert all(0 < part < 8 for part in begun.values())
    assert (status.finished, status.failed, status.pending) == (2, 0, 0)
    assert all_of(there.path) == all_of(here)


def large_for_pendulums(motion):
    blocks = []
    while motion.system == "simple-pendulum" and len(blocks) < 80:
        blocks.append(np.ones(2**22))
        time.sleep(0.02)
    return len(motion.t)


def test_a_case_beyond_the_memory_limit_is_told_and_the_others_finish(tmp_path, start):
    """The nanny kills the worker that takes more than 1 GB, again where the case is tried again; canon says which."""
    study = Study.of(
        system=["simple-pendulum", "henon-heiles"],
        method="verlet",
        step=0.1,
        span=100.0,
        samples=512,
        keep="motion",
    )
    here, there = tmp_path / "here.sqlite", tmp_path / "cluster.sqlite"
    with distributed.Client(
        scheduler_file=str(start(["--memory-limit", "1GB"], ["--memory-limit", "1GB"])),
        timeout=BEYOND_THE_GUARD,
    ) as client:
        client.wait_for_workers(2)
        told = (
            r"1 case took more memory than workers have.*simple-pendulum.*give workers more memory.*run again"
        )
        with pytest.raises(StudyError, match=told):
            run_study(study, there, client.get_executor(), keep={"large": large_for_pendulums}, in_flight=2)
        assert status_of(Store(there)).finished == 1
        client.wait_for_workers(1)
        assert (
            run_study(study, there, client.get_executor(), keep={"extent": extent}, in_flight=2).finished == 3
        )
    run_study(study, here, keep={"extent": extent})
    (rows, files), (whole, chunks) = all_of(here), all_of(there)
    assert rows.items() <= whole.items()
    assert files.items() <= chunks.items()


def test_memory_that_runs_out_on_a_worker_is_told_by_case(tmp_path):
    """A thread stands for the worker; MemoryError is what a limit of the system gives."""
    study = Study(STUDY.cases[:2])

    def too_large(motion):
        raise MemoryError("Unable to allocate 1 EiB")

    with (
        ThreadPoolExecutor(1) as pool,
        pytest.raises(
            StudyError, match=r"2 cases took more memory .*henon-heiles with verlet: MemoryError: Unable"
        ),
    ):
        run_study(study, tmp_path / "s.sqlite", pool, keep={"f": too_large})
    with pytest.raises(
        StudyError, match=r"1 case took more memory .*henon-heiles with verlet: MemoryError: Unable"
    ):
        run_study(study, tmp_path / "s.sqlite", keep={"f": too_large})
    assert status_of(Store(tmp_path / "s.sqlite")).pending == 2
