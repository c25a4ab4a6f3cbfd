"""Taylor integration of one orbit: from sample to sample, through events, up to a singularity."""

from __future__ import annotations

import copy
import functools
import time
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.adaptive.first_step import first_step
from canon.flow.adaptive.held_steps import HeldSteps, LocalisedTerms, finer
from canon.flow.adaptive.spare_integrators import spare_integrators
from canon.flow.adaptive.state_unit import is_finite
from canon.flow.adaptive.tested_steps import TestedSteps
from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state
from canon.kernel.heyoka_bridge import taylor_integrator
from canon.kernel.program.series_gaps import may_have_gaps

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from canon.array import Array
    from canon.flow.adaptive.taylor_events import TaylorEvents
    from canon.flow.method.method import Taylor
    from canon.flow.run.event import PreparedEvent
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["Slice", "TaylorOrbit", "numbers_of", "orbits_of"]

_MANY_STEPS, _CREEPING = 50_000, 1e-10
"""Where so many steps pass less than this part of what is left, they shrink towards a singularity."""

_MANY_WIDE_STEPS = 1_000
"""In numbers wider than the machine's, which take a millisecond a step and are never too large to be finite."""

_ONE = Fraction(1)

_OF_ONE_STEP = (
    ". Where the motion is fast in its unit of time, its derivatives of high order are beyond 1e308: take units of "
    "time and length in which they are not, or a method of fixed steps"
)
"""Said where the step from a finite state fails."""

_SYSTEMS = 64
"""Systems of which it is known how to step them."""

_SMALL_PART = 2.0**-30
"""What part of a step is passed without events after one that changed the state."""

_LARGE_PART = 2.0**-6
"""Less than this is passed from a start at which an event's function vanishes with its rate."""


@dataclass(frozen=True)
class Slice:
    """States reached, shape (times, 2n), and what they cost; ``outcome`` where the motion can't go on."""

    rows: Any
    steps: int
    seconds: float
    outcome: Any
    stopped: bool


