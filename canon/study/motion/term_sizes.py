"""Sizes of terms along a motion: beside what an error is large, and whether a quantity is more than their rounding.

Errors are relative to a quantity's value at the start, unless that is nothing beside the terms that it is the sum of:
a pendulum released from the horizontal has the energy −mgl cos(π/2), 6e-17 of these. It is decided here for all, and
runs made of parts carry it with them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.expression.graph.number_systems import FLOAT64
from canon.flow.run.values_at_states import energy_and_rates
from canon.study.motion.observables import ENERGY, Observable, counts_as_zero

if TYPE_CHECKING:
    from canon.array import Array
    from canon.flow.trajectory import Trajectory
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["TermSizes", "error_unit", "terms_along"]

LOOKED_AT = 64
"""States of a motion at which the size of terms is looked at."""


@dataclass(frozen=True)
class TermSizes:
    """How large Σ|y ∂I/∂y| of a quantity I is over the parts of a run; 0 where it is not known.

    Parameters
    ----------
    parts
        Parts looked at.
    mean, square
        Its mean, and its root mean square.

    Examples
    --------
    >>> TermSizes().with_part(np.array([3.0, 3.0])).with_part(np.array([1.0]))
    TermSizes(parts=2, mean=2.0, square=2.236...)
    """

    parts: int = 0
    mean: float = 0.0
    square: float = 0.0

    def with_part(self, terms: Array) -> TermSizes:
        """Return the sizes with those of one more part."""
        most, share = float(terms.max()), 1.0 / (self.parts + 1)
        square = most * math.sqrt(float(np.mean((terms / most) ** 2))) if most else 0.0
        return TermSizes(
            self.parts + 1,
            (1.0 - share) * self.mean + share * float(np.mean(terms)),
            math.hypot(math.sqrt(1.0 - share) * self.square, math.sqrt(share) * square),
        )


def terms_along(motion: Trajectory, name: str, orbit: int = 0) -> Array:
    """Return Σ|y ∂I/∂y| at some states, the first of them the start: what rounding y by a part u does to I, over u.

    Parameters
    ----------
    motion
        The motion.
    name
        ``"energy"``, or one of the observables that it follows. Where forces do work, the energy less the work W takes
        the energy's place, and W is one of the y: it is rounded as they are.
    orbit
        Which of many orbits.
    """
    record, places = motion.record, np.unique(np.linspace(0, len(motion.t) - 1, LOOKED_AT).astype(int))
    system, whole, t = record.task.system, record.whole.y, motion.t[places]
    states = whole[:, places, orbit] if whole.ndim == 3 else whole[:, places]
    if name == ENERGY and system.sums:  # written out they may be millions
        velocity, force = np.split(np.asarray(energy_and_rates(system, states, t, FLOAT64)[1:]), 2)
        sizes = np.abs(states * np.concatenate([force, velocity]))[system.rows]
        return np.nan_to_num(np.sum(sizes, axis=0), nan=0.0, posinf=0.0)
    works = record.moving is not None and record.moving.work is not None
    rows = (
        [*system.rows, len(system.q) - system.varying] if works else system.rows
    )  # parameters are no part of y
    node = None if name == ENERGY else system.node_of(record.task.observed[record.task.names.index(name)])
    point = dict(zip(system.inputs, (*states, t), strict=True))
    with np.errstate(all="ignore"):
        slopes = system.graph.evaluate(_slopes(system, node, rows), point, FLOAT64)
        terms = [np.abs(states[row] * np.asarray(slope)) for row, slope in zip(rows, slopes, strict=True)]
    return np.nan_to_num(np.sum(terms, axis=0), nan=0.0, posinf=0.0)  # √x has no slope at 0


def _slopes(system: HamiltonEquations, node: int | None, rows: list[int]) -> tuple[int, ...]:
    """Return the nodes of ∂I/∂y, of H but for signs: Hamilton's equations have them."""
    if node is None and system.canonical:
        both = (*system.force, *system.velocity)
        return tuple(both[row] for row in rows)
    of = system.hamiltonian if node is None else node
    return tuple(system.graph.gradient(of, [system.inputs[row] for row in rows]))


def error_unit(
    motion: Trajectory, observable: str | Observable, terms: Array, orbit: int = 0
) -> tuple[float, bool]:
    """Return what changes of a quantity are divided by, and whether that makes them relative.

    Parameters
    ----------
    motion
        The motion.
    observable
        ``"energy"``, an observable that it follows, or one of a study, which brings its unit.
    terms
        Its terms (:func:`terms_along`).
    orbit
        Which of many orbits.
    """
    name = observable if isinstance(observable, str) else observable.name
    if isinstance(observable, Observable) and name != ENERGY:
        return observable.unit, observable.relative
    values = motion.energy if name == ENERGY else motion.observables[name]
    at_start = abs(float(np.atleast_1d(values[0])[orbit]))
    relative = motion.relative if name == ENERGY else not counts_as_zero(at_start, float(terms[0]))
    return at_start if relative else 1.0, relative
