"""Rational numbers that satisfy polynomial equations: symbols eliminated one by one, conics through a known point.

A point of the rationals near the one that was drawn is wanted, not all of them: each symbol that an equation holds
linearly is solved for; in one unknown the rational roots are tried; a curve of degree two in two unknowns with one
rational point has as many as there are lines through it (L. E. Dickson, History of the Theory of Numbers II, ch. XIII).
"""

from __future__ import annotations

from math import isqrt
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Rational, Symbol

from canon.proof.trees.affine_form import is_affine
from canon.proof.trees.polynomial import MOST_TERMS, terms_at_most
from canon.proof.trees.sympy_types import by_name, free_symbols, rational

if TYPE_CHECKING:
    import random
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr

__all__ = ["rational_solution"]

NUMERATORS, DENOMINATORS = 6, 5
"""Numbers that are tried for a first point of a conic."""


def rational_solution(
    equations: Sequence[Expr], near: Mapping[Symbol, Rational], chance: random.Random
) -> dict[Symbol, Rational] | None:
    """Return rational numbers for all the symbols that satisfy equations, each = 0; None where none were found.

    Parameters
    ----------
    equations
        What should vanish.
    near
        A number for each symbol; those that the equations leave free keep it.
    chance
        Chooses between several solutions.

    Examples
    --------
    >>> import random
    >>> a, b, c, d = sp.symbols("a b c d")
    >>> near = {a: Rational(1, 2), b: Rational(1), c: Rational(3), d: Rational(1, 3)}
    >>> point = rational_solution([a * d - b * c - 1, a - d, b + c], near, random.Random(1))
    >>> point[a] == point[d], point[a] ** 2 + point[b] ** 2
    (True, 1)
    """
    settled = _solved_in_turn(equations, near)
    if settled is not None:
        return settled
    given, near = near, dict(near)
    known = _solved_step_by_step(equations, near, chance)
    if known is None:
        return None
    free = {s: number for s, number in near.items() if s not in known}
    found = {s: f.xreplace(free) for s, f in known.items()}
    if not all(isinstance(number, Rational) for number in found.values()):
        return None
    whole = {**free, **{s: rational(number) for s, number in found.items()}}
    return {s: whole[s] for s in given}


def _solved_step_by_step(
    equations: Sequence[Expr], near: dict[Symbol, Rational], chance: random.Random
) -> dict[Symbol, Expr] | None:
    """Return some symbols in terms of the others, equations solved one by one; ``near`` gains roots as symbols."""
    known: dict[Symbol, Expr] = {}
    left = list(_without_roots(equations, near, chance))
    if any(terms_at_most(e) > MOST_TERMS for e in left):
        return None
    left = [sp.expand(e) for e in left]
    while left := [e for e in left if e != 0]:
        if any(e.is_number for e in left):
            return None
        step: Mapping[Symbol, Expr] | None = (
            _linear(left) or _of_one(left, chance) or _of_two(left, near, chance)
        )
        if step is None:
            chosen = _put_in(left, near)
            if chosen is None:
                return None
            step = {chosen: near[chosen]}
        known = {s: cast("Expr", f.xreplace(step)) for s, f in known.items()} | dict(step)
        left = [sp.expand(cast("Expr", e.xreplace(step))) for e in left]
        if any(e.has(sp.zoo, sp.nan, sp.oo) for e in left):
            return None
    return known


def _solved_in_turn(
    equations: Sequence[Expr], near: Mapping[Symbol, Rational]
) -> dict[Symbol, Rational] | None:
    """Solve each equality for a symbol it holds linearly and that none before it holds."""
    kept: set[Symbol] = set()
    settled = dict(near)
    for gap in equations:
        for s in (s for s in near if gap.has(s) and s not in kept):
            slope = gap.diff(s)
            if s in slope.free_symbols or not is_affine(gap, [s]):
                continue
            others = {name: number for name, number in settled.items() if name != s}
            slope = cast("Expr", slope.xreplace(others))
            rest = cast("Expr", gap.xreplace({s: sp.Integer(0)}).xreplace(others))
            if slope.is_Rational and rest.is_Rational and slope != 0:
                settled[s] = rational(-rest / slope)
                break
        else:
            return None
        kept |= free_symbols(gap)
    return settled


