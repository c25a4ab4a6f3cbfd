"""Studies on executors: what is finished is not run again, failures are rows, keys hold every input."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace

import pytest
from sympy import Symbol

from canon import DOP853, RK4, Splitting, Taylor
from canon.flow.method.method import Gauss, TimeTransformed
from canon.flow.method.method_text import method_from
from canon.flow.method.solvable_splitting import SABA, SBAB, WisdomHolman
from canon.study.cases import run_study as run
from canon.study.cases.case import Case, key_of
from canon.study.cases.export import rows_of
from canon.study.cases.run_study import resume, run_study, status_of
from canon.study.cases.store import Store
from canon.study.cases.study import Study
from canon.study.energy_drift.drift_study import StudyError
from canon.study.motion.hamiltonian_text import Formula

QUARTIC = Formula("quartic", "p**2/2 + k*q**4/4", ("q",), ("p",), (("k", 2.0),), (("there", (1.0, 0.0)),))
SHORT = Study.of(
    system=["henon-heiles", "simple-pendulum"],
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
    for row in rows_of(uninterrupted):
        assert row["state"] == "finished"
        assert row["bound"] > 0.0
        assert len(row["final"]) in (2, 4)
        assert row["seconds"] > 0.0


def test_what_is_finished_is_not_run_again(uninterrupted, monkeypatch, tmp_path):
    def never(case, reached, seconds):
        raise AssertionError(f"{case} was run again")

    monkeypatch.setattr(run, "advance", never)
    before = outcomes(uninterrupted)
    run_study(SHORT, uninterrupted)
    assert outcomes(uninterrupted) == before
    with pytest.raises(AssertionError, match="was run again"):
        run_study(Study((replace(SHORT.cases[0], samples=600),)), tmp_path / "new.sqlite")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="it is killed as POSIX does")
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


def test_long_cases_take_turns_only_with_few_others(tmp_path):
    """With one worker two cases are under way at a time, not all of them."""
    seen = []
    study = Study(tuple(replace(case, parts=4) for case in SHORT.cases if case.method != Taylor()))
    with ThreadPoolExecutor(1) as pool:
        run_study(study, tmp_path / "turns.sqlite", pool, progress=seen.append, checkpoint_seconds=0.0)
    assert max(status.begun for status in seen) == 2
    with ThreadPoolExecutor(1) as pool:
        many = tmp_path / "many.sqlite"
        run_study(study, many, pool, progress=seen.append, checkpoint_seconds=0.0, in_flight=8)
    assert max(status.begun for status in seen) == 8
    assert outcomes(Store(many)) == outcomes(Store(tmp_path / "turns.sqlite"))
    with pytest.raises(StudyError, match="at least one case"):
        run_study(study, many, in_flight=0)


def test_failures_are_rows_with_reasons(tmp_path):
    methods = ["verlet", "rk4", "wisdom-holman", {"splitting": {"a": ["1/2", "1/2"], "b": [1]}}]
    study = Study.of(system="double-pendulum", method=methods, step=0.02, periods=20.0, samples=300)
    store = Store(tmp_path / "failures.sqlite")
    status = run_study(study, store)
    assert (status.finished, status.failed, status.pending) == (1, 3, 0)
    failed, finished, *others = rows_of(store)
    assert all(row["failure"] and "bound" not in row for row in others)
    assert failed["state"] == "failed"
    assert "does not split" in failed["failure"]
    assert "bound" not in failed
    assert failed["seconds"] == 0.0
    assert finished["verdict"] in ("secular", "bounded", "undecided")


def test_every_input_is_part_of_the_key(monkeypatch):
    case = Case("simple-pendulum", RK4(), span=100.0, step=0.1)
    others = [
        replace(case, system="duffing-oscillator"),
        replace(case, method=Splitting("verlet")),
        replace(case, span=101.0),
        replace(case, samples=500),
        replace(case, start="small"),
        replace(case, start=(2.0, 0.0)),
        replace(case, parameters=(("l", 2.0),)),
        replace(case, step=0.2),
        replace(case, precision="double"),
        replace(case, parts=2),
        replace(case, system=QUARTIC),
        replace(case, system=replace(QUARTIC, H="p**2/2 + k*q**6/6")),
        replace(case, system=replace(QUARTIC, parameters=(("k", 3.0),))),
        replace(case, system=replace(QUARTIC, starts=(("there", (0.5, 0.0)),))),
    ]
    keys = {key_of(each) for each in (case, *others)}
    assert len(keys) == 1 + len(others)
    monkeypatch.setattr("canon.study.cases.case.versions", lambda: {"heyoka": "other"})
    assert key_of(case) not in keys


def test_a_file_begun_with_other_versions_is_not_resumed(tmp_path, monkeypatch):
    store = Store(tmp_path / "old.sqlite")
    case = SHORT.cases[0]
    with monkeypatch.context() as patch:
        patch.setattr("canon.study.cases.case.versions", lambda: {"canon": "0.0"})
        store.add_cases({key_of(case): case.to_text()})
    with pytest.raises(StudyError, match=r"begun with other versions \(canon 0\.0\)"):
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
        DOP853(1e-9),
        WisdomHolman(),
        WisdomHolman(corrector=7),
        SABA(4),
        SABA("10-6-4"),
        SBAB(3),
        SBAB(3, commutator=True),
        WisdomHolman(corrector=7, coordinates="democratic-heliocentric"),
        TimeTransformed(Splitting("verlet")),
    ],
)
def test_methods_and_cases_survive_writing(method):
    written = json.loads(json.dumps(method.written))
    assert method_from(written) == method
    assert len({key_of(Case("kepler", m, span=1.0)) for m in (method, Splitting("suzuki-4"))}) == 2
    case = Case("kepler", method, span=0.1 + 0.2, start=(0.4, 0.0, 0.0, 12.1), parameters=(("mu", 39.0),))
    again = Case.from_dict(json.loads(json.dumps(case.to_dict())))
    assert again == case
    assert key_of(again) == key_of(case)


@pytest.mark.parametrize(
    "method",
    [
        Splitting("verlet", parts=(Symbol("p") ** 2, Symbol("q") ** 2)),
        WisdomHolman(parts=(Symbol("p") ** 2, Symbol("q") ** 2)),
        TimeTransformed(Gauss(4), g=Symbol("q")),
    ],
)
def test_methods_that_are_no_text_are_refused(method):
    with pytest.raises(ValueError, match="a study takes"):
        _ = method.written
    with pytest.raises(StudyError, match="a study takes"):
        Study.of(system="kepler", method=method, step=0.1, span=10.0)
