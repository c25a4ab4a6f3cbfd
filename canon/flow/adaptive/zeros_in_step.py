"""Zeros of functions in one step of a motion, as far as its interpolant shows them.

A step may be much longer than the times in which a function of the state changes. It is cut until every function is,
between two places, what its values and rates there foretell.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy.typing as npt

    from canon.array import Array

__all__ = ["JUMP", "TooFastError", "Zero", "zeros_in_step"]

JUMP = 0.25
"""A function that is larger, in parts of its size beside it, where it changes its sign, jumps there or has a pole."""

_PARTS = 4
"""Into so many parts a step is cut at least."""

_INSIDE = math.sqrt(2) - 1, math.sqrt(3) - 1
"""Where in its interval a function is compared to what is foretold: no multiples of a period lead there."""

_FORETOLD, _SMALL = 2.0**-4, 2.0**-12
"""How well, in parts of its size in the interval, and in parts of that in the whole step."""

_SHORTEST = 2.0**-20
"""The shortest interval in parts of the step: in such a one a function jumps or has a pole."""

_FEW, _INTERVALS = 32, 16384
"""Where a step is cut into more intervals it is asked what is rounding; into so many it is cut at most."""

_HALVINGS = 60
"""So often a step is halved to find a function off the zero at which it begins."""

_MOST = 10_000
"""Steps of Brent's method at most."""


class Zero(NamedTuple):
    """When a function vanishes, which one, and whether it rises as the motion passes."""

    t: float
    which: int
    rising: bool


class TooFastError(ValueError):
    """Raised where a function changes so often within a step that its zeros can't be told."""

    def __init__(self, which: int) -> None:
        super().__init__(f"function {which} changes too fast")
        self.which = which


class _Look(NamedTuple):
    """A time, and all functions and their rates there."""

    t: float
    values: Array
    rates: Array


def zeros_in_step(
    values: Callable[[float], Array],
    start: float,
    end: float,
    sides: Array,
    roundings: Callable[[], Array],
    jumping: int = 0,
) -> tuple[list[Zero], Array]:
    """Return the zeros after a step's start, in the order in which they are passed, and the signs at its end.

    Parameters
    ----------
    values
        All functions at a time of the step and, after them, the rate of each, shape (2 · functions,).
    start, end
        The step.
    sides
        Of which sign each function is just after the start, 0 where that is not known.
    roundings
        Returns how large each function may be by rounding alone.
    jumping
        The first so many functions count where they jump too; of others poles and jumps are no zeros.

    Raises
    ------
    TooFastError
        A function changes more often than can be followed.
    """
    looks = _resolved(values, start, end, roundings)
    zeros, after = list[Zero](), np.array(sides)
    for which in range(len(after)):

        def value(t: float, which: int = which) -> float:
            return float(values(t)[which])

        before = start
        for t, x in _with_turns(values, which, looks, after[which]):
            if x and after[which] and x * after[which] < 0:
                zero = _root(value, before, t, x)
                if which < jumping or abs(value(zero)) <= JUMP * max(abs(x), abs(value(before))):
                    zeros.append(Zero(zero, which, x > 0))
            after[which] = math.copysign(1.0, x) if x else after[which]
            before = t
    return sorted(zeros, key=lambda zero: abs(zero.t - start)), after


def _resolved(
    values: Callable[[float], Array], start: float, end: float, roundings: Callable[[], Array]
) -> list[_Look]:
    """Return places of a step, its ends included, between which all functions are as foretold.

    Raises
    ------
    TooFastError
        They would be too many.
    """

    def look(t: float) -> _Look:
        found = np.array(values(t))
        return _Look(t, *np.split(found, 2))

    first = [look(t) for t in np.linspace(start, end, _PARTS + 1).tolist()]
    sizes = np.array([abs(each.values) for each in first])
    small, known = _SMALL * np.where(np.isfinite(sizes), sizes, 0.0).max(axis=0), False
    ahead, passed = list(itertools.pairwise(first))[::-1], first[:1]
    while ahead:
        a, b = ahead.pop()
        inside = [look(a.t + (b.t - a.t) * part) for part in _INSIDE]
        if len(passed) > _FEW and not known:
            small, known = np.maximum(small, roundings()), True
        strange = _strange(a, inside, b, small)
        if strange.any() and abs(b.t - a.t) > _SHORTEST * abs(end - start):
            if len(passed) > _INTERVALS:
                raise TooFastError(int(np.argmax(strange)))
            ahead += [*itertools.pairwise([a, *inside, b])][::-1]
        else:
            passed += [*inside, b]
    return passed


def _strange(a: _Look, inside: list[_Look], b: _Look, small: Array) -> npt.NDArray[np.bool_]:
    """Return which functions are not, between two places, as the cubic through their values and rates is."""
    h = b.t - a.t
    with np.errstate(all="ignore"):
        change, begins, ends = b.values - a.values, h * a.rates, h * b.rates
        bend, twist = 3 * change - 2 * begins - ends, begins + ends - 2 * change
        size = np.max([abs(each.values) for each in (a, *inside, b)], axis=0)
        away = np.zeros_like(size)
        for u, each in zip(_INSIDE, inside, strict=True):
            value = a.values + u * (begins + u * (bend + u * twist))
            rate = begins + u * (2 * bend + 3 * u * twist)
            away = np.fmax(away, np.maximum(abs(value - each.values), abs(rate - h * each.rates)))
        return away > np.maximum(_FORETOLD * size, small)


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


def _with_turns(
    values: Callable[[float], Array], which: int, looks: list[_Look], side: float
) -> list[tuple[float, float]]:
    """Return the places after the first, with those between where a function turns round beyond zero."""
    points = list[tuple[float, float]]()
    for a, b in itertools.pairwise(looks):
        x, y = float(a.values[which]) or side, float(b.values[which])
        towards, from_zero = (np.sign(x) * (b.t - a.t) * each.rates[which] for each in (a, b))
        if x * y > 0 and towards < 0 < from_zero:
            turn = _turn(lambda t: float(np.nan_to_num(values(t)[len(looks[0].values) + which])), a.t, b.t)
            beyond = float(values(turn)[which])
            if beyond * x < 0:
                points.append((turn, beyond))
        points.append((b.t, y))
    return points


def _turn(rate: Callable[[float], float], a: float, b: float) -> float:
    from scipy.optimize import brentq

    found: Any = brentq(rate, a, b, xtol=2.0**-51 * max(abs(a), abs(b), 2.0**-900), maxiter=_MOST)
    return float(found)
