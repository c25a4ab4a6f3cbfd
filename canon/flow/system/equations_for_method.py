"""Equations with what a method needs beside them: constraints that it keeps, momenta, parts with known flows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from canon.flow.equations.constrained.holonomic_motion import with_constraints_kept
from canon.flow.equations.constrained.nonholonomic_motion import with_velocity_constraints_kept
from canon.flow.equations.lagrangian_motion import with_momenta_and_forces
from canon.flow.equations.poisson_motion import with_lie_poisson_parts

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from sympy import Symbol

    from canon.flow.equations.first_order_motion import FirstOrderMotion, MovingSystem
    from canon.flow.method.method import Method
    from canon.flow.system.recognised_system import RecognisedSystem

__all__ = ["KEEPING_CONSTRAINTS", "Derivation", "for_method"]

KEEPING_CONSTRAINTS = {
    "rattle": with_constraints_kept,
    "nonholonomic_leapfrog": with_velocity_constraints_kept,
}
"""What gives the equations of a system to the methods that keep constraints themselves."""


class Derivation(NamedTuple):
    """What equations were derived from.

    Parameters
    ----------
    given, found
        What the user gave, and what was recognised in it.
    motion
        Its equations.
    numbers, varying
        The parameters' numbers by name, and those that differ from orbit to orbit.
    start
        Numbers for the state, t and the parameters at the start.
    """

    given: Any
    found: RecognisedSystem
    motion: FirstOrderMotion
    numbers: Mapping[str, Fraction]
    start: Mapping[Symbol, float]
    varying: Sequence[Symbol]


def for_method(moving: MovingSystem, of: Derivation, method: Method) -> MovingSystem:
    """Return a moving system with what a method needs beside its equations.

    Raises
    ------
    TypeError, ValueError
        It has nothing of the kind; the message names methods that apply.
    """
    if (kept := KEEPING_CONSTRAINTS.get(method.family)) is not None:
        return kept(of.found.system, of.motion, moving, of.numbers, of.start, of.varying)
    if method.family == "galerkin":
        return with_momenta_and_forces(of.found.system, of.motion, moving, of.numbers, of.varying)
    if method.family == "lie_poisson":
        return with_lie_poisson_parts(of.given, moving, of.numbers, of.varying)
    return moving
