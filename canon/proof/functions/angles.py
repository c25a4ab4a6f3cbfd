"""Normal form of sines, cosines and hyperbolic functions: written with few of them, related by s² + c² = 1."""

from __future__ import annotations

from functools import cache
from math import lcm
from typing import TYPE_CHECKING

import sympy as sp
from flint import fmpq, fmpz_poly

from canon.proof.domain.limits import Refine, TooLarge
from canon.proof.functions.waves import sign_of_wave
from canon.proof.tower.lattice import Angle, Lattice
from canon.proof.tower.linear_dependence import in_earlier_fractions
from canon.proof.tower.tower import Fraction
from canon.proof.trees.sympy_types import rational

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator

    from sympy import Expr

    from canon.proof.tower.forms import Forms

__all__ = [
    "combination",
    "cos_sin",
    "divided",
    "elementary",
    "imaginary_split",
    "phase_of_pi",
]

LARGEST_MULTIPLE = 1100
"""Multiples of an angle or exponent that are still written out."""

LARGEST_FIELD = 400
"""Order of the roots of unity that are still computed with."""

BY_RADICALS = frozenset({1, 2, 3, 4, 5, 6, 10, 12})
"""Denominators q for which cos(πp/q) is written in square roots; others go through cyclotomic fields."""


def elementary(n: Forms, expr: sp.Basic) -> Fraction | None:
    """Return a trigonometric or hyperbolic function through sin, cos and exp, by definition."""
    t = n.tower
    match expr:
        case sp.sin():
            return cos_sin(n, n.form(expr.args[0]))[1]
        case sp.cos():
            return cos_sin(n, n.form(expr.args[0]))[0]
        case sp.tan():
            c, s = cos_sin(n, n.form(expr.args[0]))
            return n.over(s, c)
        case sp.cot():
            c, s = cos_sin(n, n.form(expr.args[0]))
            return n.over(c, s)
        case sp.sec():
            return t.reciprocal(cos_sin(n, n.form(expr.args[0]))[0])
        case sp.csc():
            return t.reciprocal(cos_sin(n, n.form(expr.args[0]))[1])
        case _:
            pass
    if not isinstance(expr, sp.sinh | sp.cosh | sp.tanh | sp.coth | sp.sech | sp.csch):
        return None
    cosh, sinh = cosh_sinh(n, n.form(expr.args[0]))
    match expr:
        case sp.sinh():
            return sinh
        case sp.cosh():
            return cosh
        case sp.tanh():
            return n.over(sinh, cosh)
        case sp.coth():
            return n.over(cosh, sinh)
        case sp.sech():
            return t.reciprocal(cosh)
        case _:
            return t.reciprocal(sinh)


def cosh_sinh(n: Forms, f: Fraction) -> tuple[Fraction, Fraction]:
    """Return (cosh f, sinh f) = (e^f ± e^−f)/2."""
    e = n.exponential(f)
    inverse = n.tower.reciprocal(e)
    return n.scaled(fmpq(1, 2), n.tower.sum([e, inverse])), n.scaled(fmpq(1, 2), n.minus(e, inverse))


def combination(n: Forms, f: Fraction) -> list[tuple[Fraction, fmpq]]:
    """Write f as Σ rᵢ·atomᵢ with rational rᵢ; the atoms are monomials and independent monomials over denominators."""
    f = n.tower.canonical(f)
    if not f.den:
        return list(_monomials(n, f))
    found: dict[Hashable, tuple[Fraction, fmpq]] = {}
    _combine(n, f, fmpq(1), found)
    return [(atom, r) for atom, r in found.values() if r != 0]


def _monomials(n: Forms, f: Fraction) -> Iterator[tuple[Fraction, fmpq]]:
    """Yield the monomials of the numerator over the denominator, with their coefficients."""
    t = n.tower
    for monomial, coefficient in t.terms(f.num):
        p = t.constant(1)
        for k, e in monomial:
            p = p * t.monomial(k, e)
        yield Fraction(p, f.den), coefficient


def _combine(n: Forms, f: Fraction, factor: fmpq, found: dict[Hashable, tuple[Fraction, fmpq]]) -> None:
    """Add the terms of a multiple of ``f`` to those found."""
    for term, coefficient in _monomials(n, f):
        atom, r = n.tower.canonical(term), factor * coefficient
        earlier = in_earlier_fractions(n, atom) if atom.den else None
        if earlier is None:
            _add(found, n.fraction_key(atom), atom, r)
            continue
        for other, weight in earlier[0]:
            _add(found, n.fraction_key(other), other, r * weight)
        _combine(n, Fraction(earlier[1]), r, found)


def _add(
    found: dict[Hashable, tuple[Fraction, fmpq]], key: Hashable, atom: Fraction, coefficient: fmpq
) -> None:
    before = found.get(key)
    found[key] = (atom, coefficient if before is None else before[1] + coefficient)


