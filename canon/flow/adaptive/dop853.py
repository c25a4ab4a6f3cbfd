"""DOP853, SciPy's adaptive Runge–Kutta method, on the compiled right-hand side."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.adaptive.longest_step import longest_step
from canon.flow.adaptive.watched_orbit import WatchedOrbit
from canon.flow.kinked.regimes import kinks_of
from canon.flow.run.compiled_nodes import compiled_nodes
from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state
from canon.flow.run.samples import Samples

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.array import Array
    from canon.flow.kinked.regimes import Kinks
    from canon.flow.method.method import DOP853
    from canon.flow.run.event import PreparedEvent
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
    for y0 in states.T:

        def report(fraction: float, before: int = len(done)) -> None:
            progress((before + fraction) / orbits)

        longest = max_step or math.inf
        if events or kinks is not None:
            done.append(_watched(system, kinks, events, y0, times, method, report, longest))
        else:
            done.append(_dop853(system, y0, times, method, report, longest))
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


def _watched(
    system: HamiltonEquations,
    kinks: Kinks | None,
    events: Sequence[PreparedEvent],
    y0: Array,
    times: Array,
    method: DOP853,
    progress: Callable[[float], None],
    max_step: float,
) -> Samples:
    """Integrate one orbit through its events and kinks."""
    terms = longest_step(system)
    started, sample = time.thread_time(), 1
    states = np.empty((len(y0), len(times)))
    states[:, 0] = y0
    orbit = WatchedOrbit(
        system,
        kinks,
        events,
        _tolerances(method),
        1 if times[-1] > times[0] else -1,
        lambda t, y: min(max_step, terms(t, y)),
        float(times[0]),
        y0.copy(),
    )
    try:
        sample = orbit.go(times, states, sample, progress)
    except KeyboardInterrupt:
        sample = int(np.searchsorted(times * orbit.forward, orbit.t * orbit.forward, side="right"))
    times, states = times[:sample], states[:, :sample]
    if orbit.stopped:
        times, states = np.append(times, orbit.t), np.column_stack([states, orbit.y])
    spent, compiled = time.thread_time() - started, orbit.compile_seconds
    return Samples(
        times, states, np.zeros_like(states), orbit.steps, orbit.evaluations, None, spent, compiled,
        crossings=tuple(orbit.crossings),
    )  # fmt: skip


def _tolerances(method: DOP853) -> tuple[float, float]:
    return max(method.tolerance, _LEAST), method.tolerance


def _dop853(
    system: HamiltonEquations,
    y0: Array,
    times: Array,
    method: DOP853,
    progress: Callable[[float], None],
    max_step: float,
) -> Samples:
    """Integrate with SciPy's DOP853 on the compiled right-hand side."""
    from scipy import integrate

    rates = compiled_nodes(system, system.rates)
    longest = longest_step(system)
    started, steps, sample = time.thread_time(), 0, 1
    relative, absolute = _tolerances(method)
    integrator = integrate.DOP853(rates.call, times[0], y0, times[-1], rtol=relative, atol=absolute)
    states = np.empty((len(y0), len(times)))
    states[:, 0] = y0
    direction = np.sign(times[-1] - times[0])
    try:
        while sample < len(times):
            before, kept = integrator.t, integrator.y.copy()
            integrator.max_step = min(max_step, longest(before, kept))
            message = integrator.step()
            steps += 1
            if integrator.status == "failed" or not np.isfinite(integrator.y).all():
                raise _lost(float(before), kept[system.rows], message)
            reached = sample
            while reached < len(times) and direction * (times[reached] - integrator.t) <= 0:
                reached += 1
            if reached > sample:
                states[:, sample:reached] = integrator.dense_output()(times[sample:reached])
                sample = reached
            progress(float((integrator.t - times[0]) / (times[-1] - times[0])))
    except KeyboardInterrupt:
        times, states = times[:sample], states[:, :sample]
    spent = time.thread_time() - started
    return Samples(times, states, np.zeros_like(states), steps, integrator.nfev, None, spent, rates.seconds)


def _lost(t: float, state: Array, reason: object) -> NonFiniteStateError:
    return NonFiniteStateError(
        f"the motion can't be continued after {time_and_state(t, state)} ({reason}): a collision or the edge of H's "
        "domain; stop earlier",
        t,
        state,
    )
