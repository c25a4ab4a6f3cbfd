"""Lie transforms of polynomials in balls, and the homological equation that their generators solve."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

from flint import acb

from canon.mechanics.perturbation.enclosed.enclosed_polynomial import PrecisionError
from canon.mechanics.perturbation.enclosed.graded_polynomial import GradedPolynomial

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.mechanics.perturbation.enclosed.enclosed_polynomial import FixedPointRing
    from canon.mechanics.perturbation.enclosed.graded_polynomial import Both, PairBrackets

__all__ = ["enclosed_homological_solution", "enclosed_transformed"]

Weight = tuple[int, ...]
Terms = tuple[dict[Weight, int], dict[Weight, int]]


def enclosed_transformed(
    parts: Mapping[int, GradedPolynomial],
    chi: GradedPolynomial,
    degree: int,
    order: int,
    bracket: PairBrackets,
    known: Mapping[int, GradedPolynomial] | None = None,
) -> dict[int, GradedPolynomial]:
    """Return exp(L_χ) f to an order, for f given by its homogeneous parts and χ homogeneous of one degree from 3.

    ``known`` are {f, χ} of parts for which it is known without a bracket, by the degree of f.
    """
    found = dict(parts)
    for start, part in parts.items():
        term, at, k = part, start, 1
        while at + degree - 2 <= order:
            first = (known or {}).get(start) if k == 1 else None
            if first is None:
                first = bracket(term, chi, at * degree, order + 1 - (at + degree - 2))
            term = first.over(k)
            at, k = at + degree - 2, k + 1
            found[at] = found[at] + term if at in found else term
    return dict(sorted(found.items()))


def enclosed_homological_solution(
    part: GradedPolynomial, degree: int, exponents: Sequence[acb], known: dict[Weight, acb]
) -> tuple[GradedPolynomial, GradedPolynomial]:
    """Return (kept, χ) with part + {H₂, χ} = kept, where kept has every a of a hyperbolic pair as often as its b.

    Parameters
    ----------
    part, degree
        A homogeneous polynomial in (a, b).
    exponents
        λ₁ … λₙ, those of hyperbolic pairs first.
    known
        1/(k·λ) of the k met so far; filled here.

    Raises
    ------
    PrecisionError
        Where a divisor k·λ is not told from zero.
    """
    ring, n = part.ring, len(exponents)
    reciprocals: dict[Weight, tuple[int, int, int]] = {}
    error = 1 + part.error * _largest_reciprocal(degree, exponents[: ring.hyperbolic], ring) // ring.unit
    kept: dict[int, Both] = {}
    chi: dict[int, Both] = {}
    for h, (re, im) in part.grades.items():
        stays: Terms = ({}, {})
        goes: Terms = ({}, {})
        real, imaginary = re.to_dict(), im.to_dict()
        for place in {*real, *imaginary}:
            powers = tuple(map(int, place))  # FLINT counts in its own integers
            x, y = int(real.get(place, 0)), int(imaginary.get(place, 0))
            weight = tuple(powers[j] - powers[n + j] for j in range(n))
            if not any(weight[: ring.hyperbolic]):
                stays[0][powers], stays[1][powers] = x, y
                continue
            if weight not in reciprocals:
                if weight not in known:
                    known[weight] = 1 / _divisor(weight, exponents)
                reciprocals[weight] = ring.rounded(known[weight])
            u, v, e = reciprocals[weight]
            goes[0][powers], goes[1][powers] = (x * u - y * v) // ring.unit, (x * v + y * u) // ring.unit
            error += (abs(x) + abs(y)) * e // ring.unit + 3  # two roundings, and that of this error
        kept[h], chi[h] = _made(stays, ring), _made(goes, ring)
    return GradedPolynomial(ring, kept, part.error), GradedPolynomial(ring, chi, error)


def _made(terms: Terms, ring: FixedPointRing) -> Both:
    return ring.context.from_dict(terms[0]), ring.context.from_dict(terms[1])


def _divisor(weight: Weight, exponents: Sequence[acb]) -> acb:
    total = acb(0)
    for k, e in zip(weight, exponents, strict=True):
        total += k * e
    if total.contains(0):
        raise PrecisionError(
            f"the divisor k·λ of k = {weight} is zero as far as the precision tells: rates of hyperbolic pairs are "
            "in resonance, and nothing separates the centre manifold"
        )
    return total


def _largest_reciprocal(degree: int, rates: Sequence[acb], ring: FixedPointRing) -> int:
    """Return a bound of 1/|k·λ| in units of 2⁻ᵇⁱᵗˢ, for all terms of a degree that are taken away.

    Frequencies are imaginary, so |k·λ| is at least |Σ k λ| over the hyperbolic pairs.
    """
    found = 0
    for weight in product(range(-degree, degree + 1), repeat=len(rates)):
        if any(weight) and sum(map(abs, weight)) <= degree:
            u, v, e = ring.rounded(1 / _divisor(weight, rates))
            found = max(found, abs(u) + abs(v) + e)
    return found
