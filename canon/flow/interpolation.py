"""Interpolation: states of a motion between its samples."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.fixed_step.compiled_loop import compiled_loop, steps_between
from canon.flow.fixed_step.partial_step import LoopState
from canon.flow.method.engine import FIXED_STEPS
from canon.flow.method.number_formats import fixed_precision

if TYPE_CHECKING:
    from canon.array import Array
    from canon.flow.fixed_step.partial_step import PartialSteps
    from canon.flow.run.samples import Samples
    from canon.flow.task import Task

__all__ = ["states_at"]


def states_at(task: Task, samples: Samples, times: Array) -> Array:
    """Return the states (2n, times, orbits) of a motion at any times inside its span.

    Raises
    ------
    ValueError
        A time lies outside; or what is needed was not kept.
    """
    first, last = sorted((samples.t[0], samples.t[-1]))
    if not ((first <= times) & (times <= last)).all():
        raise ValueError(f"the motion is known from t = {samples.t[0]:g} to {samples.t[-1]:g} only")
    if task.system.kicked and (times != times.round()).any():
        raise ValueError("a map has no states between its iterations: give whole times")
    if task.method.engine.keeps_polynomials:
        if not samples.dense:
            raise ValueError("the motion was not kept as a function of time: propagate(…, dense=True)")
        return np.stack([orbit(times) for orbit in samples.dense], axis=2)
    if task.method.engine is not FIXED_STEPS:
        raise ValueError(
            f"{task.method} is not kept as a function of time: name the times, propagate(…, times=…)"
        )
    if any(met.after is not None for met in samples.crossings):
        raise ValueError(
            "events changed the state on the way, which steps from a sample do not know: propagate(…, times=…)"
        )
    orbits = samples.y.shape[2]
    if not times.size:
        return np.empty((len(samples.y), 0, orbits))
    loop = compiled_loop(task.system, task.method, fixed_precision(task.precision), orbits)
    filled = np.minimum(np.arange(-(-orbits // loop.number.lanes) * loop.number.lanes), orbits - 1)
    steps = steps_between(loop, task.method, task.plan)
    found = np.stack([_at(steps, task, samples, filled, Fraction(t)) for t in times.tolist()], axis=1)
    return found[:, :, :orbits]


def _at(steps: PartialSteps, task: Task, samples: Samples, filled: Any, t: Fraction) -> Array:
    forward, stops = task.plan.forward, task.plan.stops
    k = max(int(np.searchsorted(forward * samples.t, forward * float(t), side="right")) - 1, 0)
    place = max((t - steps.t0) / steps.h, Fraction(stops[k]))
    if float(steps.time(round(place), Fraction(0))) == float(t):
        place = Fraction(round(place))
    n = int(place)
    state = LoopState(samples.y[:, k, filled], samples.carried[:, k, filled])
    if n > stops[k]:
        state = steps.whole(state, stops[k], n - stops[k])
    return steps.moved(state, n, Fraction(0), place - n).high
