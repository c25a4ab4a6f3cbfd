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


def sizes_of(system: HamiltonEquations, state: Array) -> Array:
    """Return for each component of a state the size that its tolerance is a part of.

    Parameters
    ----------
    system
        The equations: whether their state has two halves with units of their own.
    state
        The largest sizes of the components so far.

    Examples
    --------
    >>> from canon.flow.checked_request import hamilton_equations_of
    >>> from canon.scene import find
    >>> scene = find("kepler")
    >>> system = hamilton_equations_of(scene.hamiltonian, scene.values)
    >>> sizes_of(system, np.array([1e-10, 0.0, 0.0, 5.0])).tolist()
    [1e-10, 1e-10, 1.0, 1.0]
    """
    halves = np.split(state, 2) if system.canonical and not system.spare else [state]
    # A half that is zero has no size yet: the first step, which the other half chooses, gives it one.
    found = [np.full(len(half), np.abs(half).max() or 1.0) for half in halves]
    return np.minimum(np.concatenate(found), 1.0)
