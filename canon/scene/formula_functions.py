"""Functions in the formulas of scenes: SymPy's, loaded when one is first called; a list of scenes needs none."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from sympy import Expr

__all__ = ["Add", "Integer", "Rational", "asin", "cos", "exp", "sin", "sqrt"]


def _late(name: str) -> Callable[..., Expr]:
    def function(*arguments: Any) -> Expr:
        import sympy

        return getattr(sympy, name)(*arguments)

    return function


cos, sin, asin, exp, sqrt = map(_late, ("cos", "sin", "asin", "exp", "sqrt"))
Add, Integer, Rational = map(_late, ("Add", "Integer", "Rational"))