@dataclass(eq=False)
class TaylorOrbit:
    """One orbit on its way: heyoka's integrator, and one without events to leave their zeros with.

    ``held`` keeps the steps from passing over localised terms; ``tested`` says that series may have gaps, so that every
    step is tested; ``new`` tells that the next step is the first from a state that was given; ``passed`` is an event to
    meet before the next step.
    """

    integrator: Any
    taylor_events: TaylorEvents
    free: Any
    span: Any
    held: HeldSteps
    longest: Any = None
    tested: bool = False
    new: bool = True
    passed: PreparedEvent | None = None
    pieces: list[Any] = field(default_factory=list[Any])
    safe: tuple[Any, Any] = (None, None)

    @property
    def beyond(self) -> tuple[Any, Any]:
        """The state in its own size and the clock: what the motion goes on from with the same bits."""
        return self.integrator.state * self.taylor_events.size, self.integrator.dtime

    def go_on_from(self, beyond: tuple[Any, Any]) -> None:
        """Go on from where another orbit has ended."""
        state, self.integrator.dtime = beyond
        self.integrator.state[:] = state / self.taylor_events.size  # a longer span may have another unit
        self.new = False

    def advance(self, grid: Any, *, dense: bool) -> Slice:
        """Go from the first time of a grid to its last and return the states at all but the first.

        Where the way leads far from a localised term, it is gone once more with steps that are held to it.
        """
        terms = self.held.terms
        if not self.held.waits:
            if terms.exponents:
                constant = [self.integrator.state] * len(grid)
                terms.hold(self.integrator, terms.largest(constant, list(grid)))
            return self._along(list(grid), dense=dense)
        own, new, pieces = self.integrator, self.new, len(self.pieces)
        start, clock = own.state.copy(), own.dtime
        times, parts = finer(list(grid))
        made = self._along(times, dense=dense)
        largest = terms.largest([start, *made.rows], times[: len(made.rows) + 1])
        if made.outcome is None and terms.near(largest):
            return replace(made, rows=made.rows[parts - 1 :: parts])
        del self.pieces[pieces:]
        self.new, self.integrator = new, self.held.integrator(largest)
        self.integrator.state[:], self.integrator.dtime = start, clock
        again = self._along(list(grid), dense=dense)
        own.state[:], own.dtime = self.integrator.state, self.integrator.dtime
        if again.outcome is None:
            self.integrator = own
        return replace(again, seconds=made.seconds + again.seconds)

    def _along(self, grid: list[Any], *, dense: bool) -> Slice:
        started, rows, steps, left = time.thread_time(), list[Any](), 0, grid[1:]
        failure, stopped = None, False
        while left:
            event, self.passed = self.passed, None
            if event is None:
                steps_taken, found, outcome = self._towards(self.integrator, left, dense=dense)
                steps += steps_taken
                rows += found
                left = left[len(found) :]
                event = self.taylor_events.event_of(outcome)
                if event is None:
                    failure = outcome
                    break
            handled = [event] if event.jump is None else self._at_the_same_time(event)
            if handled[-1].event.action == "stop":
                rows.append(self.integrator.state.copy())
                stopped = True
                break
            steps_taken, found = self.leave(left, handled, dense=dense)
            steps += steps_taken
            rows += found
            left = left[len(found) :]
        made = np.array(rows).reshape(len(rows), len(self.integrator.state))
        if not left and not is_finite(made):
            failure = "the state is not finite"
        if stopped or (not left and not isinstance(failure, str)):
            failure = None
        return Slice(made, steps, time.thread_time() - started, failure, stopped)

    def _at_the_same_time(self, event: PreparedEvent) -> list[PreparedEvent]:
        """Change the state as an event does, then as every other does that would be met on leaving its zero.

        heyoka tells of one event that changes the state; another at the same instant, as in a corner between two
        walls, would be passed unseen.
        """
        own, handled = self.integrator, [event]
        own.state[:] = self.taylor_events.new_state
        while True:
            before, clock = own.state.copy(), own.dtime
            self.free.state[:], self.free.dtime = before, clock
            _, natural = self.free.step(self.span)
            self.free.state[:], self.free.dtime = before, clock
            part = natural * type(natural)(_SMALL_PART)
            self.free.propagate_until(own.time + part)
            found = self.taylor_events.crossed(handled, own.time, float(part), before, self.free.state)
            if found is None:
                return handled
            handled.append(found)
            own.state[:] = self.taylor_events.new_state
            if found.event.action == "stop":
                return handled

    def leave_start(self, sample: Any, *, dense: bool) -> None:
        """Move off the zero of an event at which the motion starts, which it may only touch there.

        No farther than half way to the first sample, and not past another event.
        """
        free, own = self.free, self.integrator
        before, clock, begin = own.state.copy(), own.dtime, float(own.time)
        free.state[:], free.dtime = before, clock
        _, natural = free.step(self.span)
        kind, part = type(natural), _SMALL_PART
        most = min(_LARGE_PART, float(abs((sample - own.time) / natural)) / 2)
        while part < most:
            free.state[:], free.dtime = before, clock
            free.propagate_until(own.time + natural * kind(part))
            here = float(free.time), free.state
            if self.taylor_events.has_passed((begin, before), here):
                part /= 2
                break
            if self.taylor_events.is_off((begin, before), here):
                break
            part *= 2
        self.leave([], (), dense=dense, part=part if part < most else min(_SMALL_PART, most))

    def leave(
        self, left: list[Any], events: Sequence[PreparedEvent], *, dense: bool, part: float = _SMALL_PART
    ) -> tuple[int, list[Any]]:
        """Move off an event's zero, by a small part of a step that looks for no events.

        heyoka takes a zero at the very beginning of a step for others of the step too.
        """
        free, own = self.free, self.integrator
        free.state[:], free.dtime = own.state, own.dtime
        before, clock = own.state.copy(), own.dtime
        _, natural = free.step(self.span)
        free.state[:], free.dtime = before, clock
        end = own.time + natural * type(natural)(part)
        at_once = [before for t in left if t == own.time]
        near = [t for t in left if t != own.time and (t - end) * self.taylor_events.forward < 0]
        steps, found, _ = self._towards(free, [*near, end], dense=dense)
        for event in events:
            if event.jump is not None:
                self.taylor_events.check_left(event, before, own.time, free.state, free.time)
        own.state[:], own.dtime = free.state, free.dtime
        if self.taylor_events.terminal:
            own.reset_cooldowns()
        return steps, [*at_once, *found[: len(near)]]

    def _towards(self, integrator: Any, times: list[Any], *, dense: bool) -> tuple[int, list[Any], Any]:
        """Return steps taken, the states at the times reached, and the outcome."""
        from heyoka import taylor_outcome

        steps, rows = 0, list[Any]()
        if self.new:
            self.new = False
            end = first_step(self._without_events(), times[-1])
            if end is not None:
                before = [t for t in times if abs(t - integrator.time) <= abs(end - integrator.time)]
                ends = before if before[-1:] == [end] else [*before, end]
                taken, found, outcome = self._some_steps(integrator, ends, dense=dense)
                if len(found) < len(ends) or len(before) == len(times):
                    return taken, found[: len(before)], outcome
                steps, rows = taken, found[: len(before)]
        while True:
            self.safe = (integrator.state.copy(), integrator.dtime)
            before, left = integrator.time, times[len(rows) :]
            taken, found, outcome = self._some_steps(integrator, left, dense=dense)
            steps += taken
            rows += found
            passed, ahead = abs(integrator.time - before), abs(times[-1] - integrator.time)
            if outcome != taylor_outcome.step_limit or not passed > ahead * _CREEPING:
                return steps, rows, outcome

    def _some_steps(self, integrator: Any, times: list[Any], *, dense: bool) -> tuple[int, list[Any], Any]:
        from heyoka import taylor_outcome

        limits = {"max_steps": self._many_steps}
        if integrator.with_events:
            limits["max_delta_t"] = abs(self.span)
        if self.longest is not None:
            limits["max_delta_t"] = self.longest
        if self.tested:
            return self._tested_steps(integrator, times, limits.get("max_delta_t"), dense=dense)
        if not dense and len(times) == 1:  # keeping every step's series for times between costs a fifth
            outcome, _, _, steps, _, _ = integrator.propagate_until(times[-1], **limits)
            return steps, [integrator.state.copy()] if outcome == taylor_outcome.time_limit else [], outcome
        if not dense:
            grid = np.array([integrator.time, *times])
            outcome, _, _, steps, _, found = integrator.propagate_grid(grid, **limits)
            return steps, list(found[1:]), outcome
        outcome, _, _, steps, piece, _ = integrator.propagate_until(times[-1], c_output=True, **limits)
        if piece is None:
            return steps, [], outcome
        self.pieces.append(piece)
        first, last = sorted(piece.bounds)
        return steps, [np.array(piece(t)) for t in times if first <= t <= last], outcome

    def _tested_steps(
        self, integrator: Any, times: list[Any], longest: Any, *, dense: bool
    ) -> tuple[int, list[Any], Any]:
        from heyoka import taylor_outcome

        plain = self._without_events if integrator is self.integrator else lambda: integrator
        tested = TestedSteps(integrator, plain, self.taylor_events.crossings, longest)
        outcome = tested.towards(times[-1], self._many_steps)
        self.safe = tested.safe
        if dense:
            self.pieces += tested.pieces
        if outcome == taylor_outcome.time_limit:
            return tested.steps, [*tested.states_at(times[:-1]), integrator.state.copy()], outcome
        return tested.steps, tested.states_at(times), outcome

    @property
    def _many_steps(self) -> int:
        return _MANY_STEPS if self.integrator.state.dtype in (np.float64, np.longdouble) else _MANY_WIDE_STEPS

    def _without_events(self) -> Any:
        if self.free is None:
            return self.integrator
        self.free.state[:], self.free.dtime = self.integrator.state, self.integrator.dtime
        return self.free

    def lost(self, outcome: object, rows: Sequence[int]) -> NonFiniteStateError:
        """Return the error that says where the motion ended: its last finite step is looked for again."""
        own = self.integrator
        own.state[:], own.dtime = self.safe
        t, state = own.time, own.state.copy()
        begin = t
        for _ in range(self._many_steps):
            own.step(self.span)
            if not is_finite(own.state) or own.time == t:
                break
            t, state = own.time, own.state.copy()
        y = (state * self.taylor_events.size).astype(np.float64)[list(rows)]
        return NonFiniteStateError(
            f"the motion can't be continued after {time_and_state(float(t), y)} ({outcome}): a collision or the edge "
            f"of H's domain{' or of that of an event' if self.taylor_events.events else ''}; stop earlier"
            f"{_OF_ONE_STEP if t == begin else ''}",
            float(t),
            y,
        )


