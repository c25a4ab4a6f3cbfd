"""Potential of a closed form Σ aⱼ dzⱼ: a function of its variables, found by integration.

Forms in mechanics are mostly homogeneous under some scaling; then Euler's theorem gives the potential
without an integral: if scaling the variables with weights w multiplies the form by λᵏ, then
d(Σ wⱼ zⱼ aⱼ) = k Σ aⱼ dzⱼ. Else the potential is fitted as a combination, with rational coefficients, of the
functions that the form is made of. Each is checked at points and proved before it is returned. What is left are
quadratures, such as those of arbitrary functions.
"""

from __future__ import annotations

import time as clock
from fractions import Fraction
from itertools import combinations
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.algebra.all_vanish import all_vanish
from canon.mechanics.algebra.branch_point import BranchPoint, branch_points
from canon.mechanics.algebra.named_integrals import quadratures
from canon.mechanics.algebra.substitution import exchanged, size
from canon.mechanics.algebra.table_integrals import table_integral
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from canon.proof.domain.domain import Domain

__all__ = ["potential"]


def potential(
    form: Sequence[Expr],
    z: Sequence[Symbol],
    domain: Domain,
    hints: Mapping[Expr, Expr] | None = None,
    budget: float = 10.0,
) -> Expr | None:
    """Return G with ∂G/∂zⱼ = aⱼ, proved on the domain; None where none was found.

    Where no closed form was found, integrals of functions of one variable are named and not evaluated.

    Parameters
    ----------
    form
        The coefficients aⱼ of a closed form.
    z
        Its variables.
    domain
        Where it is meant.
    hints
        Functions of z of which G may be a combination, by the name they are to have in it.
    budget
        Seconds after which no further candidate is tried.

    Examples
    --------
    >>> from sympy import symbols, sin
    >>> from canon.proof.domain.domain import Domain
    >>> x, y = symbols("x y", real=True)
    >>> potential([2*x*sin(y), x**2*sp.cos(y)], [x, y], Domain())
    x**2*sin(y)
    """
    end = clock.monotonic() + budget
    form = [_without_vanishing(a, z, domain) for a in form]
    if all(a == 0 for a in form):
        return sp.S.Zero
    hints = hints or {}
    for candidate, named in _candidates(form, z, domain, hints):
        left = end - clock.monotonic()
        if left < 0:
            return None
        proved = all_vanish(
            ((f"∂G/∂{s} = {a}", candidate.diff(s) - a) for s, a in zip(z, form, strict=True)),
            "",
            domain,
            left,
        )
        if proved.holds:
            return named
    integrals, rest = quadratures(form, z)
    if integrals == 0:
        return None
    remaining = potential(rest, z, domain, hints, max(0.0, end - clock.monotonic()))
    return None if remaining is None else integrals + remaining


def _candidates(
    form: Sequence[Expr], z: Sequence[Symbol], domain: Domain, hints: Mapping[Expr, Expr]
) -> Iterator[tuple[Expr, Expr]]:
    """Yield what may be the potential, in z and in the names of the hints."""
    for basis in (hints, None, _antiderivatives(form, z, hints), _products(form, z, hints)):
        if basis is None:
            symbols = set(z).union(*(a.atoms(Symbol) for a in form))
            points = list(branch_points(symbols, {}, domain, 2))
            yield from ((candidate, candidate) for candidate in _by_scaling(form, z, points))
            continue
        fitted = _by_fitting(form, z, domain, list(basis.values()))
        if fitted is not None:
            yield (
                sp.Add(*(c * f for c, f in zip(fitted, basis.values(), strict=True))),
                sp.Add(*(c * name for c, name in zip(fitted, basis, strict=True))),
            )


def _without_vanishing(a: Expr, z: Sequence[Symbol], domain: Domain) -> Expr:
    """Put 0 or 1 for variables on which a coefficient depends in writing only."""
    for s in z:
        if not a.has(s):
            continue
        slope = a.diff(s)
        if slope != 0 and not vanishes_off_kinks(slope, domain).holds:
            continue
        for place in (sp.S.Zero, sp.S.One):
            simpler = exchanged(a, {s: place})
            if not simpler.has(sp.nan, sp.zoo, sp.oo):
                a = simpler
                break
    if a == 0 or vanishes_off_kinks(a, domain).holds:
        return sp.S.Zero
    return _lowest_terms(a)


def _lowest_terms(a: Expr) -> Expr:
    """Cancel as a fraction of polynomials in whatever functions a holds, where a is small."""
    if size(a) > 350:
        return a
    return min((a, sp.cancel(sp.together(a))), key=size)


def _by_scaling(form: Sequence[Expr], z: Sequence[Symbol], points: Sequence[BranchPoint]) -> Iterator[Expr]:
    for weights in _weights(len(z)):
        total = sp.Add(*(w * s * a for w, s, a in zip(weights, z, form, strict=True)))
        degree = _common_ratio([total.diff(s) for s in z], form, points)
        if degree:
            yield total / sp.Rational(degree.numerator, degree.denominator)


def _weights(size: int) -> Iterator[tuple[int, ...]]:
    """Scalings to try: everything, coordinates, momenta, single variables, conjugate pairs."""
    n = size // 2
    yield (1,) * size
    yield (1,) * n + (0,) * (size - n)
    yield (0,) * n + (1,) * (size - n)
    yield (1,) * n + (2,) * (size - n)
    yield (2,) * n + (1,) * (size - n)
    if size > 2:
        for i in range(size):
            yield tuple(int(j == i) for j in range(size))
        for i, k in combinations(range(n), 2):
            yield tuple(int(j in (i, k)) for j in range(size))


