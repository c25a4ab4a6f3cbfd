"""Polynomial factors by FLINT, as SymPy's own factorisation may take hours in several variables."""

from __future__ import annotations

from collections import Counter
from math import comb, prod
from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import Ordering, fmpz_mpoly_ctx
from sympy import Expr

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["MOST_TERMS", "is_left_out", "polynomial_factors", "terms_at_most"]

MOST_TERMS = 4_000
"""Terms up to which what is factored is multiplied out."""


def polynomial_factors(expression: Expr) -> list[tuple[Expr, int]]:
    """Return the irreducible factors of an expression's numerator that are not numbers, and how often each occurs.

    The numerator is taken as a polynomial in symbols and in whatever else it holds, such as sin x. A factor of it
    whose coefficients are not rational stays whole, and so does one that has very many terms when multiplied out.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> polynomial_factors((x**2 - y**2) * sp.sin(x) ** 2 / 2)
    [(x - y, 1), (x + y, 1), (sin(x), 2)]
    """
    numerator = sp.numer(sp.together(expression))
    counts = Counter[Expr]()
    for part in sp.Mul.make_args(numerator):
        base, power = part.as_base_exp()
        if not (power.is_Integer and power > 0):
            base, power = part, sp.S.One
        for factor, times in _factors(base):
            counts[factor] += times * int(power)
    return sorted(counts.items(), key=lambda item: sp.default_sort_key(item[0]))


def _factors(base: Expr) -> list[tuple[Expr, int]]:
    if not base.free_symbols:
        return []
    if terms_at_most(base) > MOST_TERMS:
        return [(base, 1)]
    try:
        poly = sp.Poly(base)
    except (sp.PolynomialError, sp.GeneratorsNeeded):  # the latter where everything cancels
        return [(base, 1)]
    if not (poly.domain.is_ZZ or poly.domain.is_QQ):
        return [(base, 1)]
    whole = poly.clear_denoms(convert=True)[1]
    context = fmpz_mpoly_ctx.get([f"x{i}" for i in range(len(whole.gens))], Ordering.lex)
    _, found = context.from_dict({powers: int(c) for powers, c in whole.terms()}).factor()
    return [
        (sp.Poly({powers: int(c) for powers, c in f.to_dict().items()}, *whole.gens).as_expr(), int(times))
        for f, times in found
    ]


def terms_at_most(f: Expr) -> int:
    """Return how many terms an expression can have when it is multiplied out, as a polynomial in whatever it holds.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> terms_at_most((x + y + 1) ** 60 - sp.sin(x)), terms_at_most((x + 1) ** 100_000 - 2)
    (1892, 100002)
    """
    if isinstance(f, sp.Add):
        return sum(map(terms_at_most, f.args))
    if isinstance(f, sp.Mul):
        return prod(map(terms_at_most, f.args))
    base, power = f.as_base_exp()
    if isinstance(f, sp.Pow) and power.is_Integer and power > 1:
        terms, n = terms_at_most(base), int(power)
        return comb(terms + n - 1, n) if min(terms, n) < MOST_TERMS else terms + n
    return 1


def is_left_out(f: Expr, conditions: Iterable[sp.Basic]) -> bool:
    """Tell whether conditions say g ≠ 0 of every factor g of an expression.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> is_left_out(x**2 * y, [sp.Ne(x * y, 0)]), is_left_out(x * y, [sp.Ne(x, 0)])
    (True, False)
    """
    said = [cast("Expr", c.lhs) for c in conditions if isinstance(c, sp.Ne) and c.rhs == 0]
    nonzero = {base for g in said for base in _bases(g)}
    return all(base in nonzero or base.is_nonzero for base in _bases(f))


def _bases(f: Expr) -> list[Expr]:
    return [g.base if isinstance(g, sp.Pow) else g for g in sp.Mul.make_args(f)]
