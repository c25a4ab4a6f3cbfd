"""Jacobian in stretches: variations that would grow beyond the largest doubles begin anew on the way.

The Jacobians of the stretches are multiplied. The motion itself goes on all the while: that its neighbours part
exponentially is no collision.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.integrate import integrate
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.run.sampling_plan import Plan, Sampling, adaptive_plan, fixed_plan

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.array import Array
    from canon.flow.task import Task

__all__ = ["jacobian_in_stretches"]

_MOST = 2**12
"""Stretches in which a motion is tried at most."""

_HELD = 1000
"""Doubles hold numbers up to a little above this power of two."""


def jacobian_in_stretches(
    task: Task, jacobian_over: Callable[[Task], Array]
) -> tuple[Array, Array, Array, tuple[int, ...]]:
    """Return times, motion, and Jacobians with the powers of two that they are to be multiplied with.

    Parameters
    ----------
    task
        The motion of one orbit without its variations.
    jacobian_over
        Gives the Jacobian at the end of a task that is a stretch of this one.

    Raises
    ------
    NonFiniteStateError
        The motion itself can't be continued, or its variations not over the shortest stretch.
    """
    integrate(task)  # whose own end, if it has one, is what there is to say
    parts = 2
    while True:
        plan, kept = _refined(task.plan, parts)
        motion = integrate(replace(task, plan=plan))
        states = list(zip(motion.y.swapaxes(0, 1), motion.carried.swapaxes(0, 1), strict=True))
        try:
            found = [
                jacobian_over(replace(task, states=states[k], plan=_stretch(plan, k)))
                for k in range(len(states) - 1)
            ]
        except NonFiniteStateError:
            parts *= 4
            if parts > _MOST:
                raise
            continue
        M, exponents = _multiplied(found)
        return motion.t[kept], motion.y[:, kept, 0], M[:, :, kept], tuple(exponents[k] for k in kept)


def _refined(plan: Plan, parts: int) -> tuple[Plan, list[int]]:
    """Return a plan with further samples, and which of them are the plan's own."""
    if plan.h is not None:
        steps = plan.stops[-1]
        more = {round(k * steps / parts) for k in range(parts)}
        stops = tuple(sorted({*plan.stops, *more}))
        return fixed_plan(plan.start, plan.h, stops), [stops.index(stop) for stop in plan.stops]
    own = plan.instants.tolist()
    even = np.linspace(own[0], own[-1], parts + 1)[1:-1].tolist()
    inner = sorted({*own[1:-1], *even} - {own[0], own[-1]}, key=lambda t: plan.forward * t)
    last = len(own) - 1
    finer = adaptive_plan(Sampling(plan.last(0), plan.last(last), len(inner) + 1, tuple(inner)))
    times = finer.instants.tolist()
    return finer, [times.index(t) for t in own]


def _stretch(plan: Plan, k: int) -> Plan:
    """Return the plan from a sample to the next one."""
    if plan.h is not None:
        return fixed_plan(plan.last(k), plan.h, (0, plan.stops[k + 1] - plan.stops[k]))
    return adaptive_plan(Sampling(plan.last(k), plan.last(k + 1), 1))


def _multiplied(stretches: list[Array]) -> tuple[Array, list[int]]:
    """Return the products of all stretches up to each, and powers of two where doubles do not hold them."""
    so_far, power = np.eye(len(stretches[0])), 0
    products, powers = [so_far], [0]
    for each in stretches:
        own = math.frexp(float(abs(each).max()))[1]
        so_far = np.ldexp(each, -own) @ so_far
        shift = math.frexp(float(abs(so_far).max()))[1]
        so_far, power = np.ldexp(so_far, -shift), power + own + shift
        held = abs(power) < _HELD
        products.append(np.ldexp(so_far, power) if held else so_far)
        powers.append(0 if held else power)
    return np.stack(products, axis=2), powers
