"""A child process that can be killed: it runs a module of canon, and no file of the folder it is started in.

Parent and child exchange messages of bytes over pipes. The child finds nothing but the standard library, canon and
what canon rests on, each in the folder from which the parent has it; neither ``PYTHONPATH`` nor the working folder
nor what an interpreter usually runs at its start (``sitecustomize``, ``.pth`` files) reaches it. Each message says
for how long its answer is waited for, and a child whose parent has gone ends by itself: at once where the system
tells it that a pipe was closed, else then.
"""

from __future__ import annotations

import os
import queue
import signal
import struct
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, cast

from canon.trusted_folders import trusted_folders

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

__all__ = [
    "JUDGING",
    "Child",
    "Ended",
    "Late",
    "end_when_closed",
    "end_with_parent",
    "serve",
]

JUDGING = "canon.exercise.judging_process"
"""The module of a child that judges claims."""

HOME = Path(__file__).absolute().parents[1]
"""The folder, or the archive, that holds canon."""

POLL = 0.1
"""Seconds between looks for an interrupt while waiting."""

DEATH = 0.05
"""Seconds for which the end of a killed process is waited for; one with much memory takes longer to vanish."""

ABANDONED = 5.0
"""Seconds after which a child ends by itself once nobody waits for its answer any more."""

LONGEST = 1e6
"""Seconds that a timer of the system is set to at most."""

LENGTH = struct.Struct(">Q")
SECONDS = struct.Struct(">d")

# The interpreter starts bare (-S); the packages come after the standard library, canon from its folder alone.
START = """
import sys
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
module, home, lifeline, *folders = sys.argv[1:]
sys.path += folders
found = PathFinder.find_spec("canon", [home])
canon = sys.modules["canon"] = module_from_spec(found)
found.loader.exec_module(canon)
if lifeline:
    __import__("canon.process", fromlist=["end_when_closed"]).end_when_closed(int(lifeline))
__import__(module, fromlist=["main"]).main()
"""


class Late(Exception):
    """No message came before the deadline."""


class Ended(Exception):
    """The process has ended, or nothing could be sent to it."""


class Child:
    """A process that runs ``main()`` of a module of canon, which calls :func:`serve`.

    Its first message is empty and says that it is ready.

    Parameters
    ----------
    module
        Full name of the module.
    leads
        Whether it leads a group of processes: what it starts is killed with it, and an interrupt from the terminal
        does not reach it.
    """

    def __init__(self, module: str, *, leads: bool = False) -> None:
        self._owner = os.getpid()
        self._leads = leads and sys.platform != "win32"
        self._killed = False
        self._heard: queue.SimpleQueue[bytes | Ended] = queue.SimpleQueue()
        self._sender: threading.Thread | None = None
        self._sending = threading.Lock()
        lifeline, self._held = os.pipe() if sys.platform != "win32" else (-1, -1)
        self._process = subprocess.Popen(  # the interpreter that runs now, and nothing that a stranger wrote
            [
                *(sys.executable, "-P", "-s", "-S", "-c", START, module, str(HOME)),
                str(lifeline) if lifeline >= 0 else "",
                *trusted_folders(),
            ],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=leads,
            pass_fds=(lifeline,) if lifeline >= 0 else (),
            env={name: value for name, value in os.environ.items() if name != "PYTHONPATH"},
        )
        if lifeline >= 0:
            os.close(lifeline)
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()

    @property
    def pid(self) -> int:
        """The number by which the system knows the process."""
        return self._process.pid

    @property
    def processor_seconds(self) -> float | None:
        """Seconds for which it has kept a processor busy, all its threads together; None where no system tells."""
        if sys.platform != "linux":
            return None
        try:
            return time.clock_gettime(
                ~self._process.pid << 3 | 2
            )  # as clock_getcpuclockid(3) makes it of a number
        except OSError:  # it has ended
            return None

    @property
    def usable(self) -> bool:
        """Whether it is running, and this process started it: a forked child has none of its parent's."""
        return not self._killed and os.getpid() == self._owner and self._process.poll() is None

    def send(self, encode: Callable[[], bytes], seconds: float) -> None:
        """Send what ``encode`` returns, without waiting for it.

        Parameters
        ----------
        encode
            Returns the message.
        seconds
            How long its answer is waited for.
        """
        sender = threading.Thread(target=self._send, args=(encode, seconds), daemon=True)
        with self._sending:  # the process may end just now, and its listener waits for who has been started
            sender.start()
            self._sender = sender

    def receive(self, deadline: float) -> bytes:
        """Return the next message.

        Parameters
        ----------
        deadline
            Until when it is waited for, by ``time.monotonic()``.

        Raises
        ------
        Late
            Where it did not come.
        Ended
            Where it will not come.
        """
        while True:
            left = deadline - time.monotonic()
            try:
                heard = self._heard.get(timeout=min(POLL, left)) if left > 0 else self._heard.get_nowait()
            except queue.Empty:
                if left > 0:
                    continue
                raise Late from None
            if isinstance(heard, Ended):
                raise heard
            return heard

    def kill(self) -> None:
        """Kill the process with all that it started; a forked child leaves that of its parent alone."""
        if self._killed or os.getpid() != self._owner:
            return
        self._killed = True
        if self._leads and self._process.returncode is None:
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
        else:
            self._process.kill()
        self._listener.join(DEATH)

    def _send(self, encode: Callable[[], bytes], seconds: float) -> None:
        try:
            _write(cast("BinaryIO", self._process.stdin), SECONDS.pack(seconds) + encode())
        except (OSError, ValueError, RecursionError, MemoryError) as reason:
            self._heard.put(Ended(f"the message could not be sent: {type(reason).__name__}"))

    def _listen(self) -> None:
        """Pass on the messages; when the process has ended, say so and put its remains away."""
        pipe = cast("BinaryIO", self._process.stdout)
        try:
            while True:
                self._heard.put(_read(pipe))
        except (EOFError, OSError):
            self._heard.put(Ended("the process has ended"))
        self._process.wait()
        with self._sending:
            sender = self._sender
        if sender is not None:
            sender.join()
        for stream in (pipe, self._process.stdin):
            if stream is not None:
                with suppress(OSError):
                    stream.close()
        if self._held >= 0:
            os.close(self._held)


