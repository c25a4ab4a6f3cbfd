"""Certified jumps: a point of the domain at which a function has different limits from two sides.

On a line through the domain, one symbol varying, the gap of a cut is bracketed where it changes its sign and rises or
falls strictly. Both continuations are enclosed on the whole bracket; if the enclosures are disjoint, the function jumps
inside the bracket, whatever the exact place is.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, cast

import sympy as sp
from flint import acb, arb, fmpq

from canon.proof.continuity.one_sided import Cut, cuts_of, off_the_kinks, proportion
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, holds_at, precision, value
from canon.proof.trees.sympy_types import free_symbols, rational, short

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.proof.domain.domain import Domain

__all__ = ["Jump", "continued", "find_jump", "jump_between", "real_sides", "shown"]

BITS = 192
NARROW = 60
"""Halvings of a bracket."""

POINTS = 10
SAME_SURFACE = 4
"""Rounds in which functions within functions are continued across one surface."""

_NO_VALUE = (NotDecided, Undefined, Unmodelled)


@dataclass(frozen=True)
class Jump:
    """A jump between two values, near a point of the domain where ``symbol`` varies.

    Parameters
    ----------
    point
        The values of all symbols, that of the varying one rounded.
    symbol
        The symbol that varies.
    before, after
        Decimal text of the limits from below and from above.
    """

    point: Mapping[str, str]
    symbol: Symbol
    before: str
    after: str


def find_jump(f: Expr, cut: Cut, variables: Sequence[Symbol], domain: Domain, deadline: float) -> Jump | None:
    """Return a certified jump of an expression across the surface of one of its cuts, None where none is found.

    Parameters
    ----------
    f
        The expression.
    cut
        One of its cuts.
    variables
        The symbols that may vary; the others are parameters.
    domain
        Where the jump should lie.
    deadline
        Value of :func:`time.monotonic` to stop at.

    Examples
    --------
    >>> from canon.proof.domain.domain import Domain
    >>> x = sp.Symbol("x", real=True)
    >>> f = x - sp.atan(sp.tan(x))
    >>> found = find_jump(f, cuts_of(f, [x])[0], [x], Domain(), time.monotonic() + 1)
    >>> found is not None and (found.before[:6], found.after[:6])
    ('0', '3.1415')
    """
    sides = [continued(f, cut.gap, variables, up=up) for up in (True, False)]
    return jump_between(sides, cut.gap, variables, domain, deadline)


def jump_between(
    sides: Sequence[Expr],
    gap: Expr,
    variables: Sequence[Symbol],
    domain: Domain,
    deadline: float,
    positive: Sequence[Expr] = (),
) -> Jump | None:
    """Return a certified jump between two functions at a surface, the first holding where the gap is positive.

    Both are analytic across the surface wherever all of ``positive`` are so.
    """
    symbols = {s for f in (*sides, gap, *positive) for s in free_symbols(f)}
    for point, s, ends in _crossings(symbols, gap, variables, domain, deadline):
        if time.monotonic() > deadline:
            return None
        found = _jump_in(ends, s, point, gap, sides, domain, positive)
        if found is not None:
            return found
    return None


def real_sides(
    f: Expr, gap: Expr, variables: Sequence[Symbol], domain: Domain, deadline: float
) -> int | None:
    """Return on how many sides of a surface a function may be real, where it was looked at; None where it was nowhere.

    It is analytic off the surfaces where it branches, so that it is not real in the parts that hold points where it is
    certainly not. What is claimed is claimed where it is real: on one side, or on none, there is nothing to jump.

    Examples
    --------
    >>> from canon.proof.domain.domain import Domain
    >>> x = sp.Symbol("x", real=True)
    >>> [real_sides(f, x, [x], Domain(), time.monotonic() + 1) for f in (sp.sqrt(x), sp.sqrt(x - 1), abs(x))]
    [1, 0, 2]
    """
    seen: int | None = None
    for point, s, ends in _crossings(free_symbols(f) | free_symbols(gap), gap, variables, domain, deadline):
        if time.monotonic() > deadline:
            return None
        sides = [{**point, s: end} for end in ends]
        if all(domain.admits(side) for side in sides):
            seen = max(seen or 0, sum(_may_be_real(f, side) for side in sides))
            if seen == len(sides):
                break
    return seen


def _crossings(
    symbols: set[Symbol], gap: Expr, variables: Sequence[Symbol], domain: Domain, deadline: float
) -> Iterator[tuple[Mapping[Symbol, sp.Rational], Symbol, tuple[sp.Rational, sp.Rational]]]:
    """Yield points of a domain, a symbol, and ends between which it takes the point across a surface."""
    for point in domain.points(symbols, POINTS, deadline=deadline):
        for s in sorted(free_symbols(gap) & set(variables), key=str):
            yield from ((point, s, ends) for ends in _brackets(gap, s, point))


def _may_be_real(f: Expr, point: Mapping[Symbol, sp.Rational]) -> bool:
    with precision(BITS):
        try:
            return bool(value(f, point).imag.contains(0))
        except _NO_VALUE:
            return True


def continued(f: Expr, gap: Expr, variables: Sequence[Symbol], *, up: bool) -> Expr:
    """Return what an expression is on one side of a surface, as an expression that is analytic across it.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> continued(abs(x) / x + sp.sign(-x), x, [x], up=False)
    0
    """
    for _ in range(SAME_SURFACE):
        by: dict[Expr, Expr] = {}
        for cut in cuts_of(f, variables):
            ratio = proportion(cut.gap, gap)
            if ratio is not None:
                by[cut.part] = cut.above if up == bool(ratio > 0) else cut.below
        if not by:
            break
        f = cast("Expr", f.xreplace(by))
    return sp.cancel(f) if f.is_rational_function() else f


def _brackets(
    gap: Expr, s: Symbol, point: Mapping[Symbol, sp.Rational]
) -> Iterator[tuple[sp.Rational, sp.Rational]]:
    """Yield short intervals at whose ends the gap has different signs, the other symbols having their values."""
    if s.is_integer:
        return
    others = {x: number for x, number in point.items() if x != s}
    here = cast("Expr", gap.xreplace(others))
    for root in _roots(here, s):
        yield from _narrowed(here, s, rational(root - _NEAR), rational(root + _NEAR))
    places = sorted({*_STEPS, *(rational(point[s] + step) for step in _STEPS)})
    for a, b in pairwise(places):
        if _sign(here, s, a) * _sign(here, s, b) < 0:
            yield from _narrowed(here, s, a, b)


_NEAR = rational(sp.Rational(1, 2**20))

_STEPS = tuple(
    rational(sp.Rational(sign * number, 7))
    for number in (1, 3, 5, 8, 11, 15, 19, 24, 31, 45, 80, 200)
    for sign in (1, -1)
)


def _roots(gap: Expr, s: Symbol) -> Iterator[sp.Rational]:
    """Yield zeros, or rational numbers near them, of factors that are linear in the symbol or sines of what is."""
    for factor in sp.Mul.make_args(gap):
        inner = factor.base if isinstance(factor, sp.Pow) else factor
        start = sp.S.Zero
        if isinstance(inner, sp.sin | sp.cos):
            start = sp.pi / 2 if isinstance(inner, sp.cos) else sp.S.Zero
            inner = cast("Expr", inner.args[0])
        slope = inner.diff(s)
        if slope == 0 or slope.free_symbols:
            continue
        zero = (start - cast("Expr", inner.xreplace({s: sp.S.Zero}))) / slope
        if not zero.free_symbols and zero.is_real:
            yield zero if isinstance(zero, sp.Rational) else short(float(zero), 10**6)


def _narrowed(
    gap: Expr, s: Symbol, a: sp.Rational, b: sp.Rational
) -> Iterator[tuple[sp.Rational, sp.Rational]]:
    low = _sign(gap, s, a)
    if low * _sign(gap, s, b) >= 0:
        return
    for i in range(NARROW):
        middle = rational(a + (b - a) * (sp.Rational(1, 2) + sp.Rational(1 + i % 3, 64)))
        here = _sign(gap, s, middle)
        if here == 0:
            break
        a, b = (middle, b) if here == low else (a, middle)
    yield a, b


def _sign(gap: Expr, s: Symbol, place: sp.Rational) -> int:
    """Return the certain sign of the gap at a place, 0 where there is none."""
    with precision(BITS):
        try:
            found = value(gap, {s: place})
        except _NO_VALUE:
            return 0
    if not found.imag.is_zero() or found.real.contains(0):
        return 0
    return 1 if found.real > 0 else -1


def _jump_in(
    bracket: tuple[sp.Rational, sp.Rational],
    s: Symbol,
    point: Mapping[Symbol, sp.Rational],
    gap: Expr,
    sides: Sequence[Expr],
    domain: Domain,
    positive: Sequence[Expr] = (),
) -> Jump | None:
    others = {x: number for x, number in point.items() if x != s}
    with precision(BITS):
        ball = _ball(*bracket)
        memo: dict[sp.Basic, acb] = {s: ball}
        try:
            if not _allowed(s, ball) or not all(holds_at(c, others, memo) for c in domain.conditions):
                return None
            slope = value(off_the_kinks(gap.diff(s)), others, memo)
            clear = all(_clear(e, s, others, memo) for e in (gap, *sides))
            clear = clear and all(_is_positive(e, others, memo) for e in positive)
            if slope.contains(0) or not clear:
                return None
            above, below = (value(side, others, memo) for side in sides)
        except _NO_VALUE:
            return None
        if (above - below).contains(0):
            return None
        before, after = (below, above) if slope.real > 0 else (above, below)
        where = {x.name: str(number) for x, number in others.items()} | {s.name: _place(*bracket)}
        return Jump(where, s, shown(before), shown(after))


def _is_positive(e: Expr, others: Mapping[Symbol, sp.Rational], memo: dict[sp.Basic, acb]) -> bool:
    found = value(e, others, memo)
    return bool(found.imag.is_zero() and found.real > 0)


def _place(a: sp.Rational, b: sp.Rational) -> str:
    """Return a short fraction inside a bracket, or a decimal near it."""
    middle = Fraction(int(a.p), int(a.q)) / 2 + Fraction(int(b.p), int(b.q)) / 2
    simple = short(middle, 1000)
    return str(simple) if a < simple < b else f"{float(middle):.6g}"


def _ball(a: sp.Rational, b: sp.Rational) -> acb:
    ends = [arb(fmpq(int(end.p), int(end.q))) for end in (a, b)]
    return acb(ends[0].union(ends[1]))


def _allowed(s: Symbol, ball: acb) -> bool:
    """Tell whether the whole bracket has the sign that was declared of the symbol."""
    if s.is_nonnegative:
        return bool(ball.real > 0)
    if s.is_nonpositive:
        return bool(ball.real < 0)
    return s.is_zero is None and (s.is_nonzero is not True or not ball.contains(0))


def _clear(e: Expr, s: Symbol, others: Mapping[Symbol, sp.Rational], memo: dict[sp.Basic, acb]) -> bool:
    """Tell whether no cut of an expression reaches into the bracket."""
    return not any(value(cut.gap, others, memo).contains(0) for cut in cuts_of(e, [s]))


def shown(z: acb) -> str:
    """Return a few certain digits of a value."""
    real = "0" if z.real.contains(0) else _digits(z.real)
    if z.imag.contains(0):
        return real
    imaginary = f"{_digits(z.imag)}*I"
    return imaginary if real == "0" else f"{real} + {imaginary}"


def _digits(x: arb) -> str:
    text = x.str(8, radius=False)
    return text if "e" in text or "." not in text else text.rstrip("0").rstrip(".")
