"""SymPy's parts of expressions with their static types."""

from __future__ import annotations

from fractions import Fraction
from typing import cast

import sympy as sp

__all__ = ["arguments", "by_name", "free_symbols", "rational", "short"]


def free_symbols(expr: sp.Basic) -> set[sp.Symbol]:
    """Return the free symbols of an expression."""
    return cast("set[sp.Symbol]", expr.free_symbols)


def by_name(expr: sp.Basic) -> list[sp.Symbol]:
    """Return the free symbols of an expression in the order of their names."""
    return sorted(free_symbols(expr), key=lambda s: s.name)


def arguments(expr: sp.Basic) -> tuple[sp.Expr, ...]:
    """Return the arguments of an expression whose arguments are expressions."""
    return cast("tuple[sp.Expr, ...]", expr.args)


def rational(number: object) -> sp.Rational:
    """Return a number that is known to be rational."""
    return cast("sp.Rational", number)


def short(number: float | Fraction, largest: int) -> sp.Rational:
    """Return the rational number nearest to a number among those with a denominator that is not larger.

    Examples
    --------
    >>> short(3.1415926, 10)
    22/7
    """
    near = Fraction(number).limit_denominator(largest)
    return rational(sp.Rational(near.numerator, near.denominator))
