"""Corner points: points close to the ends of a domain, and to kinks, poles and branch points of both sides.

A claim may be false on a tiny set only: |x − 10⁻⁷| = x − 10⁻⁷ for 0 < x < 10⁻⁷. Between two neighbouring places where a
formula changes nothing changes, so one point between any two of them, and points very close to each, find such sets.
"""

from __future__ import annotations

import time
from itertools import combinations, islice, pairwise, product
from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import acb, arb, fmpq, fmpz_poly
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational

from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain.declarations import declared_complex
from canon.proof.trees.anatomy import Anatomy, anatomy
from canon.proof.trees.polynomial import MOST_TERMS, terms_at_most
from canon.proof.trees.sympy_types import arguments, rational

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.proof.domain.domain import Domain

    Point = dict[Symbol, sp.Rational]

__all__ = ["corner_points", "places_of_change"]

LARGEST_GAP = 200
"""Size of an argument whose zeros are looked for."""

MOST_GAPS = 24
MOST_DEGREE = 12
BITS = 256
"""Precision of places, far finer than the least distance from them."""

DISTANCES = tuple(rational(sp.Rational(1, 10**k)) for k in (30, 14, 9, 5, 2))
"""How far from a place where formulas change points are put, on both sides."""

BASES = 3
"""Choices of the other symbols' values."""

MOST_SHOWN = 10**40
"""Denominator of places that are taken exactly; others are near irrational ones."""

PERIODS = (0, -1, 1)

ROOTS_OF_UNITY = (sp.asin, sp.acos, sp.atanh, sp.asec, sp.acsc, sp.acoth, sp.acosh, sp.asech)
"""Functions that branch where their argument is 1 or −1."""


def places_of_change(sides: Anatomy, domain: Domain) -> list[Expr]:
    """Return what vanishes at ends of the domain, kinks, poles and branch points of some expressions.

    Examples
    --------
    >>> from canon.proof import Domain
    >>> x = sp.Symbol("x", real=True)
    >>> places_of_change(anatomy([sp.asin(x) + abs(x - 3)]), Domain((x < 1,)))
    [x - 1, x - 3, x + 1]
    """
    relations = [r for condition in domain.conditions for r in condition.atoms(Relational)]
    relations.extend(sides.of(Relational))
    found: dict[sp.Basic, None] = {r.lhs - r.rhs: None for r in relations if isinstance(r.lhs, sp.Expr)}
    found |= {e.args[0]: None for e in sides.of(sp.Abs, sp.sign, sp.Heaviside, sp.acot, sp.log)}
    found |= {a - b: None for e in sides.of(sp.Max, sp.Min) for a, b in combinations(e.args, 2)}
    found |= {e.base: None for e in sides.of(sp.Pow) if not e.exp.is_integer or e.exp.is_negative}
    found |= {e.args[0] + one: None for e in sides.of(*ROOTS_OF_UNITY) for one in (-1, 1)}
    found |= {a: None for e in sides.of(sp.atan2) for a in e.args}
    varying = [cast("Expr", g) for g in found if g.free_symbols and not g.has(AppliedUndef)]
    return [g for g in varying if anatomy([g]).tree <= LARGEST_GAP]


def corner_points(
    sides: Anatomy, domain: Domain, deadline: float = float("inf")
) -> Iterator[dict[Symbol, sp.Rational]]:
    """Yield points of the domain next to places where formulas change, and between any two of them.

    Examples
    --------
    >>> from canon.proof import Domain
    >>> x = sp.Symbol("x", positive=True)
    >>> any(x_there[x] < sp.Rational(1, 10**7) for x_there in corner_points(anatomy([abs(x - 1)]), Domain()))
    True
    """
    gaps = places_of_change(sides, domain)[:MOST_GAPS]
    symbols = sorted((s for s in sides.symbols if not declared_complex(s)), key=lambda s: s.name)
    moving = [s for s in symbols if not s.is_integer]
    gaps += [s for s in moving if s.is_nonnegative or s.is_nonpositive]
    number = BASES if len(symbols) > 1 else 1
    bases = list(domain.points(sides.symbols, number, seed=5, but_functions=True, deadline=deadline))
    if any(isinstance(c, sp.Eq) for c in domain.conditions):
        marks = {s: _values(gaps, s, base) for base in bases[:1] for s in moving}
        yield from domain.points(
            sides.symbols, 60, seed=6, marks=marks, but_functions=True, deadline=deadline
        )
        return
    for base, s in product(bases, moving):
        yield from _moved(base, s, gaps, domain, deadline)
    for base in bases[:1]:
        yield from _moved_twice(base, moving, gaps, domain, deadline)


def _moved_twice(
    base: dict[Symbol, sp.Rational],
    moving: Sequence[Symbol],
    gaps: Sequence[Expr],
    domain: Domain,
    deadline: float,
) -> Iterator[dict[Symbol, sp.Rational]]:
    """Yield a point moved in one symbol to where formulas in it alone change, and then in another."""
    for s in moving:
        own = [g for g in gaps if g.free_symbols == {s}]
        close = [v for root in _places(own, s, {}) for v in _beside(root, DISTANCES[:2])]
        for v, other in product(close, (other for other in moving if other != s)):
            yield from _moved({**base, s: v}, other, gaps, domain, deadline)


def _moved(base: Point, s: Symbol, gaps: Sequence[Expr], domain: Domain, deadline: float) -> Iterator[Point]:
    """Yield a point with one symbol moved to where formulas change, until the deadline."""
    if time.monotonic() > deadline:
        return
    for number in _values(gaps, s, base):
        if time.monotonic() > deadline:
            return
        point = {**base, s: number}
        if domain.admits(point):
            yield point


