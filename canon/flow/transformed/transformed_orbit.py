"""Time-transformed integration of one orbit: whole steps in the fictitious time, then a part of one to a given t.

Far from the wanted time many steps are taken in one go, half as many as would lead there if they stayed as long as
the latest; should they pass it nevertheless they are taken back. Near it the compiled loop looks at the time after
every step. So no motion is asked for more than one step behind its end.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.fixed_step.advance import AdvancedStates, advance_orbits
from canon.flow.fixed_step.event_search import EventLocator, compiled_watch
from canon.flow.fixed_step.loop_buffers import LoopBuffers
from canon.flow.fixed_step.partial_step import LoopState, PartialSteps
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.transformed.land_at_time import Segment, iterations, state_at_time, time_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.flow.run.event import PreparedEvent
    from canon.flow.transformed.extended_hamiltonian import ExtendedSystem
    from canon.flow.transformed.land_at_time import StateAtTime

__all__ = ["StepEnd", "TransformedOrbit"]

_SLICE = 10_000
"""Steps between looks at progress and interruptions; a time that stands still for so many has stopped."""

_LEAP = 16
"""So many steps at least are taken in one go."""

_MANY = 32
"""From so many kept states on they are passed in compiled code: there is one leap after the other."""

_PATIENCE, _LIFETIME = 2**20, 2.0**50
"""After so many steps a motion that needs so many more is given up: they would take years."""


@dataclass(frozen=True, eq=False)
class StepEnd:
    """The end of a whole step, from which a motion goes on with the same bits.

    Parameters
    ----------
    n
        Steps since the start.
    state
        The extended state, shape (2n, 1).
    sides
        On which side of zero the events' functions are; empty where that is not known yet.
    met
        How many events have been met.
    """

    n: int
    state: LoopState
    sides: tuple[int, ...] = ()
    met: int = 0


class TransformedOrbit:
    """One orbit on its way.

    Parameters
    ----------
    frame
        The extended equations.
    steps
        The method's steps in the fictitious time; negative ones where time runs back.
    step_end
        Where it stands.
    events
        What to look for.
    bits
        Bits of the mantissa that times are known to.
    report
        Called now and then with the time.
    """

    def __init__(
        self,
        frame: ExtendedSystem,
        steps: PartialSteps,
        step_end: StepEnd,
        events: Sequence[PreparedEvent],
        bits: int,
        report: Callable[[float], None],
    ) -> None:
        self.frame, self.steps, self.events, self.bits, self.report = frame, steps, events, bits, report
        self.forward = 1 if steps.h > 0 else -1
        self.pairs = steps.pairs
        self.code = compiled_watch(frame.system, events, steps.loop, frame.clock)
        self.n, self.stopped, self.work, self.interrupted = step_end.n, False, 0, False
        self.before, self.segments, self._earlier = (
            step_end,
            [Segment(Fraction(0), step_end.state)],
            step_end.met,
        )
        self._pace, self._stride, self._still = _LEAP, float(frame.step), 0
        self._stand(step_end.state)
        self._begun = self.n, self.time
        self.locator = EventLocator(frame.system, steps, events)
        self.kept = np.zeros(2 + 3 * len(events))
        self.kept[0] = self.forward
        if events:
            self.kept[1:-1] = np.ravel(self._sides(step_end))

    def _sides(self, step_end: StepEnd) -> list[tuple[int, float, float]]:
        locator, t = self.locator, Fraction(0)
        known = locator.start(step_end.state, t)
        if step_end.sides:
            locator.sides = list(step_end.sides)
            known = locator.known(locator.values_and_rates(step_end.state, t))
        return known

    def _stand(self, state: LoopState) -> None:
        self.buffers = LoopBuffers(self.steps.loop, state.high, state.low, self.pairs, memory=state.beyond)
        self._read()

    def _read(self) -> None:
        """Note the state and the time at the end of the latest step, or where an event ended the motion."""
        self.state = LoopState.of(self.buffers)
        self.time = float(time_of(self.state, self.frame.clock))

    @property
    def step_end(self) -> StepEnd:
        """Where the latest step has ended."""
        return StepEnd(self.n, self.state, tuple(self.locator.sides), self._met)

    @property
    def _met(self) -> int:
        return self._earlier + len(self.locator.crossings)

    # steps ----------------------------------------------------------------------------------------------

    def go(self, goal: Fraction, last: int | None = None) -> bool:
        """Take steps until the time has come, or a step has a number, or an event ends the motion.

        Returns
        -------
        bool
            Whether the time has come.

        Raises
        ------
        ArithmeticError
            The time stops or turns back.
        """
        there = self._there(goal)
        while not self.stopped and not self._has_come(there) and (last is None or self.n < last):
            left = _SLICE if last is None else min(_SLICE, last - self.n)
            safe = min(left, self._safe(there))
            if safe < _LEAP or self.leap([self.n, self.n + safe], goal) is None:
                self._watched(left if self.events else min(left, _LEAP), there)
            if self.interrupted:
                raise KeyboardInterrupt
            self.report(self.time)
        return self._has_come(there)

    def strides(self, goal: Fraction, stride: int) -> list[int]:
        """Return the numbers of steps, a stride apart, that surely end before a time; one where there are none."""
        steps = self._safe(self._there(goal))
        return list(range(self.n, self.n + (steps if steps >= _LEAP else 0) + 1, stride))

    def leap(self, stops: Sequence[int], goal: Fraction) -> AdvancedStates | None:
        """Take steps in one go and return the states at some of them; take them back where they pass a time."""
        start, there, old = self.state, self._there(goal), self.time
        rows = self.frame.system.rows
        try:
            found = advance_orbits(
                self.steps.loop, start.high, start.low, self.pairs, stops, lambda _: self.report(old),
                memory=start.beyond, rows=rows, many=_MANY,
            )  # fmt: skip
        except NonFiniteStateError:
            found = None
        steps = stops[-1] - stops[0]
        if found is None:
            self.work += steps
            self._pace //= 4
            return None
        reached = stops[found.high.shape[1] - 1]
        self._count(start, found.beyond[-1], reached - stops[0])
        times = self.forward * (found.high[self.frame.clock, :, 0] + found.low[self.frame.clock, :, 0])
        if (np.diff(times) <= 0).any() or times[-1] >= self.forward * there:
            self._pace //= 4
            return None
        self.n, self._pace = reached, 2 * self._pace
        self._stand(LoopState(found.high[:, -1], found.low[:, -1], found.beyond[-1]))
        self._stride = abs(self.time - old) / max(1, steps)
        self.before, self.segments = self.step_end, [Segment(Fraction(0), self.state)]
        self.interrupted = reached < stops[-1]
        return found

    def _safe(self, there: float) -> int:
        """Return how many steps surely end before a time, as far as the latest ones tell."""
        self._check_pace(there)
        if self.events or not self._stride:
            return 0
        return min(self._pace, int(min(abs(there - self.time) / self._stride / 2, 2.0**40)))

    def _check_pace(self, there: float) -> None:
        """Make sure that a time can be reached, once there were steps enough to tell their pace.

        Raises
        ------
        ArithmeticError
            At the pace of late it would take more steps than anybody waits for.
        """
        taken, left = self.n - self._begun[0], abs(there - self.time)
        gone = abs(self.time - self._begun[1])
        if taken < _PATIENCE:
            return
        if gone * _LIFETIME < left * taken:
            raise ArithmeticError(
                f"in {taken:,} steps the time has gone on by {gone:.3g}, and {left:.3g} are left: dt/ds is too "
                "small for this motion; scale the time by another g, or take steps of one size"
            )
        self._begun = self.n, self.time  # a motion may fall to where the time stands nearly still

    def _watched(self, steps: int, there: float) -> None:
        """Take steps one by one until the time has come or an event may have happened."""
        buffers, first, start = self.buffers, self.n, self.state
        safe, before = (
            (buffers.y.copy(), buffers.e.copy()),
            (np.empty_like(buffers.y), np.empty_like(buffers.e)),
        )
        self.kept[-1] = there
        done = np.array([first], dtype=np.int64)
        memory = (buffers.y, buffers.e, buffers.c, *before, self.kept, done)
        self.code.call(buffers.loop.code.address, *(m.ctypes.data for m in memory), first, steps)
        self.n = int(done[0])
        self._count(start, buffers.beyond(), self.n - first)
        if not buffers.finite():
            raise buffers.lost(*safe, first, self.n - first, self.frame.system.rows)
        self._read()
        self.before = StepEnd(
            self.n - 1, LoopState.in_copy(buffers, *before), tuple(self.locator.sides), self._met
        )
        self.segments = [Segment(Fraction(0), self.before.state)]
        if self.events:
            self._pass_events()
        self._check_time(start, self.n - first)

    def _pass_events(self) -> None:
        """Meet the events of the latest step."""
        end = self.state
        new, part, known = self.locator.locate(self.n - 1, self.before.state, end)
        self.segments = [Segment(*leg) for leg in self.locator.segments]
        if not known:
            self.stopped = True
            self.segments.append(Segment(part, new))
            self._stand(new)
            return
        if new is not end:
            self._stand(new)
        self.kept[1:-1] = np.ravel(known)

    def _check_time(self, start: LoopState, steps: int) -> None:
        """Make sure that the time goes on: not back in a step, nor by nothing in very many."""
        clock = self.frame.clock
        now, before, first = (time_of(s, clock) for s in (self.state, self.before.state, start))
        self._stride = abs(float(now - first)) / steps
        self._still = 0 if now != first else self._still + steps
        if self.forward * (now - before) < 0 or self._still >= _SLICE:
            raise ArithmeticError(
                f"the time stops or turns back after t = {float(before):.9g}: dt/ds is to be positive along the motion"
            )

    def _count(self, start: LoopState, beyond: object, steps: int) -> None:
        """Count steps, of implicit methods iterations."""
        self.work += iterations(start.beyond, beyond) if self.steps.loop.implicit else steps

    # times ----------------------------------------------------------------------------------------------

    def _has_come(self, there: float) -> bool:
        return self.forward * (self.time - there) >= 0

    def _there(self, goal: Fraction) -> float:
        return float(goal - self.forward * abs(goal) * self.fine)

    @property
    def fine(self) -> Fraction:
        """To what part of itself a time is met, where that can be."""
        number, compensated = self.steps.loop.number, self.steps.loop.compensated
        wide = compensated or number.mantissa > self.bits
        return Fraction(1, 2 ** (self.bits + 3 if wide else self.bits - 1))

    def state_at(self, goal: Fraction) -> StateAtTime:
        """Return the state at a time that the latest step has reached, by a part of that step.

        Raises
        ------
        ArithmeticError
            No part of the step ends there.
        """
        ends = self.segments if self.stopped else [*self.segments, Segment(Fraction(1), self.state)]
        found = state_at_time(self.frame, self.steps, ends, goal, self.fine, Fraction(4, 2**self.bits))
        self.work += found.work
        return found
