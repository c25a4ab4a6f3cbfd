"""Equations of motion kept for another call: of the same system, with the same numbers, for the same kind of method."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from sympy import Symbol

    from canon.flow.equations.first_order_motion import FirstOrderMotion, MovingSystem
    from canon.flow.system.recognised_system import RecognisedSystem

__all__ = ["KeptEquations", "kept_equations"]

_KEPT = 32
"""Systems whose equations are kept."""
_STARTS = 4
"""Starts of a system whose equations are others from each."""


@dataclass(frozen=True, eq=False)
class DerivedEquations:
    """Equations from a start, and with numbers by the unit of the work done along."""

    motion: FirstOrderMotion
    start: Mapping[Symbol, float]
    moving: dict[Fraction, MovingSystem] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class KeptEquations:
    """What was derived of a system, the latest last."""

    derived: list[DerivedEquations] = field(default_factory=list)

    def from_start(self, found: RecognisedSystem, start: Mapping[Symbol, float]) -> DerivedEquations:
        """Return the equations from a start, derived where they are not known.

        Raises
        ------
        ValueError
            They do not determine the motion there.
        """
        for known in self.derived:
            if known.start == start or known.motion.holds_from(start):
                return known
        made = DerivedEquations(found.derived(start), dict(start))
        self.derived[:] = [*self.derived[1 - _STARTS :], made]
        return made


def kept_equations(
    system: Any, numbers: Mapping[str, Fraction], varying: Sequence[Symbol], family: str
) -> KeptEquations:
    """Return what is kept of a system; nothing yet where it holds what can change.

    Parameters
    ----------
    system
        The system.
    numbers
        The numbers of its parameters by name. Others have a graph of their own: no result hangs on what was asked
        before.
    varying
        The parameters that differ from orbit to orbit.
    family
        The kind of method.
    """
    try:
        hash(system)
    except TypeError:
        return KeptEquations()
    return _kept(system, tuple(sorted(numbers.items())), tuple(varying), family)


@functools.lru_cache(maxsize=_KEPT)
def _kept(*_asked: Any) -> KeptEquations:
    return KeptEquations()