def _without_roots(
    equations: Sequence[Expr], near: dict[Symbol, Rational], chance: random.Random
) -> list[Expr]:
    """Write each root of what holds symbols as a symbol of its own, its power as one equation more."""
    found = {p for e in equations for p in e.atoms(sp.Pow)}
    by: dict[sp.Basic, Expr] = {}
    powers: dict[Symbol, Expr] = {}
    names: dict[Expr, Symbol] = {}
    for power in sorted(found, key=sp.default_sort_key):
        base, exponent = power.as_base_exp()
        if isinstance(exponent, Rational) and exponent.q > 1 and free_symbols(base):
            degree = int(exponent.q)
            root = sp.root(base, degree)
            name = names.setdefault(root, sp.Dummy("root", positive=True))
            near[name] = rational(Rational(chance.randint(1, 9), chance.randint(1, 5)))
            by[power] = name ** int(exponent.p)
            powers[name] = name**degree - base
    return [cast("Expr", e.xreplace(by)) for e in (*equations, *powers.values())]


def _linear(equations: Sequence[Expr]) -> dict[Symbol, Expr] | None:
    """Return a symbol that an equation holds linearly with a slope that is a number, and its value."""
    for e in equations:
        for s in by_name(e):
            slope = e.diff(s)
            if isinstance(slope, Rational) and is_affine(e, [s]):
                rest = cast("Expr", e.xreplace({s: sp.Integer(0)}))
                return {s: sp.expand(-rest / slope)}
    return None


def _of_one(equations: Sequence[Expr], chance: random.Random) -> dict[Symbol, Expr] | None:
    """Return a rational root of an equation in one unknown, such as one of degree two."""
    for e in equations:
        symbols = by_name(e)
        if len(symbols) == 1:
            roots = _rational_roots(e, symbols[0])
            return {symbols[0]: chance.choice(roots)} if roots else None
    return None


def _rational_roots(equation: Expr, symbol: Symbol) -> list[Rational]:
    poly = _polynomial(equation, symbol)
    if poly is None or poly.degree() > 4:
        return []
    if poly.degree() == 2:
        a, b, c = (rational(k) for k in poly.all_coeffs())
        root = _root(rational(b**2 - 4 * a * c))
        return [] if root is None else [rational((-b + sign * root) / (2 * a)) for sign in (1, -1)]
    return [rational(root) for root in sp.roots(poly, filter="Q")]


def _of_two(
    equations: Sequence[Expr], near: Mapping[Symbol, Rational], chance: random.Random
) -> dict[Symbol, Expr] | None:
    """Return a point of a conic: the second point of a line through one that was found by trial."""
    for e in equations:
        symbols = by_name(e)
        if len(symbols) != 2:
            continue
        poly = _polynomial(e, *symbols)
        if poly is None or poly.total_degree() != 2:
            continue
        x, y = symbols
        for start in _trials(near[x]):
            there = sp.expand(cast("Expr", e.xreplace({x: start})))
            for root in _rational_roots(there, y) if there.has(y) else ():
                return _second_point(e, {x: start, y: root}, chance)
        return None
    return None


def _second_point(
    conic: Expr, first: Mapping[Symbol, Rational], chance: random.Random
) -> dict[Symbol, Expr] | None:
    """Return the other point of a conic on a line of random rational slope through a first point."""
    x, y = first
    along = sp.Dummy("along")
    slope = Rational(chance.randint(-9, 9), chance.randint(1, 7))
    line = {x: first[x] + along, y: first[y] + slope * along}
    on_line = _polynomial(sp.expand(cast("Expr", conic.xreplace(line))), along)
    if on_line is None or on_line.degree() != 2:
        return dict(first)
    a, b, _ = on_line.all_coeffs()
    return {s: cast("Expr", f.xreplace({along: -b / a})) for s, f in line.items()}


def _trials(near: Rational) -> Iterator[Rational]:
    yield near
    for q in range(1, DENOMINATORS + 1):
        for p in range(-NUMERATORS, NUMERATORS + 1):
            yield rational(Rational(p, q))


def _put_in(equations: Sequence[Expr], near: Mapping[Symbol, Rational]) -> Symbol | None:
    """Return the symbol that takes the number it was drawn with: one that leaves others with a lower degree."""
    symbols = sorted({s for e in equations for s in free_symbols(e)}, key=lambda s: s.name)
    rank = {s: sum(1 for e in equations if e.has(s) and s in e.diff(s).free_symbols) for s in symbols}
    return min((s for s in symbols if s in near), key=lambda s: (-rank[s], s.name), default=None)


def _polynomial(equation: Expr, *symbols: Symbol) -> sp.Poly | None:
    try:
        poly = sp.Poly(equation, *symbols)
    except sp.PolynomialError:
        return None
    return poly if all(isinstance(c, Rational) for c in poly.coeffs()) else None


def _root(number: Rational) -> Rational | None:
    """Return the square root of a rational number, if it is rational."""
    if number < 0:
        return None
    p, q = isqrt(int(number.p)), isqrt(int(number.q))
    return rational(Rational(p, q)) if p * p == number.p and q * q == number.q else None
