"""Normal form of square roots of square roots: through roots that are there already, of squares, and by conjugates."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from flint import fmpq

from canon.proof.tower.factors import factors_of
from canon.proof.tower.tower import Fraction

if TYPE_CHECKING:
    from collections.abc import Iterator

    from flint import fmpq_mpoly

    from canon.proof.tower.forms import Forms

__all__ = ["denested"]

MOST_ROOTS_MULTIPLIED = 3
MOST_ROOTS_KNOWN = 7


def denested(n: Forms, p: fmpq_mpoly) -> Fraction | None:
    """Return √p, p ≥ 0, through square roots that are there already, or through simpler ones."""
    return _by_products(n, p) or _of_square(n, p) or _by_conjugate(n, p)


def _by_products(n: Forms, p: fmpq_mpoly) -> Fraction | None:
    """Return √p = |S|·Πρⱼ/ΠRⱼ where p·ΠRⱼ = S² for known roots ρⱼ = √Rⱼ with Rⱼ > 0 proven."""
    t = n.tower
    roots = [
        (kernel, n.arguments[kernel].num)
        for kernel in t.generators
        if kernel[0] == "root" and kernel[2] == 2 and not n.arguments[kernel].num.is_constant()
    ]
    if len(roots) > MOST_ROOTS_KNOWN or p.is_constant():
        return None
    for size in range(MOST_ROOTS_MULTIPLIED + 1):
        for chosen in combinations(roots, size):
            product = p
            for _, radicand in chosen:
                product = t.product(product, radicand)
            square = _square_root(n, product)
            if square is None or any(n.signs.of(radicand) != "+" for _, radicand in chosen):
                continue
            result = square
            for kernel, radicand in chosen:
                rho = Fraction(t.monomial(t.generator(kernel)))
                result = t.times(result, rho, t.reciprocal(Fraction(radicand)))
            return result
    return None


def _square_root(n: Forms, p: fmpq_mpoly) -> Fraction | None:
    """Return √p = |S| for p = S², also with 1 − c² = s², or of a positive rational p."""
    if p.is_constant() and p.leading_coefficient() > 0:
        return n.root(Fraction(p), fmpq(1, 2))
    square = n.tower.square_root(p)
    if square is not None:
        return n.modulus(Fraction(square))
    if not any(n.tower.generators[k][0] == "cos" for k in n.tower.used(p)):
        return None
    unit, factors = factors_of(n, p)
    outside = n.tower.square_root(n.tower.constant(unit)) if unit > 0 else None
    if outside is None or any(e % 2 for _, e in factors):
        return None
    parts = (n.tower.power(n.modulus(Fraction(q)), e // 2) for q, e in factors)
    return n.tower.times(Fraction(outside), *parts)


def _of_square(n: Forms, p: fmpq_mpoly) -> Fraction | None:
    """Return √(A + Bρ) = |s + Bρ/2s| where s² = (A ± D)/2 and A² − B²R = D²: √(1 + x² + 2|x|) = 1 + |x|."""
    t = n.tower
    for k, a, b, d in _conjugates(n, p):
        if not n.signs.real(t.monomial(k)):
            continue
        for sign in (1, -1):
            s = t.square_root((a + t.constant(fmpq(sign)) * d) * t.constant(fmpq(1, 2)))
            if s is None or s.is_zero() or not n.signs.real(s):
                continue
            slope = n.over(Fraction(b), Fraction(t.constant(fmpq(2)) * s))
            if not slope.den:
                return n.modulus(t.sum([Fraction(s), t.times(slope, Fraction(t.monomial(k)))]))
    return None


def _conjugates(n: Forms, p: fmpq_mpoly) -> Iterator[tuple[int, fmpq_mpoly, fmpq_mpoly, fmpq_mpoly]]:
    """Yield ρ, A, B and D for each square root ρ in A + Bρ with A² − B²R = D², R being ρ²."""
    t = n.tower
    for k in reversed(t.used(p)):
        relation = t.relation(k)
        if relation is None or relation[0] != 2:
            continue
        parts = t.coefficients(p, k)
        if len(parts) != 2:
            continue
        a, b = parts
        d = t.square_root(t.reduce(t.product(a, a) - t.product(t.product(b, b), relation[1])))
        if d is not None:
            yield k, a, b, d


def _by_conjugate(n: Forms, p: fmpq_mpoly) -> Fraction | None:
    """Return √(A + Bρ) = √((A+D)/2) ± √((A−D)/2), the sign that of B, where A² − B²R = D², D ≥ 0.

    With p ≥ 0 and p·(A − Bρ) = D² ≥ 0 (and p > 0) also A − Bρ ≥ 0, so A ≥ 0 and A ± D ≥ 0 because
    (A + D)(A − D) = B²R ≥ 0; the square of the right side is A + |B|ρ·sign B.
    """
    t = n.tower
    if n.signs.of(p) != "+":
        return None
    for k, a, b, d in _conjugates(n, p):
        sign_b = n.signs.of(b)
        if not n.signs.declared(k).endswith("+") or not sign_b:
            continue
        if n.inside_root and not n.signs.of(d):  # |D| might lead back to the root it is asked for
            continue
        size = n.modulus(Fraction(d))
        larger, smaller = _halves(n, Fraction(a), size)
        return t.sum([larger, smaller if sign_b.endswith("+") else n.negative(smaller)])
    return None


def _halves(n: Forms, a: Fraction, d: Fraction) -> tuple[Fraction, Fraction]:
    """Return √((A+D)/2) and √((A−D)/2)."""
    half, outer = fmpq(1, 2), n.inside_root
    n.inside_root = True
    try:
        larger = n.root(n.scaled(half, n.tower.sum([a, d])), half)
        smaller = n.root(n.scaled(half, n.minus(a, d)), half)
    finally:
        n.inside_root = outer
    return larger, smaller
