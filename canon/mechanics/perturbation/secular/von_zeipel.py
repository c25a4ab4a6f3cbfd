"""Von Zeipel's generating function F₂ of a Lie transform, to any order: the Hamilton–Jacobi equation in ε.

Deprit's map from new to old variables is the flow of W in the "time" ε. Its generating function S(q, P, ε), of old
coordinates and new momenta, is therefore a solution of ∂S/∂ε + W(q, ∂S/∂q, ε) = 0 with S = Σ q P at ε = 0
(C. G. J. Jacobi, Vorlesungen über Dynamik, 20; for the first orders G. Hori, S. Ferraz-Mello, Canonical Perturbation
Theories, 2007, chapter 6, doi:10.1007/978-0-387-38905-9).
"""

from __future__ import annotations

from itertools import combinations_with_replacement
from math import factorial, prod
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.expression.symbols.user_input import given_expression, given_symbols
from canon.mechanics.algebra.substitution import substitute
from canon.mechanics.canonical.generating_function import GeneratingFunction
from canon.mechanics.perturbation.lie_series import powers_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sympy import Expr, Symbol

__all__ = ["von_zeipel_function"]


def von_zeipel_function(
    W: Expr,
    q: Sequence[Symbol],
    p: Sequence[Symbol],
    order: int,
    small: Symbol,
    plain: Callable[[Expr], Expr] | None = None,
) -> GeneratingFunction:
    """Return F₂(q, P) = Σ q P + ε S₁ + … of the map of :func:`lie_deprit`, to an order in ε.

    k Sₖ is minus the coefficient of ε^(k−1) in W(q, P + ∂S/∂q, ε), which holds S₁ … Sₖ₋₁ alone: there are derivatives
    only, no integral.

    Parameters
    ----------
    W
        Deprit's generator, a polynomial in ε.
    q, p
        Coordinates and momenta in the same order.
    order
        The highest power of ε in F₂, at least 1.
    small
        ε.
    plain
        In what form each Sₖ is kept, such as a Fourier series; multiplied out unless given.

    Returns
    -------
    GeneratingFunction
        Of type 2, with p = ∂F₂/∂q and Q = ∂F₂/∂P to the order; new variables have the names of the old ones with
        ``_new``.

    Raises
    ------
    ValueError
        Where W is no polynomial in ε, or the order is less than 1.

    Examples
    --------
    >>> q, p, eps = sp.symbols("q p epsilon")
    >>> von_zeipel_function(q**2 * p, [q], [p], 3, eps).F
    -epsilon**3*p_new*q**4 + epsilon**2*p_new*q**3 - epsilon*p_new*q**2 + p_new*q
    """
    q, p = given_symbols(q, "q"), given_symbols(p, "p")
    if order < 1:
        raise ValueError(f"the order should be a whole number from 1, not {order}")
    parts = powers_of(given_expression(W, "W"), small, order - 1)
    terms: list[Expr] = []
    for k in range(1, order + 1):
        shifts = [[sp.S.Zero, *(S.diff(x) for S in terms)] for x in q]
        each = (_of_shifted(part, p, shifts, k - 1 - n) for n, part in enumerate(parts[:k]))
        terms.append((plain or sp.expand)(-sp.Add(*each) / k))
    new_q, new_p = (tuple(sp.Symbol(f"{s}_new", real=True) for s in side) for side in (q, p))
    bare = sp.Add(*(x * y for x, y in zip(q, new_p, strict=True)))
    S = sp.Add(*(S * small**k for k, S in enumerate(terms, start=1)))
    return GeneratingFunction(2, bare + substitute(S, dict(zip(p, new_p, strict=True))), q, p, new_q, new_p)


def _of_shifted(f: Expr, p: Sequence[Symbol], shifts: Sequence[Sequence[Expr]], power: int) -> Expr:
    """Return the coefficient of ε^power in f(p + δ), by Taylor's formula, for δ given by its coefficients."""
    total = sp.S.Zero if power else f
    for degree in range(1, power + 1):
        for chosen in combinations_with_replacement(range(len(p)), degree):
            repeated = prod(factorial(chosen.count(i)) for i in {*chosen})
            derivative = cast("Expr", f.diff(*(p[i] for i in chosen)))
            if derivative != 0:
                total += derivative * _coefficient([shifts[i] for i in chosen], power) / repeated
    return total


def _coefficient(series: Sequence[Sequence[Expr]], power: int) -> Expr:
    """Return the coefficient of ε^power in a product of series."""
    product = [sp.S.One, *(sp.S.Zero for _ in range(power))]
    for factor in series:
        known = [*factor, *(sp.S.Zero for _ in range(power + 1))]
        product = [sp.Add(*(product[i] * known[n - i] for i in range(n + 1))) for n in range(power + 1)]
    return product[power]
