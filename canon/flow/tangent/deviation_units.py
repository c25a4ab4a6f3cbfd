"""Units of deviations: how large one of a momentum is that matters as much as one of a coordinate.

Lengths of deviations add squares of coordinates and momenta. Where a unit of the one turns into 10⁹ of the other, as
of a satellite in kilogrammes and metres, all deviations look parallel and none can be told from the next. Exponents are
the same in any units.
"""

from __future__ import annotations

from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

from canon.expression.graph.number_systems import FLOAT64
from canon.flow.run.values_at_states import energy_and_rates

if TYPE_CHECKING:
    from canon.array import Array
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["deviation_units"]

_ALIKE = 1e3
"""Ratios up to this leave the units as they are."""

_STEP = 2.0**-20


def deviation_units(system: HamiltonEquations, state: Array, time: float) -> Array:
    """Return the size of a deviation of each variable, shape (2n,): 1 of the coordinates.

    That of the momenta is √(‖∂ṗ/∂q‖ / ‖∂q̇/∂p‖) at the start, m ω for oscillators; 1 where that is near 1 or unknown.

    Parameters
    ----------
    system
        The equations, their parameters having numbers.
    state
        The start, shape (2n,).
    time
        When it starts.
    """
    n = len(state) // 2
    units = np.ones(2 * n)
    across = [_largest_slope(system, state, time, half) for half in (slice(0, n), slice(n, 2 * n))]
    if all(np.isfinite(x) and x > 0 for x in across):
        ratio = sqrt(across[0] / across[1])
        if not 1 / _ALIKE <= ratio <= _ALIKE:
            units[n:] = ratio
    return units


def _largest_slope(system: HamiltonEquations, state: Array, time: float, half: slice) -> float:
    """Return how much the other half's rates change at most by a variable of one half."""
    n = len(state) // 2
    own = [i for i in system.rows if half.start <= i < half.stop]  # parameters by orbit are no variables
    size = float(np.abs(state[own]).max(initial=0.0)) or 1.0
    other = slice(n, None) if half.start == 0 else slice(0, n)
    found = 0.0
    for i in own:
        sides = []
        for sign in (1, -1):
            beside = state.copy()
            beside[i] += sign * _STEP * size
            with FLOAT64.quiet():
                rates = energy_and_rates(system, beside, time, FLOAT64)[1:]
            sides.append(np.array(rates, dtype=np.float64)[other])
        found = max(found, float(np.abs(sides[0] - sides[1]).max()) / (2 * _STEP * size))
    return found
