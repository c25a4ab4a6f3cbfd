"""Forces: their work in virtual displacements, springs, dampers, and potentials that depend on velocities."""

from __future__ import annotations

from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Symbol

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["generalized_forces"]


def generalized_forces(
    forces: Sequence[Sequence[Expr]], positions: Sequence[Sequence[Expr]], q: Sequence[Symbol]
) -> tuple[Expr, ...]:
    """Return Q = Σ F·∂r/∂q, the work of forces in virtual displacements.

    Parameters
    ----------
    forces
        Force vectors, one a point.
    positions
        The positions r(q, t) at which they act, as vectors of the same length.
    q
        The generalized coordinates.

    Examples
    --------
    >>> from sympy import cos, sin, symbols
    >>> theta, l, F = symbols("theta l F")
    >>> generalized_forces([(F, 0)], [(l*sin(theta), -l*cos(theta))], [theta])
    (F*l*cos(theta),)
    """
    return tuple(
        sp.Add(
            *(
                component * place.diff(s)
                for force, position in zip(forces, positions, strict=True)
                for component, place in zip(force, position, strict=True)
            )
        )
        for s in q
    )
