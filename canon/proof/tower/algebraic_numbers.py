"""Reciprocals, norms and roots of algebraic numbers over a tower.

1/(1 + √2) and √2 − 1 are one number. Written without radicals below, it has one normal form, and sines, logarithms
or arbitrary functions of it are recognised as equal.
"""

from __future__ import annotations

from math import isqrt, prod
from typing import TYPE_CHECKING, Any, Protocol

from flint import arb, fmpq, fmpq_mat, fmpz

if TYPE_CHECKING:
    from flint import fmpq_mpoly


__all__ = ["field_of", "norm", "reciprocal", "root_in_field"]


class Radicals(Protocol):
    """What is needed of a tower: its polynomials, and the relations of its radicals."""

    def used(self, p: fmpq_mpoly) -> list[int]: ...
    def constant(self, number: Any) -> fmpq_mpoly: ...
    def monomial(self, generator: int, power: int = 1) -> fmpq_mpoly: ...
    def coefficients(self, p: fmpq_mpoly, generator: int) -> list[fmpq_mpoly]: ...
    def terms(self, p: fmpq_mpoly) -> list[tuple[tuple[tuple[int, int], ...], fmpq]]: ...
    def relation(self, generator: int) -> tuple[int, fmpq_mpoly] | None: ...
    def product(self, a: fmpq_mpoly, b: fmpq_mpoly) -> fmpq_mpoly: ...
    def reduce(self, p: fmpq_mpoly) -> fmpq_mpoly: ...
    def polynomial_power(self, p: fmpq_mpoly, n: int) -> fmpq_mpoly: ...


LARGEST_DEGREE = 16
"""Degree of a number field in which is still divided."""

LONGEST = 16
"""Terms of a number that is still divided by."""

LARGEST_ROOT = 12
LARGEST_INTEGER = 10**30
"""Norms up to this are tried as powers."""


def reciprocal(t: Radicals, p: fmpq_mpoly) -> fmpq_mpoly | None:
    """Return q with pq = 1 by the relations of the tower, so that p vanishes nowhere.

    1/(A + Bρ) = (A − Bρ)/(A² − B²R) with ρ² = R, where A² − B²R has such a reciprocal (a number that is not zero
    has one), and otherwise by solving pq = 1 in the products of the radicals.

    Examples
    --------
    >>> from canon.proof.tower.tower import Tower
    >>> tower = Tower()
    >>> root = tower.monomial(tower.generator("√2"))
    >>> tower.relate(0, 2, tower.constant(2))
    >>> reciprocal(tower, root + 1) == root - 1
    True
    """
    if p.is_constant():
        return None if p.is_zero() else t.constant(1 / p.leading_coefficient())
    if len(p) > LONGEST:
        return None
    k = t.used(p)[-1]
    relation = t.relation(k)
    if relation is None:
        return None
    parts = t.coefficients(p, k)
    if relation[0] != 2 or len(parts) != 2:
        return _solved(t, p)
    a, b = parts
    below = reciprocal(t, t.reduce(t.product(a, a) - t.product(t.product(b, b), relation[1])))
    return None if below is None else t.product(a - b * t.monomial(k), below)


def field_of(t: Radicals, p: fmpq_mpoly) -> list[tuple[int, int]] | None:
    """Return the generators that a number is made of, with the degrees of their relations; None for no number."""
    found: dict[int, int] = {}
    open_ = t.used(p)
    while open_:
        k = open_.pop()
        relation = t.relation(k)
        if relation is None:
            return None
        if k not in found:
            found[k] = relation[0]
            open_.extend(t.used(relation[1]))
    return sorted(found.items())


