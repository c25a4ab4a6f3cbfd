"""Token buckets, one a client: each request takes some out, and the work it makes; time puts them back."""

from __future__ import annotations

import time
from collections import OrderedDict
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Buckets", "WorkTime"]

MOST_CLIENTS = 10_000
"""Clients that are remembered; the one that asked the longest ago is forgotten first."""


class Buckets:
    """How much each client may still ask.

    A client may ask as long as something is left; what is asked then may leave a debt, which time pays.

    Parameters
    ----------
    rate
        Tokens a second that come back.
    burst
        The most that a bucket holds.
    now
        Returns the time in seconds.

    Examples
    --------
    >>> clock = iter((0.0, 0.0, 1.0)).__next__
    >>> buckets = Buckets(rate=1.0, burst=2.0, now=clock)
    >>> buckets.take("a", 2.5), buckets.take("a", 1.0), buckets.take("a", 1.0)
    (0.0, 0.5, 0.0)
    """

    def __init__(self, rate: float, burst: float, now: Callable[[], float] = time.monotonic) -> None:
        self._rate, self._burst, self._now = rate, burst, now
        self._levels: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def take(self, client: str, tokens: float) -> float:
        """Take tokens out of a client's bucket; where nothing is left, return the seconds until there is."""
        level, now = self._level(client)
        if level <= 0.0:
            return -level / self._rate or 1.0 / self._rate
        self._put(client, level - tokens, now)
        return 0.0

    def charge(self, client: str, tokens: float) -> None:
        """Take tokens for what turned out to be more work than it looked."""
        level, now = self._level(client)
        self._put(client, level - tokens, now)

    def _level(self, client: str) -> tuple[float, float]:
        now = self._now()
        level, before = self._levels.get(client, (self._burst, now))
        return min(self._burst, level + (now - before) * self._rate), now

    def _put(self, client: str, level: float, now: float) -> None:
        self._levels[client] = (level, now)
        self._levels.move_to_end(client)
        while len(self._levels) > MOST_CLIENTS:
            self._levels.popitem(last=False)


class WorkTime:
    """Seconds that pieces of work took, each in a ``with`` block, whatever came of it.

    Examples
    --------
    >>> clock = iter((1.0, 4.0)).__next__
    >>> work = WorkTime(clock)
    >>> with work:
    ...     pass
    >>> work.seconds
    3.0
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now, self._start = now, 0.0
        self.seconds = 0.0

    def __enter__(self) -> None:
        """Begin a piece of work."""
        self._start = self._now()

    def __exit__(self, *_: object) -> None:
        """Count a piece of work."""
        self.seconds += self._now() - self._start
