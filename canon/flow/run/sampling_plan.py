"""Sample times of a run: evenly over the span, or at the times the user names."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.frozen_mapping import FrozenMapping
from canon.kernel.program.hamilton_equations import exact_number

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy.typing as npt

    from canon.array import Array

__all__ = [
    "Plan",
    "Sampling",
    "adaptive_plan",
    "fictitious_plan",
    "fixed_plan",
    "is_count",
    "sampling",
    "steps_over",
]

_LATEST, _MOST_STEPS = Fraction(10**300), 2**62
"""Times and steps that can still be told from the next ones."""

_MOST_SAMPLES = 10**9
"""Samples whose times alone take 8 GB; of two variables the states, their digits beyond doubles and H take 50 GB."""

_SLICES = 20
"""Parts a run of an adaptive method is done in, between which progress is reported and an interruption heard."""


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
        """Return the sample times as they are, for methods that evaluate the motion anywhere.

        Of even ones those that doubles do not tell from the one before are left out. A ValueError where no memory holds
        them.
        """
        if self.times is None:
            _check_memory(self.samples)
            even = np.linspace(float(self.start), float(self.end), self.samples + 1)
            return even[np.append(True, np.diff(even) != 0)]
        return np.array([float(self.start), *self.times, float(self.end)])

    def stops(self, steps: int) -> list[int]:
        """Return the numbers of the steps nearest to the sample times, each once, from 0 to the last."""
        if self.times is None:
            _check_memory(min(self.samples, steps))
            even = np.linspace(0, steps, min(self.samples, steps) + 1)
            return np.unique(even.round().astype(np.int64)).tolist()
        length = self.end - self.start
        nearest = (round((Fraction(t) - self.start) / length * steps) for t in self.times)
        return sorted({0, steps, *nearest})


def is_count(given: Any) -> bool:
    """Return whether what was given is a whole number from 1 on, in whatever type, that steps can be counted by.

    Examples
    --------
    >>> [is_count(given) for given in (1, 20.0, np.int64(3), 0, 2.5, math.nan, math.inf, "3")]
    [True, True, True, False, False, False, False, False]
    """
    if isinstance(given, str) or np.ndim(given):
        return False
    return bool(1 <= given <= _MOST_STEPS and given == int(given))


def sampling(t_span: tuple[Fraction, Fraction], samples: int | None, times: npt.ArrayLike | None) -> Sampling:
    """Return the instants of a run.

    Parameters
    ----------
    t_span
        First and last time.
    samples, times
        As :func:`canon.flow.propagation.propagate` takes them: 1000 samples where neither is given.

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
    _check_length(start, end)
    if times is None:
        if samples is not None and not is_count(samples):
            raise ValueError(f"samples={samples!r}: keep at least one state after the first, a whole number")
        return Sampling(start, end, 1000 if samples is None else int(samples))
    if samples is not None:
        raise ValueError(f"samples={samples} and times: give one of them")
    try:
        given = np.asarray(times, dtype=np.float64)
    except (OverflowError, ValueError, TypeError) as wrong:
        raise ValueError(f"times: give a list of finite numbers ({wrong})") from wrong
    if given.ndim != 1 or not given.size or not np.isfinite(given).all():
        raise ValueError(f"times of shape {given.shape}: give a list of finite numbers")
    forward = 1 if end > start else -1
    if not (np.diff(given) * forward > 0).all():
        raise ValueError(
            "times follow each other without repeating, in the direction of t_span: sort them, "
            "np.unique(times)" + ("" if forward > 0 else "[::-1]")
        )
    # Times are doubles: the ends among them are those nearest to the span's own, such as a tenth.
    inner = [t for t in given.tolist() if t not in (float(start), float(end))]
    outside = [t for t in (*inner[:1], *inner[-1:]) if not min(start, end) <= Fraction(t) <= max(start, end)]
    if outside:
        raise ValueError(f"times hold {outside[0]:g}, outside t_span = ({float(start):g}, {float(end):g})")
    return Sampling(start, end, len(inner) + 1, tuple(inner))


def _check_memory(samples: int) -> None:
    if samples > _MOST_SAMPLES:
        raise ValueError(
            f"samples={samples}: their times alone take {8e-9 * samples:.3g} GB of memory, and the states more; keep "
            f"at most {_MOST_SAMPLES:.0e}, or let a method of fixed steps follow functions inside its loop, cadence="
        )


def _check_length(start: Fraction, end: Fraction) -> None:
    if max(abs(start), abs(end)) > _LATEST:
        raise ValueError("t_span reaches beyond 1e300: measure time in other units")
    if start == end:
        raise ValueError(
            f"t_span = ({float(start)}, {float(end)}) has no length: give a start and another end"
        )
    if float(start) == float(end):
        raise ValueError(
            f"t_span begins and ends at t = {float(start):g} as far as doubles tell: measure time from nearer by"
        )


