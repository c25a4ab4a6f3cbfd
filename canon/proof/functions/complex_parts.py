"""Normal form of real and imaginary parts, conjugates, arguments and signs of complex expressions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from canon.proof.functions.angles import imaginary_split
from canon.proof.functions.arcs import arc_of_point
from canon.proof.tower.tower import Fraction

if TYPE_CHECKING:
    from canon.proof.tower.forms import Forms

__all__ = ["cartesian", "elementary", "sign_function"]


def elementary(n: Forms, expr: sp.Basic) -> Fraction | None:
    """Return re, im, conjugate or arg of z = a + ib with a, b proven real; arg z = atan2(b, a), both undefined at 0."""
    if not isinstance(expr, sp.re | sp.im | sp.conjugate | sp.arg):
        return None
    parts = cartesian(n, n.form(expr.args[0]))
    if parts is None:
        return None
    a, b = parts
    match expr:
        case sp.re():
            return a
        case sp.im():
            return b
        case sp.conjugate():
            return n.minus(a, n.tower.times(n.imaginary_unit, b))
        case _:
            return arc_of_point(n, b, a)


def cartesian(n: Forms, f: Fraction) -> tuple[Fraction, Fraction] | None:
    """Return (a, b) with f = a + ib, both proven real.

    1/(c + id) = (c − id)/(c² + d²) for real c and d, where both sides have the same one point without a value.
    """
    t = n.tower
    above, below = Fraction(f.num), t.number(1)
    for i, e in f.den:
        base = Fraction(t.base(i))
        if not n.is_real(base):
            c, d = imaginary_split(n, base)
            if not (n.is_real(c) and n.is_real(d)):
                return None
            above = t.times(above, t.power(n.minus(c, t.times(n.imaginary_unit, d)), e))
            base = t.sum([t.times(c, c), t.times(d, d)])
        below = t.times(below, t.power(base, e))
    a, b = imaginary_split(n, above)
    if not (n.is_real(a) and n.is_real(b)):
        return None
    return n.over(a, below), n.over(b, below)


def sign_function(n: Forms, expr: sp.Basic) -> Fraction | None:
    """Return sign z: ±1 where z has a proven sign, z/|z| where z is proven not to vanish, 0 where it does.

    Elsewhere it is a kernel s with s·|z| = z, also at z = 0.
    """
    t = n.tower
    z = n.form(expr.args[0])
    known = n.sign(z)
    if known in ("+", "-"):
        return t.number(1 if known == "+" else -1)
    if t.is_zero(z):
        return t.number(0)
    if n.is_real(z):
        return None
    size = n.modulus(z)
    parts = cartesian(n, z)
    if parts is not None and n.sign(t.sum([t.times(part, part) for part in parts])) == "+":
        return n.over(z, size)
    kernel = (sp.sign, (n.fraction_key(t.canonical(z)),))
    fresh = not t.knows(kernel)
    s = n.atom(kernel, "", lambda: sp.sign(n.fraction_expression(z)))
    if fresh:
        t.learn_zero(n.minus(t.times(s, size), z).num)
    return s
