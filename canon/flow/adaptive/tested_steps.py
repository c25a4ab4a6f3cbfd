"""Tested steps of the Taylor method, for motions whose series may have gaps: each is held to the equations at its end.

heyoka takes the length of a step from the last two coefficients of the series. Beside a zero of x¹⁵ both are as good as
nothing and the step is far too long: a ball in the well x¹⁶/8 loses all its digits by one. How a step's polynomial
moves at its end and what the equations ask for there differ by what the step has missed, divided by its length.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.adaptive.state_unit import is_finite

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["TestedSteps", "good_steps"]

_MISSED = 2.0**9
"""So many tolerances of the state's largest number a step may miss, times the order of what it misses."""

_FEWEST, _MOST = 128, 2048
"""So many steps are tested together, more and more as they are found good."""

_MANY = 32
"""After so many good steps in a row what was found at those before no longer counts."""

_SHRINKS, _IN_VAIN = 0.25, 3
"""What a step misses shrinks by less than this, so often, when it is halved, where it is rounding."""

_HALVINGS = 100
"""So many halvings with no more than a few steps between them lead to a singularity: heyoka is left to find it."""

_LATE, _NEWTON = 64.0, 4
"""In tolerances, how well the length of a step is known; it is found in so many steps of Newton's method at most."""

_LONGER = 1.25
"""A bound that was found is let out by so much after many good steps that it has held."""


@dataclass
class _Trial:
    """How many steps are tried together, and how the latest ones have failed.

    Parameters
    ----------
    count
        Steps that are tried together.
    last
        What the latest step that was too long has missed.
    halvings, in_vain
        Halvings since many steps were good, and how many of the latest in a row were no help.
    trusting
        Whether heyoka's steps are taken as they are: what they miss is rounding, or a singularity is near.
    """

    count: int = _FEWEST
    last: float = math.inf
    halvings: int = 0
    in_vain: int = 0
    trusting: bool = False

    def succeeded(self, made: int) -> None:
        """Note that steps were good."""
        self.halvings = 0 if made >= _MANY else self.halvings
        self.count, self.last = min(max(2 * self.count, _FEWEST), _MOST), math.inf

    def failed(self, missed: float) -> None:
        """Note that a step was too long."""
        self.halvings += 1
        self.in_vain = self.in_vain + 1 if missed > self.last * _SHRINKS else 0
        self.last = missed

    @property
    def is_vain(self) -> bool:
        """Whether halving helps no more."""
        return self.in_vain >= _IN_VAIN or self.halvings > _HALVINGS


class TestedSteps:
    """Steps of one integrator; those that prove too long are taken again, shorter.

    Parameters
    ----------
    integrator
        heyoka's adaptive integrator.
    plain
        Returns an integrator of the same equations in the same state, whose events, if it has any, do nothing.
    told
        What events have told, of which the latest is taken back where it was told in steps that prove too long.
    longest
        The longest step; None where there is no bound.
    """

    def __init__(self, integrator: Any, plain: Callable[[], Any], told: list[Any], longest: Any) -> None:
        self.integrator, self.plain, self.told = integrator, plain, told
        self.longest = self.bound = longest
        self.pieces = list[Any]()
        self.steps = 0
        self._keep()

    def towards(self, end: Any, most: int) -> Any:
        """Go to a time in at most so many steps and return heyoka's outcome; ``pieces`` give the motion on the way."""
        from heyoka import taylor_outcome

        own, trial = self.integrator, _Trial()
        while True:
            outcome, steps, piece = self._stepped(end, min(trial.count, most - self.steps))
            made, good, missed = 0, 0, math.inf
            if piece is not None:
                made, (good, missed) = len(piece.times) - 1, good_steps(piece, self.plain())
            if is_finite(own.state) and (trial.trusting or good == made):
                self._accept(steps, piece)
                if outcome != taylor_outcome.step_limit or self.steps >= most:
                    return outcome
                self._keep()
                trial.succeeded(made)
                continue
            if trial.trusting:
                return outcome
            if not good:
                self._shorten(trial, missed, end, piece)
            self._go_back()
            trial.count = good or 1

    def states_at(self, times: list[Any]) -> list[Any]:
        """Return the states at those of some times, in their order, that were reached."""
        found = list[Any]()
        for t in times:
            piece = next((each for each in self.pieces if min(each.bounds) <= t <= max(each.bounds)), None)
            if piece is None:
                break
            found.append(np.array(piece(t)))
        return found

    def _stepped(self, end: Any, most: int) -> tuple[Any, int, Any]:
        """Make steps and return heyoka's outcome, how many were made, and the motion on the way."""
        limits = {} if self.bound is None else {"max_delta_t": self.bound}
        found = self.integrator.propagate_until(end, c_output=True, max_steps=most, **limits)
        return found[0], found[3], found[4]

    def _accept(self, steps: int, piece: Any) -> None:
        self.steps += steps
        if piece is not None:
            self.pieces.append(piece)
            self._let_out(piece)

    def _keep(self) -> None:
        own = self.integrator
        self.safe, self._known, self._begun = (own.state.copy(), own.dtime), len(self.told), own.time

    def _go_back(self) -> None:
        own = self.integrator
        own.state[:], own.dtime = self.safe
        del self.told[self._known :]
        if own.with_events:
            own.reset_cooldowns()

    def _shorten(self, trial: _Trial, missed: float, end: Any, piece: Any) -> None:
        """Halve the step, or trust heyoka's where that has been in vain."""
        trial.failed(missed)
        trial.trusting = trial.is_vain or not self._halve(end, piece)
        if trial.trusting:
            self.bound = self.longest

    def _halve(self, end: Any, piece: Any) -> bool:
        """Bound the next step by half of the one that was too long; return whether time still goes on with it."""
        begun = self._begun
        tried = abs(end - begun) if piece is None else abs(piece.times[1] - piece.times[0])
        known = [tried] if self.bound is None else [tried, self.bound]
        self.bound = min(x for x in known if x == x) / type(begun)(2)
        return bool(begun + self.bound != begun)

    def _let_out(self, piece: Any) -> None:
        held = self.bound is not None and len(piece.times) > _MANY
        if held and abs(np.diff(piece.times)).max() * type(self._begun)(_LONGER) > self.bound:
            longer = self.bound * type(self._begun)(_LONGER)
            self.bound = longer if self.longest is None else min(longer, self.longest)


