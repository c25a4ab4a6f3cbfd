"""Time-transformed motion: sampled after equal numbers of steps, or at the times that are asked for."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.fixed_step.compiled_loop import compiled_loop, steps_between
from canon.flow.fixed_step.partial_step import LoopState
from canon.flow.method.number_formats import fixed_precision
from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state
from canon.flow.run.samples import Samples
from canon.flow.run.sampling_plan import fixed_plan
from canon.flow.transformed.kept_rows import KeptRows
from canon.flow.transformed.transformed_orbit import StepEnd, TransformedOrbit
from canon.kernel.llvm.number_types import DOUBLE, double_pair

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.array import Array
    from canon.flow.method.method import TimeTransformed
    from canon.flow.run.event import Crossing, Event
    from canon.flow.run.sampling_plan import Plan
    from canon.flow.transformed.extended_hamiltonian import ExtendedSystem

__all__ = ["RunState", "transformed_motion"]


@dataclass(frozen=True, eq=False)
class RunState:
    """Where a motion in a fictitious time stands.

    Parameters
    ----------
    step_ends
        Of each orbit the end of its last whole step before the last state that is kept.
    stride
        How many steps apart states are kept, where they are.
    rows
        How many states are kept.
    arrived
        Whether the motion has come to its end, where the last state need not be the end of a stride.
    """

    step_ends: tuple[StepEnd, ...]
    stride: int = 1
    rows: int = 0
    arrived: bool = False


def transformed_motion(
    frame: ExtendedSystem,
    method: TimeTransformed,
    precision: str | int | None,
    states: tuple[Array, Array],
    plan: Plan,
    events: Sequence[Event],
    progress: Callable[[float], None],
    so_far: Samples | None,
) -> Samples:
    """Integrate in the fictitious time until the time has come, and land there with a part of a step.

    Parameters
    ----------
    frame
        The motion in the fictitious time.
    method, precision, states, events
        As :class:`canon.flow.task.Task` has them.
    plan
        Its instants are landed at, one part of a step aside from the motion each; where it has ``wanted`` states,
        they are kept after evenly many steps, up to twice as many.
    progress
        Called now and then with the fraction of the time span that is done.
    so_far
        What was done before, where the motion is resumed.

    Returns
    -------
    Samples
        All of the motion, what was done before included; an interruption ends it at the last state that is kept.

    Raises
    ------
    ValueError
        dt/ds is not positive at the start.
    ArithmeticError
        The time stops or turns back, or no part of a step ends at an instant.
    NonFiniteStateError
        The motion can't be continued.
    """
    run = _TransformedRun(frame, method, precision, states, plan, events, progress, so_far)
    started = time.thread_time()
    try:
        if plan.wanted:
            run.in_steps()
        else:
            run.at_instants()
    except NonFiniteStateError as lost:
        raise _told(frame, lost, run.busy if run.count > 1 else None) from None
    except KeyboardInterrupt:
        pass  # what is kept comes back
    return run.samples(time.thread_time() - started)


class _TransformedRun:
    """A motion on its way: its orbits, and what of it is kept."""

    def __init__(
        self,
        frame: ExtendedSystem,
        method: TimeTransformed,
        precision: str | int | None,
        states: tuple[Array, Array],
        plan: Plan,
        events: Sequence[Event],
        progress: Callable[[float], None],
        so_far: Samples | None,
    ) -> None:
        self.frame, self.states, self.plan, self.events = frame, states, plan, events
        self.so_far, self.progress = so_far, progress
        self.start, self.end = plan.start, Fraction(float(plan.instants[-1]))
        self.method, kind = method.method, fixed_precision(precision)
        self.bits = min(kind.number.mantissa, DOUBLE.mantissa)
        self.loop = compiled_loop(frame.system, self.method, kind)
        self.count, self.busy = states[0].shape[1], 0
        self.orbits = [self._orbit(k) for k in range(self.count)]
        # In one attribute, so that an interruption finds rows and run state of the same moment.
        self.kept = self._kept_before()

    def _orbit(self, k: int) -> TransformedOrbit:
        (high, low), frame, plan = self.states, self.frame, self.plan
        pairs = zip(high[:, k].tolist(), low[:, k].tolist(), strict=True)
        state, h = frame.start([Fraction(a) + Fraction(b) for a, b in pairs], self.start)
        if self.so_far is None:
            parts = [np.array(half)[:, np.newaxis] for half in zip(*map(double_pair, state), strict=True)]
            step_end = StepEnd(0, LoopState(parts[0], parts[1]))
        else:
            step_end = self.so_far.beyond.step_ends[k]
        steps = steps_between(self.loop, self.method, fixed_plan(Fraction(0), plan.forward * h, (0,)))
        return TransformedOrbit(frame, steps, step_end, frame.events(self.events), self.bits, self._report)

    def _kept_before(self) -> tuple[KeptRows, RunState]:
        """Return the times and states that are kept already, and where the motion stands."""
        if self.so_far is None:
            step_ends = tuple(orbit.step_end for orbit in self.orbits)
            high, low = (part[:, np.newaxis] for part in self.states)
            return KeptRows(np.array([float(self.start)]), high, low), RunState(step_ends, rows=1)
        state: RunState = self.so_far.beyond
        count = state.rows - bool(state.arrived and self.plan.wanted)
        known = KeptRows(self.so_far.t[:count], self.so_far.y[:, :count], self.so_far.carried[:, :count])
        return known, replace(state, rows=count, arrived=False)

    def _report(self, t: float) -> None:
        if self.count == 1:
            self.progress(min(1.0, float((Fraction(t) - self.start) / (self.end - self.start))))

    def _row(self, t: float, states: Sequence[LoopState]) -> tuple[Array, Array, Array]:
        high, low = (
            np.concatenate(parts, axis=1) for parts in ([s.high for s in states], [s.low for s in states])
        )
        return np.array([t]), high[self.frame.rows, np.newaxis], low[self.frame.rows, np.newaxis]

    # at the times that are asked for -------------------------------------------------------------------

    def at_instants(self) -> None:
        """Land at every instant, each time with all orbits."""
        instants, first, (rows, state) = self.plan.instants.tolist(), self.orbits[0], self.kept
        for k in range(state.rows, len(instants)):
            goal, states = Fraction(instants[k]), list[LoopState]()
            for index, orbit in enumerate(self.orbits):
                self.busy = index
                states.append(orbit.state_at(goal).state if orbit.go(goal) else orbit.state)
            # Where there are events there is one orbit.
            ended = first.stopped and not first.go(goal)
            rows.add(*self._row(first.time if ended else instants[k], states))
            step_ends = tuple(orbit.before for orbit in self.orbits)
            self.kept = rows, RunState(step_ends, rows=k + 1, arrived=ended or k + 1 == len(instants))
            if self.count > 1:
                self.progress(k / (len(instants) - 1))
            if ended:
                break

    # after evenly many steps ---------------------------------------------------------------------------

    def in_steps(self) -> None:
        """Keep every so manieth state, twice as far apart whenever there are twice as many as wanted."""
        (orbit,), end, (rows, state) = self.orbits, self.end, self.kept
        stride, most = state.stride, 2 * self.plan.wanted
        while True:
            more = self._leap(orbit, stride, most + 1 - len(rows))
            if more is None:
                reached = orbit.go(end, (orbit.n // stride + 1) * stride)
                if reached or orbit.stopped:
                    break
                more = self._row(orbit.time, [orbit.state])
            rows.add(*more)
            if len(rows) > most:
                rows, stride = rows.every_other(), 2 * stride
            self.kept = rows, RunState((orbit.step_end,), stride, len(rows))
            if orbit.interrupted:
                raise KeyboardInterrupt
        last = orbit.state_at(end).state if reached else orbit.state
        rows.add(*self._row(float(end) if reached else orbit.time, [last]))
        self.kept = rows, RunState((orbit.before,), stride, len(rows), arrived=True)

    def _leap(self, orbit: TransformedOrbit, stride: int, most: int) -> tuple[Array, Array, Array] | None:
        """Return the states of many strides taken in one go; None where so many are not surely left."""
        stops = orbit.strides(self.end, stride)[: most + 1]
        if orbit.n % stride or len(stops) < 2:
            return None
        found = orbit.leap(stops, self.end)
        if found is None or found.high.shape[1] < 2:
            return None
        times = found.high[self.frame.clock, 1:, 0] + found.low[self.frame.clock, 1:, 0]
        return times, found.high[self.frame.rows, 1:], found.low[self.frame.rows, 1:]

    # what came out -------------------------------------------------------------------------------------

    def samples(self, seconds: float) -> Samples:
        """Return all of the motion."""
        before, (rows, state) = self.so_far, self.kept
        t, high, low = rows.first(state.rows)
        ended = state.arrived
        steps = sum(orbit.n for orbit in self.orbits) if ended else sum(f.n for f in state.step_ends)
        work = sum(orbit.work for orbit in self.orbits) * self.method.stages
        return Samples(
            t=t,
            y=high,
            carried=low,
            steps=steps,
            evaluations=work + (before.evaluations if before else 0),
            step=float(self.frame.step),
            cpu_seconds=seconds + (before.cpu_seconds if before else 0.0),
            compile_seconds=self.loop.code.seconds,
            beyond=state,
            crossings=self._crossings(float(t[-1])),
        )

    def _crossings(self, last: float) -> tuple[Crossing, ...]:
        """Return the events met up to the last state that is kept."""
        (orbit, *_), forward = self.orbits, self.plan.forward
        earlier = () if self.so_far is None else self.so_far.crossings[: self.so_far.beyond.step_ends[0].met]
        found = [*earlier, *(_crossing(self.frame, met) for met in orbit.locator.crossings)]
        return tuple(met for met in found if (met.t - last) * forward <= 0)


def _crossing(frame: ExtendedSystem, met: Crossing) -> Crossing:
    """Return an event met as one of the motion in t."""
    t, y = _in_time(frame, met.y)
    return replace(met, t=t, y=y, after=None if met.after is None else _in_time(frame, met.after)[1])


def _told(frame: ExtendedSystem, lost: NonFiniteStateError, orbit: int | None) -> NonFiniteStateError:
    """Return an error in the fictitious time as one in t."""
    t, y = _in_time(frame, lost.state)
    said = str(lost).replace(time_and_state(lost.time, lost.state), time_and_state(t, y))
    return NonFiniteStateError(said if orbit is None else f"{said} (orbit {orbit})", t, y)


def _in_time(frame: ExtendedSystem, state: Array) -> tuple[float, Array]:
    """Return t and (q, p) of an extended state without parameters that vary."""
    clock = frame.clock
    return float(state[clock]), np.delete(state, [clock, 2 * clock + 1])
