"""Integrators of heyoka that no motion uses any more, kept for the next motion of the same system."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from canon.kernel.heyoka_bridge import taylor_integrator

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from fractions import Fraction

    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["SpareIntegrators", "spare_integrators"]

_SYSTEMS, _EACH = 16, 4
"""Systems whose integrators are kept, and how many of each."""


@dataclass(frozen=True, eq=False)
class SpareIntegrators:
    """Integrators in doubles, without events, of one system: to make one is dear (``benchmarks/preparation.py``).

    Parameters
    ----------
    system, tolerance, unit
        As :func:`canon.kernel.heyoka_bridge.taylor_integrator` takes them.
    """

    system: HamiltonEquations
    tolerance: float | None
    unit: Fraction
    _kept: list[Any] = field(default_factory=list[Any])

    def take(self, start: Callable[[], Sequence[Fraction]], t0: Fraction) -> Any:
        """Return one that was put aside, in whatever state, or a new one, in the state that is then asked for."""
        try:
            return self._kept.pop()
        except IndexError:
            return taylor_integrator(self.system, start(), t0, self.tolerance, unit=self.unit)

    def put_aside(self, integrators: Sequence[Any]) -> None:
        """Keep integrators of motions that have ended."""
        self._kept.extend(integrators[: max(0, _EACH - len(self._kept))])


@functools.lru_cache(maxsize=_SYSTEMS)
def spare_integrators(system: HamiltonEquations, tolerance: float | None, unit: Fraction) -> SpareIntegrators:
    """Return the spare integrators of a system, the same ones in every call."""
    return SpareIntegrators(system, tolerance, unit)
