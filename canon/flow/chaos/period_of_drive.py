"""Period of a drive: whether the equations of a system that depends on time are the same after a time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from canon.array import Array
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["check_period_of_drive"]

_ROUNDING = 2.0**-52
_TIMES = 256
"""At so many times each state is looked at."""

_KNOWN = 2.0**-40
"""A period is given to this part of itself: 6.28318530718 is 2π, 6.2831853 is not."""

_GOLDEN = (5**0.5 - 1) / 2
"""Its multiples, taken to one turn, fall on no switching of a drive."""


def check_period_of_drive(equations: HamiltonEquations, course: Array, period: float) -> None:
    """Refuse a period after which the rates are not what they were.

    Parameters
    ----------
    equations
        Equations that depend on time.
    course
        States to look at, shape (2n, states).
    period
        The time after which the rates are to be the same.

    Raises
    ------
    ValueError
        They are not.
    """
    count = course.shape[1] * _TIMES
    states, times = np.repeat(course, _TIMES, axis=1), period * (_GOLDEN * np.arange(1, count + 1) % 1)
    now, after = _rates(equations, states, times), _rates(equations, states, times + period)
    changed = abs(after - now)
    earlier, later = (_rates(equations, states, times + period * (1 + off)) for off in (-_KNOWN, _KNOWN))
    known = np.fmax(abs(earlier - after), abs(later - after)).max(axis=1, keepdims=True)
    allowed = 2 * known + 64 * _ROUNDING * np.nanmax(abs(now), axis=1, keepdims=True)
    if (np.isfinite(now) & ~(changed <= allowed)).any():
        raise ValueError(
            f"H is not the same after {period!r}: an orbit that comes back then would not go on as before; give a "
            "whole multiple of the drive's period, to all its digits, such as 2*np.pi/omega"
        )


def _rates(equations: HamiltonEquations, states: Array, times: Array) -> Array:
    """Return (q̇, ṗ) at states and times side by side, NaN where they have none."""
    point = dict(zip(equations.inputs, (*states, times), strict=True))
    with np.errstate(all="ignore"):
        rates = equations.graph.evaluate([*equations.velocity, *equations.force], point)
    return np.array([np.broadcast_to(np.asarray(rate, dtype=np.float64), times.shape) for rate in rates])
