"""Sizes of states: what DOP853 takes its tolerance for parts of.

SciPy's absolute tolerance is in whatever unit the state has: 1e-12 m is much for an electron in its orbit. Here it is a
part of the largest number that the coordinates have had so far, and of the momenta or velocities likewise, though of
no more than 1, so that it is never wider than SciPy's. One number for all coordinates lets one that is nothing but
rounding beside others, as the middle of a chain that is held by symmetry, not make the steps short.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from canon.array import Array
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["sizes_of"]


def sizes_of(system: HamiltonEquations, largest: Array, start: Array) -> Array:
    """Return for each component of a state the size that its tolerance is a part of.

    A half that starts at zero has no unit yet: it takes that of the other half, and 1 where all is zero. What grows
    from nothing, as under a force that is switched on later, would be followed to all its digits else.

    Parameters
    ----------
    system
        The equations: whether their state has two halves with units of their own.
    largest
        The largest sizes of the components so far.
    start
        The state at the start.

    Examples
    --------
    >>> from canon.flow.checked_request import hamilton_equations_of
    >>> from canon.scene import find
    >>> scene = find("kepler")
    >>> system = hamilton_equations_of(scene.hamiltonian, scene.values)
    >>> start = np.array([1e-10, 0.0, 0.0, 0.0])
    >>> sizes_of(system, np.array([1e-10, 0.0, 0.0, 5.0]), start).tolist()
    [1e-10, 1e-10, 1.0, 1.0]
    """
    n, all_of = len(system.q) - system.varying, len(system.q)
    halves = [slice(n), slice(all_of, all_of + n)] if _has_two_units(system, n) else [system.rows]
    begun = [np.abs(start[half]).max(initial=0.0) for half in halves]
    found = np.ones(len(start))  # of work, which has a unit of its own, and of what stays as it is
    for half, size in zip(halves, begun, strict=True):
        found[half] = max(size or max(begun) or 1.0, largest[half].max(initial=0.0))
    return np.minimum(found, 1.0)


def _has_two_units(system: HamiltonEquations, n: int) -> bool:
    """Tell whether the two halves of a state are coordinates and momenta, or coordinates and their rates."""
    if system.spare:
        return False
    rates = [system.graph.symbol(p) for p in system.p[:n]]
    return system.canonical or [*system.velocity[:n]] == rates
