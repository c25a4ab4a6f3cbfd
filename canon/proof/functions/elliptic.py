"""Normal form of the complete elliptic integrals K(m), E(m) of the parameter m = k².

Used for m < 1 proven, where K and E are analytic: the imaginary-modulus transformation for m < 0, Landen's
transformation between two parameters that both occur, and Legendre's relation between m and 1 − m
(NIST DLMF 19.7.2, 19.8.12–13, 19.7.1).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from flint import fmpq

from canon.proof.functions.powers import root

if TYPE_CHECKING:
    from canon.proof.tower.forms import Forms
    from canon.proof.tower.tower import Fraction

__all__ = ["elementary"]


def elementary(n: Forms, expr: sp.Basic) -> Fraction | None:
    """Return K(m) or E(m) through kernels of parameters met before, where a transformation applies."""
    if not isinstance(expr, sp.elliptic_k | sp.elliptic_e) or len(expr.args) != 1:
        return None
    m = n.tower.canonical(n.form(expr.args[0]))
    if n.tower.is_zero(m):
        return n.scaled(fmpq(1, 2), n.pi)
    if not n.is_real(m) or n.sign(n.minus(n.tower.number(1), m)) != "+":
        return None
    first, second = _integrals(n, m)
    return first if isinstance(expr, sp.elliptic_k) else second


def _integrals(n: Forms, m: Fraction) -> tuple[Fraction, Fraction]:
    """Return K(m) and E(m)."""
    t = n.tower
    key = n.fraction_key(m)
    known = n.integrals.get(key)
    if known is not None:
        return known
    if n.sign(m) == "-":
        below = n.minus(m, t.number(1))
        first, second = _integrals(n, t.canonical(n.over(m, below)))
        complement = _complementary(n, m)
        pair = (n.over(first, complement), t.times(complement, second))
    else:
        pair = _by_landen(n, m) or _kernels(n, m)
    n.integrals[key] = pair
    return pair


def _complementary(n: Forms, m: Fraction) -> Fraction:
    return root(n, n.minus(n.tower.number(1), m), fmpq(1, 2))


def _by_landen(n: Forms, m: Fraction) -> tuple[Fraction, Fraction] | None:
    """With k₁ = (1 − k′)/(1 + k′): K(k) = (1 + k₁)K(k₁), E(k) = (1 + k′)E(k₁) − k′K(k)."""
    t = n.tower
    one = t.number(1)
    for other, (first, second) in n.moduli:
        for larger, smaller in ((m, other), (other, m)):
            complement = _complementary(n, larger)
            above = t.sum([one, complement])
            ratio = n.over(n.minus(one, complement), above)
            if not t.is_zero(n.minus(t.times(ratio, ratio), smaller)):
                continue
            if larger is m:
                own = n.over(n.scaled(2, first), above)
                return own, n.minus(t.times(above, second), t.times(complement, own))
            own = n.scaled(fmpq(1, 2), t.times(above, first))
            return own, n.over(t.sum([second, t.times(complement, first)]), above)
    return None


def _kernels(n: Forms, m: Fraction) -> tuple[Fraction, Fraction]:
    """Return K(m), E(m) as generators; note Legendre's relation EK′ + E′K − KK′ = π/2 where 1 − m occurs too."""
    t = n.tower
    key = n.fraction_key(m)
    first = n.atom(("K", key), "+", lambda: sp.elliptic_k(n.fraction_expression(m)))
    second = n.atom(("E", key), "+", lambda: sp.elliptic_e(n.fraction_expression(m)))
    for other, (k, e) in n.moduli:
        if t.is_zero(n.minus(t.sum([m, other]), t.number(1))):
            products = t.sum([t.times(e, first), t.times(second, k), n.negative(t.times(k, first))])
            t.learn_zero(n.minus(products, n.scaled(fmpq(1, 2), n.pi)).num)
    n.moduli.append((m, (first, second)))
    return first, second
