"""Sizes of a state's components, each in its own unit, which DOP853 takes its relative tolerance for parts of.

A component that is zero at the start has the size it comes to within the time scale of the motion. One that is all
rounding, as by a symmetry, is measured by the terms that cancel in its rate.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.array import Array

__all__ = ["TimeAndSizes", "time_and_sizes"]

_RESOLVED = 2.0**-3
"""In parts of its size, what a component's midpoint rule and RK4 may differ by in a step as long as the time scale."""

_TELLING = 2.0**-32
"""In parts of the largest of its half of the state, what a component is to begin with to tell of the time scale."""

_AT_ZERO, _REACHED = 2.0**-20, 0.125
"""A component that begins as so small a part of what it comes to has so much of that for its size."""

_HALVINGS = 200

_NUDGE = 2.0**-20
"""So large a part of their sizes all components are moved by to see what they add to the rates."""

_LEVELS = 4
"""Through so many rates a size is handed on."""

_ROUNDINGS = 8 * 2.0**-52
"""In parts of the terms of a rate, what rounding makes of it."""


@dataclass(frozen=True, eq=False)
class TimeAndSizes:
    """The time scale of a motion at its start, and the sizes of its components."""

    time: float
    sizes: Array


def time_and_sizes(
    rate: Callable[[float, Array], Array], t: float, y: Array, span: float, tolerance: float
) -> TimeAndSizes:
    """Return the time scale of a motion at its start and the sizes of its components, in whatever units they are.

    Parameters
    ----------
    rate
        dy/dt at t and y.
    t, y
        The start.
    span
        How long the motion is, negative where it runs back.
    tolerance
        The relative tolerance of a step: what is so small a part of rounding can't be measured.
    """
    time, sizes = _resolved(rate, t, y, span)
    handed = _handed_on(rate, t, y, abs(time), sizes)
    sizes = np.where(sizes == 0, handed, np.maximum(sizes, _ROUNDINGS / tolerance * handed))
    sizes = np.where(sizes == 0, _largest_of_half(sizes), sizes)
    return TimeAndSizes(abs(time), np.where(sizes == 0, 1.0, sizes))


def _resolved(rate: Callable[[float, Array], Array], t: float, y: Array, span: float) -> tuple[float, Array]:
    """Return the longest of the span, its half, … in which RK4 makes sense, and the sizes of components there."""
    time = span
    for _ in range(_HALVINGS):
        stages = _stages(rate, t, y, time)
        if np.isfinite(stages).all():
            sizes = np.maximum(abs(y), abs(time) * abs(stages).max(axis=0))
            begun = np.maximum(abs(y), abs(time * stages[0]))
            telling = begun > _TELLING * _largest_of_half(begun)
            away = abs(time * (stages[0] - 4 * stages[1] + 2 * stages[2] + stages[3]) / 6)
            if (away <= _RESOLVED * sizes)[telling].all():
                return time, np.where(abs(y) > _AT_ZERO * sizes, abs(y), _REACHED * sizes)
        time /= 2
    return time, abs(y)


def _stages(rate: Callable[[float, Array], Array], t: float, y: Array, h: float) -> Array:
    """Return the four rates of a step of RK4."""
    first = rate(t, y).copy()
    second = rate(t + h / 2, y + h / 2 * first).copy()
    third = rate(t + h / 2, y + h / 2 * second).copy()
    return np.array([first, second, third, rate(t + h, y + h * third)])


def _handed_on(rate: Callable[[float, Array], Array], t: float, y: Array, time: float, sizes: Array) -> Array:
    """Return the sizes that components of such sizes would give one another in a time, were nothing to cancel."""
    first = rate(t, y).copy()
    # Of irrational parts no two are alike, so that no symmetry is left.
    nudge = _NUDGE * np.cos(math.e * np.arange(1.0, len(y) + 1))
    for _ in range(_LEVELS):
        moved = abs(rate(t, y + nudge * sizes) - first) / _NUDGE
        if not np.isfinite(moved).all():
            break
        sizes = np.maximum(sizes, time * moved)
    return sizes


def _largest_of_half(sizes: Array) -> Array:
    """Return for each component the largest size among coordinates or among momenta."""
    half = -(-len(sizes) // 2)
    parts = sizes[:half], sizes[half:]
    return np.concatenate([np.full(len(part), part.max(initial=0.0)) for part in parts])
