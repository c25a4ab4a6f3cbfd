"""Motion with unilateral constraints f(q, t) ≥ 0: contacts that open, are met again, and close."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.equations.contact_events import ContactEvents
from canon.flow.equations.contact_walls import (
    NEAR,
    Regimes,
    dot,
    is_touched,
    power_of_two,
    size_of_wall,
    values_of,
    wall_of,
)
from canon.flow.equations.lagrangian_motion import SPAN, lagrangian_motion, rate_of_pull

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Symbol

    from canon.expression.graph.graph import Graph
    from canon.flow.equations.contact_walls import Wall
    from canon.flow.equations.first_order_motion import FirstOrderMotion
    from canon.mechanics.lagrange.unilateral import UnilateralLagrangian

__all__ = ["contact_motion"]

_SWITCH = Fraction(1, 2**60)
"""A closed contact's σ in parts of the start's size: errors of a step are relative to the largest variable."""


def contact_motion(system: UnilateralLagrangian, start: Mapping[Symbol, float]) -> FirstOrderMotion:
    """Return the first-order equations of a Lagrangian with unilateral constraints, in all regimes.

    Parameters
    ----------
    system
        The Lagrangian with its constraints.
    start
        Numbers for q, q̇, t and the parameters at the start, which say what contacts are closed there.

    Raises
    ------
    ValueError
        The start is beyond a wall or moves into it, the contacts that are closed there do not determine the
        accelerations, a coefficient of restitution is not between 0 and 1, or it is given where masses depend on the
        velocities so that it does not say what an impact does.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> from canon.mechanics.lagrange.unilateral import UnilateralLagrangian
    >>> y = coordinates("y")
    >>> block = UnilateralLagrangian(Lagrangian(y.dot**2 / 2 - y, [y]), [y])
    >>> contact_motion(block, {y: 0.0, y.dot: 0.0}).contacts.each[0].closed
    True
    """
    free = lagrangian_motion(system.system, start)
    if any(r.left_out for r in free.residuals):
        raise ValueError("constraints that depend on others beside unilateral ones: leave them out")
    walls = [wall_of(free, f, start) for f in system.unilateral]
    _check_side(free, walls, start)
    at_start, alpha = _regime_at_start(free, walls, start)
    unit = power_of_two(max(abs(float(start[s])) for s in free.state))
    regimes = Regimes(free, walls, unit * _SWITCH, Fraction(alpha))
    motion = regimes.motion()
    named = {s: node for s, node in motion.named.items() if s not in start}  # a parameter keeps its name
    contacts = ContactEvents(regimes, start, named).contacts(system.restitution, at_start)
    return replace(motion, named=named, contacts=contacts)


def _check_side(free: FirstOrderMotion, walls: Sequence[Wall], start: Mapping[Symbol, float]) -> None:
    onwards = math.copysign(1.0, start.get(SPAN, 1.0))
    for wall in walls:
        f, rate = map(float, values_of(free.graph, [wall.value, wall.rate], start))
        if not (math.isfinite(f) and math.isfinite(rate)):
            raise ValueError(
                f"the constraint {wall.f} ≥ 0 has no finite value at the start: begin inside its domain"
            )
        if f < -NEAR * size_of_wall(free, wall, start):
            raise ValueError(
                f"the start is beyond a wall: {wall.f} is {f:.3g} there, and a unilateral constraint keeps it ≥ 0; "
                "start on the other side, or turn the sign of the constraint round"
            )
        if is_touched(free, wall, start) and onwards * rate < -NEAR * _speed(free, wall, start):
            back = "" if onwards > 0 else ", and time runs back"
            raise ValueError(
                f"the start moves into a wall: {wall.f} = 0 there, with the rate {rate:.3g}{back}; start with the "
                "velocities after the impact, or before it, where the function is positive"
            )


def _speed(free: FirstOrderMotion, wall: Wall, start: Mapping[Symbol, float]) -> float:
    """Return the size of the terms of ḟ at the start."""
    *slopes, rest = np.abs(
        values_of(free.graph, [*wall.normal, free.graph.derivative(wall.value, free.t)], start)
    )
    return float(slopes @ np.abs([float(start[s]) for s in free.second]) + rest)


def _touching(free: FirstOrderMotion, walls: Sequence[Wall], start: Mapping[Symbol, float]) -> list[int]:
    """Return which contacts are touched at rest, f = ḟ = 0."""
    return [
        i
        for i, wall in enumerate(walls)
        if is_touched(free, wall, start)
        and abs(float(values_of(free.graph, [wall.rate], start)[0])) <= NEAR * _speed(free, wall, start)
    ]


def _is_consistent(
    graph: Graph,
    walls: Sequence[Wall],
    nodes: tuple[Sequence[int], Sequence[int]],
    touching: Sequence[int],
    closed: Sequence[int],
    start: Mapping[Symbol, float],
) -> bool:
    """Tell whether with some contacts closed those push, and the others that are touched do not close."""
    point = {**start, **{w.switch: float(i in closed) for i, w in enumerate(walls)}}
    forces, opening = (values_of(graph, each, point) for each in nodes)
    if not np.isfinite(forces).all():
        return False
    return all(forces[i] >= 0 for i in closed) and all(opening[i] >= 0 for i in touching if i not in closed)


def _regime_at_start(
    free: FirstOrderMotion, walls: Sequence[Wall], start: Mapping[Symbol, float]
) -> tuple[list[bool], float]:
    """Return which contacts are closed at the start, and α of the pull towards them.

    Of the contacts with f = ḟ = 0 those are closed that push, where the others do not close by themselves.
    """
    graph = free.graph
    equations = Regimes(free, walls, Fraction(1), Fraction(0))
    lam, bent = equations.multipliers, equations.accelerations
    rates = (*free.rates[: len(free.q)], *bent)
    falls = [graph.add((dot(graph, w.normal, bent), w.curvature)) for w in walls]
    touching = _touching(free, walls, start)
    subsets = (
        closed
        for count in range(len(touching), -1, -1)
        for closed in itertools.combinations(touching, count)
        if _is_consistent(graph, walls, (lam, falls), touching, closed, start)
    )
    chosen = next(subsets, None)
    if chosen is None:
        names = ", ".join(f"{walls[i].f} = 0" for i in touching)
        raise ValueError(
            f"the contacts at {names} do not determine the motion at the start: leave one of them out"
        )
    point = {**start, **{w.switch: 1.0 for w in walls}}
    alpha = rate_of_pull(graph, free.state, rates, point)
    return [i in chosen for i in range(len(walls))], alpha
