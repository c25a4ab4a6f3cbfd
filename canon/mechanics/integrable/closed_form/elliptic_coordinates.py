"""Actions in elliptic coordinates, as of motion about two fixed centres, by Legendre's three complete integrals.

With x = cosh u or cos v the momentum is √(A + B x + C x²), and ∫ p dq is one of xᵏ/√P₄ between neighbouring roots of a
quartic with the roots ±1 and those of A + B x + C x² (P. F. Byrd, M. D. Friedman, Handbook of Elliptic Integrals, 254,
256, 336.02; for the motion C. L. Charlier, Die Mechanik des Himmels I, section 3).
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, cast

import sympy as sp
from sympy import Expr, Symbol, sqrt

from canon.mechanics.integrable.cycles import CycleKind, ball_of
from canon.proof.domain.balls import value

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from flint import arb

    from canon.mechanics.integrable.cycles import Cycle

__all__ = ["action_in_elliptic_coordinates", "sides_of_roots"]

NEAR = 1e-9
"""How near to 1 or −1 the end of a range of x is taken for the root there."""


def action_in_elliptic_coordinates(
    A: Expr, terms: Mapping[Expr, Expr], q: Symbol, cycle: Cycle, values: Mapping[Symbol, Expr]
) -> Expr | None:
    """Return (1/2π) ∮ √(A + B x + C x²) dq for x = cos q or cosh q, or None for another p².

    The order of the roots is that of the motion with the given values; where two of them are complex there is no such
    formula.
    """
    for x in (sp.cos(q), sp.cosh(q)):
        if x**2 in terms and set(terms) <= {x, x**2}:
            break
    else:
        return None
    B, C = terms.get(x, sp.S.Zero), terms[x**2]
    ends = _range(x, q, cycle)
    placed = _in_order(_roots(A, B, C), values)
    if ends is None or placed is None:
        return None
    low, high, times = ends
    middle = (low + high) / 2
    above = sum(place > middle for place, _ in placed)
    if not 0 < above < len(placed):
        return None
    moments = _moments([root for _, root in placed], above)
    total = sp.Add(*(c * moment for c, moment in zip((A, B, C), moments, strict=True)))
    return cycle.sign * times * total / (sp.pi * sqrt(sp.Abs(C)))


def sides_of_roots(
    A: Expr, terms: Mapping[Expr, Expr], q: Symbol, values: Mapping[Symbol, Expr]
) -> tuple[Expr, ...]:
    """Return what is positive as long as the four roots are real and keep the order that they have at given values."""
    x = next(x for x in (sp.cos(q), sp.cosh(q)) if x**2 in terms)
    B, C = terms.get(x, sp.S.Zero), terms[x**2]
    placed = [root for _, root in _in_order(_roots(A, B, C), values) or ()]
    return (B**2 - 4 * A * C, *(a - b for a, b in pairwise(placed)))


def _roots(A: Expr, B: Expr, C: Expr) -> list[Expr]:
    R = sqrt(B**2 - 4 * A * C)
    return [sp.S.One, sp.S.NegativeOne, (-B + R) / (2 * C), (-B - R) / (2 * C)]


def _range(x: Expr, q: Symbol, cycle: Cycle) -> tuple[float, float, int] | None:
    """Return between which values x moves, and how often it does in half a cycle."""
    if cycle.kind is CycleKind.ROTATION:
        return (-1.0, 1.0, 1) if isinstance(x, sp.cos) and cycle.period == 2 * sp.pi else None
    low, high = (float(end) for end in cast("tuple[arb, arb]", cycle.turning_points))
    first, last = (float(x.subs(q, end)) for end in (low, high))
    if abs(first - last) > NEAR:  # x falls or grows all the way
        return min(first, last), max(first, last), 1
    fold = float(x.subs(q, (low + high) / 2))
    return min(first, fold), max(first, fold), 2


def _in_order(roots: Sequence[Expr], values: Mapping[Symbol, Expr]) -> list[tuple[float, Expr]] | None:
    """Return real roots with their values, the largest first."""
    placed: list[tuple[float, Expr]] = []
    for root in roots:
        ball = value(root, {}, {s: ball_of(number) for s, number in values.items()})
        if not ball.is_finite() or not ball.imag.contains(0):
            return None
        placed.append((float(ball.real.mid()), root))
    return sorted(placed, key=lambda each: -each[0])


def _moments(roots: Sequence[Expr], above: int) -> tuple[Expr, Expr, Expr]:
    """Return ∫ xᵏ dx/√|P₄|, k = 0, 1, 2, over the interval that has so many of the roots a > b > c > d above it."""
    if above == 3:
        zeroth, first, second = _moments([-root for root in reversed(roots)], 1)
        return zeroth, -first, second
    a, b, c, d = roots
    g = 2 / sqrt((a - c) * (b - d))
    if above == 1:  # between b and a, with x = (b − c α² sn²)/(1 − α² sn²)
        m, n, pole, start = (a - b) * (c - d) / ((a - c) * (b - d)), (a - b) / (a - c), c, b
    else:  # between c and b, with x = (c − d α² sn²)/(1 − α² sn²)
        m, n, pole, start = (b - c) * (a - d) / ((a - c) * (b - d)), (b - c) / (b - d), d, c
    K, E, Pi = sp.elliptic_k(m), sp.elliptic_e(m), sp.elliptic_pi(n, m)
    V = (n * E + (m - n) * K + (2 * n * m + 2 * n - n**2 - 3 * m) * Pi) / (2 * (n - 1) * (m - n))
    step = start - pole
    return g * K, g * (pole * K + step * Pi), g * (pole**2 * K + 2 * pole * step * Pi + step**2 * V)
