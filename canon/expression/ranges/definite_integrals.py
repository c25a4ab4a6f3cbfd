"""Definite integrals that a formula may hold: of powers, sines, cosines and exponentials, in closed form.

SymPy's ``integrate`` has no bound on its work. Here the integrand is a sum of terms c xⁿ g(ux + v) with g one of sin,
cos, exp, and parts are integrated n times; whatever is of another form is not integrated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.simplify.fu import TR8

if TYPE_CHECKING:
    from sympy import Expr, Symbol

__all__ = ["definite_integral"]

MOST_OPERATIONS = 300
"""Size of an integrand: products of many sines become sums of many terms."""
MOST_POWER = 12
"""Greatest power of the variable, of a sine or of a sum."""


def definite_integral(f: Expr, x: Symbol, lower: Expr, upper: Expr) -> Expr | None:
    """Return ∫ f dx from one bound to the other, None where no closed form is found here.

    Parameters
    ----------
    f
        The integrand.
    x
        The variable; it may stand in the bounds as well, where it means the variable outside.
    lower, upper
        The bounds.

    Examples
    --------
    >>> theta, a = sp.symbols("theta a", positive=True)
    >>> zero = sp.S.Zero
    >>> definite_integral(sp.sin(theta) ** 2, theta, zero, 2 * sp.pi), definite_integral(theta**2, theta, zero, a)
    (pi, a**3/3)
    >>> definite_integral(1 / (1 + sp.cos(theta)), theta, zero, a) is None
    True
    """
    if not _is_short(f, x):
        return None
    waves = f.rewrite([sp.sinh, sp.cosh], sp.exp) if f.has(sp.sinh, sp.cosh) else f
    found: list[Expr] = []
    for term in sp.Add.make_args(_without_products(sp.expand(waves))):
        whole = _antiderivative(term, x, positive=bool(lower.is_positive and upper.is_positive))
        if whole is None:
            return None
        found.append(whole.subs(x, upper) - whole.subs(x, lower))
    return sp.Add(*found)


def _is_short(f: Expr, x: Symbol) -> bool:
    powers = (p.exp for p in f.atoms(sp.Pow) if p.base.has(x) and p.exp.is_Integer)
    return sp.count_ops(f) <= MOST_OPERATIONS and all(abs(exponent) <= MOST_POWER for exponent in powers)


def _without_products(f: Expr) -> Expr:
    """Return a sum in which no term has two sines or cosines as factors."""
    for _ in range(MOST_POWER):
        new = sp.expand(TR8(f))
        if new == f or sp.count_ops(new) > MOST_OPERATIONS**2:
            break
        f = new
    return f


def _antiderivative(term: Expr, x: Symbol, *, positive: bool) -> Expr | None:
    """Return an antiderivative of c xⁿ g(ux + v), None for any other term."""
    if term.is_zero:
        return term
    outside, inside = term.as_independent(x, as_Add=False)
    power, function = sp.S.Zero, None
    for factor in sp.Mul.make_args(inside):
        base, exponent = (factor, sp.S.One) if isinstance(factor, sp.exp) else factor.as_base_exp()
        if base == x and exponent.is_Rational:
            power += exponent
        elif exponent == 1 and isinstance(base, sp.sin | sp.cos | sp.exp) and function is None:
            function = base
        elif factor != 1:
            return None
    if function is None:
        return _of_power(outside, x, power, positive=positive)
    slope = cast("Expr", function.args[0]).diff(x)
    if (
        slope.has(x)
        or sp.expand(function.args[0] - slope * x).has(x)
        or not slope.is_nonzero
        or not (power.is_Integer and 0 <= power <= MOST_POWER)
    ):
        return None  # cos(n x) with n = 0 has another integral
    return outside * _by_parts(int(power), function, x, slope)


def _of_power(outside: Expr, x: Symbol, power: Expr, *, positive: bool) -> Expr | None:
    if not (positive or (power.is_Integer and power >= 0)):
        return None
    return outside * (sp.log(x) if power == -1 else x ** (power + 1) / (power + 1))


def _by_parts(power: int, function: Expr, x: Symbol, slope: Expr) -> Expr:
    """Return the antiderivative of xⁿ g(ux + v), by n integrations by parts."""
    whole: Expr = sp.S.Zero
    factor: Expr = sp.S.One
    for n in range(power, -1, -1):
        function = _integrated(function) / slope
        whole += factor * x**n * function
        factor *= -n
    return whole


def _integrated(g: Expr) -> Expr:
    """Return the antiderivative of a sine, cosine or exponential with respect to its argument.

    Examples
    --------
    >>> _integrated(sp.sin(sp.Symbol("x")) / 2)
    -cos(x)/2
    """
    twins = {
        w: -sp.cos(w.args[0]) if isinstance(w, sp.sin) else sp.sin(w.args[0]) for w in g.atoms(sp.sin, sp.cos)
    }
    return cast("Expr", g.xreplace(twins))
