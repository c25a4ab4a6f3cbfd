"""The formula that applies around a point: pieces, moduli and maxima replaced by what they are there."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.relational import Relational

from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, value
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.replacement import KINKED
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from sympy import Expr, Symbol

__all__ = ["NoPiece", "formula_around", "holds_around", "neighbourhood", "put_in"]


LARGEST_GAP = 200
"""Size of a function that is written out."""


class NoPiece(Exception):
    """No condition of a Piecewise holds at a point, nor at any near it."""


def formula_around(expr: Expr, point: Mapping[Symbol, sp.Rational]) -> Expr:
    """Return an expression without pieces that equals the given one in a neighbourhood of a point.

    Only conditions that hold, or fail, strictly at the point are used, so that they do so around it.

    Raises
    ------
    NoPiece
        Where no piece applies.
    NotDecided
        At a bound of a piece, or so near it that the precision does not tell.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> formula_around(abs(x) + sp.Piecewise((1, x > 2), (x**2, True)), {x: sp.Integer(-1)})
    x**2 - x
    """
    return cast("Expr", _Neighbourhood(point).formula(expr))


def neighbourhood(
    exprs: Iterable[Expr], point: Mapping[Symbol, sp.Rational]
) -> tuple[list[Expr], dict[Expr, int]]:
    """Return formulas of expressions around a point, and the signs there of what their pieces turn on.

    Where these signs are the same the expressions equal the formulas.

    Raises
    ------
    NoPiece, NotDecided
        As :func:`formula_around` does.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> neighbourhood([abs(x - abs(y))], {x: sp.Integer(1), y: sp.Integer(-2)})
    ([-x - y], {y: -1, x + y: -1})
    """
    around = _Neighbourhood(point)
    return [cast("Expr", around.formula(expr)) for expr in exprs], around.gaps()


def holds_around(condition: sp.Basic, point: Mapping[Symbol, sp.Rational]) -> bool:
    """Tell whether a condition certainly holds in a neighbourhood of a point.

    Raises
    ------
    NotDecided
        At a bound, or so near it that the precision does not tell.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> holds_around(sp.Or(x <= 0, sp.Eq(x, 5)), {x: sp.Integer(-1)})
    True
    """
    return _Neighbourhood(point).holds(condition)


def put_in(expr: Expr, by: Mapping[sp.Basic, sp.Basic]) -> Expr:
    """Return an expression with parts exchanged for others, and nothing cancelled.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> put_in(x / y, {y: x})
    x/x
    """
    done: dict[sp.Basic, sp.Basic] = {}
    for part in anatomy([expr]).parts:  # what a part consists of comes before it
        inner = [done[a] for a in part.args]
        if part in by:
            done[part] = by[part]
        elif all(new is old for new, old in zip(inner, part.args, strict=True)):
            done[part] = part
        else:
            done[part] = _rebuilt(part, inner)
    return cast("Expr", done[expr])


def _rebuilt(part: sp.Basic, inner: Sequence[sp.Basic]) -> sp.Basic:
    rebuild = cast("Callable[..., sp.Basic]", part.func)
    kept = isinstance(part, sp.Add | sp.Mul | sp.Pow | sp.Function | Relational)
    return rebuild(*inner, evaluate=False) if kept else rebuild(*inner)


def _written_out(gap: Expr) -> Expr:
    """Return a small function as a sum: moduli that were put in leave brackets."""
    if anatomy([gap]).tree > LARGEST_GAP:
        return gap
    return cast("Expr", sp.expand(gap, log=False, power_base=False, power_exp=False))


class _Neighbourhood:
    def __init__(self, point: Mapping[Symbol, sp.Rational]) -> None:
        self.point = point
        self.known: dict[sp.Basic, sp.Basic] = {}
        self.signs: dict[Expr, int] = {}

    def formula(self, part: sp.Basic) -> sp.Basic:
        if part not in self.known:
            self.known[part] = self._fresh(part)
        return self.known[part]

    def _fresh(self, part: sp.Basic) -> sp.Basic:
        if isinstance(part, sp.Piecewise):
            return self._piece(part)
        if not part.args or isinstance(part, Relational):
            return part
        inner = [self.formula(a) for a in part.args]
        if isinstance(part, KINKED):
            return self._smooth(part, cast("list[Expr]", inner))
        if all(new is old for new, old in zip(inner, part.args, strict=True)):
            return part
        return _rebuilt(part, inner)

    def _piece(self, part: sp.Piecewise) -> sp.Basic:
        for piece, condition in cast("tuple[tuple[Expr, sp.Basic], ...]", part.args):
            if self.holds(condition):
                return self.formula(piece)
        raise NoPiece

    def holds(self, condition: sp.Basic) -> bool:
        if condition in (sp.true, sp.false):
            return condition == sp.true
        if isinstance(condition, sp.And):
            return all(self.holds(c) for c in condition.args)
        if isinstance(condition, sp.Or):
            return any(self.holds(c) for c in condition.args)
        if isinstance(condition, sp.Not):
            return not self.holds(condition.args[0])
        if not isinstance(condition, Relational):
            raise Unmodelled(f"the condition {condition} is not modelled")
        left, right = arguments(condition)
        sign = self._sign(left - right)
        match condition:
            case sp.Eq():
                return False
            case sp.Ne():
                return True
            case sp.StrictLessThan() | sp.LessThan():
                return sign < 0
            case _:
                return sign > 0

    def _sign(self, gap: Expr) -> int:
        """Return the sign of something that is certainly not zero at the point."""
        ball = value(gap, self.point)
        if ball.contains(0):
            raise NotDecided("a bound of a piece")
        if not ball.imag.is_zero():
            raise Undefined("complex numbers are compared")
        sign = 1 if ball.real > 0 else -1
        if gap.free_symbols:
            self.signs[gap] = sign
        return sign

    def gaps(self) -> dict[Expr, int]:
        """Return the signs of what was asked, as formulas around the point; |q| < 1 stays so at its kink q = 0."""
        found: dict[Expr, int] = {}
        for gap, sign in list(self.signs.items()):
            try:
                formula = cast("Expr", self.formula(gap))
            except (NoPiece, NotDecided, Undefined, Unmodelled):
                formula = gap
            found[_written_out(formula)] = sign
        return found | {_written_out(gap): sign for gap, sign in self.signs.items() if not gap.has(*KINKED)}

    def _smooth(self, part: sp.Basic, inner: list[Expr]) -> sp.Basic:
        if isinstance(part, sp.Max | sp.Min):
            best = inner[0]
            for other in inner[1:]:
                if (other - best).is_zero is not True and self._sign(other - best) == (
                    1 if isinstance(part, sp.Max) else -1
                ):
                    best = other
            return best
        u = inner[0]
        try:
            sign = self._sign(u)
        except Undefined:
            return part.func(*inner)
        if isinstance(part, sp.Abs):
            return sign * u
        return sp.Integer((1 + sign) // 2 if isinstance(part, sp.Heaviside) else sign)
