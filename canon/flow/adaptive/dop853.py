"""DOP853, SciPy's adaptive Runge–Kutta method, on the compiled right-hand side."""

from __future__ import annotations

import contextlib
import math
import time
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.adaptive.longest_step import longest_step
from canon.flow.adaptive.watched_orbit import WatchedOrbit
from canon.flow.kinked.regimes import kinks_of
from canon.flow.run.samples import Samples, waiting_events

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.array import Array
    from canon.flow.kinked.regimes import Kinks
    from canon.flow.method.method import DOP853
    from canon.flow.run.event import Event, PreparedEvent
    from canon.flow.run.sampling_plan import Plan
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["dop853_motion"]

_LEAST = 2.3e-14
"""SciPy's least relative tolerance."""


def dop853_motion(
    system: HamiltonEquations,
    states: Array,
    plan: Plan,
    method: DOP853,
    progress: Callable[[float], None],
    so_far: Samples | None = None,
    max_step: float | None = None,
    events: Sequence[PreparedEvent] = (),
) -> Samples:
    """Integrate orbits one after the other and sample them; a resumed motion chooses its first step anew.

    Events, of one orbit, and kinks of the equations are located and met on the way.

    Raises
    ------
    NonFiniteStateError
        A state stops being finite, or the step size becomes too small.
    """
    times = plan.instants[0 if so_far is None else len(so_far.t) - 1 :]
    orbits, done, kinks = states.shape[1], list[Samples](), kinks_of(system)
    waiting = waiting_events(events, so_far)
    for y0 in states.T:

        def report(fraction: float, before: int = len(done)) -> None:
            progress((before + fraction) / orbits)

        done.append(_orbit(system, kinks, events, y0, times, method, report, max_step or math.inf, waiting))
        if len(done[-1].t) < len(times) and orbits > 1:
            raise KeyboardInterrupt("an ensemble under DOP853 is done orbit by orbit: nothing of it is kept")
    return Samples(
        t=done[0].t,
        y=np.stack([each.y for each in done], axis=2),
        carried=np.stack([each.carried for each in done], axis=2),
        steps=sum(each.steps for each in done),
        evaluations=sum(each.evaluations for each in done),
        step=None,
        cpu_seconds=sum(each.cpu_seconds for each in done),
        compile_seconds=sum(each.compile_seconds for each in done),
        crossings=done[0].crossings if orbits == 1 else (),
    )


def _orbit(
    system: HamiltonEquations,
    kinks: Kinks | None,
    events: Sequence[PreparedEvent],
    y0: Array,
    times: Array,
    method: DOP853,
    progress: Callable[[float], None],
    max_step: float,
    waiting: Sequence[Event],
) -> Samples:
    """Integrate one orbit with SciPy's DOP853 on the compiled right-hand side, through its events and kinks."""
    terms, started = longest_step(system), time.thread_time()
    states = np.empty((len(y0), len(times)))
    states[:, 0] = y0
    orbit = WatchedOrbit(
        system,
        kinks,
        events,
        (max(method.tolerance, _LEAST), method.tolerance),
        1 if times[-1] > times[0] else -1,
        lambda t, y: min(max_step, terms(t, y)),
        float(times[0]),
        y0.copy(),
        waiting,
    )
    with contextlib.suppress(KeyboardInterrupt):  # what is kept comes back
        orbit.go(times, states, progress)
    times, states = times[: orbit.sampled], states[:, : orbit.sampled]
    if orbit.stopped:
        times, states = np.append(times, orbit.t), np.column_stack([states, orbit.y])
    spent, compiled = time.thread_time() - started, orbit.compile_seconds
    return Samples(
        times, states, np.zeros_like(states), orbit.steps, orbit.evaluations, None, spent, compiled,
        crossings=tuple(orbit.crossings),
    )  # fmt: skip