def _multiplication(t: Radicals, p: fmpq_mpoly) -> fmpq_mat | None:
    """Return the matrix of the multiplication by p in the products of powers of the generators."""
    field = field_of(t, p)
    if field is None or prod(degree for _, degree in field) > LARGEST_DEGREE:
        return None
    basis: list[tuple[tuple[int, int], ...]] = [()]
    for k, degree in field:
        basis = [(*m, (k, e)) if e else m for m in basis for e in range(degree)]
    places = {m: i for i, m in enumerate(basis)}
    matrix = fmpq_mat(len(basis), len(basis))
    for column, monomial in enumerate(basis):
        factor = t.constant(1)
        for k, e in monomial:
            factor = factor * t.monomial(k, e)
        for m, coefficient in t.terms(t.product(p, factor)):
            matrix[places[tuple(sorted(m))], column] = coefficient
    return matrix


def _solved(t: Radicals, p: fmpq_mpoly) -> fmpq_mpoly | None:
    matrix = _multiplication(t, p)
    if matrix is None:
        return None
    size = matrix.nrows()
    one = fmpq_mat(size, 1)
    one[0, 0] = fmpq(1)
    try:
        solution = matrix.solve(one)
    except ZeroDivisionError:
        return None
    field = field_of(t, p)
    total = t.constant(0)
    for row in range(size):
        term, left = t.constant(solution[row, 0]), row
        for k, degree in reversed(field or []):
            left, e = divmod(left, degree)
            term = term * t.monomial(k, e)
        total = total + term
    return total


def norm(t: Radicals, p: fmpq_mpoly) -> fmpq | None:
    """Return the norm of an algebraic number, a rational whose primes are all that divide the number."""
    matrix = _multiplication(t, p)
    return None if matrix is None else matrix.det()


def root_in_field(t: Radicals, p: fmpq_mpoly, m: int, size: arb) -> fmpq_mpoly | None:
    """Return α > 0 with αᵐ = p for p = A + Bρ > 0 over one square root ρ = √D of a rational, if there is one.

    α = a + bρ has the norm ν = α(a − bρ) with νᵐ = A² − B²D, so that 2a = α + ν/α is rational.

    Parameters
    ----------
    t, p
        The number over its tower.
    m
        Degree of the root.
    size
        A ball around the positive number ᵐ√p.
    """
    used = t.used(p)
    relation = t.relation(used[0]) if len(used) == 1 else None
    if relation is None or relation[0] != 2 or not relation[1].is_constant() or m > LARGEST_ROOT:
        return None
    a, b = t.coefficients(p, used[0])
    whole = t.product(a, a) - t.product(t.product(b, b), relation[1])
    if whole.is_zero():
        return None
    for nu in _rational_roots(whole.leading_coefficient(), m):
        trace = _simple(size + arb(nu) / size)
        if trace is None:
            continue
        # ρ·(p − A)/B = D: the conjugate has the other sign of ρ, so b = (α − ν/α)/(2ρ) = rational
        d = relation[1].leading_coefficient()
        slope = _simple((size - arb(nu) / size) / arb(d).sqrt())
        if slope is None:
            continue
        alpha = t.constant(trace / 2) + t.constant(slope / 2) * t.monomial(used[0])
        if t.polynomial_power(alpha, m) == p:
            return alpha
    return None


def _rational_roots(number: fmpq, m: int) -> list[fmpq]:
    """Return the rational m-th roots of a number."""
    if number < 0 and m % 2 == 0:
        return []
    upper, lower = (_whole_root(abs(int(part)), m) for part in (number.p, number.q))
    if upper is None or lower is None:
        return []
    root = fmpq(upper, lower)
    return [root, -root] if m % 2 == 0 else [-root if number < 0 else root]


def _whole_root(number: int, m: int) -> int | None:
    if number > LARGEST_INTEGER:
        return None
    found = isqrt(number) if m == 2 else round(number ** (1 / m))
    return next((k for k in (found - 1, found, found + 1) if k >= 0 and k**m == number), None)


def _simple(ball: arb) -> fmpq | None:
    """Return the rational with a denominator up to 1000 that a narrow ball holds."""
    for q in (1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12):
        whole = (ball * q).unique_fmpz()
        if isinstance(whole, fmpz):
            return fmpq(whole, q)
    return None