def steps_over(start: Fraction, end: Fraction, step: float | None, method: object) -> int:
    """Return in how many equal steps, none longer than the wanted one, a span is passed.

    Parameters
    ----------
    start, end
        First and last time.
    step
        The wanted size, positive in either direction of time; or negative back in time, as the motion has it.
    method
        What takes the steps, for messages.

    Raises
    ------
    ValueError
        The step is missing or makes no sense.

    Examples
    --------
    >>> [steps_over(Fraction(0), Fraction(end), 0.1, "verlet") for end in (1, -1, "1.05")]
    [10, 10, 11]
    """
    if step is None:
        raise ValueError(f"{method} takes fixed steps: give step=, in the units of time")
    wrong = isinstance(step, float) and not math.isfinite(step)
    size = Fraction(0) if wrong else exact_number(step, "step")
    ratio = Fraction(-1) if not size else (abs(end - start) if size > 0 else end - start) / size
    if ratio < 0:
        raise ValueError(f"step={step}: give a positive number; the direction of time follows from t_span")
    if ratio > _MOST_STEPS:
        raise ValueError(
            f"step={step}: the span of {float(end - start):.3g} is more than 2⁶² such steps; take longer ones"
        )
    nearest = max(1, round(ratio))
    # A span that is a whole number of steps up to the rounding of its ends and of the step counts as one.
    return nearest if abs(ratio - nearest) <= nearest * Fraction(1, 10**9) else math.ceil(ratio)


@dataclass(frozen=True, eq=False)
class Plan:
    """The sample times of a run as a method passes them.

    Parameters
    ----------
    start
        The first time.
    instants
        The sample times as doubles, shape (times,).
    h, stops
        Of a fixed-step method: the exact step, and the numbers of the steps after which to sample.
    ends
        Of an adaptive method: the samples at which to look at progress and interruptions.
    wanted
        Of a time-transformed method that is to keep states after evenly many steps: about how many. Then the instants
        are the first and the last time.
    exact
        Of an adaptive method: the exact times of samples whose instants are rounded, such as the ends of the span.
    """

    start: Fraction
    instants: Array
    h: Fraction | None = None
    stops: tuple[int, ...] = ()
    ends: tuple[int, ...] = ()
    wanted: int = 0
    exact: Mapping[int, Fraction] = field(default_factory=lambda: FrozenMapping({}))

    @property
    def forward(self) -> int:
        """1 where time runs forward, −1 where it runs back."""
        return 1 if self.instants[-1] > self.instants[0] else -1

    def slices(self, first: int) -> list[tuple[int, int]]:
        """Return the parts of a run from sample ``first`` on, as numbers of their first and last samples."""
        ends = [end for end in self.ends if end > first]
        return list(itertools.pairwise([first, *ends]))

    def continued(self, more: Sampling) -> Plan:
        """Return this plan with another one after it, which starts where this ends.

        Raises
        ------
        ValueError
            The new end lies behind, or is not a whole number of this run's steps away.
        """
        if (more.end - more.start) * self.forward < 0:
            raise ValueError(
                f"until={float(more.end):g} lies behind t = {float(more.start):g}, where the motion has arrived"
            )
        if self.h is None:
            instants, last = more.instants(), len(self.instants) - 1
            ends = tuple(last + end for end in _slices(len(instants) - 1))
            whole = np.append(self.instants, instants[1:])
            exact = {**self.exact, **_rounded({len(whole) - 1: more.end})}
            return replace(self, instants=whole, ends=self.ends + ends, exact=exact)
        ratio = (more.end - more.start) / self.h
        steps = round(ratio)
        if not steps or abs(ratio - steps) > abs(steps) * Fraction(1, 10**9):
            near = [float(more.start + n * self.h) for n in (math.floor(ratio), math.floor(ratio) + 1)]
            raise ValueError(
                f"until={float(more.end):.15g} is no whole number of steps of {float(self.h):g} away from "
                f"t = {float(more.start):.15g}: take {near[0]:.15g} or {near[1]:.15g}"
            )
        return fixed_plan(
            self.start, self.h, (*self.stops, *(self.stops[-1] + s for s in more.stops(steps)[1:]))
        )

    def last(self, samples: int) -> Fraction:
        """Return the exact time of a sample."""
        if self.h is not None:
            return self.start + self.stops[samples] * self.h
        return self.exact.get(samples, Fraction(float(self.instants[samples])))


def fixed_plan(start: Fraction, h: Fraction, stops: tuple[int, ...]) -> Plan:
    """Return the plan of a run in steps of one size."""
    # Of whole numbers over one denominator the quotient is the nearest double, as of fractions, and is quicker.
    whole = math.lcm(start.denominator, h.denominator)
    first, each = int(start * whole), int(h * whole)
    return Plan(start, np.array([(first + stop * each) / whole for stop in stops]), h, stops)


def adaptive_plan(wanted: Sampling) -> Plan:
    """Return the plan of a run in steps that the method chooses."""
    instants = wanted.instants()
    last = len(instants) - 1
    exact = _rounded({0: wanted.start, last: wanted.end})
    return Plan(wanted.start, instants, ends=tuple(_slices(last)), exact=exact)


def fictitious_plan(wanted: Sampling, *, named: bool) -> Plan:
    """Return the plan of a time-transformed run: the named times, or about so many states evenly spaced in steps."""
    if named:
        return adaptive_plan(wanted)
    ends = np.array([float(wanted.start), float(wanted.end)])
    return Plan(wanted.start, ends, ends=(1,), wanted=wanted.samples)


def _rounded(times: Mapping[int, Fraction]) -> dict[int, Fraction]:
    """Return those of some times that doubles round."""
    return {sample: t for sample, t in times.items() if Fraction(float(t)) != t}


def _slices(samples: int) -> list[int]:
    parts = np.array_split(np.arange(1, samples + 1), min(_SLICES, samples))
    return [int(part[-1]) for part in parts]
