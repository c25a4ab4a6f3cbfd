"""Compiled Jacobian: unit deviations moved by the exact derivative of every flow that a compiled step is made of."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.fixed_step.compiled_loop import steps_between
from canon.flow.fixed_step.loop_buffers import LoopBuffers
from canon.flow.fixed_step.partial_step import coefficient_pairs
from canon.flow.method.number_formats import fixed_precision
from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state
from canon.flow.tangent.tangent_loop import tangent_loop

if TYPE_CHECKING:
    from canon.array import Array
    from canon.flow.task import Task

__all__ = ["compiled_jacobian"]

_AT_ONCE = 1 << 14
"""Steps in one call of compiled code: after each Python can handle an interruption."""


def compiled_jacobian(task: Task) -> tuple[Array, Array, Array, Array]:
    """Return times, the motion, and its Jacobian as the sum of two arrays, shape (2n, 2n, times).

    Parameters
    ----------
    task
        The motion, of one orbit, by a splitting by solvable parts or on a Poisson manifold.

    Raises
    ------
    NonFiniteStateError
        The motion leaves the finite numbers, or its neighbours part by more than they hold.
    """
    plan, precision, size = task.plan, fixed_precision(task.precision), len(task.system.rows)
    assert plan.h is not None
    made = tangent_loop(task.system, task.method, precision, size, step=float(plan.h))
    loop, number = made.loop, made.loop.number
    coefficients = steps_between(loop, task.method, plan).coefficients
    buffers = LoopBuffers(loop, *task.states, coefficient_pairs(coefficients, plan.start, plan.h))
    units = np.array(made.units or (1.0,) * size)
    unit = number.packed(np.diag(units).reshape(-1, 1), np.zeros((size**2, 1)))
    deviations = buffers.e[0, -len(unit) :]
    deviations[:] = unit
    motion, found = [buffers.states()[0]], [number.unpacked(unit.copy())]
    for begin, end in pairwise(plan.stops):
        for first in range(begin, end, _AT_ONCE):
            _advance(buffers, first, min(_AT_ONCE, end - first), task)
        motion.append(buffers.states()[0])
        found.append(number.unpacked(deviations.copy()))
        if not np.isfinite(found[-1][0]).all():
            t, state = float(plan.start + end * plan.h), motion[-1][:, 0]
            raise NonFiniteStateError(
                f"the Jacobian is not finite after {time_and_state(t, state)}: neighbours part too far",
                t,
                state,
            )
    weights = units[:, np.newaxis, np.newaxis]
    high, low = (
        np.stack([each[k].reshape(size, size).T for each in found], axis=2) / weights for k in (0, 1)
    )
    return plan.instants, np.stack([each[task.system.rows, 0] for each in motion], axis=1), high, low


def _advance(buffers: LoopBuffers, first: int, steps: int, task: Task) -> None:
    y, e = buffers.y.copy(), buffers.e.copy()
    buffers.advance(first, steps)
    if not buffers.finite():
        raise buffers.lost(y, e, first, steps, task.system.rows)
