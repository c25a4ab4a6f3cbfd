"""Claims judged in a process of its own, which is killed when a claim's budget is spent.

Parent and worker exchange JSON lines over pipes. The worker answers each claim with its verdict first and with
the feedback afterwards, so that a feedback that takes too long costs no verdict. A worker has at most 2 GB
of memory (where the system can limit it) and no way to pass anything but text back. It is killed together with
the process in which it lets proofs run, so that nothing goes on computing what nobody waits for.
"""

from __future__ import annotations

import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from decimal import Decimal
from pathlib import Path
from types import MappingProxyType
from typing import IO, TYPE_CHECKING, Any

from canon.exercise.report import Judgement, invalid
from canon.exercise.sheet import Claim

if TYPE_CHECKING:
    from types import TracebackType

__all__ = ["Worker"]

MEMORY = 2 * 1024**3
START = 60.0
"""Seconds that a worker may take to start, on a slow or busy machine."""
GRACE = 0.7
"""Seconds beyond its budget that a judgement may take to come to its own end before it is killed."""


FEEDBACK = 1.8
"""Seconds after the verdict for which its feedback is waited for."""


class Worker:
    """A process that judges claims one after the other; a context manager.

    Examples
    --------
    >>> with Worker() as worker:
    ...     worker.judge(Claim("a", "equality-only", {"lhs": "1/3 + 1/6", "rhs": "0.5"})).status
    'holds'
    """

    def __init__(self) -> None:
        self._owner = os.getpid()
        self._process: subprocess.Popen[str] | None = None
        self._lines: queue.SimpleQueue[str] = queue.SimpleQueue()

    def __enter__(self) -> Worker:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def judge(self, claim: Claim) -> Judgement:
        """Judge one claim within its budget; never raises for what stands in the claim."""
        if claim.errors:
            return invalid(claim, "\n".join(error.brief for error in claim.errors))
        self._run()
        start = time.monotonic()
        process = self._process
        if process is None or process.stdin is None:
            return _open(claim, "no process could be started to judge it", 0.0)
        try:
            process.stdin.write(_encoded(claim) + "\n")
            process.stdin.flush()
        except BrokenPipeError:
            self.stop()
            return _open(claim, "the process that judged it broke off", 0.0)
        return self._answer(claim, start)

    def _answer(self, claim: Claim, start: float) -> Judgement:
        deadline = start + claim.budget + GRACE
        verdict: Judgement | None = None
        while True:
            try:
                line = self._lines.get(timeout=max(0.0, deadline - time.monotonic()))
            except queue.Empty:
                self.stop()
                spent = time.monotonic() - start
                return verdict or _open(claim, f"its budget of {claim.budget:g} s was spent", spent)
            if not line:
                self.stop()
                spent = time.monotonic() - start
                return verdict or _open(
                    claim, "the process that judged it broke off (memory, or a fault)", spent
                )
            answer = json.loads(line)
            verdict = Judgement.from_dict(answer)
            if answer["last"]:
                return verdict
            deadline = min(deadline, time.monotonic() + FEEDBACK)

    def _run(self) -> None:
        """Start a process unless one is running."""
        if self._process is not None and self._process.poll() is None:
            return
        self.stop()
        self._lines = queue.SimpleQueue()
        self._process = subprocess.Popen(  # the interpreter that runs now, and nothing of the claim
            [sys.executable, "-P", "-m", "canon.exercise.worker"],  # -P: no module of the folder it is run in
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            encoding="utf-8",
            start_new_session=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(path or str(Path.cwd()) for path in sys.path)},
        )
        assert self._process.stdout is not None  # it is a pipe
        threading.Thread(target=_listen, args=(self._process.stdout, self._lines), daemon=True).start()
        try:
            ready = self._lines.get(timeout=START)
        except queue.Empty:
            ready = ""
        if not ready:  # it ended, or could not begin
            self.stop()

    def stop(self) -> None:
        """Kill the process, whatever it is doing; the next claim starts another one.

        A forked child leaves the process of its parent alone.
        """
        process, self._process = self._process, None
        if process is None or os.getpid() != self._owner:
            return
        _kill(process)
        process.wait()
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                with suppress(BrokenPipeError):
                    pipe.close()


def _kill(process: subprocess.Popen[str]) -> None:
    """Kill a worker and the process of its proofs, which is of its group."""
    if sys.platform == "win32" or process.returncode is not None:
        process.kill()
        return
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def _listen(pipe: IO[str], lines: queue.SimpleQueue[str]) -> None:
    """Pass on what the worker says; an empty line when it has ended."""
    try:
        for line in pipe:
            lines.put(line)
    except ValueError:  # the pipe was closed when the worker was stopped
        return
    lines.put("")


def _open(claim: Claim, why: str, seconds: float) -> Judgement:
    title = str(claim.keys.get("title", ""))
    return Judgement(claim.id, claim.kind, "undecided", seconds, known=why, title=title, expect=claim.expect)


def _encoded(claim: Claim) -> str:
    said = {
        "id": claim.id,
        "kind": claim.kind,
        "keys": dict(claim.keys),
        "expect": claim.expect,
        "budget": claim.budget,
    }
    return json.dumps(said, default=_plain)


def _plain(value: Any) -> Any:
    if isinstance(value, Decimal):
        return {"decimal": str(value)}
    return str(value)


def _restored(found: dict[str, Any]) -> Any:
    return Decimal(found["decimal"]) if set(found) == {"decimal"} else found


def _limit_memory() -> None:
    try:
        import resource
    except ImportError:  # a system that can't limit it
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    limit = MEMORY if hard == resource.RLIM_INFINITY else min(MEMORY, hard)
    resource.setrlimit(resource.RLIMIT_AS, (limit, hard))


def _serve() -> None:
    """Judge what comes in until the parent closes the pipe."""
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8")
    sys.stdout = sys.stderr
    _limit_memory()
    sys.set_int_max_str_digits(0)  # what follows from long numbers is longer; here its time is limited anyway
    from canon.exercise.judging import judgements

    answers.write("ready\n")
    answers.flush()
    for line in sys.stdin:
        said = json.loads(line, object_hook=_restored)
        said["keys"] = MappingProxyType(said["keys"])
        for judgement, last in judgements(Claim(**said)):
            answers.write(json.dumps({**judgement.to_dict(), "last": last}) + "\n")
            answers.flush()


if __name__ == "__main__":
    _serve()
