"""Homological equation {χ, H₂} = rest of a normal form, term by term: small divisors told, zero ones refused."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import sympy as sp

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial

__all__ = ["Module", "SmallDivisor", "ZeroDivisorError", "homological_solution", "weight_of"]

Weight = tuple[int, ...]


class ZeroDivisorError(ZeroDivisionError):
    """A term that should be removed has the divisor zero."""


@dataclass(frozen=True)
class SmallDivisor:
    """A divisor k·λ that a generator was divided by, at a degree.

    Parameters
    ----------
    weight
        k: how often each aⱼ occurs more than its bⱼ.
    value
        |k·λ|.
    degree
        The first degree where it occurred.
    """

    weight: Weight
    value: float
    degree: int


@dataclass(frozen=True)
class Module:
    """Whole vectors k whose terms stay in a normal form: those in the span of some.

    Parameters
    ----------
    resonances
        The vectors that span the module; none where only k = 0 stays.

    Examples
    --------
    >>> (2, -2) in Module(((1, -1),)), (1, 0) in Module(((1, -1),))
    (True, False)
    """

    resonances: tuple[Weight, ...]

    def __contains__(self, weight: Weight) -> bool:
        if not any(weight):
            return True
        if not self.resonances:
            return False
        spanned = sp.Matrix(self.resonances)
        return spanned.rank() == spanned.col_join(sp.Matrix([weight])).rank()


def weight_of(exponents: tuple[int, ...]) -> Weight:
    """Return k with kⱼ the power of aⱼ less that of bⱼ."""
    n = len(exponents) // 2
    return tuple(int(exponents[j] - exponents[n + j]) for j in range(n))  # FLINT counts in its own integers


def homological_solution(
    part: PhasePolynomial,
    eigenvalues: Sequence[PhasePolynomial],
    module: Module | None,
    values: Sequence[complex],
    known: dict[Weight, PhasePolynomial | None],
    divisors: dict[Weight, float],
) -> tuple[PhasePolynomial, PhasePolynomial]:
    """Return (kept, χ) with part + {H₂, χ} = kept.

    Parameters
    ----------
    part
        A homogeneous polynomial in (a, b).
    eigenvalues, values
        λ₁ … λₙ exactly, and as numbers.
    module
        Which terms are kept; None for those with k·λ = 0.
    known
        1/(k·λ) of the k met so far, None of those kept; filled here.
    divisors
        |k·λ| of the k divided by; filled here.

    Raises
    ------
    ZeroDivisorError
        Where k·λ = 0 for a k that is not in the module.
    """
    ring = part.ring
    kept, chi = ring.zero, ring.zero
    for weight, term in part.split(weight_of).items():
        if weight not in known:
            known[weight] = _reciprocal(weight, eigenvalues, module, ring.zero)
        inverse = known[weight]
        if inverse is None:
            kept = kept + term
        else:
            divisors[weight] = abs(sum(k * v for k, v in zip(weight, values, strict=True)))
            chi = chi + term * inverse
    return kept, chi


def _reciprocal(
    weight: Weight, eigenvalues: Sequence[PhasePolynomial], module: Module | None, zero: PhasePolynomial
) -> PhasePolynomial | None:
    divisor = zero
    for k, value in zip(weight, eigenvalues, strict=True):
        divisor = divisor + value.times(k)
    if module is None:
        return divisor.inverse() if divisor else None
    if weight in module:
        return None
    if not divisor:
        raise ZeroDivisorError(
            f"the term of k = {weight} has the divisor k·λ = 0 and is not among the resonances; "
            f"name it: resonances=[{weight}], or leave resonances out to keep every such term"
        )
    return divisor.inverse()
