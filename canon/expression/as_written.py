"""Expressions as they are written: 0/h, h/h and log(1) stay what they are, where SymPy would make numbers of them.

What was left out by evaluation can't be asked any more whether it has a value; here nothing is left out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Rational

from canon.expression.builder import Builder
from canon.expression.parse import syntax_of
from canon.expression.text import syntax
from canon.expression.text.vocabulary import FUNCTIONS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy.logic.boolalg import Boolean

    from canon.expression.text.scope import Scope

__all__ = ["as_written"]


def as_written(text: str, scope: Scope) -> Expr:
    """Return the expression of a text, or lhs − rhs of an equation, with nothing cancelled.

    Only rational numbers are worked out, and what stands under a Derivative.

    Raises
    ------
    LanguageError
        Where the text can't be read; one that :func:`~canon.expression.parse.parse_equation` has read can be.

    Examples
    --------
    >>> from canon import parameters
    >>> from canon.expression.text.scope import Scope
    >>> x = parameters("x")
    >>> as_written("x + 0/x", Scope({"x": x}))
    x + 0/x
    """
    builder = _Unevaluated(text, scope)
    node = syntax_of(text, scope)
    if (sides := syntax.equation(node)) is not None:
        left, right = map(builder.expression, sides)
        return _sum([left, _product([sp.S.NegativeOne, right])])
    return builder.expression(node)


class _Unevaluated(Builder):
    def built(self, node: syntax.Node) -> Expr:
        match node:
            case syntax.Negative(operand):
                return _product([sp.S.NegativeOne, self.expression(operand)])
            case syntax.Sum(terms):
                built = [(minus, self.expression(term)) for minus, term in terms]
                return _sum([_product([sp.S.NegativeOne, term]) if minus else term for minus, term in built])
            case syntax.Product(factors):
                built = [(divides, self.expression(factor)) for divides, factor in factors]
                return _product([_power(f, sp.S.NegativeOne) if divides else f for divides, f in built])
            case syntax.Power(base, exponent):
                return _power(self.expression(base), self.expression(exponent))
            case syntax.Call(function="sqrt", arguments=(radicand,)) if self.is_own("sqrt"):
                return _power(self.expression(radicand), sp.S.Half)
            case syntax.Call(function="Piecewise") if self.is_own("Piecewise"):
                return self.piecewise(node)
            case syntax.Call(name, arguments) if name in FUNCTIONS and self.is_own(name):
                return FUNCTIONS[name][0](*map(self.expression, arguments), evaluate=False)
            case syntax.Call():
                return Builder(self.text, self.scope).built(node)
            case _:
                return super().built(node)

    def is_own(self, name: str) -> bool:
        """Tell whether a name means the function of the language."""
        return name not in self.scope.functions and self.scope.symbol(name) is None

    def finite(self, node: syntax.Node, value: Expr) -> Expr:
        """Return a value whether it is finite or not; what is made of numbers alone must be one that can be read."""
        if not value.args or value.free_symbols:
            return value
        number = Builder(self.text, self.scope).expression(node)
        return number if isinstance(number, Rational) and _is_arithmetic(value) else value

    def joined(self, pieces: Sequence[tuple[Expr, Boolean]]) -> Expr:
        return sp.Piecewise(*pieces, evaluate=False)


def _is_arithmetic(value: Expr) -> bool:
    """Tell whether a number is written with rational numbers alone; sign(1/(√(3 + 2√2) − 1 − √2))² = 1 is not."""
    return all(
        isinstance(part, Rational | sp.Add | sp.Mul) or (isinstance(part, sp.Pow) and part.exp.is_Integer)
        for part in sp.preorder_traversal(value)
    )


def _sum(terms: Sequence[Expr]) -> Expr:
    return sp.Add(*terms, evaluate=all(isinstance(term, Rational) for term in terms))


def _product(factors: Sequence[Expr]) -> Expr:
    return sp.Mul(*factors, evaluate=all(isinstance(factor, Rational) for factor in factors))


def _power(base: Expr, exponent: Expr) -> Expr:
    inverse = isinstance(base, Rational) and base != 0 and exponent == -1
    return sp.Pow(base, exponent, evaluate=inverse)
