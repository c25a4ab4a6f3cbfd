"""Normal form of gamma functions, factorials, binomial coefficients and polygammas whose arguments differ by integers.

NIST DLMF 5.5.1–5.5.3, 5.15.5 and 5.12.1: Γ(z + 1) = zΓ(z), Γ(z)Γ(1 − z) = π/sin πz and
ψ⁽ᵐ⁾(z + 1) = ψ⁽ᵐ⁾(z) + (−1)ᵐm!/zᵐ⁺¹.
All functions go back to the first argument of each class that was met, so no argument is used at which the claim is
not made.
"""

from __future__ import annotations

from math import factorial
from typing import TYPE_CHECKING

import sympy as sp
from flint import fmpq

from canon.proof.functions.angles import cos_sin
from canon.proof.functions.powers import logarithm
from canon.proof.trees.sympy_types import arguments

if TYPE_CHECKING:
    from canon.proof.tower.forms import Forms
    from canon.proof.tower.tower import Fraction

__all__ = ["elementary"]

LARGEST_SHIFT = 60
"""Differences of arguments that are still written out."""


def elementary(n: Forms, expr: sp.Basic) -> Fraction | None:
    """Return a function of the gamma family through kernels of arguments met before."""
    match expr:
        case sp.gamma():
            return _gamma(n, n.form(expr.args[0]))
        case sp.factorial():
            return _gamma(n, _shifted(n, n.form(expr.args[0]), 1))
        case sp.binomial():
            return _binomial(n, *(n.form(a) for a in expr.args))
        case sp.beta():
            return _beta(n, *(n.form(a) for a in expr.args))
        case sp.RisingFactorial():
            x, k = (n.form(a) for a in expr.args)
            return _ratio(n, n.tower.sum([x, k]), x)
        case sp.FallingFactorial():
            x, k = (n.form(a) for a in expr.args)
            return _ratio(n, _shifted(n, x, 1), _shifted(n, n.minus(x, k), 1))
        case sp.fibonacci() | sp.lucas() if len(expr.args) == 1 and arguments(expr)[0].is_integer:
            return n.form(_binet(expr))
        case sp.loggamma():
            return _log_gamma(n, n.form(expr.args[0]))
        case sp.polygamma():
            order, z = arguments(expr)
            return _polygamma(n, int(order), n.form(z)) if order in range(LARGEST_SHIFT) else None
        case sp.erfc():
            return n.minus(n.tower.number(1), n.form(sp.erf(expr.args[0])))
        case _:
            return None


def _shifted(n: Forms, z: Fraction, k: int) -> Fraction:
    return n.tower.sum([z, n.tower.number(k)])


def _whole(f: Fraction) -> int | None:
    """Return a whole number of moderate size that ``f`` is."""
    if f.den or not f.num.is_constant():
        return None
    number = fmpq(0) if f.num.is_zero() else f.num.leading_coefficient()
    return int(number.p) if number.q == 1 and abs(number) <= LARGEST_SHIFT else None


def _rising(n: Forms, z: Fraction, k: int) -> Fraction:
    """Return z(z + 1)…(z + k − 1)."""
    return n.tower.times(*(_shifted(n, z, j) for j in range(k)))


def _gamma(n: Forms, z: Fraction) -> Fraction:
    """Return Γ(z) = z₀(z₀ + 1)…(z − 1)Γ(z₀) for an earlier z₀ = z − k, by reflection for one with z₀ + z = k."""
    t = n.tower
    z = t.canonical(z)
    whole = _whole(z)
    if whole is not None and whole > 0:
        return t.number(factorial(whole - 1))
    for base, value in n.gammas:
        shift, mirror = _whole(n.minus(z, base)), _whole(t.sum([z, base]))
        if shift is not None:
            if shift >= 0:
                return t.times(_rising(n, base, shift), value)
            return n.over(value, _rising(n, z, -shift))
        reflected = None if mirror is None else _reflected(n, z, mirror, base, value)
        if reflected is not None:
            return reflected
    if t.is_zero(n.minus(z, t.number(fmpq(1, 2)))):
        return n.form(sp.sqrt(sp.pi))
    sign = "+" if n.sign(z) == "+" else "real" if n.is_real(z) else ""
    kernel = ("gamma", n.fraction_key(z))
    found = n.atom(kernel, sign, lambda: sp.gamma(n.fraction_expression(z)))
    n.gammas.append((z, found))
    return found


