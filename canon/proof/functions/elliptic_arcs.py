"""Normal form of the elliptic functions of an arc: Legendre's F, E and Π, the amplitude am, and ε = E(am).

Used at real arguments for m < 1 proven, where F increases with φ: F(am u) = u and am F(φ) = φ, all are odd, and φ + π
has 2K, 2E, 2Π more (NIST DLMF 19.2.8–10, 22.16.1–20). Π is taken apart for n < 1 proven, where it has no poles.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from flint import fmpq

from canon.expression.symbols.jacobi_functions import jacobi_am, jacobi_epsilon
from canon.proof.functions.angles import combination, multiple
from canon.proof.functions.jacobi_addition import is_ordinary, sn_cn_dn

if TYPE_CHECKING:
    from canon.proof.tower.forms import Forms
    from canon.proof.tower.tower import Fraction

__all__ = ["cos_sin_of_amplitude", "elementary"]


def elementary(n: Forms, expr: sp.Basic) -> Fraction | None:
    """Return an integral or an amplitude through those of arguments met before, where a rule applies."""
    if isinstance(expr, sp.elliptic_pi):
        return _third_kind(n, expr)
    incomplete = isinstance(expr, sp.elliptic_e) and len(expr.args) == 2
    if not (incomplete or isinstance(expr, sp.elliptic_f | jacobi_am | jacobi_epsilon)):
        return None
    t = n.tower
    argument, m = (t.canonical(n.form(a)) for a in expr.args)
    if t.is_zero(m):
        return argument
    if not (n.is_real(argument) and is_ordinary(n, m)):
        return None
    if isinstance(expr, jacobi_am):
        return amplitude(n, argument, m)
    if isinstance(expr, jacobi_epsilon):
        return _arc(n, "E inc", amplitude(n, argument, m), m)
    return _arc(n, "E inc" if incomplete else "F", argument, m)


def amplitude(n: Forms, u: Fraction, m: Fraction) -> Fraction:
    """Return am(u, m): half a turn for every 2K, φ of F(φ, m), otherwise a kernel of an argument made positive."""
    t = n.tower
    quarter = n.form(sp.elliptic_k(n.fraction_expression(m)))
    halves, rest = _periods(n, u, quarter, 2)
    turns = n.scaled(halves, n.pi)
    if t.is_zero(rest):
        return turns
    for sign in (1, -1):
        if t.is_zero(n.minus(rest, n.scaled(sign, quarter))):
            return t.sum([turns, n.scaled(fmpq(sign, 2), n.pi)])
        kernel = n.only_kernel(n.scaled(sign, rest))
        if kernel is not None and kernel[0] == "F" and kernel[2] == n.fraction_key(m):
            return t.sum([turns, n.scaled(sign, n.amplitudes[kernel][0])])
    return t.sum([turns, _odd(n, "am", rest, m)])


def cos_sin_of_amplitude(n: Forms, kernel: tuple[object, ...], r: fmpq) -> tuple[Fraction, Fraction] | None:
    """Return cos and sin of whole multiples of am(u, m) through cn and sn."""
    if kernel[0] != "am" or r.q != 1:
        return None
    s, c, _ = sn_cn_dn(n, *n.amplitudes[kernel])
    return multiple(n, (c, s), int(r.p))


def _arc(n: Forms, kind: str, phi: Fraction, m: Fraction) -> Fraction:
    """Return F(φ, m) or E(φ, m)."""
    t = n.tower
    complete = n.form((sp.elliptic_k if kind == "F" else sp.elliptic_e)(n.fraction_expression(m)))
    halves, rest = _periods(n, phi, n.pi, 1)
    total = n.scaled(2 * halves, complete)
    if t.is_zero(rest):
        return total
    for sign in (1, -1):
        if t.is_zero(n.minus(n.scaled(2, rest), n.scaled(sign, n.pi))):
            return t.sum([total, n.scaled(sign, complete)])
        kernel = n.only_kernel(n.scaled(sign, rest))
        if kind == "F" and kernel is not None and kernel[0] == "am" and kernel[2] == n.fraction_key(m):
            return t.sum([total, n.scaled(sign, n.amplitudes[kernel][0])])
    return t.sum([total, _odd(n, kind, rest, m)])


def _periods(n: Forms, f: Fraction, unit: Fraction, step: int) -> tuple[int, Fraction]:
    """Return a whole number k and f − k·step·unit, in which the unit is left at most half of a step."""
    kernel = n.only_kernel(unit)
    for atom, r in combination(n, f) if kernel is not None else ():
        if n.only_kernel(atom) == kernel:
            k = (int(2 * r.p) + step * int(r.q)) // (2 * step * int(r.q))
            return k, n.tower.canonical(n.minus(f, n.scaled(k * step, unit)))
    return 0, f


def _odd(n: Forms, kind: str, argument: Fraction, m: Fraction, *others: Fraction) -> Fraction:
    """Return the kernel of an odd function; it has the sign of its argument."""
    t = n.tower
    argument = t.canonical(argument)
    negative = argument.num.leading_coefficient() < 0
    argument = n.negative(argument) if negative else argument
    kernel = (kind, n.fraction_key(argument), n.fraction_key(m), *map(n.fraction_key, others))
    n.amplitudes[kernel] = argument, m
    function = {"am": jacobi_am, "F": sp.elliptic_f, "E inc": sp.elliptic_e, "Pi": sp.elliptic_pi}[kind]
    found = n.atom(
        kernel,
        n.sign(argument) or "real",
        lambda: function(*map(n.fraction_expression, (*others, argument, m))),
    )
    return n.negative(found) if negative else found


def _third_kind(n: Forms, expr: sp.elliptic_pi) -> Fraction | None:
    """Return Π(n, m) or Π(n, φ, m) for characteristics below one: K or F for n = 0, E/(1 − m) for Π(m, m)."""
    t = n.tower
    characteristic, *arc, m = (t.canonical(n.form(a)) for a in expr.args)
    below = n.minus(t.number(1), characteristic)
    if (
        not (all(map(n.is_real, arc)) and is_ordinary(n, m) and n.is_real(characteristic))
        or n.sign(below) != "+"
    ):
        return None
    if t.is_zero(characteristic):
        return _arc(n, "F", arc[0], m) if arc else n.form(sp.elliptic_k(n.fraction_expression(m)))
    if arc:
        return _arc_of_third_kind(n, characteristic, arc[0], m)
    if t.is_zero(n.minus(characteristic, m)):
        complete = n.form(sp.elliptic_e(n.fraction_expression(m)))
        return n.over(complete, n.minus(t.number(1), m))
    keys = n.fraction_key(characteristic), n.fraction_key(m)
    return n.atom(
        ("Pi complete", *keys), "+", lambda: sp.elliptic_pi(*map(n.fraction_expression, (characteristic, m)))
    )


def _arc_of_third_kind(n: Forms, characteristic: Fraction, phi: Fraction, m: Fraction) -> Fraction:
    t = n.tower
    halves, rest = _periods(n, phi, n.pi, 1)
    quarters = t.canonical(n.over(n.scaled(2, rest), n.pi))
    whole = t.is_zero(quarters) or any(t.is_zero(n.minus(quarters, t.number(k))) for k in (1, -1))
    parts = [] if whole else [_odd(n, "Pi", rest, m, characteristic)]
    turns = t.sum([t.number(2 * halves), quarters if whole else t.number(0)])
    if not t.is_zero(turns):
        complete = sp.elliptic_pi(*map(n.fraction_expression, (characteristic, m)))
        parts.append(t.times(turns, n.form(complete)))
    return t.sum(parts)
