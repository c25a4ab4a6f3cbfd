"""Inverses of point transformations: the coordinates alone are solved for, the momenta follow from them.

Of a canonical map with Q = Q(q, t) the momenta are P = (∂Q/∂q)⁻ᵀ p + b(q, t), so that p = (∂Q/∂q)ᵀ (P − b): nothing
but the coordinates needs solving. (H. Goldstein, C. Poole, J. Safko, Classical Mechanics, 3rd ed., section 9.1.)

What is found here is a suggestion of one branch; :mod:`inverse_transformation` proves it both ways.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

from canon.mechanics.algebra.solve_on_branch import Inversion, solve_system
from canon.mechanics.algebra.substitution import shortened
from canon.mechanics.canonical.inverse.confocal_inverse import confocal_branch
from canon.mechanics.canonical.inverse.inverse_branch import BranchOfInverse, positive_radicands
from canon.mechanics.canonical.inverse.polar_inverse import polar_branch

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.mechanics.algebra.branch_point import BranchPoint

__all__ = ["point_branch"]


def point_branch(
    q: Sequence[Symbol],
    p: Sequence[Symbol],
    meaning: Mapping[Symbol, Expr],
    witness: BranchPoint,
    deadline: float,
) -> BranchOfInverse | None:
    """Return the branch of the inverse that the witness shows; None where the map is not of coordinates alone.

    Parameters
    ----------
    q, p
        The old variables.
    meaning
        The new coordinates and then the new momenta, as expressions in the old variables.
    witness
        A point of the domain, which tells the branch.
    deadline
        When to give up, on the monotonic clock; a step that is under way is finished.

    Examples
    --------
    >>> from math import inf
    >>> from sympy import cos, sin, symbols
    >>> from canon.mechanics.algebra.branch_point import BranchPoint
    >>> r = symbols("r", positive=True)
    >>> φ, p_r, p_φ, x, y, p_x, p_y = symbols("φ p_r p_φ x y p_x p_y", real=True)
    >>> meaning = {x: r*cos(φ), y: r*sin(φ),
    ...            p_x: p_r*cos(φ) - p_φ*sin(φ)/r, p_y: p_r*sin(φ) + p_φ*cos(φ)/r}
    >>> point = {r: sp.Integer(2), φ: sp.Rational(1, 3), p_r: sp.Integer(1), p_φ: sp.Integer(1)}
    >>> branch = point_branch([r, φ], [p_r, p_φ], meaning, BranchPoint(point, meaning), inf)
    >>> branch.values[φ], branch.values[p_φ]
    (atan2(y, x), -p_x*y + p_y*x)
    """
    new = list(meaning)
    new_q, new_p = new[: len(q)], new[len(q) :]
    places = {Q: meaning[Q] for Q in new_q}
    if any(place.has(*p) for place in places.values()):
        return None
    branch = confocal_branch(q, places, witness) or polar_branch(q, places, witness, deadline)
    if branch is None:
        inversion = Inversion(witness, deadline=deadline)
        solved = solve_system([(place, Q) for Q, place in places.items()], q, inversion)
        if solved is None:
            return None
        values = {z: shortened(value) for z, value in solved.items()}
        branch = BranchOfInverse(values, tuple(positive_radicands(values.values())), {})
    at_rest = dict.fromkeys(p, sp.S.Zero)
    shares = [P - meaning[P].xreplace(at_rest) for P in new_p]
    momenta = {
        old: _in_short(
            branch, sp.Add(*(places[Q].diff(z) * share for Q, share in zip(new_q, shares, strict=True)))
        )
        for z, old in zip(q, p, strict=True)
    }
    return replace(branch, values={**branch.values, **momenta})


def _in_short(branch: BranchOfInverse, f: Expr) -> Expr:
    return shortened(branch.at(f))