def divided(n: Forms, kind: str, key: Hashable, coefficient: fmpq) -> int:
    """Return the number of parts that make ``coefficient`` a whole multiple, or ask to refine."""
    have = n.parts.get((kind, key), 1)
    need = lcm(have, int(coefficient.q))
    if need != have:
        n.parts[(kind, key)] = need
        raise Refine
    if abs(coefficient) * need > LARGEST_MULTIPLE:
        raise TooLarge(f"a multiple of more than {LARGEST_MULTIPLE} of one argument")
    return need


def imaginary_split(n: Forms, f: Fraction) -> tuple[Fraction, Fraction]:
    """Write f = a + i·b, where i in a denominator stays there as part of the atoms."""
    t = n.tower
    if not t.knows(("I",)):
        return f, t.number(0)
    parts = t.coefficients(t.reduce(f.num), t.generator(("I",)))
    return Fraction(parts[0], f.den), Fraction(parts[1] if len(parts) > 1 else t.constant(0), f.den)


def cos_sin(n: Forms, f: Fraction) -> tuple[Fraction, Fraction]:
    """Return (cos f, sin f) by the addition theorems, which hold for complex arguments as well.

    cos(ib) = cosh b and sin(ib) = i sinh b.
    """
    t = n.tower
    a, b = imaginary_split(n, f)
    pair = (t.number(1), t.number(0))
    rest: list[tuple[Fraction, fmpq]] = []
    for atom, r in combination(n, a):
        known = _special_angle(n, atom, r)
        if known is None:
            rest.append((atom, r))
        else:
            pair = turned(n, pair, known)
    for angle, times in _in_base_angles(n, rest):
        pair = turned(n, pair, multiple(n, _base_angle(n, angle), times))
    if not b.num.is_zero():
        cosh, sinh = cosh_sinh(n, b)
        pair = turned(n, pair, (cosh, t.times(n.imaginary_unit, sinh)))
    return pair


def turned(
    n: Forms, first: tuple[Fraction, Fraction], second: tuple[Fraction, Fraction]
) -> tuple[Fraction, Fraction]:
    """Return cos and sin of a sum of two angles given by theirs."""
    t = n.tower
    (c1, s1), (c2, s2) = first, second
    return n.minus(t.times(c1, c2), t.times(s1, s2)), t.sum([t.times(s1, c2), t.times(c1, s2)])


def multiple(n: Forms, pair: tuple[Fraction, Fraction], times: int) -> tuple[Fraction, Fraction]:
    """Return cos and sin of a whole multiple of an angle."""
    result = (n.tower.number(1), n.tower.number(0))
    k = abs(times)
    while k:
        if k & 1:
            result = turned(n, result, pair)
        k >>= 1
        if k:
            pair = turned(n, pair, pair)
    return (result[0], n.negative(result[1])) if times < 0 else result


def _special_angle(n: Forms, atom: Fraction, r: fmpq) -> tuple[Fraction, Fraction] | None:
    """Return cos and sin of r·atom for multiples of π and of arcs, which need no base angle."""
    kernel = n.only_kernel(atom)
    if kernel == ("pi",):
        return phase_of_pi(n, r)
    if kernel is not None and (known := n.cos_sin_of_arc(kernel, r)) is not None:
        return known
    if r.q == 1 and _whole_multiple_of_pi(n, atom):
        return _alternating(n, n.fraction_key(atom), atom, int(r.p))
    return None


def _in_base_angles(n: Forms, terms: list[tuple[Fraction, fmpq]]) -> list[tuple[Angle, int]]:
    """Write an argument as whole multiples of base angles, a basis of the lattice of all arguments met.

    An argument outside the lattice widens it, and the work starts again.
    """
    if not terms:
        return []
    for atom, _ in terms:
        n.atoms.setdefault(n.fraction_key(atom), atom)
    wanted: Angle = frozenset((n.fraction_key(atom), int(r.p), int(r.q)) for atom, r in terms)
    lattice = n.parts.setdefault("angles", Lattice())
    for atom, _ in terms:
        lattice.number(n.fraction_key(atom))
    found = lattice.coordinates(wanted)
    if found is None:
        for key, _, _ in wanted:
            if key not in lattice.meaning:
                lattice.meaning[key] = n.fraction_expression(n.atoms[key])
        if not lattice.add(wanted):
            raise Refine
        found = [(wanted, 1)]
    if any(abs(k) > LARGEST_MULTIPLE for _, k in found):
        return [(wanted, 1)]
    return found


def _whole_multiple_of_pi(n: Forms, atom: Fraction) -> bool:
    kernels = [(n.tower.generators[k], e) for m, _ in n.tower.terms(atom.num) for k, e in m]
    return (
        not atom.den
        and (("pi",), 1) in kernels
        and all(
            kernel == ("pi",) or (kernel[0] == "symbol" and kernel[1].is_integer) for kernel, _ in kernels
        )
    )


def _alternating(n: Forms, key: Hashable, atom: Fraction, k: int) -> tuple[Fraction, Fraction]:
    """Return cos(kπN) and sin(kπN) for an integer N: a sign ε with ε² = 1, and 0."""
    t = n.tower
    kernel = ("alternating", key)
    fresh = not t.knows(kernel)
    c = n.atom(kernel, "real", lambda: sp.cos(n.fraction_expression(atom)))
    if fresh:
        t.relate(t.generator(kernel), 2, t.constant(1))
    return t.power(c, k % 2), t.number(0)


