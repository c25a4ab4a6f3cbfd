"""Taylor expansion of a Hamiltonian by degree, exactly, without differentiating it in many variables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import sympy as sp
from flint import fmpq
from sympy import Expr, Symbol

from canon.mechanics.perturbation.lie_transform import added, truncated_product

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from canon.mechanics.perturbation.phase_polynomial import PhasePolynomial, PolynomialRing

__all__ = ["NotAnalyticError", "constants_in", "homogeneous_parts", "refuse_kinks"]

Parts = dict[int, "PhasePolynomial"]


class NotAnalyticError(ValueError):
    """Raised for a function that has no Taylor series at the point."""


KINKS = (
    sp.Abs,
    sp.sign,
    sp.Max,
    sp.Min,
    sp.Piecewise,
    sp.floor,
    sp.ceiling,
    sp.re,
    sp.im,
    sp.conjugate,
    sp.Heaviside,
)


def refuse_kinks(f: Expr, variables: Sequence[Symbol]) -> None:
    """Refuse a function of pieces, moduli or maxima of the variables.

    Raises
    ------
    NotAnalyticError
        Where f has one.
    """
    pieces: list[Any] = sorted(f.atoms(*KINKS), key=str)
    for part in pieces:
        if part.has(*variables):
            raise NotAnalyticError(
                f"{part} has no Taylor series where it has a kink; take the piece that applies"
            )


def constants_in(f: Any, variables: Sequence[Symbol]) -> Iterator[Expr]:
    """Yield the constants that the coefficients of a Taylor series at 0 are made of."""
    if not f.has(*variables):
        yield f
    elif f.is_Add or f.is_Mul:
        for part in f.args:
            yield from constants_in(part, variables)
    elif f not in variables:
        inner = _inside(f, variables)
        if not (f.is_Pow and f.exp.is_Integer):
            yield from (c for c in _derivatives(f, inner, inner.subs(dict.fromkeys(variables, 0)), 2))
        yield from constants_in(inner, variables)


def homogeneous_parts(f: Expr, variables: Sequence[Symbol], ring: PolynomialRing, order: int) -> Parts:
    """Return the parts of degree 0 … order of the Taylor series of f at 0; those that vanish are left out.

    Raises
    ------
    NotAnalyticError
        Where f has no Taylor series at 0.

    Examples
    --------
    >>> from canon.mechanics.perturbation.phase_polynomial import PolynomialRing
    >>> q, p = sp.symbols("q p")
    >>> parts = homogeneous_parts(p**2 / 2 - sp.cos(q), [q, p], PolynomialRing(2), 4)
    >>> {d: PolynomialRing(2).expression(part, [q, p]) for d, part in parts.items()}
    {0: -1, 2: p**2/2 + q**2/2, 4: -q**4/24}
    """
    return {d: part for d, part in sorted(_series(f, tuple(variables), ring, order).items()) if part}


def _series(f: Any, variables: tuple[Symbol, ...], ring: PolynomialRing, order: int) -> Parts:
    if not f.has(*variables):
        return {0: ring.number(f)}
    if f in variables:
        return {1: ring.variable(variables.index(f))} if order else {}
    if f.is_Add:
        total: Parts = {}
        for part in f.args:
            total = added(total, _series(part, variables, ring, order))
        return total
    if f.is_Mul:
        product: Parts = {0: ring.one}
        for part in f.args:
            product = truncated_product(product, _series(part, variables, ring, order), order)
        return product
    if f.is_Pow and f.exp.is_Integer and f.exp > 0:
        return _power(_series(f.base, variables, ring, order), int(f.exp), ring, order)
    return _of_function(f, variables, ring, order)


def _of_function(f: Any, variables: tuple[Symbol, ...], ring: PolynomialRing, order: int) -> Parts:
    """Return the series of g(u) through the Taylor series of g at u(0)."""
    inner = _inside(f, variables)
    u = _series(inner, variables, ring, order)
    start = u.pop(0, ring.zero)
    at = ring.expression(start, [sp.S.Zero] * len(variables))
    total: Parts = {}
    power: Parts = {0: ring.one}
    for k, slope in enumerate(_derivatives(f, inner, at, order)):
        coefficient = ring.number(slope).times(fmpq(1, int(sp.factorial(k))))
        total = added(total, {d: part * coefficient for d, part in power.items()})
        power = truncated_product(power, u, order)
        if not power:
            break
    return total


def _inside(f: Any, variables: Sequence[Symbol]) -> Any:
    """Return u of a power or a function of u alone."""
    if f.is_Pow and not f.exp.has(*variables):
        return f.base
    if (len(f.args) == 1 and f.is_Function) or isinstance(f, sp.exp):
        return f.args[0]
    raise NotAnalyticError(
        f"{f} is no power and no function of one variable; write it with such, as exp(y*log(x)) or atan(y/x)"
    )


def _derivatives(f: Any, inner: Any, at: Any, order: int) -> Iterator[Expr]:
    """Yield g, g′, g″ … at a point, where f = g(inner)."""
    s = sp.Dummy("s", real=True)
    g: Any = f.func(s, f.exp) if f.is_Pow and not isinstance(f, sp.exp) else f.func(s)
    for _ in range(order + 1):
        value = g.subs(s, at)
        if value.has(sp.nan, sp.zoo, sp.oo, -sp.oo, s) or value.has(sp.Derivative, sp.Subs):
            raise NotAnalyticError(
                f"{f} has no Taylor series where {inner} = {at}; take another point, or variables without "
                "this singularity"
            )
        yield value
        g = g.diff(s)


def _power(u: Parts, k: int, ring: PolynomialRing, order: int) -> Parts:
    result: Parts = {0: ring.one}
    while k:
        if k & 1:
            result = truncated_product(result, u, order)
        k >>= 1
        if k:
            u = truncated_product(u, u, order)
    return result
