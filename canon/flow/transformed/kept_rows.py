"""Kept rows: times and states that a time-transformed run has kept, in the pieces in which they were reached."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from canon.array import Array

__all__ = ["KeptRows"]


class KeptRows:
    """Times and states y + carried, to which more are added piece by piece.

    Parameters
    ----------
    t
        Times, shape (times,).
    high, low
        The states there, each part of shape (2n, times, orbits).

    Examples
    --------
    >>> rows = KeptRows(np.array([0.0]), np.ones((2, 1, 1)), np.zeros((2, 1, 1)))
    >>> rows.add(np.array([0.5, 1.0]), np.ones((2, 2, 1)), np.zeros((2, 2, 1)))
    >>> len(rows), rows.every_other().first(2)[0], rows.first(2)[1].shape
    (3, array([0., 1.]), (2, 2, 1))
    """

    def __init__(self, t: Array, high: Array, low: Array) -> None:
        self._times, self._highs, self._lows, self._count = [t], [high], [low], len(t)

    def __len__(self) -> int:
        return self._count

    def add(self, t: Array, high: Array, low: Array) -> None:
        """Add what comes after, of the same shapes."""
        self._times.append(t)
        self._highs.append(high)
        self._lows.append(low)
        self._count += len(t)

    def first(self, count: int) -> tuple[Array, Array, Array]:
        """Return so many times, and the two parts of the states there; an addition that was cut short is left out."""
        t, high, low = (
            np.concatenate(parts, axis=axis)
            for parts, axis in ((self._times, 0), (self._highs, 1), (self._lows, 1))
        )
        return t[:count], high[:, :count], low[:, :count]

    def every_other(self) -> KeptRows:
        """Return the first, the third, the fifth …"""
        t, high, low = self.first(self._count)
        return KeptRows(t[::2], high[:, ::2], low[:, ::2])
