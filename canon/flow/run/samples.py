"""Sampled states: what an integrator returns, how two runs are joined, and statistics between samples."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.array import Array

if TYPE_CHECKING:
    from canon.flow.run.event import Crossing, Event, PreparedEvent

__all__ = ["Dense", "Samples", "Statistics", "joined", "side_by_side", "waiting_events"]

Dense = Callable[[Array], Array]
"""States (2n, times) at times."""


@dataclass(frozen=True)
class _InTurn:
    """A motion as a function of time, and its continuation from a time on."""

    before: Dense
    after: Dense
    joint: float
    forward: int

    def __call__(self, t: Array) -> Array:
        earlier = self.forward * (t - self.joint) <= 0
        found = np.empty((len(self.before(np.array([self.joint]))), len(t)))
        for part, chosen in ((self.before, earlier), (self.after, ~earlier)):
            if chosen.any():
                found[:, chosen] = part(t[chosen])
        return found


@dataclass(frozen=True)
class Samples:
    """What an integrator hands back: sampled states and what they cost.

    Parameters
    ----------
    t
        Sample times, shape (times,).
    y
        States, shape (2n, times, orbits).
    carried
        What the states are beyond doubles: the state is y + carried, shape (2n, times, orbits).
    steps, evaluations
        Steps taken, and evaluations of the force (Taylor: of the series).
    step
        The step size of a fixed-step method.
    cpu_seconds, compile_seconds
        Processor time of the integration, and the wall-clock time that compiling its loop took.
    watched
        Where observables were followed inside the loop: mean, least and greatest change of each between
        samples, shape (observables, 3, times − 1, orbits).
    beyond
        What the method needs beyond the last state to go on with the same bits.
    crossings
        Events met; of many orbits those of the first, then those of the second …
    dense
        The motion of each orbit as a function of time, where it was asked for.
    each
        Of many orbits with events, which go one by one: the samples of each.
    """

    t: Array
    y: Array
    carried: Array
    steps: int
    evaluations: int
    step: float | None
    cpu_seconds: float
    compile_seconds: float
    watched: Array | None = None
    beyond: Any = None
    crossings: tuple[Crossing, ...] = ()
    dense: tuple[Dense, ...] = ()
    each: tuple[Samples, ...] = ()

    def of_one(self) -> Samples:
        """Return the samples of the first orbit, without the axis of the orbits."""
        return replace(self, y=self.y[:, :, 0], carried=self.carried[:, :, 0])


def side_by_side(each: Sequence[Samples]) -> Samples:
    """Return orbits of the same times, integrated one by one, as one motion."""
    count = min(len(one.t) for one in each)
    return replace(
        each[0],
        t=each[0].t[:count],
        y=np.concatenate([one.y[:, :count] for one in each], axis=2),
        carried=np.concatenate([one.carried[:, :count] for one in each], axis=2),
        steps=sum(one.steps for one in each),
        evaluations=sum(one.evaluations for one in each),
        cpu_seconds=sum(one.cpu_seconds for one in each),
        compile_seconds=sum(one.compile_seconds for one in each),
        beyond=None,
        crossings=tuple(met for one in each for met in one.crossings),
        dense=tuple(dense for one in each for dense in one.dense),
        each=tuple(each),
    )


def joined(before: Samples | None, after: Samples) -> Samples:
    """Return a motion and its continuation, whose first sample is the last one before, as one motion."""
    if before is None:
        return after
    watched = after.watched
    if watched is not None and before.watched is not None:
        watched = np.concatenate([before.watched, watched], axis=2)
    return replace(
        after,
        t=np.concatenate([before.t, after.t[1:]]),
        y=np.concatenate([before.y, after.y[:, 1:]], axis=1),
        carried=np.concatenate([before.carried, after.carried[:, 1:]], axis=1),
        steps=before.steps + after.steps,
        evaluations=before.evaluations + after.evaluations,
        cpu_seconds=before.cpu_seconds + after.cpu_seconds,
        watched=watched,
        crossings=before.crossings + after.crossings,
        dense=tuple(
            _InTurn(earlier, later, float(after.t[0]), 1 if after.t[-1] > after.t[0] else -1)
            for earlier, later in zip(before.dense, after.dense, strict=True)
        ),
    )


def waiting_events(events: Sequence[PreparedEvent], so_far: Samples | None) -> list[Event]:
    """Return the events that a resumed motion has not met yet where it stands; none of one that begins.

    One whose function is zero just there has not left it, so that it was not counted before.
    """
    if so_far is None or len(so_far.t) == 1:
        return []
    last = so_far.t[-1]
    return [
        each.event
        for each in events
        if not any(m.event is each.event and m.t == last for m in so_far.crossings)
    ]


@dataclass(frozen=True, eq=False)
class Statistics:
    """Changes of a quantity since the start, gathered inside the loop between samples.

    Parameters
    ----------
    mean, least, greatest
        Over the steps watched in each block, from one sample to the next, shape (times − 1,) or
        (times − 1, orbits).
    """

    mean: Array
    least: Array
    greatest: Array

    @property
    def largest(self) -> Array:
        """The largest size of the change in each block."""
        return np.maximum(abs(self.least), abs(self.greatest))

    @property
    def running(self) -> Array:
        """The largest size of the change from the start to the end of each block."""
        return np.maximum.accumulate(self.largest, axis=0)
