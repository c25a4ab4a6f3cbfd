"""Fixed-step runs: the plan of steps, orbits on threads, samples."""

from __future__ import annotations

import dataclasses
import functools
import math
import os
import threading
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.fixed_step.advance import AdvancedStates, Interruption, advance_orbits
from canon.flow.fixed_step.compiled_loop import steps_between
from canon.flow.fixed_step.partial_step import LoopState
from canon.flow.fixed_step.statistics import check_cadence, statistics
from canon.flow.fixed_step.steps_with_events import run_with_events
from canon.flow.run.samples import Samples, waiting_events
from canon.flow.run.sampling_plan import Plan, Sampling, fixed_plan, steps_over

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.array import Array
    from canon.flow.fixed_step.loop_buffers import LoopObservables, Memory
    from canon.flow.method.method import FixedStep, Method
    from canon.flow.run.event import PreparedEvent
    from canon.kernel.llvm.loop import Loop
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["fixed_steps", "planned"]

_FEW = 1000
"""Plans of so many samples are kept for the next motion of the same length."""


def planned(wanted: Sampling, step: float | None, method: Method) -> Plan:
    """Return the plan of a run: the largest step, not above the given one, that divides the span.

    Raises
    ------
    ValueError
        The step is missing or makes no sense.
    """
    steps = steps_over(wanted.start, wanted.end, step, method)
    few = wanted.times is None and wanted.samples <= _FEW
    return (_kept_plan if few else _plan)(wanted, steps)


def _plan(wanted: Sampling, steps: int) -> Plan:
    return fixed_plan(wanted.start, (wanted.end - wanted.start) / steps, tuple(wanted.stops(steps)))


_kept_plan = functools.lru_cache(maxsize=64)(_plan)


def fixed_steps(
    system: HamiltonEquations,
    loop: Loop,
    method: FixedStep,
    states: tuple[Array, Array],
    plan: Plan,
    progress: Callable[[float], None],
    watch: LoopObservables | None = None,
    so_far: Samples | None = None,
    events: Sequence[PreparedEvent] = (),
) -> Samples:
    """Step along a plan and sample on the way; an interruption ends that at the last sample reached by all orbits.

    Parameters
    ----------
    system
        The equations.
    loop, method
        The compiled loop and the method it was compiled for.
    states
        The states to start from as sums of two doubles, each of shape (2n, orbits).
    plan
        The steps, and after which of them to sample.
    progress
        Called now and then with the fraction done.
    watch
        Observables to follow inside the loop.
    so_far
        What was done before, where the motion is resumed.
    events
        Events, of one orbit.
    """
    steps, orbits = steps_between(loop, method, plan), states[0].shape[1]
    first = 0 if so_far is None else len(so_far.t) - 1
    stops, memory = plan.stops[first:], None if so_far is None else so_far.beyond
    if watch is not None:
        check_cadence(watch, stops)
    met, end = (), Fraction(0)
    if events:
        start = LoopState(*states, memory)
        found, met, end = run_with_events(
            system, steps, start, stops, events, progress, waiting_events(events, so_far)
        )
        runs = [found]
    else:
        runs = _on_threads(loop, states, steps.pairs, stops, progress, watch, memory, system.rows)
    samples = min(found.high.shape[1] for found in runs)
    runs = [found.first(samples) for found in runs]
    high, low = _side_by_side([r.high for r in runs]), _side_by_side([r.low for r in runs])
    t = plan.instants[first : first + samples].copy()
    taken = stops[samples - 1] - stops[0]
    if met and met[-1].event.action == "stop":
        t[-1], taken = met[-1].t, math.ceil(end) - stops[0]
    beyond = runs[0].beyond[-1] if len(runs) == 1 else np.concatenate([found.beyond[-1] for found in runs])
    iterations = taken * orbits
    if loop.implicit:
        iterations = round(float(beyond[:, 0].sum() - (0 if memory is None else memory[:, 0].sum())))
    return Samples(
        t=t,
        y=high[:, :, :orbits],
        carried=low[:, :, :orbits],
        steps=taken,
        evaluations=iterations * method.stages,
        step=float(steps.h),
        cpu_seconds=sum(r.cpu_seconds for r in runs),
        compile_seconds=loop.code.seconds,
        watched=statistics(runs, stops[:samples], watch, orbits),
        beyond=beyond,
        crossings=met,
    )


def _side_by_side(parts: Sequence[Array]) -> Array:
    return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=2)


def _on_threads(
    loop: Loop,
    states: tuple[Array, Array],
    coefficients: tuple[Array, Array],
    stops: Sequence[int],
    progress: Callable[[float], None],
    watch: LoopObservables | None,
    memory: Memory | None,
    rows: Sequence[int],
) -> list[AdvancedStates]:
    """Run orbits on as many threads as there are processors, each a whole number of blocks."""
    (high, low), lanes = states, loop.number.lanes
    orbits = high.shape[1]
    blocks = -(-orbits // lanes)
    if blocks == 1 and lanes == 1:
        return [advance_orbits(loop, high, low, coefficients, stops, progress, watch, memory, rows)]
    # The last block is filled up with copies of the last orbit.
    filled = np.minimum(np.arange(blocks * lanes), orbits - 1)
    parts = np.array_split(filled.reshape(blocks, lanes), min(os.cpu_count() or 1, blocks))
    own_blocks = np.array_split(np.arange(blocks), len(parts))
    stopped, done, lock = threading.Event(), [0.0] * len(parts), threading.Lock()

    def part(k: int) -> AdvancedStates:
        def report(fraction: float) -> None:
            if stopped.is_set():
                raise Interruption
            with lock:
                done[k] = fraction
                progress(min(done))

        chosen = parts[k].ravel()
        own = None if watch is None else dataclasses.replace(watch, start=watch.start[chosen])
        kept = None if memory is None else memory[own_blocks[k]]
        whose = chosen if orbits > 1 else None
        found = advance_orbits(
            loop, high[:, chosen], low[:, chosen], coefficients, stops, report, own, kept, rows, whose=whose
        )
        if found.high.shape[1] < len(stops):
            stopped.set()
        return found

    with ThreadPoolExecutor(len(parts)) as pool:
        futures = [pool.submit(part, k) for k in range(len(parts))]
        try:
            wait(futures, return_when=FIRST_EXCEPTION)
        except KeyboardInterrupt:
            pass
        finally:
            stopped.set()
        found = [future.result() for future in futures]
    if min(each.high.shape[1] for each in found) == len(stops):
        progress(1.0)
    return found
