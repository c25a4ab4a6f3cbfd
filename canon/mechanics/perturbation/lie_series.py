"""Lie series exp(ε L_W) and Deprit's transform of functions on phase space, as SymPy expressions to an order."""

from __future__ import annotations

from math import comb, factorial
from typing import TYPE_CHECKING, Any

import sympy as sp

from canon.expression.symbols.input_in_words import described
from canon.expression.symbols.user_input import given_expression, given_symbols
from canon.mechanics.hamilton.bracket import poisson_bracket

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from sympy import Expr, Symbol

__all__ = ["deprit_triangle", "lie_deprit", "lie_series", "powers_of"]


def lie_series(
    f: Expr, W: Expr, q: Sequence[Symbol], p: Sequence[Symbol], order: int, small: Expr | int = 1
) -> Expr:
    """Return exp(ε L_W) f = Σ εᵏ/k! L_Wᵏ f to k = order, where L_W f = {f, W}.

    It is f at the place that the flow of W leads to in the time ε (W. Gröbner, Die Lie-Reihen und ihre Anwendungen,
    1960; G.-I. Hori, Publ. Astron. Soc. Jpn. 18, 287 (1966)).

    Parameters
    ----------
    f, W
        Functions of q and p; W without ε.
    q, p
        Coordinates and momenta in the same order.
    order
        The highest k.
    small
        ε.

    Examples
    --------
    >>> q, p, eps = sp.symbols("q p epsilon")
    >>> lie_series(q, (q**2 + p**2) / 2, [q], [p], 3, eps)
    -epsilon**3*p/6 - epsilon**2*q/2 + epsilon*p + q
    """
    q, p = given_symbols(q, "q"), given_symbols(p, "p")
    f, generator = given_expression(f, "f"), given_expression(W, "W")
    _counted(order)
    if not isinstance(small, int) and generator.has(small):
        raise ValueError(f"W depends on {small}; lie_deprit takes such a W")
    term, total = f, f
    for k in range(1, order + 1):
        term = sp.expand(poisson_bracket(term, generator, q, p)) / k
        total += sp.expand(small**k * term)
    return total


def lie_deprit(f: Expr, W: Expr, q: Sequence[Symbol], p: Sequence[Symbol], order: int, small: Symbol) -> Expr:
    """Return f(x(y, ε), ε) to the order in ε, where dx/dε = {x, W(x, ε)} and x = y at ε = 0, by Deprit's triangle.

    With f = Σ fₙ εⁿ/n! and W = Σ Wₙ₊₁ εⁿ/n! it is built from fₙ⁽ᵏ⁺¹⁾ = fₙ₊₁⁽ᵏ⁾ + Σ C(n, m) {fₙ₋ₘ⁽ᵏ⁾, Wₘ₊₁} (A. Deprit,
    Celest. Mech. 1, 12 (1969), doi:10.1007/BF01230629).

    Parameters
    ----------
    f, W
        Functions of q, p and polynomials in ε.
    q, p
        Coordinates and momenta in the same order.
    order
        The highest power of ε.
    small
        ε, a symbol: put a number for it into the result.

    Raises
    ------
    TypeError, ValueError
        Where ε is no symbol, or f or W no polynomial in it.

    Examples
    --------
    >>> q, p, eps = sp.symbols("q p epsilon")
    >>> lie_deprit(q, p + eps * p**2, [q], [p], 2, eps)
    epsilon**2*p + epsilon + q
    """
    q, p = given_symbols(q, "q"), given_symbols(p, "p")
    _counted(order)
    f_parts = powers_of(given_expression(f, "f"), small, order)
    W_parts = powers_of(given_expression(W, "W"), small, order)
    columns = [part * factorial(n) for n, part in enumerate(f_parts)]
    generators = [part * factorial(n) for n, part in enumerate(W_parts)]

    def bracket(a: Expr, b: Expr) -> Expr:
        return sp.expand(poisson_bracket(a, b, q, p))

    images = deprit_triangle(columns, generators, bracket)
    return sp.Add(*(sp.expand(image * small**n / factorial(n)) for n, image in enumerate(images)))


def deprit_triangle(
    column: Sequence[Expr], generators: Sequence[Expr], bracket: Callable[[Expr, Expr], Expr]
) -> list[Expr]:
    """Return f₀⁽⁰⁾, f₀⁽¹⁾, …: the hypotenuse of Deprit's triangle over the column f₀, f₁, …"""
    images, row = [column[0]], [*column]
    while len(row) > 1:
        row = [
            row[n + 1] + sp.Add(*(comb(n, m) * bracket(row[n - m], generators[m]) for m in range(n + 1)))
            for n in range(len(row) - 1)
        ]
        images.append(row[0])
    return images


def powers_of(f: Expr, small: Any, order: int) -> list[Expr]:
    """Return the coefficients of 1, ε … ε^order.

    Raises
    ------
    TypeError, ValueError
        Where ε is no symbol, or f no polynomial in it.
    """
    if not isinstance(small, sp.Symbol):
        raise TypeError(
            f"the small quantity should be a symbol, not {described(small)}; put a number for it last"
        )
    expanded = sp.expand(f)
    if not expanded.is_polynomial(small):
        raise ValueError(f"{f} is no polynomial in {small}; expand it in {small} first")
    coefficients: list[Any] = [expanded.coeff(small, n) for n in range(order + 1)]
    return coefficients


def _counted(order: int) -> None:
    if order < 0:
        raise ValueError(f"the order should be a whole number from 0, not {order}")
