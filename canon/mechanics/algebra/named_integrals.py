"""Named integrals: parts of a potential that are quadratures, given a name and left unevaluated.

With an arbitrary function f the form f(u) du has the potential ∫ f(s) ds up to s = u, and a coefficient that depends on
its own variable only has its integral, whether a table holds it or not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol
from sympy.core.function import AppliedUndef
from sympy.core.symbol import uniquely_named_symbol

from canon.mechanics.algebra.substitution import exchanged
from canon.proof.analytic import is_analytic, proved_sign
from canon.proof.domain.domain import EVERYWHERE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

__all__ = ["quadratures"]


def quadratures(form: Sequence[Expr], z: Sequence[Symbol]) -> tuple[Expr, list[Expr]]:
    """Return the part of the potential Σ ∫ … ds that is named, and what is left of the form.

    Integrals begin at 0; at 1 or −1 where their end can't be 0. What may be singular on the way stays in the form.

    Parameters
    ----------
    form
        The coefficients aⱼ of a closed form.
    z
        Its variables.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> f, g = sp.symbols("f g", cls=sp.Function)
    >>> quadratures([g(x) + f(x + y), f(x + y) + x + 1/x], [x, y])
    (Integral(f(s), (s, 0, x + y)) + Integral(g(s), (s, 0, x)), [0, x + 1/x])
    """
    rest = [cast("Expr", sp.expand(a)) for a in form]
    parts: list[Expr] = []
    for part, gradient in _of_functions(rest, z):
        parts.append(part)
        rest = [cast("Expr", sp.expand(a - b)) for a, b in zip(rest, gradient, strict=True)]
    for j, own in enumerate(z):
        others = [other for other in z if other != own]
        alone = [term for term in sp.Add.make_args(rest[j]) if term.has(own) and not term.has(*others)]
        for term in alone:
            part = _of_one_variable(term, own)
            if part is not None:
                parts.append(part)
                rest[j] -= term
    return sp.Add(*parts), rest


def _of_functions(form: Sequence[Expr], z: Sequence[Symbol]) -> Iterator[tuple[Expr, list[Expr]]]:
    """Yield k ∫ f(s) ds up to s = u for each part k f(u) du of the form, and this part."""
    found = sorted(set[AppliedUndef]().union(*(a.atoms(AppliedUndef) for a in form)), key=sp.default_sort_key)
    for applied in found:
        moving = [u for u in cast("tuple[Expr, ...]", applied.args) if u.has(*z)]
        if len(moving) != 1:
            continue
        coefficients = [cast("Expr", a.coeff(applied)) for a in form]
        factor = _common_ratio(coefficients, [moving[0].diff(s) for s in z])
        if factor is None or factor == 0 or factor.has(*z):
            continue
        integral = _integral(lambda s, f=applied, u=moving[0]: exchanged(f, {u: s}), moving[0])
        if integral is not None:
            yield factor * integral, [c * applied for c in coefficients]


def _common_ratio(above: Sequence[Expr], below: Sequence[Expr]) -> Expr | None:
    """Return a/b, where it is the same for all pairs in which not both are zero."""
    pairs = [(a, b) for a, b in zip(above, below, strict=True) if a != 0 or b != 0]
    ratios = {sp.cancel(a / b) if b != 0 else None for a, b in pairs}
    return ratios.pop() if len(ratios) == 1 else None


def _of_one_variable(term: Expr, x: Symbol) -> Expr | None:
    """Return ∫ a(s) ds up to x, by parts where a = u df/dx."""
    constant, moving = term.as_independent(x, as_Add=False)
    for slope in sp.Mul.make_args(moving):
        if isinstance(slope, sp.Derivative) and slope.variables == (x,):
            factor, f = moving / slope, cast("Expr", slope.expr)
            if not factor.has(AppliedUndef):
                rest = factor.diff(x) * f
                integral = sp.S.Zero if rest == 0 else _of_one_variable(rest, x)
                return None if integral is None else constant * (factor * f - integral)
    integral = _integral(lambda s: exchanged(moving, {x: s}), x)
    return None if integral is None else constant * integral


def _integral(integrand_of: Callable[[Symbol], Expr], end: Expr) -> Expr | None:
    """Return the integral from 0, or from 1 or −1 on the side where its end lies; None where it may be singular."""
    sign, start = ("positive", 1) if end.is_positive else ("negative", -1) if end.is_negative else ("real", 0)
    taken = integrand_of(sp.Dummy())
    free = cast("Symbol", uniquely_named_symbol("s", [taken, end]))
    s = Symbol(free.name, **{sign: True})
    integrand = integrand_of(s)
    regular = is_analytic([integrand], EVERYWHERE) and all(
        proved_sign(power.base, EVERYWHERE) in ("+", "-")
        for power in integrand.atoms(sp.Pow)
        if power.exp.is_negative is not False and power.has(s)
    )
    return sp.Integral(integrand, (s, start, end)) if regular else None
