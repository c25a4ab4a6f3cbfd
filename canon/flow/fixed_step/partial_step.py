"""Partial steps: single steps of any length from any state, to locate events and to evaluate between samples."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.cached_property import cached_property
from canon.flow.fixed_step.loop_buffers import LoopBuffers
from canon.kernel.llvm.number_types import double_pair

if TYPE_CHECKING:
    from collections.abc import Callable
    from fractions import Fraction

    from canon.array import Array
    from canon.flow.fixed_step.loop_buffers import Memory
    from canon.kernel.llvm.loop import Loop

__all__ = ["LoopState", "PartialSteps", "coefficient_pairs"]


@dataclass(frozen=True)
class LoopState:
    """States high + low, each of shape (2n, orbits), and what an implicit method keeps beyond them."""

    high: Array
    low: Array
    beyond: Memory | None = None

    @classmethod
    def of(cls, buffers: LoopBuffers) -> LoopState:
        """Return the state that buffers hold."""
        return cls(*buffers.states(), buffers.beyond())

    @classmethod
    def in_copy(cls, buffers: LoopBuffers, y: Memory, e: Memory) -> LoopState:
        """Return the state of which y and e, copies of the buffers' memory, are made."""
        high, low = buffers.states_in(y[np.newaxis], e[np.newaxis])
        return cls(high[:, 0], low[:, 0], buffers.beyond_in(e).copy())


def coefficient_pairs(
    coefficients: Callable[[Fraction], list[Fraction]], t: Fraction, h: Fraction
) -> tuple[Array, Array]:
    """Return what a loop reads, t, h and the method's coefficients times h, as sums of two doubles."""
    pairs = np.array([double_pair(c) for c in (t, h, *coefficients(h))])
    return pairs[:, 0].copy(), pairs[:, 1].copy()


@dataclass(frozen=True, eq=False)
class PartialSteps:
    """Steps between the times t0 + n h of a run.

    Parameters
    ----------
    loop
        The compiled loop.
    coefficients
        The method's coefficients for a step size.
    t0, h
        The run's first time and its step.
    """

    loop: Loop
    coefficients: Callable[[Fraction], list[Fraction]]
    t0: Fraction
    h: Fraction

    @cached_property
    def pairs(self) -> tuple[Array, Array]:
        """What the loop reads for whole steps."""
        return coefficient_pairs(self.coefficients, self.t0, self.h)

    def time(self, n: int, part: Fraction) -> Fraction:
        """Return the time of a part of step n + 1."""
        return self.t0 + (n + part) * self.h

    def moved(self, state: LoopState, n: int, begin: Fraction, end: Fraction) -> LoopState:
        """Return the state after one step from t0 + (n + begin) h to t0 + (n + end) h."""
        if begin == end:
            return state
        pairs = coefficient_pairs(self.coefficients, self.time(n, begin), (end - begin) * self.h)
        buffers = LoopBuffers(self.loop, state.high, state.low, pairs, memory=state.beyond)
        buffers.advance(0, 1)
        return LoopState.of(buffers)

    def whole(self, state: LoopState, n: int, steps: int) -> LoopState:
        """Return the state after whole steps of the run, from the one at t0 + n h."""
        buffers = LoopBuffers(self.loop, state.high, state.low, self.pairs, memory=state.beyond)
        buffers.advance(n, steps)
        return LoopState.of(buffers)