def end_when_closed(pipe: int) -> None:
    """Let this process end as soon as the other end of a pipe is closed, as by the death of who holds it.

    Where it can, the system itself ends the process, whatever it is computing; everywhere a thread looks.

    Parameters
    ----------
    pipe
        Descriptor of the end for reading; nothing is ever written to the other.
    """
    try:
        import fcntl
    except ImportError:  # Windows
        pass
    else:
        if hasattr(signal, "SIGIO") and hasattr(os, "O_ASYNC"):
            signal.signal(signal.SIGIO, signal.SIG_DFL)  # which ends a process
            fcntl.fcntl(pipe, fcntl.F_SETOWN, os.getpid())
            fcntl.fcntl(pipe, fcntl.F_SETFL, fcntl.fcntl(pipe, fcntl.F_GETFL) | os.O_ASYNC)

    def watch() -> None:
        with suppress(OSError):
            os.read(pipe, 1)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def end_with_parent() -> None:
    """Let this process of a pool end with the one that started it, which alone handles interrupts from the terminal."""
    from multiprocessing import parent_process

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = parent_process()
    if parent is None:
        return
    if sys.platform != "win32":
        end_when_closed(parent.sentinel)
        return

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def serve(answers: Callable[[bytes], Iterable[bytes]], memory: int) -> None:
    """Answer the messages of the parent until it closes the pipe; an interrupt is the parent's to handle.

    Parameters
    ----------
    answers
        Returns the answers to a message.
    memory
        Bytes of address space that the process may have, where the system can limit it: not on macOS and Windows.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform != "win32":
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
    told = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    _limit_memory(memory)
    _write(told, b"")
    while True:
        try:
            message = _read(sys.stdin.buffer)
        except EOFError:
            return
        (seconds,) = SECONDS.unpack_from(message)
        _end_in(seconds + ABANDONED)
        for answer in answers(message[SECONDS.size :]):
            _write(told, answer)
        _end_in(0.0)


def _end_in(seconds: float) -> None:
    """Let the system end this process after some time, whatever it is doing then; 0 takes that back."""
    if sys.platform != "win32":
        signal.setitimer(signal.ITIMER_REAL, min(seconds, LONGEST))


def _limit_memory(memory: int) -> None:
    """Limit the address space, so that what grows ends itself and not the machine."""
    try:
        import resource
    except ImportError:  # Windows
        return
    if sys.platform == "darwin":  # refuses limits below what every process has mapped (python/cpython#78783)
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = memory if hard == resource.RLIM_INFINITY else min(memory, hard)
    resource.setrlimit(resource.RLIMIT_AS, (wanted, hard))


def _write(stream: BinaryIO, body: bytes) -> None:
    stream.write(LENGTH.pack(len(body)) + body)
    stream.flush()


def _read(stream: BinaryIO) -> bytes:
    """Return one message; raises EOFError where the stream has ended."""
    head = stream.read(LENGTH.size)
    if len(head) < LENGTH.size:
        raise EOFError
    (length,) = LENGTH.unpack(head)
    body = stream.read(length)
    if len(body) < length:
        raise EOFError
    return body
