"""Taylor integration of one orbit through kinks: each regime up to the zero that ends it, then the next one.

Every regime has an integrator of its own, compiled when the orbit first comes there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.adaptive.held_steps import spacing
from canon.flow.adaptive.regime_orbits import RegimeOrbit, RegimeOrbits
from canon.flow.adaptive.taylor_orbit import Slice
from canon.flow.kinked.next_regime import passage, signs_at_start
from canon.flow.kinked.place import Place
from canon.flow.kinked.regime_signs import HELD
from canon.flow.kinked.saltation import saltation
from canon.flow.run.event import Crossing, Event
from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.array import Array
    from canon.flow.adaptive.taylor_events import TaylorEvents
    from canon.flow.adaptive.taylor_orbit import TaylorOrbit
    from canon.flow.kinked.regime_signs import Signs
    from canon.flow.kinked.regimes import Kinks
    from canon.flow.method.method import Taylor
    from canon.flow.run.event import PreparedEvent

__all__ = ["KinkedOrbit", "kinked_orbits_of"]

_NEWTON = 4
"""Steps of Newton's method that put a state onto a zero: heyoka finds it to the rounding of its step."""

_NEAR = 2.0**-20
"""A zero is put right by a smaller part of the whole motion only."""

_LONGEST_EULER, _HALVINGS = 2.0**-10, 100
"""The step off such a zero: at first in parts of the state, and how often it is halved."""

_BEYOND = 2.0**-50
"""In parts of its size, where a function is put behind a wall at which H jumps."""

_AT_ONCE = 2.0**-44
"""In parts of the way to go: samples that are no farther from an instant are at that instant."""

_PILE = 1000
"""So many kinks within a rounding of time pile up."""

_NOT_SMOOTH = (
    "the motion comes to rest, where its force is not smooth enough to go on: stop it by an event of the speed, "
    "Event(speed, action='stop'), or end the span before"
)

_ZERO = 2.0**-40
"""In parts of a function's size: an event that vanishes at the same place as a kink."""


