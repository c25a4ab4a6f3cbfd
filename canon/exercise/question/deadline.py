"""Deadlines: how long a judgement may take, in time of the processor, so that a busy machine changes no verdict.

Proofs are given seconds on the clock. Where other programs take turns on the processor, a second of work takes more of
them, and a proof is given as many more.

What a person is told depends on no seconds: searches end by counts of steps. Seconds are a last safety, and where they
ended a search that found nothing, :class:`BudgetSpent` says so.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TypeVar

from canon.proof.worker.budget import seconds_in_worker

__all__ = [
    "NEAR",
    "PATIENCE",
    "PROOF_SECONDS",
    "SIDE_SECONDS",
    "BudgetSpent",
    "Deadline",
    "Worked",
    "unless_spent",
]

T = TypeVar("T")
PROOF_SECONDS = 20.0
"""Last safety of one proof or judgement, in seconds of the processor: most take some hundredths, and a process for
proofs, which may have to be started, a second or two."""
SIDE_SECONDS = 5.0
"""Last safety of a question beside a judgement, such as whether an answer says nothing: many times what it takes."""
NEAR = 0.9
"""Share of its seconds after which a proof is taken to have been ended by them."""

PATIENCE = 5.0
"""Seconds on the clock for one of the processor at most."""
LEAST = 0.05
"""Seconds after which work and clock are compared; before, they differ by chance."""


class BudgetSpent(Exception):
    """The seconds were spent before the search came to its own end: what it would have found is not known."""


@dataclass(frozen=True)
class Worked:
    """A moment on both clocks: that of the processor, for the process and its worker of proofs, and that on the wall.

    Examples
    --------
    >>> Worked(10.0, 100.0).slowness(Worked(11.0, 103.0)), Worked(10.0, 100.0).slowness(Worked(11.0, 190.0))
    (3.0, 5.0)
    >>> Worked(10.0, 100.0).slowness(Worked(10.0, 100.04)), Worked(10.0, 100.0).since(Worked(10.5, 100.5))
    (1.0, 0.5)
    """

    processor: float
    wall: float

    @classmethod
    def now(cls) -> Worked:
        """Return this moment."""
        return cls(time.process_time() + seconds_in_worker(), time.monotonic())

    def slowness(self, now: Worked) -> float:
        """Return how many seconds on the clock one of work took from then to now."""
        wall, work = now.wall - self.wall, now.processor - self.processor
        return 1.0 if wall < LEAST else min(PATIENCE, max(1.0, wall / max(work, wall / PATIENCE)))

    def since(self, now: Worked) -> float:
        """Return the seconds of work from then to now, at least the share of the clock that is always counted."""
        return max(now.processor - self.processor, (now.wall - self.wall) / PATIENCE)


@dataclass(frozen=True)
class Deadline:
    """The end of the seconds of work that a judgement has.

    Parameters
    ----------
    start
        When it began.
    seconds
        How long it may work, in seconds of the processor.

    Examples
    --------
    >>> Deadline(Worked.now(), 10.0).left > 9.9, Deadline(Worked(0.0, 0.0), 0.0).left
    (True, 0.05)
    """

    start: Worked
    seconds: float

    @classmethod
    def after(cls, seconds: float) -> Deadline:
        """Return the deadline so many seconds of work from now."""
        return cls(Worked.now(), seconds)

    @property
    def left(self) -> float:
        """Seconds on the clock that are left, at least a few hundredths, so that every question is looked at."""
        now = Worked.now()
        return max(LEAST, (self.seconds - self.start.since(now)) * self.start.slowness(now))

    @property
    def worked_off(self) -> bool:
        """Whether its seconds of work are spent; a busy clock alone does not spend them.

        Examples
        --------
        >>> Deadline.after(10.0).worked_off, Deadline(Worked(0.0, 0.0), 0.0).worked_off
        (False, True)
        """
        return self.start.since(Worked.now()) > self.seconds

    @property
    def over(self) -> bool:
        """Whether what found nothing until now may have been ended by the seconds, those of a busy clock included.

        Examples
        --------
        >>> Deadline.after(10.0).over, Deadline(Worked(0.0, 0.0), 0.0).over
        (False, True)
        """
        return time.monotonic() - self.start.wall > NEAR * self.seconds


def unless_spent(found: T | None, start: float, seconds: float) -> T | None:
    """Return what was found since a moment of :func:`time.monotonic`, or None where the search ended by itself.

    Raises
    ------
    BudgetSpent
        Where nothing was found, and the seconds may have ended the search.

    Examples
    --------
    >>> unless_spent("found", 0.0, 1e-9), unless_spent(None, time.monotonic(), 1e9)
    ('found', None)
    """
    if found is None and time.monotonic() - start > NEAR * seconds:
        raise BudgetSpent
    return found
