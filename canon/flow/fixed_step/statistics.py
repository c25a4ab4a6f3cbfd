"""Statistics of observables in a fixed-step run: the mean, least and greatest change between samples."""

from __future__ import annotations

import dataclasses
import functools
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.fixed_step.loop_buffers import LoopObservables
from canon.flow.run.observables_along import values_in
from canon.flow.run.sampling_plan import is_count
from canon.kernel.loops.statistics_loop import statistics_function, wide_number

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from canon.array import Array
    from canon.flow.fixed_step.advance import AdvancedStates
    from canon.kernel.llvm.loop import Loop
    from canon.kernel.llvm.machine_code import MachineCode
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["check_cadence", "loop_observables", "statistics"]

_KEPT = 64
"""Compiled functions kept for the next call."""


def loop_observables(
    system: HamiltonEquations,
    nodes: Sequence[int],
    loop: Loop,
    states: tuple[Array, Array],
    t0: Fraction,
    cadence: int,
) -> LoopObservables:
    """Return what follows nodes of a system's graph inside a loop, every so many steps.

    Raises
    ------
    ValueError
        The cadence is no positive whole number; or the state is in x87 numbers or double-double and an
        observable holds a function that double-double does not have.
    """
    if not is_count(cadence):
        raise ValueError(f"cadence={cadence!r}: give a number of steps, 1 or more")
    wide = wide_number(loop.number)
    high, low = states
    if not loop.compensated:  # the loop starts from the state rounded to its numbers
        one = dataclasses.replace(loop.number, lanes=1)
        high, low = (part.reshape(high.shape) for part in one.unpacked(one.packed(high.ravel(), low.ravel())))
    found = values_in(wide, system, nodes, float(t0), high, low)
    start = np.moveaxis(found, 0, 1)
    return LoopObservables(_kept_statistics_function(system, tuple(nodes), loop), int(cadence), start)


def check_cadence(watch: LoopObservables, stops: Sequence[int]) -> None:
    """Make sure that observables are looked at between any two samples.

    Raises
    ------
    ValueError
        The cadence is longer than an interval between samples.
    """
    if not np.diff([stop // watch.cadence for stop in stops]).all():
        raise ValueError(
            f"cadence={watch.cadence} steps is longer than the shortest interval between samples, "
            f"{int(np.diff(stops).min())} steps: take a smaller cadence or fewer samples"
        )


def statistics(
    runs: Sequence[AdvancedStates], stops: Sequence[int], watch: LoopObservables | None, orbits: int
) -> Array | None:
    """Return mean, least and greatest change, shape (observables, 3, times − 1, orbits)."""
    parts = [each.watched for each in runs if each.watched is not None]
    if watch is None or not parts:
        return None
    if len(stops) == 1:
        return np.empty((watch.start.shape[1], 3, 0, orbits))
    found = np.concatenate(parts, axis=1)[:, :orbits].transpose(2, 3, 0, 1).copy()
    counts = np.diff([stop // watch.cadence for stop in stops])
    found[:, 0] /= counts[:, np.newaxis]
    if not np.isfinite(found).all():
        raise ArithmeticError(
            "the energy or an observable was not finite inside the loop: it left its own domain"
        )
    return found


@functools.lru_cache(maxsize=_KEPT)
def _kept_statistics_function(system: HamiltonEquations, nodes: tuple[int, ...], loop: Loop) -> MachineCode:
    return statistics_function(system, nodes, loop)
