"""Feasible points of domains so thin that no point drawn at random lies in them."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.trees.anatomy import anatomy
from canon.proof.trees.sympy_types import free_symbols, rational

if TYPE_CHECKING:
    import random
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr, Symbol
    from sympy.logic.boolalg import Boolean

__all__ = ["moved_inside"]

STEPS = 16
MARGINS = (1.0, 0.1)
"""How far beyond a boundary a point is put at first."""

SHRINKAGE = 0.4
"""Factor of the margin from step to step: a thin domain needs a small one."""

BITS = 64
LARGEST = 1e9
LARGEST_TREE = 400
"""Size of conditions together beyond which steps cost too much."""


def moved_inside(
    point: Mapping[Symbol, sp.Rational],
    conditions: Sequence[Boolean],
    chance: random.Random,
    deadline: float = math.inf,
) -> dict[Symbol, sp.Rational] | None:
    """Move a point across the boundaries it is on the wrong side of, one after the other.

    Each step goes along the gradient of the most violated inequality as far as its linear approximation asks
    (Agmon, Motzkin and Schoenberg's relaxation, doi:10.4153/CJM-1954-037-2), which converges for half spaces.
    The caller has to verify that the conditions hold where the point is put.

    Examples
    --------
    >>> import random
    >>> from sympy import Rational, symbols
    >>> x = symbols("x", real=True)
    >>> moved = moved_inside({x: Rational(1, 2)}, (abs(x - 70) < Rational(1, 10),), random.Random(1))
    >>> abs(moved[x] - 70) < Rational(1, 10)
    True
    """
    gaps = list(_gaps(point, conditions))
    if not gaps or anatomy(gaps).tree > LARGEST_TREE:
        return None
    here = {s: float(number) for s, number in point.items()}
    margin = chance.choice(MARGINS)
    for _ in range(STEPS):
        margin *= SHRINKAGE
        if time.monotonic() > deadline:
            return None
        at = _as_rationals(here, margin)
        found = _most_violated(gaps, at)
        if found is None:
            return None
        worst, gap = found
        if worst > 0:
            return at
        slopes = _gradient(gap, at)
        square = math.fsum(slope * slope for slope in slopes.values())  # infinite where a power would raise
        if not 0 < square < LARGEST**2:
            return None
        for s, slope in slopes.items():
            here[s] += slope * (margin * chance.uniform(0.2, 1) - worst) / square
        if any(not abs(number) < LARGEST for number in here.values()):
            return None
    return None


def _most_violated(gaps: Sequence[Expr], at: Mapping[Symbol, sp.Rational]) -> tuple[float, Expr] | None:
    """Return the least of some functions and its value; None where one of them has no value."""
    values = [_float(gap, at) for gap in gaps]
    if None in values:
        return None
    return min(zip(cast("list[float]", values), gaps, strict=True), key=lambda pair: pair[0])


def _gradient(gap: Expr, at: Mapping[Symbol, sp.Rational]) -> dict[Symbol, float]:
    """Return the slopes in the directions in which a point can be moved; none where one has no value."""
    slopes = {s: _float(gap.diff(s), at) for s in free_symbols(gap) if s in at and not s.is_integer}
    return {} if None in slopes.values() else cast("dict[Symbol, float]", slopes)


def _gaps(point: Mapping[Symbol, sp.Rational], conditions: Sequence[Boolean]) -> Iterator[Expr]:
    """Yield what should be positive: of each inequality, and of each symbol of one sign."""
    for condition in conditions:
        if isinstance(condition, sp.Lt | sp.Le | sp.Gt | sp.Ge):
            yield cast("Expr", condition.gts) - cast("Expr", condition.lts)
    for s in point:
        if s.is_positive:
            yield s
        elif s.is_negative:
            yield -s


def _as_rationals(here: Mapping[Symbol, float], margin: float) -> dict[Symbol, sp.Rational]:
    """Return the place in rationals, no finer than what the margin needs."""
    finest = math.ceil(16 / margin)
    return {s: rational(sp.Rational(round(number * finest), finest)) for s, number in here.items()}


def _float(f: Expr, at: Mapping[Symbol, sp.Rational]) -> float | None:
    try:
        with precision(BITS):
            ball = value(f, at)
    except (NotDecided, Undefined, Unmodelled):
        return None
    number = float(ball.real.mid())
    return number if ball.imag.contains(0) and math.isfinite(number) else None