@dataclass(eq=False)
class KinkedOrbit:
    """One orbit on its way through kinks; as :class:`canon.flow.adaptive.taylor_orbit.TaylorOrbit` for its driver."""

    regimes: RegimeOrbits
    state: Any
    dtime: tuple[Any, Any]
    signs: Signs | None = None
    on_zero: bool = False
    put_off: bool = False
    at_kink: tuple[Any, Any] = (None, None)
    pieces: list[Any] = field(default_factory=list[Any])

    @property
    def beyond(self) -> tuple[Any, Any]:
        """The state in its own size, and the clock with the regime: what the motion goes on from with the same bits."""
        return self.state * self.regimes.taylor_events.size, (self.dtime, self.signs, self.on_zero)

    def go_on_from(self, beyond: tuple[Any, Any]) -> None:
        """Go on from where another orbit has ended."""
        self.state[:], (self.dtime, self.signs, self.on_zero) = (
            beyond[0] / self.regimes.taylor_events.size,
            beyond[1],
        )

    def advance(self, grid: Any, *, dense: bool) -> Slice:
        """Go from the first time of a grid to its last and return the states at all but the first."""
        with self.regimes.lock:
            return self._advance(list(grid), dense=dense)

    def _advance(self, grid: list[Any], *, dense: bool) -> Slice:
        rows, left, steps, seconds = list[Any](), grid[1:], 0, 0.0
        if self.signs is None:
            self.signs = signs_at_start(self.regimes.kinks, self._place(), self.regimes.taylor_events.forward)
            self.on_zero = True
        in_a_row = 0
        while left:
            began = self._now()
            own, made, found = self._within(left, dense=dense)
            steps, seconds = steps + made.steps, seconds + made.seconds
            rows += found
            left = left[len(found) :]
            if made.outcome is not None or not made.stopped:
                ended = made.outcome is None and self._passes_at_the_end(own)
                if self.put_off:
                    self._put_off(rows, grid, left)
                    self.put_off = False
                return Slice(self._rows(rows), steps, seconds, made.outcome, stopped=ended)
            in_a_row = in_a_row + 1 if self._now() == began else 0
            if in_a_row > _PILE:
                raise self._piled_up()
            short = self.state.copy(), self._now()
            self.at_kink = short
            if self._meet(own):
                rows.append(self.state.copy())
                return Slice(self._rows(rows), steps, seconds, None, stopped=True)
            if self.put_off:
                left, self.put_off = self._put_off(rows, grid, left), False
            left = self._passed_on_the_way(rows, left, short)
        return Slice(self._rows(rows), steps, seconds, None, stopped=False)

    def _passed_on_the_way(self, rows: list[Any], left: list[Any], short: tuple[Any, Any]) -> list[Any]:
        """Give samples between the end of a regime and its zero the states there; return the times that are left.

        A regime without a series at its zero ends a little before, and the way that is left is straight.
        """
        (before, begun), (after, end) = short, self.at_kink
        passed = [t for t in left if (t - self._now()) * self.regimes.taylor_events.forward < 0]
        rows += [before + (t - begun) / (end - begun) * (after - before) for t in passed]
        return left[len(passed) :]

    def _put_off(self, rows: list[Any], grid: list[Any], left: list[Any]) -> list[Any]:
        """Give the samples at this very instant the momenta after it, and return the times that are left."""
        near = abs(self._now() - self.at_kink[1]) + abs(_AT_ONCE * (grid[-1] - grid[0]))
        kept = [t for t in grid[1 : len(rows) + 1] if abs(t - self._now()) > near]
        passed = [t for t in left if (t - self._now()) * self.regimes.taylor_events.forward <= 0]
        rows[len(kept) :] = [self.state.copy() for _ in range(len(rows) - len(kept) + len(passed))]
        return left[len(passed) :]

    def _within(self, left: list[Any], *, dense: bool) -> tuple[RegimeOrbit, Slice, list[Any]]:
        """Go on in one regime; return its integrator, what was done there, and the states at the times reached."""
        assert self.signs is not None
        own, steps, found = self.regimes.of(self.signs), 0, list[Any]()
        if self.on_zero:
            own, steps, found = self._leave(left, dense=dense)
            self.on_zero, left = False, left[len(found) :]
        orbit, pieces = self._placed(own), len(own.orbit.pieces)
        orbit.new = True
        made = Slice(np.empty((0, len(self.state))), 0, 0.0, None, stopped=False)
        if left:
            made = orbit.advance([orbit.integrator.time, *left], dense=dense)
        self._take(own, pieces)
        reached = made.rows[:-1] if made.stopped else made.rows
        return own, replace(made, steps=made.steps + steps), [*found, *reached]

    def _leave(self, left: list[Any], *, dense: bool) -> tuple[RegimeOrbit, int, list[Any]]:
        """Leave a zero; a motion that comes back to it meanwhile has only touched it."""
        assert self.signs is not None
        before, clock = self.state.copy(), self.dtime
        for _ in range(2):
            own = self.regimes.of(self.signs)
            self._leave_weak_zero(left)
            self._check_rates()
            orbit, pieces = self._placed(own), len(own.orbit.pieces)
            if orbit.free is None:  # nothing ends this regime
                return own, 0, []
            steps, found = orbit.leave(left, [], dense=dense)
            self._take(own, pieces)
            wrong = self._on_wrong_side()
            if not wrong:
                return own, steps, found
            del self.pieces[len(self.pieces) - len(orbit.pieces) + pieces :]
            self.state[:], self.dtime = before, clock
            self.signs = tuple(-s if k in wrong else s for k, s in enumerate(self.signs))
        raise self._piled_up()

    def _check_rates(self) -> None:
        """Make sure that the rates have values where a regime with roots begins."""
        assert self.signs is not None
        regime = self.regimes.kinks.regime(self.signs)
        rates = [*regime.system.velocity, *regime.system.force]
        if regime.weak and not np.isfinite(self._place().values(regime.system, rates)).all():
            raise self._error(_NOT_SMOOTH)

    def _on_wrong_side(self) -> list[int]:
        """Return the switching functions that have not the sign of the regime."""
        assert self.signs is not None
        regime, at = self.regimes.kinks.regime(self.signs), self._place()
        values = at.values(regime.system, [*regime.functions.values()])
        found = zip(regime.functions.items(), values, strict=True)
        return [
            k for (k, g), x in found if x * self.signs[k] < 0 and abs(x) > _BEYOND * at.size(regime.system, g)
        ]

    def _placed(self, own: RegimeOrbit) -> TaylorOrbit:
        """Return the integrator of a regime, put where the motion is."""
        integrator = own.orbit.integrator
        integrator.state[:], integrator.dtime = self.state, self.dtime
        if own.orbit.taylor_events.terminal:
            integrator.reset_cooldowns()
        return own.orbit

    def _take(self, own: RegimeOrbit, pieces: int) -> None:
        """Take over where an integrator has come, and the series of its steps since."""
        self.state[:], self.dtime = own.orbit.integrator.state, own.orbit.integrator.dtime
        self.pieces += own.orbit.pieces[pieces:]

    def _meet(self, own: RegimeOrbit) -> bool:
        """Do what follows where a regime's integrator has stopped; return whether the motion ends there."""
        crossings = self.regimes.taylor_events.crossings
        met = crossings.pop()
        self.on_zero = True
        if id(met.event) in own.kinks:
            self._pass(own.kinks[id(met.event)])
            return self._others(own, met.t, None)
        event = own.given[id(met.event)]
        return self._happened(event, met) or self._others(own, met.t, event)

    def _passes_at_the_end(self, own: RegimeOrbit) -> bool:
        """Go over a kink that lies where a slice ends, and return whether an event ends the motion there.

        heyoka looks for zeros before the end of a step only.
        """
        assert self.signs is not None
        regime = self.regimes.kinks.regime(self.signs)
        values = self._place().values(regime.system, [*regime.functions.values()])
        for k, value in zip(regime.functions, values, strict=True):
            if self.signs[k] != HELD and value * self.signs[k] <= 0:
                if abs(value) > _ZERO * self._place().size(regime.system, regime.functions[k]):
                    raise self._error("a kink was passed unseen before: give a smaller max_step")
                self.on_zero = True
                self._pass(k)
                return self._others(own, float(self._now()), None)
        return False

    def _pass(self, k: int) -> None:
        """Go over to the regime beyond a kink."""
        assert self.signs is not None
        kinks, own, forward = (
            self.regimes.kinks,
            self.regimes.taylor_events,
            self.regimes.taylor_events.forward,
        )
        ended = kinks.regime(self.signs).functions
        if k in ended:
            self._put_on_zero(ended[k])
            self.at_kink = self.state.copy(), self._now()
        at = self._place()
        following = passage(kinks, self.signs, k, at, forward)
        if kinks.system.variations:
            change = saltation(kinks, self.signs, following, k, at).tolist()
            self.state[:] = self.state + np.array([own.number(Fraction(x) / own.unit) for x in change])
        self.signs = following.signs
        if following.rests is not None:
            self.state[following.rests] = own.number(Fraction(0))
        after = None
        if following.y is not None:
            self.state[:] = [own.number(Fraction(x) / own.unit) for x in following.y.tolist()]
            after = following.y[kinks.system.rows]
            self._step_off(k)
            self.put_off = True
        if following.words:
            wall: Any = kinks.system.graph.to_sympy(kinks.functions[k])
            told = Event(wall, name=f"{following.words} at {wall} = 0")
            own.crossings.append(
                Crossing(told, at.t, at.y[kinks.system.rows], rising=following.signs[k] > 0, after=after)
            )

    def _put_on_zero(self, node: int) -> None:
        """Put the state onto a zero, along the motion: heyoka's is off it by the rounding of its whole step."""
        assert self.signs is not None
        regime = self.regimes.kinks.regime(self.signs)
        system, rate = regime.system, regime.rate(node)
        nodes = [node, rate, *system.velocity, *system.force]
        for _ in range(_NEWTON):
            value, speed, *rates = self._place().values(system, nodes)
            if not value or not speed or not np.isfinite(rates).all():
                return
            if abs(value / speed) > _NEAR * abs(float(self.regimes.span)):
                return
            before = self.state.copy()
            self._move(before, self.dtime, np.array(rates), -value / speed)
            if (before == self.state).all():
                return

    def _step_off(self, k: int) -> None:
        """Go a few roundings beyond a wall where H jumps, so that the state has the energy that it is to have."""
        assert self.signs is not None
        regime = self.regimes.kinks.regime(self.signs)
        at, system, g = self._place(), regime.system, regime.functions[k]
        speed, *rates = at.values(system, [regime.rate(g), *system.velocity, *system.force])
        if not speed:
            where: Any = system.graph.to_sympy(g)
            raise self._error(
                f"the motion is not determined: H jumps at {where} = 0, where it has no speed across"
            )
        wanted = self.signs[k] * _BEYOND * at.size(system, g)
        self._move(self.state.copy(), self.dtime, np.array(rates), (wanted - at.value(system, g)) / speed)

    def _leave_weak_zero(self, left: list[Any]) -> bool:
        """Leave a zero where the rates have no Taylor series, by a step that Euler's and the midpoint rule agree on.

        It goes no farther than half of the way to the next of the times that are left.
        """
        assert self.signs is not None
        regime, own = self.regimes.kinks.regime(self.signs), self.regimes.taylor_events
        at, system = self._place(), regime.system
        zero = [regime.functions[k] for k in regime.weak]
        near = [g for g in zero if abs(at.value(system, g)) <= _ZERO * at.size(system, g)]
        if not near:
            return False
        before, clock, rates = self.state.copy(), self.dtime, [*system.velocity, *system.force]
        first = np.nan_to_num(at.values(system, rates))  # rounding may have it a little beyond
        if not first.any():
            raise self._error(_NOT_SMOOTH)
        size = float(abs(before.astype(np.float64)).max()) * float(own.size) or 1.0
        ahead = next((float(abs(t - self._now())) for t in left if t != self._now()), math.inf)
        length = min(_LONGEST_EULER * size / float(abs(first).max()), ahead / 2) * own.forward
        middle = first
        for _ in range(_HALVINGS):
            self._move(before, clock, first, length / 2)
            middle = np.array(self._place().values(system, rates))
            if abs(middle - first).max() * abs(length) <= spacing(own.number) / 8 * size:
                break
            length /= 2
        self._move(before, clock, middle, length)
        return True

    def _move(self, state: Any, clock: tuple[Any, Any], rates: Array, length: float) -> None:
        own = self.regimes.taylor_events
        away = own.number(Fraction(length))
        self.state[:] = state + away * np.array([own.number(Fraction(x) / own.unit) for x in rates.tolist()])
        self.dtime = _sum_of_two(*clock, away)

    def _others(self, own: RegimeOrbit, t: float, known: PreparedEvent | None) -> bool:
        """Do what follows from all other events whose functions vanish at the same place, which heyoka passes over."""
        taylor_events, crossings = self.regimes.taylor_events, self.regimes.taylor_events.crossings
        done = [known]
        for event in own.given.values():
            at, system = self._place(), own.orbit.taylor_events.system
            value, rate = at.values(system, [event.value, event.rate])
            near = abs(value) <= _ZERO * at.size(system, event.value)
            told = any(
                met.event is event.event and abs(met.t - t) <= _ZERO * (abs(t) + 1.0)
                for met in crossings[-9:]
            )
            rising = rate * taylor_events.forward > 0
            if event in done or told or not near or not rate or not event.event.counts(rising):
                continue
            done.append(event)
            y = (at.y + at.carried)[system.rows]
            if self._happened(event, Crossing(event.event, at.t, y, rising)):
                return True
        return False

    def _happened(self, event: PreparedEvent, met: Crossing) -> bool:
        """Note an event of the person's and do what it asks for; return whether the motion ends."""
        own, kinks = self.regimes.taylor_events, self.regimes.kinks
        after = None
        if event.jump is not None:
            at = self._place()
            found = np.array(at.values(kinks.system, event.jump))
            if not np.isfinite(found).all():
                where = time_and_state(met.t, met.y)
                raise NonFiniteStateError(f"the new state of an event is not finite at {where}", met.t, met.y)
            self.state[:] = [own.number(Fraction(x) / own.unit) for x in found.tolist()]
            after = found[kinks.system.rows]
            self.signs = signs_at_start(kinks, self._place(), own.forward)
        own.crossings.append(replace(met, event=event.event, after=after))
        return event.event.action == "stop"

    def lost(self, outcome: object, rows: Sequence[int]) -> NonFiniteStateError:
        """Return the error that says where the motion ended."""
        assert self.signs is not None
        return self.regimes.of(self.signs).orbit.lost(outcome, rows)

    def _piled_up(self) -> NonFiniteStateError:
        return self._error("kinks pile up; stop the motion before")

    def _error(self, words: str) -> NonFiniteStateError:
        y, t = self._place().y[self.regimes.kinks.system.rows], float(self._now())
        return NonFiniteStateError(f"at {time_and_state(t, y)} {words}", t, y)

    def _now(self) -> Any:
        return self.dtime[0] + self.dtime[1]

    def _place(self) -> Place:
        own = self.regimes.taylor_events
        whole = self.state * own.size
        high = whole.astype(np.float64)
        return Place(own.wide, float(self._now()), high, (whole - high).astype(np.float64))

    def _rows(self, rows: list[Any]) -> Any:
        return np.array(rows).reshape(len(rows), len(self.state))


