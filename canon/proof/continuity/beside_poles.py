"""Both sides of a surface on which a function is written with denominators that vanish: infinite, or of one value."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.proof.trees.anatomy import anatomy
from canon.proof.vanish import vanishes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr, Symbol

    from canon.proof.domain.domain import Domain

__all__ = ["meet_beside_poles"]

LARGE = 400
"""Size of an expression that is still written over one denominator."""


def meet_beside_poles(
    above: Expr, below: Expr, gap: Expr, moving: Sequence[Symbol], there: Domain, budget: float
) -> bool:
    """Tell whether continuations from two sides of a surface are proved to be infinite there, or to be equal.

    Written over one denominator a side is infinite where that vanishes and the numerator does not. Where both vanish,
    as in t/(exp |t| − 1), the limits may differ, and nothing is proved. Powers of one distance v from the surface are
    put together first: t/|t|^(4/3) is −v^(−1/3) below t = 0.

    Parameters
    ----------
    above, below
        The continuations, where the gap is positive and where it is negative.
    gap
        What vanishes on the surface.
    moving
        What may vary.
    there
        The domain on the surface.
    budget
        Seconds.

    Examples
    --------
    >>> from canon.proof.domain.domain import Domain
    >>> t = sp.Symbol("t", real=True)
    >>> there = Domain((sp.Eq(t, 0),))
    >>> power = sp.Rational(-4, 3)
    >>> meet_beside_poles(t * t**power, t * (-t) ** power, t, [t], there, 1.0)
    True
    >>> meet_beside_poles(t / (sp.exp(t) - 1), t / (sp.exp(-t) - 1), t, [t], there, 1.0)
    False
    """
    if anatomy([above, below]).tree > LARGE:
        return False
    sides = (_at_distance(above, gap, moving, 1), _at_distance(below, gap, moving, -1))
    parts = [sp.fraction(sp.together(side)) for side in sides]
    found = [_is_infinite(n, d, there, budget / 8) for n, d in parts]
    if None in found or found[0] != found[1]:
        return False
    return bool(found[0]) or vanishes(sides[0] - sides[1], there, budget / 2).holds


def _is_infinite(n: Expr, d: Expr, there: Domain, budget: float) -> bool | None:
    """Tell whether a quotient is infinite on a surface; None where that is not known, as at 0/0."""
    below = vanishes(d, there, budget)
    if below.fails:
        return False if below.certificate == "ball" else None
    above = vanishes(n, there, budget) if below.holds else below
    return True if above.fails and above.certificate == "ball" else None


def _at_distance(side: Expr, gap: Expr, moving: Sequence[Symbol], sign: int) -> Expr:
    """Return a side with the powers of the distance from the surface put together, where the gap is linear."""
    for s in moving:
        slope = cast("Expr", gap.diff(s))
        if slope.is_number and slope.is_nonzero:
            v, rest = sp.Dummy("v", positive=True), sp.expand(gap - slope * s)
            put_together = cast("Expr", side.xreplace({s: (sign * v - rest) / slope}))
            return cast("Expr", put_together.xreplace({v: sign * gap}))
    return side
