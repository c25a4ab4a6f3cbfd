"""Answers that are right only to some order in something small: the angles of small oscillations, 1/c, a step.

The order is read off from the values of the residual at ε and ε/2, and proved by its derivatives at ε = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol

from canon.exercise.diagnose.change import Mistake
from canon.exercise.diagnose.diagnosis import Diagnosis
from canon.exercise.diagnose.effort import proved_to_vanish
from canon.expression.symbols.symbol import Coordinate, Rate
from canon.mechanics.algebra.substitution import substitute, symbols_of
from canon.proof.continuity.smooth import PIECED
from canon.proof.domain.balls import NotDecided, Undefined, Unmodelled, precision, value
from canon.proof.domain.domain import Domain

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from canon.exercise.diagnose.diagnosis import WrongAnswer
    from canon.exercise.diagnose.effort import Effort
    from canon.exercise.question.question import Part

__all__ = ["right_to_an_order"]

BITS = 512
POINTS = 2
MOST_ORDERS = 4
LIMIT_STEPS = 1_000
"""Steps for one thing that may be small."""
MOST_OPERATIONS = 400
_KINKED = (*PIECED, sp.atan2)


@dataclass(frozen=True)
class _Limit:
    """A way to make something small: what is put in for the symbols, and its name."""

    values: Mapping[Symbol, Expr]
    name: str


def right_to_an_order(wrong: WrongAnswer) -> Iterator[Diagnosis]:
    """Yield in what, and to which order, all components are right, once that is proved."""
    residuals = [(part.residual, _of_first_order(part)) for part in wrong.parts]
    residuals = [(r, c) for r, c in residuals if r != 0]
    if any(r.has(*_KINKED) or sp.count_ops(r) > MOST_OPERATIONS for r, _ in residuals):
        return
    epsilon = sp.Dummy("epsilon", positive=True)
    for limit in _limits([r for r, _ in residuals], epsilon):
        if not wrong.effort.spend(LIMIT_STEPS):
            return
        order = _order_in(wrong, residuals, limit, epsilon)
        if order is not None:
            yield Diagnosis.stated(Mistake.ONLY_SMALL, limit.name, order - 1)


def _order_in(
    wrong: WrongAnswer, residuals: Sequence[tuple[Expr, Expr]], limit: _Limit, epsilon: Symbol
) -> int | None:
    """Return the order of smallness of all residuals, at least 2, where that is proved and the answer ends there."""
    scaled = [(substitute(r, limit.values), substitute(c, limit.values)) for r, c in residuals]
    orders = [_order(r, c, epsilon, wrong.domain) for r, c in scaled]
    order = min((0 if k is None else k for k in orders), default=0)
    if not 2 <= order <= MOST_ORDERS:
        return None
    if not all(_is_truncated(_in_variables(part), tuple(limit.values), order) for part in wrong.parts):
        return None
    proved = all(
        _vanishes_to(r, epsilon, order, _without(wrong.domain, limit), wrong.effort) for r, _ in scaled
    )
    return order if proved else None


def _of_first_order(part: Part) -> Expr:
    """Return with what a residual is compared: the right value, or what an equation equates to accelerations."""
    if part.right != 0:
        return part.right
    return substitute(part.claimed, dict.fromkeys(part.determined, sp.S.Zero))


def _limits(residuals: Sequence[Expr], epsilon: Symbol) -> Iterator[_Limit]:
    found = symbols_of(*residuals)
    moving = [s for s in found if isinstance(s, Coordinate | Rate)]
    for s in found:
        if s not in moving:
            yield _Limit({s: epsilon}, f"{s}")
            yield _Limit({s: 1 / epsilon}, f"1/{s}")
    for s in moving:
        yield _Limit({s: epsilon * s}, f"{s}")
    if len(moving) > 1:
        names = ", ".join(map(str, moving))
        yield _Limit({s: epsilon * s for s in moving}, f"{names} together")


def _in_variables(part: Part) -> Expr:
    """Return what was claimed with the momenta as functions of the velocities: they become small with these."""
    return substitute(part.claimed, {s: v for s, v in part.through.items() if s not in part.determined})


def _is_truncated(claimed: Expr, small: Sequence[Symbol], order: int) -> bool:
    """Whether what was claimed is a polynomial of the order to which it is right, as one who truncates writes it."""
    here = [s for s in small if claimed.has(s)]
    if not here:
        return True
    poly = claimed.as_poly(*here)
    return poly is not None and poly.total_degree() < order


def _without(domain: Domain, limit: _Limit) -> Domain:
    """Return the domain without what was said of what is small."""
    return Domain(tuple(c for c in domain.conditions if not c.has(*limit.values)), domain.box)


def _order(residual: Expr, claimed: Expr, epsilon: Symbol, domain: Domain) -> int | None:
    """Return the order of a residual in ε where it is beyond that of the claimed side, as far as values tell."""
    symbols = [s for s in symbols_of(residual, claimed) if s != epsilon]
    orders: set[int | None] = set()
    for point in domain.points(symbols, POINTS, seed=5):
        own, other = (_order_at(f, epsilon, point) for f in (residual, claimed))
        orders.add(own if own is not None and (other is None or own > other) else None)
    return orders.pop() if len(orders) == 1 else None


def _order_at(f: Expr, epsilon: Symbol, point: Mapping[Symbol, sp.Rational]) -> int | None:
    try:
        with precision(BITS):
            at = [value(f, {**point, epsilon: _halved(k)}) for k in (60, 61)]
            if any(z.contains(0) for z in at):
                return None
            ratio = float(abs(at[0] / at[1]).log().mid()) / math.log(2)
    except (Undefined, NotDecided, Unmodelled):
        return None
    order = round(ratio)
    return order if abs(ratio - order) < 1e-6 else None


def _halved(times: int) -> sp.Rational:
    return cast("sp.Rational", sp.Rational(1, 2**times))


def _vanishes_to(f: Expr, epsilon: Symbol, order: int, domain: Domain, effort: Effort) -> bool:
    """Whether the first coefficients of a function analytic at ε = 0 are proved to vanish."""
    for k in range(order):
        coefficient = f.diff(epsilon, k).subs(epsilon, 0)
        if coefficient.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
            return False
        if coefficient != 0 and not proved_to_vanish(coefficient, domain, effort):
            return False
    return True
