"""Winding centres: places where two functions vanish together, so that the angle of the pair jumps around them."""

from __future__ import annotations

from itertools import combinations, permutations, product
from typing import TYPE_CHECKING

import sympy as sp

from canon.proof.analytic import proved_sign
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain.domain import Domain
from canon.proof.domain.relations import linear, parts_of
from canon.proof.trees.affine_form import is_affine
from canon.proof.trees.sympy_types import free_symbols, short

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.proof.continuity.one_sided import Cut

__all__ = ["SMALL", "centre_of", "centres_near", "common_zero"]

STARTS = 12
STEPS = 24
SMALL = 1e-9


def centre_of(cut: Cut, moving: Sequence[Symbol], domain: Domain) -> str | None:
    """Return a place around which an angle winds, in words; "" where there is none, None where none was found.

    Numerator and denominator vanish together there, as q and p do for atan(q/p), and their differentials are
    independent. That the sum of their squares is positive excludes it, as for tan u = sin u/cos u.
    """
    if cut.around is None:
        return ""
    kinds = (sp.StrictLessThan, sp.LessThan, sp.StrictGreaterThan, sp.GreaterThan)
    hull = Domain(tuple(c for c in parts_of(domain.conditions) if isinstance(c, kinds) and linear(c)))
    present = [s for s in moving if any(side.has(s) for side in cut.around)]
    squares = sp.Add(*(side**2 for side in cut.around))
    apart = any(proved_sign(side, hull) in ("+", "-") for side in (*cut.around, squares))
    if len(present) < 2 or apart:
        return ""
    return common_zero(cut.around, present, hull) or None


def common_zero(pair: tuple[Expr, Expr], variables: Sequence[Symbol], domain: Domain) -> str:
    """Return a place of a convex domain, or of its boundary, where two functions vanish together; "" if none is found.

    First one of them is solved for a variable in which it is linear, and the other, on that surface, for another; else
    Newton's method is used in two variables from points of the domain.

    Examples
    --------
    >>> import sympy as sp
    >>> from canon.proof.domain.domain import Domain
    >>> q, p = sp.symbols("q p", real=True)
    >>> common_zero((q, p), [q, p], Domain()), common_zero((sp.sin(q + p), sp.cos(q + p)), [q, p], Domain())
    ('p = 0, q = 0', '')
    """
    solved = _solved_in_turn(pair, variables)
    if solved:
        return solved
    found = next(centres_near(pair, variables, domain), None)
    return "" if found is None else " and ".join(f"{f} = 0" for f in pair)


def centres_near(
    pair: tuple[Expr, Expr], variables: Sequence[Symbol], domain: Domain
) -> Iterator[tuple[tuple[Symbol, Symbol], dict[Symbol, sp.Rational]]]:
    """Yield places where two functions vanish together, found from some points of a domain, by which two variables."""
    for point in domain.points(free_symbols(pair[0]) | free_symbols(pair[1]) | {*variables}, STARTS):
        for two in combinations(variables, 2):
            found = _newton(pair, two, point)
            if found is not None and domain.contains(point | found):
                yield two, {**point, **found}


def _solved_in_turn(pair: tuple[Expr, Expr], variables: Sequence[Symbol]) -> str:
    """Return where two functions vanish together, one of them linear in one variable, then the other in another."""
    for (first, second), (s, r) in product((pair, pair[::-1]), permutations(variables, 2)):
        zero = _zero(first, s)
        there = None if zero is None else _zero(second.subs(s, zero), r)
        if zero is not None and there is not None and s not in free_symbols(there):
            return ", ".join(f"{x} = {place}" for x, place in sorted(((s, zero), (r, there)), key=str))
    return ""


def _zero(f: Expr, s: Symbol) -> Expr | None:
    """Return the zero of what is linear in a symbol."""
    slope = f.diff(s)
    if slope.has(s) or slope.is_nonzero is not True or not is_affine(f, [s]):
        return None
    return -f.subs(s, 0) / slope


def _newton(
    pair: tuple[Expr, Expr], two: tuple[Symbol, Symbol], start: Mapping[Symbol, sp.Rational]
) -> dict[Symbol, sp.Rational] | None:
    """Return where Newton's method ends, if both functions vanish there and their differentials are independent."""
    point = dict(start)
    slopes = [f.diff(s) for f in pair for s in two]
    size = 1.0
    for _ in range(STEPS):
        with precision(96):
            try:
                f, g, a, b, c, d = (float(value(e, point).real.mid()) for e in (*pair, *slopes))
            except (NotDecided, Undefined, Unmodelled):
                return None
        det = a * d - b * c
        scale = (a * a + b * b) ** 0.5 * (c * c + d * d) ** 0.5
        if not scale < float("inf") or abs(det) <= 1e-6 * scale:
            return None
        size = abs(f) + abs(g)
        if size < SMALL:
            return {s: point[s] for s in two}
        steps = ((d * f - b * g) / det, (a * g - c * f) / det)
        for s, step in zip(two, steps, strict=True):
            point[s] = short(float(point[s]) - step, 10**15)
    return None
