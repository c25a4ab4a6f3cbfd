"""Sample times of an error series: evenly spaced where that resolves the motion, else scattered.

Even samples of an oscillation they do not resolve see it as a slow one (aliasing), and slow oscillations look like
growth. One sample at a random place of each interval makes noise of it instead. Noise averages out far more slowly
than a resolved oscillation does, so scattered times are for the others alone.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from canon.array import Array

__all__ = ["FEWEST_USUAL", "GOLDEN", "SAMPLES_PER_PERIOD", "is_resolved", "scattered", "usual_samples"]

GOLDEN = (1.0 + math.sqrt(5.0)) / 2.0

SAMPLES_PER_PERIOD = 14.0 + GOLDEN
"""Samples in a period where no number is given: enough to see its oscillation, and not in step with it."""

FEWEST_USUAL = 4096
"""Samples of a run at least, unless fewer are asked for."""

RESOLVED = 0.5
"""Correlation of neighbouring samples above which they resolve a series: six of a sine a turn."""


def usual_samples(span: float, period: float | None, most: int, *, unknown: int) -> int:
    """Return about 16 samples a period, within limits; where no period is known a number for that.

    Examples
    --------
    >>> usual_samples(1000.0, 1.0, 2**15, unknown=4096), usual_samples(1000.0, None, 2**15, unknown=4096)
    (15618, 4096)
    """
    return (
        unknown if period is None else int(min(most, max(FEWEST_USUAL, SAMPLES_PER_PERIOD * span / period)))
    )


def is_resolved(error: Array, every: int) -> bool:
    """Tell whether every so many samples of a series suffice to see how it oscillates.

    Parameters
    ----------
    error
        A densely sampled piece of the series, shape (times,).
    every
        Which of these samples would be kept.

    Examples
    --------
    >>> dense = np.sin(np.linspace(0.0, 100.0, 1001))
    >>> is_resolved(dense, 5), is_resolved(dense, 63)
    (True, False)
    """
    centred = error - error.mean()
    square = float(centred @ centred)
    if square == 0.0 or every < 2:
        return True
    # A turn in exactly that many samples looks like none: the correlation has to stay high all the way there.
    lags = range(1, every + 1)
    return min(float(centred[lag:] @ centred[:-lag]) / square for lag in lags) > RESOLVED


def scattered(first: float, last: float, samples: int, seed: int) -> Array:
    """Return one time at a random place of each of so many equal intervals of a span.

    Parameters
    ----------
    first, last
        The span.
    samples
        Number of intervals.
    seed
        Of the places; the same seed gives the same times.

    Examples
    --------
    >>> scattered(0.0, 4.0, 4, seed=1).astype(int).tolist()
    [0, 1, 2, 3]
    """
    places = np.arange(samples) + np.random.default_rng(seed).uniform(size=samples)
    return first + (last - first) / samples * places
