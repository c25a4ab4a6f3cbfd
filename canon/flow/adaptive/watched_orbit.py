"""DOP853 integration of one orbit, through events and kinks: each is located inside a step, and a step ends on it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.cached_property import cached_property
from canon.flow.adaptive.component_sizes import sizes_at_start, sizes_of
from canon.flow.adaptive.zeros_in_step import TooFastError, Zero, zeros_in_step
from canon.flow.kinked.next_regime import passage, signs_at_start
from canon.flow.kinked.place import Place
from canon.flow.kinked.regime_signs import HELD
from canon.flow.kinked.regimes import Regime
from canon.flow.kinked.saltation import saltation
from canon.flow.run.compiled_nodes import CompiledNodes, compiled_nodes
from canon.flow.run.event import Crossing, Event
from canon.flow.run.non_finite_state import NonFiniteStateError, PiledUpError, time_and_state
from canon.kernel.llvm.number_types import DOUBLE, EXTENDED

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Sequence

    from canon.array import Array
    from canon.flow.kinked.regime_signs import Signs
    from canon.flow.kinked.regimes import Kinks
    from canon.flow.run.event import PreparedEvent
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["WatchedOrbit"]

_NEWTON = 6
"""Steps of the method to a zero, each nearer to it."""

_AT_ONCE = 2.0**-40
"""In parts of a function's size: one that vanishes where another event is met."""

_ROUNDING = 2.0**-44
"""In parts of a function's size, what rounding and the interpolant's may make of one that vanishes."""

_PILE = 1000
"""So many events at one instant pile up."""


@dataclass(frozen=True, eq=False)
class Watch:
    """A regime's compiled rates, and the functions looked for in it: those of its kinks, then the person's events.

    ``values`` gives every function and, after them, the rate of each.
    """

    regime: Regime
    rate: CompiledNodes
    values: CompiledNodes
    functions: tuple[int, ...]
    kinks: tuple[int, ...]
    events: tuple[PreparedEvent, ...]

    @property
    def count(self) -> int:
        """How many functions are looked for."""
        return len(self.functions)


