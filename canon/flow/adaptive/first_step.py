"""First step of the Taylor method: its length, tried by two halves where a symmetry of the start may hide it.

heyoka takes the length of a step from the last two coefficients of the series. At a turning point or on a line of
symmetry every second, fourth or eighth coefficient alone is not zero, and where both of the last two vanish the step is
far too long: 2·10⁻⁸ are lost by a pendulum that is released from the horizontal. Steps begin at such points where a
person has put them, that is at the start.
"""

from __future__ import annotations

from typing import Any

import numpy as np

__all__ = ["first_step"]

_AGREE = 32.0
"""So many tolerances of the state's largest number two halves and the whole of a good step may differ by."""

_MOST = 100
"""Steps that a trial may take, and halvings."""


def first_step(integrator: Any, end: Any) -> Any:
    """Return the time at which the first step from the integrator's state should end; None for heyoka's own choice.

    Parameters
    ----------
    integrator
        heyoka's adaptive integrator, without events that change or stop anything; it is left as it is.
    end
        The time beyond which no step is wanted.
    """
    state, clock, start = integrator.state.copy(), integrator.dtime, integrator.time
    kind = type(start)

    def stepped(limit: Any) -> tuple[Any, Any]:
        integrator.state[:], integrator.dtime = state, clock
        _, taken = integrator.step(limit)
        return taken, integrator.state.copy()

    def agree(whole: Any, length: Any) -> bool:
        stepped(length / kind(2))
        integrator.propagate_until(start + length, max_steps=_MOST)
        if integrator.time != start + length:
            return False
        numbers = whole.astype(np.float64)
        size = float(abs(numbers).max(initial=0.0))
        away = (whole - integrator.state).astype(np.float64)
        return bool(np.isfinite(numbers).all() and abs(away).max() <= _AGREE * float(integrator.tol) * size)

    chosen = None
    length, reached = stepped(end - start)
    for _ in range(_MOST):
        if np.isnan(np.float64(length)) or start + length == start or agree(reached, length):
            break
        length, reached = stepped(length / kind(2))
        chosen = start + length
    integrator.state[:], integrator.dtime = state, clock
    return chosen
