"""Studies: what is finished is not run again, nothing finished is lost, resumed results are the same bit for bit."""

from __future__ import annotations

import csv
import io
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace

import pytest

from canon import DOP853, RK4, Splitting, Taylor
from canon.flow.method import Gauss
from canon.study import run
from canon.study.case import Case, key_of, method_from, method_to
from canon.study.comparison import StudyError
from canon.study.export import csv_of
from canon.study.run import Study, finished_rows, read_study, resume, run_study, status_of
from canon.study.store import Store

SHORT = Study.of(
    scene=["henon-heiles", "simple-pendulum"],
    method=[Splitting("verlet"), RK4(), Taylor()],
    step=[0.05, 0.1],
    periods=40.0,
    samples=512,
)


def outcomes(store):
    return {key: (record.outcome, record.failure) for key, record in store.records().items()}


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    store = Store(tmp_path_factory.mktemp("study") / "whole.sqlite")
    status = run_study(SHORT, store)
    assert (status.finished, status.failed, status.pending) == (10, 0, 0)
    return store


def test_the_product_has_no_case_twice():
    assert len(SHORT.cases) == 2 * (2 + 2 + 1)
    assert all(case.step is None for case in SHORT.cases if case.method == Taylor())


def test_every_case_has_its_numbers(uninterrupted):
    for row in finished_rows(uninterrupted):
        assert row["state"] == "finished"
        assert row["bound"] > 0.0
        assert len(row["final"]) in (2, 4)
        assert row["seconds"] > 0.0


def test_what_is_finished_is_not_run_again(uninterrupted, monkeypatch, tmp_path):
    def never(case):
        raise AssertionError(f"{case} was run again")

    monkeypatch.setattr(run, "run_case", never)
    before = outcomes(uninterrupted)
    run_study(SHORT, uninterrupted)
    assert outcomes(uninterrupted) == before
    with pytest.raises(AssertionError, match="was run again"):
        run_study(Study((replace(SHORT.cases[0], samples=600),)), tmp_path / "new.sqlite")


PROGRAM = """
import sys, time
from tests.study.test_run import SHORT
from canon.study.run import run_study

def slowly(status):
    print(status, flush=True)
    time.sleep(0.2)

run_study(SHORT, sys.argv[1], progress=slowly)
"""


@pytest.mark.parametrize("finished", [pytest.param(1, marks=pytest.mark.slow), 4])
def test_killed_at_any_moment_and_resumed_it_ends_the_same(tmp_path, uninterrupted, finished):
    path = tmp_path / "killed.sqlite"
    program = subprocess.Popen([sys.executable, "-c", PROGRAM, str(path)], stdout=subprocess.PIPE, text=True)
    assert program.stdout is not None
    for _ in range(finished):
        assert program.stdout.readline()
    program.send_signal(signal.SIGKILL)
    program.wait(30)
    program.stdout.close()
    store = Store(path)
    kept = outcomes(store)
    assert finished <= len(kept) < 10
    status = resume(store)
    assert (status.finished, status.pending) == (10, 0)
    assert outcomes(store) == outcomes(uninterrupted)
    assert kept.items() <= outcomes(store).items()


def test_a_process_pool_gives_the_same_and_survives_a_killed_worker(tmp_path, uninterrupted):
    store = Store(tmp_path / "pool.sqlite")
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn) as pool:
        worker = pool.submit(os.getpid).result()

        def kill_the_worker(status):
            if status.finished == 2:
                os.kill(worker, signal.SIGKILL)
                time.sleep(0.2)

        with pytest.raises(StudyError, match=r"workers died .*what was finished is kept, run again"):
            run_study(SHORT, store, pool, progress=kill_the_worker)
    assert 2 <= status_of(store).finished < 10
    with ProcessPoolExecutor(1, mp_context=spawn) as pool:
        assert run_study(SHORT, store, pool).pending == 0
    assert outcomes(store) == outcomes(uninterrupted)


def test_threads_give_the_same(tmp_path, uninterrupted):
    store = Store(tmp_path / "threads.sqlite")
    seen = []
    with ThreadPoolExecutor(2) as pool:
        run_study(SHORT, store, pool, progress=seen.append)
    assert outcomes(store) == outcomes(uninterrupted)
    assert [status.finished for status in seen] == list(range(1, 11))
    assert seen[-1].pending == 0


