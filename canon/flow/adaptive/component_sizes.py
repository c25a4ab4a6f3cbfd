"""Sizes of states: what DOP853 takes its tolerance for parts of.

SciPy's absolute tolerance is in whatever unit the state has: 1e-12 m is much for an electron in its orbit. Here it is a
part of the largest number that the coordinates have had so far, and of the momenta likewise, though of no more than 1,
so that it is never wider than SciPy's. One number for all coordinates lets one that is nothing but rounding beside
others, as the middle of a chain that is held by symmetry, not make the steps short.
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
    count = 2 if system.canonical and not system.spare else 1
    begun, reached = (np.abs(np.split(each, count)).max(axis=1) for each in (start, largest))
    begun[begun == 0] = begun.max() or 1.0
    return np.minimum(np.repeat(np.maximum(begun, reached), len(start) // count), 1.0)
