"""Running a compiled loop: in slices, with progress, up to the last finite state."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.array import Array
from canon.flow.fixed_step.loop_buffers import LoopBuffers, LoopObservables, Memory

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy.typing as npt

    from canon.kernel.llvm.loop import Loop

__all__ = ["AdvancedStates", "Interruption", "advance_orbits"]

_SLICE_SECONDS = 0.1
"""Between calls of compiled code Python can handle an interruption and report progress."""

_MANY = 2048
"""From so many samples on, a run is worth the 10 ms for which the loop that takes them in one call is compiled."""

_KEPT_NUMBERS = 1 << 16
"""So many numbers of states are kept as the loop has them before they are brought into order."""


class Interruption(Exception):
    """Tells a thread to end its run at once and hand over what it has."""


@dataclass(frozen=True)
class AdvancedStates:
    """States at the wanted steps, and what they cost.

    Parameters
    ----------
    high, low
        The states are high + low, shape (2n, times, orbits).
    watched
        Where observables were watched: of each interval between two stops, orbit and observable the sum, the
        least and the greatest change, shape (times − 1, orbits, observables, 3).
    beyond
        What an implicit method kept beyond each state, shape (times, blocks, …).
    iterations
        Iterations of an implicit method, 0 of others.
    cpu_seconds
        Processor time of this thread.
    """

    high: Array
    low: Array
    watched: Array | None
    beyond: Memory
    iterations: int
    cpu_seconds: float

    def first(self, samples: int) -> AdvancedStates:
        """Return the first so many samples of this run."""
        if samples == self.high.shape[1]:
            return self
        watched = None if self.watched is None else self.watched[: samples - 1]
        high, low = self.high[:, :samples], self.low[:, :samples]
        return AdvancedStates(high, low, watched, self.beyond[:samples], self.iterations, self.cpu_seconds)


def advance_orbits(
    loop: Loop,
    high: Array,
    low: Array,
    coefficients: tuple[Array, Array],
    stops: Sequence[int],
    progress: Callable[[float], None] = lambda _: None,
    watch: LoopObservables | None = None,
    memory: Memory | None = None,
    rows: Sequence[int] | None = None,
    whose: npt.NDArray[np.int64] | None = None,
    many: int = _MANY,
) -> AdvancedStates:
    """Advance orbits step by step and keep their states at the wanted step numbers.

    An interruption (Ctrl-C, or :class:`Interruption` from ``progress``) ends the run at its last stop: fewer
    samples than stops come back.

    Parameters
    ----------
    loop
        The compiled loop.
    high, low
        The states at the first stop are high + low, shape (2n, orbits); orbits a multiple of the loop's lanes.
    coefficients
        t0, h and the method's coefficients times h, likewise as sums of two doubles.
    stops
        Rising step numbers at which to keep the states; the first is where the motion is, the last is the end.
    progress
        Called now and then with the fraction done, 0 … 1.
    watch
        Observables to follow between the stops.
    memory
        What an implicit method kept beyond the state, where a run is resumed.
    rows
        The components that are coordinates and momenta, for messages.
    whose
        The numbers of the orbits, where these are some of many, for messages.
    many
        From so many stops on, they are passed in compiled code; the states are the same bit for bit.

    Raises
    ------
    NonFiniteStateError
        A state is not finite; the error knows the last finite one.
    """
    buffers = LoopBuffers(loop, high, low, coefficients, watch, memory, whose)
    rows_kept = _Rows(buffers, len(stops))
    started, slices = time.thread_time(), _Slices(buffers, stops[0], stops[-1], rows, progress)
    one_by_one = len(stops) < many
    numbers = np.array(() if one_by_one else stops, dtype=np.int64)
    try:
        while (sample := rows_kept.count) < len(stops):
            ahead = 0 if one_by_one else slices.stops_ahead(numbers[sample : sample + rows_kept.room])
            if sample and ahead > 1:
                slices.go_through(numbers[sample : sample + ahead], rows_kept)
                continue
            slices.go_to(stops[sample])
            rows_kept.keep()
    except (KeyboardInterrupt, Interruption):
        if not rows_kept.count:
            raise
        slices.check_finite()
    kept, beyond = rows_kept.all()
    found = AdvancedStates(
        kept[0],
        kept[1],
        rows_kept.watched,
        beyond,
        int(beyond[-1][:, 0].sum()) if loop.implicit else 0,
        time.thread_time() - started,
    )
    return found.first(rows_kept.count)


class _Slices:
    """A loop that goes on in slices of about a tenth of a second; at the end of each the state must be finite.

    Parameters
    ----------
    buffers
        The loop and its state.
    first, last
        The step numbers at which the motion stands, and at which it ends.
    rows
        The components that are coordinates and momenta, for messages.
    progress
        Called after each slice with the fraction done.
    """

    def __init__(
        self,
        buffers: LoopBuffers,
        first: int,
        last: int,
        rows: Sequence[int] | None,
        progress: Callable[[float], None],
    ) -> None:
        self.buffers, self.rows, self.progress = buffers, rows, progress
        self.done, self.last, self.steps = first, last, 64
        self._begin()

    def go_to(self, stop: int) -> None:
        """Take all steps up to one, and end the slices that are complete."""
        while self.done < stop:
            steps = min(self.begun + self.steps, stop) - self.done
            self.buffers.advance(self.done, steps)
            self.done += steps
            if self.done - self.begun == self.steps or self.done == self.last:
                self._end()

    def stops_ahead(self, stops: Memory) -> int:
        """Return how many of the next stops lie in this slice."""
        return int(np.searchsorted(stops, self.begun + self.steps, side="right"))

    def go_through(self, stops: Memory, rows: _Rows) -> None:
        """Take all steps up to the last of stops in this slice and keep the states at all of them."""
        rows.keep_many(np.concatenate([[self.done], stops]))
        self.done = int(stops[-1])
        if self.done - self.begun == self.steps or self.done == self.last:
            self._end()

    def check_finite(self) -> None:
        """Make sure that the state is finite; the error has the last one known to be."""
        if not self.buffers.finite():
            raise self.buffers.lost(*self.safe, self.begun, self.done - self.begun, self.rows) from None

    def _begin(self) -> None:
        self.safe, self.begun = (self.buffers.y.copy(), self.buffers.e.copy()), self.done
        self.clock = time.perf_counter()

    def _end(self) -> None:
        self.check_finite()
        spent = time.perf_counter() - self.clock
        if self.done - self.begun == self.steps and spent < _SLICE_SECONDS / 2:
            self.steps *= 2
        elif spent > _SLICE_SECONDS and self.steps > 1:
            self.steps //= 2
        self.progress(self.done / self.last)
        self._begin()


class _Rows:
    """The states kept, and what was watched between them: copies of memory, brought into order many at a time.

    Parameters
    ----------
    buffers
        The buffers.
    samples
        How many there will be.
    """

    def __init__(self, buffers: LoopBuffers, samples: int) -> None:
        self.buffers, self.count, self._ordered = buffers, 0, 0
        self._kept = np.empty((2, buffers.size, samples, buffers.orbits))
        at_once = max(1, min(samples, _KEPT_NUMBERS // buffers.y.size))
        self._y = np.empty((at_once, *buffers.y.shape), dtype=buffers.y.dtype)
        self._e = np.empty((at_once, *buffers.e.shape), dtype=buffers.e.dtype)
        self._beyond = np.empty((samples, *buffers.beyond_in(buffers.e).shape), dtype=buffers.e.dtype)
        self._watched = list[Array]()

    @property
    def watched(self) -> Array | None:
        """What was watched between the states kept, shape (times − 1, orbits, observables, 3)."""
        if self.buffers.watch is None:
            return None
        orbits, observables, _ = self.buffers.watch.start.shape
        return np.concatenate([np.empty((0, orbits, observables, 3)), *self._watched])

    def keep(self) -> None:
        """Keep the state that the buffers has reached."""
        place = self.count - self._ordered
        if place == len(self._y):
            self._order()
            place = 0
        self._y[place], self._e[place] = self.buffers.y, self.buffers.e
        if self.count and self.buffers.watch is not None:
            self._watched.append(self.buffers.watched()[np.newaxis])
        self.count += 1

    @property
    def room(self) -> int:
        """How many states there is memory for before they are brought into order; then all of it."""
        return len(self._y) - (self.count - self._ordered) or len(self._y)

    def keep_many(self, stops: Memory) -> None:
        """Let the buffers go from stop to stop and keep their states at all but the first."""
        if self.count - self._ordered == len(self._y):
            self._order()
        place = self.count - self._ordered
        watched = self.buffers.sample(stops, self._y[place:], self._e[place:])
        self.count += len(stops) - 1
        if watched is not None:
            self._watched.append(watched)

    def _order(self) -> None:
        part, new = slice(self._ordered, self.count), self.count - self._ordered
        self._kept[0, :, part], self._kept[1, :, part] = self.buffers.states_in(self._y[:new], self._e[:new])
        self._beyond[part] = self.buffers.beyond_in(self._e[:new])
        self._ordered = self.count

    def all(self) -> tuple[Array, Memory]:
        """Return the states as sums of two doubles, and what implicit methods kept beyond them."""
        self._order()
        return self._kept, self._beyond[: self.count]
