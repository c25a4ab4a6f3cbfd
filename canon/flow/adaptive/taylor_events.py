"""Event location for the Taylor method: events as heyoka's own, and the crossings that it reports."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.adaptive.state_unit import is_finite
from canon.flow.kinked.place import Place
from canon.flow.run.event import Crossing
from canon.flow.run.non_finite_state import NonFiniteStateError, PiledUpError, time_and_state
from canon.flow.run.observables_along import values_in
from canon.kernel.heyoka_bridge import heyoka_functions
from canon.kernel.llvm.number_types import DOUBLE, DOUBLE_DOUBLE, EXTENDED

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.array import Array
    from canon.flow.run.event import PreparedEvent
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["TaylorEvents"]

_ONE = Fraction(1)

_ROUNDING = 2.0**-9
"""What part of the motion on leaving a zero rounding may make up."""

_SEEN = 2.0**-20
"""In parts of its largest value, where a function's sign at a sample is known for certain."""

_OFF = 2.0**-44
"""In parts of its size, where it is known for certain that a function has left zero."""

_SAME_TIME = 2.0**-44
"""Times this near to one another, as a part of the time and a slice's length, are those of one zero."""


class TaylorEvents:
    """Events of one orbit as heyoka's, and the crossings it tells of.

    Parameters
    ----------
    system, events
        The equations and what to look for.
    precision, number
        The precision's keyword and what makes its numbers.
    forward
        1 where time runs forward, −1 where it runs back.
    unit
        What the integrator's numbers are parts of.
    earlier
        Crossings of the run that this one goes on from.

    Raises
    ------
    ValueError
        An event changes the state in a precision in which that is not done.
    """

    def __init__(
        self,
        system: HamiltonEquations,
        events: Sequence[PreparedEvent],
        precision: str | int,
        number: Callable[[Fraction], Any],
        *,
        forward: int,
        unit: Fraction = _ONE,
        earlier: Sequence[Crossing] = (),
    ) -> None:
        self.earlier = earlier
        self.unit, self.size = unit, number(unit)
        self.system, self.events, self.number, self.forward = system, events, number, forward
        self.recorded = [event for event in events if event.event.action == "record"]
        self.terminal = [event for event in events if event.event.action != "record"]
        self.crossings: list[Crossing] = []
        self.new_state: Any = None
        self.wide = {"double": EXTENDED if EXTENDED.available() else DOUBLE}.get(
            str(precision), DOUBLE_DOUBLE
        )
        if precision not in ("double", "extended") and any(event.jump for event in events):
            raise ValueError(
                f"precision={precision!r}: the state is changed at events in 'double' and 'extended' only"
            )

    def heyoka_events(self) -> dict[str, list[Any]]:
        """Return what heyoka's integrator takes."""
        import heyoka as hy

        if not self.events:
            return {}
        kinds = {0: hy.event_direction.any, 1: hy.event_direction.positive, -1: hy.event_direction.negative}

        def of(event: PreparedEvent, make: Any, callback: Any) -> Any:
            direction = kinds[event.event.direction * self.forward]
            (function,) = heyoka_functions(self.system, [event.value], self.number, self.unit)
            kind = type(self.number(Fraction(0)))
            return make(function, direction=direction, fp_type=kind, callback=callback)

        return {
            "nt_events": [of(e, hy.nt_event, self._recorder(e)) for e in self.recorded],
            "t_events": [of(e, hy.t_event, self._stopper(e)) for e in self.terminal],
        }

    def event_of(self, outcome: Any) -> PreparedEvent | None:
        """Return the event at which the motion stands, if its outcome is one."""
        place = -outcome.value - 1
        return self.terminal[place] if 0 <= place < len(self.terminal) else None

    def at_zero(self, t: float, high: Array, low: Array) -> bool:
        """Return whether the motion starts where some event's function is exactly zero."""
        return any(self._value(event, t, high[:, 0], low[:, 0]) == 0 for event in self.events)

    def is_off(self, begin: tuple[float, Any], here: tuple[float, Any]) -> bool:
        """Return whether every event that was zero at a time and state has left zero for certain at others."""
        return not any(
            self._value(event, begin[0], *self._parts(begin[1])) == 0
            and abs(self._value(event, here[0], *self._parts(here[1])))
            <= _OFF * self._place(*here).size(self.system, event.value)
            for event in self.events
        )

    def has_passed(self, begin: tuple[float, Any], here: tuple[float, Any]) -> bool:
        """Return whether an event has been passed from a time and state to others."""
        before, now = (
            [self._value(event, t, *self._parts(state)) for event in self.events]
            for t, state in (begin, here)
        )
        return any(a * b < 0 for a, b in zip(before, now, strict=True))

    def passed_at(self, t: Any, state: Any, span: Any) -> PreparedEvent | None:
        """Meet an event that ends or changes the motion and was passed unseen where a slice ended; None without one.

        heyoka looks for zeros before the end of a step, and rounding may have the next begin beyond this one.
        """
        now, parts = float(t), self._parts(state)
        near = (abs(now) + abs(float(span))) * _SAME_TIME
        for event in self.terminal:
            value, rate = (self._value(event, now, *parts, rate=rate) for rate in (False, True))
            way = self.forward * rate
            told = any(
                met.event is event.event and abs(met.t - now) <= 2 * near
                for met in (*self.earlier, *self.crossings)
            )
            if told or not abs(value) < abs(rate) * near or value * way < 0:
                continue
            if event.event.counts(way > 0):
                self.new_state = None if event.jump is None else self._changed(event.jump, now, state)
                self._record(event, now, state, 1 if rate > 0 else -1, self.new_state)
                return event
        return None

    def check_domain(self, t: Array, y: Array) -> None:
        """Make sure that every event's function is finite along samples y of shape (2n, times), and was seen to vanish.

        heyoka looks for no zeros in a step in which a function is not finite.

        Raises
        ------
        NonFiniteStateError
            One is not: the motion has left its domain, and zeros may have been missed; or one was.
        """
        values = dict(zip(self.system.inputs, (*y, t), strict=True))
        with np.errstate(all="ignore"):
            found = self.system.graph.evaluate([event.value for event in self.events], values)
        for event, value in zip(self.events, found, strict=True):
            lost = ~np.isfinite(np.broadcast_to(value, t.shape))
            if lost.any():
                first = int(np.argmax(lost))
                state = y[self.system.rows, first]
                raise NonFiniteStateError(
                    f"the function of {event.event} is not finite at {time_and_state(float(t[first]), state)}: it left "
                    "its own domain there, and its zeros may have been missed",
                    float(t[first]),
                    state,
                )
            self._check_seen(event, t, y, np.broadcast_to(value, t.shape))

    def _check_seen(self, event: PreparedEvent, t: Array, y: Array, value: Array) -> None:
        """Make sure that an event was told between samples at which its function has other signs.

        heyoka's search for the roots of a step's polynomial gives up at multiple ones, as those of x³.

        Raises
        ------
        NonFiniteStateError
            It was not.
        """
        known = np.flatnonzero(abs(value) > _SEEN * abs(value).max())
        rising = value[known] > 0
        for at in np.flatnonzero(rising[1:] != rising[:-1]):
            before, after = known[at], known[at + 1]
            near = abs(t[after] - t[before]) * _SEEN
            begin, end = sorted((t[before], t[after]))
            there = [met for met in self.crossings if begin - near <= met.t <= end + near]
            told = any(met.event is event.event or met.after is not None for met in there)
            if (
                event.event.counts(bool(rising[at + 1]))
                and not told
                and self._leads_over(event, t, y, before, after)
            ):
                state = y[self.system.rows, before]
                raise NonFiniteStateError(
                    f"{event.event} was passed unseen between {time_and_state(float(t[before]), state)} and t = "
                    f"{t[after]:.9g}: its function has a kink near its zero, or vanishes with its rate. Give one that "
                    "has a rate there, such as x in place of x**3, or take DOP853() or a method of fixed steps",
                    float(t[before]),
                    state,
                )

    def _leads_over(self, event: PreparedEvent, t: Array, y: Array, before: int, after: int) -> bool:
        """Tell whether a function moves from its sign at one sample to that at another, and does not jump there.

        As tan θ at its pole and atan2 at π do.
        """
        chosen = [before, after]
        point = dict(zip(self.system.inputs, (*y[:, chosen], t[chosen]), strict=True))
        value, rate = self.system.graph.evaluate([event.value, event.rate], point)
        way = self.forward * np.broadcast_to(rate, 2) * np.sign(np.broadcast_to(value, 2)[1])
        return bool((way > 0).any())

    def crossed(
        self, handled: Sequence[PreparedEvent], t: Any, part: float, before: Any, after: Any
    ) -> PreparedEvent | None:
        """Meet the first of the other events whose function changes its sign from one state to the next, if any.

        Rounding may have put the first state a little beyond the zero already. ``after`` is the state at t + part.
        """
        near, later = abs(part) * _ROUNDING, float(t) + part
        for event in self.events:
            if self._told(event, float(t), near) or any(event is other for other in handled):
                continue
            old = self._value(event, float(t), *self._parts(before))
            new = self._value(event, later, *self._parts(after))
            passed = old * new < 0 or (new != 0 and abs(old) < abs(new) * _ROUNDING)
            if passed and event.event.counts(new > 0):
                changed = None if event.jump is None else self._changed(event.jump, float(t), before)
                self.new_state = before if changed is None else changed
                self._record(event, float(t), before, self.forward if new > 0 else -self.forward, changed)
                return event
        return None

    def _told(self, event: PreparedEvent, t: float, near: float) -> bool:
        """Return whether one of the latest crossings is this event's at nearly the same time."""
        return any(met.event is event.event and abs(met.t - t) <= near for met in self.crossings[-9:])

    def check_left(self, event: PreparedEvent, changed: Any, t: Any, after: Any, later: Any) -> None:
        """Make sure that a motion, changed at t, has left an event's zero later to the side to which it was sent.

        A change that takes the function itself away from zero leaves nothing to look for.

        Raises
        ------
        NonFiniteStateError
            It is back already: events pile up.
        """
        if event.switches:
            return
        now = self._value(event, float(later), *self._parts(after))
        begun = self._value(event, float(t), *self._parts(changed)) if event.resets else 0.0
        if abs(begun) > abs(now - begun):
            return
        sent = self._value(event, float(t), *self._parts(changed), rate=True) * self.forward
        if now * sent <= 0:
            y = (changed * self.size).astype(np.float64)[self.system.rows]
            raise PiledUpError(
                f"{event.event} is met again at once at {time_and_state(float(t), y)}: events pile up there; stop the "
                "motion before",
                float(t),
                y,
            )

    def settle(self, t: Any, state: Any, span: Any, met: int) -> None:
        """Count the zeros on which a slice begins once each.

        A step that ends on a zero has it in neither or in both of the slices that meet there, as rounding will.

        Parameters
        ----------
        t, state, span
            Where the slice began, and its length.
        met
            How many crossings were known before it.
        """
        begun, near = float(t), (abs(float(t)) + abs(float(span))) * _SAME_TIME
        parts = self._parts(state)
        for event in self.recorded:
            rate = self._value(event, begun, *parts, rate=True)
            if not abs(self._value(event, begun, *parts)) < abs(rate) * near:
                continue
            rising = rate * self.forward > 0
            known = [c for c in (*self.earlier, *self.crossings) if abs(c.t - begun) <= 2 * near]
            same = [c for c in known if c.event is event.event and c.rising == rising]
            self.crossings[met:] = [
                c for c in self.crossings[met:] if not any(c is other for other in same[1:])
            ]
            if not known and event.event.counts(rising):
                self._record(event, begun, state, 1 if rate > 0 else -1, None)
                self.crossings[met:] = [self.crossings[-1], *self.crossings[met:-1]]

    def settle_ends(self, begin: tuple[Any, Any] | None, end: tuple[Any, Any] | None, span: float) -> None:
        """Count zeros at the ends of a motion as passed where the function's sign says so.

        So has one the run that goes on from another's last state, or that other, and not both.

        Parameters
        ----------
        begin, end
            Times and states, where the motion begins at one of its own and ends at its last time.
        span
            Its length.
        """
        for place, at_end in ((begin, False), (end, True)):
            if place is None:
                continue
            t, near = float(place[0]), (abs(float(place[0])) + abs(span)) * _SAME_TIME
            for event in self.recorded:
                self._settle_end(event, t, place[1], near, at_end=at_end)

    def _settle_end(self, event: PreparedEvent, t: float, state: Any, near: float, *, at_end: bool) -> None:
        parts = self._parts(state)
        value, rate = (self._value(event, t, *parts, rate=rate) for rate in (False, True))
        if not abs(value) < abs(rate) * near:
            return
        rising, beyond = rate * self.forward > 0, value * rate * self.forward
        same = [c for c in self.crossings if c.event is event.event and c.rising == rising]
        here = [c for c in same if abs(c.t - t) <= 2 * near]
        # At the end it has been passed where the sign has changed, at the beginning it is still to be passed.
        if not (beyond > 0 if at_end else beyond < 0):
            self.crossings = [c for c in self.crossings if not any(c is each for each in here)]
        elif not here and event.event.counts(rising):
            self._record(event, t, state, 1 if rate > 0 else -1, None)
            self.crossings.insert(len(self.crossings) if at_end else 0, self.crossings.pop())

    def _value(self, event: PreparedEvent, t: float, high: Array, low: Array, *, rate: bool = False) -> float:
        node = event.rate if rate else event.value
        found = values_in(self.wide, self.system, [node], t, high[:, np.newaxis], low[:, np.newaxis])
        return float(found[0, 0].sum())

    def _recorder(self, event: PreparedEvent) -> Callable[[Any, Any, int], None]:
        def recorded(integrator: Any, t: Any, sign: int) -> None:
            integrator.update_d_output(t)
            self._record(event, float(t), integrator.d_output, sign, None)

        return recorded

    def _stopper(self, event: PreparedEvent) -> Callable[[Any, int], bool]:
        def met(integrator: Any, sign: int) -> bool:
            t, state = float(integrator.time), integrator.state.copy()
            after = None if event.jump is None else self._changed(event.jump, t, state)
            self.new_state = after
            self._record(event, t, state, sign, after)
            return False

        return met

    def _changed(self, jump: tuple[int, ...], t: float, state: Any) -> Any:
        high, low = self._parts(state)
        found = values_in(self.wide, self.system, jump, t, high[:, np.newaxis], low[:, np.newaxis])[:, 0]
        if not is_finite(found):
            y = high[self.system.rows]
            raise NonFiniteStateError(
                f"the new state of an event is not finite at {time_and_state(t, y)}", t, y
            )
        exact = [sum((Fraction(*x.as_integer_ratio()) for x in parts), Fraction(0)) for parts in found]
        return np.array([self.number(x / self.unit) for x in exact])

    def _record(self, event: PreparedEvent, t: float, state: Any, sign: int, after: Any) -> None:
        rows = self.system.rows
        moved = None if after is None else (after * self.size).astype(np.float64)[rows]
        y = (state * self.size).astype(np.float64)[rows]
        self.crossings.append(Crossing(event.event, t, y, sign * self.forward > 0, moved))

    def _place(self, t: float, state: Any) -> Place:
        return Place(self.wide, t, *self._parts(state))

    def _parts(self, state: Any) -> tuple[Array, Array]:
        whole = state * self.size
        high = whole.astype(np.float64)
        return high, (whole - high).astype(np.float64)
