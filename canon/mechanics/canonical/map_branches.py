"""Implicit maps with several solutions: the one that is meant is the map near the identity.

Where the equations hold at Z = z with the step put to zero, and determine Z there, they have one solution near it: an
analytic family that starts with the identity. A branch of all solutions that does not contain Z = z then has no part
of that family.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp

from canon.mechanics.algebra.linear import eliminate, is_regular
from canon.mechanics.algebra.substitution import substitute, symbols_of
from canon.proof.domain.domain import Domain
from canon.proof.domain.verdict import Undecided
from canon.proof.kinks import vanishes_off_kinks

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from sympy import Expr, Symbol

    from canon.mechanics.algebra.constraint_manifold import Branch

__all__ = ["near_the_identity", "over_the_old"]

SECONDS = 1.0
"""Time for the question whether the identity satisfies an equation."""


def over_the_old(branches: Sequence[Branch], old: Sequence[Symbol], new: Sequence[Symbol]) -> list[Branch]:
    """Return the branches over an open part of the old variables, or all of them where there is none such.

    Q³ = q³, P Q² = p q² hold at q = Q = 0 for any p and P: that defines no map.

    Examples
    --------
    >>> from canon.mechanics.algebra.constraint_manifold import on_manifold
    >>> q, p, Q, P = sp.symbols("q p Q P", real=True)
    >>> branches = on_manifold([Q**2 - q**2, P * Q - p * q], Domain(), prefer=(Q, P, q, p))
    >>> [len(branches), len(over_the_old(branches, (q, p), (Q, P)))]
    [4, 2]
    """
    return [b for b in branches if not _binds_the_old(b, old, new)] or list(branches)


def _binds_the_old(branch: Branch, old: Sequence[Symbol], new: Sequence[Symbol]) -> bool:
    free = [s for s in (*old, *new) if s not in branch.values]
    slopes = [[substitute(z, branch.values).diff(s) for s in free] for z in old]
    try:
        return eliminate(sp.Matrix(slopes), domain=branch.domain).rank < len(old)
    except Undecided:
        return False


def near_the_identity(
    equations: Sequence[Expr],
    branches: Sequence[Branch],
    old: Sequence[Symbol],
    new: Sequence[Symbol],
    domain: Domain,
) -> list[Branch] | None:
    """Return the branches that may have a part of the map near the identity; None where no such map was found.

    Steps are the parameters with a range in the ``box`` of a claim.

    Parameters
    ----------
    equations, branches
        The equations, and their solutions.
    old, new
        The old variables, and in the same order the new ones.
    domain
        Where the map is meant.

    Examples
    --------
    >>> from canon.mechanics.algebra.constraint_manifold import on_manifold
    >>> q, p, Q, P, h = sp.symbols("q p Q P h", real=True)
    >>> equations, domain = [Q - q - h * P, P**2 - p**2], Domain((), {h: (0, 1)})
    >>> branches = on_manifold(equations, domain, prefer=(Q, P, q, p))
    >>> near = near_the_identity(equations, branches, (q, p), (Q, P), domain)
    >>> [len(branches), len(near)]
    [2, 1]
    """
    for at_rest in _rests(old, new, domain):
        about = Domain(tuple(c for c in domain.conditions if not c.has(*at_rest)))
        here = [substitute(g, at_rest) for g in equations]
        slopes = sp.Matrix([[substitute(g.diff(z), at_rest) for z in new] for g in equations])
        if all(_vanishes(g, about) for g in here) and is_regular(slopes, about).holds:
            return [b for b in branches if not _is_elsewhere(b, at_rest, about)]
    return None


def _rests(old: Sequence[Symbol], new: Sequence[Symbol], domain: Domain) -> Iterator[Mapping[Symbol, Expr]]:
    """Yield the identity, and the identity with a step that is zero."""
    identity: dict[Symbol, Expr] = dict(zip(new, old, strict=True))
    yield identity
    for step in domain.box:
        if step not in (*old, *new):
            yield identity | {step: sp.S.Zero}


def _vanishes(f: Expr, domain: Domain) -> bool:
    return not _has_no_value(f) and vanishes_off_kinks(f, domain, SECONDS).holds


def _is_elsewhere(branch: Branch, at_rest: Mapping[Symbol, Expr], domain: Domain) -> bool:
    """Tell whether a branch certainly has no generic point at which the new variables are the old ones."""
    for symbol, value in branch.values.items():
        gap = substitute(sp.numer(sp.together(symbol - value)), at_rest)
        counted = any(
            s.is_integer for s in symbols_of(gap)
        )  # of arcs on other sheets one may be the identity
        if not counted and not _has_no_value(gap) and is_regular(sp.Matrix([[gap]]), domain).holds:
            return True
    return False


def _has_no_value(f: Expr) -> bool:
    return f.has(sp.nan, sp.zoo, sp.oo, -sp.oo)
