"""Zeros of functions in one step of a motion, as far as its interpolant shows them."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.array import Array

__all__ = ["JUMP", "Zero", "zeros_in_step"]

JUMP = 0.25
"""A function that is larger, in parts of its size beside it, where it changes its sign, jumps there or has a pole."""

_PLACES = 9
"""At so many places of a step, its end included, functions are looked at, and at the extrema between them."""

_HALVINGS = 60
"""So often a step is halved to find a function off the zero at which it begins."""

_MOST = 10_000
"""Steps of Brent's method at most."""


class Zero(NamedTuple):
    """When a function vanishes, which one, and whether it rises as the motion passes."""

    t: float
    which: int
    rising: bool


def zeros_in_step(
    values: Callable[[float], Array], start: float, end: float, sides: Array, jumping: int = 0
) -> tuple[list[Zero], Array]:
    """Return the zeros after a step's start, in the order in which they are passed, and the signs at its end.

    Parameters
    ----------
    values
        All functions at a time of the step, shape (functions,).
    start, end
        The step.
    sides
        Of which sign each function is just after the start, 0 where that is not known.
    jumping
        The first so many functions count where they jump too; of others poles and jumps are no zeros.
    """
    times = np.linspace(start, end, _PLACES + 1)[1:].tolist()
    table = np.array([values(t) for t in times])
    zeros, after = list[Zero](), np.array(sides)
    for which, column in enumerate(table.T.tolist()):

        def value(t: float, which: int = which) -> float:
            return float(values(t)[which])

        before = start
        for t, x in _with_extrema(value, list(zip(times, column, strict=True))):
            if x and after[which] and x * after[which] < 0:
                zero = _root(value, before, t, x)
                if which < jumping or abs(value(zero)) <= JUMP * max(abs(x), abs(value(before))):
                    zeros.append(Zero(zero, which, x > 0))
            after[which] = math.copysign(1.0, x) if x else after[which]
            before = t
    return sorted(zeros, key=lambda zero: abs(zero.t - start)), after


def _root(value: Callable[[float], float], a: float, b: float, at_b: float) -> float:
    from scipy.optimize import brentq

    if value(a) * at_b >= 0:  # the start of a step lies at the zero, rounded to the other side
        side = math.copysign(1.0, at_b)
        # A ball that hardly bounces is off the floor for a very small part of a step.
        parts = (a + (b - a) * 0.5**k for k in range(1, _HALVINGS))
        inside = next((t for t in parts if side * value(t) < 0), a)
        if inside == a:
            return a
        a = inside
    # At a multiple root, as of x³, Brent's method takes some hundred steps.
    root: Any = brentq(value, a, b, xtol=2.0**-51 * max(abs(a), abs(b), 2.0**-900), maxiter=_MOST)
    return float(root)


def _with_extrema(
    value: Callable[[float], float], points: list[tuple[float, float]]
) -> list[tuple[float, float]]:
    """Return places with those between where a function turns round beyond zero."""
    from scipy.optimize import minimize_scalar

    turns = list[tuple[float, float]]()
    for (a, x), (_, y), (c, z) in zip(points, points[1:], points[2:], strict=False):
        if not (x * y > 0 and y * z > 0 and abs(y) <= min(abs(x), abs(z))):
            continue
        side = math.copysign(1.0, y)
        least: Any = minimize_scalar(
            lambda t, side=side: side * value(t), bounds=sorted((a, c)), method="bounded"
        )
        t = float(least.x)
        if side * value(t) < 0:
            turns.append((t, value(t)))
    first = points[0][0]
    return sorted(itertools.chain(points, turns), key=lambda point: abs(point[0] - first))
