"""Linear dependence of fractions over the rationals.

exp(x/(x − z)) and exp(−z/(x − z)) have arguments that differ by 1, and 1/(x(x + 1)) is 1/x − 1/(x + 1). A fraction
that is a rational combination of earlier ones and a polynomial is written as such, so that its exponential, its
cosine and its sine go through theirs. Only denominators that occur anyway are multiplied by.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flint import fmpq, fmpq_mat

from canon.proof.tower.tower import Fraction

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable

    from flint import fmpq_mpoly

    from canon.proof.tower.forms import Forms

__all__ = ["in_earlier_fractions"]

MOST_FRACTIONS = 40
"""Fractions that one is compared with."""

LONGEST = 60
"""Terms of a denominator or numerator that is still compared."""


def in_earlier_fractions(n: Forms, a: Fraction) -> tuple[list[tuple[Fraction, fmpq]], fmpq_mpoly] | None:
    """Return (aₖ, cₖ) and a polynomial q with a = Σ cₖaₖ + q, where the aₖ are fractions that were met before.

    Over the common denominator D, a = N/D and aₖ = Nₖ/D: where the remainders of N and Σ cₖNₖ by D are equal, q is the
    difference of the quotients. A fraction that is independent of all before joins them.
    """
    whole = _as_polynomial(n, a)
    if whole is not None:
        return [], whole
    key = n.fraction_key(a)
    known = n.independent
    if key in known:
        return None
    related = _sharing_factors(list(known.values()), a)
    found = _dependence(n, related, a) if related else None
    if found is None and len(known) < MOST_FRACTIONS:
        known[key] = a
    return found


def _as_polynomial(n: Forms, a: Fraction) -> fmpq_mpoly | None:
    """Return q with N = qB for a = N/B, B = b + cσ and σ² a polynomial: c²/(1 − s) is 1 + s where s² = 1 − c².

    It is found as N(b − cσ)/(b² − c²σ²), and N = qB is verified, so that it holds also where b − cσ = 0.
    """
    t = n.tower
    if len(a.den) != 1 or a.den[0][1] != 1 or len(a.num) > LONGEST:
        return None
    below = t.base(a.den[0][0])
    k = t.used(below)[-1]
    relation = t.relation(k)
    parts = t.coefficients(below, k)
    if relation is None or relation[0] != 2 or len(parts) != 2 or len(below) > LONGEST:
        return None
    b, c = parts
    norm = t.reduce(t.product(b, b) - t.product(t.product(c, c), relation[1]))
    if norm.is_zero():
        return None
    q = t.quotient(t.product(a.num, b - c * t.monomial(k)), norm)
    return q if q is not None and t.reduce(a.num - t.product(q, below)).is_zero() else None


def _sharing_factors(known: list[Fraction], a: Fraction) -> list[Fraction]:
    """Return the fractions that are linked with ``a`` by factors of their denominators, one after the other."""
    factors = {i for i, _ in a.den}
    related: list[Fraction] = []
    while True:
        linked = [
            f for f in known if not any(f is g for g in related) and any(i in factors for i, _ in f.den)
        ]
        if not linked:
            return related
        related += linked
        factors |= {i for f in linked for i, _ in f.den}


def _dependence(
    n: Forms, known: list[Fraction], a: Fraction
) -> tuple[list[tuple[Fraction, fmpq]], fmpq_mpoly] | None:
    t = n.tower
    common: dict[int, int] = {}
    for f in (*known, a):
        for i, e in f.den:
            common[i] = max(common.get(i, 0), e)
    below = n.denominator(Fraction(t.constant(1), tuple(common.items())))
    if len(below) > LONGEST:
        return None
    pairs: list[tuple[fmpq_mpoly, fmpq_mpoly]] = []
    for f in (*known, a):
        have = dict(f.den)
        missing = tuple((i, e - have.get(i, 0)) for i, e in common.items() if e > have.get(i, 0))
        above = t.product(f.num, n.denominator(Fraction(t.constant(1), missing)))
        if len(above) > LONGEST:
            return None
        quotient, remainder = divmod(above, below)
        pairs.append((quotient, t.reduce(remainder)))
    weights = _solved(t.terms(r) for _, r in pairs)
    if weights is None:
        return None
    rest = pairs[-1][0]
    for c, (quotient, _) in zip(weights, pairs, strict=False):
        rest = rest - quotient * t.constant(c)
    return [(f, c) for f, c in zip(known, weights, strict=True) if c != 0], t.reduce(rest)


def _solved(columns: Iterable[Iterable[tuple[Hashable, fmpq]]]) -> list[fmpq] | None:
    """Return the coefficients that make the last column of the columns before, if there are any."""
    terms = [dict(column) for column in columns]
    places = {m: i for i, m in enumerate(dict.fromkeys(m for column in terms for m in column))}
    if not places:
        return [fmpq(0)] * (len(terms) - 1)
    matrix = fmpq_mat(len(places), len(terms))
    for j, column in enumerate(terms):
        for m, c in column.items():
            matrix[places[m], j] = c
    solved, rank = matrix.rref()
    weights = [fmpq(0)] * (len(terms) - 1)
    for row in range(rank):
        pivot = next(j for j in range(len(terms)) if solved[row, j] != 0)
        if pivot == len(terms) - 1:
            return None
        weights[pivot] = solved[row, len(terms) - 1]
    return weights
