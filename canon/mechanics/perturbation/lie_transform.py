"""Lie transforms of graded polynomials: exp(L_χ) by degree, where L_χ f = {f, χ}."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import fmpz_mpoly

    from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial, Sides

__all__ = ["Brackets", "PhaseField", "added", "bracket_parts", "chain", "transformed", "truncated_product"]


@dataclass(frozen=True)
class PhaseField:
    """A vector field in the phase variables whose components have one denominator.

    Parameters
    ----------
    components
        The real and the imaginary part of each numerator.
    den
        The denominator.
    """

    components: tuple[Sides, ...]
    den: fmpz_mpoly

    @classmethod
    def of(cls, components: Sequence[PhasePolynomial]) -> PhaseField:
        """Return the field with these components."""
        common = components[0].den
        for f in components[1:]:
            if f.den != common:
                common = common * (f.den / f.den.gcd(common))
        raised = [(f, common / f.den) for f in components]
        return cls(tuple((f.re * factor, f.im * factor) for f, factor in raised), common)

    def change_of(self, f: PhasePolynomial, divisor: int = 1) -> PhasePolynomial:
        """Return the derivative of f along the field, divided by a whole number."""
        return f.along(self.components, self.den * divisor)


@dataclass(frozen=True)
class Brackets:
    """Poisson's bracket in variables a₁ … aₙ, b₁ … bₙ with {aⱼ, bⱼ} = cⱼ and all others zero."""

    constants: tuple[PhasePolynomial, ...]

    def __call__(self, f: PhasePolynomial, g: PhasePolynomial) -> PhasePolynomial:
        """Return {f, g} = Σ cⱼ (∂f/∂aⱼ ∂g/∂bⱼ − ∂f/∂bⱼ ∂g/∂aⱼ)."""
        return self.field(g).change_of(f)

    def field(self, g: PhasePolynomial) -> PhaseField:
        """Return the Hamiltonian vector field ({a₁, g}, … {b₁, g}, …)."""
        n = len(self.constants)
        ahead = [g.derivative(n + j) * c for j, c in enumerate(self.constants)]
        back = [-(g.derivative(j) * c) for j, c in enumerate(self.constants)]
        return PhaseField.of([*ahead, *back])


def transformed(
    parts: Mapping[int, PhasePolynomial], chi: PhasePolynomial, degree: int, order: int, bracket: Brackets
) -> dict[int, PhasePolynomial]:
    """Return exp(L_χ) f to an order, for f given by its homogeneous parts and χ of a lowest degree.

    Each bracket with a part of χ of degree s raises the degree by s − 2, which is at least 1.
    """
    found = dict(parts)
    fields = {s: bracket.field(part) for s, part in chi.split(_degree).items()}
    for start, part in parts.items():
        term, k = {start: part}, 1
        while term and min(term) + degree - 2 <= order:
            term = _along(term, fields, k, order)
            found = added(found, term)
            k += 1
    return {d: f for d, f in sorted(found.items()) if f}


def _along(
    f: Mapping[int, PhasePolynomial], fields: Mapping[int, PhaseField], divisor: int, order: int
) -> dict[int, PhasePolynomial]:
    """Return {f, χ}/divisor to an order, from the fields of the homogeneous parts of χ."""
    total: dict[int, PhasePolynomial] = {}
    for d, part in f.items():
        for s, field in fields.items():
            if d + s - 2 <= order:
                total = added(total, {d + s - 2: field.change_of(part, divisor)})
    return {d: part for d, part in total.items() if part}


def _degree(exponents: tuple[int, ...]) -> int:
    return int(sum(exponents))


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
    for e, b in g.items():
        field = bracket.field(b)
        for d, a in f.items():
            if d + e - 2 <= order:
                total = added(total, {d + e - 2: field.change_of(a)})
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
