"""Resonant steps: step sizes in resonance with a motion, whose errors stand out from their neighbours'."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["resonant_steps"]

RESONANT = 10.0
"""How many times larger than its neighbours let expect the error of a resonant step is."""


def resonant_steps(step: ArrayLike, error: ArrayLike) -> NDArray[np.bool_]:
    """Tell which steps are in resonance: their error is over ten times that on the line through their neighbours.

    Parameters
    ----------
    step
        Steps, rising or falling, shape (steps,).
    error
        Size of the error with each step; those that are not positive tell nothing.

    Examples
    --------
    >>> resonant_steps([0.1, 0.2, 0.3, 0.4], [1e-6, 4e-6, 9e-4, 1.6e-5]).tolist()
    [False, False, True, False]
    """
    h, size = np.asarray(step, dtype=np.float64), np.asarray(error, dtype=np.float64)
    found = np.zeros(len(h), dtype=bool)
    for i in range(1, len(h) - 1):
        near = slice(i - 1, i + 2)
        if not (np.all(size[near] > 0.0) and np.all(h[near] > 0.0)):
            continue
        x, y = np.log(h[near]), np.log(size[near])
        expected = y[0] + (y[2] - y[0]) * (x[1] - x[0]) / (x[2] - x[0])
        found[i] = y[1] - expected > np.log(RESONANT)
    return found
