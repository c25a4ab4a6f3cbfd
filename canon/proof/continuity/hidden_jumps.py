"""Hidden jumps: certified where roots and logarithms of one surface branch to different sides of it.

With log g the boundary value from Im g > 0, log(c gᵐ) for real c ≠ 0 and g is log|c| + m log g + iπ k, where k tells
how often π is to be added for the principal value: it differs where g > 0 and where g < 0. Roots follow as
exponentials.
"""

from __future__ import annotations

import time
from itertools import product
from typing import TYPE_CHECKING, cast

import sympy as sp

from canon.proof.continuity.jumps import continued, jump_between
from canon.proof.trees.anatomy import anatomy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr, Symbol

    from canon.proof.continuity.branching import Branch, OpenSurface
    from canon.proof.continuity.jumps import Jump
    from canon.proof.domain.domain import Domain

__all__ = ["hidden_jump"]

MOST_PARTS = 4

LARGE = 2000
"""Size of a function that is still multiplied out."""


def hidden_jump(
    f: Expr, surface: OpenSurface, moving: Sequence[Symbol], domain: Domain, deadline: float
) -> Jump | None:
    """Return a certified jump at a surface where branches are of different kinds; None where none is found.

    Examples
    --------
    >>> from canon.proof.continuity.branching import open_surfaces
    >>> from canon.proof.domain.domain import Domain
    >>> q = sp.Symbol("q", real=True)
    >>> f = sp.sqrt(q - 1) * sp.sqrt(q + 1) / sp.sqrt(q**2 - 1)
    >>> found = hidden_jump(f, open_surfaces(f, [q], Domain())[0], [q], Domain(), time.monotonic() + 1)
    >>> found is not None and (dict(found.point), found.before, found.after)
    ({'q': '-1'}, '-1', '1')
    """
    known = [b for b in surface.branches if isinstance(b.part, sp.Pow | sp.log)]
    if not known or len(known) > MOST_PARTS or _are_nested(known):
        return None
    for signs in product((1, -1), repeat=len(known)):
        positive = [sign * b.cofactor for b, sign in zip(known, signs, strict=True)]
        if time.monotonic() > deadline or any(c.is_number and not c.is_positive for c in positive):
            continue
        above, below = (_whole(f, known, signs, surface.gap, moving, up=up) for up in (True, False))
        sides = (above, below)
        jump = (
            jump_between(sides, surface.gap, moving, domain, deadline, positive) if above != below else None
        )
        if jump is not None:
            return jump
    return None


def _whole(
    f: Expr,
    branches: Sequence[Branch],
    signs: Sequence[int],
    gap: Expr,
    moving: Sequence[Symbol],
    *,
    up: bool,
) -> Expr:
    """Return what a function is on one side of a surface where the cofactors of its branches have some signs."""
    by = {b.part: _side(b, sign, up=up) for b, sign in zip(branches, signs, strict=True)}
    side = cast("Expr", f.xreplace(cast("dict[sp.Basic, Expr]", by)))
    side = sp.expand_mul(side) if anatomy([side]).tree <= LARGE else side  # so that log g cancels
    return continued(side, gap, moving, up=up)


def _are_nested(branches: Sequence[Branch]) -> bool:
    return any(a.part != b.part and a.part.has(b.part) for a in branches for b in branches)


def _side(branch: Branch, sign: int, *, up: bool) -> Expr:
    """Return a root or logarithm of cofactor · gap**count, the cofactor having a sign, on one side of the gap."""
    m, g, size = branch.count, branch.gap, sign * branch.cofactor
    negative = (sign < 0) if up or m % 2 == 0 else (sign > 0)
    turns = sp.Integer(int(negative) - (0 if up else m))
    if isinstance(branch.part, sp.log):
        return sp.log(size) + m * sp.log(g) + sp.I * sp.pi * turns
    r = cast("Expr", branch.part.args[1])
    return size**r * g ** (m * r) * sp.exp(sp.I * sp.pi * turns * r)
