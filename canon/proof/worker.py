"""The process that heavy proofs run in; it can be killed at any time.

It speaks over its standard input and output: a length of eight bytes, then a pickle. It is started by
:mod:`canon.proof.budget` as ``python -m canon.proof.worker`` and ends when its input ends.
"""

from __future__ import annotations

import os
import pickle
import signal
import struct
import sys
import time
from typing import TYPE_CHECKING, BinaryIO, cast

if TYPE_CHECKING:
    from sympy import Expr

    from canon.proof.domain import Domain
    from canon.proof.prove import Attempt

__all__ = ["main", "read_message", "write_message"]

LENGTH = struct.Struct(">Q")
MEMORY = 4 * 2**30
"""Bytes of address space, where the system lets it be limited."""


def write_message(stream: BinaryIO, message: object) -> None:
    """Write one pickled message."""
    body = pickle.dumps(message, protocol=pickle.HIGHEST_PROTOCOL)
    stream.write(LENGTH.pack(len(body)) + body)
    stream.flush()


def read_message(stream: BinaryIO) -> object:
    """Read one message; raises EOFError where the stream has ended."""
    head = stream.read(LENGTH.size)
    if len(head) < LENGTH.size:
        raise EOFError
    (length,) = LENGTH.unpack(head)
    body = stream.read(length)
    if len(body) < length:
        raise EOFError
    return pickle.loads(body)


def attempt(exprs: tuple[Expr, ...], domain: Domain, seconds: float) -> list[Attempt]:
    """Try to prove that each expression vanishes, with the caps on sizes that fit a killable process."""
    from canon.proof.limits import THOROUGH
    from canon.proof.prove import prove_each

    return prove_each(exprs, domain, time.monotonic() + seconds, THOROUGH)


def limit_memory() -> None:
    """Limit the address space, so that a proof that grows ends itself and not the machine."""
    try:
        import resource
    except ImportError:  # Windows
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = MEMORY if hard == resource.RLIM_INFINITY else min(MEMORY, hard)
    resource.setrlimit(resource.RLIMIT_AS, (wanted, hard))


def main() -> None:
    """Answer requests until the input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    replies = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    limit_memory()
    while True:
        try:
            exprs, domain, seconds = cast(
                "tuple[tuple[Expr, ...], Domain, float]", read_message(sys.stdin.buffer)
            )
        except EOFError:
            return
        try:
            reply: object = attempt(exprs, domain, seconds)
        except (MemoryError, RecursionError) as reason:
            reply = f"{type(reason).__name__} in the worker"
        write_message(replies, reply)


if __name__ == "__main__":
    main()
