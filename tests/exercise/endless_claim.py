"""A claim that takes longer than any budget here, and the process that is at work on it, to be killed meanwhile."""

from __future__ import annotations

import queue
import time
from typing import TYPE_CHECKING, Any

from canon.exercise.judging_process import Worker

if TYPE_CHECKING:
    from canon.exercise.report.judgement import Judgement
    from canon.exercise.sheet.sheet import Claim

COORDINATES = 240
ENDLESS: dict[str, Any] = {
    "id": "endless",
    "kind": "euler-lagrange",
    "q": [f"q{i}" for i in range(COORDINATES)],
    "L": "+".join(f"q{i}_dot**2*exp(q{(i * 7) % COORDINATES}*q{i})" for i in range(COORDINATES)),
    "claim": [f"q{i}_ddot" for i in range(COORDINATES)],
}
"""It keeps a processor busy for more than twenty seconds."""

_ASKED: queue.SimpleQueue[Worker] = queue.SimpleQueue()


class WatchedWorker(Worker):
    """A worker that says when it is asked about the endless claim."""

    def judge(self, claim: Claim) -> Judgement:
        if claim.id == ENDLESS["id"]:
            self.heard = False
            _ASKED.put(self)
        return super().judge(claim)


def at_work() -> Worker:
    """Return the watched worker that was asked, once its process has the claim.

    A process that was killed before the claim came is replaced, and the next one has it.
    """
    worker = _ASKED.get()
    while not worker.heard:
        time.sleep(0.01)
    return worker
