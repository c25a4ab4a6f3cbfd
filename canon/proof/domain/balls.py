"""Certified values: an expression at an exact point, enclosed in a complex ball.

Ball arithmetic (python-flint ``acb``, the Arb library: F. Johansson, IEEE Trans. Comput. 66 (2017) 1281,
doi:10.1109/TC.2017.2690633) encloses the true value. Where a ball keeps away from zero the value is
certainly not zero; where it touches a branch cut the enclosure covers both sides, so no sign is guessed.
Principal branches are SymPy's.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import acb, ctx, fmpq, fmpz
from sympy.core.relational import Relational

from canon.proof.domain.ball_functions import CONSTANTS, FUNCTIONS, NotDecided, Undefined, Unmodelled, power

if TYPE_CHECKING:
    from collections.abc import Generator, Mapping

    from sympy import Expr, Symbol

__all__ = ["NotDecided", "Undefined", "Unmodelled", "holds_at", "precision", "value"]


@contextmanager
def precision(bits: int) -> Generator[None]:
    """Run a block at a working precision of ``bits``."""
    before = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = before


def value(expr: Expr, point: Mapping[Symbol, sp.Rational], memo: dict[sp.Basic, acb] | None = None) -> acb:
    """Enclose ``expr`` at ``point`` in a complex ball at the current precision.

    Parameters
    ----------
    expr
        Expression without arbitrary functions.
    point
        An exact rational value for every symbol.
    memo
        Values of subexpressions found before at the same point and precision.

    Raises
    ------
    Undefined
        Where a value is infinite or not a number at any precision.
    NotDecided
        Where the ball is too wide to tell a pole or the piece of a ``Piecewise``.
    Unmodelled
        For functions without a meaning here.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> value(sp.sqrt(x) ** 2 - 2, {x: sp.Integer(2)}).contains(0)
    True
    """
    known: dict[sp.Basic, acb] = {} if memo is None else memo
    return _value(expr, point, known)


def _value(expr: sp.Basic, point: Mapping[Symbol, sp.Rational], memo: dict[sp.Basic, acb]) -> acb:
    found = memo.get(expr)
    if found is None:
        found = _fresh_value(expr, point, memo)
        if not found.is_finite():
            raise NotDecided(f"{expr.func.__name__} is unbounded at this precision")
        memo[expr] = found
    return found


def _fresh_value(expr: sp.Basic, point: Mapping[Symbol, sp.Rational], memo: dict[sp.Basic, acb]) -> acb:
    if isinstance(expr, sp.Rational):
        return acb(fmpq(int(expr.p), int(expr.q)))
    if isinstance(expr, sp.Symbol):
        if expr not in point:
            raise Unmodelled(f"{expr} has no value")
        number = point[expr]
        return acb(fmpq(int(number.p), int(number.q)))
    constant = CONSTANTS.get(expr)
    if constant is not None:
        return constant()
    if isinstance(expr, sp.Piecewise):
        return _piecewise(expr, point, memo)
    arguments = [_value(argument, point, memo) for argument in expr.args]
    if isinstance(expr, sp.Add):
        return _exactly(_sum(arguments), [cast("Expr", expr)], point)
    if isinstance(expr, sp.Mul):
        return _product(arguments)
    if isinstance(expr, sp.Pow):
        return power(arguments[0], arguments[1], expr.exp)
    function = FUNCTIONS.get(expr.func)
    if function is None:
        raise Unmodelled(f"{expr.func.__name__} is not modelled")
    return function(*arguments)


SHORT = 8
"""Terms of a sum that is added up exactly where its ball does not tell whether it is zero."""


def _exactly(ball: acb, terms: list[Expr], point: Mapping[Symbol, sp.Rational]) -> acb:
    """Return an exact ball for a short polynomial that may vanish: a ball around 1/3 − 1/3 has a radius."""
    if not ball.contains(0) or ball.is_zero():
        return ball
    terms = [part for term in terms for part in sp.Add.make_args(term)]
    if len(terms) > SHORT:
        return ball
    found = [_monomial(term, point) for term in terms]
    return ball if None in found else acb(sum(cast("list[fmpq]", found), fmpq(0)))


def _monomial(term: Expr, point: Mapping[Symbol, sp.Rational]) -> fmpq | None:
    """Return the exact value of a rational multiple of powers of symbols, None for anything else."""
    total = fmpq(1)
    for factor in sp.Mul.make_args(term):
        base, exponent = factor.as_base_exp()
        number = point.get(base) if isinstance(base, sp.Symbol) else base
        if not isinstance(number, sp.Rational) or not isinstance(exponent, sp.Rational):
            return None
        if abs(int(exponent.p)) > SHORT or (number == 0 and exponent < 0):
            return None
        root = _root(number, int(exponent.q))
        if root is None:
            return None
        total *= root ** int(exponent.p)
    return total


def _root(number: sp.Rational, degree: int) -> fmpq | None:
    """Return the principal root of a rational number, None where it is not rational."""
    above, below = fmpz(int(number.p)), fmpz(int(number.q))
    if degree == 1:
        return fmpq(above, below)
    if above < 0 or degree > SHORT:
        return None
    roots = above.root(degree), below.root(degree)
    return fmpq(*roots) if roots[0] ** degree == above and roots[1] ** degree == below else None


def _sum(terms: list[acb]) -> acb:
    total = acb(0)
    for term in terms:
        total += term
    return total


def _product(factors: list[acb]) -> acb:
    total = acb(1)
    for factor in factors:
        total *= factor
    return total


def _piecewise(expr: sp.Piecewise, point: Mapping[Symbol, sp.Rational], memo: dict[sp.Basic, acb]) -> acb:
    for piece, condition in cast("tuple[tuple[Expr, sp.Basic], ...]", expr.args):
        if holds_at(condition, point, memo):
            return _value(piece, point, memo)
    raise Undefined("no piece applies")


def holds_at(
    condition: sp.Basic, point: Mapping[Symbol, sp.Rational], memo: dict[sp.Basic, acb] | None = None
) -> bool:
    """Tell whether a condition certainly holds, or certainly does not, at an exact point.

    Raises
    ------
    NotDecided
        Where two sides that should be compared cannot be told apart.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> holds_at(x**2 < 2, {x: sp.Rational(7, 5)})
    True
    """
    known: dict[sp.Basic, acb] = {} if memo is None else memo
    if condition in (sp.true, sp.false):
        return condition == sp.true
    if isinstance(condition, sp.And):
        return all(holds_at(part, point, known) for part in condition.args)
    if isinstance(condition, sp.Or):
        return any(holds_at(part, point, known) for part in condition.args)
    if isinstance(condition, sp.Not):
        return not holds_at(condition.args[0], point, known)
    if not isinstance(condition, Relational):
        raise Unmodelled(f"the condition {condition} is not modelled")
    sides = cast("tuple[Expr, ...]", condition.args)
    left, right = (_value(side, point, known) for side in sides)
    difference = _exactly(left - right, [sides[0], -sides[1]], point)
    return _compare(condition, difference)


def _compare(condition: Relational, difference: acb) -> bool:
    if isinstance(condition, sp.Eq | sp.Ne):
        if difference.is_zero():
            return isinstance(condition, sp.Eq)
        if difference.contains(0):
            raise NotDecided(f"{condition} cannot be told from its opposite")
        return isinstance(condition, sp.Ne)
    if not difference.imag.is_zero():
        if not difference.imag.contains(0):
            raise Undefined(f"{condition} compares complex numbers")
        raise NotDecided(f"{condition} compares numbers not known to be real")
    gap = difference.real
    if isinstance(condition, sp.StrictGreaterThan | sp.GreaterThan):
        gap = -gap
    if gap.is_zero():
        return isinstance(condition, sp.LessThan | sp.GreaterThan)
    if gap < 0:
        return True
    if gap > 0:
        return False
    raise NotDecided(f"{condition} cannot be told from its opposite")
