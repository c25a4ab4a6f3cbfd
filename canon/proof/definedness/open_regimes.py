"""Regimes: open parts of a domain on which moduli, maxima and pieces are one formula each."""

from __future__ import annotations

import time
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.proof.definedness.formula_around import NoPiece, holds_around, neighbourhood
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision
from canon.proof.domain.domain import Domain
from canon.proof.domain.relations import linear, parts_of
from canon.proof.refute.refute import landmarks
from canon.proof.rungs.ladder import REFUSALS
from canon.proof.trees.anatomy import Anatomy, anatomy
from canon.proof.trees.replacement import KINKED

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr, Symbol
    from sympy.logic.boolalg import Boolean

__all__ = ["Regime", "regimes"]

MOST = 12
"""Regimes of one question that are looked at."""

POINTS = (6, 60)
"""Points in the box, and at all scales, whose regimes are looked at."""

BITS = 256


@dataclass(frozen=True)
class Regime:
    """An open part of a domain, what holds there besides, and what some expressions are there."""

    formulas: tuple[Expr, ...]
    conditions: tuple[Boolean, ...]
    domain: Domain

    def __str__(self) -> str:
        return ", ".join(map(str, self.conditions))


def regimes(exprs: Sequence[Expr], domain: Domain, deadline: float) -> Iterator[Regime]:
    """Yield regimes of some expressions around points of a domain, those in the box before others.

    What a modulus, a maximum or a condition of a piece turns on is certainly not zero at the point, and every
    inequality of the domain holds strictly there. So all that is said of a regime is true around that point: it is
    open, and not empty. A box is a hint only, and is left out. Equalities of the domain that are not linear may have
    single points; then nothing is yielded.

    Parameters
    ----------
    exprs, domain
        Expressions with pieces, and where they are meant.
    deadline
        Value of :func:`time.monotonic` to stop at.

    Examples
    --------
    >>> x = sp.Symbol("x", real=True)
    >>> [str(r) for r in regimes([abs(x) - x, sp.Max(x, 1)], Domain((x < 3,)), time.monotonic() + 1)]
    ['x > 0, x - 1 < 0', 'x < 0, x - 1 < 0', 'x > 0, x - 1 > 0']
    """
    found = anatomy(exprs)
    equalities = [c for c in parts_of(domain.conditions) if isinstance(c, sp.Eq)]
    if not found.has(*KINKED, sp.Piecewise) or not all(map(linear, equalities)):
        return
    seen: set[frozenset[Boolean]] = set()
    for point in _points(found, domain, deadline):
        if time.monotonic() > deadline or len(seen) == MOST:
            return
        regime = _around(exprs, point, domain)
        if regime is not None and frozenset(regime.conditions) not in seen:
            seen.add(frozenset(regime.conditions))
            yield regime


def _points(found: Anatomy, domain: Domain, deadline: float) -> Iterator[Mapping[Symbol, sp.Rational]]:
    inside, outside = POINTS
    wide = Domain(domain.conditions)
    marks = landmarks(found, domain)
    return chain(
        domain.points(found.symbols, inside, deadline=deadline, but_functions=True),
        wide.points(found.symbols, outside, seed=1, marks=marks, deadline=deadline, but_functions=True),
    )


def _around(exprs: Sequence[Expr], point: Mapping[Symbol, sp.Rational], domain: Domain) -> Regime | None:
    """Return the regime around a point; None at a kink or at an end of the domain, or where that is not known."""
    bounds = [c for c in domain.conditions if not isinstance(c, sp.Eq) and c not in domain.on_functions]
    with precision(BITS):
        try:
            if not all(holds_around(bound, point) for bound in bounds):
                return None
            formulas, signs = neighbourhood(exprs, point)
        except (NoPiece, NotDecided, Undefined, Unmodelled, *REFUSALS):
            return None
    if any(f.has(*KINKED, sp.Piecewise) for f in formulas):
        return None
    said = [sp.Gt(gap, 0) if sign > 0 else sp.Lt(gap, 0) for gap, sign in signs.items()]
    conditions = tuple(cast("Boolean", c) for c in said if c != sp.true)
    if sp.false in conditions:
        return None
    return Regime(tuple(formulas), conditions, Domain((*domain.conditions, *conditions)))
