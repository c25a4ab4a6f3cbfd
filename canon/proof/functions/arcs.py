"""Normal form of inverse circular and hyperbolic functions."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import fmpq

from canon.proof.functions.angles import multiple
from canon.proof.tower.tower import Fraction

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator

    from sympy import Expr

    from canon.proof.tower.forms import Forms

__all__ = ["ARCS", "arc_of_point", "cos_sin_of_arc", "elementary"]

ARCS = ("asin", "atan", "atan2")
"""Kernels that are angles; all other inverse functions are written through these and logarithms."""

SIMPLE_MULTIPLES = tuple(
    fmpq(p, q) for p, q in ((1, 1), (-1, 1), (2, 1), (-2, 1), (3, 1), (-3, 1), (-1, 2), (1, 2))
)
"""Multiples of a logarithm that are tried as values of Lambert's W."""


def elementary(n: Forms, expr: sp.Basic) -> Fraction | None:
    """Return an inverse function through asin, atan, atan2 and log by identities of principal branches.

    acos z = π/2 − asin z; asinh z = log(z + √(z²+1)); acosh z = log(z + √(z+1)√(z−1));
    atanh z = (log(1+z) − log(1−z))/2 (NIST DLMF 4.23.16, 4.37.16–24). acot z = atan(1/z) except at z = 0,
    where acot 0 = π/2: used only where z is proven not to vanish, as is acoth.
    """
    t = n.tower
    arguments = expr.args
    match expr:
        case sp.asin():
            return _odd(n, "asin", n.form(arguments[0]))
        case sp.acos():
            return n.minus(n.scaled(fmpq(1, 2), n.pi), _odd(n, "asin", n.form(arguments[0])))
        case sp.atan():
            return _odd(n, "atan", n.form(arguments[0]))
        case sp.atan2():
            return arc_of_point(n, n.form(arguments[0]), n.form(arguments[1]))
        case sp.asec():
            return n.minus(n.scaled(fmpq(1, 2), n.pi), _odd(n, "asin", t.reciprocal(n.form(arguments[0]))))
        case sp.acsc():
            return _odd(n, "asin", t.reciprocal(n.form(arguments[0])))
        case sp.acot() | sp.acoth():
            z = n.form(arguments[0])
            if n.sign(z) not in ("+", "-"):
                return None
            inverse = t.reciprocal(z)
            return _odd(n, "atan", inverse) if isinstance(expr, sp.acot) else _atanh(n, inverse)
        case sp.asinh() | sp.acosh() | sp.atanh() | sp.asech() | sp.acsch():
            return _area(n, expr, n.form(arguments[0]))
        case sp.LambertW() if len(arguments) == 1 or arguments[1] == -1:
            return _lambert_w(n, expr, n.form(arguments[0]))
        case _:
            return None


def _odd(n: Forms, name: str, z: Fraction) -> Fraction:
    """Return asin or atan of z; both are odd, so the argument's leading sign is made positive."""
    t = n.tower
    z = t.canonical(z)
    if z.num.is_zero():
        return z
    negative = z.num.leading_coefficient() < 0
    z = n.negative(z) if negative else z
    arc = n.form(sp.Rational(1, 4) * sp.pi) if name == "atan" and t.is_zero(n.minus(z, t.number(1))) else None
    if arc is None:
        kernel = (name, n.fraction_key(z))
        n.arguments[kernel] = z
        function = sp.asin if name == "asin" else sp.atan
        real = n.is_real(z) and (name == "atan" or _at_most_one(n, z))
        arc = n.atom(kernel, _arc_sign(n, z, real=real), lambda: function(n.fraction_expression(z)))
    return n.negative(arc) if negative else arc


def _arc_sign(n: Forms, z: Fraction, *, real: bool) -> str:
    return (n.sign(z) or "real") if real else ""


