"""Companions of a computed motion: the same in wider numbers or with half the step, and two neighbours beside it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.integrate import integrate
from canon.flow.kinked.regimes import kinks_of
from canon.flow.method.adaptive_methods import Taylor
from canon.flow.method.number_formats import FIXED
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.run.passed_terms import may_have_passed
from canon.flow.run.sampling_plan import Plan
from canon.kernel.llvm.number_types import EXTENDED

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.array import Array
    from canon.flow.run.samples import Samples
    from canon.flow.task import Task

__all__ = ["BESIDE", "CompanionTask", "companion_tasks", "companions"]

BESIDE = 2.0**-40
"""How far beside the motion its neighbour starts, in parts of the motion's size."""

_AS_WIDE = {"single": "double", "compensated": "double", "double-double": "quad"}
"""Precisions of fixed steps, and those of Taylor's method that are as wide."""

_SLICES = 20

_IN_LANES = "gauss", "average_vector_field"
"""Families of methods whose stages lie in SIMD lanes, which extended numbers have none of."""

_BITS = {"single": 23, "double": 52, "compensated": 52, "extended": 63, "double-double": 104}
"""With so many bits the numbers of a precision are rounded at worst."""


@dataclass(frozen=True)
class CompanionTask:
    """A companion's task, what to call it, and the rounding unit of its numbers."""

    task: Task
    words: str
    unit: float

    def truncation(self, scale: Array, y: Array) -> Array:
        """Return what is cut off from the companion's series beside its rounding, shape (2n, 1, orbits).

        Taylor's tolerance is relative to the largest number of a state: with momenta of 10⁶ a coordinate of 10⁻³ has
        nine digits less. Series of a coordinate that stays zero have nothing to cut off; a method of fixed steps errs
        by a known part of what it shows.
        """
        if self.task.plan.h is not None:
            return np.zeros_like(scale)
        moves = (y[:, :, : scale.shape[2]] != 0).any(axis=1, keepdims=True)
        return np.where(moves, 2.0 * self.unit * scale.max(axis=0, keepdims=True), 0.0)


def companion_tasks(task: Task, samples: Samples) -> Iterator[CompanionTask]:
    """Yield companions, each more exact than the one before."""
    plan = task.plan
    # Over kinks steps lose their order, and half as long ones may err as much.
    kinked = kinks_of(task.system) is not None
    if plan.h is None or kinked or may_have_passed(task.system, samples, float(plan.h)):
        # An event that has ended the motion may end the companion a little later.
        t = plan.instants if samples.crossings and len(samples.t) < len(plan.instants) else samples.t
        ends = sorted({round(k * (len(t) - 1) / _SLICES) for k in range(1, _SLICES + 1)} - {0})
        exact = plan.exact if plan.h is None else {k: plan.last(k) for k in range(len(t))}
        plan = Plan(plan.start, t, ends=tuple(ends), exact=exact)
        given = _AS_WIDE.get(task.precision_name, task.precision_name)
        for precision, bits in _wider_taylor(given):
            better = replace(task, method=Taylor(), plan=plan, precision=precision)
            yield CompanionTask(
                better, f"Taylor, {precision}{'' if isinstance(precision, str) else ' digits'}", 2.0**-bits
            )
        return
    half = replace(plan, h=plan.h / 2, stops=tuple(2 * stop for stop in plan.stops))
    for precision in _wider(task):
        words = f"{task.method}, step {float(half.h or 0):g}, {precision}"
        yield CompanionTask(replace(task, plan=half, precision=precision), words, 2.0 ** -_BITS[precision])


def _wider_taylor(given: str) -> list[tuple[str | int, int]]:
    ladder: list[tuple[str | int, int]] = [("extended", 63), ("quad", 112), (50, 166)]
    names = ["double", "extended", "quad"]
    if given not in names:
        return [(int(given) + 16, math.floor((int(given) + 16) / math.log10(2)))]
    left = ladder[names.index(given) :]
    return left if EXTENDED.available() else [each for each in left if each[0] != "extended"]


def _wider(task: Task) -> list[str]:
    """Return the precisions of the companions of a method of fixed steps."""
    given = FIXED[task.precision_name]
    if task.method.solvable is not None:
        return [given.name]
    # Extended numbers once more, as they may hold numbers that double-double does not.
    ready = EXTENDED.available() and given.number.mantissa <= EXTENDED.mantissa
    return (
        ["extended", "double-double"] if ready and task.method.family not in _IN_LANES else ["double-double"]
    )


def companions(
    better: CompanionTask, samples: Samples, own: Array, scale: Array
) -> tuple[Samples | None, int]:
    """Return the companion, with two neighbours as further orbits where there can be any, and its samples.

    One starts a small part of the motion's size beside it, the other so near that rounding might have put it there.
    """
    task, (high, low) = better.task, better.task.states
    shifts = scale[:, 0] * _directions(len(scale))[:, np.newaxis]
    if (
        kinks_of(task.system) is not None
    ):  # beside a rest in a kink of |x| a neighbour would meet it without end
        shifts[(own == own[:, :1]).all(axis=1)] = 0.0
    near, far = low.copy(), low.copy()
    near[task.system.rows] += 2 * better.unit * shifts
    far[task.system.rows] += BESIDE * shifts
    highs = [high, high + far, high + near]
    lows = [low, (high - highs[1]) + far, (high - highs[2]) + near]
    pairs = np.concatenate(highs, axis=1), np.concatenate(lows, axis=1)
    together = None if task.events else replace(task, states=pairs)
    for each in (together, task):
        if each is None:
            continue
        try:
            return _known(integrate(each), samples)
        except NonFiniteStateError as lost:
            last = lost
    forward = task.plan.forward
    before = int(np.searchsorted(forward * samples.t, forward * last.time))
    if before < 2:
        return None, 0
    try:
        return _known(integrate(_first(task, before)), samples)
    except NonFiniteStateError:
        return None, 0


def _first(task: Task, count: int) -> Task:
    """Return a task that ends at an earlier sample."""
    plan = task.plan
    ends = (*(end for end in plan.ends if end < count - 1), count - 1) if plan.ends else ()
    shorter = replace(plan, instants=plan.instants[:count], stops=plan.stops[:count], ends=ends)
    return replace(task, plan=shorter)


def _known(found: Samples, samples: Samples) -> tuple[Samples, int]:
    """Return a companion and how many of the motion's samples it has too."""
    count = min(len(found.t), len(samples.t))
    cut = replace(found, t=found.t[:count], y=found.y[:, :count], carried=found.carried[:, :count])
    return cut, count


def _directions(size: int) -> Array:
    """Return numbers between ½ and 1 in size with signs, as unlike a special direction as the golden ratio makes it."""
    places = np.arange(1, size + 1) * ((math.sqrt(5) - 1) / 2) % 1
    return np.where(np.arange(size) % 2, -1.0, 1.0) * (0.5 + places / 2)
