"""Ignorable coordinates and Routh's function.

A coordinate is ignorable where L holds its velocity but not itself; its momentum is constant. Routh's function
R = L − Σ p q̇ over the ignorable coordinates, with their velocities eliminated for the constant momenta, is a
Lagrangian of the other coordinates (E. J. Routh; H. Goldstein, Classical Mechanics, § 8.3).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from canon.expression.symbol import momentum, velocity
from canon.mechanics.claim import all_vanish
from canon.mechanics.lagrangian import Lagrangian
from canon.mechanics.legendre import eliminate_velocities
from canon.proof.domain import Domain

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr, Symbol

    from canon.proof.verdict import Verdict

__all__ = ["Routhian", "ignorable_coordinates", "is_ignorable", "routhian"]


@dataclass(frozen=True)
class Routhian:
    """Routh's function of a system with ignorable coordinates.

    Parameters
    ----------
    R
        L − Σ p q̇ over the ignorable coordinates, their velocities eliminated.
    q
        The coordinates that remain.
    cyclic, momenta
        The ignorable coordinates and their constant momenta.
    t
        The time.
    """

    R: Expr
    q: tuple[Symbol, ...]
    cyclic: tuple[Symbol, ...]
    momenta: tuple[Symbol, ...]
    t: Symbol

    @cached_property
    def lagrangian(self) -> Lagrangian:
        """R as the Lagrangian of the remaining coordinates, at constant momenta."""
        return Lagrangian(self.R, self.q, self.t)

    @cached_property
    def cyclic_velocities(self) -> tuple[Expr, ...]:
        """The velocities of the ignorable coordinates, q̇ = −∂R/∂p; their integral over time is q."""
        return tuple(-self.R.diff(p) for p in self.momenta)


def ignorable_coordinates(lagrangian: Lagrangian) -> tuple[Symbol, ...]:
    """Return the coordinates that certainly do not enter L, nor have a generalized force.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates
    >>> r, phi = coordinates("r phi")
    >>> ignorable_coordinates(Lagrangian(r.dot**2 + r**2*phi.dot**2 - 1/r, [r, phi]))
    (phi,)
    """
    return tuple(s for s in lagrangian.q if is_ignorable(lagrangian, s).holds)


def is_ignorable(lagrangian: Lagrangian, coordinate: Symbol, domain: Domain | None = None) -> Verdict:
    """Tell whether ∂L/∂q = 0 and no generalized force acts along q."""
    forces = dict(zip(lagrangian.q, lagrangian.forces, strict=False))
    claims = [(f"∂L/∂{coordinate} = 0", lagrangian.L.diff(coordinate))]
    if coordinate in forces:
        claims.append((f"no force acts along {coordinate}", forces[coordinate]))
    return all_vanish(claims, f"{coordinate} is ignorable", domain)


def routhian(
    lagrangian: Lagrangian,
    cyclic: Sequence[Symbol] | None = None,
    momenta: Sequence[Symbol] | None = None,
    domain: Domain | None = None,
) -> Routhian:
    """Return Routh's function with the velocities of the ignorable coordinates eliminated.

    Parameters
    ----------
    lagrangian
        A Lagrangian without non-potential forces on the ignorable coordinates.
    cyclic
        The coordinates to ignore; all ignorable ones unless given. With none, R = L.
    momenta
        Symbols for their constant momenta; ``q.momentum`` unless given.
    domain
        Where L is meant.

    Raises
    ------
    ValueError
        Where a coordinate is not known to be ignorable.
    LegendreError
        Where the velocities cannot be eliminated.

    Examples
    --------
    >>> from canon import Lagrangian, coordinates, parameters
    >>> r, phi = coordinates("r phi")
    >>> (m,) = parameters("m", positive=True)
    >>> routhian(Lagrangian(m*(r.dot**2 + r**2*phi.dot**2)/2, [r, phi])).R
    m*r_dot**2/2 - p_phi**2/(2*m*r**2)
    """
    ignored = tuple(cyclic) if cyclic is not None else ignorable_coordinates(lagrangian)
    for s in ignored:
        verdict = is_ignorable(lagrangian, s, domain)
        if not verdict.holds:
            raise ValueError(
                f"{s} is not ignorable: {verdict.feedback or verdict.status.name}; leave it out of cyclic"
            )
    p = tuple(momenta) if momenta is not None else tuple(momentum(s) for s in ignored)
    if len(p) != len(ignored):
        raise ValueError(f"{len(p)} momenta for {len(ignored)} ignorable coordinates; each needs one")
    rest = tuple(s for s in lagrangian.q if s not in ignored)
    if not ignored:
        return Routhian(lagrangian.L, rest, (), (), lagrangian.t)
    velocities = [velocity(s) for s in ignored]
    negative = eliminate_velocities(
        lagrangian.L, velocities, p, domain or Domain(), "L", "ignorable velocities"
    )
    return Routhian(-negative, rest, ignored, p, lagrangian.t)