def _at_most_one(n: Forms, z: Fraction) -> bool:
    """Tell whether |z| ≤ 1 is proven."""
    one = n.tower.number(1)
    return n.sign(n.minus(one, n.tower.times(z, z))).endswith("+")


def arc_of_point(n: Forms, y: Fraction, x: Fraction) -> Fraction:
    """Return atan2(y, x) through atan where a half plane is proven; atan2(ky, kx) = atan2(y, x) for k > 0."""
    t = n.tower
    half_pi = n.scaled(fmpq(1, 2), n.pi)
    if n.is_real(x) and n.is_real(y):
        side = n.sign(x)
        if side == "+":
            return _odd(n, "atan", n.over(y, x))
        if side == "-" and t.is_zero(y):
            return n.pi
        if (above := n.sign(y)) in ("+", "-"):
            return n.minus(half_pi if above == "+" else n.negative(half_pi), _odd(n, "atan", n.over(x, y)))
    y, x = t.canonical(y), t.canonical(x)
    kernel: tuple[Hashable, ...] = ("atan2", n.fraction_key(y), n.fraction_key(x))
    n.arguments[kernel], n.arguments[(*kernel, "x")] = y, x
    real = n.is_real(x) and n.is_real(y)
    return n.atom(
        kernel,
        "real" if real else "",
        lambda: sp.atan2(n.fraction_expression(y), n.fraction_expression(x)),
    )


def _area(n: Forms, expr: sp.Basic, z: Fraction) -> Fraction:
    t = n.tower
    one, half = t.number(1), fmpq(1, 2)
    match expr:
        case sp.atanh():
            return _atanh(n, z)
        case sp.asech() | sp.acsch():
            z = t.reciprocal(z)
        case _:
            pass
    if isinstance(expr, sp.asinh | sp.acsch):
        return n.logarithm(t.sum([z, n.root(t.sum([t.times(z, z), one]), half)]))
    roots = t.times(n.root(t.sum([z, one]), half), n.root(n.minus(z, one), half))
    return n.logarithm(t.sum([z, roots]))


def _atanh(n: Forms, z: Fraction) -> Fraction:
    one = n.tower.number(1)
    above, below = n.tower.sum([one, z]), n.minus(one, z)
    return n.scaled(fmpq(1, 2), n.minus(n.logarithm(above), n.logarithm(below)))


def _lambert_w(n: Forms, expr: sp.Basic, z: Fraction) -> Fraction:
    """Return W₀(z) or W₋₁(z): g where z = g exp g with g ≥ −1, or g ≤ −1; otherwise a kernel.

    W₀(z) ≥ 0 for z ≥ 0 and W₋₁(z) < 0 for −1/e ≤ z < 0. Both are asked of the domain for each g: that z = g exp g is
    an identity, and that g lies on the branch; u ↦ u exp u is injective on each of the two rays (NIST DLMF 4.13).
    """
    t = n.tower
    one, upper = t.number(1), len(expr.args) == 1
    for g, beyond in _inverse_candidates(n, z):
        above = [t.sum([g, one]), *beyond]
        gaps = above if upper else [n.negative(gap) for gap in above]
        if any(n.sign(gap).endswith("+") for gap in gaps) and t.is_zero(
            n.minus(z, t.times(g, n.exponential(g)))
        ):
            return g
    kernel = (sp.LambertW, (n.fraction_key(t.canonical(z)), *map(str, expr.args[1:])))
    n.arguments[kernel] = z
    sign = n.sign(z) if n.is_real(z) else ""
    if upper:
        known = sign if sign.endswith("+") else ""
    else:
        least = sign == "-" and n.sign(t.sum([z, n.form(sp.exp(-1))])).endswith("+")
        known = "-" if least else ""
    return n.atom(kernel, known, lambda: cast("Expr", expr))


