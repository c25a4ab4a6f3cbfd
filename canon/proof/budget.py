"""Time and memory limits: heavy proofs run in one worker process that is reused and can be killed."""

from __future__ import annotations

import atexit
import os
import queue
import subprocess
import sys
import threading
import time
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, cast

from canon.proof.worker import read_message, write_message

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

    from canon.proof.domain import Domain
    from canon.proof.prove import Attempt

__all__ = ["prove_in_worker"]

GRACE = 0.15
"""Seconds that the worker may take beyond its own deadline before it is killed."""

POLL = 0.1
"""Seconds between looks for an interrupt while waiting."""


def prove_in_worker(exprs: Sequence[Expr], domain: Domain, seconds: float) -> list[Attempt] | str:
    """Try to prove in the worker that each of some expressions vanishes.

    Parameters
    ----------
    exprs, domain
        As for :func:`canon.proof.prove.prove_each`.
    seconds
        Time limit, the start of the worker included where it is not running yet.

    Returns
    -------
    list of Attempt, or str
        What the proving rungs did for each, or why there is no answer.
    """
    return _worker(os.getpid()).ask(exprs, domain, seconds)


@cache
def _worker(pid: int) -> _Worker:  # noqa: ARG001
    """Return the worker of this process; a forked child gets one of its own."""
    worker = _Worker()
    atexit.register(worker.stop)
    return worker


class _Worker:
    """One worker process, started when first needed and again after it was killed."""

    def __init__(self) -> None:
        self._owner = os.getpid()
        self._process: subprocess.Popen[bytes] | None = None
        self._conversation: threading.Thread | None = None
        self._lock = threading.Lock()

    def ask(self, exprs: Sequence[Expr], domain: Domain, seconds: float) -> list[Attempt] | str:
        """Send one request and wait for the reply, at most as long as it may take."""
        deadline = time.monotonic() + seconds + GRACE
        if not self._lock.acquire(timeout=max(0.0, seconds)):
            return f"another thread's proof took the {seconds:.1f} s"
        try:
            return self._asked(exprs, domain, deadline, seconds)
        finally:
            self._lock.release()

    def _asked(
        self, exprs: Sequence[Expr], domain: Domain, deadline: float, seconds: float
    ) -> list[Attempt] | str:
        left = max(0.0, deadline - time.monotonic() - 2 * GRACE)
        request = (tuple(exprs), type(domain)(domain.conditions, dict(domain.box)), left)
        replies: queue.SimpleQueue[object] = queue.SimpleQueue()
        process = self._running()
        self._conversation = threading.Thread(target=_converse, args=(process, request, replies), daemon=True)
        self._conversation.start()
        try:
            reply = _wait(replies, deadline)
        except BaseException:  # an interrupt above all: nobody waits for the answer any more
            self.stop()
            raise
        if reply is None:
            self.stop()
            return f"stopped after {seconds:.1f} s"
        if isinstance(reply, OSError | EOFError):
            self.stop()
            return "the worker ended, for lack of memory or otherwise"
        return cast("list[Attempt] | str", reply)

    def stop(self) -> None:
        """Kill the process, if there is one; a forked child leaves that of its parent alone."""
        process, self._process = self._process, None
        if process is None or os.getpid() != self._owner:
            return
        process.kill()
        process.wait()
        if self._conversation is not None:
            self._conversation.join()
        for stream in (process.stdin, process.stdout):
            if stream is not None:
                with suppress(OSError):
                    stream.close()

    def _running(self) -> subprocess.Popen[bytes]:
        if self._process is not None and self._process.poll() is not None:
            self.stop()
        if self._process is None:
            path = os.pathsep.join(entry or str(Path.cwd()) for entry in sys.path)
            self._process = subprocess.Popen(
                [
                    sys.executable,
                    "-P",
                    "-m",
                    "canon.proof.worker",
                ],  # -P: no module of the folder it is run in
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": path},
            )
        return self._process


def _converse(process: subprocess.Popen[bytes], request: object, replies: queue.SimpleQueue[object]) -> None:
    try:
        if process.stdin is not None and process.stdout is not None:
            write_message(cast("BinaryIO", process.stdin), request)
            replies.put(read_message(cast("BinaryIO", process.stdout)))
    except (OSError, EOFError) as reason:
        replies.put(reason)


def _wait(replies: queue.SimpleQueue[object], deadline: float) -> object:
    """Return the reply, or None when the deadline has passed."""
    while (left := deadline - time.monotonic()) > 0:
        try:
            return replies.get(timeout=min(POLL, left))
        except queue.Empty:
            continue
    return None
