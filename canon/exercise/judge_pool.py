"""Judging pool: processes that judge claims, kept warm between questions, each killable and of bounded memory."""

from __future__ import annotations

import json
import queue
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from canon.exercise.judging_process import Worker
from canon.exercise.report.report import Report
from canon.exercise.sheet.sheet import Claim, Sheet, bundled_sheet, claim_from, read_sheet
from canon.exercise.waiting_claims import OWN_KEYS, WaitingClaims
from canon.expression.symbols.input_in_words import given_kind
from canon.process import Ended

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path
    from types import TracebackType

    from canon.exercise.report.judgement import Judgement
    from canon.process import Child

__all__ = ["JudgePool", "said"]

CLAIMS_A_PROCESS = 1_000
"""Claims after which a process is replaced, so that what libraries keep in memory does not grow for ever."""


class JudgePool:
    """Processes that judge claims, ready before they are asked; a context manager.

    Any thread may ask. A process whose claim spends its budget is killed and replaced; the others go on.

    Parameters
    ----------
    workers
        How many processes judge at the same time.
    budget
        Seconds for each claim, whatever it says itself; set it where strangers write the sheets.
    warm
        Whether the processes judge a small claim as soon as they run, so that the first answer comes as quickly as
        the others.
    child
        A judging process that was started before, for the first of the workers.

    Examples
    --------
    >>> with JudgePool(workers=1, budget=5.0) as pool:
    ...     claim = {"id": "a", "kind": "equality-only", "lhs": "sin(2*x)", "parameters": {"x": "real"}}
    ...     right = pool.judge({**claim, "rhs": "2*sin(x)*cos(x)"}).status
    ...     right, pool.judge({**claim, "rhs": "2*sin(x)"}).status
    ('holds', 'fails')
    """

    def __init__(
        self,
        workers: int = 2,
        budget: float | None = None,
        *,
        warm: bool = True,
        child: Child | None = None,
    ) -> None:
        if given_kind(workers, int, "workers") < 1:
            raise ValueError(f"workers should be a number of processes, 1 or more, not {workers!r}")
        if budget is not None and not 0.0 < budget <= 3600.0:
            raise ValueError(f"budget should be a number of seconds up to 3600, not {budget!r}")
        self._budget = budget
        self._all = (Worker(child), *(Worker() for _ in range(workers - 1)))
        self._idle: queue.SimpleQueue[Worker] = queue.SimpleQueue()
        self._threads = ThreadPoolExecutor(workers)
        self._closed = threading.Event()
        for worker in self._all:
            if warm:
                worker.start()
                self._threads.submit(self._warmed, worker)
            else:
                self._idle.put(worker)

    def __enter__(self) -> JudgePool:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def processes(self) -> tuple[int, ...]:
        """The numbers by which the system knows the processes that are running."""
        return tuple(pid for worker in self._all if (pid := worker.pid) is not None)

    @property
    def started(self) -> int:
        """How many processes have been started in all: more than run where some were killed or replaced."""
        return sum(worker.started for worker in self._all)

    def judge(self, claim: Claim | Mapping[str, Any]) -> Judgement:
        """Return the judgement on one claim, or on a table of its keys; waits for a process that is idle."""
        read = claim if isinstance(claim, Claim) else claim_from(dict(claim))
        worker = self._idle.get()
        try:
            return self._judged_by(worker, read)
        finally:
            self._put_back(worker)

    def check(self, sheet: str | Path | Sheet | Mapping[str, Any]) -> Report:
        """Return the report on a sheet, as :func:`canon.exercise.sheet_check.check` does."""
        read = sheet if isinstance(sheet, Sheet) else read_sheet(sheet)
        return Report(read.title or read.file, tuple(self.judged(read.claims)), read.claims)

    def judged(self, claims: Sequence[Claim]) -> Iterator[Judgement]:
        """Yield the judgement on each claim, in order; what is said twice is judged once."""
        keys = [said(claim) for claim in claims]
        first = dict(zip(reversed(keys), reversed(claims), strict=True))
        waiting = WaitingClaims(dict(reversed(first.items())))
        running = [self._threads.submit(self._judged_next, waiting) for _ in first]
        begun = iter(running)  # in this order, so that the next to be told is among the first
        found: dict[str, Judgement] = {}
        try:
            for key, claim in zip(keys, claims, strict=True):
                while key not in found:
                    other, judgement = next(begun).result()
                    found[other] = judgement
                title = str(claim.keys.get("title", ""))
                yield replace(found[key], id=claim.id, title=title, expect=claim.expect, file=claim.file)
        finally:
            for future in running:  # nobody waits for what is left
                future.cancel()

    def close(self) -> None:
        """Kill the processes, whatever they are doing."""
        self._closed.set()
        self._threads.shutdown(wait=False, cancel_futures=True)
        for worker in self._all:
            worker.close()

    def _judged_by(self, worker: Worker, claim: Claim) -> Judgement:
        if self._closed.is_set():
            raise ValueError("the pool is closed: make another one")
        return worker.judge(claim if self._budget is None else replace(claim, budget=self._budget))

    def _judged_next(self, waiting: WaitingClaims) -> tuple[str, Judgement]:
        """Return the key and the judgement of the waiting claim that is best for a process that is idle."""
        worker = self._idle.get()
        try:
            key, claim = waiting.next_for(worker)
            return key, self._judged_by(worker, claim)
        finally:
            self._put_back(worker)

    def _warmed(self, worker: Worker) -> None:
        try:
            worker.judge(bundled_sheet().claims[0])  # it brings what most claims need into memory
        finally:
            self._put_back(worker)

    def _put_back(self, worker: Worker) -> None:
        """Let the next claim have a process, a new one where it was killed or has judged enough."""
        try:
            with suppress(OSError, Ended):  # the system has no process to give now, or the pool is closed
                if worker.judged >= CLAIMS_A_PROCESS:
                    worker.stop()
                    worker.start()
                elif worker.judged:
                    worker.start()
        finally:
            self._idle.put(worker)


def said(claim: Claim) -> str:
    """Return everything in a claim that matters to its judgement, as text; an ill-formed one is itself only.

    Examples
    --------
    >>> keys = {"lhs": "1", "rhs": "1"}
    >>> said(Claim("a", "equality-only", keys)) == said(Claim("b", "equality-only", {**keys, "id": "b"}))
    True
    """
    if claim.errors:
        return f"{claim.id}: {claim.errors}"
    keys = {key: value for key, value in claim.keys.items() if key not in OWN_KEYS}
    return json.dumps([claim.kind, keys, claim.budget], sort_keys=True, default=str)
