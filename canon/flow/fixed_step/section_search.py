"""Places on a surface of section of many orbits: noticed by compiled steps, found by partial steps, in SIMD lanes."""

from __future__ import annotations

import functools
import os
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from canon.flow.fixed_step.loop_buffers import LoopBuffers
from canon.flow.fixed_step.partial_step import coefficient_pairs
from canon.kernel.llvm.number_types import double_pair
from canon.kernel.loops.section_loop import crossing_places_function, crossing_search_function

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.array import Array
    from canon.flow.fixed_step.loop_buffers import Memory
    from canon.flow.fixed_step.partial_step import PartialSteps
    from canon.kernel.llvm.loop import Loop
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["SectionPlaces", "reads_affinely", "section_places"]

_ROOM = 1 << 14
"""Places that are noted before they are found."""

_STEPS = 1 << 16
"""Steps between looks at interruptions and whether a state is finite."""

_MANY = 2**62

_JUMP = 0.25
"""As in :mod:`canon.flow.fixed_step.event_search`."""

_kept_search = functools.lru_cache(maxsize=64)(crossing_search_function)
_kept_places = functools.lru_cache(maxsize=64)(crossing_places_function)


@dataclass(frozen=True)
class SectionPlaces:
    """Places on a surface of section, of one orbit after the other, in the order in which each passes them.

    Parameters
    ----------
    orbit, t
        Whose they are and when, shape (places,).
    high, low
        The states are high + low, shape (2n, places).
    turned
        How often g turned so near zero that it may have passed twice within a step unseen.
    steps
        Steps taken by all orbits together.
    """

    orbit: npt.NDArray[np.int64]
    t: Array
    high: Array
    low: Array
    turned: int
    steps: int


def reads_affinely(steps: PartialSteps) -> bool:
    """Return whether a loop reads what is affine in the step size, in numbers that are no pairs: lanes may differ."""
    if steps.loop.number.pair:
        return False
    h = steps.h
    whole, half, none = (steps.coefficients(part) for part in (h, h / 2, Fraction(0)))
    return all(2 * b == a + c for a, b, c in zip(whole, half, none, strict=True))


