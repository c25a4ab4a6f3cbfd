"""Elementary functions on both sides of a surface across which they may jump.

Each function that may jump has a gap, an expression that changes its sign there, and on either side a continuation
that is analytic across the surface: atan(N/D) is ±π/2 − atan(D/N) where D ≷ 0 (with the sign of N), acot(N/D) is
±π/2 − atan(N/D) where N ≷ 0, atan2(y, x) is ±π + atan(y/x) where x < 0 and y ≷ 0, and atan2(gy, gx) is atan2(±y, ±x)
where g ≷ 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational

from canon.proof.domain.declarations import declared_complex
from canon.proof.domain.reality import certainly_real
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.sympy_types import arguments, free_symbols

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr, Symbol

    from canon.proof.domain.domain import Domain

__all__ = [
    "Cut",
    "coprime",
    "cuts_of",
    "off_the_kinks",
    "proportion",
    "with_moduli",
    "without_complex_logarithms",
    "without_functions_of_parameters",
]

LARGE = 400
"""Size of an argument whose numerator and denominator are still made coprime."""


@dataclass(frozen=True)
class Cut:
    """A part of an expression that may jump, or bend, where ``gap`` changes its sign.

    Parameters
    ----------
    part
        The function.
    gap
        What vanishes on the surface.
    above, below
        What the function is where the gap is positive and where it is negative, near the surface.
    around
        For an angle: y and x of its direction, which vanish together where it has no value, so that it may wind around
        that place.
    bends
        Whether the function itself is continuous, as |u| is, so that only a quotient of it can jump.
    beyond
        What must be negative for a jump: x of atan2(y, x).
    """

    part: Expr
    gap: Expr
    above: Expr
    below: Expr
    around: tuple[Expr, Expr] | None = None
    bends: bool = False
    beyond: Expr | None = None


def cuts_of(f: Expr, variables: Sequence[Symbol]) -> list[Cut]:
    """Return the parts of an expression that may jump or bend in some variables.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> [(cut.gap, cut.above, cut.below) for cut in cuts_of(sp.atan(1 / x), [x])]
    [(x, -atan(x) + pi/2, -atan(x) - pi/2)]
    """
    found: list[Cut] = []
    for part in anatomy([f]).parts:
        if isinstance(part, sp.Expr) and part.has(*variables):
            found.extend(cut for cut in _cuts(part) if cut.gap.has(*variables))
    return found


def _cuts(part: Expr) -> Iterator[Cut]:
    match part:
        case sp.sign():
            yield Cut(part, _finite(arguments(part)[0]), sp.S.One, sp.S.NegativeOne)
        case sp.Heaviside():
            yield Cut(part, _finite(arguments(part)[0]), sp.S.One, sp.S.Zero)
        case sp.arg() if certainly_real(arguments(part)[0]):
            yield Cut(part, _finite(arguments(part)[0]), sp.S.Zero, sp.pi)
        case sp.Abs():
            u = arguments(part)[0]
            yield Cut(part, u, u, -u, bends=True)
        case sp.Max() | sp.Min():
            yield from _extremes(part)
        case sp.Piecewise():
            yield from _pieces(part)
        case sp.atan() | sp.acot():
            yield from _arcs(part)
        case sp.atan2():
            yield from _angles(part)
        case sp.Pow():
            yield from _roots(part)
        case _:
            pass


def _finite(gap: Expr) -> Expr:
    """Return what has the sign of an expression and no poles: u v for u/v, which changes its sign at both."""
    above, below = sp.fraction(sp.together(gap))
    return above * below if below.free_symbols else gap


def _angles(part: sp.atan2) -> Iterator[Cut]:
    """Yield the cuts of atan2(y, x) = atan2(g n, g d): the half-lines n = 0 > x, and where g changes its sign.

    With y = 0, where the angle is 0 or π, g is x.
    """
    y, x = arguments(part)
    n, d = _in_ratio(y, x)
    common = sp.cancel(x / d)
    if n.free_symbols:
        turn, flat = (
            sp.pi * sp.Heaviside(-x) * (sp.sign(common) if common.free_symbols else 1),
            sp.atan(y / x),
        )
        yield Cut(part, n if common.free_symbols else y, flat + turn, flat - turn, (y, x), beyond=x)
    if common.free_symbols:
        yield Cut(part, common, sp.atan2(n, d), sp.atan2(-n, -d))


def _in_ratio(y: Expr, x: Expr) -> tuple[Expr, Expr]:
    """Return two expressions without a common factor in the ratio of two others."""
    if anatomy([y, x]).tree > LARGE:
        return y, x
    if sp.expand(y) == 0:
        return sp.S.Zero, sp.S.One
    return sp.fraction(sp.cancel(y / x))


def _extremes(part: sp.Max | sp.Min) -> Iterator[Cut]:
    first, *others = arguments(part)
    rest = part.func(*others)
    larger, smaller = (first, rest) if isinstance(part, sp.Max) else (rest, first)
    yield Cut(part, first - rest, larger, smaller, bends=True)
    if len(others) > 1:
        yield from _extremes(rest)


def _pieces(part: sp.Piecewise) -> Iterator[Cut]:
    """Yield a cut for each gap, all relations on it being true or false together."""
    relations = sorted(part.atoms(Relational), key=sp.default_sort_key)
    for i, relation in enumerate(relations):
        gap = _gap(relation)
        same = {r: ratio for r in relations if (ratio := proportion(_gap(r), gap)) is not None}
        if any(r in same for r in relations[:i]):
            continue
        sides = [
            cast("Expr", part.xreplace({r: _truth(r, up == (ratio > 0)) for r, ratio in same.items()}))
            for up in (True, False)
        ]
        yield Cut(part, gap, sides[0], sides[1])


def _gap(relation: Relational) -> Expr:
    return _finite(cast("Expr", relation.lhs) - cast("Expr", relation.rhs))


def _truth(relation: Relational, positive: bool) -> sp.Basic:
    if isinstance(relation, sp.Eq | sp.Ne):
        return sp.true if isinstance(relation, sp.Ne) else sp.false
    return sp.true if positive == isinstance(relation, sp.Gt | sp.Ge) else sp.false


def proportion(u: Expr, gap: Expr) -> Expr | None:
    """Return u/gap if it is a number whose sign is known, so that both vanish on one surface.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> proportion(2 - 2 * x, x - 1), proportion(x**2, x)
    (-2, None)
    """
    ratio = sp.cancel(u / gap) if anatomy([u, gap]).tree <= LARGE else u / gap
    known = ratio.is_positive or ratio.is_negative
    return (
        sp.S.One
        if ratio.is_positive and not ratio.is_number
        else ratio
        if known and ratio.is_number
        else None
    )


def _arcs(part: Expr) -> Iterator[Cut]:
    (u,) = arguments(part)
    if u.has(sp.I) or any(declared_complex(s) for s in free_symbols(u)):
        return
    above, below = coprime(u)
    zero, other = (below, above) if isinstance(part, sp.atan) else (above, below)
    gap = sp.Mul(*(factor for factor in sp.Mul.make_args(zero) if not _is_root(factor)))
    if gap.free_symbols:
        turn, rest = sp.sign(other * zero / gap) * sp.pi / 2, -sp.atan(zero / other)
        yield Cut(part, gap, rest + turn, rest - turn, (other, zero))


def _is_root(factor: Expr) -> bool:
    """Tell whether a factor is a square root or the like, which has one sign where it is real."""
    return isinstance(factor, sp.Pow) and isinstance(factor.exp, sp.Rational) and factor.exp.q % 2 == 0


def coprime(u: Expr) -> tuple[Expr, Expr]:
    """Return numerator and denominator without a common factor, tangents written in sines and cosines."""
    for function, rewritten in _IN_SINES.items():
        u = cast("Expr", u.replace(function, rewritten))
    together = cast("Expr", sp.together(u))
    return sp.fraction(sp.cancel(together) if anatomy([together]).tree <= LARGE else together)


_IN_SINES = {
    sp.tan: lambda u: sp.sin(u) / sp.cos(u),
    sp.cot: lambda u: sp.cos(u) / sp.sin(u),
    sp.sec: lambda u: 1 / sp.cos(u),
    sp.csc: lambda u: 1 / sp.sin(u),
    sp.coth: lambda u: sp.cosh(u) / sp.sinh(u),
    sp.csch: lambda u: 1 / sp.sinh(u),
}


def _roots(part: sp.Pow) -> Iterator[Cut]:
    """Yield a cut for each factor that the radicand has twice, above or below: √(v² w) is |v| √w, √(w/v²) is √w/|v|."""
    exponent = part.exp
    if not isinstance(exponent, sp.Rational) or exponent.is_integer or part.base.is_number:
        return
    unit, factors = _factored(part.base)
    for factor, count in factors:
        if count % 2 == 0 and certainly_real(factor):
            others = sp.Mul(unit, *(g**n for g, n in factors if g != factor))
            above, below = ((side * factor) ** (count * exponent) * others**exponent for side in (1, -1))
            yield Cut(part, factor, above, below, bends=True)


def _factored(u: Expr) -> tuple[Expr, list[tuple[Expr, int]]]:
    """Return a number and the factors of a fraction, those of its denominator counted below zero, as far as known."""
    if anatomy([u]).tree > LARGE:
        return u, []
    found: list[tuple[Expr, int]] = []
    units: list[Expr] = []
    for side, sign in zip(sp.fraction(sp.together(u)), (1, -1), strict=True):
        try:
            unit, factors = cast("tuple[Expr, list[tuple[Expr, int]]]", sp.factor_list(side))
        except sp.PolynomialError:
            return u, []
        units.append(unit**sign)
        found += [(factor, sign * count) for factor, count in factors]
    return sp.Mul(*units), found


def with_moduli(f: Expr) -> Expr:
    """Write u·sign(u) as |u|, which it is everywhere and which does not jump."""
    return cast("Expr", f.replace(lambda e: isinstance(e, sp.Mul), _modulus))


def _modulus(product: Expr) -> Expr:
    powers = product.as_powers_dict()
    for jump in [base for base in powers if isinstance(base, sp.sign) and powers[base] == 1]:
        u = arguments(jump)[0]
        if powers.get(u, 0) == 1:
            product = product / (u * jump) * sp.Abs(u)
    return product


def off_the_kinks(f: Expr) -> Expr:
    """Return a derivative without the impulses that SymPy writes where a sign jumps."""
    return cast("Expr", f.replace(lambda e: isinstance(e, sp.DiracDelta), lambda _: sp.S.Zero))


def without_functions_of_parameters(f: Expr, moving: Sequence[Symbol], domain: Domain) -> Expr:
    """Return an expression in which functions of parameters alone, as ω(τ), are parameters: these have values."""
    elsewhere = (*domain.conditions, *f.atoms(sp.Derivative, sp.Subs))
    held = {
        g: sp.Symbol(str(g), real=g.is_real, positive=g.is_positive)
        for g in f.atoms(AppliedUndef)
        if not g.has(*moving) and not any(part.has(g) for part in elsewhere)
    }
    return cast("Expr", f.xreplace(held)) if held else f


def without_complex_logarithms(f: Expr) -> Expr:
    """Write log z as log|z| + i atan2(Im z, Re z), and roots of complex z likewise, where i stands in z.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> without_complex_logarithms(-sp.I * sp.log(sp.exp(2 * sp.I * x)))
    -I*(log(sqrt(sin(2*x)**2 + cos(2*x)**2)) + I*atan2(sin(2*x), cos(2*x)))
    """
    if not f.has(sp.I) or any(declared_complex(s) for s in free_symbols(f)):
        return f
    return cast("Expr", f.replace(_is_complex_branch, _by_angle))


def _is_complex_branch(e: sp.Basic) -> bool:
    z = e.args[0] if isinstance(e, sp.log | sp.arg) else e.args[0] if isinstance(e, sp.Pow) else None
    root = isinstance(e, sp.Pow) and not e.exp.is_integer and e.exp.is_real
    return (
        z is not None and z.has(sp.I) and (not isinstance(e, sp.Pow) or bool(root)) and bool(z.free_symbols)
    )


def _by_angle(e: Expr, *_: Expr) -> Expr:
    z = arguments(e)[0]
    x, y = z.as_real_imag()
    angle = sp.atan2(y, x)
    if isinstance(e, sp.arg):
        return angle
    logarithm = sp.log(sp.sqrt(x**2 + y**2)) + sp.I * angle
    return sp.exp(e.exp * logarithm) if isinstance(e, sp.Pow) else logarithm
