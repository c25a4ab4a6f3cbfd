"""Fixed steps with event location: compiled steps, stopped wherever an event may have happened."""

from __future__ import annotations

import time
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.fixed_step.advance import AdvancedStates, Interruption
from canon.flow.fixed_step.event_search import EventLocator, compiled_watch
from canon.flow.fixed_step.loop_buffers import LoopBuffers
from canon.flow.fixed_step.partial_step import LoopState, PartialSteps

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from canon.array import Array
    from canon.flow.fixed_step.loop_buffers import Memory
    from canon.flow.run.event import Crossing, Event, PreparedEvent
    from canon.kernel.llvm.loop import Loop
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["run_with_events"]

_SLICE = 10_000
"""Steps between looks at progress, interruptions and whether the state is finite."""


def run_with_events(
    system: HamiltonEquations,
    steps: PartialSteps,
    start: LoopState,
    stops: Sequence[int],
    events: Sequence[PreparedEvent],
    progress: Callable[[float], None],
    waiting: Collection[Event] = (),
) -> tuple[AdvancedStates, tuple[Crossing, ...], Fraction]:
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
    waiting
        Of a motion that is resumed: the events that it has not met yet where it stands.

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
    loop, locator = steps.loop, EventLocator(system, steps, events)
    code = compiled_watch(system, events, loop)
    pairs = steps.pairs
    buffers = LoopBuffers(loop, start.high, start.low, pairs, memory=start.beyond)
    kept = np.zeros(1 + 3 * len(events))
    kept[0] = locator.forward
    done, before = np.array([stops[0]], dtype=np.int64), (np.empty_like(buffers.y), np.empty_like(buffers.e))
    states, beyond = [buffers.states()], [buffers.beyond()]
    kept[1:] = np.ravel(locator.start(LoopState(*states[0]), steps.time(stops[0], Fraction(0)), waiting))
    started, reached = time.thread_time(), Fraction(stops[0])
    try:
        for stop in stops[1:]:
            while done[0] < stop:
                first = int(done[0])
                safe = buffers.y.copy(), buffers.e.copy()
                memory = (buffers.y, buffers.e, buffers.c, *before, kept, done)
                wanted = min(_SLICE, stop - first)
                code.call(loop.code.address, *(m.ctypes.data for m in memory), first, wanted)
                n = int(done[0])
                if not buffers.finite():
                    raise buffers.lost(*safe, first, n - first, system.rows)
                old = LoopState.of(buffers)
                new, part, known = locator.locate(n - 1, LoopState.in_copy(buffers, *before), old)
                if not known:  # stopped, maybe at the very end of the step
                    if _same_time(steps, reached, n - 1 + part):
                        _forget_last(states, beyond)
                    states.append((new.high, new.low))
                    beyond.append(buffers.beyond())
                    return _run(states, beyond, loop, started), tuple(locator.crossings), n - 1 + part
                if new is not old:
                    buffers = LoopBuffers(loop, new.high, new.low, pairs, memory=new.beyond)
                kept[1:] = np.ravel(known)
                progress(n / stops[-1])
            states.append(buffers.states())
            beyond.append(buffers.beyond())
            reached = Fraction(stop)
    except (KeyboardInterrupt, Interruption):
        last = float(steps.time(int(reached), Fraction(0)))
        locator.crossings = [met for met in locator.crossings if (met.t - last) * locator.forward <= 0]
    return _run(states, beyond, loop, started), tuple(locator.crossings), reached


def _same_time(steps: PartialSteps, reached: Fraction, place: Fraction) -> bool:
    """Return whether doubles do not tell the times of two places, counted in steps."""
    return float(steps.time(0, reached)) == float(steps.time(0, place))


def _forget_last(states: list[tuple[Array, Array]], beyond: list[Memory]) -> None:
    """Forget the state that was kept last, where it is not the start."""
    if len(states) > 1:
        del states[-1], beyond[-1]


def _run(
    states: Sequence[tuple[Array, Array]], beyond: Sequence[Memory], loop: Loop, started: float
) -> AdvancedStates:
    high, low = (np.stack([pair[k] for pair in states], axis=1) for k in (0, 1))
    iterations = int(beyond[-1][:, 0].sum()) if loop.implicit else 0
    return AdvancedStates(high, low, None, np.array(beyond), iterations, time.thread_time() - started)
