"""Sizes of states: what DOP853 takes its tolerance for parts of.

SciPy's absolute tolerance is in whatever unit the state has: 1e-12 m is much for an electron in its orbit. Here it is a
part of the largest number that the coordinates have had so far, and of the momenta or velocities likewise, though of
no more than 1, so that it is never wider than SciPy's. One number for all coordinates lets one that is nothing but
rounding beside others, as the middle of a chain that is held by symmetry, not make the steps short. A half that starts
at zero is measured by what becomes of it in a moment: an electron at rest at the origin will be some 1e-7 m away.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.array import Array
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["sizes_at_start", "sizes_of"]

_MOMENTS = [2.0**-k for k in range(10, 61, 5)]
"""Parts of a span, one of which is short beside all that happens in it."""

_ALIKE = 2.0**-10
"""Two short steps and one, or states and their neighbours, go on alike where they differ by less than this part."""

_NEIGHBOUR = 2.0**-30


def sizes_at_start(
    system: HamiltonEquations, rate: Callable[[float, Array], Array], t: float, y: Array, span: float
) -> Array:
    """Return what the components of a state are to be measured by at the start, 0 where nothing tells.

    Of a half that starts at zero that is what its rates make of it in a moment, unless they are what rounding left of
    terms that cancel, as at an equilibrium: then they are others in the neighbourhood.

    Parameters
    ----------
    system, rate
        The equations, and their right-hand side f(t, y).
    t, y
        The start.
    span
        From the start to the end.
    """
    sizes, halves = np.abs(y), _halves(system)
    still = [half for half in halves if not sizes[half].any()]
    moment = _moment(rate, t, y, span, halves) if still else None
    if moment is not None:
        moved = np.abs(_after(rate, t, y, moment))
        beside = np.abs(_after(rate, t, y * (1 + _NEIGHBOUR), moment))
        for half in still:
            if np.abs(beside[half] - moved[half]).max(initial=0.0) <= _ALIKE * moved[half].max(initial=0.0):
                sizes[half] = moved[half]
    return sizes


def _moment(
    rate: Callable[[float, Array], Array],
    t: float,
    y: Array,
    span: float,
    halves: Sequence[slice] | Sequence[list[int]],
) -> float | None:
    """Return a time that one Runge–Kutta step and two pass alike."""
    with np.errstate(all="ignore"):
        for part in _MOMENTS:
            step = span * part
            once = _after(rate, t, y, step)
            twice = _after(rate, t + step / 2, _after(rate, t, y, step / 2), step / 2)
            missed, moved = np.abs(once - twice), np.abs(twice - y)
            if np.isfinite(twice).all() and all(
                missed[half].max(initial=0.0) <= _ALIKE * moved[half].max(initial=0.0) for half in halves
            ):
                return step
    return None


def _after(rate: Callable[[float, Array], Array], t: float, y: Array, h: float) -> Array:
    """Return a state one step of Kutta's method later."""
    k1 = np.array(rate(t, y))
    k2 = np.array(rate(t + h / 2, y + h / 2 * k1))
    k3 = np.array(rate(t + h / 2, y + h / 2 * k2))
    k4 = np.array(rate(t + h, y + h * k3))
    return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def sizes_of(system: HamiltonEquations, largest: Array, start: Array) -> Array:
    """Return for each component of a state the size that its tolerance is a part of.

    A half of which nothing is known at the start takes the size of the other half, and 1 where all is zero. What grows
    from nothing, as under a force that is switched on later, would be followed to all its digits else.

    Parameters
    ----------
    system
        The equations: whether their state has two halves with units of their own.
    largest
        The largest sizes of the components so far.
    start
        Sizes at the start, as :func:`sizes_at_start` returns them.

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
    halves = _halves(system)
    begun = [np.abs(start[half]).max(initial=0.0) for half in halves]
    found = np.ones(len(start))  # of work, which has a unit of its own, and of what stays as it is
    for half, size in zip(halves, begun, strict=True):
        found[half] = max(size or max(begun) or 1.0, largest[half].max(initial=0.0))
    return np.minimum(found, 1.0)


def _halves(system: HamiltonEquations) -> list[slice] | list[list[int]]:
    """Return the rows of a state that have a unit in common."""
    n, all_of = len(system.q) - system.varying, len(system.q)
    return [slice(n), slice(all_of, all_of + n)] if _has_two_units(system, n) else [system.rows]


def _has_two_units(system: HamiltonEquations, n: int) -> bool:
    """Tell whether the two halves of a state are coordinates and momenta, or coordinates and their rates."""
    if system.spare:
        return False
    rates = [system.graph.symbol(p) for p in system.p[:n]]
    return system.canonical or [*system.velocity[:n]] == rates
