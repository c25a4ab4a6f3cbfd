"""Judging process: a child process for claims, killed when a claim's budget is spent.

Parent and worker exchange JSON. The worker says first that a claim has come, then its verdict, and the feedback
afterwards: a feedback that takes too long costs no verdict, nor does the end of a process that no claim had reached. A
worker has at most 2 GB of memory (where the
system can limit it) and no way to pass anything but text back. It is killed together with the process in which it
lets proofs run, so that nothing goes on computing what nobody waits for.
"""

from __future__ import annotations

import gc
import json
import sys
import time
from collections.abc import Mapping
from dataclasses import replace
from decimal import Decimal
from typing import TYPE_CHECKING, Any

from canon.exercise.question.deadline import PATIENCE
from canon.exercise.report.judgement import Judgement, invalid, without_explanation
from canon.exercise.sheet.sheet import Claim
from canon.frozen_mapping import FrozenMapping
from canon.process import JUDGING, Child, Ended, Late, serve

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import TracebackType

__all__ = ["BROKE_OFF", "NOT_STARTED", "Worker"]

MEMORY = 2 * 1024**3
START = 60.0
"""Seconds that a worker may take to start, on a slow or busy machine."""
GRACE = 0.35
"""Seconds beyond its budget that a judgement may take to come to its own end before it is killed."""
LOOK = 0.1
"""Seconds between looks at how long a process has worked."""
HEARD = b""
"""The first that a process says of a claim: it has come."""
FEEDBACK = 12.0
"""Seconds after the verdict for which its feedback is waited for, an outer limit: most takes some hundredths."""


BROKE_OFF = "the process that judged it broke off (memory, or a fault)"
"""What is known of a claim whose process ended before its verdict."""
NOT_STARTED = "no process could be started to judge it"
"""What is known of a claim whose process ended before it was ready, or never began."""


class Worker:
    """A process that judges claims one after the other; a context manager.

    Parameters
    ----------
    child
        A process of :mod:`canon.exercise.judging_process` that was started before; a new one unless given.

    Examples
    --------
    >>> with Worker() as worker:
    ...     worker.judge(Claim("a", "equality-only", {"lhs": "1/3 + 1/6", "rhs": "0.5"})).status
    'holds'
    """

    def __init__(self, child: Child | None = None) -> None:
        self._child = child
        self._ready = False
        self._closed = False
        self.heard = False
        """Whether the claim that was asked last has come to its process."""
        self.judged = 0
        """Claims that its process was asked."""
        self.started = int(child is not None)
        """Processes that it had, one after the other."""

    def __enter__(self) -> Worker:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    @property
    def pid(self) -> int | None:
        """The number by which the system knows its process; None where none is running."""
        child = self._child
        return child.pid if child is not None and child.usable else None

    def judge(self, claim: Claim) -> Judgement:
        """Judge one claim within its budget; never raises for what stands in the claim.

        ``seconds`` of the judgement is how long its verdict was waited for, without the start of a process.
        """
        if claim.errors:
            return invalid(claim, "\n".join(error.brief for error in claim.errors))
        found = self._asked(claim) or self._asked(claim)
        return found or _open(claim, BROKE_OFF if self.judged else NOT_STARTED, 0.0)

    def _asked(self, claim: Claim) -> Judgement | None:
        """Return what a running process says of a claim; None where it ended before the claim had come to it."""
        self.heard = False
        try:
            child = self._running()
        except Late:
            self.stop()
            return _open(claim, NOT_STARTED, 0.0)
        except (Ended, OSError):
            self.stop()
            return None
        self.judged += 1
        start = time.monotonic()
        child.send(lambda: _encoded(claim), PATIENCE * (claim.budget + GRACE))  # as long as it is waited for
        return self._answer(child, claim, start)

    def _answer(self, child: Child, claim: Claim, start: float) -> Judgement | None:
        """Return the last that is said of a claim before it must have been said; None where it has not come."""
        allowed = claim.budget + GRACE
        before = child.processor_seconds
        verdict: Judgement | None = None
        try:
            self.heard = _received(child, start + allowed, before, allowed) == HEARD
            while True:
                answer = json.loads(_received(child, start + allowed, before, allowed))
                seconds = verdict.seconds if verdict else time.monotonic() - start
                verdict = replace(Judgement.from_dict(answer), seconds=seconds)
                if answer["last"]:
                    return verdict
                allowed = min(allowed, time.monotonic() - start + FEEDBACK)
        except Late:
            why = f"its budget of {claim.budget:g} s was spent"
            verdict = verdict and without_explanation(verdict, claim.budget)
        except Ended:
            if not self.heard:
                self.stop()
                return None
            why = BROKE_OFF
        self.stop()
        return verdict or _open(claim, why, time.monotonic() - start)

    def start(self) -> Child:
        """Return the process, a new one unless one is running, without waiting until it is ready.

        Raises
        ------
        Ended
            Where the worker is closed.
        """
        child = self._child
        if child is None or not child.usable:
            self.stop()
            if self._closed:
                raise Ended("the worker is closed")
            child = self._child = Child(JUDGING, leads=True)
            self._ready, self.judged = False, 0
            self.started += 1
            if self._closed:  # meanwhile, by another thread, which may have found no process to kill
                child.kill()
                raise Ended("the worker is closed")
        return child  # its own name for it: another thread may stop this worker meanwhile

    def _running(self) -> Child:
        """Return the process once it is ready."""
        child = self.start()
        if not self._ready:
            child.receive(time.monotonic() + START)
            self._ready = True
        return child

    def stop(self) -> None:
        """Kill the process, whatever it is doing; the next claim starts another one."""
        child, self._child = self._child, None
        if child is not None:
            child.kill()

    def close(self) -> None:
        """Kill the process, whatever it is doing; no other one is started, and a claim is said to be undecided."""
        self._closed = True
        self.stop()


