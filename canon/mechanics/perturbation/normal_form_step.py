"""Homological equation {χ, H₂} = rest of a normal form, term by term: small divisors told, zero ones refused."""

from __future__ import annotations

import operator
from dataclasses import dataclass, field
from math import nan
from typing import TYPE_CHECKING

import sympy as sp

from canon.expression.symbols.user_input import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial

__all__ = [
    "Divisors",
    "Module",
    "SmallDivisor",
    "ZeroDivisorError",
    "homological_solution",
    "weight_of",
    "whole_vector",
]

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
        |k·λ|; NaN where parameters stand in it.
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


def whole_vector(given: Sequence[int], count: int, name: str, of: str) -> Weight:
    """Return a vector of whole numbers, one for each of as many as are counted.

    Raises
    ------
    ValueError
        Where a number is not whole, or there are more or fewer.

    Examples
    --------
    >>> whole_vector([1, -2], 2, "a resonance", "angle")
    (1, -2)
    >>> whole_vector([0.5, -1], 2, "a resonance", "angle")
    Traceback (most recent call last):
        ...
    ValueError: a resonance should have 2 whole numbers, one for each angle, not [0.5, -1]
    """
    try:
        vector = tuple(operator.index(k) for k in given)
    except TypeError:  # also where it is no sequence
        vector = ()
    if len(vector) != count:
        raise ValueError(
            f"{name} should have {counted(count, 'whole number')}, one for each {of}, not {given}"
        )
    return vector


def weight_of(exponents: tuple[int, ...]) -> Weight:
    """Return k with kⱼ the power of aⱼ less that of bⱼ."""
    n = len(exponents) // 2
    return tuple(int(exponents[j] - exponents[n + j]) for j in range(n))  # FLINT counts in its own integers


@dataclass(frozen=True)
class Divisors:
    """The divisors k·λ of a normal form: which terms are kept, and the reciprocals of the others, each found once.

    Parameters
    ----------
    eigenvalues, values
        λ₁ … λₙ exactly, and as numbers; None for one with parameters.
    module
        Which terms are kept; None for those with k·λ = 0.
    """

    eigenvalues: Sequence[PhasePolynomial]
    values: Sequence[complex | None]
    module: Module | None
    reciprocals: dict[str, PhasePolynomial] = field(default_factory=dict, repr=False)
    names: dict[Weight, str | None] = field(default_factory=dict, repr=False)

    def name(self, weight: Weight) -> str | None:
        """Return the text of k·λ, by which its reciprocal is found; None where the term of k is kept.

        Raises
        ------
        ZeroDivisorError
            Where k·λ = 0 for a k that is not in the module.
        """
        if weight not in self.names:
            self.names[weight] = self._name(weight)
        return self.names[weight]

    def modulus(self, weight: Weight) -> float:
        """Return |k·λ|, NaN where parameters stand in it."""
        terms = [None if v is None else k * v for k, v in zip(weight, self.values, strict=True) if k]
        return nan if None in terms else abs(sum(term for term in terms if term is not None))

    def _name(self, weight: Weight) -> str | None:
        ring = self.eigenvalues[0].ring
        if self.module is not None and weight in self.module:
            return None
        divisor = ring.total(value.times(k) for k, value in zip(weight, self.eigenvalues, strict=True))
        if not divisor and self.module is None:
            return None
        if not divisor:
            raise ZeroDivisorError(
                f"the term of k = {weight} has the divisor k·λ = 0 and is not among the resonances; "
                f"name it: resonances=[{weight}], or leave resonances out to keep every such term"
            )
        text = f"({divisor.re} + i ({divisor.im}))/({divisor.den})"
        if text not in self.reciprocals:
            self.reciprocals[text] = divisor.inverse()
        return text


def homological_solution(
    part: PhasePolynomial, divisors: Divisors
) -> tuple[PhasePolynomial, PhasePolynomial, dict[Weight, float]]:
    """Return (kept, χ) with part + {H₂, χ} = kept, and |k·λ| of the k that were divided by.

    Parameters
    ----------
    part
        A polynomial in (a, b).
    divisors
        Those of H₂.

    Raises
    ------
    ZeroDivisorError
        Where k·λ = 0 for a k that is not in the module.
    """
    met: dict[Weight, float] = {}

    def name(exponents: tuple[int, ...]) -> str | None:
        weight = weight_of(exponents)
        found = divisors.name(weight)
        if found is not None and weight not in met:
            met[weight] = divisors.modulus(weight)
        return found

    by_divisor = part.split(name)
    kept = by_divisor.pop(None, part.ring.zero)
    chi = part.ring.total(f * divisors.reciprocals[text] for text, f in by_divisor.items() if text)
    return kept, chi, met