def test_failures_are_rows_with_reasons(tmp_path):
    study = Study.of(scene="double-pendulum", method=["verlet", "rk4"], step=0.02, periods=20.0, samples=300)
    store = Store(tmp_path / "failures.sqlite")
    status = run_study(study, store)
    assert (status.finished, status.failed, status.pending) == (1, 1, 0)
    failed, finished = finished_rows(store)
    assert failed["state"] == "failed"
    assert "does not split" in failed["failure"]
    assert "bound" not in failed
    assert finished["verdict"] in ("secular", "bounded", "undecided")


def test_every_input_is_part_of_the_key(monkeypatch):
    case = Case("simple-pendulum", RK4(), span=100.0, step=0.1)
    others = [
        replace(case, scene="duffing-oscillator"),
        replace(case, method=Splitting("verlet")),
        replace(case, span=101.0),
        replace(case, samples=500),
        replace(case, start="small"),
        replace(case, start=(2.0, 0.0)),
        replace(case, parameters=(("l", 2.0),)),
        replace(case, step=0.2),
        replace(case, precision="double"),
    ]
    keys = {key_of(each) for each in (case, *others)}
    assert len(keys) == 1 + len(others)
    monkeypatch.setattr("canon.study.case.version", lambda name: "other")
    assert key_of(case) not in keys


def test_a_file_begun_with_other_versions_is_not_resumed(tmp_path, monkeypatch):
    store = Store(tmp_path / "old.sqlite")
    case = SHORT.cases[0]
    with monkeypatch.context() as patch:
        patch.setattr("canon.study.case.version", lambda name: "1.0")
        store.add_cases({key_of(case): json.dumps(case.to_dict())})
    with pytest.raises(StudyError, match="begun with other versions"):
        resume(store)


@pytest.mark.parametrize(
    "method",
    [
        Splitting("kahan-li-8"),
        Splitting(a=["1/3", "2/3"], b=["1/2", "1/2"]),
        Gauss(4),
        RK4(),
        Taylor(),
        Taylor(1e-9),
        DOP853(),
    ],
)
def test_methods_and_cases_survive_writing(method):
    written = json.loads(json.dumps(method_to(method)))
    assert method_from(written) == method
    case = Case("kepler", method, span=0.1 + 0.2, start=(0.4, 0.0, 0.0, 12.1), parameters=(("mu", 39.0),))
    again = Case.from_dict(json.loads(json.dumps(case.to_dict())))
    assert again == case
    assert key_of(again) == key_of(case)


def test_a_study_from_a_file(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(
        """
        [[study]]
        scene = "kepler"
        start = ["e=0.6", "e=0.0167"]
        method = ["kahan-li-8", "rk4", { gauss = 4 }]
        step = [0.01, 0.02]
        periods = 100

        [[study]]
        scene = "simple-pendulum"
        method = "taylor"
        tolerance = [1e-8, 1e-12]
        until = 50.0
        parameters = { l = 2.0 }
        """
    )
    cases = read_study(file).cases
    assert len(cases) == 2 * 3 * 2 + 2
    assert cases[-1] == Case("simple-pendulum", Taylor(), 50.0, parameters=(("l", 2.0),), tolerance=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "[[study]]\nscene = 'keplr'\nmethod='rk4'\nstep=1\nperiods=1",
            "study 1: there is no scene 'keplr'; did you mean kepler",
        ),
        ("[[study]]\nscene = 'kepler'\nmethod='rk5'\nstep=1\nperiods=1", "no method is written rk5"),
        ("[[study]]\nscene = 'kepler'\nmethod='rk4'\nperiods=1", "RK4 takes fixed steps: give step"),
        ("[[study]]\nscene = 'kepler'\nmethod='rk4'\nstep=1", "duration as periods or as until"),
        ("[[study]]\nscene = 'kepler'\nmethod='rk4'\nsteps=1\nperiods=1", "unknown key 'steps'"),
        ("[[study]]\nscene = 'kepler'\nperiods=1", "'method' is missing"),
        ("scene = 'kepler'", "holds \\[\\[study\\]\\] tables"),
        ("[[study]\n", "study.toml"),
    ],
)
def test_what_is_wrong_in_a_file_is_named(tmp_path, text, message):
    file = tmp_path / "study.toml"
    file.write_text(text)
    with pytest.raises(StudyError, match=message):
        read_study(file)


def test_csv_holds_every_case_exactly(uninterrupted):
    lines = list(csv.DictReader(io.StringIO(csv_of(uninterrupted))))
    rows = finished_rows(uninterrupted)
    assert [line["key"] for line in lines] == [row["key"] for row in rows]
    for line, row in zip(lines, rows, strict=True):
        assert float(line["slope"]) == row["slope"]
        assert json.loads(line["final"]) == row["final"]
        assert method_from(json.loads(line["method"])) == method_from(row["method"])
        assert line["tolerance"] == ""
