"""What is being done and how long it will take still, on the terminal's error stream."""

from __future__ import annotations

import sys
import time

__all__ = ["Progress", "time_left"]

EVERY = 0.2
"""Seconds between two changes of the line."""


class Progress:
    """One line on stderr with a bar and the remaining time; silent where stderr is no terminal.

    Call it with what is being done and the fraction of it that is done, 0 … 1.
    """

    def __init__(self) -> None:
        self._shown = 0
        self._what = ""
        self._began = self._last = time.monotonic()

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_: object) -> None:
        self._write("")

    def __call__(self, what: str, done: float) -> None:
        """Show that this fraction of it is done."""
        if not sys.stderr.isatty():
            return
        now = time.monotonic()
        if what != self._what:
            self._what, self._began = what, now
        elif now - self._last < EVERY:
            return
        self._last = now
        bar = ("█" * round(20 * done)).ljust(20, "░")
        left = time_left((now - self._began) * (1.0 - done) / done) if done > 0.0 else ""
        self._write(f"{what} {100 * done:3.0f} % {bar} {left}")

    def _write(self, line: str) -> None:
        if line or self._shown:
            print("\r" + line.ljust(self._shown), end="" if line else "\r", file=sys.stderr, flush=True)
        self._shown = len(line)


def time_left(seconds: float) -> str:
    """Return a remaining time in words.

    Examples
    --------
    >>> time_left(3.2), time_left(75.0), time_left(7300.0)
    ('4 s left', '1 min 15 s left', '2 h 1 min left')
    """
    whole = int(seconds) + 1 if seconds < 60.0 else round(seconds)
    if whole < 60:
        return f"{whole} s left"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s left"
    return f"{whole // 3600} h {whole % 3600 // 60} min left"
