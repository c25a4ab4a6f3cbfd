"""Running a compiled loop with an eye on events."""

from __future__ import annotations

import functools
import time
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.fixed_step.advance import Interruption, Run
from canon.flow.fixed_step.event_search import Guard
from canon.flow.fixed_step.loop_buffers import Job
from canon.flow.fixed_step.partial_step import PartialSteps, State, coefficient_pairs
from canon.kernel.loops.event_loop import sentry_function

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.array import Array
    from canon.flow.fixed_step.loop_buffers import Memory
    from canon.flow.run.event import Crossing, Prepared
    from canon.kernel.llvm.loop import Loop
    from canon.kernel.llvm.machine_code import MachineCode
    from canon.kernel.program.hamilton_equations import Equations

__all__ = ["run_with_events"]

_KEPT = 64
_SLICE = 10_000
"""Steps between looks at progress, interruptions and whether the state is finite."""


@functools.lru_cache(maxsize=_KEPT)
def _kept_sentry(
    system: Equations, values: tuple[int, ...], rates: tuple[int, ...], loop: Loop
) -> MachineCode:
    return sentry_function(system, values, rates, loop)


def run_with_events(
    system: Equations,
    steps: PartialSteps,
    start: State,
    stops: Sequence[int],
    events: Sequence[Prepared],
    progress: Callable[[float], None],
) -> tuple[Run, tuple[Crossing, ...], Fraction]:
    """Advance one orbit step by step, keep its states at the wanted step numbers and meet events.

    Parameters
    ----------
    system
        The equations.
    steps
        The method and its step.
    start
        The state at the first stop.
    stops
        Rising step numbers at which to keep the state.
    events
        The events.
    progress
        Called now and then with the fraction done.

    Returns
    -------
    tuple
        The run, whose last state is the one at the event that stopped it, if one did; the crossings; how many
        steps were taken in all since step 0, with the part of the last one.

    Raises
    ------
    NonFiniteStateError
        A state is not finite, or events pile up.
    """
    loop, guard = steps.loop, Guard(system, steps, events)
    code = _kept_sentry(system, tuple(e.value for e in events), tuple(e.rate for e in events), loop)
    pairs = coefficient_pairs(steps.coefficients, steps.t0, steps.h)
    job = Job(loop, start.high, start.low, pairs, memory=start.beyond)
    kept = np.zeros(1 + 3 * len(events))
    kept[0] = guard.forward
    done, before = np.array([stops[0]], dtype=np.int64), (np.empty_like(job.y), np.empty_like(job.e))
    states, beyond = [job.states()], [job.beyond()]
    kept[1:] = np.ravel(guard.start(State(*states[0]), steps.time(stops[0], Fraction(0))))
    started, reached = time.thread_time(), Fraction(stops[0])
    try:
        for stop in stops[1:]:
            while done[0] < stop:
                first = int(done[0])
                safe = job.y.copy(), job.e.copy()
                memory = (job.y, job.e, job.c, *before, kept, done)
                wanted = min(_SLICE, stop - first)
                code.call(loop.code.address, *(m.ctypes.data for m in memory), first, wanted)
                n = int(done[0])
                if not job.finite():
                    raise job.lost(*safe, first, n - first, np.array(system.rows))
                old = State(*job.states(), job.beyond())
                new, part, known = guard.through(n - 1, _state_in(job, before), old)
                if not known:  # stopped, maybe at the very end of the step
                    states.append((new.high, new.low))
                    beyond.append(job.beyond())
                    return _run(states, beyond, loop, started), tuple(guard.met), n - 1 + part
                if new is not old:
                    job = Job(loop, new.high, new.low, pairs, memory=new.beyond)
                kept[1:] = np.ravel(known)
                progress(n / stops[-1])
            states.append(job.states())
            beyond.append(job.beyond())
            reached = Fraction(stop)
    except (KeyboardInterrupt, Interruption):
        last = float(steps.time(int(reached), Fraction(0)))
        guard.met = [met for met in guard.met if (met.t - last) * guard.forward <= 0]
    return _run(states, beyond, loop, started), tuple(guard.met), reached


def _state_in(job: Job, memory: tuple[Memory, Memory]) -> State:
    own = job.y, job.e
    job.y, job.e = memory
    found = State(*job.states(), job.beyond())
    job.y, job.e = own
    return found


def _run(states: Sequence[tuple[Array, Array]], beyond: Sequence[Memory], loop: Loop, started: float) -> Run:
    high, low = (np.stack([pair[k] for pair in states], axis=1) for k in (0, 1))
    iterations = int(beyond[-1][:, 0].sum()) if loop.implicit else 0
    return Run(high, low, None, np.array(beyond), iterations, time.thread_time() - started)
