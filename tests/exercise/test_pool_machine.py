"""Whatever is asked of a judging pool, in whatever order, and whoever kills its processes: each claim gets its verdict.

A machine of hypothesis judges right, wrong and ill-formed claims, one by one and many at a time, kills processes that
are idle or at work, and looks at the verdicts and at what is running. One that is killed at work costs its own claim
the verdict.
"""

from __future__ import annotations

import os
import signal
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import Any

import pytest
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule, run_state_machine_as_test

from canon.exercise import JudgePool, judge_pool
from canon.exercise.judging_process import BROKE_OFF, NOT_STARTED
from canon.exercise.sheet.sheet import claim_from

from .endless_claim import ENDLESS, WatchedWorker, at_work

WORKERS = 2
BASE = {"kind": "equality-only", "parameters": {"x": "real"}}
CLAIMS: dict[str, dict[str, Any]] = {
    "holds": {**BASE, "id": "right", "lhs": "sin(2*x)", "rhs": "2*sin(x)*cos(x)"},
    "fails": {**BASE, "id": "wrong", "lhs": "sin(2*x)", "rhs": "2*sin(x)"},
    "invalid": {**BASE, "id": "ill-formed", "lhs": "sin(2*x", "rhs": "2*sin(x)"},
}
VERDICTS = st.sampled_from(sorted(CLAIMS))
"""Of claims; each is judged at face value, whatever came before it."""


def is_running(pid: int) -> bool:
    with suppress(ProcessLookupError):
        os.kill(pid, 0)
        return True
    return False


class PoolMachine(RuleBasedStateMachine):
    """A pool of two processes."""

    pool: JudgePool | None = None

    @initialize()
    def start(self) -> None:
        with pytest.MonkeyPatch.context() as patched:
            patched.setattr(judge_pool, "Worker", WatchedWorker)
            self.pool, self.seen = JudgePool(workers=WORKERS, budget=20.0), set[int]()

    def teardown(self) -> None:
        if self.pool is None:
            return
        self.pool.close()
        while any(map(is_running, self.seen)):  # a process that outlives its pool would hang here
            time.sleep(0.05)
        with pytest.raises(ValueError, match="closed"):
            self.pool.judge(CLAIMS["holds"])

    @rule(verdict=VERDICTS)
    def one(self, verdict: str) -> None:
        assert self.pool is not None
        assert self.pool.judge(CLAIMS[verdict]).status == verdict

    @rule(verdicts=st.lists(VERDICTS, min_size=1, max_size=6))
    def many(self, verdicts: list[str]) -> None:
        assert self.pool is not None
        claims = [claim_from({**CLAIMS[verdict], "id": f"c{k}"}) for k, verdict in enumerate(verdicts)]
        found = list(self.pool.judged(claims))
        assert [each.status for each in found] == verdicts
        assert [each.id for each in found] == [claim.id for claim in claims]

    @rule(verdicts=st.lists(VERDICTS, min_size=3, max_size=6))
    def nobody_waits_for_the_rest(self, verdicts: list[str]) -> None:
        assert self.pool is not None
        claims = [claim_from({**CLAIMS[verdict], "id": f"c{k}"}) for k, verdict in enumerate(verdicts)]
        assert next(iter(self.pool.judged(claims))).status == verdicts[0]

    @rule(which=st.integers(0, WORKERS - 1))
    def an_idle_process_is_killed(self, which: int) -> None:
        assert self.pool is not None
        running = self.pool.processes
        if which < len(running):
            with suppress(ProcessLookupError):
                os.kill(running[which], signal.SIGKILL)
            while is_running(running[which]):  # a busy machine may take its time to end it
                time.sleep(0.01)

    @rule(verdict=VERDICTS)
    def a_process_is_killed_at_work(self, verdict: str) -> None:
        """Its claim is said to be undecided; who asks meanwhile or afterwards is answered."""
        assert self.pool is not None
        with ThreadPoolExecutor(1) as thread:
            asked = thread.submit(self.pool.judge, ENDLESS)
            worker = at_work()
            self.one(verdict)
            while (pid := worker.pid) is None:
                time.sleep(0.01)
            os.kill(pid, signal.SIGKILL)
            found = asked.result()
        assert found.status == "undecided"
        assert found.known in (BROKE_OFF, NOT_STARTED)
        self.many(["holds", "fails"])

    @invariant()
    def no_more_processes_run_than_are_meant(self) -> None:
        if self.pool is not None:
            assert len(self.pool.processes) <= WORKERS
            self.seen.update(self.pool.processes)


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="processes are killed by a signal")
def test_a_pool_judges_whatever_happens_to_it() -> None:
    few = settings(
        max_examples=8, stateful_step_count=12, deadline=None, phases=[Phase.generate],
        suppress_health_check=[HealthCheck.too_slow],
    )  # fmt: skip
    run_state_machine_as_test(PoolMachine, settings=few)
