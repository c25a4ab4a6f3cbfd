"""Numeric polynomials in complex variables: values, gradients and second derivatives in doubles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from canon.cached_property import cached_property

if TYPE_CHECKING:
    from collections.abc import Iterable

    import numpy.typing as npt

    from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial

    Complex = npt.NDArray[np.complex128]

__all__ = ["NumericPolynomial"]


@dataclass(frozen=True)
class NumericPolynomial:
    """A polynomial Σ c z^k.

    Parameters
    ----------
    exponents
        k, of shape (terms, variables).
    coefficients
        c, of shape (terms,).
    """

    exponents: npt.NDArray[np.int64]
    coefficients: Complex

    @classmethod
    def of(cls, parts: Iterable[PhasePolynomial]) -> NumericPolynomial:
        """Return the sum of some polynomials without parameters, to double precision."""
        terms: dict[tuple[int, ...], complex] = {}
        size = 0
        for part in parts:
            size = part.ring.size
            for k, c in part.split(lambda e: tuple(map(int, e))).items():
                shown = c.ring.expression(c.coefficient_alone(), [sp.S.One] * size)
                terms[k] = terms.get(k, 0j) + complex(shown.evalf(20))
        exponents = np.array([*terms], dtype=np.int64).reshape(len(terms), size)
        return cls(exponents, np.array([*terms.values()], dtype=np.complex128))

    @cached_property
    def slopes(self) -> tuple[NumericPolynomial, ...]:
        """The derivatives by each variable."""
        return tuple(self._derivative(j) for j in range(self.exponents.shape[1]))

    def value(self, z: npt.NDArray[np.complex128]) -> complex:
        """Return the value at z."""
        if not len(self.coefficients):
            return 0j
        powers = z[:, None] ** np.arange(int(self.exponents.max()) + 1)
        product = self.coefficients
        for j in range(len(z)):
            product = product * powers[j, self.exponents[:, j]]
        return complex(product.sum())

    def gradient(self, z: npt.NDArray[np.complex128]) -> Complex:
        """Return the derivatives by each of z."""
        return np.array([slope.value(z) for slope in self.slopes])

    def hessian(self, z: npt.NDArray[np.complex128]) -> Complex:
        """Return the second derivatives."""
        return np.array([slope.gradient(z) for slope in self.slopes])

    def _derivative(self, j: int) -> NumericPolynomial:
        kept = self.exponents[:, j] > 0
        lowered = self.exponents[kept]
        factors = lowered[:, j].copy()
        lowered[:, j] -= 1
        return NumericPolynomial(lowered, self.coefficients[kept] * factors)