def orbits_of(
    system: HamiltonEquations,
    states: tuple[Array, Array],
    t0: Fraction,
    method: Taylor,
    number: Callable[[Fraction], Any],
    taylor_events: TaylorEvents,
    span: Any,
    max_step: float | None = None,
) -> list[TaylorOrbit]:
    """Compile one integrator and copy it for the other orbits; in doubles without events a spare one will do."""
    starts = numbers_of(states, number, taylor_events.unit).T
    unit, events = taylor_events.unit, taylor_events.heyoka_events()
    terms = LocalisedTerms.of(system, number, method.tolerance, unit, taylor_events.forward)

    def exact() -> list[Fraction]:
        pairs = zip(*(part[:, 0].tolist() for part in states), strict=True)
        return [Fraction(a) + Fraction(b) for a, b in pairs]

    def made_with(beside: Mapping[str, Any]) -> Any:
        return taylor_integrator(system, exact(), t0, method.tolerance, number, beside, unit)

    @functools.cache
    def held() -> Any:
        return made_with(terms.beside({}))

    if number is float and not events:
        first = spare_integrators(system, method.tolerance, unit).take(exact, t0)
    else:
        first = made_with(terms.beside(events) if events else events)
    free = made_with({}) if events else None
    longest = None if max_step is None else number(Fraction(max_step))
    tested = _is_tested(system, first.order)
    made = list[TaylorOrbit]()
    for start in starts:
        integrator = copy.deepcopy(first) if made else first
        integrator.state[:], integrator.time = start, number(t0)
        steps = HeldSteps(terms, held, waits=not events)
        made.append(TaylorOrbit(integrator, taylor_events, free, span, steps, longest, tested))
    return made


def numbers_of(states: tuple[Array, Array], number: Callable[[Fraction], Any], unit: Fraction = _ONE) -> Any:
    """Return states, sums of two doubles, in parts of a unit, a power of two, in heyoka's numbers."""
    if number is float:  # rounded once, as exact numbers are
        return (states[0] + states[1]) / float(unit)
    pairs = zip(states[0].ravel().tolist(), states[1].ravel().tolist(), strict=True)
    exact = [number((Fraction(high) + Fraction(low)) / unit) for high, low in pairs]
    return np.array(exact).reshape(states[0].shape)


@functools.lru_cache(maxsize=_SYSTEMS)
def _is_tested(system: HamiltonEquations, order: int) -> bool:
    return may_have_gaps(system.graph, system.rates, order)