def _reflected(n: Forms, z: Fraction, k: int, base: Fraction, value: Fraction) -> Fraction | None:
    """Return Γ(z) = Γ(k − z₀) through Γ(1 − z₀) = π/(sin πz₀ Γ(z₀)), where sin πz₀ ≠ 0.

    Where Γ(z₀) and Γ(k − z₀) both have a value and k ≤ 1, z₀ is not whole; for k > 1 that sine has to be proved
    not to vanish.
    """
    t = n.tower
    sine = cos_sin(n, t.times(n.pi, base))[1]
    if k > 1 and not (n.is_real(sine) and n.signs.nonzero(sine.num)):
        return None
    opposite = n.over(n.pi, t.times(sine, value))
    if k <= 1:
        return n.over(opposite, _rising(n, z, 1 - k))
    return t.times(opposite, _rising(n, n.minus(t.number(1), base), k - 1))


def _positive(n: Forms, *fractions: Fraction) -> bool:
    return all(n.sign(f) == "+" for f in fractions)


def _binomial(n: Forms, a: Fraction, b: Fraction) -> Fraction | None:
    """Return a(a − 1)…(a − b + 1)/b! for a whole b, Γ(a + 1)/(Γ(b + 1)Γ(a − b + 1)) where all three are positive."""
    t = n.tower
    whole = _whole(b)
    if whole is not None and whole >= 0:
        return n.scaled(fmpq(1, factorial(whole)), _rising(n, _shifted(n, a, 1 - whole), whole))
    below = _shifted(n, b, 1), _shifted(n, n.minus(a, b), 1)
    above = _shifted(n, a, 1)
    if not _positive(n, above, *below):
        return None
    return n.over(_gamma(n, above), t.times(*(_gamma(n, z) for z in below)))


def _ratio(n: Forms, above: Fraction, below: Fraction) -> Fraction | None:
    """Return Γ(a)/Γ(b) for positive a and b."""
    if not _positive(n, above, below):
        return None
    first, second = _gamma(n, below), _gamma(n, above)
    return n.over(second, first)


def _binet(expr: sp.Basic) -> sp.Expr:
    """Return Fₖ = (φᵏ − (−φ)⁻ᵏ)/√5 or Lₖ = φᵏ + (−φ)⁻ᵏ, which hold for every whole k."""
    k, phi = arguments(expr)[0], (1 + sp.sqrt(5)) / 2
    if isinstance(expr, sp.lucas):
        return phi**k + (-phi) ** (-k)
    return (phi**k - (-phi) ** (-k)) / sp.sqrt(5)


def _beta(n: Forms, a: Fraction, b: Fraction) -> Fraction | None:
    """Return B(a, b) = Γ(a)Γ(b)/Γ(a + b) for positive a and b."""
    if not _positive(n, a, b):
        return None
    t = n.tower
    return n.over(t.times(_gamma(n, a), _gamma(n, b)), _gamma(n, t.sum([a, b])))


def _log_gamma(n: Forms, z: Fraction) -> Fraction | None:
    """Return log Γ(z) for z > 0, where it is the real logarithm."""
    return logarithm(n, _gamma(n, z)) if _positive(n, z) else None


def _polygamma(n: Forms, order: int, z: Fraction) -> Fraction:
    """Return ψ⁽ᵐ⁾(z) = ψ⁽ᵐ⁾(z₀) + (−1)ᵐm! Σ 1/(z₀ + j)ᵐ⁺¹ for an earlier z₀ = z − k."""
    t = n.tower
    z = t.canonical(z)
    known = n.polygammas.setdefault(order, [])
    weight = (-1) ** order * factorial(order)
    for base, value in known:
        shift = _whole(n.minus(z, base))
        if shift is not None:
            first = base if shift >= 0 else z
            steps = (t.power(_shifted(n, first, j), -order - 1) for j in range(abs(shift)))
            return t.sum([value, n.scaled(weight if shift >= 0 else -weight, t.sum(steps))])
    kernel = ("polygamma", order, n.fraction_key(z))
    meaning = sp.polygamma
    found = n.atom(kernel, "real" if n.is_real(z) else "", lambda: meaning(order, n.fraction_expression(z)))
    known.append((z, found))
    return found
