"""Landing at a given time: the part of a step in the fictitious time at whose end t has that value."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any, NamedTuple

from canon.expression.graph.number_systems import FLOAT64

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.flow.fixed_step.partial_step import LoopState, PartialSteps
    from canon.flow.transformed.extended_hamiltonian import ExtendedSystem

__all__ = ["Segment", "StateAtTime", "iterations", "state_at_time", "time_of"]

_TRIES = 60
"""Trials of a part of a step; bisection alone would need 53."""


class Segment(NamedTuple):
    """Where in a step a smooth part of the motion begins, and the state there."""

    begin: Fraction
    state: LoopState


class StateAtTime(NamedTuple):
    """A state at a given time, the segment and the part of a step that lead to it, and the steps of the search."""

    state: LoopState
    segment: Segment
    part: Fraction
    work: int


def time_of(state: LoopState, clock: int) -> Fraction:
    """Return the time that is a component of an extended state."""
    return Fraction(float(state.high[clock, 0])) + Fraction(float(state.low[clock, 0]))


def iterations(before: Any, after: Any) -> int:
    """Return how many iterations an implicit method took between two memories of it."""
    return round(float(after[0, 0])) - (0 if before is None else round(float(before[0, 0])))


def state_at_time(
    frame: ExtendedSystem,
    steps: PartialSteps,
    segments: Sequence[Segment],
    goal: Fraction,
    fine: Fraction,
    coarse: Fraction,
) -> StateAtTime:
    """Return the state at a time within a step.

    The first trial is that of a cubic polynomial with the right slopes, the others are the secant's.

    Parameters
    ----------
    frame, steps
        The equations, and what takes parts of a step.
    segments
        The step's smooth parts, from its beginning to its end.
    goal
        The time.
    fine, coarse
        To what part of itself the time is to be met where it can be, and at least.

    Raises
    ------
    ArithmeticError
        No part of the step ends there.
    """
    forward, clock = (1 if steps.h > 0 else -1), frame.clock
    times = [time_of(segment.state, clock) for segment in segments]
    misses = [forward * (t - goal) for t in times]
    scale = max(map(abs, (goal, times[0], times[-1])))
    if misses[-1] <= fine * scale:
        return StateAtTime(segments[-1].state, segments[-2], segments[-1].begin, 0)
    k = max((i for i, miss in enumerate(misses) if miss <= 0), default=0)
    segment, last = segments[k], segments[k + 1].begin
    if misses[k] >= -fine * scale:
        return StateAtTime(segment.state, segment, segment.begin, 0)
    low, high = (segment.begin, misses[k]), (last, misses[k + 1])
    x, known, best, work = _guess(frame, steps, segments[k], segments[k + 1], goal), low, None, 0
    for _ in range(_TRIES):
        state = steps.moved(segment.state, 0, segment.begin, x)
        work += iterations(segment.state.beyond, state.beyond) if steps.loop.implicit else 1
        miss = forward * (time_of(state, clock) - goal)
        if best is None or abs(miss) < best[0]:
            best = abs(miss), state, x
        low, high = ((x, miss), high) if miss < 0 else (low, (x, miss))
        new = _secant(known, (x, miss), low[0], high[0])
        if abs(miss) <= fine * scale or new in (low[0], high[0]):
            break
        known, x = (x, miss), new
    assert best is not None
    if best[0] > coarse * scale:
        raise ArithmeticError(
            f"no part of a step ends at t = {float(goal):.9g}: dt/ds varies too fast there; take smaller steps"
        )
    return StateAtTime(best[1], segment, best[2], work)


def _secant(
    a: tuple[Fraction, Fraction], b: tuple[Fraction, Fraction], low: Fraction, high: Fraction
) -> Fraction:
    """Return where the line through two points is zero, or the middle of the bracket where that is outside."""
    (x, f), (z, g) = a, b
    found = z - g * (z - x) / (g - f) if g != f else low
    if not low < found < high:
        found = (low + high) / 2
    return Fraction(float(found))


def _guess(
    frame: ExtendedSystem, steps: PartialSteps, first: Segment, last: Segment, goal: Fraction
) -> Fraction:
    """Return about where in a step the time is: the cubic polynomial s(t) with the slopes at both ends."""
    start, end = (time_of(segment.state, frame.clock) for segment in (first, last))
    length = last.begin - first.begin
    u = float((goal - start) / (end - start))
    slopes = [
        float((end - start) / (length * steps.h)) / _rate(frame, segment.state) for segment in (first, last)
    ]
    part = u * u * (3 - 2 * u) + slopes[0] * u * (1 - u) ** 2 - slopes[1] * u * u * (1 - u)
    return first.begin + length * Fraction(min(max(part, u / 2), (1 + u) / 2))


def _rate(frame: ExtendedSystem, state: LoopState) -> float:
    """Return dt/ds."""
    system = frame.system
    values = dict(zip(system.inputs, (*state.high[:, 0].tolist(), 0.0), strict=True))
    return float(system.graph.evaluate([system.velocity[frame.clock]], values, FLOAT64)[0])
