"""The judging pool: any thread asks, every claim gets its answer, a killed process costs its claim only."""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
import time
from concurrent.futures import CancelledError, ThreadPoolExecutor
from dataclasses import replace

import pytest

import canon
from canon.exercise import JudgePool, Sheet, SheetError, judge_pool, judging_process, read_sheet
from canon.exercise.judge_pool import CLAIMS_A_PROCESS
from canon.exercise.judging_process import BROKE_OFF, Worker
from canon.exercise.sheet.sheet import Claim, claim_from
from canon.exercise.waiting_claims import AHEAD, WaitingClaims
from canon.process import ABANDONED, Child, Ended

from .endless_claim import ENDLESS, WatchedWorker, at_work

RIGHT = {"id": "right", "kind": "equality-only", "lhs": "2*x", "rhs": "x + x", "parameters": {"x": "real"}}
WRONG = {**RIGHT, "id": "wrong", "rhs": "x + 1"}
LONG = {
    **RIGHT,
    "id": "long",
    "lhs": "(x + t + cos(x) + 1)**60*sin(x)**40",
    "rhs": "(x + t + cos(x) + 1)**60*(1 - cos(x)**2)**20 + x*0",
}


@pytest.fixture(scope="module")
def pool():
    with JudgePool(workers=2, budget=5.0) as made:
        yield made


def test_every_thread_gets_the_answer_to_its_own_question(pool):
    asked = [RIGHT if k % 3 else WRONG for k in range(30)]
    with ThreadPoolExecutor(8) as threads:
        found = list(threads.map(pool.judge, asked))
    assert [judgement.status for judgement in found] == ["holds" if k % 3 else "fails" for k in range(30)]


def test_an_ill_formed_claim_is_invalid(pool):
    assert pool.judge({"id": "a", "kind": "equality-only", "lhs": "1"}).status == "invalid"


@pytest.mark.skipif(sys.platform == "win32", reason="it is killed as POSIX does")
def test_a_killed_process_costs_its_claim_only(pool):
    before = [worker._child.pid for worker in pool._all if worker._child]
    for pid in before:
        os.kill(pid, signal.SIGKILL)
    found = [pool.judge(RIGHT).status for _ in range(6)]
    assert found.count("holds") >= 4
    assert found[-1] == "holds"
    assert {worker._child.pid for worker in pool._all}.isdisjoint(before)


def test_the_budget_of_the_pool_is_that_of_every_claim():
    with JudgePool(workers=1, budget=0.2, warm=False) as pool:
        late = pool.judge({**LONG, "budget": 3000})
        assert late.status == "undecided"
        assert pool.judge(WRONG).status == "fails"


def test_a_process_is_replaced_after_many_claims():
    with JudgePool(workers=1, warm=False) as pool:
        assert pool.judge(RIGHT).status == "holds"
        (worker,) = pool._all
        old, worker.judged = worker._child.pid, CLAIMS_A_PROCESS
        assert pool.judge(RIGHT).status == "holds"
        assert worker.judged == 0
        assert worker._child.pid != old
        assert pool.judge(WRONG).status == "fails"


def test_a_closed_pool_says_so():
    pool = JudgePool(workers=1, warm=False)
    pool.close()
    pool.close()
    with pytest.raises(ValueError, match="the pool is closed"):
        pool.judge(RIGHT)


@pytest.mark.parametrize(("given", "told"), [({"workers": 0}, "1 or more"), ({"budget": -1.0}, "up to 3600")])
def test_what_makes_no_sense_is_refused(given, told):
    with pytest.raises(ValueError, match=told):
        JudgePool(**given)


TOML = '[[claim]]\nid = "right"\nkind = "equality-only"\nlhs = "2*x"\nrhs = "x + x"\nparameters = { x = "real" }\n'


@pytest.mark.parametrize(
    "source", [TOML, json.dumps({"claims": [RIGHT]}), json.dumps([RIGHT]), {"claims": [RIGHT]}, [RIGHT]]
)
def test_a_sheet_is_read_from_text_and_from_tables(source):
    (claim,) = read_sheet(source).claims
    assert (claim.id, claim.errors) == ("right", ())


def test_numbers_of_a_table_are_read_as_in_a_file():
    table = {"claims": [{**RIGHT, "budget": 2.5}]}
    assert read_sheet(table).claims[0] == read_sheet(json.dumps(table)).claims[0]
    assert read_sheet(table).claims[0].budget == 2.5


def test_what_is_no_sheet_is_refused():
    for source in ({"claims": [{"id": {1, 2}}]}, {"claims": [{"id": float("nan")}]}, "{", "a = [\n"):
        with pytest.raises(SheetError):
            read_sheet(source)


def test_a_sheet_is_checked_by_the_pool_and_by_check_within_a_budget(pool):
    table = {"title": "two", "claims": [RIGHT, WRONG, {**RIGHT, "id": "again"}]}
    report = pool.check(table)
    assert [judgement.id for judgement in report] == ["right", "wrong", "again"]
    assert report.counts == {"holds": 2, "fails": 1}
    late = canon.check(Sheet("long", (Claim("long", "equality-only", LONG, budget=3000.0),)), budget=0.2)
    assert late.counts == {"undecided": 1}


