"""Judging queue: claims of many clients before a few processes, first come first served and never too many."""

from __future__ import annotations

import asyncio
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING

from canon.exercise.judge_pool import JudgePool
from canon.exercise.judging_process import BROKE_OFF
from canon.serve.kept_verdicts import KeptVerdicts
from canon.serve.refusal import Refusal

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Sequence

    from canon.exercise.report.judgement import Judgement
    from canon.exercise.sheet.sheet import Claim
    from canon.serve.service_limits import Limits

__all__ = ["JudgingQueue"]


class JudgingQueue:
    """The processes that judge, and the claims that wait for them.

    A request has no more claims before the processes than there are processes, so that a long sheet does not keep
    others waiting for its end.

    Parameters
    ----------
    limits
        What the service does at most.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._pool = JudgePool(limits.workers, limits.budget)
        self._threads = ThreadPoolExecutor(limits.workers, "judging")
        self._slots = asyncio.Semaphore(limits.workers)
        self._kept = KeptVerdicts()
        self.waiting = 0
        """Claims that are judged or wait for it."""
        self.judged = 0
        """Claims that were answered."""

    async def verdicts(self, claims: Sequence[Claim]) -> AsyncGenerator[Judgement]:
        """Yield the judgement on each claim, in order.

        Raises
        ------
        Refusal
            Where too many claims wait already.
        """
        if self.waiting + len(claims) > self._limits.waiting:
            raise Refusal(
                503,
                f"{self.waiting} claims of other people are waiting, and at most {self._limits.waiting} may; "
                "ask again in a few seconds",
                retry_after=1.0 + self.waiting / self._limits.workers * 0.1,
            )
        self.waiting += (left := len(claims))
        rest = iter(claims)
        running: deque[asyncio.Task[Judgement]] = deque()
        try:
            for claim in islice(rest, self._limits.workers):
                running.append(asyncio.create_task(self._judgement(claim)))
            while running:
                judgement = await running.popleft()
                self.waiting, left, self.judged = self.waiting - 1, left - 1, self.judged + 1
                for claim in islice(rest, 1):
                    running.append(asyncio.create_task(self._judgement(claim)))
                yield judgement
        finally:
            self.waiting -= left
            for task in running:  # nobody waits for what is left
                task.cancel()

    @property
    def processes(self) -> dict[str, int]:
        """How many processes there should be, how many run, and how many have been started in all."""
        return {
            "wanted": self._limits.workers,
            "running": len(self._pool.processes),
            "started": self._pool.started,
        }

    def close(self) -> None:
        """Kill the processes."""
        self._pool.close()
        self._threads.shutdown(wait=False, cancel_futures=True)

    async def _judgement(self, claim: Claim) -> Judgement:
        claim = replace(claim, budget=self._limits.budget)
        if (kept := self._kept.verdict(claim)) is not None:
            return kept
        async with self._slots:
            judgement = await self._judged(claim)
            if judgement.known == BROKE_OFF:  # by its own fault or by another's: a second time tells
                judgement = await self._judged(claim)
        self._kept.keep(claim, judgement)
        return judgement

    async def _judged(self, claim: Claim) -> Judgement:
        return await asyncio.get_running_loop().run_in_executor(self._threads, self._pool.judge, claim)
