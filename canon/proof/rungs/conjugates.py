"""Conjugates of nested radicals: a root of a known polynomial is zero where it is smaller than all other roots."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from flint import arb, fmpq

from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain.limits import TooLarge

if TYPE_CHECKING:
    from flint import fmpq_mpoly

    from canon.proof.functions.normal_form import NormalForm
    from canon.proof.tower.tower import Fraction

__all__ = ["radicals_cancel"]

DEEPEST = 4

LONGEST_NORM = 40
"""Terms of a norm that is still taken further."""


def radicals_cancel(n: NormalForm, f: Fraction) -> bool:
    """Tell whether the numerator of ``f`` is proven zero through one of its factors."""
    _, factors = n.tower.factors(n.tower.reduce(f.num))
    return any(_by_norm(n, p, DEEPEST) or _by_root_bound(n, p) for p, _ in factors)


def _by_norm(n: NormalForm, p: fmpq_mpoly, depth: int) -> bool:
    """A + Bρ = 0 with ρ = √R ≥ 0 where A² = B²R and A, B have opposite signs: then |A| = |B|ρ."""
    t = n.tower
    if depth == 0:
        return False
    for k in reversed(t.used(p)):
        relation = t.relation(k)
        if relation is None or relation[0] != 2 or not n.signs.declared(k).endswith("+"):
            continue
        a, b = (*t.coefficients(p, k), t.constant(0))[:2]
        norm = t.reduce(t.product(a, a) - t.product(t.product(b, b), relation[1]))
        if not norm.is_zero() and (len(norm) > LONGEST_NORM or not _by_norm(n, norm, depth - 1)):
            continue
        signs = (n.signs.of(a), n.signs.of(b))
        if all(signs) and signs[0][-1] != signs[1][-1]:
            return True
    return False


def _by_root_bound(n: NormalForm, p: fmpq_mpoly) -> bool:
    """Prove that an algebraic number is zero.

    Eliminating the radicals from y − p leaves P(y) = yᵐ Q(y), Q(0) ≠ 0, with P(p) = 0. By Cauchy's bound
    every root of Q has modulus at least |q₀|/(|q₀| + max|qᵢ|); a ball for p below that proves p = 0.
    """
    t = n.tower
    if not _is_algebraic(n, p):
        return False
    expr = n.expression(p)
    y = n.atom(("y",), "", lambda: sp.Symbol("y")).num
    index = t.generator(("y",))
    polynomial = y - p
    while eliminated := [k for k in t.used(polynomial) if k != index]:
        k = eliminated[-1]
        relation = t.relation(k)
        if relation is None:
            raise TooLarge("an algebraic number over something else")
        polynomial = t.resultant(polynomial, t.monomial(k, relation[0]) - relation[1], k)
    coefficients = [
        c.leading_coefficient() if not c.is_zero() else fmpq(0) for c in t.coefficients(polynomial, index)
    ]
    lowest = next(i for i, c in enumerate(coefficients) if c != 0)
    if lowest == 0:
        return False
    rest = [abs(c) for c in coefficients[lowest:]]
    bound = rest[0] / (rest[0] + max(rest[1:], default=fmpq(0)))
    for bits in (128, 512, 2048, 8192):
        with precision(bits):
            try:
                size = abs(value(expr, {}))
            except (NotDecided, Undefined, Unmodelled):
                continue
            if size < arb(bound):
                return True
            if size > arb(bound) / 2 and bits > 128:
                return False
    return False


def _is_algebraic(n: NormalForm, p: fmpq_mpoly) -> bool:
    """Tell whether p is built from relations alone, of a degree that can be eliminated."""
    t = n.tower
    open_, seen, degree = set(t.used(p)), set[int](), 1
    while open_:
        k = open_.pop()
        relation = t.relation(k)
        if relation is None:
            return False
        seen.add(k)
        degree *= relation[0]
        open_ |= set(t.used(relation[1])) - seen
    return degree <= t.limits.eliminated_degree and bool(seen)
