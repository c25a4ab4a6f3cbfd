"""Invariant manifolds of unstable periodic orbits: starts beside the orbit that leave it, or that fall into it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from canon.flow.chaos.floquet import symplectic_inverse
from canon.flow.geometry.flow_jacobian import flow_jacobian

if TYPE_CHECKING:
    from canon.array import Array
    from canon.flow.chaos.periodic_search import PeriodicOrbit

__all__ = ["manifold_starts"]


def manifold_starts(
    orbit: PeriodicOrbit,
    branch: Literal["unstable", "stable"] = "unstable",
    *,
    side: int = 1,
    count: int = 100,
    distance: float = 1e-6,
) -> Array:
    """Return states on a manifold of an orbit, one beside each of so many places on it, shape (2n, count).

    Propagate them forward in time, or backward where the manifold is the stable one: each orbit then draws a curve of
    the manifold. A start errs by the square of the distance.

    Parameters
    ----------
    orbit
        An unstable orbit of an autonomous Hamiltonian.
    branch
        ``"unstable"``: motions that leave the orbit; ``"stable"``: motions that fall into it.
    side
        1 or −1: to which side of the orbit.
    count
        How many places, evenly spaced in time.
    distance
        How far from the orbit, in the norm of the state.

    Raises
    ------
    ValueError
        The orbit has no real multiplier of another size than 1, so that no motion leaves it in a plane.

    Notes
    -----
    The vector at a place is the eigenvector of the monodromy matrix M, or of its inverse, for the multiplier of the
    largest size, carried there by the derivative of the flow, forward or back in time; for a negative multiplier the
    two sides change places from turn to turn.

    Examples
    --------
    >>> from canon.flow import manifold_starts, periodic_orbit
    >>> orbit = periodic_orbit("henon-heiles", [0.01, 0.1, 0.4, 0.1], 6.5)
    >>> manifold_starts(orbit, "unstable", count=8).shape
    (4, 8)
    """
    if branch not in ("unstable", "stable"):
        raise ValueError(f"branch={branch!r}: 'unstable' or 'stable'")
    if side not in (1, -1):
        raise ValueError(f"side={side}: 1 or -1")
    if not {"hyperbolic", "inverse hyperbolic"} & set(orbit.multipliers.kinds):
        raise ValueError(f"{orbit} has no real multiplier but ±1: nothing leaves it along a direction")
    # What is stable grows back in time, where rounding leaves it alone.
    forward = branch == "unstable"
    M, way = (orbit.M, orbit.period) if forward else (symplectic_inverse(orbit.M), -orbit.period)
    values, vectors = (part.astype(np.complex128) for part in np.linalg.eig(M))
    real = np.flatnonzero(abs(values.imag) <= 1e-9 * abs(values))
    vector = vectors[:, real[np.argmax(abs(values[real]))]].real
    request = orbit.search.request
    found = flow_jacobian(
        request.system, (0.0, way), orbit.y, method=request.method, step=request.step,
        tolerance=request.tolerance, parameters=request.parameters, samples=count, sizes=orbit.scale.state,
    )  # fmt: skip
    parts = len(found.t) - 1
    places = np.arange(parts) * (1 if forward else -1) % parts  # in the order of time
    carried = np.einsum("ijk,j->ik", found.M[:, :, places], vector)
    return found.y[:, places] + side * distance * carried / np.linalg.norm(carried, axis=0)
