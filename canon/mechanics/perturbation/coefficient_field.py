"""Coefficient fields: the smallest field that holds the constants of a Hamiltonian, and polynomials over it."""

from __future__ import annotations

from math import prod
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.perturbation.phase_polynomial import PolynomialRing

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

__all__ = ["NoExactFieldError", "ring_over"]


LARGEST_DEGREE = 8
"""The largest degree of a field of numbers: beyond it a primitive element takes minutes."""


class NoExactFieldError(ValueError):
    """Raised where constants lie in no field that exact polynomials are computed over."""


def ring_over(constants: Iterable[Expr], size: int) -> PolynomialRing:
    """Return the polynomials in ``size`` phase variables over a field that holds these constants.

    Raises
    ------
    NoExactFieldError
        Where the constants have functions of parameters, or several independent roots of them.

    Examples
    --------
    >>> k, m = sp.symbols("k m", positive=True)
    >>> ring_over([sp.sqrt(k / m)], 2).root
    sqrt(k)*sqrt(m)
    >>> ring_over([sp.sqrt(2), sp.sqrt(3)], 2).relation
    (1, 0, -10, 0, 1)
    """
    values: list[Any] = [sp.sympify(c, strict=True) for c in constants]
    parameters: tuple[Symbol, ...] = tuple(sorted({s for c in values for s in c.free_symbols}, key=str))
    radicals: set[Any] = {r for c in values for r in c.atoms(sp.Pow) if not r.exp.is_Integer}
    strange = sorted(
        {f for c in values for f in c.atoms(sp.Function, sp.NumberSymbol)} | _powers(radicals), key=str
    )
    if strange:
        raise NoExactFieldError(
            f"{strange[0]} is no algebraic number and no rational function of parameters; "
            "write a parameter for it, and put its value into the result"
        )
    if not radicals:
        return PolynomialRing(size, parameters)
    if any(r.free_symbols for r in radicals):
        return _with_square_root(_radical_parts(values), size, parameters)
    if prod(int(r.exp.q) for r in radicals) > LARGEST_DEGREE:
        raise NoExactFieldError(
            f"the roots {', '.join(sorted(map(str, radicals)))} make a field of too large a degree; "
            "take parameters with simpler values"
        )
    field = sp.QQ.algebraic_field(*sorted(radicals, key=sp.default_sort_key))
    return _with_number(field, size, parameters)


def _with_number(field: Any, size: int, parameters: tuple[Symbol, ...]) -> PolynomialRing:
    """Return the ring over a field of numbers, whose generator is multiplied until its equation has whole numbers."""
    found: list[Any] = [
        sp.Rational(int(c.numerator), int(c.denominator)) for c in reversed(field.mod.to_list())
    ]
    monic, degree = [c / found[-1] for c in found], len(found) - 1
    factor = sp.ilcm(*(c.q for c in monic))
    relation = tuple(c * factor ** (degree - k) for k, c in enumerate(monic))
    return PolynomialRing(size, parameters, factor * field.ext.as_expr(), relation)


def _radical_parts(values: Iterable[Any]) -> list[Expr]:
    """Return the product of the roots in each term of some sums."""
    sums = (sp.Add.make_args(sp.expand(value)) for value in values)
    terms: list[list[Any]] = [list(sp.Mul.make_args(term)) for several in sums for term in several]
    products: Iterator[Any] = (
        sp.Mul(*(f for f in factors if f.is_Pow and not f.exp.is_Integer)) for factors in terms
    )
    return sorted({product for product in products if product != 1}, key=sp.default_sort_key)


def _with_square_root(radicals: list[Expr], size: int, parameters: tuple[Symbol, ...]) -> PolynomialRing:
    """Return the ring over ℚ(parameters)(r) where r² is the one radicand beside squares."""
    squares = [sp.factor(r**2) for r in radicals]
    above, below = sp.fraction(squares[0])
    radicand = sp.expand(_without_squares(above * below))
    if any(_is_no_square(sp.factor(s / radicand)) for s in squares):
        raise NoExactFieldError(
            f"{', '.join(map(str, radicals))} are independent roots; "
            "give frequencies names, as in p**2/(2*m) + m*omega**2*q**2/2"
        )
    return PolynomialRing(size, parameters, sp.sqrt(radicand), (-radicand, sp.S.Zero, sp.S.One))


def _without_squares(product: Expr) -> Expr:
    found: Any = sp.factor_list(product)
    number, factors = found
    return number * sp.Mul(*(f for f, times in factors if times % 2))


def _is_no_square(ratio: Any) -> bool:
    return any(not f.exp.is_Integer for f in _roots(sp.powdenest(sp.sqrt(ratio))))


def _powers(radicals: Iterable[Any]) -> set[Any]:
    return {r for r in radicals if not r.exp.is_Rational}


def _roots(value: Any) -> set[Any]:
    return value.atoms(sp.Pow)
