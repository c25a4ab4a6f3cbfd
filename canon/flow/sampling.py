"""When states are kept: evenly over the span, or at times the user names."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from canon.flow.trajectory import Array

__all__ = ["Sampling", "sampling", "steps_over"]


@dataclass(frozen=True)
class Sampling:
    """The instants of a run: its first time, sample times between, its last time.

    Parameters
    ----------
    start, end
        The span; ``end`` may be the earlier one.
    samples
        How many samples after the first, evenly spaced, where no times are named.
    times
        Sample times strictly between start and end, in the order in which they are passed.
    """

    start: Fraction
    end: Fraction
    samples: int
    times: tuple[float, ...] | None = None

    def instants(self) -> Array:
        """Return the sample times as they are, for methods that evaluate the motion anywhere."""
        if self.times is None:
            return np.linspace(float(self.start), float(self.end), self.samples + 1)
        return np.array([float(self.start), *self.times, float(self.end)])

    def stops(self, steps: int) -> list[int]:
        """Return the numbers of the steps nearest to the sample times, each once, from 0 to the last."""
        if self.times is None:
            even = np.linspace(0, steps, min(self.samples, steps) + 1)
            return np.unique(even.round().astype(np.int64)).tolist()
        length = self.end - self.start
        nearest = (round((Fraction(t) - self.start) / length * steps) for t in self.times)
        return sorted({0, steps, *nearest})


def sampling(t_span: tuple[Fraction, Fraction], samples: int | None, times: npt.ArrayLike | None) -> Sampling:
    """Return the instants of a run.

    Parameters
    ----------
    t_span
        First and last time.
    samples, times
        As :func:`canon.flow.propagate.propagate` takes them: 1000 samples where neither is given.

    Raises
    ------
    ValueError
        The span has no length; both are given; times are no list of finite numbers that follow each other from
        the first time to the last.

    Examples
    --------
    >>> named = sampling((Fraction(0), Fraction(10)), None, [0, 1, 2.5])
    >>> named.times, named.stops(40)
    ((1.0, 2.5), [0, 4, 10, 40])
    """
    start, end = t_span
    if start == end:
        raise ValueError(f"t_span = ({float(start)}, {float(end)}) has no length")
    if times is None:
        if samples is not None and (samples < 1 or samples != int(samples)):
            raise ValueError(f"samples={samples}: keep at least one state after the first")
        return Sampling(start, end, 1000 if samples is None else int(samples))
    if samples is not None:
        raise ValueError(f"samples={samples} and times: give one of them")
    given = np.asarray(times, dtype=np.float64)
    if given.ndim != 1 or not given.size or not np.isfinite(given).all():
        raise ValueError(f"times of shape {given.shape}: give a list of finite numbers")
    forward = 1 if end > start else -1
    if not (np.diff(given) * forward > 0).all():
        raise ValueError(
            "times follow each other without repeating, in the direction of t_span: sort them, "
            "np.unique(times)" + ("" if forward > 0 else "[::-1]")
        )
    outside = [
        t for t in (given[0], given[-1]) if not min(start, end) <= Fraction(float(t)) <= max(start, end)
    ]
    if outside:
        raise ValueError(f"times hold {outside[0]:g}, outside t_span = ({float(start):g}, {float(end):g})")
    inner = [float(t) for t in given if float(t) not in (float(start), float(end))]
    return Sampling(start, end, len(inner) + 1, tuple(inner))


def steps_over(start: Fraction, end: Fraction, step: float | None, method: object) -> int:
    """Return in how many equal steps, none longer than the wanted one, a span is passed.

    Raises
    ------
    ValueError
        The step is missing or makes no sense.
    """
    if step is None:
        raise ValueError(f"{method} takes fixed steps: give step=, in the units of time")
    if not (math.isfinite(step) and step > 0):
        raise ValueError(f"step={step}: give a positive number; the direction of time follows from t_span")
    ratio = abs(end - start) / Fraction(step)
    nearest = max(1, round(ratio))
    # A span that is a whole number of steps up to the rounding of its ends and of the step counts as one.
    return nearest if abs(ratio - nearest) <= nearest * Fraction(1, 10**9) else math.ceil(ratio)
