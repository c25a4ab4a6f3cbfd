"""Lie transforms of graded polynomials: exp(L_χ) by degree, where L_χ f = {f, χ}."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flint import fmpq

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial

__all__ = ["Brackets", "added", "bracket_parts", "chain", "transformed", "truncated_product"]


@dataclass(frozen=True)
class Brackets:
    """Poisson's bracket in variables a₁ … aₙ, b₁ … bₙ with {aⱼ, bⱼ} = cⱼ and all others zero."""

    constants: tuple[PhasePolynomial, ...]

    def __call__(self, f: PhasePolynomial, g: PhasePolynomial) -> PhasePolynomial:
        """Return {f, g} = Σ cⱼ (∂f/∂aⱼ ∂g/∂bⱼ − ∂f/∂bⱼ ∂g/∂aⱼ)."""
        n, ring = len(self.constants), f.ring
        same = all(c == self.constants[0] for c in self.constants)
        parts = [
            (
                (f.derivative(j), g.derivative(n + j)),
                (-f.derivative(n + j), g.derivative(j)),
            )
            for j in range(n)
        ]
        if same:
            return ring.sum_of_products([pair for both in parts for pair in both]) * self.constants[0]
        total = ring.zero
        for c, both in zip(self.constants, parts, strict=True):
            total = total + ring.sum_of_products(both) * c
        return total


def transformed(
    parts: Mapping[int, PhasePolynomial], chi: PhasePolynomial, degree: int, order: int, bracket: Brackets
) -> dict[int, PhasePolynomial]:
    """Return exp(L_χ) f to an order, for f given by its homogeneous parts and χ homogeneous of one degree.

    Each bracket with χ of degree s raises the degree by s − 2, which is at least 1.
    """
    found = dict(parts)
    for start, part in parts.items():
        term, at, k = part, start, 1
        while at + degree - 2 <= order and term:
            term = bracket(term, chi).times(fmpq(1, k))
            at, k = at + degree - 2, k + 1
            if term:
                found[at] = found[at] + term if at in found else term
    return {d: f for d, f in sorted(found.items()) if f}


def added(
    first: Mapping[int, PhasePolynomial], second: Mapping[int, PhasePolynomial]
) -> dict[int, PhasePolynomial]:
    """Return the sum of two polynomials given by their homogeneous parts."""
    total = dict(first)
    for d, f in second.items():
        total[d] = total[d] + f if d in total else f
    return total


def chain(
    parts: Mapping[int, PhasePolynomial],
    generators: Sequence[tuple[int, PhasePolynomial]],
    order: int,
    bracket: Brackets,
) -> dict[int, PhasePolynomial]:
    """Return exp(L_χ) of one generator after another, the first of the list first."""
    for degree, chi in generators:
        parts = transformed(parts, chi, degree, order, bracket)
    return dict(parts)


def bracket_parts(
    f: Mapping[int, PhasePolynomial], g: Mapping[int, PhasePolynomial], order: int, bracket: Brackets
) -> dict[int, PhasePolynomial]:
    """Return {f, g} to an order, of polynomials given by their homogeneous parts; what vanishes is left out."""
    total: dict[int, PhasePolynomial] = {}
    for d, a in f.items():
        for e, b in g.items():
            if d + e - 2 <= order:
                total = added(total, {d + e - 2: bracket(a, b)})
    return {d: part for d, part in sorted(total.items()) if part}


def truncated_product(
    f: Mapping[int, PhasePolynomial], g: Mapping[int, PhasePolynomial], order: int
) -> dict[int, PhasePolynomial]:
    """Return f g to an order, of polynomials given by their homogeneous parts."""
    total: dict[int, PhasePolynomial] = {}
    for d, a in f.items():
        for e, b in g.items():
            if d + e <= order and a and b:
                total[d + e] = total[d + e] + a * b if d + e in total else a * b
    return total
