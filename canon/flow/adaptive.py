"""Adaptive methods that other libraries do well: heyoka's Taylor method and SciPy's DOP853."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.stepping import NonFiniteStateError
from canon.flow.trajectory import Array, Samples
from canon.kernel.loop import field_function
from canon.kernel.taylor import taylor_integrator

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.flow.method import DOP853, Taylor
    from canon.kernel.structure import Equations

__all__ = ["integrate_dop853", "integrate_taylor"]

_SLICES = 20
"""Parts a run is done in, between which progress is reported and an interruption heard."""


def integrate_taylor(
    system: Equations, y0: Array, times: Array, method: Taylor, progress: Callable[[float], None] | None
) -> Samples:
    """Integrate with heyoka and evaluate the steps' own Taylor polynomials at the sample times.

    Raises
    ------
    NonFiniteStateError
        The state stops being finite.
    """
    from heyoka import taylor_outcome

    compiling = time.perf_counter()
    integrator = taylor_integrator(system, [float(x) for x in y0], float(times[0]), method.tolerance)
    compiled = time.perf_counter() - compiling
    states, steps, started = [y0[np.newaxis]], 0, time.thread_time()
    for part in np.array_split(np.arange(1, len(times)), min(_SLICES, len(times) - 1)):
        outcome, _, _, taken, _, grid = integrator.propagate_grid(times[part[0] - 1 : part[-1] + 1])
        if outcome != taylor_outcome.time_limit or not np.isfinite(grid).all():
            raise _lost(integrator.time, np.array(integrator.state), outcome)
        states.append(grid[1:])
        steps += taken
        if progress is not None:
            progress(float(part[-1]) / (len(times) - 1))
    spent = time.thread_time() - started
    return Samples(times, np.concatenate(states).T.copy(), None, steps, steps, None, spent, compiled)


def integrate_dop853(
    system: Equations, y0: Array, times: Array, method: DOP853, progress: Callable[[float], None] | None
) -> Samples:
    """Integrate with SciPy's DOP853 on the compiled right-hand side.

    Raises
    ------
    NonFiniteStateError
        The state stops being finite, or the step size becomes too small.
    """
    from scipy import integrate

    field = field_function(system.program((*system.velocity, *system.force)))
    x, out = np.empty(len(y0) + 1), np.empty(len(y0))

    def rate(t: float, y: Array) -> Array:
        x[:-1], x[-1] = y, t
        field.call(x.ctypes.data, out.ctypes.data)
        return out.copy()

    started, steps, sample = time.thread_time(), 0, 1
    tolerance = method.tolerance
    integrator = integrate.DOP853(rate, times[0], y0, times[-1], rtol=max(tolerance, 2.3e-14), atol=tolerance)
    states = np.empty((len(y0), len(times)))
    states[:, 0] = y0
    direction = np.sign(times[-1] - times[0])
    while sample < len(times):
        before, kept = integrator.t, integrator.y.copy()
        message = integrator.step()
        steps += 1
        if integrator.status == "failed" or not np.isfinite(integrator.y).all():
            raise _lost(float(before), kept, message)
        reached = sample
        while reached < len(times) and direction * (times[reached] - integrator.t) <= 0:
            reached += 1
        if reached > sample:
            states[:, sample:reached] = integrator.dense_output()(times[sample:reached])
            sample = reached
        if progress is not None:
            progress(float((integrator.t - times[0]) / (times[-1] - times[0])))
    spent = time.thread_time() - started
    return Samples(times, states, None, steps, integrator.nfev, None, spent, field.seconds)


def _lost(t: float, state: Array, reason: object) -> NonFiniteStateError:
    shown = ", ".join(f"{x:.6g}" for x in state[:8])
    return NonFiniteStateError(
        f"the motion can't be continued after t = {t:.9g} where (q, p) = ({shown}) ({reason}): a "
        "collision or the edge of H's domain; stop earlier",
        t,
        state,
    )
