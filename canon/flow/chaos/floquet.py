"""Floquet multipliers of a periodic orbit: eigenvalues of its monodromy matrix, Krein signs, linear stability.

On the quotient of the energy surface by the orbit the monodromy matrix M is symplectic of size 2n − 2; its
eigenvalues are those of M without the double 1 that every orbit of an autonomous Hamiltonian has, which rounding would
part by the root of its size. With f = J∇H the quotient is the orthogonal complement of f and ∇H, which J maps to
itself.

Sources: V. I. Arnold, Mathematical Methods of Classical Mechanics, 2nd ed., §42; M. G. Krein (1950), in
V. A. Yakubovich, V. M. Starzhinskii, Linear Differential Equations with Periodic Coefficients (1975), III.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from canon.array import Array

__all__ = ["FloquetMultipliers", "floquet_multipliers", "near_double", "symplectic_inverse"]

_ROUNDING = 1e-14
"""Of the square of the largest entry of M, nearly: what its entries are known to."""

_LARGE = 2.0
"""Multipliers above this size are known better than their reciprocals."""


@dataclass(frozen=True, eq=False)
class FloquetMultipliers:
    """Floquet multipliers λ, in pairs λ, 1/λ, by how fast they let neighbours part.

    Parameters
    ----------
    values
        The multipliers but for the two that are 1, shape (2n − 2,), those of the largest size first.
    krein
        Of each on the unit circle, and not at ±1, the sign of −i v†Jv for its vector v: +1 or −1; 0 of others. Two of
        equal sign that meet stay on the circle, of opposite signs they may leave it.
    accuracy
        What λ + 1/λ is known to.
    """

    values: npt.NDArray[np.complex128]
    krein: npt.NDArray[np.int64]
    accuracy: float

    @property
    def indices(self) -> npt.NDArray[np.complex128]:
        """The stability indices λ + 1/λ, one a pair, shape (n − 1,): real and between −2 and 2 on the unit circle."""
        return _paired(self.values + 1 / self.values)

    @property
    def kinds(self) -> tuple[str, ...]:
        """What each pair is: elliptic, hyperbolic, inverse hyperbolic, complex; parabolic where that is not known."""
        return tuple(_kind(complex(index), self.accuracy) for index in self.indices)

    @property
    def stable(self) -> bool | None:
        """Whether neighbours stay near to first order; None where a multiplier is too near to ±1 to tell."""
        kinds = set(self.kinds)
        if kinds & {"hyperbolic", "inverse hyperbolic", "complex"}:
            return False
        return None if "parabolic" in kinds else True


def floquet_multipliers(M: Array, slope: Array | None) -> FloquetMultipliers:
    """Return the multipliers of a monodromy matrix.

    Parameters
    ----------
    M
        The derivative of the flow over one period, shape (2n, 2n).
    slope
        ∇H at the orbit's start, shape (2n,); None where H depends on time, and no multiplier is 1 for certain.

    Examples
    --------
    >>> import numpy as np
    >>> turn = np.array([[0.6, 0.8], [-0.8, 0.6]])  # of an oscillator: e^{±iθ} with cos θ = 0.6
    >>> found = floquet_multipliers(turn, None)
    >>> found.values.round(9).tolist(), found.krein.tolist(), found.kinds
    ([(0.6-0.8j), (0.6+0.8j)], [-1, 1], ('elliptic',))
    """
    n = len(M) // 2
    J, basis = _form(n), np.eye(2 * n)
    if slope is not None:
        both = np.stack([slope, J @ slope], axis=1)
        basis = np.linalg.svd(both)[0][:, 2:]
    reduced, form = basis.T @ M @ basis, basis.T @ J @ basis
    accuracy = _ROUNDING * float(np.abs(M).max(initial=1.0)) ** 1.5 * n
    values, vectors = (part.astype(np.complex128) for part in np.linalg.eig(reduced))
    order = np.lexsort((values.imag, -np.abs(values).round(6)))
    values, vectors = _with_reciprocals(values[order]), vectors[:, order]
    signs = [_krein(complex(value), vectors[:, k], form, accuracy) for k, value in enumerate(values)]
    return FloquetMultipliers(values, np.array(signs, dtype=np.int64), accuracy)


def _with_reciprocals(values: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    """Return the multipliers, small ones as reciprocals of large ones: rounding leaves nothing of theirs below its own.

    An eigenvalue is known to the rounding of the largest entry of M, which is more than all of 1/λ where λ > 10⁸.
    """
    found, left = values.copy(), list(range(len(values)))
    while left and abs(values[left[0]]) > _LARGE:
        inverse = 1 / values[left.pop(0)]
        partner = min(left, key=lambda k: abs(values[k] - inverse))
        found[partner] = inverse
        left.remove(partner)
    return found


def symplectic_inverse(M: Array) -> Array:
    """Return M⁻¹ = −J Mᵀ J of a symplectic matrix, exactly.

    Examples
    --------
    >>> import numpy as np
    >>> symplectic_inverse(np.array([[1.0, 2.0], [0.0, 1.0]])).tolist()
    [[1.0, -2.0], [0.0, 1.0]]
    """
    J = _form(len(M) // 2)
    return -J @ M.T @ J + 0.0


def _form(n: int) -> Array:
    return np.block([[np.zeros((n, n)), np.eye(n)], [-np.eye(n), np.zeros((n, n))]])


def _krein(value: complex, vector: npt.NDArray[np.complex128], form: Array, accuracy: float) -> int:
    if _kind(value + 1 / value, accuracy) != "elliptic":
        return 0
    return int(np.sign((-1j * (vector.conj() @ form @ vector)).real))


def near_double(accuracy: float) -> float:
    """Return how far from ±2 rounding may bring an index that is there, as a double root; so of two that are equal."""
    return accuracy + float(np.sqrt(accuracy)) * 0.1


def _kind(index: complex, accuracy: float) -> str:
    """Return what a pair is; at ±2 a double root, which rounding moves by the root of its size."""
    near = near_double(accuracy)
    if abs(abs(index.real) - 2) <= near and abs(index.imag) <= near:
        return "parabolic"
    if abs(index.imag) > near:
        return "complex"
    if index.real > 2:
        return "hyperbolic"
    return "inverse hyperbolic" if index.real < -2 else "elliptic"


def _paired(indices: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    """Return one of each two indices that belong together, which are equal but for rounding."""
    left, found = list(indices), list[complex]()
    while left:
        first = left.pop(0)
        partner = min(range(len(left)), key=lambda k: abs(left[k] - first), default=None)
        found.append(first if partner is None else (first + left.pop(partner)) / 2)
    return np.array(found, dtype=np.complex128)