def good_steps(piece: Any, plain: Any) -> tuple[int, float]:
    """Return how many steps, from the first on, end moving as the equations ask, and what the next one has missed.

    Parameters
    ----------
    piece
        heyoka's continuous output of the steps.
    plain
        An integrator of the same equations that stands at their end.
    """
    series = piece.tcs
    state, clock = plain.state.copy(), plain.dtime
    known = is_finite(state)
    if known:
        plain.step(max_delta_t=type(plain.time)(0), write_tc=True)
        plain.state[:], plain.dtime = state, clock
    after = np.concatenate([series[1:, :, :2], plain.tc[np.newaxis, :, :2]])
    ends, rates = after[:, :, 0], after[:, :, 1]
    with np.errstate(all="ignore"):
        length, slope = _lengths(series, ends, rates, np.diff(piece.times), float(plain.tol))
        missed = abs((length[:, np.newaxis] * (rates - slope)).astype(np.float64)).max(axis=1)
        size = np.maximum(abs(ends), abs(series[:, :, 0])).astype(np.float64).max(axis=1)
        parts = missed / (float(plain.tol) * np.maximum(size, 1.0))
    if not known:
        parts[-1] = math.inf
    good = parts <= _MISSED
    first = int(np.argmin(good))
    return (len(good), 0.0) if good.all() else (first, float(np.nan_to_num(parts[first], nan=math.inf)))


def _lengths(series: Any, ends: Any, rates: Any, length: Any, tolerance: float) -> tuple[Any, Any]:
    """Return the lengths of steps, and how their polynomials move at their ends.

    Differences of times are rounded; at the true length the fastest component is where the step has ended.
    """
    steps, fastest = np.arange(len(ends)), abs(rates).astype(np.float64).argmax(axis=1)
    speed = rates[steps, fastest]
    still = speed == 0
    slope = rates
    for _ in range(_NEWTON):
        value, slope = _value_and_slope(series, length)
        late = (ends - value)[steps, fastest] / speed
        late[still] = 0 * length[still]
        if not (abs(late.astype(np.float64)) > abs(length.astype(np.float64)) * _LATE * tolerance).any():
            break
        length = length + late
    return length, slope


def _value_and_slope(series: Any, length: Any) -> tuple[Any, Any]:
    """Return polynomials, of shape (steps, components, powers), and their derivatives at the ends of steps."""
    if series.dtype in (np.float64, np.longdouble):
        degrees = np.arange(series.shape[2])
        powers = np.ones((len(length), len(degrees)), dtype=series.dtype)
        np.cumprod(np.broadcast_to(length[:, np.newaxis], powers[:, 1:].shape), axis=1, out=powers[:, 1:])
        falling = np.zeros_like(powers)
        falling[:, 1:] = degrees[1:] * powers[:, :-1]
        return np.einsum("sck,sk->sc", series, powers), np.einsum("sck,sk->sc", series, falling)
    value, slope = series[:, :, -1], 0 * series[:, :, 0]
    for k in reversed(range(series.shape[2] - 1)):
        slope = slope * length[:, np.newaxis] + value
        value = value * length[:, np.newaxis] + series[:, :, k]
    return value, slope