def _common_ratio(
    gradient: Sequence[Expr], form: Sequence[Expr], points: Sequence[BranchPoint]
) -> Fraction | None:
    """Return the simple k ≠ 0 with gradient = k · form at all points, or None."""
    ratio: Fraction | None = None
    for point in points:
        for g, a in zip(gradient, form, strict=True):
            left, right = point.number(g), point.number(a)
            if left is None or right is None:
                return None
            if abs(right) < 1e-12:
                if abs(left) > 1e-9:
                    return None
                continue
            found = Fraction(left / right).limit_denominator(12)
            if abs(left / right - found) > 1e-9 or (ratio is not None and found != ratio):
                return None
            ratio = found
    return ratio or None


def _finite_rows(equations: Sequence[Sequence[Expr]], point: BranchPoint) -> list[list[float]]:
    """Return the coefficients of equations at a point; none where one of them has no value or is huge."""
    rows = [[point.number(f) for f in equation] for equation in equations]
    if not all(x is not None and abs(x) < 1e8 for row in rows for x in row):
        return []
    return [[float(x) for x in row if x is not None] for row in rows]


def _by_fitting(
    form: Sequence[Expr], z: Sequence[Symbol], domain: Domain, basis: Sequence[Expr]
) -> list[sp.Rational] | None:
    """Fit d(Σ c f) = form with rational c at points of the domain, the simplest functions f first."""
    if not basis:
        return None
    symbols = set(z).union(*(f.atoms(Symbol) for f in (*basis, *form)))
    equations = [(*(f.diff(s) for f in basis), a) for s, a in zip(z, form, strict=True)]
    rows: list[list[float]] = []
    wanted = 2 + -(-(len(basis) + 4) // len(z))
    for point in branch_points(symbols, {}, domain, 2 * wanted, seed=11):
        rows += _finite_rows(equations, point)
        if len(rows) >= wanted * len(z):
            break
    return _rational_fit(rows) if len(rows) > len(basis) else None


def _terms(a: Expr) -> list[Expr]:
    return list(sp.Add.make_args(cast("Expr", sp.expand_mul(a))))


def _antiderivatives(
    form: Sequence[Expr], z: Sequence[Symbol], hints: Mapping[Expr, Expr]
) -> dict[Expr, Expr]:
    """Return the hints times the constants of the form, and the elementary integrals of its simple terms."""
    constants = {
        term.as_independent(*z, as_Add=False)[0].as_coeff_Mul()[1] for a in form for term in _terms(a)
    }
    basis = {c * name: c * hint for c in sorted(constants, key=size)[:4] for name, hint in hints.items()}
    for a, s in zip(form, z, strict=True):
        for term in _terms(a)[:12]:
            integral = table_integral(term, s)
            if integral is not None:
                plain = integral.as_coeff_Mul()[1]
                basis[plain] = plain
    return dict(sorted(basis.items(), key=lambda item: size(item[0]))[:40])


def _products(form: Sequence[Expr], z: Sequence[Symbol], hints: Mapping[Expr, Expr]) -> dict[Expr, Expr]:
    """Return the hints, and products of variables with the terms of the form and with their functions."""
    terms = {term.as_coeff_Mul()[1] for a in form for term in _terms(a)}
    kernels = _functions((*form, *hints.values()), z)
    basis: dict[Expr, Expr] = dict(hints)
    for f in (
        *(s * term for s in z for term in terms),
        *terms,
        *kernels,
        *(sp.log(s) for s in z),
        *(s * kernel for s in z for kernel in kernels),
    ):
        plain = f.as_coeff_Mul()[1]
        if plain.has(*z):
            basis[plain] = plain
    return dict(sorted(basis.items(), key=lambda item: size(item[0]))[:60])


def _functions(sources: Sequence[Expr], z: Sequence[Symbol]) -> set[Expr]:
    found: set[Expr] = set()
    for source in sources:
        found |= {f for f in source.atoms(sp.Function) if f.has(*z)}
        found |= {f for f in source.atoms(sp.Pow) if f.has(*z) and not f.as_base_exp()[1].is_Integer}
    return found


def _rational_fit(rows: Sequence[Sequence[float]]) -> list[sp.Rational] | None:
    """Combine columns to the last one with short rational coefficients, the simplest columns first."""
    import numpy as np

    table = np.array(rows)
    scale = np.abs(table).max(axis=1, keepdims=True)
    table = table / np.where(scale > 0, scale, 1.0)
    target = table[:, -1]
    chosen: list[int] = []
    basis = np.empty((table.shape[0], 0))
    for k in range(table.shape[1] - 1):
        column = table[:, k]
        rest = column - basis @ (basis.T @ column)
        rest = rest - basis @ (basis.T @ rest)
        if np.linalg.norm(rest) > 1e-7 * max(np.linalg.norm(column), 1e-300):
            basis = np.column_stack([basis, rest / np.linalg.norm(rest)])
            chosen.append(k)
    if not chosen:
        return None
    solution, *_ = np.linalg.lstsq(table[:, chosen], target, rcond=None)
    rounded = [Fraction(float(c)).limit_denominator(48) for c in solution]
    if np.abs(table[:, chosen] @ np.array([float(c) for c in rounded]) - target).max() > 1e-7:
        return None
    coefficients = [sp.S.Zero] * (table.shape[1] - 1)
    for k, c in zip(chosen, rounded, strict=True):
        coefficients[k] = sp.Rational(c.numerator, c.denominator)
    return coefficients