def _inverse_candidates(n: Forms, z: Fraction) -> Iterator[tuple[Fraction, list[Fraction]]]:
    """Yield what may be W(z), arguments of exponentials in z, and logarithms in z with simple multiples.

    Where z = g exp g every term of z has the same exponentials, so that g is the sum of their arguments in one of them.
    Beside it stand functions that have the sign of g + 1: of m log u + 1 that is u − exp(−1/m), where m > 0.
    """
    yield _exponent(n, z), []
    for k in n.tower.used(z.num):
        candidate = n.tower.generators[k]
        if candidate[0] == "exp":
            yield n.arguments[candidate], []
        elif candidate[0] == "log":
            argument, logarithm = n.arguments[candidate], Fraction(n.tower.monomial(k))
            for m in SIMPLE_MULTIPLES:
                edge = n.minus(argument, n.form(sp.exp(sp.Rational(-int(m.q), int(m.p)))))
                beyond = [edge if m > 0 else n.negative(edge)] if n.sign(argument) == "+" else []
                yield n.scaled(m, logarithm), beyond


def _exponent(n: Forms, z: Fraction) -> Fraction:
    """Return what stands in the exponent of the first term of z: v + 1 where z is (v + 1) e exp v."""
    parts = [(z.num, 1), *((n.tower.base(i), -e) for i, e in z.den)]
    powers = [(k, sign * e) for p, sign in parts for k, e in next(iter(n.tower.terms(p)), ((), 0))[0]]
    named = [(n.tower.generators[k], e) for k, e in powers]
    return n.tower.sum(n.scaled(e, n.arguments[kernel]) for kernel, e in named if kernel[0] == "exp")


def cos_sin_of_arc(n: Forms, kernel: tuple[object, ...], r: fmpq) -> tuple[Fraction, Fraction] | None:
    """Return cos and sin of r·arc where r is whole or half.

    cos asin z = √(1 − z²) for every z; e^{i atan z} = (1 + iz)/√(1 + z²) for real z, and its square
    (1 + iz)/(1 − iz) for every z; e^{i atan2(y, x)} = (x + iy)/√(x² + y²). Halves of asin and atan lie in
    [−π/4, π/4], where cos(a/2) = √((1 + cos a)/2) > 0 and sin(a/2) = sin a/(2cos(a/2)).
    """
    if kernel[0] not in ARCS or int(r.q) not in (1, 2):
        return None
    t = n.tower
    whole_turns = r.q == 1 and int(r.p) % 2 == 0
    if kernel[0] == "atan" and not whole_turns and not n.is_real(n.arguments[kernel]):
        return None
    if kernel[0] == "atan" and whole_turns:
        z = n.arguments[kernel]
        square = t.times(z, z)
        below = t.sum([t.number(1), square])
        pair = (n.over(n.minus(t.number(1), square), below), n.over(n.scaled(2, z), below))
        return multiple(n, pair, int(r.p) // 2)
    pair = _pair(n, kernel)
    if r.q == 2:
        if kernel[0] == "atan2" or not n.is_real(n.arguments[kernel]):
            return None
        pair = _halved(n, pair)
    return multiple(n, pair, int(r.p))


def _pair(n: Forms, kernel: tuple[object, ...]) -> tuple[Fraction, Fraction]:
    t = n.tower
    half = fmpq(1, 2)
    z = n.arguments[kernel]
    one = t.number(1)
    if kernel[0] == "asin":
        return n.root(n.minus(one, t.times(z, z)), half), z
    x = one if kernel[0] == "atan" else n.arguments[(*kernel, "x")]
    length = n.root(t.sum([t.times(x, x), t.times(z, z)]), half)
    return n.over(x, length), n.over(z, length)


def _halved(n: Forms, pair: tuple[Fraction, Fraction]) -> tuple[Fraction, Fraction]:
    t = n.tower
    c = n.root(n.scaled(fmpq(1, 2), t.sum([t.number(1), pair[0]])), fmpq(1, 2))
    return c, n.over(pair[1], n.scaled(2, c))
