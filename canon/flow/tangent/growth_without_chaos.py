"""Motions beside which neighbours may part exponentially without chaos: states of rest, and those of linear systems."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from canon.expression.graph.number_systems import FLOAT64
from canon.flow.run.values_at_states import energy_and_rates

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.array import Array
    from canon.flow.task import Task

__all__ = ["rests_or_is_linear"]

_AT_REST = 1e-6
"""A state moves at its first rate by so much of its size in the whole run, at most."""

_ROUNDING = 1e-11
"""Rates half-way between two states are the mean of those at both in a linear system, but for so much of them."""


def rests_or_is_linear(task: Task) -> Array:
    """Tell of each orbit whether it rests, or the equations are linear in the state; shape (orbits,), of bools.

    An exponent above zero is then that of an unstable place or system, where nothing comes back near its start.

    Parameters
    ----------
    task
        The motions.
    """
    system, first = task.system, task.states[0]
    if system.kicked:
        return np.zeros(first.shape[1], dtype=bool)
    begin, end = (float(task.plan.instants[k]) for k in (0, -1))
    moved = np.abs(_rates(task, first, begin)) * abs(end - begin)
    rests = (moved <= _AT_REST * np.linalg.norm(first[system.rows], axis=0)).all(axis=0)
    steady = bool(system.autonomous)
    return (rests & steady) | all(_is_linear_at(task, t) for t in (begin, end))


def _is_linear_at(task: Task, t: float) -> bool:
    for a, b in _places(task):
        here, there = _rates(task, a, t), _rates(task, b, t)
        between = _rates(task, (a + b) / 2, t)
        lack = np.abs(between - (here + there) / 2)
        if not (lack <= _ROUNDING * np.maximum(np.abs(here), np.abs(there)).max(axis=0)).all():
            return False  # as where a rate has no value
    return True


def _places(task: Task) -> Iterator[tuple[Array, Array]]:
    """Yield pairs of states around the starts, with the parameters of each orbit."""
    first, rows = task.states[0], task.system.rows
    random = np.random.default_rng(0)
    for _ in range(2):
        a, b = first.copy(), first.copy()
        for place in (a, b):
            place[rows] += random.uniform(-1, 1, (len(rows), 1)) * (1 + np.abs(first[rows]))
        yield a, b


def _rates(task: Task, states: Array, t: float) -> Array:
    """Return the rate of each variable, shape (variables, orbits)."""
    rows = task.system.rows
    with np.errstate(all="ignore"):
        rates = energy_and_rates(task.system, states, t, FLOAT64)[1:]
        return np.array(
            [np.broadcast_to(np.asarray(rates[row], dtype=float), states.shape[1]) for row in rows]
        )