def equality(number, lhs, rhs):
    return Claim(str(number), "equality-only", {"lhs": lhs, "rhs": rhs, "parameters": {"x": "real"}})


def test_a_process_goes_on_with_the_questions_it_has_judged():
    """Two questions in turns: each worker keeps its own while there is some of it within reach, then helps out."""
    waiting = WaitingClaims({str(i): equality(i, f"sin(x)*{i % 2 + 2}", str(i)) for i in range(8)})
    taken = {worker: [] for worker in "ab"}
    for worker in "abaaabbb":
        taken[worker].append(int(waiting.next_for(worker)[0]))
    assert taken == {"a": [0, 2, 4, 6], "b": [1, 3, 5, 7]}


def test_nobody_is_without_work_and_nothing_is_judged_twice():
    waiting = WaitingClaims({str(i): equality(i, "sin(x)", str(i)) for i in range(250)})
    taken = [int(waiting.next_for(i % 3)[0]) for i in range(250)]
    assert sorted(taken) == list(range(250))
    assert max(abs(turn - i) for turn, i in enumerate(taken)) <= AHEAD


def test_judgements_come_in_the_order_of_the_claims(pool):
    claims = [equality(i, f"{i % 3}*x", f"x*{i % 3} + {i % 2}") for i in range(24)]
    found = list(pool.judged(claims))
    assert [j.id for j in found] == [c.id for c in claims]
    assert [j.status for j in found] == ["fails" if i % 2 else "holds" for i in range(24)]


def test_a_pool_that_is_closed_meanwhile_says_so_to_whoever_waits():
    with JudgePool(workers=1, warm=False) as pool:
        judged = pool.judged([equality(i, "x", f"x + {i}") for i in range(50)])
        assert next(judged).status == "holds"
        pool.close()
        with pytest.raises((CancelledError, ValueError, OSError)):
            list(judged)


def test_a_pool_that_is_closed_while_it_judges_starts_no_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(judge_pool, "Worker", WatchedWorker)
    pool = JudgePool(workers=1, budget=20.0, warm=False)
    with ThreadPoolExecutor(1) as thread:
        judged = thread.submit(pool.judge, ENDLESS)
        at_work()
        pool.close()
        assert judged.result().status == "undecided"
    assert (pool.started, pool.processes) == (1, ())


class Gone(Child):
    """A process that was killed while it started, before anybody could notice."""

    def __init__(self) -> None:
        pass

    @property
    def usable(self) -> bool:
        return True

    def receive(self, deadline: float) -> bytes:
        raise Ended

    def kill(self) -> None:
        pass


def test_a_process_that_was_killed_while_it_started_costs_no_claim() -> None:
    with Worker(Gone()) as worker:
        assert worker.judge(claim_from(RIGHT)).status == "holds"


@pytest.mark.skipif(sys.platform == "win32", reason="no process is halted there")
def test_a_process_that_is_killed_before_a_claim_comes_to_it_costs_no_verdict() -> None:
    """However long that takes: it was said to be undecided where the machine was busy."""
    with Worker() as worker, ThreadPoolExecutor(1) as thread:
        assert worker.judge(claim_from(RIGHT)).status == "holds"
        halted = worker.pid
        os.kill(halted, signal.SIGSTOP)
        asked = thread.submit(worker.judge, claim_from(WRONG))
        while worker.judged < 2:
            time.sleep(0.01)
        time.sleep(0.2)
        assert not worker.heard
        os.kill(halted, signal.SIGKILL)
        assert asked.result().status == "fails"
        assert worker.started == 2


def test_a_worker_that_is_closed_while_its_process_starts_kills_it(monkeypatch: pytest.MonkeyPatch) -> None:
    worker, started = Worker(), list[Child]()

    def child(module: str, *, leads: bool) -> Child:
        worker.close()
        started.append(Child(module, leads=leads))
        return started[0]

    monkeypatch.setattr(judging_process, "Child", child)
    with pytest.raises(Ended, match="closed"):
        worker.start()
    assert [each.usable for each in started] == [False]
    assert worker.judge(claim_from(RIGHT)).status == "undecided"
    assert len(started) == 1


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no process is halted there")
def test_a_process_that_others_keep_from_the_processor_is_waited_for():
    """Its own timer counts seconds on the clock: it ended itself while the pool still waited, "memory, or a fault"."""
    with Worker() as worker:
        assert worker.judge(Claim("first", "equality-only", {"lhs": "1", "rhs": "1"})).status == "holds"
        pid = worker.pid
        timers = [
            threading.Timer(seconds, os.kill, (pid, sign))
            for seconds, sign in ((0.5, signal.SIGSTOP), (2.0 + ABANDONED + 0.5, signal.SIGCONT))
        ]
        for timer in timers:
            timer.start()
        found = worker.judge(replace(claim_from(ENDLESS), budget=2.0))
        for timer in timers:
            timer.cancel()  # a process that had ended before could not be woken
            timer.join()
    assert found.status == "undecided"
    assert found.known != BROKE_OFF
