"""Functions that vanish everywhere or almost nowhere, and functions proved to vanish nowhere.

Real-analytic functions on a connected domain have no zero divisors: one nonzero value makes such a function
nonzero at generic points. Functions with pieces do not: x + |x| is zero for all x < 0.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.function import AppliedUndef, Derivative
from sympy.polys.polyerrors import PolynomialError

from canon.expression.symbols.jacobi_functions import JACOBI
from canon.proof.domain.domain import Domain
from canon.proof.domain.limits import QUICK, Full, OutOfTime, TooLarge
from canon.proof.domain.reality import certainly_real
from canon.proof.domain.relations import linear, parts_of
from canon.proof.functions.angles import Refine
from canon.proof.functions.normal_form import NormalForm
from canon.proof.rungs.ladder import MOST_STARTS, REFUSALS
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable
    from typing import Any

    from sympy import Expr
    from sympy.logic.boolalg import Boolean

__all__ = ["is_analytic", "is_positive_between", "is_uncut", "parting", "proved_sign"]

SECONDS = 0.5
"""Time for the sign of one expression."""

ENTIRE = (sp.Add, sp.Mul, sp.exp, sp.sin, sp.cos, sp.tan, sp.cot, sp.sec, sp.csc, sp.sinh, sp.cosh, sp.tanh)
"""Operations and functions that are analytic wherever they are defined, at complex arguments too."""


def is_analytic(exprs: Iterable[Expr], domain: Domain) -> bool:
    """Tell whether expressions are certainly analytic on one connected set that holds the domain.

    The set is convex: what the symbols' signs and the linear conditions leave. Roots and logarithms count
    where the radicand is proved positive there, square roots also where it is a nonnegative polynomial
    without square factors, whose zeros then have codimension 2 and cut nothing in two. What has more than one
    branch may not be taken of poles, which cut a line in two: atan(1/x) jumps where 1/x has one, and no less so where x
    is declared nonzero: in the convex set such a symbol is any real number. Nonlinear equalities leave several sheets
    and are declined.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> is_analytic([sp.sqrt(x**2 + y**2), sp.sin(x)], Domain()), is_analytic([x + abs(x)], Domain())
    (True, False)
    """
    conditions = list(parts_of(domain.conditions))
    if any(isinstance(c, sp.Eq) and not linear(c) for c in conditions):
        return False
    kinds = (sp.StrictLessThan, sp.LessThan, sp.StrictGreaterThan, sp.GreaterThan)
    bounds = [c for c in conditions if isinstance(c, kinds) and linear(c)]
    exprs = list(exprs)
    plain: dict[sp.Basic, Expr] = {s: sp.Dummy(s.name, real=True) for s in parting((*exprs, *bounds))}
    hull = Domain(tuple(cast("Boolean", c.xreplace(plain)) for c in bounds))
    seen: dict[sp.Basic, bool] = {}
    return all(_analytic(expr.xreplace(plain) if plain else expr, hull, seen) for expr in exprs)


def parting(exprs: Iterable[sp.Basic]) -> set[sp.Symbol]:
    """Return the symbols that are declared nonzero and of neither sign: their values are two half-lines.

    Examples
    --------
    >>> x, y = sp.Symbol("x", real=True, nonzero=True), sp.Symbol("y", positive=True)
    >>> parting([x * y])
    {x}
    """
    symbols = anatomy(list(exprs)).symbols
    return {s for s in symbols if s.is_real and s.is_nonzero and not (s.is_positive or s.is_negative)}


def _analytic(expr: sp.Basic, hull: Domain, seen: dict[sp.Basic, bool]) -> bool:
    found = seen.get(expr)
    if found is None:
        found = seen[expr] = _fresh(expr, hull, seen)
    return found


def _fresh(expr: sp.Basic, hull: Domain, seen: dict[sp.Basic, bool]) -> bool:
    if isinstance(expr, sp.Symbol):
        return not expr.is_integer
    if isinstance(expr, Derivative):
        return _analytic(expr.expr, hull, seen)
    if not all(_analytic(a, hull, seen) for a in expr.args):
        return False
    match expr:
        case sp.Pow():
            return expr.exp.is_integer is True or is_uncut(expr.base, expr.exp, hull)
        case sp.log() if len(expr.args) == 1:
            return proved_sign(arguments(expr)[0], hull) == "+" and _without_poles(arguments(expr)[0], hull)
        case sp.atan() | sp.asinh():
            return certainly_real(arguments(expr)[0]) and _without_poles(arguments(expr)[0], hull)
        case _ if isinstance(expr, JACOBI):
            return all(certainly_real(a) and _without_poles(a, hull) for a in arguments(expr))
        case _:
            return isinstance(expr, (*ENTIRE, AppliedUndef)) or (isinstance(expr, sp.Expr) and expr.is_number)


def is_uncut(base: Expr, exponent: Expr, hull: Domain) -> bool:
    """Tell whether a power with an exponent that is not whole has one analytic branch on the hull."""
    if base.is_number:
        return True
    sign = "+" if base.is_positive else proved_sign(base, hull)
    if not sign or not _without_poles(base, hull):
        return False
    if sign == "+":
        return True
    if sign != "0+" or not isinstance(exponent, sp.Rational) or exponent.q != 2:
        return False
    try:
        return all(e == 1 for _, e in sp.Poly(base, *base.free_symbols, domain="QQ").factor_list()[1])
    except PolynomialError:
        return False


def _without_poles(expr: Expr, hull: Domain) -> bool:
    """Tell whether no denominator of an expression, written as a tangent perhaps, vanishes on the hull."""
    found = anatomy([expr])
    denominators: list[Expr] = [e.base for e in found.of(sp.Pow) if not e.exp.is_nonnegative]
    denominators += [sp.cos(e.args[0]) for e in found.of(sp.tan, sp.sec)]
    denominators += [sp.sin(e.args[0]) for e in found.of(sp.cot, sp.csc)]
    return all(d.is_nonzero or proved_sign(d, hull) in ("+", "-") for d in denominators)


def is_positive_between(expr: Expr, domain: Domain) -> bool:
    """Tell whether an expression is positive because it is so at the ends: linear in cos² u, or in cos u.

    Examples
    --------
    >>> t = sp.Symbol("t", real=True)
    >>> a, b = sp.symbols("a b", positive=True)
    >>> is_positive_between(a * sp.sin(t) ** 2 + b * sp.cos(t) ** 2, Domain())
    True
    >>> is_positive_between(sp.sin(t) ** 2 + sp.cos(t), Domain())
    False
    """
    angles = {arguments(part)[0] for part in expr.atoms(sp.sin, sp.cos)}
    if len(angles) != 1:
        return proved_sign(expr, domain) == "+"
    (angle,) = angles
    c, s = sp.Dummy("c", real=True), sp.Dummy("s", real=True)
    try:
        circular = sp.Poly(expr.xreplace({sp.cos(angle): c, sp.sin(angle): s}), s, c)
    except PolynomialError:
        return False
    if any(power % 2 for power, _ in circular.monoms()):
        return False
    inner = sp.Poly(circular.as_expr().subs(s, sp.sqrt(1 - c**2)), c)
    if inner.degree() == 1:
        ends = (1, -1)
    elif inner.degree() == 2 and inner.coeff_monomial(c) == 0:
        ends = (1, 0)
    else:
        return False
    return all(proved_sign(cast("Expr", inner.eval(end)), domain) == "+" for end in ends)


def proved_sign(expr: Expr, domain: Domain) -> str:
    """Return the proven sign of an expression on a domain: "+", "0+", "-", "0-", or "" where none is proved.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> proved_sign(x**2 + 1, Domain()), proved_sign(x, Domain())
    ('+', '')
    >>> a = sp.Symbol("a", real=True, nonzero=True)
    >>> proved_sign(a**2, Domain()), proved_sign(x**2, Domain())
    ('+', '0+')
    """
    parts: dict[Hashable, Any] = {}
    capacity = 16
    deadline = time.monotonic() + SECONDS
    for _ in range(MOST_STARTS):
        try:
            forms = NormalForm(domain, parts, deadline, QUICK, capacity)
            sign = forms.sign(forms.form(expr))
            return sign.removeprefix("0") if expr.is_nonzero else sign
        except Refine:
            continue
        except Full:
            capacity *= 2
        except (OutOfTime, TooLarge, *REFUSALS):
            break
    return ""