def section_places(
    system: HamiltonEquations,
    steps: PartialSteps,
    states: tuple[Array, Array],
    count: int,
    surface: tuple[int, int],
    *,
    direction: int,
    wanted: int | None,
    progress: Callable[[float], None],
) -> SectionPlaces:
    """Return where orbits pass a surface g = 0 within so many steps.

    Parameters
    ----------
    system, steps
        The equations; a loop, its coefficients, first time and step.
    states
        The starting states as sums of two doubles, each of shape (2n, orbits).
    count
        How many steps to take at most.
    surface
        The nodes of g and of dg/dt along the motion.
    direction
        1: where g rises, −1: where it falls, 0: both.
    wanted
        How many places of each orbit, or all.
    progress
        Called now and then with the fraction done.

    Raises
    ------
    NonFiniteStateError
        An orbit was lost before it had its places.
    """
    (high, low), loop = states, steps.loop
    lanes, orbits = loop.number.lanes, high.shape[1]
    blocks = -(-orbits // lanes)
    # The last block is filled up with copies of the last orbit.
    filled = np.minimum(np.arange(blocks * lanes), orbits - 1).reshape(blocks, lanes)
    enough = _MANY if wanted is None else wanted
    search = _Search(system, steps, count, surface, direction, enough, several=orbits > 1)
    search.compile()
    stopped, done, lock = threading.Event(), [0], threading.Lock()

    def block(k: int) -> _Found:
        found = search.block(high[:, filled[k]], low[:, filled[k]], filled[k], stopped)
        with lock:
            done[0] += 1
            progress(done[0] / blocks)
        return found

    if blocks == 1:
        parts = [block(0)]
    else:
        with ThreadPoolExecutor(min(os.cpu_count() or 1, blocks)) as pool:
            try:
                parts = list(pool.map(block, range(blocks)))
            finally:
                stopped.set()
    orbit = np.concatenate([part.orbit for part in parts])
    own = (
        np.concatenate([part.lane for part in parts])
        + np.repeat(np.arange(blocks) * lanes, [len(part.orbit) for part in parts])
        < orbits
    )
    chosen = np.flatnonzero(own)
    order = chosen[np.argsort(orbit[chosen], kind="stable")]

    def ordered(pieces: list[Array]) -> Array:
        return np.concatenate(pieces, axis=-1)[..., order]

    return SectionPlaces(
        orbit[order],
        ordered([part.t for part in parts]),
        ordered([part.high for part in parts]),
        ordered([part.low for part in parts]),
        sum(part.turned for part in parts),
        sum(part.steps for part in parts),
    )


@dataclass(frozen=True)
class _Found:
    """Places of one block of orbits."""

    orbit: npt.NDArray[np.int64]
    lane: npt.NDArray[np.int64]
    t: Array
    high: Array
    low: Array
    turned: int
    steps: int


@dataclass(frozen=True)
class _Noted:
    """Memory for what is noted of each passing: the state before it, g before and after it, lane and step."""

    y: Memory
    e: Memory
    g: Memory
    where: npt.NDArray[np.int64]

    @classmethod
    def of(cls, loop: Loop, size: int, room: int) -> _Noted:
        kind = loop.number.dtype
        return cls(
            np.zeros((room, size), dtype=kind),
            np.zeros((room, size), dtype=kind),
            np.zeros((room, 2), dtype=kind),
            np.zeros((room, 2), dtype=np.int64),
        )


@dataclass(frozen=True, eq=False)
class _Search:
    """What is looked for, and with which steps."""

    system: HamiltonEquations
    steps: PartialSteps
    count: int
    surface: tuple[int, int]
    direction: int
    wanted: int
    several: bool

    def compile(self) -> None:
        """Compile what threads would each compile for themselves."""
        _kept_search(self.system, self.surface[0], self.steps.loop, self.direction)
        _kept_places(self.system, *self.surface, self.steps.loop)

    def block(
        self, high: Array, low: Array, orbits: npt.NDArray[np.int64], stopped: threading.Event
    ) -> _Found:
        """Return the places of one block of orbits, found as often as the memory for what is noted is full."""
        loop, lanes = self.steps.loop, self.steps.loop.number.lanes
        code = _kept_search(self.system, self.surface[0], loop, self.direction)
        buffers = LoopBuffers(loop, high, low, self.steps.pairs, whose=orbits if self.several else None)
        seen = np.zeros((2, lanes), dtype=loop.number.dtype)
        seen[0] = self._values(high, low)
        room = max(_ROOM, 2 * lanes)
        noted, counts = _Noted.of(loop, len(high), room), np.zeros(lanes + 3, dtype=np.int64)
        found: list[_Found] = []
        done = 0
        while done < self.count and counts[:lanes].min() < self.wanted and not stopped.is_set():
            before, begun = (buffers.y.copy(), buffers.e.copy()), done
            counts[lanes] = 0
            code.call(
                loop.code.address, buffers.y.ctypes.data, buffers.e.ctypes.data, buffers.c.ctypes.data,
                seen.ctypes.data, noted.y.ctypes.data, noted.e.ctypes.data, noted.g.ctypes.data,
                noted.where.ctypes.data, counts.ctypes.data, done, min(_STEPS, self.count - done), room, self.wanted,
            )  # fmt: skip
            done = int(counts[lanes + 1])
            # An orbit that has its places already goes on only for the others beside it, and may be lost.
            unfinished = counts[:lanes] < self.wanted
            if not buffers.finite() and (buffers.lost_orbits() & unfinished).any():
                raise buffers.lost(*before, begun, done - begun, self.system.rows, unfinished)
            found.append(self._places(noted, int(counts[lanes]), orbits))
        own = np.unique(orbits).size
        found = found or [self._places(noted, 0, orbits)]
        turned = int(counts[lanes + 2])
        return _Found(
            np.concatenate([each.orbit for each in found]),
            np.concatenate([each.lane for each in found]),
            np.concatenate([each.t for each in found]),
            np.concatenate([each.high for each in found], axis=1),
            np.concatenate([each.low for each in found], axis=1),
            turned,
            done * own,
        )

    def _values(self, high: Array, low: Array) -> Array:
        """Return g at the start; 0 where rounding leaves no sign of it."""
        symbols = self.system.inputs
        start = dict(zip(symbols, (*(high + low), float(self.steps.t0)), strict=True))
        return np.broadcast_to(self.system.graph.evaluate([self.surface[0]], start)[0], high.shape[1:])

    def _places(self, noted: _Noted, count: int, orbits: npt.NDArray[np.int64]) -> _Found:
        """Return where g = 0 in the steps that were noted."""
        loop, size = self.steps.loop, noted.y.shape[1]
        lanes = loop.number.lanes
        blocks = -(-count // lanes)
        if not count:
            nothing = np.zeros(0, dtype=np.int64)
            states = np.zeros((size, 0))
            return _Found(nothing, nothing, np.zeros(0), states, states, 0, 0)
        filled = np.minimum(np.arange(blocks * lanes), count - 1)
        g, (lane, step) = noted.g[filled].astype(np.float64), noted.where[filled].T
        one = replace(loop.number, lanes=1)
        # The states are of the loop's own numbers, which doubles may not hold.
        before, rest = (part.reshape(-1, size).T for part in one.unpacked(noted.y[filled].ravel()))
        rest = noted.e[filled].T if loop.compensated else rest
        parts = np.clip(g[:, 0] / (g[:, 0] - g[:, 1]), 0.0, 1.0)
        t0, h = self.steps.t0, self.steps.h
        times = _as_number(loop, t0) + step.astype(loop.number.dtype) * _as_number(loop, h)
        base, slope = self._affine()
        own = LoopBuffers(loop, before, rest, base)
        code = _kept_places(self.system, *self.surface, loop)
        kind = loop.number.dtype
        memory: list[npt.NDArray[Any]] = [
            times.astype(kind), parts.astype(kind), np.where(g[:, 0] < 0, -1.0, 1.0).astype(kind),
            np.zeros(size * lanes, dtype=kind), np.zeros(loop.carry * lanes, dtype=kind),
            np.zeros(len(base[0]) * lanes, dtype=kind),
        ]  # fmt: skip
        read = [one.packed(*pair) for pair in (base, slope)]
        code.call(
            loop.code.address, own.y.ctypes.data, own.e.ctypes.data,
            *(part.ctypes.data for part in (*read, *memory)), blocks, len(base[0]),
        )  # fmt: skip
        high, rest = own.states()
        t = (times + memory[1] * _as_number(loop, h)).astype(np.float64)
        values = dict(zip(self.system.inputs, (*(high + rest), t), strict=True))
        there = np.broadcast_to(np.abs(self.system.graph.evaluate([self.surface[0]], values)[0]), t.shape)
        kept = np.flatnonzero((there <= _JUMP * np.abs(g).max(axis=1))[:count])  # neither jumps nor poles
        return _Found(orbits[lane[kept]], lane[kept], t[kept], high[:, kept], rest[:, kept], 0, 0)

    def _affine(self) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """Return the coefficients of a step of no size, and what they gain up to a whole step."""
        coefficients, h = self.steps.coefficients, self.steps.h
        base = [self.steps.t0, Fraction(0), *coefficients(Fraction(0))]
        whole = [self.steps.t0, h, *coefficients(h)]
        gain = [b - a for a, b in zip(base, whole, strict=True)]
        return _pairs(base), _pairs(gain)


def _pairs(numbers: list[Fraction]) -> tuple[Array, Array]:
    return coefficient_pairs(lambda _h: numbers[2:], numbers[0], numbers[1])


def _as_number(loop: Loop, value: Fraction) -> Any:
    """Return a number in the loop's own type."""
    high, low = double_pair(value)
    return np.array(high, dtype=loop.number.dtype) + np.array(low, dtype=loop.number.dtype)
