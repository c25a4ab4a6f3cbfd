"""Unit of a state for the Taylor method: small numbers are measured by a small unit, so that the tolerance is relative.

heyoka takes its tolerance for a relative one where the largest number of a state is above 1 and for an absolute one
elsewhere: an oscillator of amplitude 10⁻¹⁰ would lose eight digits, one of 10⁻³⁰ all of them.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from canon.array import Array
    from canon.flow.run.sampling_plan import Plan
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["is_finite", "state_unit"]

_ORDINARY = 2.0**-4
"""A state whose largest number is above this part of 1 is integrated as it is."""

_BELOW = 20
"""A start at the origin gets a unit 2⁻²⁰ times as large as its rate would carry it in all of the time."""


def state_unit(system: HamiltonEquations, states: Array, plan: Plan) -> Fraction:
    """Return the power of two that the states of a motion are to be measured by: 1, or less for small numbers.

    Parameters
    ----------
    system
        The equations.
    states
        The states to start from, shape (2n, orbits).
    plan
        From when to when.
    """
    sizes = abs(states[system.rows]).max(axis=0)
    if (sizes == 0).any():
        point = dict(zip(system.inputs, (*states, np.float64(plan.instants[0])), strict=True))
        rates = system.graph.evaluate([*system.velocity, *system.force], point)
        fastest = np.max([abs(np.broadcast_to(np.asarray(x), sizes.shape)) for x in rates], axis=0)
        span = abs(plan.instants[-1] - plan.instants[0])
        sizes = np.where(sizes == 0, fastest * span * 2.0**-_BELOW, sizes)
    sizes = sizes[(sizes > 0) & (sizes < _ORDINARY)]
    return Fraction(2) ** (math.frexp(float(sizes.min()))[1] - 1) if sizes.size else Fraction(1)


def is_finite(state: Any) -> bool:
    """Tell whether doubles hold a state of any numbers: wider ones may be beyond them after a step that is too long."""
    with np.errstate(all="ignore"):
        return bool(np.isfinite(state.astype(np.float64)).all())
