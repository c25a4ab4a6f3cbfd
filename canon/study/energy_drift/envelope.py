"""Envelope of an error series: its largest and median size in intervals of the logarithm of time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from canon.array import Array

__all__ = ["envelope_of"]


def envelope_of(t: Array, error: Array, intervals: int = 100) -> dict[str, Array] | None:
    """Return time, largest and median size of an error in intervals of log t; None where it is zero throughout.

    The first unit of time of a long run is left out: it shows the first oscillation, not the growth.

    Parameters
    ----------
    t
        Times from 0, rising, shape (times,).
    error
        The error with or without its sign, shape (times,).
    intervals
        How many intervals there are at most.

    Returns
    -------
    dict
        ``t``, ``largest`` and ``median``, each of shape (intervals with samples,).

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0.0, 1000.0, 5001)
    >>> found = envelope_of(t, 1e-9 * t * np.sin(t))
    >>> float(found["t"][-1]), bool(abs(found["largest"][-1] / 1e-6 - 1.0) < 0.01)
    (1000.0, True)
    """
    size = np.abs(error)
    positive = (t >= min(1.0, t[-1] / 50.0)) & (t > 0.0) & (size > 0.0)
    if np.count_nonzero(positive) < 2:
        return None
    when, what = t[positive], size[positive]
    edges = np.geomspace(when[0], when[-1], intervals + 1)
    number = np.clip(np.searchsorted(edges, when, side="right") - 1, 0, intervals - 1)
    filled = np.unique(number)
    groups = [what[number == k] for k in filled]
    centre = np.sqrt(edges[filled] * edges[filled + 1])
    centre[-1] = when[-1]
    return {
        "t": centre,
        "largest": np.array([group.max() for group in groups]),
        "median": np.array([np.median(group) for group in groups]),
    }
