"""Integration of a task by the engine of its method, from the start or from an earlier run's end."""

from __future__ import annotations

from typing import TYPE_CHECKING

from canon.flow.adaptive.dop853 import dop853_motion
from canon.flow.adaptive.taylor_motion import taylor_motion
from canon.flow.fixed_step.compiled_loop import compiled_loop
from canon.flow.fixed_step.fixed_steps import fixed_steps
from canon.flow.fixed_step.statistics import loop_observables
from canon.flow.method.method import DOP853, FixedStep, Taylor, TimeTransformed
from canon.flow.method.number_formats import fixed_precision
from canon.flow.run.event import prepared_events
from canon.flow.run.samples import joined
from canon.flow.transformed.transformed_motion import transformed_motion

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.flow.run.samples import Samples
    from canon.flow.task import Task

__all__ = ["integrate", "silently"]


def silently(_done: float) -> None:
    """Report nothing."""


def integrate(
    task: Task, progress: Callable[[float], None] = silently, so_far: Samples | None = None
) -> Samples:
    """Return all of a task's motion, what was done before included.

    Raises
    ------
    NonFiniteStateError
        The motion can't be continued.
    """
    if isinstance(task.method, TimeTransformed):
        frame = task.fictitious
        assert frame is not None
        return transformed_motion(
            frame, task.method, task.precision, task.states, task.plan, task.events, progress, so_far
        )
    return joined(so_far, _more(task, progress, so_far))


def _more(task: Task, progress: Callable[[float], None], so_far: Samples | None) -> Samples:
    """Return the part of the motion that was not done before."""
    states = task.states if so_far is None else (so_far.y[:, -1], so_far.carried[:, -1])
    events, orbits = prepared_events(task.system, task.events), states[0].shape[1]
    if isinstance(task.method, FixedStep):
        loop = compiled_loop(task.system, task.method, fixed_precision(task.precision), orbits)
        watch = None
        if task.cadence is not None:
            watch = loop_observables(
                task.system, task.nodes, loop, task.states, task.plan.start, task.cadence
            )
        return fixed_steps(task.system, loop, task.method, states, task.plan, progress, watch, so_far, events)
    if isinstance(task.method, DOP853):
        return dop853_motion(task.system, states[0], task.plan, task.method, progress, so_far)
    assert isinstance(task.method, Taylor)
    precision, dense = task.precision or "double", task.dense
    return taylor_motion(
        task.system, states, task.plan, task.method, precision, progress, so_far, events, dense=dense
    )
