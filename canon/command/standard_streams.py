"""Standard streams that are closed or full: what is printed goes nowhere then, and a line says so."""

from __future__ import annotations

import errno
import os
import sys
from contextlib import suppress
from io import TextIOWrapper

__all__ = ["silenced", "streams_open", "why_not_written"]


def streams_open() -> None:
    """Open the null device in place of every standard stream that is closed, lest a file take its number."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest number that is free, which is this one
    for name, number in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, "w", closefd=False))
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without ✓ shows ?


def why_not_written(error: OSError) -> str:
    """Return why standard output took no more, empty where the error is one of another file."""
    if error.filename is not None or error.errno not in (
        errno.ENOSPC,
        errno.EIO,
        errno.EBADF,
        errno.EFBIG,
        errno.EDQUOT,
    ):
        return ""
    return os.strerror(error.errno)


def silenced() -> None:
    """Send what is still to be written nowhere, so that the end of the program can't fail in writing it."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            with suppress(OSError, ValueError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
