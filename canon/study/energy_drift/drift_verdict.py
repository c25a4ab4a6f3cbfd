"""Kinds of error growth along a run, and the verdict with the numbers behind it."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.display import preformatted

if TYPE_CHECKING:
    from canon.study.energy_drift.block_means import Blocks

__all__ = ["Drift", "Growth"]


class Growth(enum.Enum):
    """How the error of a conserved quantity grows with time."""

    BOUNDED = "bounded"
    ROUND_OFF = "round-off"
    WANDERING = "wandering"
    SECULAR = "secular"
    DIVERGED = "diverged"
    UNDECIDED = "undecided"

    def __str__(self) -> str:
        return self.value


@dataclass(frozen=True, eq=False)
class Drift:
    """How the error of a conserved quantity grew over a run.

    Parameters
    ----------
    bound
        Largest absolute error of the samples.
    slope, slope_error
        Drift of the error per unit of time and its standard error, a random walk allowed for. The error is
        right for a walk and twice too large for a mere oscillation; at worst, for both together, it is 1.4
        times too small (benchmarks/drift_calibration.py).
    amplitude_slope, amplitude_slope_error
        The same for the size of the oscillation about the mean.
    exponent, exponent_interval
        Power of time with which the error grows (0 bounded, ½ round-off, 1 secular) and its 95 %
        confidence interval.
    detection_limit
        Size of slope that would have been found with 95 % probability.
    verdict
        The verdict; BOUNDED means that no growth was found, hence none above the detection limit; WANDERING that the
        error walks at random, and that rounding is not known to explain it.
    walk
        Root-mean-square distance the random part of the error wandered over the run; 0 where none was found.
    span
        Duration of the series.
    reason
        Why the verdict, in words.
    cause
        Where the error comes from: ``"truncation"`` of the method's steps, ``"round-off"``, or empty where it is not
        known. It is known of a motion only, whose steps and precision say how much rounding can do.
    way
        Method, step and precision of the motion; empty where only a series was given.
    blocks
        The block means the verdict rests on.
    """

    bound: float
    slope: float
    slope_error: float
    amplitude_slope: float
    amplitude_slope_error: float
    exponent: float
    exponent_interval: tuple[float, float]
    detection_limit: float
    verdict: Growth
    walk: float
    span: float
    reason: str
    blocks: Blocks
    cause: str = ""
    way: str = ""

    def __repr__(self) -> str:
        return f"<Drift: {self.verdict.value}, {self.reason}>"

    def _repr_html_(self) -> str:
        return preformatted(str(self))

    def __str__(self) -> str:
        low, high = self.exponent_interval
        return (
            f"{self.verdict.value}: {self.reason}\n"
            f"  largest error    {self.bound:.3g}\n"
            f"  drift            {self.slope:.3g} ± {self.slope_error:.2g} per unit of time\n"
            f"  detection limit  {self.detection_limit:.2g} per unit of time\n"
            f"  growth exponent  {self.exponent:.2f} (95 %: {low:.2f} to {high:.2f})"
            + (
                f"\n  comes from       {self.cause or 'truncation or round-off'}: {self.way}"
                if self.way
                else ""
            )
        )
