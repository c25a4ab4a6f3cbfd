"""Compiled deviations: orbits and the vectors beside them go from sample to sample, renormalised on the way."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.fixed_step.compiled_loop import steps_between
from canon.flow.fixed_step.loop_buffers import LoopBuffers
from canon.flow.fixed_step.partial_step import coefficient_pairs
from canon.flow.method.number_formats import fixed_precision
from canon.flow.run.non_finite_state import NonFiniteStateError, time_and_state
from canon.flow.tangent.tangent_loop import tangent_loop
from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.loops.renormalising_loop import renormalising_function

if TYPE_CHECKING:
    import numpy.typing as npt

    from canon.array import Array
    from canon.flow.task import Task

__all__ = ["CompiledDeviations"]

_FIRST, _LONGEST = 8, 1 << 12
"""Steps between renormalisations: at first, and at most."""

_LOST, _PLENTY = 1e-8, 1e-3
"""Parts of a squared length that are left when earlier vectors are taken out: below the one, four digits are
gone and the steps are taken again with more renormalisations; above the other, fewer will do."""

_SMALL = 10.0
"""Logarithm of the growth between two renormalisations up to which fewer will do."""


class CompiledDeviations:
    """Orbits on their way with deviation vectors beside them.

    Parameters
    ----------
    task
        The motion, by a method that has a tangent loop.
    frame
        The deviations at the start, shape (2n, vectors): of the coordinates that lengths are measured in, as the
        tangent loop has them, or of (q, p) where they are given.
    orthogonal
        Whether they are kept orthonormal; else each keeps its own direction and gets the length 1.
    orbits
        Which of the task's orbits; filled up to whole blocks.
    given
        Whether they are of (q, p).

    Raises
    ------
    ValueError
        The numbers are no doubles; or H does not split.
    """

    def __init__(
        self,
        task: Task,
        frame: Array,
        *,
        orthogonal: bool,
        orbits: npt.NDArray[Any] | None = None,
        given: bool = False,
    ) -> None:
        many = task.states[0].shape[1]
        precision = fixed_precision(task.precision)
        if precision.number != DOUBLE:
            raise ValueError(
                f"precision={precision.name!r}: deviations are moved in doubles; leave precision out, or 'double'"
            )
        assert task.plan.h is not None
        step = float(task.plan.h)
        self.tangent = tangent_loop(task.system, task.method, precision, frame.shape[1], many, step=step)
        loop, deviations = self.tangent.loop, self.tangent.deviations
        chosen = np.arange(many) if orbits is None else orbits
        self.orbits, lanes = len(chosen), loop.number.lanes
        filled = chosen[np.minimum(np.arange(-(-len(chosen) // lanes) * lanes), len(chosen) - 1)]
        pairs = coefficient_pairs(
            steps_between(loop, task.method, task.plan).coefficients, task.plan.start, task.plan.h
        )
        high, low = (part[:, filled] for part in task.states)
        self.buffers = LoopBuffers(loop, high, low, pairs)
        if given and self.tangent.units:
            frame = frame * np.array(self.tangent.units)[:, np.newaxis]
            frame = frame / np.linalg.norm(frame, axis=0)
        self._behind(self.buffers.e)[:] = self._packed(frame)
        self.rows = task.system.rows
        self.renormalise = renormalising_function(deviations, orthogonal=orthogonal)
        self.stops, self.sample, self.every = task.plan.stops, 0, _FIRST
        blocks, width = self.buffers.blocks, lanes * deviations.lanes
        self.logs = np.empty((blocks, deviations.groups, 2, width))
        self.least = np.empty((blocks, width))

    def _behind(self, e: Array) -> Array:
        """Return the deviations in e, shape (blocks, numbers)."""
        return e[:, self.tangent.deviations.before * self.buffers.loop.number.lanes :]

    def _packed(self, frame: Array) -> Array:
        """Return a frame as it lies in memory: by groups, components, lanes."""
        d, lanes = self.tangent.deviations, self.buffers.loop.number.lanes
        filled = np.zeros((d.size, d.groups * d.lanes))
        filled[:, : frame.shape[1]] = frame
        grouped = filled.reshape(d.size, d.groups, d.lanes).transpose(1, 0, 2)
        return np.repeat(grouped.ravel(), lanes)

    def advance(self) -> Array:
        """Go to the next sample and return ln of how the vectors have grown, shape (vectors, orbits).

        Raises
        ------
        NonFiniteStateError
            The only orbit has left the finite numbers; of many orbits those that have give NaN.
        """
        first, steps = self.stops[self.sample], self.stops[self.sample + 1] - self.stops[self.sample]
        y, e = self.buffers.y.copy(), self.buffers.e.copy()
        while True:
            growth, left = self._attempt(first, steps)
            known = np.isfinite(growth).all(axis=0)
            good = left > _LOST and not (~known & np.isfinite(self.states()).all(axis=0)).any()
            if good or self.every == 1:
                break
            self.every = max(1, self.every // 8)
            self.buffers.y[:], self.buffers.e[:] = y, e
        if self.orbits == 1 and not self.buffers.finite():
            raise self.buffers.lost(y, e, first, steps, self.rows)
        if self.orbits == 1 and not known.all():
            raise self._deviations_lost(first)
        largest = np.abs(growth[:, known]).max(initial=0.0) / -(-steps // self.every)
        if left > _PLENTY and largest < _SMALL and self.every < _LONGEST:
            self.every *= 2
        self.sample += 1
        return growth

    def _deviations_lost(self, first: int) -> NonFiniteStateError:
        t, state = self.buffers.t0 + first * self.buffers.h, self.states()[:, 0]
        return NonFiniteStateError(
            f"the deviations stop being finite after {time_and_state(t, state)}, the orbit does not: neighbours part "
            "too fast for this step, or an implicit method's stages do not converge for them; take a smaller step",
            t,
            state,
        )

    def _attempt(self, first: int, steps: int) -> tuple[Array, float]:
        """Take steps, and return the growth and the least part of a squared length that was left."""
        self.logs[:], self.least[:] = 0.0, 1.0
        buffers = self.buffers
        self.renormalise.call(
            buffers.loop.code.address, *(x.ctypes.data for x in (buffers.y, buffers.e, buffers.c)),
            first, steps, self.every, buffers.blocks, self.logs.ctypes.data, self.least.ctypes.data,
        )  # fmt: skip
        d = self.tangent.deviations
        total = self.logs.sum(axis=2)  # blocks, groups, width
        if d.lanes > 1:
            return total.reshape(-1, 1)[: d.vectors], float(self.least.min())
        return total.transpose(1, 0, 2).reshape(d.groups, -1)[:, : self.orbits], float(self.least.min())

    def vectors(self) -> Array:
        """Return the deviations, shape (2n, vectors, orbits)."""
        d, lanes = self.tangent.deviations, self.buffers.loop.number.lanes
        lying = self._behind(self.buffers.e).reshape(self.buffers.blocks, d.groups, d.size, d.lanes, lanes)
        ordered = lying.transpose(2, 1, 3, 0, 4).reshape(d.size, d.groups * d.lanes, -1)
        return ordered[:, : d.vectors, : self.orbits].copy()

    def states(self) -> Array:
        """Return the states, shape (2n, orbits)."""
        return self.buffers.states()[0][self.rows, : self.orbits]
