"""Event location for fixed-step methods: noticed between steps, located by partial steps of the same method."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.fixed_step.partial_step import LoopState, PartialSteps
from canon.flow.run.event import Crossing
from canon.flow.run.non_finite_state import NonFiniteStateError, PiledUpError, time_and_state
from canon.flow.run.observables_along import values_in
from canon.kernel.loops.event_loop import event_function
from canon.kernel.loops.statistics_loop import wide_number

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from canon.flow.run.event import Event, PreparedEvent
    from canon.kernel.llvm.loop import Loop
    from canon.kernel.llvm.machine_code import MachineCode
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["EventLocator", "compiled_watch"]

_IN_ONE_STEP = 100
"""More events in one step than this pile up towards an instant."""

_AT_ONCE = Fraction(1, 2**30)
"""Nor does one that changes the state come again after so small a part of a step unless it does."""

_AWAY = 2.0**-10
"""In parts of its way in a step: a function that a change of the state has taken farther from zero is on that side."""

_JUMP = 0.25
"""A function that is larger, in parts of its size beside it, where it changes its sign, jumps there or has a pole."""

_TRIES = 200


def compiled_watch(
    system: HamiltonEquations, events: Sequence[PreparedEvent], loop: Loop, timed: int | None = None
) -> MachineCode:
    """Return the code that steps until an event may have happened, or a time has come, kept from an earlier call.

    Parameters
    ----------
    system, events, loop, timed
        As :func:`canon.kernel.loops.event_loop.event_function` takes them.
    """
    values, rates = tuple(e.value for e in events), tuple(e.rate for e in events)
    return _kept_watch(system, values, rates, loop, timed)


_kept_watch = functools.lru_cache(maxsize=64)(event_function)


@dataclass(frozen=True)
class _RestOfStep:
    """What is left of step n + 1: the state at its beginning and at its end, were it not for the events.

    Of each event ``latest`` has the place of its latest crossing, or the beginning, with dg/dt there; ``at_begin`` has
    g at the beginning, ``at_end`` g and dg/dt at the end.
    """

    n: int
    begin: Fraction
    base: LoopState
    end: LoopState
    latest: list[tuple[Fraction, float]]
    at_begin: list[float]
    at_end: list[tuple[float, float]]


class EventLocator:
    """What is known of events while a motion goes on.

    Parameters
    ----------
    system
        The equations.
    steps
        Steps of the method between the run's own.
    events
        What to look for.
    """

    def __init__(
        self, system: HamiltonEquations, steps: PartialSteps, events: Sequence[PreparedEvent]
    ) -> None:
        self.system, self.steps, self.events = system, steps, events
        self.forward = 1 if steps.h > 0 else -1
        self.wide = wide_number(steps.loop.number)
        self.bits = steps.loop.number.mantissa + 4
        self.crossings: list[Crossing] = []
        self.sides: list[int] = []
        self.segments: list[tuple[Fraction, LoopState]] = []
        """Where the latest step that was gone through began, and where in it events changed the state."""

    def values_and_rates(self, state: LoopState, t: Fraction) -> list[tuple[float, float]]:
        """Return each event's g and dg/dt, positive where g rises in the order of passing."""
        nodes = [node for event in self.events for node in (event.value, event.rate)]
        found = values_in(self.wide, self.system, nodes, float(t), state.high, state.low)[:, 0]
        numbers = [float(x.sum()) for x in found]
        if not all(map(math.isfinite, numbers)):
            y = state.high[self.system.rows, 0]
            raise NonFiniteStateError(
                f"an event's function is not finite at {time_and_state(float(t), y)}: it left its own domain there",
                float(t),
                y,
            )
        return [(g, self.forward * rate) for g, rate in zip(numbers[::2], numbers[1::2], strict=True)]

    def start(
        self, state: LoopState, t: Fraction, waiting: Collection[Event] = ()
    ) -> list[tuple[int, float, float]]:
        """Note on which side of zero each g is and return that with dg/dt and g, for the compiled loop.

        Parameters
        ----------
        state, t
            Where the motion is.
        waiting
            Events that it has come to, where it goes on from there: those on their zero are yet to be met.
        """
        looks = self.values_and_rates(state, t)
        self.sides = [
            _sign(g) or (-_sign(rate) if each.event in waiting else _sign(rate))
            for each, (g, rate) in zip(self.events, looks, strict=True)
        ]
        return self.known(looks)

    def known(self, looks: Sequence[tuple[float, float]]) -> list[tuple[int, float, float]]:
        """Return what the compiled loop is to know of each event."""
        return [(side, rate, g) for side, (g, rate) in zip(self.sides, looks, strict=True)]

    def locate(
        self, n: int, before: LoopState, after: LoopState
    ) -> tuple[LoopState, Fraction, list[tuple[int, float, float]]]:
        """Meet the events of step n + 1 in their order.

        Parameters
        ----------
        n
            Steps taken before it.
        before, after
            The states at its two ends, were it not for the events.

        Returns
        -------
        tuple
            The state where the motion goes on, or where it stopped; which part of the step that is, 1 where
            all of it was passed; what the compiled loop is to know, empty where the motion stopped.
        """
        self.segments = []
        rest = self._rest_of_step(n, Fraction(0), before, after)
        self.sides = [side or _sign(g) for side, (g, _) in zip(self.sides, rest.at_end, strict=True)]
        changed = dict[int, Fraction]()
        for _ in range(_IN_ONE_STEP):
            place, i = self._earliest(rest)
            if place > 1:
                return rest.end, Fraction(1), self.known(rest.at_end)
            here, t = self.steps.moved(rest.base, n, rest.begin, place), self.steps.time(n, place)
            rising, event = self.sides[i] < 0, self.events[i]
            self.sides[i] = -self.sides[i]
            value, rate = self.values_and_rates(here, t)[i]
            rest.latest[i] = (place, rate)
            jumps = abs(value) > _JUMP * max(abs(rest.at_begin[i]), abs(rest.at_end[i][0]))
            if jumps or not event.event.counts(rising):
                continue
            if event.jump is not None:
                if changed.get(i, Fraction(-1)) > place - _AT_ONCE:
                    break
                changed[i] = place
                rest = self._changed(rest, i, here, place, rising=rising)
                continue
            self._record(event, t, here, rising, None)
            if event.event.action == "stop":
                return here, place, []
        t, y = float(self.steps.time(n, rest.begin)), rest.base.high[self.system.rows, 0]
        again = self.crossings[-1].event if self.crossings else "an event"
        raise PiledUpError(
            f"{again} is met again at once at {time_and_state(t, y)}: events pile up there; stop the motion before",
            t,
            y,
        )

    def _rest_of_step(self, n: int, begin: Fraction, base: LoopState, end: LoopState) -> _RestOfStep:
        self.segments.append((begin, base))
        at_begin = self.values_and_rates(base, self.steps.time(n, begin))
        latest = [(begin, rate) for _, rate in at_begin]
        at_end = self.values_and_rates(end, self.steps.time(n, Fraction(1)))
        return _RestOfStep(n, begin, base, end, latest, [g for g, _ in at_begin], at_end)

    def _earliest(self, rest: _RestOfStep) -> tuple[Fraction, int]:
        """Return the place of the next crossing in a step and whose it is; the place 2 where there is none."""
        places = ((self._first(i, rest), i) for i in range(len(self.events)))
        return min(places, default=(Fraction(2), 0))

    def _changed(
        self, rest: _RestOfStep, i: int, here: LoopState, place: Fraction, *, rising: bool
    ) -> _RestOfStep:
        """Change the state by an event and return what is left of the step after it."""
        t = self.steps.time(rest.n, place)
        base = self._jumped(self.events[i], here, t)
        self._record(self.events[i], t, here, rising, base)
        following = self._rest_of_step(
            rest.n, place, base, self.steps.moved(base, rest.n, place, Fraction(1))
        )
        self._renew_sides(self.values_and_rates(here, t), following)
        self.sides[i] = _sign(following.latest[i][1]) or -self.sides[i]
        if self.events[i].switches or self.events[i].resets:
            value, rate = self.values_and_rates(base, t)[i]
            way = abs(rate * float(self.steps.h)) + abs(following.at_end[i][0] - value)
            if self.events[i].switches or abs(value) > _AWAY * way > 0:
                self.sides[i] = _sign(value) or self.sides[i]
        return following

    def _renew_sides(self, before: Sequence[tuple[float, float]], after: _RestOfStep) -> None:
        """Note the sides of those functions that a change of the state has moved; by a jump none of them crosses."""
        for i, ((g, _), moved) in enumerate(zip(before, after.at_begin, strict=True)):
            if moved != g:
                self.sides[i] = _sign(moved) or _sign(after.latest[i][1])

    def _record(
        self, event: PreparedEvent, t: Fraction, here: LoopState, rising: bool, after: LoopState | None
    ) -> None:
        rows = self.system.rows
        moved = None if after is None else after.high[rows, 0]
        self.crossings.append(Crossing(event.event, float(t), here.high[rows, 0], rising, moved))

    def _jumped(self, event: PreparedEvent, here: LoopState, t: Fraction) -> LoopState:
        assert event.jump is not None
        found = values_in(self.wide, self.system, event.jump, float(t), here.high, here.low)
        high = found[..., 0].astype(np.float64)
        low = ((found[..., 0] - high) + found[..., 1:].sum(axis=-1)).astype(np.float64)
        if not np.isfinite(high).all():
            y = here.high[self.system.rows, 0]
            raise NonFiniteStateError(
                f"the new state of {event.event} is not finite at {time_and_state(float(t), y)}", float(t), y
            )
        return LoopState(high, low, here.beyond)

    def _first(self, i: int, rest: _RestOfStep) -> Fraction:
        """Return the first part of a step at which g crosses zero after its latest crossing, or 2."""
        side, (place, came), (g, goes) = self.sides[i], rest.latest[i], rest.at_end[i]

        def ahead(part: Fraction) -> tuple[float, float]:
            """Return g and dg/d(part), taken with the side's sign: positive until the crossing."""
            state = self.steps.moved(rest.base, rest.n, rest.begin, part)
            value, rate = self.values_and_rates(state, self.steps.time(rest.n, part))[i]
            return side * value, side * rate * abs(float(self.steps.h))

        last = Fraction(1)
        if side * g >= 0:
            if not (side * came < 0 < side * goes):
                return Fraction(2)
            dip = _dip(ahead, (place, side * came), (last, side * goes), self.bits // 2)
            if dip is None:
                return Fraction(2)
            last = dip
        return _root(ahead, place, last, self.bits)


def _dip(
    f: Callable[[Fraction], tuple[float, float]],
    falling: tuple[Fraction, float],
    rising: tuple[Fraction, float],
    bits: int,
) -> Fraction | None:
    """Return a place where f, which falls at one place and rises at a later one, is negative, or None.

    Its least value is approached by false positions of the slope (Illinois) until f is negative or the place known.
    """
    (low, down), (high, up) = falling, rising
    for _ in range(_TRIES):
        part = down / (down - up) if down != up else 0.5
        x = low + (high - low) * Fraction(round(min(max(part, 0.01), 0.99) * 2**20), 2**20)
        value, slope = f(x)
        if value < 0:
            return x
        if slope == 0 or high - low <= Fraction(1, 2**bits):
            return None
        if slope < 0:
            low, down, up = x, slope, up / 2
        else:
            high, up, down = x, slope, down / 2
        if value + min(slope, -abs(slope)) * float(high - low) > 0:  # too far from zero to reach it
            return None
    return None


def _root(f: Callable[[Fraction], tuple[float, float]], low: Fraction, high: Fraction, bits: int) -> Fraction:
    """Return where f, positive at ``low``, becomes negative before ``high``: Newton's method kept in a bracket.

    f returns its value and its slope.
    """
    smallest, near = Fraction(1, 2**bits), Fraction(1, 2 ** (bits // 2))
    x, moved = (low + high) / 2, high - low
    for _ in range(_TRIES):
        value, slope = f(x)
        if value == 0:
            return x
        low, high = (x, high) if value > 0 else (low, x)
        new = x - Fraction(value) / Fraction(slope) if slope else (low + high) / 2
        if not low <= new <= high:
            new = (low + high) / 2
        new = Fraction(round(new * 2**bits), 2**bits)
        before, moved = moved, abs(new - x)
        # Near the end steps shrink to those that round-off makes.
        if moved <= 2 * smallest or high - low <= smallest or before / 4 <= moved <= near:
            return min(max(new, low), high)
        x = new
    return x


def _sign(x: float) -> int:
    return (x > 0) - (x < 0)