def _received(child: Child, deadline: float, before: float | None, allowed: float) -> bytes:
    """Return what a process answers; on a busy machine it is waited for until it has worked as long as allowed."""
    last = deadline + (PATIENCE - 1) * allowed
    while True:
        try:
            return child.receive(deadline)
        except Late:
            now, worked = time.monotonic(), child.processor_seconds
            if before is None or worked is None or worked - before >= allowed or now >= last:
                raise
            deadline = min(last, now + max(LOOK, allowed - worked + before))


def _open(claim: Claim, why: str, seconds: float) -> Judgement:
    return replace(invalid(claim, why), status="undecided", seconds=seconds)


def _encoded(claim: Claim) -> bytes:
    said = {
        "id": claim.id,
        "kind": claim.kind,
        "keys": dict(claim.keys),
        "expect": claim.expect,
        "budget": claim.budget,
    }
    return json.dumps(said, default=_plain).encode()


def _plain(value: Any) -> Any:
    if isinstance(value, Decimal):
        return {"decimal": str(value)}
    return dict(value) if isinstance(value, Mapping) else str(value)


def _decoded(message: bytes) -> Claim:
    said: dict[str, Any] = json.loads(message, object_hook=_restored)
    said["keys"] = FrozenMapping(said["keys"])
    return Claim(**said)


def _restored(found: dict[str, Any]) -> Any:
    return Decimal(found["decimal"]) if set(found) == {"decimal"} else found


def main() -> None:
    """Judge what comes in until the parent closes the pipe."""
    gc.disable()  # a tenth of the time of the imports goes into looking at what is made to stay
    from canon.exercise.diagnose.kept_explanations import KeptExplanations
    from canon.exercise.explained_judgement import judgements

    gc.freeze()
    gc.enable()
    kept = KeptExplanations()

    def answers(message: bytes) -> Iterator[bytes]:
        yield HEARD
        for judgement, last in judgements(_decoded(message), kept):
            yield json.dumps({**judgement.to_dict(), "last": last}).encode()

    sys.set_int_max_str_digits(0)  # what follows from long numbers is longer; here its time is limited anyway
    serve(answers, MEMORY)