def _values(gaps: Sequence[Expr], s: Symbol, base: Mapping[Symbol, sp.Rational]) -> list[sp.Rational]:
    """Return values of a symbol at, between and beside the places where formulas change."""
    places = _places(gaps, s, base)
    between = [_short((a + b) / 2, (b - a) / 8) for a, b in pairwise(places)]
    exact = [place for place in places if place.q < MOST_SHOWN]
    return [*between, *exact, *(v for place in places for v in _beside(place, DISTANCES))]


def _beside(place: sp.Rational, distances: Iterable[sp.Rational]) -> Iterator[sp.Rational]:
    for distance in distances:
        for v in (place + distance, place - distance):
            yield _short(v, distance / 8)


def _short(number: Expr, error: Expr) -> sp.Rational:
    """Return a decimal number that is as near as is asked."""
    exact = rational(number)
    if exact.q < MOST_SHOWN:
        return exact
    digits = 10 ** len(str(int(1 / error)))
    return rational(sp.Rational((2 * int(exact.p) * digits + int(exact.q)) // (2 * int(exact.q)), digits))


def _places(gaps: Iterable[Expr], s: Symbol, base: Mapping[Symbol, sp.Rational]) -> list[sp.Rational]:
    """Return where functions of one symbol vanish, the others having the values of a point."""
    found: set[sp.Rational] = set()
    with precision(BITS):
        for gap in gaps:
            roots = (root for f in sp.Mul.make_args(gap) for root in _roots(f, s, base))
            found |= set(islice(roots, 3 * MOST_DEGREE))
    return sorted(found)


def _roots(f: Expr, s: Symbol, base: Mapping[Symbol, sp.Rational]) -> Iterator[sp.Rational]:
    """Yield real zeros of a polynomial, or of elementary functions of one, as rationals at or near them."""
    if s not in f.free_symbols:
        return
    if isinstance(f, sp.Pow) and f.exp.is_positive:
        yield from _roots(f.base, s, base)
    elif f.is_polynomial(s):
        yield from _polynomial_roots(f, s, base)
    else:
        for inner in _peeled(f, s):
            yield from _roots(inner, s, base)


def _polynomial_roots(f: Expr, s: Symbol, base: Mapping[Symbol, sp.Rational]) -> Iterator[sp.Rational]:
    if terms_at_most(f) > MOST_TERMS or (poly := sp.Poly(f, s)).degree() > MOST_DEGREE:
        return
    coefficients = [_number(c, base) for c in reversed(poly.all_coeffs())]
    if None in coefficients:
        return
    exact = cast("list[sp.Rational]", coefficients)
    while exact and exact[-1] == 0:
        exact.pop()
    if len(exact) == 2:
        yield rational(-exact[0] / exact[1])
    elif len(exact) > 2:
        common = int(sp.ilcm(*(c.q for c in exact)))
        whole = fmpz_poly([int(c * common) for c in exact])
        for root, _ in cast("list[tuple[acb, int]]", whole.complex_roots()):
            if root.imag.contains(0):
                yield _middle(root.real)


def _number(c: Expr, base: Mapping[Symbol, sp.Rational]) -> sp.Rational | None:
    """Return the value at a point, where it is real: exactly for polynomials, otherwise very nearly."""
    if c.is_polynomial() and not c.atoms(sp.NumberSymbol):
        exact = c.xreplace(dict(base))
        if isinstance(exact, sp.Rational):
            return exact
    try:
        ball = value(c, base)
    except (NotDecided, Undefined, Unmodelled):
        return None
    return _middle(ball.real) if ball.imag.contains(0) and ball.real.is_finite() else None


def _middle(ball: arb) -> sp.Rational:
    exact = ball.unique_fmpz()
    if exact is not None:
        return sp.Integer(int(exact))
    mantissa, exponent = ball.mid().man_exp()
    number = fmpq(int(mantissa)) * fmpq(2) ** int(exponent)
    return rational(sp.Rational(int(number.p), int(number.q)))


def _peeled(f: Expr, s: Symbol) -> Iterator[Expr]:
    """Yield u − c where f = 0 says h(u) = b for an elementary function h."""
    rest, outer = f.as_independent(s, as_Add=True)
    scale, function = outer.as_independent(s, as_Add=False)
    b, u = -rest / scale, arguments(function)[0]
    match function:
        case sp.sin() | sp.cos():
            first = sp.asin(b) if isinstance(function, sp.sin) else sp.acos(b)
            second = sp.pi - first if isinstance(function, sp.sin) else -first
            yield from (u - c - 2 * sp.pi * k for k in PERIODS for c in (first, second))
        case sp.tan() | sp.cot():
            yield from (u - _INVERSE[type(function)](b) - sp.pi * k for k in PERIODS)
        case sp.Abs():
            yield from (u - b, u + b)
        case sp.Pow() if isinstance(function.exp, sp.Rational) and b != 0:
            root = b ** (1 / function.exp)
            yield from (u - root, u + root)
        case _ if type(function) in _INVERSE:
            yield u - _INVERSE[type(function)](b)
        case _:
            return


_INVERSE: dict[type[Expr], type[sp.Function]] = {
    sp.tan: sp.atan,
    sp.cot: sp.acot,
    sp.exp: sp.log,
    sp.log: sp.exp,
    sp.sinh: sp.asinh,
    sp.tanh: sp.atanh,
    sp.atan: sp.tan,
    sp.asin: sp.sin,
    sp.acos: sp.cos,
    sp.asinh: sp.sinh,
}
