"""Effort for a diagnosis: counted in steps, so that a claim gets the same diagnosis on any machine at any time.

A step is about one symbol or operation evaluated at the points of a screen. The seconds are an outer limit only, far
beyond what the steps take, and are those of the processor, so that a busy machine changes nothing; what a proof costs
is counted as a fixed number of steps.
"""

from __future__ import annotations

from canon.exercise.question.deadline import Worked

__all__ = ["PROOF_SECONDS", "PROOF_STEPS", "STEPS", "Effort"]

STEPS = 600_000
"""Steps for one diagnosis, which take a second or two where nothing is found."""
PROOF_STEPS = 2_500
"""Steps that a proof or a judgement on a changed claim counts for."""
PROOF_SECONDS = 3.0
"""Outer limit of one proof or judgement, in seconds of the processor; most take some milliseconds."""


class Effort:
    """What may still be spent on the search for a diagnosis.

    Parameters
    ----------
    seconds
        The outer limit from now, in seconds of the processor.
    steps
        How many steps.

    Examples
    --------
    >>> effort = Effort(10.0, steps=100)
    >>> half = effort.share(0.5)
    >>> half.spend(30), half.spend(30), effort.steps
    (True, False, 40)
    """

    def __init__(self, seconds: float, steps: int = STEPS) -> None:
        self.start, self.seconds = Worked.now(), seconds
        self.steps = steps
        self._whole: Effort | None = None

    def share(self, part: float) -> Effort:
        """Return a share of what is left; what is spent of it is spent of the whole."""
        found = Effort(self.seconds, int(part * self.steps))
        found.start, found._whole = self.start, self
        return found

    def spend(self, steps: int) -> bool:
        """Spend some steps; return whether there were any left."""
        self.steps -= steps
        if self._whole is not None:
            self._whole.spend(steps)
        return not self.spent

    @property
    def spent(self) -> bool:
        """Whether nothing is left."""
        return self.steps < 0 or self.start.since(Worked.now()) > self.seconds

    def work_for_a_proof(self) -> float:
        """Spend the steps of a proof or judgement; return how many seconds of the processor it may take at most."""
        self.spend(PROOF_STEPS)
        return max(0.05, min(PROOF_SECONDS, self.seconds - self.start.since(Worked.now())))

    def for_a_proof(self) -> float:
        """Spend the steps of a proof; return how many seconds on the clock it may take at most."""
        return self.work_for_a_proof() * self.start.slowness(Worked.now())
