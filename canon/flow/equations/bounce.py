"""Elastic impacts of systems in (q, q̇): the velocities after a wall g(q, t) = 0, ideal constraints being kept.

The wall's impulse is along ∇g, that of the constraints along their rows: M Δ − Aᵀμ = ∇g, A Δ = 0, and
q̇ → q̇ − 2 ġ Δ/(∇g·Δ) turns ġ round and keeps the kinetic energy where the wall is at rest. With M(q, q̇) a finite
impulse along ∇g changes q̇ along Δ/(∇g·Δ) only where that does not depend on q̇, and by that much only where ∇g·Δ is
after the impact what it was before.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.flow.equations.lagrangian_motion import values_at_start
from canon.flow.equations.linear_equations import solved_from_start

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph
    from canon.flow.equations.first_order_motion import FirstOrderMotion
    from canon.flow.run.event import Event

__all__ = ["is_straight", "with_bounces"]


def with_bounces(
    motion: FirstOrderMotion, events: Sequence[Event], start: Mapping[Symbol, float]
) -> tuple[FirstOrderMotion, tuple[Event, ...]]:
    """Return the equations and the events, bounces written as new velocities.

    Parameters
    ----------
    motion
        The equations.
    events
        What is to happen; those that do not bounce are left as they are.
    start
        Numbers for the state, t and the parameters.

    Raises
    ------
    ValueError
        The system has no mass matrix to bounce with, or one that depends on the velocities so that they are not known
        after the impact; or g is no wall g(q, t) = 0.
    """
    if all(event.action != "bounce" for event in events):
        return motion, tuple(events)
    named, made = dict(motion.named), list["Event"]()
    for event in events:
        if event.action != "bounce":
            made.append(event)
            continue
        after = _velocities_after(motion, event, start)
        symbols = [sp.Dummy(f"{s.name}_after", real=True) for s in motion.second]
        named |= dict(zip(symbols, after, strict=True))
        made.append(replace(event, action=dict(zip(motion.second, symbols, strict=True))))
    return replace(motion, named=named), tuple(made)


def _velocities_after(motion: FirstOrderMotion, event: Event, start: Mapping[Symbol, float]) -> list[int]:
    graph, q, v = motion.graph, motion.q, motion.second
    function: Any = event.function
    if not motion.matrix:
        raise ValueError(f"{event} bounces, which a {motion.kind} does not: give the new state as its action")
    wall = graph.from_sympy(function)
    unknown = sorted(s.name for s in graph.symbols(wall) - {*start})
    if unknown:
        raise KeyError(
            f"the event {event} holds {', '.join(unknown)}: give each a number, parameters={{symbol: value}}"
        )
    if graph.symbols(wall) & {*v} or not graph.symbols(wall) & {*q}:
        raise ValueError(
            f"the event {event} is no wall g(q, t) = 0 to bounce from: give its action as {{v: …}}"
        )
    normal, speeds = graph.gradient(wall, q), [graph.symbol(s) for s in v]
    matrix, size = motion.matrix, len(motion.matrix)
    values = values_at_start(graph, [a for row in matrix for a in row], start, "the mass matrix")
    right = [*normal, *[graph.zero] * (size - len(q))]
    pushed = solved_from_start(graph, matrix, right, values.reshape(size, size))[: len(q)]
    rate = graph.add([*map(graph.mul, zip(normal, speeds, strict=True)), graph.derivative(wall, motion.t)])
    across = graph.add(list(map(graph.mul, zip(normal, pushed, strict=True))))
    impulse = graph.scaled(-2, graph.mul((rate, graph.power(across, -1))))
    after = [graph.add((s, graph.mul((impulse, d)))) for s, d in zip(speeds, pushed, strict=True)]
    turned = graph.substitute([across], dict(zip(speeds, after, strict=True)))[0]
    if turned != across or not is_straight(graph, pushed, across, v):
        raise ValueError(
            f"masses depend on the velocities, so it is not known how they bounce at {event}: give its action as "
            "{v: …}"
        )
    return after


def is_straight(graph: Graph, pushed: Sequence[int], across: int, v: Sequence[Symbol]) -> bool:
    """Tell whether an impulse changes velocities along a direction Δ/(∇g·Δ) that does not depend on them."""
    inverse = graph.power(across, -1)
    return not graph.all_symbols([graph.mul((d, inverse)) for d in pushed]) & {*v}
