"""Steps of functions whose derivatives vanish: another number on one side of a place than on the other."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.proof.analytic import parting
from canon.proof.continuity.jumps import shown
from canon.proof.continuity.one_sided import off_the_kinks
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain.domain import EVERYWHERE, Domain, conditions_hold
from canon.proof.domain.relations import linear, parts_of
from canon.proof.kinks import vanishes_off_kinks
from canon.proof.trees.sympy_types import free_symbols

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from flint import acb
    from sympy import Expr, Symbol
    from sympy.logic.boolalg import Boolean

__all__ = ["Fault", "is_locally_constant", "nonzero", "step_between_pieces"]

VALUES = 24
"""Points at which a locally constant function is evaluated."""
SHARE = 0.5
"""Part of the time for one question about derivatives."""


@dataclass(frozen=True)
class Fault:
    """Where a function jumps, and between which values."""

    point: Mapping[str, str]
    before: str
    after: str
    said: str


def is_locally_constant(
    f: Expr, variables: Iterable[Symbol], domain: Domain = EVERYWHERE, budget: float = 1.0
) -> bool:
    """Tell whether all derivatives of a function are proved to vanish, so that it is a number on each piece.

    Examples
    --------
    >>> q = sp.Symbol("q", real=True)
    >>> is_locally_constant(sp.atan(1 / q) + sp.atan(q), [q]), is_locally_constant(sp.atan(q), [q])
    (True, False)
    """
    moving = [s for s in variables if f.has(s)]
    slopes = [off_the_kinks(f.diff(s)) for s in moving]
    return not moving or vanishes_off_kinks(sp.Matrix(slopes), domain, budget).holds


def step_between_pieces(
    f: Expr, moving: Sequence[Symbol], domain: Domain, deadline: float, borders: Sequence[Expr] = ()
) -> Fault | None:
    """Return two points of one piece of the domain between which a locally constant function changes.

    The domain comes to pieces where one of the ``borders`` vanishes, which have to be planes.
    """
    left = deadline - time.monotonic()
    if left <= 0 or not is_locally_constant(f, moving, domain, SHARE * left):
        return None
    gaps = _planes(f, moving, domain, borders)
    if gaps is None:
        return None
    points = domain.points(free_symbols(f), VALUES, deadline=deadline)
    first = next(((p, ball) for p in points if (ball := _ball(f, p)) is not None), None)
    if first is None:
        return None
    staying = {s: number for s, number in first[0].items() if s not in moving}
    for point in ({**p, **staying} for p in points):
        if not _in_one_piece(point, first[0], gaps, domain):
            continue
        ball = _ball(f, point)
        with precision(128):
            if ball is not None and not (ball - first[1]).contains(0):
                return _between(first, (point, ball))
    return None


def _planes(f: Expr, moving: Sequence[Symbol], domain: Domain, borders: Sequence[Expr]) -> list[Expr] | None:
    """Return what vanishes where the domain comes to pieces, all of them planes; None where others part it too."""
    cases = [c for c in parts_of(domain.conditions) if isinstance(c, sp.Ne)]
    whole = free_symbols(f) - parting([f])  # parameters keep their values, and variables have their planes
    curved = any(border.diff(x).has(*moving) for border in borders for x in moving)
    if curved or not domain.is_connected(whole) or not all(map(linear, cases)):
        return None
    return [*(cast("Expr", c.lhs) - cast("Expr", c.rhs) for c in cases), *nonzero(f, moving), *borders]


def _in_one_piece(
    point: Mapping[Symbol, sp.Rational],
    other: Mapping[Symbol, sp.Rational],
    gaps: Sequence[Expr],
    domain: Domain,
) -> bool:
    return all(_is_above(g, point) == _is_above(g, other) for g in gaps) and domain.contains(point)


def _ball(f: Expr, point: Mapping[Symbol, sp.Rational]) -> acb | None:
    try:
        with precision(128):
            return value(f, point)
    except (NotDecided, Undefined, Unmodelled):
        return None


def _is_above(gap: Expr, point: Mapping[Symbol, sp.Rational]) -> bool:
    return conditions_hold([cast("Boolean", sp.Gt(gap, 0, evaluate=False))], point)


def nonzero(f: Expr, moving: Sequence[Symbol]) -> list[Symbol]:
    """Return the variables of a function that are not zero but of either sign: its domain comes to pieces there."""
    return [s for s in moving if f.has(s) and s.is_nonzero and not s.is_positive and not s.is_negative]


def _between(
    first: tuple[Mapping[Symbol, sp.Rational], acb], second: tuple[Mapping[Symbol, sp.Rational], acb]
) -> Fault:
    texts = [shown(ball) for _, ball in (first, second)]
    other = ", ".join(f"{s} = {number}" for s, number in second[0].items())
    point = {s.name: str(number) for s, number in first[0].items()}
    here = ", ".join(f"{s} = {number}" for s, number in point.items())
    said = f"jumps: a part of it with all derivatives zero is {texts[0]} at {here} and {texts[1]} at {other}"
    return Fault(point, texts[0], texts[1], said)
