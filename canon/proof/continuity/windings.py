"""Windings: how often angles turn around a place that they share, and whether their sum turns at all.

An angle of (y, x) turns once around a place where both vanish, in the sense of the sign of ∂(y, x)/∂(s, r) for two of
the variables. Of angles about one centre whose turns undo each other, as those of (q, p) and (p, q) do, the sum has the
differential of a continuous function: no jump of theirs is a matter of choice.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.proof.continuity.winding_centre import SMALL, centres_near
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.proof.continuity.one_sided import Cut
    from canon.proof.domain.domain import Domain

__all__ = ["turns_undone"]

BITS = 96


def turns_undone(f: Expr, angles: Sequence[Cut], moving: Sequence[Symbol], domain: Domain) -> set[Expr]:
    """Return the angles of a function that share a centre around which the turns of all of them undo each other.

    Parameters
    ----------
    f
        The function; an angle within another function is left out.
    angles
        Its cuts at angles that wind.
    moving, domain
        The variables, and where.
    """
    pairs = {cut.part: cut.around for cut in angles if cut.around is not None}
    strengths = _strengths(f, list(pairs))
    undone: set[Expr] = set()
    for angle in strengths:
        variables = _of_the_pair(pairs[angle], moving)
        if not any(variables & _of_the_pair(pairs[other], moving) for other in strengths if other != angle):
            continue
        for two, centre in centres_near(pairs[angle], sorted(variables, key=str), domain):
            turns = {a: _turns(pairs[a], strength, two, centre) for a, strength in strengths.items()}
            undone |= _cancelling(turns)
    return undone


def _strengths(f: Expr, angles: Sequence[Expr]) -> dict[Expr, Expr]:
    """Return what stands before each angle that stands in no other function."""
    marks: dict[Expr, Symbol] = {angle: sp.Dummy("angle", real=True) for angle in angles}
    marked = cast("Expr", f.xreplace(dict(marks)))
    slopes = {angle: marked.diff(mark) for angle, mark in marks.items()}
    return {angle: slope for angle, slope in slopes.items() if slope != 0 and not slope.has(*marks.values())}


def _of_the_pair(pair: tuple[Expr, Expr], moving: Sequence[Symbol]) -> set[Symbol]:
    return {s for s in moving if any(side.has(s) for side in pair)}


def _cancelling(turns: Mapping[Expr, float]) -> set[Expr]:
    """Return the angles that turn around a place, if their turns undo each other."""
    turning = {angle: size for angle, size in turns.items() if size}
    if len(turning) > 1 and abs(sum(turning.values())) <= SMALL * max(map(abs, turning.values())):
        return {*turning}
    return set()


def _turns(
    pair: tuple[Expr, Expr], strength: Expr, two: tuple[Symbol, Symbol], centre: Mapping[Symbol, sp.Rational]
) -> float:
    """Return how far a multiple of the angle of a pair turns around a place; 0 where that is none of its centres."""
    (y, x), (s, r) = pair, two
    turn = y.diff(s) * x.diff(r) - y.diff(r) * x.diff(s)
    with precision(BITS):
        try:
            *there, area, size = (float(value(g, centre).real.mid()) for g in (y, x, turn, strength))
        except (NotDecided, Undefined, Unmodelled):
            return 0.0
    if area == 0 or any(abs(g) > SMALL for g in there):
        return 0.0
    return size if area > 0 else -size
