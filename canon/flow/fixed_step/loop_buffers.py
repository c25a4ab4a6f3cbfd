"""Buffers of a compiled loop: states, compensation and coefficients of orbits, in blocks of SIMD lanes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from canon.array import all_finite
from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state
from canon.kernel.loops.sampling_loop import sampling_function, watched_sampling_function
from canon.kernel.loops.statistics_loop import ENTRIES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.array import Array
    from canon.kernel.llvm.loop import Loop
    from canon.kernel.llvm.machine_code import MachineCode

__all__ = ["LoopBuffers", "LoopObservables", "Memory"]

Memory = npt.NDArray[Any]


@dataclass(frozen=True)
class LoopObservables:
    """Observables to follow inside the loop.

    Parameters
    ----------
    code
        The machine code of :func:`canon.kernel.loops.statistics_loop.statistics_function`.
    cadence
        After how many steps they are evaluated each time.
    start
        Their values at the start in wide numbers, shape (orbits, observables, 1), or 2 parts of double-doubles.
    """

    code: MachineCode
    cadence: int
    start: Memory


class LoopBuffers:
    """Orbits on their way: states, what compensation carries, coefficients, statistics.

    Parameters
    ----------
    loop
        The compiled loop.
    high, low
        The states are high + low, shape (2n, orbits); orbits a multiple of the loop's lanes.
    coefficients
        t0, h and the method's coefficients times h, as sums of two doubles.
    watch
        Observables to follow.
    memory
        What an implicit method kept beyond the state, from :meth:`beyond` of earlier buffers.
    whose
        The numbers that messages call the orbits by, where these are some of many; from 0 on where None.
    """

    def __init__(
        self,
        loop: Loop,
        high: Array,
        low: Array,
        coefficients: tuple[Array, Array],
        watch: LoopObservables | None = None,
        memory: Memory | None = None,
        whose: npt.NDArray[np.int64] | None = None,
    ) -> None:
        self.loop, number = loop, loop.number
        self.size, self.orbits = high.shape
        self.whose = np.arange(self.orbits) if whose is None and self.orbits > 1 else whose
        self.blocks = self.orbits // number.lanes
        # A compensated state starts with its low part in the compensation, any other rounds it to its type.
        low = self._by_block(low)
        nothing = np.zeros(low.shape)
        self.y = number.packed(self._by_block(high), nothing if loop.compensated else low)
        self._scalars = self.y.size // (self.blocks * self.size)
        self.e = np.zeros((self.blocks, loop.carry * self._scalars), dtype=number.dtype)
        if loop.compensated:
            self.e[:, : self.size * self._scalars] = number.packed(low, nothing).reshape(self.blocks, -1)
        if memory is not None:
            self.e[:, self.size * self._scalars :] = memory
        one = number.lanes == 1
        self.c = number.packed(*(part if one else np.repeat(part, number.lanes) for part in coefficients))
        self._addresses = self.y.ctypes.data, self.e.ctypes.data, self.c.ctypes.data
        self.t0, self.h = (float(part) for part in coefficients[0][:2])
        self.watch = watch
        if watch is not None:
            *observed, parts = watch.start.shape
            self.record = np.zeros((*observed, ENTRIES, parts), dtype=watch.start.dtype)
            self.record[..., 0, :] = watch.start
            self._forget()

    def _forget(self) -> None:
        self.record[..., 1:, :] = 0
        self.record[..., 2, 0], self.record[..., 3, 0] = np.inf, -np.inf

    def watched(self) -> Array:
        """Return the sums and bounds of the changes since they were last asked for, and start anew."""
        found = _changes(self.record)
        self._forget()
        return found

    def _by_block(self, states: Array) -> Array:
        """Reorder (2n, orbits) as blocks, components, lanes: shape (blocks · 2n, lanes)."""
        lanes = self.loop.number.lanes
        if self.orbits == 1:
            return states
        return states.reshape(self.size, self.blocks, lanes).transpose(1, 0, 2).reshape(-1, lanes)

    def advance(self, first: int, steps: int) -> None:
        """Take steps, the first of which has a given number."""
        if self.watch is None:
            self.loop.code.call(*self._addresses, first, steps, self.blocks)
            return
        numbers = (first, steps, self.blocks, self.watch.cadence)
        self.watch.code.call(self.loop.code.address, *self._addresses, *numbers, self.record.ctypes.data)

    def sample(self, stops: Memory, y: Memory, e: Memory) -> Array | None:
        """Go from stop to stop, the first of which is where the motion stands, and copy y and e at the others.

        What is watched is returned as :meth:`watched` would have it at each of them.

        Parameters
        ----------
        stops
            Step numbers, shape (samples + 1,).
        y, e
            Where the copies go, one after the other along the first axis.
        """
        samples = len(stops) - 1
        rows = stops.ctypes.data, y.ctypes.data, e.ctypes.data
        arguments = self.loop.code.address, *self._addresses, *rows
        sizes = samples, self.blocks, self.y.nbytes, self.e.nbytes
        if self.watch is None:
            sampling_function().call(*arguments, *sizes)
            return None
        fresh, kept = self.record.copy(), np.empty((samples, *self.record.shape), dtype=self.record.dtype)
        records = self.record.ctypes.data, fresh.ctypes.data, kept.ctypes.data
        followed = self.watch.code.address, *records, self.watch.cadence, self.record.nbytes
        watched_sampling_function().call(*arguments, *sizes, *followed)
        return _changes(kept)

    def _call(self, y: Memory, e: Memory, first: int, steps: int, blocks: int) -> None:
        self.loop.code.call(y.ctypes.data, e.ctypes.data, self.c.ctypes.data, first, steps, blocks)

    def finite(self) -> bool:
        """Return whether every state is finite."""
        return all_finite(self.y)

    def states(self) -> tuple[Array, Array]:
        """Return the states as sums of two doubles, each of shape (2n, orbits)."""
        high, low = self.states_in(self.y[np.newaxis], self.e[np.newaxis])
        return high[:, 0], low[:, 0]

    def states_in(self, y: Memory, e: Memory) -> tuple[Array, Array]:
        """Return states of which y and e are copies, each of shape (2n, times, orbits).

        Parameters
        ----------
        y, e
            Copies of these buffers, one after the other along the first axis.
        """
        times = len(y)

        def by_orbit(numbers: Array) -> Array:
            if self.orbits == 1:
                return numbers.reshape(times, self.size, 1).transpose(1, 0, 2)
            shaped = numbers.reshape(times, self.blocks, self.size, self.loop.number.lanes)
            return shaped.transpose(2, 0, 1, 3).reshape(self.size, times, self.orbits)

        high, low = (by_orbit(part) for part in self.loop.number.unpacked(y))
        if self.loop.compensated:
            carried, _ = self.loop.number.unpacked(e[:, :, : self.size * self._scalars].copy())
            low = low + by_orbit(carried)
        return high, low

    def beyond(self) -> Memory:
        """Return what an implicit method keeps beyond the state, its iterations first, shape (blocks, …)."""
        return self.beyond_in(self.e).copy()

    def beyond_in(self, e: Memory) -> Memory:
        """Return what lies beyond the states in copies of these buffers' e, shape (…, blocks, …)."""
        return e[..., self.size * self._scalars :]

    def lost_orbits(self) -> npt.NDArray[np.bool_]:
        """Return of each orbit whether its state is not finite."""
        y = self.y.reshape(self.blocks, self.size, -1, self.loop.number.lanes)
        return ~np.isfinite(y).all(axis=(1, 2)).ravel()

    def lost(
        self,
        y: Memory,
        e: Memory,
        first: int,
        steps: int,
        rows: Sequence[int] | None,
        wanted: npt.NDArray[np.bool_] | None = None,
    ) -> NonFiniteStateError:
        """Find the last finite state of the first orbit that was lost, halving the slice of steps.

        Parameters
        ----------
        y, e
            The memory before the slice.
        first, steps
            The slice.
        rows
            The components that are coordinates and momenta; all of them where None.
        wanted
            Of each orbit whether its loss matters; all of them where None.
        """
        number, lost = self.loop.number, self.lost_orbits()
        block, lane = divmod(int(np.argmax(lost if wanted is None else lost & wanted)), number.lanes)
        length = self.y.size // self.blocks
        y, e = y[block * length : (block + 1) * length].copy(), e[block].copy()

        def finite(memory: Memory) -> bool:
            return bool(np.isfinite(number.unpacked(memory)[0][:, lane]).all())

        while steps > 1:
            half, half_e = y.copy(), e.copy()
            self._call(half, half_e, first, steps // 2, 1)
            if finite(half):
                y, e, first, steps = half, half_e, first + steps // 2, steps - steps // 2
            else:
                steps //= 2
        after = e.copy()
        self._call(y.copy(), after, first, 1, 1)
        state = number.unpacked(y)[0][:, lane]
        change = float(after[(self.size + 1) * self._scalars]) if self.loop.implicit else 0.0
        orbit = None if self.whose is None else int(self.whose[block * number.lanes + lane])
        state = state if rows is None else state[list(rows)]
        return _complaint(self.loop, self.t0 + first * self.h, first + 1, state, change, orbit)


def _complaint(
    loop: Loop, t: float, step: int, state: Array, change: float, orbit: int | None
) -> NonFiniteStateError:
    if change:
        what = f"{loop.iterated} of step {step} do not converge (last change {change:.2g})"
        why = loop.remedy
    else:
        what = f"the state stops being finite in step {step}"
        why = "a collision or the edge of H's domain; stop earlier, or take a smaller step or Taylor()"
    which = "" if orbit is None else f" of orbit {orbit}"
    return NonFiniteStateError(f"{what}{which}, after {time_and_state(t, state)}: {why}", t, state)


def _changes(record: Memory) -> Array:
    """Return sums and bounds of changes from records of shape (…, entries, parts) as doubles."""
    return record[..., 1:, :].sum(axis=-1).astype(np.float64)
