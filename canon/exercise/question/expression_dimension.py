"""Dimension of an expression from those of its symbols: exact, and only where it is decided.

An expression f of quantities x with dimensions d(x) has the dimension D where it scales with it: that of λ^d(x) x is
λ^D f for every λ > 0 and every base dimension (P. W. Bridgman, Dimensional Analysis, Yale University Press 1922).
Terms of a sum that scale otherwise than their neighbours, and arguments of sines that scale at all, are impossible.
Numbers have no dimension. Nothing is said of logarithms, of exponents that are no numbers and of unknown symbols.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Final

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef

from canon.exercise.sheet.quantities.dimension_texts import NUMBER, Dimension
from canon.expression.symbols.jacobi_functions import JACOBI

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["Clash", "Of", "analysed", "dimension_of"]

MOST_POWER = 1_000
"""Largest numerator or denominator of a power whose dimension is told."""
_OF_NUMBERS = (
    sp.sin, sp.cos, sp.tan, sp.cot, sp.sec, sp.csc, sp.asin, sp.acos, sp.atan, sp.acot, sp.sinh, sp.cosh,
    sp.tanh, sp.coth, sp.asinh, sp.acosh, sp.atanh, sp.exp, sp.LambertW, sp.elliptic_k, sp.elliptic_e, sp.elliptic_f,
    sp.elliptic_pi, *JACOBI, sp.gamma,
)  # fmt: skip
"""Functions of numbers only, whose values are numbers."""
_AS_IT_IS = (sp.Abs, sp.re, sp.im, sp.conjugate)
_OF_ALIKE = (sp.atan2, sp.Max, sp.Min)

_ANY: Final = "any"
"""The dimension of zero."""
Of = tuple[tuple[Expr, Dimension], ...]
"""Expressions, each with its dimension."""


@dataclass(frozen=True)
class Clash:
    """Place of an expression that is dimensionally impossible.

    Parameters
    ----------
    node
        The sum, or the function or power of what should be a number.
    parts
        The terms whose dimension is decided, each with it; or the argument that is no number, with its own.
    all_decided
        Whether there are no other terms.
    """

    node: Expr
    parts: Of
    all_decided: bool = True

    @property
    def is_of_a_sum(self) -> bool:
        """Whether terms differ, not whether an argument is no number."""
        return len(self.parts) > 1


def dimension_of(f: Expr, known: Mapping[str, Dimension]) -> Dimension | None:
    """Return the dimension of an expression, None where it is not decided, or any, as that of 0.

    Parameters
    ----------
    f
        The expression.
    known
        The dimensions of symbols and of arbitrary functions by their names.

    Examples
    --------
    >>> from canon.exercise.sheet.quantities.dimension_texts import dimension_from
    >>> m, x, c = sp.symbols("m x c")
    >>> known = {"m": dimension_from("mass"), "x": dimension_from("length")}
    >>> print(dimension_of(3 * m * sp.sqrt(x), known), dimension_of(m + x, known), dimension_of(c * x, known))
    length^(1/2)*mass None None
    """
    found = _Analysis(known).of(f)
    return found if isinstance(found, Dimension) else None


def analysed(f: Expr, known: Mapping[str, Dimension]) -> tuple[Clash, ...]:
    """Return where an expression is dimensionally impossible, the outermost place first.

    Examples
    --------
    >>> from canon.exercise.sheet.quantities.dimension_texts import dimension_from
    >>> m, x = sp.symbols("m x")
    >>> known = {"m": dimension_from("mass"), "x": dimension_from("length")}
    >>> [clash.node for clash in analysed(x * (m + x) + sp.sin(x), known)]
    [sin(x), m + x]
    """
    analysis = _Analysis(known)
    analysis.of(f)
    return tuple(reversed(analysis.clashes))


class _Analysis:
    """The dimensions of an expression's parts, each found once, and the clashes among them."""

    def __init__(self, known: Mapping[str, Dimension]) -> None:
        self.known = known
        self.found: dict[sp.Basic, Dimension | str | None] = {}
        self.clashes: list[Clash] = []

    def of(self, f: sp.Basic) -> Dimension | str | None:
        if f not in self.found:
            self.found[f] = self._fresh(f)
        return self.found[f]

    def _fresh(self, f: sp.Basic) -> Dimension | str | None:
        if f == 0:
            return _ANY
        if isinstance(f, Symbol):
            return self.known.get(f.name)
        if isinstance(f, Expr) and f.is_number and not f.args:
            return NUMBER
        match f:
            case sp.Add():
                return self._alike(f, f.args)
            case sp.Mul():
                return self._product(f)
            case sp.exp():
                return self._of_a_number(f, f.args)
            case sp.Pow():
                return self._power(f)
            case AppliedUndef():
                return self.known.get(type(f).__name__)
            case sp.Derivative():
                return self._derivative(f)
            case sp.sign():
                return NUMBER
            case _:
                return self._of_a_function(f)

    def _of_a_function(self, f: sp.Basic) -> Dimension | str | None:
        if isinstance(f, _OF_NUMBERS):
            return self._of_a_number(f, f.args)
        if isinstance(f, _AS_IT_IS):
            return self.of(f.args[0])
        if isinstance(f, _OF_ALIKE):
            alike = self._alike(f, f.args)
            return NUMBER if isinstance(f, sp.atan2) and isinstance(alike, Dimension) else alike
        for part in f.args:  # what it is is not known, but what stands in it may be impossible
            if isinstance(part, Expr):
                self.of(part)
        return None

    def _alike(self, f: Expr, terms: tuple[sp.Basic, ...]) -> Dimension | str | None:
        """Return the one dimension of terms that should have the same."""
        found = [(term, self.of(term)) for term in terms]
        decided = tuple((t, d) for t, d in found if isinstance(d, Dimension) and isinstance(t, Expr))
        dimensions = {d for _, d in decided}
        if len(dimensions) > 1:
            self.clashes.append(Clash(f, decided, all(d is not None for _, d in found)))
            return None
        if any(d is None for _, d in found):
            return None
        return dimensions.pop() if dimensions else _ANY

    def _product(self, f: sp.Mul) -> Dimension | str | None:
        whole = NUMBER
        found = [self.of(factor) for factor in f.args]
        if _ANY in found:
            return _ANY
        for dimension in found:
            if not isinstance(dimension, Dimension):
                return None
            whole *= dimension
        return whole

    def _power(self, f: sp.Pow) -> Dimension | str | None:
        base, exponent = f.args
        below = self.of(base)
        if isinstance(exponent, sp.Rational):
            p, q = int(exponent.p), int(exponent.q)
            if not isinstance(below, Dimension) or max(abs(p), q) > MOST_POWER:
                return NUMBER if isinstance(below, Dimension) and below.is_number else None
            return below ** Fraction(p, q)
        as_number = self._of_a_number(f, (exponent,))
        return NUMBER if as_number and isinstance(below, Dimension) and below.is_number else None

    def _of_a_number(self, f: Expr, arguments: tuple[sp.Basic, ...]) -> Dimension | None:
        """Return that a function is a number, None where its arguments are not known to be numbers."""
        decided = True
        for argument in arguments:
            found = self.of(argument)
            if isinstance(found, Dimension) and not found.is_number and isinstance(argument, Expr):
                self.clashes.append(Clash(f, ((argument, found),)))
            decided = decided and found in (_ANY, NUMBER)
        return NUMBER if decided else None

    def _derivative(self, f: sp.Derivative) -> Dimension | None:
        found = self.of(f.expr)
        if not isinstance(found, Dimension):
            return None
        for variable in f.variables:
            by = self.of(variable)
            if not isinstance(by, Dimension):
                return None
            found = found / by
        return found
