"""Table integrals of single terms, found quickly or not at all.

SymPy's rules may search for minutes where functions are nested, so they are only asked about products that are
plain in the variable: one function of a linear argument, or an algebraic factor, times a power.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol
from sympy.integrals.manualintegrate import manualintegrate

from canon.mechanics.algebra.substitution import exchanged, size

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["table_integral"]

_LARGEST = 70
"""Nodes of a term above which it is not tried."""


def table_integral(term: Expr, s: Symbol) -> Expr | None:
    """Integrate one term with respect to s; None where it is not plain enough.

    Examples
    --------
    >>> from sympy import cos, exp, sin, symbols
    >>> x, y = symbols("x y")
    >>> table_integral(2*x*y*cos(x**2), x), table_integral(x*exp(y*x), y)
    (y*sin(x**2), exp(x*y))
    >>> table_integral(sin(x + exp(x)), x) is None
    True
    """
    if not term.has(s):
        return term * s
    if size(term) > _LARGEST:
        return None
    for candidate in _by_substitution(term, s):
        return candidate
    return _by_rules(term, s) if _is_plain(term, s) else None


def _by_substitution(term: Expr, s: Symbol) -> Iterator[Expr]:
    """Where the term is c g(u) u′ with c free of s, c ∫ g du."""
    for g in sp.Mul.make_args(term):
        if not g.has(s) or g == s:
            continue
        for u in _inner(g):
            slope = u.diff(s)
            if slope == 0 or not u.has(s) or u == s:
                continue
            rest = sp.cancel(term / (g * slope))
            if rest.has(s):
                continue
            place = sp.Dummy("u", real=True)
            integral = _by_rules(exchanged(g, {u: place}), place)
            if integral is not None and not exchanged(g, {u: place}).has(s):
                yield rest * exchanged(integral, {place: u})


def _inner(g: Expr) -> list[Expr]:
    """Return the argument of a function, or the base of a power and that base's argument."""
    base, exponent = g.as_base_exp()
    if isinstance(g, sp.exp):
        return [cast("Expr", g.args[0])]
    found = [base] if exponent != 1 else []
    if isinstance(base, sp.Function) and len(base.args) == 1:
        found.append(cast("Expr", base.args[0]))
    return found


def _is_plain(term: Expr, s: Symbol) -> bool:
    """Whether the factors are powers of s and either functions of one linear argument or one algebraic factor."""
    arguments: set[Expr] = set()
    functions = algebraic = 0
    for factor in sp.Mul.make_args(term):
        base, exponent = factor.as_base_exp()
        if not factor.has(s) or (base == s and exponent.is_Rational):
            continue
        if isinstance(factor, sp.exp) or (isinstance(base, sp.Function) and len(base.args) == 1):
            arguments.add(cast("Expr", factor.args[0] if isinstance(factor, sp.exp) else base.args[0]))
            functions += 1
        elif exponent.is_Rational and base.is_polynomial(s) and sp.Poly(base, s).degree() <= 2:
            algebraic += 1
        else:
            return False
    linear = all(u.diff(s) != 0 and not u.diff(s).has(s) for u in arguments)
    return linear and len(arguments) <= 1 and functions <= 2 and algebraic <= (0 if functions else 1)


def _by_rules(term: Expr, s: Symbol) -> Expr | None:
    integral: sp.Basic = sp.piecewise_fold(manualintegrate(term, s))
    if isinstance(integral, sp.Piecewise):
        integral, _ = integral.args[0].args  # whoever uses this case proves what comes of it
    if not isinstance(integral, Expr) or integral.has(sp.Integral, sp.Piecewise):
        return None
    return integral
