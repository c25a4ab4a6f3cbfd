"""Integrators of the regimes of equations with kinks, each with the events that end the regime."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from canon.cached_property import cached_property
from canon.flow.adaptive.held_steps import spacing
from canon.flow.adaptive.taylor_events import TaylorEvents
from canon.flow.adaptive.taylor_orbit import TaylorOrbit, orbits_of
from canon.flow.kinked.place import Place
from canon.flow.kinked.regime_signs import HELD
from canon.flow.run.event import Event, PreparedEvent

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.flow.kinked.regime_signs import Signs
    from canon.flow.kinked.regimes import Kinks, Regime

__all__ = ["RegimeOrbit", "RegimeOrbits"]

_SHORT = 0.7
"""The power of a rounding, in parts of its size, that a function without a Taylor series at its zero is let come to."""


@dataclass(frozen=True, eq=False)
class RegimeOrbit:
    """An integrator of one regime, and what its terminal events are: kinks by number, else the person's events."""

    orbit: TaylorOrbit
    kinks: dict[int, int]
    given: dict[int, PreparedEvent]


@dataclass(frozen=True, eq=False)
class RegimeOrbits:
    """The integrators of all regimes, compiled when they are first needed, and used by one orbit at a time."""

    kinks: Kinks
    events: Sequence[PreparedEvent]
    taylor_events: TaylorEvents
    settings: tuple[Any, ...]
    lock: Any = field(default_factory=threading.Lock)

    @cached_property
    def _kept(self) -> dict[Signs, RegimeOrbit]:
        return {}

    @property
    def span(self) -> Any:
        """How long the motion is."""
        return self.settings[5]

    def of(self, signs: Signs) -> RegimeOrbit:
        """Return the integrator of a regime."""
        if signs not in self._kept:
            self._kept[signs] = self._made(signs)
        return self._kept[signs]

    def _made(self, signs: Signs) -> RegimeOrbit:
        regime, own = self.kinks.regime(signs), self.taylor_events
        ends = [(k, node, -signs[k]) for k, node in regime.functions.items()]
        if HELD in signs:
            ways = self.kinks.ways_out(signs)
            ends += [(k, node, -1) for k, node in ways if regime.system.graph.symbols(node)]
        kinks, given, events = dict[int, int](), dict[int, PreparedEvent](), list[PreparedEvent]()
        for event, folded in zip(self.events, self.kinks.events(signs, self.events), strict=True):
            stops = (
                folded
                if event.event.action == "record"
                else replace(folded, event=_stopping(event.event), jump=None)
            )
            given[id(stops.event)] = replace(folded, event=event.event)
            events.append(stops)
        for k, node, direction in ends:
            expression = regime.system.graph.to_sympy(node)
            if k in regime.weak:
                graph = regime.system.graph
                node = graph.add((node, graph.number(-signs[k] * self._short_of(node, regime))))
            stops = PreparedEvent(Event(expression, direction, "stop"), node, regime.rate(node), None)
            kinks[id(stops.event)] = k
            events.append(stops)
        precision, states, t0, method, number, span, max_step = self.settings
        watched = TaylorEvents(regime.system, events, precision, number, forward=own.forward, unit=own.unit)
        watched.crossings = own.crossings
        orbit = orbits_of(regime.system, states, t0, method, number, watched, span, max_step)[0]
        return RegimeOrbit(orbit, kinks, given)

    def _short_of(self, node: int, regime: Regime) -> Fraction:
        """Return how far from a zero without a Taylor series a motion is let come, whose last bit is one step."""
        (high, low), t0, number = self.settings[1], self.settings[2], self.settings[4]
        at = Place(self.taylor_events.wide, float(t0), high[:, 0], low[:, 0])
        size = at.size(regime.system, node) or 1.0
        return Fraction(size) * Fraction(spacing(number) ** _SHORT)


def _stopping(event: Event) -> Event:
    return Event(event.function, event.direction, "stop", event.name)
