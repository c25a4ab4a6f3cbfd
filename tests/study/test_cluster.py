"""A study on a cluster: dask's scheduler and two worker processes on loopback, one of them killed on the way."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

import distributed
import pytest

from canon import Gauss, Splitting, Taylor
from canon.cli import main
from canon.study.cases.run_study import run_study
from canon.study.cases.store import Store
from canon.study.cases.study import Study

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


@pytest.fixture
def cluster(tmp_path):
    """Return the scheduler's address; two workers have joined it."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    address_file = tmp_path / "scheduler.json"
    started = []

    def start(module, *arguments):
        command = [sys.executable, "-m", f"distributed.cli.{module}", *arguments]
        process = subprocess.Popen(command, cwd=tmp_path, env=environment, stderr=subprocess.DEVNULL)
        started.append(process)

    start(
        "dask_scheduler",
        "--host",
        "127.0.0.1",
        "--port",
        "0",
        "--no-dashboard",
        "--scheduler-file",
        str(address_file),
    )
    for name in ("one", "two"):
        start(
            "dask_worker", "--scheduler-file", str(address_file), "--no-nanny", "--nthreads", "1", "--no-dashboard",
            "--name", name, "--local-directory", str(tmp_path / name),
        )  # fmt: skip
    yield address_file
    for process in started:
        process.kill()
        process.wait(30)


@pytest.mark.slow
def test_a_cluster_of_which_a_worker_is_killed_gives_the_same(tmp_path, cluster):
    here = Store(tmp_path / "here.sqlite")
    run_study(STUDY, here)
    store = Store(tmp_path / "cluster.sqlite")
    with distributed.Client(scheduler_file=str(cluster), timeout=60) as client:
        client.wait_for_workers(2, timeout=60)
        pids = client.run(os.getpid)
        assert len(set(pids.values())) == 2
        legs = []

        def kill_one(status):
            legs.append(status)
            if len(legs) == 5:
                os.kill(next(iter(pids.values())), signal.SIGKILL)

        status = run_study(STUDY, store, client.get_executor(), progress=kill_one, checkpoint_seconds=0.0)
        assert len(client.scheduler_info()["workers"]) == 1
        file = tmp_path / "small.toml"
        file.write_text('[[study]]\nsystem = "henon-heiles"\nmethod = "verlet"\nstep = 0.1\nspan= 300\n')
        assert main(["study", "run", str(file), "--dask", client.scheduler.address]) == 0
    assert (status.finished, status.failed, status.pending) == (10, 0, 0)
    assert len(legs) == 40  # each part came back once
    assert outcomes(store) == outcomes(here)