def _sum_of_two(high: Any, low: Any, more: Any) -> tuple[Any, Any]:
    """Return a sum as its rounded value and the rest."""
    first = high + (low + more)
    return first, (high - first) + (low + more)


def kinked_orbits_of(
    kinks: Kinks,
    states: tuple[Array, Array],
    t0: Fraction,
    method: Taylor,
    number: Callable[[Fraction], Any],
    taylor_events: TaylorEvents,
    span: Any,
    precision: str | int,
    max_step: float | None = None,
) -> list[KinkedOrbit]:
    """Return orbits that share the integrators of all regimes.

    Parameters
    ----------
    kinks
        The switching functions.
    states, t0
        Where the orbits start, as sums of two doubles of shape (2n, orbits), and when.
    method, number, precision
        The method, what makes its numbers, and their keyword.
    taylor_events
        The person's events.
    span, max_step
        How long the motion is, and the longest step.
    """
    first = states[0][:, :1], states[1][:, :1]
    settings = precision, first, t0, method, number, span, max_step
    regimes = RegimeOrbits(kinks, taylor_events.events, taylor_events, settings)
    zero = number(Fraction(0))
    made: list[KinkedOrbit] = []
    for high, low in zip(states[0].T.tolist(), states[1].T.tolist(), strict=True):
        whole = [(Fraction(a) + Fraction(b)) / taylor_events.unit for a, b in zip(high, low, strict=True)]
        made.append(KinkedOrbit(regimes, np.array([number(x) for x in whole]), (number(t0), zero)))
    return made
