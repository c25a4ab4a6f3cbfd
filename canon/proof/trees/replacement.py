"""Replacement in expressions that SymPy may have no value for, every distinct part rebuilt once."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, TypeVar, cast

import sympy as sp
from sympy.concrete.expr_with_limits import ExprWithLimits
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational
from sympy.functions.elementary.hyperbolic import HyperbolicFunction
from sympy.functions.elementary.trigonometric import InverseTrigonometricFunction, TrigonometricFunction

from canon.expression.symbols.jacobi_functions import JACOBI
from canon.proof.trees.anatomy import Anatomy, anatomy
from canon.proof.trees.bound_variables import BINDING, bound_by

if TYPE_CHECKING:
    from collections.abc import Mapping

    from sympy import Expr

__all__ = ["KINKED", "NoValue", "defined_nowhere", "replaced"]

KINKED = (sp.Max, sp.Min, sp.Abs, sp.sign, sp.Heaviside)
"""Functions that have another formula on either side of a point."""

LARGEST_WRITTEN = 1000
"""Exponents and arguments of factorials and the like that SymPy may write out when a number is put in."""

UNWRITTEN = (
    TrigonometricFunction,
    HyperbolicFunction,
    InverseTrigonometricFunction,
    AppliedUndef,
    sp.exp,
    sp.log,
    sp.Piecewise,
    *JACOBI,
    *KINKED,
)
"""Functions that stay as they are at large numbers."""

NOT_NUMBERS = (*map(type, (sp.nan, sp.zoo, sp.oo, sp.S.NegativeInfinity)), sp.AccumBounds)

LAZY = (sp.Piecewise, ExprWithLimits, sp.Derivative, sp.Subs, sp.Max, sp.Min)
"""Expressions that may have a value though one of their parts has none."""


_B = TypeVar("_B", bound=sp.Basic)


class NoValue(Exception):
    """SymPy gives no value to an expression after a substitution, or one too long to write out or to wait for."""


def replaced(
    expr: _B,
    by: Mapping[sp.Basic, Expr] | Mapping[sp.Basic, sp.Basic],
    deadline: float = float("inf"),
) -> _B:
    """Return ``expr`` after a substitution, every distinct part being rebuilt once.

    Raises
    ------
    NoValue
        Where SymPy refuses a part (Max of an imaginary number, a derivative by an expression, …), where a symbol
        put in or taken out is bound in a sum or an integral that changes, or where SymPy would
        write out a number of very many digits; and where the deadline, a value of :func:`time.monotonic`, passes
        between two parts, for of quotients of quotients SymPy asks in exponential time whether they are infinite.
    """
    done: dict[sp.Basic, sp.Basic] = {}
    found = anatomy([expr])
    exchanged = _free_in(by) if found.has(*BINDING) else set[sp.Basic]()
    for part in found.parts:  # what a part consists of comes before it
        if time.monotonic() > deadline:
            raise NoValue
        inner = tuple(done[a] for a in part.args)
        if part in by:
            done[part] = by[part]
        elif all(new is old for new, old in zip(inner, part.args, strict=True)):
            done[part] = part
        elif _too_long(part, inner):
            raise NoValue
        elif not exchanged.isdisjoint(bound_by(part)):
            done[part] = _but_for_bound(part, inner, by, deadline)
        else:
            try:
                done[part] = _rebuilt(part, inner)
            except (ValueError, TypeError) as reason:
                raise NoValue from reason
    return cast("_B", done[expr])


def _free_in(by: Mapping[sp.Basic, sp.Basic]) -> set[sp.Basic]:
    return set[sp.Basic]().union(*(e.free_symbols for pair in by.items() for e in pair))


def _but_for_bound(
    part: sp.Basic, inner: tuple[sp.Basic, ...], by: Mapping[sp.Basic, sp.Basic], deadline: float
) -> sp.Basic:
    """Replace in a substitution, inside which its own variables are others than the free ones of their names."""
    bound = bound_by(part)
    outside = {old: new for old, new in by.items() if bound.isdisjoint(old.free_symbols)}
    if not isinstance(part, sp.Subs) or not bound.isdisjoint(_free_in(outside)):
        raise NoValue
    return part.func(replaced(part.args[0], outside, deadline), part.args[1], inner[2])


def _rebuilt(part: sp.Basic, inner: tuple[sp.Basic, ...]) -> sp.Basic:
    """Put a part together again; relations stay unevaluated, for SymPy may think about them without end.

    SymPy makes acot(−x) to −acot x, which is wrong at x = 0.
    """
    if isinstance(part, Relational) and not all(isinstance(a, sp.Rational | sp.Symbol) for a in inner):
        return part.func(*inner, evaluate=False)
    if isinstance(part, sp.acot) and inner[0].free_symbols:
        return part.func(*inner, evaluate=False)
    return part.func(*inner)


def _too_long(part: sp.Basic, inner: tuple[sp.Basic, ...]) -> bool:
    """Tell whether SymPy may write out a power, factorial or sum of very many digits or terms."""
    if isinstance(part, sp.Pow):
        base, exponent = inner
        new = exponent is not part.exp or (base.is_number and base not in (0, 1, -1))
        return isinstance(exponent, sp.Rational) and abs(exponent) > LARGEST_WRITTEN and new
    if isinstance(part, sp.exp) and inner[0].has(sp.log):
        return any(abs(r) > LARGEST_WRITTEN for r in inner[0].atoms(sp.Rational))
    if isinstance(part, sp.Function) and not isinstance(part, UNWRITTEN):
        return any(isinstance(a, sp.Rational) and abs(a) > LARGEST_WRITTEN for a in inner)
    return False


def defined_nowhere(expr: sp.Basic, found: Anatomy | None = None) -> bool:
    """Tell whether a part that is not a finite number leaves the whole without a value.

    A piece that does not apply, a bound of a sum or an argument of Max that loses need not have one.
    What the expression consists of may be given where it is known.
    """
    parts = (found or anatomy([expr])).parts  # what a part consists of comes before it
    poisoned: set[sp.Basic] = {part for part in parts if isinstance(part, NOT_NUMBERS)}
    if not poisoned:
        return False
    for part in parts:
        if not (isinstance(part, LAZY) or poisoned.isdisjoint(part.args)):
            poisoned.add(part)
    return expr in poisoned
