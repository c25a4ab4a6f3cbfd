"""Effort for a diagnosis: counted in steps, so that a claim gets the same diagnosis on any machine at any time.

A step is about one symbol or operation evaluated at the points of a screen; a proof counts for a fixed number of them.
Seconds end nothing silently: they are a last safety, many times beyond what the steps take, and where they are
spent the search is given up with :class:`BudgetSpent`, which is told. They are those of the processor, so that a busy
machine changes nothing.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from canon.exercise.question.deadline import NEAR, PROOF_SECONDS, BudgetSpent, Worked
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Generator

    from sympy import Expr

    from canon.proof.domain.domain import Domain

__all__ = [
    "JUDGEMENT_STEPS",
    "PROOF_SECONDS",
    "PROOF_STEPS",
    "STEPS",
    "BudgetSpent",
    "Effort",
    "proved_to_vanish",
]

STEPS = 600_000
"""Steps for one diagnosis, which take a second or two where nothing is found."""
PROOF_STEPS = 2_500
"""Steps that a proof counts for."""
JUDGEMENT_STEPS = 2_500
"""Steps that a judgement on a changed claim counts for, of which a search needs up to some two hundred."""

LOOK_STEPS = 1_000
"""Steps after which the clock is looked at again: some milliseconds. A look takes as long as several steps."""


class Effort:
    """What may still be spent on the search for a diagnosis.

    Parameters
    ----------
    seconds
        The last safety, from now, in seconds of the processor.
    steps
        How many steps.

    Examples
    --------
    >>> effort = Effort(10.0, steps=100)
    >>> half = effort.share(0.5)
    >>> half.spend(30), half.spend(30), effort.steps
    (True, False, 40)
    >>> Effort(0.0).spend(1)
    Traceback (most recent call last):
        ...
    canon.exercise.question.deadline.BudgetSpent
    """

    def __init__(self, seconds: float, steps: int = STEPS) -> None:
        self.start, self.seconds = Worked.now(), seconds
        self.steps = steps
        self.whole: Effort | None = None
        self._unlooked = LOOK_STEPS

    def share(self, part: float) -> Effort:
        """Return a share of what is left; what is spent of it is spent of the whole."""
        found = Effort(self.seconds, int(part * self.steps))
        found.start, found.whole = self.start, self
        return found

    def spend(self, steps: int) -> bool:
        """Spend some steps; return whether there were any left.

        Raises
        ------
        BudgetSpent
            Where the seconds are over.
        """
        self._unlooked += steps
        if self._unlooked >= LOOK_STEPS:
            self._unlooked = 0
            if self._seconds_left <= 0:
                raise BudgetSpent
        counting: Effort | None = self
        while counting is not None:
            counting.steps -= steps
            counting = counting.whole
        return not self.spent

    @property
    def spent(self) -> bool:
        """Whether no steps are left."""
        return self.steps < 0

    @contextmanager
    def proof(self, steps: int = PROOF_STEPS) -> Generator[float]:
        """Give the seconds of the processor that one proof or judgement may take, and count its steps.

        Raises
        ------
        BudgetSpent
            Where it took them all, so that its outcome says more of the machine than of the claim.
        """
        self.spend(steps)
        begun, seconds = Worked.now(), min(PROOF_SECONDS, self._seconds_left)
        on_the_clock = seconds * self.start.slowness(begun)
        yield seconds
        now = Worked.now()
        if begun.since(now) > NEAR * seconds or now.wall - begun.wall > NEAR * on_the_clock:
            raise BudgetSpent

    @property
    def _seconds_left(self) -> float:
        return self.seconds - self.start.since(Worked.now())


def proved_to_vanish(f: Expr, domain: Domain, effort: Effort) -> bool:
    """Whether an expression is proved to vanish off the kinks of a domain.

    Raises
    ------
    BudgetSpent
        Where the seconds ended the proof.
    """
    with effort.proof() as seconds:
        slowness = effort.start.slowness(Worked.now())
        return vanishes_off_kinks(f, domain, budget=seconds * slowness).holds
