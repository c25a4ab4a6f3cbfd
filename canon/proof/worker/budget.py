"""Time and memory limits: heavy proofs run in one worker process that is reused and can be killed."""

from __future__ import annotations

import atexit
import os
import pickle
import threading
import time
from functools import cache
from typing import TYPE_CHECKING, cast

from canon.process import Child, Ended, Late

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

    from canon.proof.domain.domain import Domain
    from canon.proof.rungs.ladder import Attempt

__all__ = ["prove_in_worker", "seconds_in_worker"]

GRACE = 0.15
"""Seconds that the worker may take beyond its own deadline before it is killed."""


def prove_in_worker(exprs: Sequence[Expr], domain: Domain, seconds: float) -> list[Attempt] | str:
    """Try to prove in the worker that each of some expressions vanishes.

    Parameters
    ----------
    exprs, domain
        As for :func:`canon.proof.rungs.ladder.prove_each`.
    seconds
        Time limit, the start of the worker included where it is not running yet.

    Returns
    -------
    list of Attempt, or str
        What the proving rungs did for each, or why there is no answer.
    """
    return _worker(os.getpid()).ask(exprs, domain, seconds)


def seconds_in_worker() -> float:
    """Return for how many seconds the worker of this process has kept a processor busy, or was waited for."""
    return _worker(os.getpid()).worked


@cache
def _worker(pid: int) -> _Worker:  # noqa: ARG001
    """Return the worker of this process; a forked child gets one of its own."""
    worker = _Worker()
    atexit.register(worker.stop)
    return worker


class _Worker:
    """One worker process, started when first needed and again after it was killed."""

    def __init__(self) -> None:
        self._child: Child | None = None
        self._lock = threading.Lock()
        self.worked = 0.0

    def ask(self, exprs: Sequence[Expr], domain: Domain, seconds: float) -> list[Attempt] | str:
        """Send one request and wait for the reply, at most as long as it may take."""
        deadline = time.monotonic() + seconds + GRACE
        if not self._lock.acquire(timeout=max(0.0, seconds)):
            return f"another thread's proof took the {seconds:.1f} s"
        try:
            return self._asked(exprs, domain, deadline)
        except Late:
            self.stop()
            return f"stopped after {seconds:.1f} s"
        except Ended:
            self.stop()
            return "the worker ended, for lack of memory or otherwise"
        except BaseException:  # an interrupt above all: nobody waits for the answer any more
            self.stop()
            raise
        finally:
            self._lock.release()

    def _asked(self, exprs: Sequence[Expr], domain: Domain, deadline: float) -> list[Attempt] | str:
        child, asked = self._running(deadline), time.monotonic()
        before = child.processor_seconds
        try:
            return self._answer(child, exprs, domain, deadline)
        finally:
            after = child.processor_seconds
            if before is None or after is None:
                self.worked += time.monotonic() - asked
            else:
                self.worked += after - before

    def _answer(
        self, child: Child, exprs: Sequence[Expr], domain: Domain, deadline: float
    ) -> list[Attempt] | str:
        """Send a request to the process, and return its reply."""
        left = max(0.0, deadline - time.monotonic() - 2 * GRACE)
        request = (tuple(exprs), type(domain)(domain.conditions, dict(domain.box)), left)
        child.send(lambda: pickle.dumps(request, protocol=pickle.HIGHEST_PROTOCOL), left)
        return cast("list[Attempt] | str", pickle.loads(child.receive(deadline)))

    def _running(self, deadline: float) -> Child:
        """Return the process once it is ready, a new one unless one is running."""
        if self._child is None or not self._child.usable:
            self.stop()
            self._child = Child("canon.proof.worker.proof_process")
            self._child.receive(deadline)
        return self._child

    def stop(self) -> None:
        """Kill the process, if there is one; a forked child leaves that of its parent alone."""
        child, self._child = self._child, None
        if child is not None:
            child.kill()