def _base_angle(n: Forms, angle: Angle) -> tuple[Fraction, Fraction]:
    """Return cos and sin of a base angle as two generators with s² = 1 − c².

    Their signs follow from the range of the angle on the domain.
    """
    t = n.tower
    fresh = not t.knows(("sin", angle))
    if fresh:
        for key, _, _ in angle:
            if key not in n.atoms:
                n.atoms[key] = n.form(n.parts["angles"].meaning[key])
        argument = t.sum(n.scaled(fmpq(p, q), n.atoms[key]) for key, p, q in angle)
        n.arguments["cos", angle] = n.arguments["sin", angle] = argument
        real = n.is_real(argument)
        if real:
            n.ranges[angle] = _range(n, angle)
        signs = _quadrant(n, angle) if real else ("", "")
    else:
        real, signs = False, ("", "")
    c = n.atom(("cos", angle), signs[0], lambda: sp.cos(n.fraction_expression(n.arguments["cos", angle])))
    s = n.atom(("sin", angle), signs[1], lambda: sp.sin(n.fraction_expression(n.arguments["sin", angle])))
    if fresh:
        t.relate(t.generator(("sin", angle)), 2, 1 - c.num**2)
        if real:
            for bound in (1 - c.num, 1 + c.num, 1 - c.num**2, 1 - s.num, 1 + s.num):
                n.signs.learn(bound, strict=False, combine=False)
    return c, s


def _range(n: Forms, angle: Angle) -> tuple[Expr, Expr, bool]:
    """Return the bounds of a base angle that is a multiple of one symbol, and whether both are excluded."""
    if len(angle) == 1:
        ((key, p, q),) = angle
        kernel = n.only_kernel(n.atoms[key])
        if kernel is not None and kernel[0] == "symbol":
            low, high, strict = n.domain.interval(kernel[1])
            first, last = low * sp.Rational(p, q), high * sp.Rational(p, q)
            return (first, last, strict) if p > 0 else (last, first, strict)
    return -sp.oo, sp.oo, True


def _quadrant(n: Forms, angle: Angle) -> tuple[str, str]:
    """Return the signs of cos and sin on the range of a base angle."""
    return sign_of_wave(n, angle, 1, 0) or "real", sign_of_wave(n, angle, 0, 1) or "real"


# -- rational multiples of π ---------------------------------------------------------------------------


def phase_of_pi(n: Forms, r: fmpq) -> tuple[Fraction, Fraction]:
    """Return cos(rπ) and sin(rπ) exactly: by square roots, or in the real field of 2 cos(π/2N).

    sin(rπ) = cos((1/2 − r)π), so one generator serves both.
    """
    angle = rational(sp.Rational(int(r.p), int(r.q)) % 2)
    if angle.q in BY_RADICALS:
        return n.form(sp.cos(angle * sp.pi)), n.form(sp.sin(angle * sp.pi))
    half = divided(n, "angle of pi", "cyclotomic", fmpq(1, 2 * int(angle.q)))
    order = half
    first, second = angle * order, (sp.Rational(1, 2) - angle) * order
    return _cosine_in_field(n, int(first), order), _cosine_in_field(n, abs(int(second)), order)


def _cosine_in_field(n: Forms, k: int, order: int) -> Fraction:
    """Return cos(kπ/order) as a polynomial in C = 2cos(π/order), reduced by C's minimal polynomial."""
    t = n.tower
    kernel = ("cyclotomic", order)
    fresh = not t.knows(kernel)
    c = n.atom(kernel, "+", lambda: 2 * sp.cos(sp.pi / order))
    if fresh:
        coefficients = _minimal_polynomial(2 * order)
        degree = len(coefficients) - 1
        power = t.constant(0)
        for e, coefficient in enumerate(coefficients[:-1]):
            power = power - t.constant(coefficient) * c.num**e
        t.relate(t.generator(kernel), degree, power)
    now, following = t.number(2), c
    for _ in range(min(k % (2 * order), -k % (2 * order))):
        now, following = following, n.minus(t.times(c, following), now)
    return n.scaled(fmpq(1, 2), now)


@cache
def _minimal_polynomial(m: int) -> tuple[int, ...]:
    """Return the minimal polynomial of 2cos(2π/m) from Φ_m(z) = z^(φ/2) ψ(z + 1/z), constant term first."""
    if m > LARGEST_FIELD:
        raise TooLarge(f"the field of the {m}-th roots of unity")
    phi = [int(c) for c in fmpz_poly.cyclotomic(m)]
    middle = len(phi) // 2
    x = fmpz_poly([0, 1])
    before, now = fmpz_poly([2]), x
    total = fmpz_poly([phi[middle]])
    for k in range(1, middle + 1):
        total = total + phi[middle + k] * now
        before, now = now, x * now - before
    return tuple(int(c) for c in total)
