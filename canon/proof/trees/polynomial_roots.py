"""Roots of polynomials in one unknown, written with roots of their coefficients: real ones, and all of low degree.

Roots at one point of a domain are numbers, and are found as such: rational ones in
:mod:`canon.proof.domain.rational_points`, those in balls in :mod:`canon.proof.refute.corners`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr

from canon.proof.trees.polynomial import MOST_TERMS, terms_at_most

if TYPE_CHECKING:
    from sympy import Symbol

__all__ = ["Root", "is_binomial", "low_degree_roots", "polynomial_in", "real_roots"]


@dataclass(frozen=True)
class Root:
    """A value, and what must not be negative for it."""

    value: Expr
    conditions: tuple[Expr, ...] = ()

    def inside(self, conditions: tuple[Expr, ...]) -> Root:
        """Return the root with conditions that were met before."""
        return Root(self.value, tuple(dict.fromkeys((*conditions, *self.conditions))))


def polynomial_in(f: Expr, x: Symbol) -> sp.Poly | None:
    """Return an expression as a polynomial in one symbol, of degree 1 at least; None for others and for long ones."""
    if terms_at_most(f) > MOST_TERMS:
        return None
    try:
        poly = sp.Poly(f, x)
    except sp.PolynomialError:
        return None
    return None if poly.degree() < 1 or any(c.has(x) for c in poly.all_coeffs()) else poly


def is_binomial(poly: sp.Poly) -> bool:
    """Tell whether a polynomial is a xⁿ + c."""
    return {power for (power,) in poly.monoms()} <= {0, poly.degree()}


def real_roots(poly: sp.Poly, *, positive: bool = False) -> list[Root] | None:
    """Return the real roots of a polynomial in one unknown; None where they are not written in roots.

    Where the leading coefficient vanishes they are limits of these. Of a xⁿ + c there is only one where the unknown is
    known to be ``positive``.

    Examples
    --------
    >>> x, a = sp.symbols("x a", real=True)
    >>> real_roots(sp.Poly(x**2 - a, x))
    [Root(value=sqrt(a), conditions=(a,)), Root(value=-sqrt(a), conditions=(a,))]
    """
    terms = {power: c for (power,), c in poly.terms()}
    top, c = int(poly.degree()), terms.get(0, sp.S.Zero)
    lead = terms[top]
    if top == 1:
        return [Root(-c / lead)]
    if is_binomial(poly):
        return _roots_of_power(-c / lead, top, positive=positive)
    if top == 2:
        b = terms[1]
        discriminant = sp.expand(b**2 - 4 * lead * c)
        return [Root((-b + sign * sp.sqrt(discriminant)) / (2 * lead), (discriminant,)) for sign in (1, -1)]
    return None


def _roots_of_power(power: Expr, top: int, *, positive: bool) -> list[Root] | None:
    root = power ** sp.Rational(1, top)
    if positive:
        return [Root(root)]
    if top % 2:
        return [Root(sp.real_root(power, top))] if power.is_number else None
    return [Root(root, (power,)), Root(-root, (power,))]


def low_degree_roots(polynomial: Expr, u: Symbol) -> list[tuple[Expr, tuple[Expr, ...]]]:
    """Return the roots in u of factors of low degree, each with the expressions whose signs tell it."""
    if not polynomial.is_polynomial(u):
        return []
    poly = sp.Poly(polynomial, u)
    factors = [poly] if poly.degree() <= 2 else [f for f, _ in poly.factor_list()[1]]
    roots: list[tuple[Expr, tuple[Expr, ...]]] = []
    for factor in factors:
        coefficients = factor.all_coeffs()
        if len(coefficients) == 2:
            roots.append((-coefficients[1] / coefficients[0], ()))
        elif len(coefficients) > 2 and all(c == 0 for c in coefficients[1:-1]):
            root = sp.root(-coefficients[-1] / coefficients[0], len(coefficients) - 1)
            roots.extend([(cast("Expr", root), (u,)), (cast("Expr", -root), (u,))])
        elif len(coefficients) == 3:
            a, b, c = coefficients
            half = sp.sqrt(sp.factor(b**2 - 4 * a * c))
            slope = 2 * a * u + b
            roots.extend([((-b + half) / (2 * a), (slope,)), ((-b - half) / (2 * a), (slope,))])
        elif len(coefficients) == 5 and all(c == 0 for c in coefficients[1::2]):
            for square, signs in low_degree_roots(
                cast("Expr", factor.as_expr().xreplace({u**4: u**2, u**2: u})), u
            ):
                told = (u, *(cast("Expr", sign.xreplace({u: u**2})) for sign in signs))
                roots.extend([(sp.sqrt(square), told), (-sp.sqrt(square), told)])
    return roots
