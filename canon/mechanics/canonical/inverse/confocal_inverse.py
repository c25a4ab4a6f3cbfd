"""Inverses of confocal coordinates: x = c cosh u cos v, y = c sinh u sin v, with foci at (±c, 0), by both distances.

With r₊ and r₋ the distances from (−c, 0) and (c, 0), c cosh u = (r₊ + r₋)/2 and c cos v = (r₊ − r₋)/2. Turned about the
axis of the foci they are prolate coordinates, about the other axis oblate ones. (P. M. Morse and H. Feshbach, Methods
of Theoretical Physics, section 5.1.)

What is found here is a suggestion of one branch; :mod:`inverse_transformation` proves it both ways.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from typing import TYPE_CHECKING, Any

import sympy as sp
from sympy import Expr, Symbol, atan2, cos, cosh, pi, sin, sinh, sqrt

from canon.mechanics.canonical.inverse.inverse_branch import AngleFromArc, AreaFromCosine, BranchOfInverse

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from canon.mechanics.algebra.branch_point import BranchPoint

__all__ = ["confocal_branch"]


def confocal_branch(
    q: Sequence[Symbol], places: Mapping[Symbol, Expr], witness: BranchPoint
) -> BranchOfInverse | None:
    """Return the old coordinates on the branch that the witness shows; None where they are no confocal ones.

    Parameters
    ----------
    q
        The old coordinates, two of them or three.
    places
        The new coordinates as expressions in the old ones.
    witness
        A point of the domain, which tells the branch.

    Examples
    --------
    >>> from canon.mechanics.algebra.branch_point import BranchPoint
    >>> u = sp.Symbol("u", positive=True)
    >>> v, x, y = sp.symbols("v x y", real=True)
    >>> places = {x: cosh(u)*cos(v), y: sinh(u)*sin(v)}
    >>> branch = confocal_branch([u, v], places, BranchPoint({u: sp.Integer(1), v: sp.Integer(1)}, places))
    >>> branch.values[u]
    acosh(sqrt(y**2 + (x - 1)**2)/2 + sqrt(y**2 + (x + 1)**2)/2)
    """
    for u, v, *others in permutations(q) if len(q) > 1 else ():
        for axes in _axes(places, others, witness):
            branch = _by_distances(u, v, axes, witness)
            if branch is not None:
                return branch
    return None


@dataclass(frozen=True)
class _Axes:
    """Two places of a half plane, in the old coordinates and in the new ones, and the angle that turns it."""

    old: tuple[Expr, Expr]
    new: tuple[Expr, Expr]
    turned: Mapping[Symbol, AngleFromArc]
    positive: tuple[Expr, ...] = ()


def _axes(places: Mapping[Symbol, Expr], others: Sequence[Symbol], witness: BranchPoint) -> Iterator[_Axes]:
    """Yield both orders of the two places in a plane; in space the place on an axis and the distance from it."""
    for order in permutations(places):
        if not others and len(order) == 2:
            yield _Axes((places[order[0]], places[order[1]]), order, {})
        elif len(others) == 1 and len(order) == 3:
            x, y, z = order
            (phi,) = others
            rho = places[x] / cos(phi)
            if rho.has(phi) or places[z].has(phi) or places[y] != rho * sin(phi):
                continue
            if (witness.number(rho) or 0.0) <= 0:
                continue
            distance = sqrt(x**2 + y**2)
            angle = _angle(phi, y / distance, x / distance, witness)
            if angle is not None:
                yield _Axes((rho, places[z]), (distance, z), {phi: angle}, (x**2 + y**2,))
                yield _Axes((places[z], rho), (z, distance), {phi: angle}, (x**2 + y**2,))


def _by_distances(u: Symbol, v: Symbol, axes: _Axes, witness: BranchPoint) -> BranchOfInverse | None:
    """Return the branch where the places are c cosh u cos v and c sinh u sin v, or with sin v and cos v exchanged."""
    for along, across in ((cos, sin), (sin, cos)):
        c, d = axes.old[0] / (cosh(u) * along(v)), axes.old[1] / (sinh(u) * across(v))
        if c != d or c.has(u, v) or not c.is_positive:
            continue
        x, y = axes.new
        far, near = sqrt((x + c) ** 2 + y**2), sqrt((x - c) ** 2 + y**2)
        sign = 1 if (witness.number(u) or 0.0) > 0 else -1
        cosine = (far + near) / (2 * c)
        area = AreaFromCosine(sign * sqrt(cosine**2 - 1), cosine, sign)
        parts: dict[Any, Expr] = {along: (far - near) / (2 * c), across: y / (c * area.sine)}
        angle = _angle(v, parts[sin], parts[cos], witness)
        if angle is None:
            return None
        angles = {v: angle, **axes.turned}
        ranges = tuple(sp.Gt(f, 0) for f in (*axes.positive, far + near - 2 * c))
        values = {u: area.value, **{z: found.value for z, found in angles.items()}}
        return BranchOfInverse(values, ranges, angles, areas={u: area})
    return None


def _angle(z: Symbol, sine: Expr, cosine: Expr, witness: BranchPoint) -> AngleFromArc | None:
    turns = witness.number((z - atan2(sine, cosine)) / (2 * pi))
    return None if turns is None else AngleFromArc(sine, cosine, round(turns))
