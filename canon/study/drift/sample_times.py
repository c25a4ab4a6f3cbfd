"""Sample times of an error series: evenly spaced where that resolves the motion, else scattered.

Even samples of an oscillation they do not resolve see it as a slow one (aliasing), and slow oscillations look like
growth. One sample at a random place of each interval makes noise of it instead. Noise averages out far more slowly
than a resolved oscillation does, so scattered times are for the others alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from canon.array import Array

__all__ = ["is_resolved", "scattered"]

RESOLVED = 0.5
"""Correlation of neighbouring samples above which they resolve a series: six of a sine a turn."""


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
