"""Variational deviations: vectors carried by any engine as part of a larger system, renormalised between stretches."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.integrate import integrate
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.run.sampling_plan import Sampling, adaptive_plan, fixed_plan
from canon.flow.tangent.deviation_units import deviation_units
from canon.flow.tangent.taylor_stretches import TaylorStretches
from canon.kernel.program.variational import of_all_variables, variational

if TYPE_CHECKING:
    import numpy.typing as npt

    from canon.array import Array
    from canon.flow.run.sampling_plan import Plan
    from canon.flow.task import Task

__all__ = ["VariationalDeviations"]

_LOST, _PLENTY = 1e-4, 3e-2
"""Parts of a length that are left when earlier vectors are taken out: below the one, four digits are gone and
the stretch is passed again in shorter ones; above the other, longer ones will do."""

_SMALL, _SHORTEST = 10.0, 4096
"""Logarithm of a growth up to which longer stretches will do; stretches in which a sample is tried at most."""


class VariationalDeviations:
    """Orbits on their way with deviation vectors beside them, each integrated with its vectors as one system.

    Parameters
    ----------
    task
        The motion.
    frame
        The deviations at the start, shape (2n, vectors).
    orthogonal
        Whether they are kept orthonormal; else each keeps its own direction and gets the length 1.
    orbits
        Which of the task's orbits.
    given
        Whether the deviations are of (q, p), as they are here in any case.
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
        del given  # lengths are those of (q, p)
        self.task, self.orthogonal, self.rows = task, orthogonal, task.system.rows
        # Parameters that differ from orbit to orbit stand in the state: they have deviations too, which stay 0.
        self.larger = variational(of_all_variables(task.system), frame.shape[1])
        self.taylor = TaylorStretches.of(task, self.larger)
        chosen = np.arange(task.states[0].shape[1]) if orbits is None else orbits
        self.high, self.low = (part[:, chosen].copy() for part in task.states)
        self.unit = self._units() if orthogonal and len(chosen) else np.ones(len(frame))
        self.frames = np.repeat((frame * self.unit[:, np.newaxis])[:, :, np.newaxis], len(chosen), axis=2)
        self.sample, self.parts = 0, [1] * len(chosen)

    def advance(self) -> Array:
        """Go to the next sample and return ln of how the vectors have grown, shape (vectors, orbits).

        Raises
        ------
        NonFiniteStateError
            The only orbit has left the finite numbers; of many orbits those that have give NaN.
        """
        _, vectors, orbits = self.frames.shape
        growth = np.zeros((vectors, orbits))
        for k in range(orbits):
            try:
                growth[:, k] = self._one(k)
            except NonFiniteStateError:
                if orbits == 1:
                    raise
                growth[:, k] = self.high[:, k] = np.nan
        self.sample += 1
        return growth

    def vectors(self) -> Array:
        """Return the deviations, shape (2n, vectors, orbits)."""
        return self.frames.copy()

    def states(self) -> Array:
        """Return the states, shape (2n, orbits)."""
        return self.high[self.rows]

    def _units(self) -> Array:
        """Return the sizes of deviations that are kept orthonormal."""
        begin = float(self.task.plan.instants[0])
        return deviation_units(self.task.system, self.high[:, 0], begin)[self.rows]

    def _one(self, k: int) -> Array:
        """Go to the next sample with one orbit, in as many stretches as its deviations ask for."""
        if not np.isfinite(self.high[:, k]).all():
            return np.full(self.frames.shape[1], np.nan)
        start = self.high[:, k].copy(), self.low[:, k].copy(), self.frames[:, :, k].copy()
        while True:
            try:
                growth, left, largest = self._stretches(k)
            except NonFiniteStateError:
                if self.parts[k] >= _SHORTEST:
                    raise
                growth, left, largest = np.array([np.nan]), 0.0, 0.0
            if left > _LOST or self.parts[k] >= _SHORTEST:
                break
            self.high[:, k], self.low[:, k], self.frames[:, :, k] = start
            self.parts[k] *= 8
        if left > _PLENTY and largest < _SMALL:
            self.parts[k] = max(1, self.parts[k] // 2)
        return growth

    def _stretches(self, k: int) -> tuple[Array, float, float]:
        growth, left, largest = np.zeros(self.frames.shape[1]), 1.0, 0.0
        for plan in _parts_of(self.task.plan, self.sample, self.parts[k]):
            moved = self._moved(k, plan) / self.unit[:, np.newaxis]
            before = np.linalg.norm(moved, axis=0)
            if self.orthogonal:
                frame, triangle = np.linalg.qr(moved)
                lengths = np.diag(triangle)
                self.frames[:, :, k] = frame * np.sign(lengths) * self.unit[:, np.newaxis]
                lengths = np.abs(lengths)
            else:
                lengths = before
                self.frames[:, :, k] = moved / lengths
            if not lengths.all():
                raise NonFiniteStateError(
                    "a deviation has shrunk to 0", float(plan.instants[-1]), self.high[:, k]
                )
            growth += np.log(lengths)
            left = min(left, float((lengths / before).min()))
            largest = max(largest, float(np.abs(np.log(lengths)).max()))
        return growth, left, largest

    def _moved(self, k: int, plan: Plan) -> Array:
        """Move one orbit along a plan, and return its deviations, not renormalised."""
        n, vectors = len(self.task.system.q), self.frames.shape[1]
        frame = np.zeros((2 * n, vectors))
        frame[self.rows] = self.frames[:, :, k]
        beside = frame.reshape(2, n, vectors).swapaxes(1, 2).reshape(2, vectors * n)
        high = np.concatenate([self.high[:, k].reshape(2, n), beside], axis=1).ravel()
        low = np.concatenate([self.low[:, k].reshape(2, n), 0 * beside], axis=1).ravel()
        if self.taylor is not None:
            y, carried = self.taylor.moved(high, low, plan)
        else:
            states = high[:, np.newaxis], low[:, np.newaxis]
            found = integrate(replace(self.task, system=self.larger, states=states, plan=plan, single=True))
            y, carried = found.y[:, -1, 0], found.carried[:, -1, 0]
        halves = y.reshape(2, -1)
        self.high[:, k] = halves[:, :n].ravel()
        self.low[:, k] = carried.reshape(2, -1)[:, :n].ravel()
        return halves[:, n:].reshape(2, vectors, n).swapaxes(1, 2).reshape(2 * n, vectors)[self.rows]


def _parts_of(plan: Plan, sample: int, parts: int) -> list[Plan]:
    """Return plans that lead from a sample to the next one in so many stretches, or as many as there are steps."""
    if plan.h is not None:
        ends = np.linspace(plan.stops[sample], plan.stops[sample + 1], parts + 1).round().astype(int)
        whole = np.unique(ends).tolist()
        return [fixed_plan(plan.start + a * plan.h, plan.h, (0, b - a)) for a, b in pairwise(whole)]
    begin, end = plan.last(sample), plan.last(sample + 1)
    exact = [begin + (end - begin) * j / parts for j in range(parts + 1)]
    return [adaptive_plan(Sampling(a, b, 1)) for a, b in pairwise(exact)]
