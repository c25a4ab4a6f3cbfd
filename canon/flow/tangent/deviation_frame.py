"""Frames of deviations: the vectors that start beside an orbit, drawn at random from a seed or given."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from canon.array import Array

__all__ = ["given_frame", "random_frame", "random_vectors"]


def random_frame(size: int, vectors: int, seed: int) -> Array:
    """Return the first columns of a random orthogonal matrix, symplectic too where that can be, shape (size, vectors).

    Of a whole frame the last column is conjugate to the first, the last but one to the second, and so on: then the
    diagonal of R in every QR decomposition of what a symplectic map makes of it has pairs r_i r_{2n+1−i} = 1. This is
    Iwasawa's decomposition of the symplectic group: the orthogonal factor is unitary, the triangular one symplectic.

    Parameters
    ----------
    size, vectors
        2n, or an odd number as on a Poisson manifold, and how many columns.
    seed
        Of NumPy's generator of random numbers.

    Examples
    --------
    >>> frame = random_frame(4, 4, seed=1)
    >>> bool(abs(frame.T @ frame - np.eye(4)).max() < 1e-15)
    True
    """
    if size % 2:
        return random_vectors(size, vectors, seed)
    n = size // 2
    random = np.random.default_rng(seed)
    unitary, _ = np.linalg.qr(random.standard_normal((n, n)) + 1j * random.standard_normal((n, n)))
    real, imaginary = np.real(unitary), np.imag(unitary)
    first = np.concatenate([real, imaginary])
    conjugate = np.concatenate([-imaginary, real])
    return np.ascontiguousarray(np.concatenate([first, conjugate[:, ::-1]], axis=1)[:, :vectors])


def random_vectors(size: int, vectors: int, seed: int) -> Array:
    """Return vectors of length 1 in random directions, linearly independent, shape (size, vectors)."""
    frame, _ = np.linalg.qr(np.random.default_rng(seed).standard_normal((size, vectors)))
    return np.ascontiguousarray(frame)


def given_frame(given: npt.ArrayLike, size: int) -> Array:
    """Return a deviation vector, or several as columns, that a user gives, each of length 1.

    Raises
    ------
    ValueError
        The shape is wrong, or a vector is zero or not finite.

    Examples
    --------
    >>> given_frame([3.0, 4.0], 2).ravel()
    array([0.6, 0.8])
    >>> given_frame([0.0, 0.0], 2)
    Traceback (most recent call last):
        ...
    ValueError: deviation vector 0 is zero: what does not deviate does not part; give another, or leave it out
    """
    frame = np.asarray(given, dtype=np.float64)
    frame = frame.reshape(-1, 1) if frame.ndim == 1 else frame
    if frame.ndim != 2 or len(frame) != size or not 1 <= frame.shape[1] <= size:
        raise ValueError(
            f"deviation vectors of shape {np.shape(given)}: give one, shape ({size},), or up to {size} as columns"
        )
    if not np.isfinite(frame).all():
        raise ValueError("a deviation vector is not finite: give finite numbers")
    largest = np.abs(frame).max(axis=0)
    if not largest.all():
        raise ValueError(
            f"deviation vector {int(np.argmin(largest))} is zero: what does not deviate does not part; give another, "
            "or leave it out"
        )
    scaled = frame / largest
    return scaled / np.linalg.norm(scaled, axis=0)
