"""Integration of a task by the engine of its method, from the start or from an earlier run's end.

An engine is imported when the first motion by it is asked for.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from canon.flow.kinked.regimes import kinks_of
from canon.flow.method.engine import FICTITIOUS_TIME, FIXED_STEPS, HEYOKA, SCIPY, Engine
from canon.flow.method.number_formats import fixed_precision
from canon.flow.run.event import prepared_events
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.run.samples import joined, side_by_side

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.array import Array
    from canon.flow.method.method import DOP853, FixedStep, Taylor, TimeTransformed
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
    if task.states[0].shape[1] > 1 and (task.events or _is_watched(task)):
        return _one_by_one(task, progress, so_far)
    return _ENGINES[task.method.engine](task, task.method, progress, so_far)


def _is_watched(task: Task) -> bool:
    """Tell whether an adaptive method looks out for zeros in the equations at which their motion ends."""
    if task.method.engine not in (HEYOKA, SCIPY):
        return False
    from canon.flow.kinked.branch_points import may_meet_branch_points
    from canon.flow.kinked.cuts_of_angles import may_cross_cuts
    from canon.flow.kinked.lost_direction import may_lose_direction

    branches = task.method.engine is HEYOKA and kinks_of(task.system) is None
    by_series = task.method.engine is HEYOKA and may_cross_cuts(task.system)
    return by_series or may_lose_direction(task.system) or (branches and may_meet_branch_points(task.system))


def _one_by_one(task: Task, progress: Callable[[float], None], so_far: Samples | None) -> Samples:
    """Return orbits each the same bits as by itself: events and such zeros are met at times of each orbit's own.

    Raises
    ------
    NonFiniteStateError
        One of them can't be continued; the message says which.
    KeyboardInterrupt
        The run was interrupted: what is done of one orbit is no part of a motion of all.
    """
    made: list[Samples] = []
    count = task.states[0].shape[1]
    for k in range(count):

        def report(fraction: float, before: int = k) -> None:
            progress((before + fraction) / count)

        high, low = (part[:, [k]] for part in task.states)
        own = replace(task, states=(high, low))
        try:
            made.append(integrate(own, report, None if so_far is None else so_far.each[k]))
        except NonFiniteStateError as lost:
            raise type(lost)(f"orbit {k}: {lost}", lost.time, lost.state) from None
        if not own.arrived(made[-1]):
            raise KeyboardInterrupt(
                "orbits with events or roots are done one by one: nothing of them is kept"
            )
    return side_by_side(made)


def _in_fictitious_time(
    task: Task, method: TimeTransformed, progress: Callable[[float], None], so_far: Samples | None
) -> Samples:
    from canon.flow.transformed.transformed_motion import transformed_motion

    frame = task.fictitious
    assert frame is not None
    return transformed_motion(
        frame, method, task.precision, task.states, task.plan, task.events, progress, so_far
    )


def _in_fixed_steps(
    task: Task, method: FixedStep, progress: Callable[[float], None], so_far: Samples | None
) -> Samples:
    from canon.flow.fixed_step.compiled_loop import compiled_loop
    from canon.flow.fixed_step.constraint_trouble import told_of_constraints
    from canon.flow.fixed_step.fixed_steps import fixed_steps
    from canon.flow.fixed_step.statistics import loop_observables

    states, events = _states(task, so_far), prepared_events(task.system, task.events)
    loop = compiled_loop(task.system, method, fixed_precision(task.precision), states[0].shape[1])
    watch = None
    if task.cadence is not None:
        watch = loop_observables(
            task.system,
            (task.system.hamiltonian, *map(task.system.node_of, task.observed)),
            loop,
            task.states,
            task.plan.start,
            task.cadence,
        )
    try:
        made = fixed_steps(task.system, loop, method, states, task.plan, progress, watch, so_far, events)
    except NonFiniteStateError as lost:
        if not task.system.keeps_constraints or task.plan.h is None:
            raise
        raise told_of_constraints(task.system, lost, float(task.plan.h)) from None
    return joined(so_far, made)


def _by_heyoka(
    task: Task, method: Taylor, progress: Callable[[float], None], so_far: Samples | None
) -> Samples:
    from canon.flow.adaptive.state_unit import parameter_units
    from canon.flow.adaptive.taylor_motion import taylor_motion
    from canon.flow.kinked.branch_points import branch_points, check_branch_points
    from canon.flow.kinked.cuts_of_angles import check_cuts, cuts_of_angles
    from canon.flow.kinked.lost_direction import check_directions, lost_directions

    system, states, events = task.system, _states(task, so_far), prepared_events(task.system, task.events)
    precision, dense = task.precision or method.engine.usual_precision, task.dense
    start, begin = states[0][:, 0], _begin(task, so_far)
    branches = branch_points(system, start, begin) if kinks_of(system) is None else ()
    lost = lost_directions(system, start, begin)
    cuts = cuts_of_angles(system) if states[0].shape[1] == 1 else ()
    looked = *events, *branches, *lost, *cuts
    units = parameter_units(system, task.states[0], looked)
    high, low = map(units.of, states)
    made = taylor_motion(
        units.system, (high, low), task.plan, method, precision, progress, so_far, units.events(looked), dense=dense,
        max_step=task.max_step,
    )  # fmt: skip
    if units.system is not system:
        made = replace(made, y=units.back(made.y), carried=units.back(made.carried))
    made = check_cuts(system, cuts, made, start) if cuts else made
    made = check_directions(lost, made)
    return joined(so_far, check_branch_points(branches, made))


def _by_scipy(
    task: Task, method: DOP853, progress: Callable[[float], None], so_far: Samples | None
) -> Samples:
    from canon.flow.adaptive.dop853 import dop853_motion
    from canon.flow.kinked.lost_direction import check_directions, lost_directions

    (states, _), events = _states(task, so_far), prepared_events(task.system, task.events)
    lost = lost_directions(task.system, states[:, 0], _begin(task, so_far))
    made = dop853_motion(
        task.system, states, task.plan, method, progress, so_far, task.max_step, (*events, *lost)
    )
    return joined(so_far, check_directions(lost, made))


_ENGINES: dict[Engine, Callable[[Task, Any, Callable[[float], None], Samples | None], Samples]] = {
    FICTITIOUS_TIME: _in_fictitious_time,
    FIXED_STEPS: _in_fixed_steps,
    HEYOKA: _by_heyoka,
    SCIPY: _by_scipy,
}
"""What integrates with the methods of each engine; all of the motion comes back, what was done before included."""


def _states(task: Task, so_far: Samples | None) -> tuple[Array, Array]:
    """Return the states to go on from."""
    return task.states if so_far is None else (so_far.y[:, -1], so_far.carried[:, -1])


def _begin(task: Task, so_far: Samples | None) -> float:
    """Return the time to go on from."""
    return float(task.plan.last(0 if so_far is None else len(so_far.t) - 1))