@dataclass(eq=False)
class WatchedOrbit:
    """One orbit under DOP853 on its way through events and kinks.

    Parameters
    ----------
    system, kinks, events
        The equations, their kinks, and the person's events.
    tolerances
        The relative one, and which part of the sizes of components the absolute one is.
    forward
        1 where time runs forward, −1 where it runs back.
    longest
        The longest step from a time and a state.
    t, y
        Where the motion is.
    waiting
        Of a motion that is resumed: the events that it has not met yet where it stands.
    """

    system: HamiltonEquations
    kinks: Kinks | None
    events: Sequence[PreparedEvent]
    tolerances: tuple[float, float]
    forward: int
    longest: Callable[[float, Array], float]
    t: float
    y: Array
    waiting: Collection[Event] = ()
    crossings: list[Crossing] = field(default_factory=list[Crossing])
    evaluations: int = 0
    steps: int = 0
    stopped: bool = False
    sampled: int = 1

    def __post_init__(self) -> None:
        self._watches: dict[Signs, Watch] = {}
        self.signs: Signs = ()
        if self.kinks is not None:
            self.signs = signs_at_start(self.kinks, self._place(), self.forward)
        self._sides = self._sides_at_start()
        self._sizes, self._start = abs(self.y), None

    @property
    def compile_seconds(self) -> float:
        """How long compiling took."""
        return sum(each.rate.seconds + each.values.seconds for each in self._watches.values())

    def _step(self, integrator: Any) -> None:
        before, kept = float(integrator.t), integrator.y.copy()
        integrator.max_step = self.longest(before, kept)
        message = integrator.step()
        self._sizes = np.fmax(self._sizes, abs(integrator.y))
        integrator.atol = self._absolute()
        self.steps += 1
        if integrator.status == "failed" or not np.isfinite(integrator.y).all():
            raise _lost(before, kept[self.system.rows], message)

    def go(self, times: Array, states: Array, progress: Callable[[float], None]) -> None:
        """Put the states at the times after the first into their columns; ``sampled`` says how many are there."""
        in_a_row, size = 0, None
        while self.sampled < len(times) and not self.stopped:
            begun, integrator = self.t, self._integrator(self.t, self.y, float(times[-1]), size)
            met, before, kept = None, self.t, self.y
            while self.sampled < len(times) and met is None:
                before, kept = float(integrator.t), integrator.y.copy()
                self._step(integrator)
                interpolant = _Interpolant(integrator)
                met = self._passed(before, kept, integrator, interpolant)
                until = integrator.t if met is None else met.t
                self._sample(times, states, interpolant, until)
                progress(float((until - times[0]) / (times[-1] - times[0])))
            self.evaluations += integrator.nfev
            if met is not None:
                size = abs(integrator.t - before)
                self._happen(met, before, kept)
            in_a_row = in_a_row + 1 if self.t == begun else 0
            if in_a_row > _PILE:
                lost = self._error("events pile up there; stop the motion before")
                raise PiledUpError(str(lost), lost.time, lost.state)

    def _sample(self, times: Array, states: Array, interpolant: _Interpolant, until: float) -> None:
        """Put the states at the times of a step into their columns."""
        reached = self.sampled
        while reached < len(times) and self.forward * (times[reached] - until) <= 0:
            reached += 1
        if reached > self.sampled:
            states[:, self.sampled : reached] = interpolant(times[self.sampled : reached])
            self.sampled = reached

    # one step ------------------------------------------------------------------------------------

    def _passed(self, before: float, kept: Array, integrator: Any, interpolant: Any) -> Zero | None:
        """Note what was passed in a step, and return the first zero that ends it, if one does."""
        watch, sides = self._watch(), self._sides
        zeros: Sequence[Zero] = ()
        if watch.count:
            zeros, sides = self._zeros(before, integrator, interpolant)
        for zero in zeros:
            event = self._event(zero)
            if event is not None and not event.event.counts(zero.rising):
                continue
            if event is None or event.event.action != "record":
                return zero
            t, y = self._located(zero, before, kept)
            self.crossings.append(Crossing(event.event, t, y[self.system.rows], zero.rising))
        self.t, self.y, self._sides = float(integrator.t), integrator.y.copy(), sides
        return None

    def _zeros(self, before: float, integrator: Any, interpolant: Any) -> tuple[list[Zero], Array]:
        watch, end = self._watch(), float(integrator.t)

        def values(t: float) -> Array:
            return watch.values.call(t, interpolant(t) if t != end else integrator.y)

        try:
            return zeros_in_step(values, before, end, self._sides, self._roundings, len(watch.kinks))
        except TooFastError as error:
            event = self._event(Zero(before, error.which, rising=True))
            what = "a kink's function" if event is None else str(event.event)
            raise self._error(
                f"{what} changes too often to be followed in one step, which goes to t = {end:.9g}: give a smaller "
                "max_step"
            ) from None

    def _roundings(self) -> Array:
        """Return how large, of the functions that are looked for, rounding makes those that vanish here."""
        watch, at = self._watch(), self._place()
        system = watch.regime.system
        return np.array([_ROUNDING * at.size(system, node) for node in watch.functions])

    def _event(self, zero: Zero) -> PreparedEvent | None:
        """Return the person's event that a zero belongs to; None for a kink."""
        watch = self._watch()
        place = zero.which - len(watch.kinks)
        return watch.events[place] if place >= 0 else None

    def _located(self, zero: Zero, before: float, kept: Array) -> tuple[float, Array]:
        """Return when a function vanishes and the state there, by steps of the method from the start of its step."""
        watch, t = self._watch(), zero.t
        y, last = self._reached(before, kept, t), math.inf
        for _ in range(_NEWTON):
            found = watch.values.call(t, y)
            value, rate = found[zero.which], found[watch.count + zero.which]
            away = -value / rate if rate else 0.0
            if not away or not abs(away) < last or t + away == t or (t + away - before) * self.forward < 0:
                break
            last, t = abs(away), float(t + away)
            y = self._reached(before, kept, t)
        return t, y

    def _reached(self, before: float, kept: Array, t: float) -> Array:
        if t == before:
            return kept.copy()
        integrator = self._integrator(before, kept, t, abs(t - before))
        while str(integrator.status) == "running":
            message = integrator.step()
            if str(integrator.status) == "failed" or not np.isfinite(integrator.y).all():
                raise _lost(before, kept[self.system.rows], message)
        self.evaluations += integrator.nfev
        return integrator.y.copy()

    # at an event ---------------------------------------------------------------------------------

    def _happen(self, zero: Zero, before: float, kept: Array) -> None:
        self.t, self.y = self._located(zero, before, kept)
        watch, event = self._watch(), self._event(zero)
        if event is None:
            self._pass(watch.kinks[zero.which], zero.which)
        else:
            self._meet(event, rising=zero.rising)
        sticks = event is None and HELD in self.signs
        arrived = self._arrived(watch.kinks[zero.which], kept) if sticks else None
        for other in (watch if sticks else self._watch()).events:
            if not self.stopped and other.event is not (event and event.event):
                self._meet_too(other, arrived)
        self._sides = self._sides_now(None if event is None or event.jump is not None else zero)

    def _pass(self, k: int, which: int) -> None:
        assert self.kinks is not None
        self._put_on_zero(which)
        at = self._place()
        following = passage(self.kinks, self.signs, k, at, self.forward)
        self.y = self.y + saltation(self.kinks, self.signs, following, k, at)
        self.signs, after = following.signs, None
        if following.rests is not None:
            self.y[following.rests] = 0.0
        if following.y is not None:
            self.y, after = following.y, following.y[self.system.rows]
        if following.words:
            wall: Any = self.system.graph.to_sympy(self.kinks.functions[k])
            told = Event(wall, name=f"{following.words} at {wall} = 0")
            y = at.y[self.system.rows]
            self.crossings.append(Crossing(told, self.t, y, rising=following.signs[k] > 0, after=after))

    def _put_on_zero(self, which: int) -> None:
        """Put the state onto the zero that it met, along its motion; where it leaves a zero, just beyond.

        There its rate has no sign yet, and one that rounding gave it might lead back. Of a motion that hardly meets the
        zero, as it turns round there, the nearest state on the zero is taken.
        """
        watch, at = self._watch(), self._place()
        system, node = watch.regime.system, watch.functions[which]
        value, rate = watch.values.call(self.t, self.y)[[which, watch.count + which]]
        leaves = self.signs[watch.kinks[which]] == HELD
        if leaves:
            value += _ROUNDING * at.size(system, node)
        away = -value / rate if rate else 0.0
        moved = away * np.nan_to_num(watch.rate.call(self.t, self.y))
        if rate and np.abs(moved).max() <= _AT_ONCE * np.abs(self.y).max():
            self.y = self.y + moved
            self.t = float(self.t + away) if leaves else self.t
        elif not leaves:
            slope = np.array(at.values(system, system.graph.gradient(node, system.inputs[:-1])))
            square = float(slope @ slope)
            self.y = self.y - (value / square * slope if 0 < square < math.inf else 0.0)

    def _meet(self, event: PreparedEvent, *, rising: bool) -> None:
        y, after = self.y[self.system.rows], None
        if event.jump is not None:
            self._check_again(event, rising=rising)
            self.y = np.array(self._place().values(self.system, event.jump))
            if not np.isfinite(self.y).all():
                raise self._error("the new state of an event is not finite")
            after = self.y[self.system.rows]
            if self.kinks is not None:
                self.signs = signs_at_start(self.kinks, self._place(), self.forward)
        self.crossings.append(Crossing(event.event, self.t, y, rising, after))
        self.stopped = event.event.action == "stop"

    def _check_again(self, event: PreparedEvent, *, rising: bool) -> None:
        """Make sure that an event that changed the state is not met again at the same instant.

        Raises
        ------
        PiledUpError
            It is.
        """
        apart = [abs(met.t - self.t) for met in self.crossings[-9:] if met.event is event.event]
        (rate,) = self._place().values(self.system, [event.rate])
        turned = rate * self.forward * (1 if rising else -1) < 0
        near = _AT_ONCE * abs(self.t) if turned else 0.0
        if apart and min(apart) <= near and not event.switches:
            at_once = (
                f"{event.event} is met again at once at {time_and_state(self.t, self.y[self.system.rows])}"
            )
            raise PiledUpError(
                f"{at_once}: events pile up there; stop the motion before", self.t, self.y[self.system.rows]
            )

    def _arrived(self, k: int, kept: Array) -> Place:
        """Return the place beside a zero that the motion sticks on, on the side from which it came from a state.

        On the zero itself a drag √|v| leaves no rate.
        """
        assert self.kinks is not None
        at = self._place()
        if self.kinks.rate_at_rest(self.signs, k) is None:
            return at
        row, y = self.kinks.row(k), self.y.copy()
        y[row] = math.copysign(_AT_ONCE * (np.abs(y).max() or 1.0), kept[row])
        return replace(at, y=y)

    def _meet_too(self, event: PreparedEvent, arrived: Place | None) -> None:
        """Meet another event if its function vanishes at the same place, by its rate where the motion arrived."""
        at = self._place()
        value, rate = at.value(self.system, event.value), (arrived or at).value(self.system, event.rate)
        rising = rate * self.forward > 0
        late = 2 * np.spacing(abs(self.t)) * abs(rate)
        near = abs(value) <= _AT_ONCE * at.size(self.system, event.value) + late
        told = any(
            met.event is event.event and abs(met.t - self.t) <= _AT_ONCE * (abs(met.t) + 1.0)
            for met in self.crossings[-9:]
        )
        if near and rate and not told and event.event.counts(rising):
            self._meet(event, rising=rising)

    def _sides_at_start(self) -> Array:
        """Return the signs of all functions, as the other engines take a start."""
        watch, sides = self._watch(), self._sides_now(rounding=0.0)
        values = self._place().values(watch.regime.system, [each.value for each in watch.events])
        first = len(watch.kinks)
        for k, (each, value) in enumerate(zip(watch.events, values, strict=True), first):
            if value == 0 and each.event in self.waiting:
                sides[k] = -sides[k]
        return sides

    def _sides_now(self, crossed: Zero | None = None, rounding: float = _AT_ONCE) -> Array:
        """Return of which sign every function is from here on: of its rate where it vanishes; 0 where that does too."""
        watch = self._watch()
        at = self._place()
        sides = [float(self.signs[k]) if self.signs[k] != HELD else 1.0 for k in watch.kinks]
        for event in watch.events:
            value, rate = at.values(watch.regime.system, [event.value, event.rate])
            # An event is found to the rounding of time.
            late = 2 * np.spacing(abs(self.t)) * abs(rate) if rounding else 0.0
            zero = abs(value) <= rounding * at.size(watch.regime.system, event.value) + late
            sides.append(
                math.copysign(1.0, rate * self.forward) * bool(rate) if zero else math.copysign(1.0, value)
            )
        if crossed is not None:
            sides[crossed.which] = 1.0 if crossed.rising else -1.0
        return np.array(sides)

    # regimes -------------------------------------------------------------------------------------

    def _watch(self) -> Watch:
        if self.signs not in self._watches:
            self._watches[self.signs] = self._made()
        return self._watches[self.signs]

    def _made(self) -> Watch:
        if self.kinks is None:
            regime, folded, looked = Regime((), self.system, {}), tuple(self.events), list[tuple[int, int]]()
        else:
            regime = self.kinks.regime(self.signs)
            folded, looked = self.kinks.events(self.signs, self.events), [*regime.functions.items()]
            if HELD in self.signs:
                ways = self.kinks.ways_out(self.signs)
                looked += [(k, node) for k, node in ways if self.system.graph.symbols(node)]
        functions = [*(node for _, node in looked), *(event.value for event in folded)]
        rates = [*(regime.rate(node) for _, node in looked), *(event.rate for event in folded)]
        # Rates without a series at a zero have no value beyond it: those of the next regime are taken there.
        smooth = regime.system if not regime.weak else self.system
        return Watch(
            regime,
            compiled_nodes(self.system, smooth.rates),
            compiled_nodes(self.system, [*functions, *rates]),
            tuple(functions),
            tuple(k for k, _ in looked),
            folded,
        )

    def _integrator(self, t: float, y: Array, end: float, first: float | None) -> Any:
        from scipy import integrate

        self._sizes = np.fmax(self._sizes, abs(y))
        if self._start is None:
            self._start = sizes_at_start(self.system, self._watch().rate.call, t, y, end - t)
        dop853: Any = integrate.DOP853  # its stub has no array of tolerances
        return dop853(
            self._watch().rate.call,
            t,
            y,
            end,
            rtol=self.tolerances[0],
            atol=self._absolute(),
            first_step=None if first is None else min(first, abs(end - t)) or None,
        )

    def _absolute(self) -> Array:
        assert self._start is not None
        return self.tolerances[1] * sizes_of(self.system, self._sizes, self._start)

    def _place(self) -> Place:
        wide = EXTENDED if EXTENDED.available() else DOUBLE
        return Place(wide, self.t, self.y, np.zeros_like(self.y))

    def _error(self, words: str) -> NonFiniteStateError:
        y = self.y[self.system.rows]
        return NonFiniteStateError(f"at {time_and_state(self.t, y)}: {words}", self.t, y)


class _Interpolant:
    """The motion inside of the latest step; its polynomial costs three rates more, and is made where it is asked."""

    def __init__(self, integrator: Any) -> None:
        self.integrator = integrator

    @cached_property
    def polynomial(self) -> Any:
        """SciPy's dense output."""
        return self.integrator.dense_output()

    def __call__(self, t: Any) -> Array:
        return self.polynomial(t)


def _lost(t: float, state: Array, reason: object) -> NonFiniteStateError:
    return NonFiniteStateError(
        f"the motion can't be continued after {time_and_state(t, state)} ({reason}): a collision or the edge of H's "
        "domain; stop earlier",
        t,
        state,
    )
