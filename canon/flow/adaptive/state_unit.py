"""Unit of a state for the Taylor method: small numbers are measured by a small unit, so that the tolerance is relative.

heyoka takes its tolerance for a relative one where the largest number of a state is above 1 and for an absolute one
elsewhere: an oscillator of amplitude 10⁻¹⁰ would lose eight digits, one of 10⁻³⁰ all of them. Parameters that differ
from orbit to orbit stand in the state too: they are measured in units so large that they are never its largest number.
A satellite about a mass of 4·10¹⁴ m³/s² would be off by metres.
"""

from __future__ import annotations

import functools
import math
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.array import Array
    from canon.flow.run.event import PreparedEvent
    from canon.flow.run.sampling_plan import Plan
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["ParameterUnits", "is_finite", "parameter_units", "state_unit"]

_ORDINARY = 2.0**-4
"""A state whose largest number is above this part of 1 is integrated as it is."""

_SMALL = 2.0**-40
"""Parameters in the state are made smaller than this part of its other numbers."""

_SYSTEMS = 64
"""Systems in other units that are kept for the next motion."""

_BELOW = 20
"""A start at the origin gets a unit 2⁻²⁰ times as large as its rate would carry it in all of the time."""


def state_unit(system: HamiltonEquations, states: Array, plan: Plan) -> Fraction:
    """Return the power of two that the states of a motion are to be measured by: 1, or less for small numbers.

    Parameters
    ----------
    system
        The equations.
    states
        The states to start from, shape (2n, orbits).
    plan
        From when to when.
    """
    sizes = abs(states[system.rows]).max(axis=0)
    if (sizes == 0).any():
        point = dict(zip(system.inputs, (*states, np.float64(plan.instants[0])), strict=True))
        rates = system.graph.evaluate([*system.velocity, *system.force], point)
        fastest = np.max([abs(np.broadcast_to(np.asarray(x), sizes.shape)) for x in rates], axis=0)
        span = abs(plan.instants[-1] - plan.instants[0])
        sizes = np.where(sizes == 0, fastest * span * 2.0**-_BELOW, sizes)
    sizes = sizes[(sizes > 0) & (sizes < _ORDINARY)]
    return Fraction(2) ** (math.frexp(float(sizes.min()))[1] - 1) if sizes.size else Fraction(1)


class ParameterUnits:
    """Units of the parameters that stand in a state, powers of two, so that what is computed stays the same bits.

    Parameters
    ----------
    system
        The equations.
    exponents
        The power of two of each row of the state; 0 of coordinates and momenta.
    """

    def __init__(self, system: HamiltonEquations, exponents: tuple[int, ...]) -> None:
        self.system = _in_units(system, exponents) if any(exponents) else system
        self._own, self._exponents = system, exponents

    def events(self, events: Sequence[PreparedEvent]) -> tuple[PreparedEvent, ...]:
        """Return events, none of which changes the state, as functions of the state in these units."""
        if self.system is self._own:
            return tuple(events)
        graph, scaled = self._own.graph, _scaled_symbols(self._own, self._exponents)
        return tuple(
            replace(
                each,
                value=graph.substitute([each.value], scaled)[0],
                rate=graph.substitute([each.rate], scaled)[0],
            )
            for each in events
        )

    def of(self, states: Array) -> Array:
        """Return states, shape (2n, …), in these units."""
        return self._times(states, -1)

    def back(self, states: Array) -> Array:
        """Return states in these units as they are."""
        return self._times(states, 1)

    def _times(self, states: Array, sign: int) -> Array:
        if self.system is self._own:
            return states
        powers = np.array(self._exponents).reshape((-1,) + (1,) * (states.ndim - 1))
        return np.ldexp(states, sign * powers)


def parameter_units(
    system: HamiltonEquations, start: Array, events: Sequence[PreparedEvent]
) -> ParameterUnits:
    """Return units in which the parameters that differ from orbit to orbit are smaller than all that moves.

    Parameters
    ----------
    system
        The equations.
    start
        The states that the motion started from, of one that is resumed too, shape (2n, orbits).
    events
        Where one changes the state, parameters stay as they are.
    """
    exponents, all_of = [0] * len(start), len(system.q)
    n, rates = all_of - system.varying, (*system.velocity, *system.force)
    if system.varying and not any(event.jump for event in events):
        sizes = np.abs(start[system.rows]).max(axis=0)
        least = _SMALL * float(sizes[sizes > 0].min(initial=1.0))
        for row in (*range(n, all_of), *range(all_of + n, 2 * all_of)):
            largest = float(np.abs(start[row]).max())
            if rates[row] == system.graph.zero and math.isfinite(largest) and largest > least:
                exponents[row] = math.frexp(largest / least)[1]
    return ParameterUnits(system, tuple(exponents))


@functools.lru_cache(maxsize=_SYSTEMS)
def _in_units(system: HamiltonEquations, exponents: tuple[int, ...]) -> HamiltonEquations:
    scaled, half = _scaled_symbols(system, exponents), len(system.velocity)
    nodes = [*system.velocity, *system.force, system.hamiltonian, *system.named.values()]
    found = system.graph.substitute(nodes, scaled)
    named = dict(zip(system.named, found[2 * half + 1 :], strict=True))
    return replace(
        system, written=system.moving_by(found[:half], found[half : 2 * half], found[2 * half]), named=named
    )


def _scaled_symbols(system: HamiltonEquations, exponents: tuple[int, ...]) -> dict[int, int]:
    graph = system.graph
    return {
        graph.symbol(symbol): graph.scaled(Fraction(2) ** exponent, graph.symbol(symbol))
        for symbol, exponent in zip(system.inputs, exponents, strict=False)
        if exponent
    }


def is_finite(state: Any) -> bool:
    """Tell whether doubles hold a state of any numbers: wider ones may be beyond them after a step that is too long."""
    with np.errstate(all="ignore"):
        return bool(np.isfinite(state.astype(np.float64)).all())
