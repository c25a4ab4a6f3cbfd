"""Time and state at one point of a motion, in wide numbers, and the values of functions there."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.run.observables_along import values_in

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.array import Array
    from canon.kernel.llvm.number_types import MachineType
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["Place"]

_KEPT = 1024


@dataclass(frozen=True, eq=False)
class Place:
    """A time and a state y + carried, each of shape (2n,).

    Parameters
    ----------
    wide
        The numbers in which functions are evaluated.
    t, y, carried
        The time, and the state as a sum of two doubles.
    """

    wide: MachineType
    t: float
    y: Array
    carried: Array

    def values(self, system: HamiltonEquations, nodes: Sequence[int]) -> list[float]:
        """Return what nodes are here."""
        if not nodes:
            return []
        pair = self.y[:, np.newaxis], self.carried[:, np.newaxis]
        with np.errstate(all="ignore"):
            return [float(x.sum()) for x in values_in(self.wide, system, nodes, self.t, *pair)[:, 0]]

    def value(self, system: HamiltonEquations, node: int) -> float:
        """Return what one node is here."""
        return self.values(system, [node])[0]

    def size(self, system: HamiltonEquations, node: int) -> float:
        """Return how large a function would be if nothing cancelled: Σ |∂g/∂y| |y| + |∂g/∂t| |t|, and its terms.

        A variable that vanishes counts for what it becomes in the time in which the state changes by its own size.
        """
        rates = [*system.velocity, *system.force]
        parts, n = _parts(system, node), len(rates)
        found = np.abs(self.values(system, [*rates, *parts]))
        here, speeds = np.abs(self.y), np.nan_to_num(found[:n], posinf=0.0)
        soon = speeds * (here.max() / speeds.max()) if speeds.any() else speeds
        with np.errstate(invalid="ignore"):  # an infinite slope by nothing counts for nothing
            terms = found[n : 2 * n] * np.maximum(here, soon)
        sizes = [*terms, found[2 * n] * abs(self.t), *found[2 * n + 1 :]]
        return float(np.nan_to_num(sizes, nan=0.0, posinf=0.0).sum())


@functools.lru_cache(maxsize=_KEPT)
def _parts(system: HamiltonEquations, node: int) -> tuple[int, ...]:
    """Return the slopes of a node, and the terms that it is the sum of."""
    kind, operands, _ = system.graph.nodes[node]
    return (*system.graph.gradient(node, system.inputs), *(operands if kind == "add" else ()))
