"""Systems written with signs and moduli: Piecewise, Max, Min and Heaviside in their functions are taken apart."""

from __future__ import annotations

from typing import Any

from canon.expression.graph.piecewise_form import without_pieces
from canon.mechanics.hamilton.vector_field import VectorField
from canon.mechanics.lagrange.constraint import ConstrainedLagrangian
from canon.mechanics.lagrange.lagrangian import Lagrangian
from canon.mechanics.lagrange.unilateral import UnilateralLagrangian

__all__ = ["written_with_signs"]


def written_with_signs(system: Any) -> Any:
    """Return a Lagrangian, constrained or not, or a vector field with no function made of pieces but sign and Abs.

    Any other system is left as it is.

    Examples
    --------
    >>> from canon import coordinates
    >>> from sympy import Max
    >>> x = coordinates("x")
    >>> written_with_signs(Lagrangian(x.dot**2 / 2 - Max(x, 0) ** 2, [x])).L
    x_dot**2/2 - (x/2 + Abs(x)/2)**2
    """
    if isinstance(system, VectorField):
        components = [without_pieces(a) for a in system.components]
        return system if _same(components, system.components) else VectorField(components, system.x)
    if isinstance(system, ConstrainedLagrangian):
        lagrangian = written_with_signs(system.lagrangian)
        if lagrangian is system.lagrangian:
            return system
        return ConstrainedLagrangian(lagrangian, system.holonomic, system.nonholonomic)
    if isinstance(system, UnilateralLagrangian):
        inner = written_with_signs(system.system)
        return (
            system
            if inner is system.system
            else UnilateralLagrangian(inner, system.unilateral, system.restitution)
        )
    if not isinstance(system, Lagrangian):
        return system
    L, *forces = written = [without_pieces(f) for f in (system.L, *system.forces)]
    if _same(written, (system.L, *system.forces)):
        return system
    return Lagrangian(L, system.q, forces, system.t)


def _same(written: Any, given: Any) -> bool:
    return all(a is b for a, b in zip(written, given, strict=True))
