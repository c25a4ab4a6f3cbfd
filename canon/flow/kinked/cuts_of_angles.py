"""Cuts of angles: atan2(y, x) jumps by 2π where y = 0 and x < 0, and its Taylor series goes on smoothly.

Where the equations depend on it by cos 3θ, say, nothing jumps. A torque that turns back to the nearest of several
places, atan2(sin θ, cos θ), does: its series goes on as if there were no cut.
"""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from canon.expression.graph.number_systems import FLOAT64
from canon.flow.run.event import Event, prepared_events
from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.array import Array
    from canon.flow.run.event import PreparedEvent
    from canon.flow.run.samples import Samples
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["check_cuts", "cuts_of_angles", "may_cross_cuts"]

_BESIDE = 2.0**-20
"""How far beside a cut rates are looked at, in parts of the state."""

_NEARER = 2.0**-4
"""How much nearer again: what does not shrink with it jumps."""

_ROUNDING = 1e-9
"""Differences that are a smaller part of the largest rate are rounding."""


def may_cross_cuts(system: HamiltonEquations) -> bool:
    """Tell whether the equations hold an angle with a cut."""
    return bool(_angles(system))


def cuts_of_angles(system: HamiltonEquations) -> tuple[PreparedEvent, ...]:
    """Return events at y = 0 for every atan2(y, x) that the equations hold."""
    graph = system.graph
    return prepared_events(
        system, [Event(graph.to_sympy(graph.nodes[node].operands[0])) for node in _angles(system)]
    )


def check_cuts(
    system: HamiltonEquations, cuts: Sequence[PreparedEvent], samples: Samples, start: Array
) -> Samples:
    """Return samples of a motion that has crossed no cut at which its rates jump.

    Parameters
    ----------
    system, cuts
        The equations, and their cuts as events.
    samples
        The motion.
    start
        Its start, shape (2n,), whose parameters stay what they are.

    Raises
    ------
    NonFiniteStateError
        They do: what follows is not the system's motion.
    """
    angles = {id(cut.event): node for cut, node in zip(cuts, _angles(system), strict=True)}
    for met in samples.crossings:
        if id(met.event) in angles and _jumps(system, angles[id(met.event)], met.t, met.y, start):
            angle = system.graph.to_sympy(angles[id(met.event)])
            raise NonFiniteStateError(
                f"the motion can't be continued after {time_and_state(met.t, met.y)}: {angle} jumps by 2*pi there, and "
                "with it the rates, which its series does not show; stop earlier, take DOP853(), or write the angle "
                "without its cut",
                met.t,
                met.y,
            )
    return replace(samples, crossings=tuple(met for met in samples.crossings if id(met.event) not in angles))


def _jumps(system: HamiltonEquations, angle: int, t: float, y: Array, start: Array) -> bool:
    """Tell whether rates jump where the first argument of an angle vanishes, from one side to the other."""
    state = start.copy()
    state[system.rows] = y
    (x,), rates = _at(system, [system.graph.nodes[angle].operands[1]], t, state), _rates(system, t, state)
    fastest = float(np.abs(rates).max())
    if x >= 0 or not fastest:
        return False
    far = _BESIDE * (float(np.abs(state[system.rows]).max()) or 1.0) / fastest
    wide, near = (
        np.abs(_rates(system, t + d, state + d * rates) - _rates(system, t - d, state - d * rates))
        for d in (far, far * _NEARER)
    )
    return bool(((near > wide / 2) & (wide > _ROUNDING * fastest)).any())


def _rates(system: HamiltonEquations, t: float, state: Array) -> Array:
    return _at(system, [*system.velocity, *system.force], t, state)


def _at(system: HamiltonEquations, nodes: Sequence[int], t: float, state: Array) -> Array:
    values = dict(zip(system.inputs, (*state, t), strict=True))
    with FLOAT64.quiet():
        return np.array([float(x) for x in system.graph.evaluate(nodes, values)])


@functools.lru_cache(maxsize=64)
def _angles(system: HamiltonEquations) -> tuple[int, ...]:
    graph = system.graph
    nodes = graph.reachable((*system.velocity, *system.force))
    return tuple(node for node in nodes if graph.nodes[node].kind == "atan2" and graph.symbols(node))
