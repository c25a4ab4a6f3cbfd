"""Lost directions: where v/|v| of several velocities comes to v = 0, as of a puck that dry friction stops.

It stops after a finite time, and what happens then the equations do not say: v/|v| has no value there, and no limit
that all ways to it share. Steps of the Taylor method pass over it on a straight way, where the series of |v| goes on
below zero, and become ever shorter on others, as those of DOP853 do.
"""

from __future__ import annotations

import functools
from fractions import Fraction
from typing import TYPE_CHECKING

import sympy as sp

from canon.expression.graph.number_systems import FLOAT64
from canon.flow.kinked.branch_points import is_nonnegative
from canon.flow.run.event import Event, prepared_events
from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.array import Array
    from canon.flow.run.event import PreparedEvent
    from canon.flow.run.samples import Samples
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["check_directions", "lost_directions", "may_lose_direction"]

_REST = Fraction(1, 2**60)
"""A square of a speed is zero at this part of what it was at the start: the speed is 1e-9 of its own."""


def may_lose_direction(system: HamiltonEquations) -> bool:
    """Tell whether the equations divide by a root of what vanishes where all velocities or momenta do."""
    return bool(_squared_speeds(system))


def lost_directions(system: HamiltonEquations, state: Array, t: float) -> tuple[PreparedEvent, ...]:
    """Return events that stop a motion where a direction is lost.

    Parameters
    ----------
    system
        The equations.
    state, t
        The start of one orbit, shape (2n,).
    """
    squares = _squared_speeds(system)
    if not squares:
        return ()
    values = dict(zip(system.inputs, (*state, t), strict=True))
    with FLOAT64.quiet():
        found = system.graph.evaluate(squares, values)
    return prepared_events(
        system,
        [
            Event(system.graph.to_sympy(square) - sp.Rational(_REST * Fraction(float(value))), -1, "stop")
            for square, value in zip(squares, found, strict=True)
            if value > 0
        ],
    )


def check_directions(lost: Sequence[PreparedEvent], samples: Samples) -> Samples:
    """Return samples of a motion that has kept its directions.

    Raises
    ------
    NonFiniteStateError
        It has lost one.
    """
    events = {id(each.event) for each in lost}
    for met in samples.crossings:
        if id(met.event) in events:
            raise NonFiniteStateError(
                f"the motion can't be continued after {time_and_state(met.t, met.y)}: a velocity comes to rest there, "
                "and its direction, v/|v| of dry friction for instance, has no value; stop before, by an Event on a "
                'small speed, Event(speed**2 - small, action="stop")',
                met.t,
                met.y,
            )
    return samples


@functools.lru_cache(maxsize=64)
def _squared_speeds(system: HamiltonEquations) -> tuple[int, ...]:
    """Return what stands under roots that the rates divide by and vanishes with the second half of the state."""
    graph, half = system.graph, len(system.velocity)
    rest = {graph.symbol(s): graph.zero for s in system.inputs[half : 2 * half]}
    found = dict[int, None]()
    for node in graph.reachable(system.rates):
        kind, operands, _ = graph.nodes[node]
        if kind != "pow" or graph.nodes[operands[1]].kind != "number":
            continue
        base, exponent = operands[0], graph.nodes[operands[1]].value
        slow = Fraction(-1, 2) <= exponent < 0 and graph.nodes[base].kind == "add"
        if slow and is_nonnegative(graph, base) and graph.substitute([base], rest) == [graph.zero]:
            found[base] = None
    return tuple(found)
