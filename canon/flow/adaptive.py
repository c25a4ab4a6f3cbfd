"""Adaptive methods that other libraries do well: heyoka's Taylor method and SciPy's DOP853."""

from __future__ import annotations

import time
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.method import Taylor
from canon.flow.stepping import NonFiniteStateError
from canon.flow.trajectory import Array, Samples
from canon.kernel.loop import field_function
from canon.kernel.taylor import heyoka_number, taylor_integrator

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.flow.method import DOP853
    from canon.kernel.structure import Equations

__all__ = ["adaptive_steps"]

_SLICES = 20
"""Parts a run is done in, between which progress is reported and an interruption heard."""


def adaptive_steps(
    system: Equations,
    states: tuple[Array, Array],
    times: Array,
    method: Taylor | DOP853,
    precision: str | int,
    progress: Callable[[float], None],
) -> Samples:
    """Integrate orbits one after the other and sample them at given times.

    Raises
    ------
    NonFiniteStateError
        A state stops being finite, or the step size becomes too small.
    ValueError
        The method does not have that precision.
    """
    orbits = states[0].shape[1]
    done: list[Samples] = []
    for high, low in zip(states[0].T, states[1].T, strict=True):

        def report(fraction: float, before: int = len(done)) -> None:
            progress((before + fraction) / orbits)

        if isinstance(method, Taylor):
            done.append(_taylor(system, high, low, times, method, precision, report))
        elif precision == "double":
            done.append(_dop853(system, high, times, method, report))
        else:
            raise ValueError(f"precision={precision!r}: {method} runs in double precision")
    return Samples(
        t=times,
        y=np.stack([each.y for each in done], axis=2),
        carried=np.stack([each.carried for each in done], axis=2),
        steps=sum(each.steps for each in done),
        evaluations=sum(each.evaluations for each in done),
        step=None,
        cpu_seconds=sum(each.cpu_seconds for each in done),
        compile_seconds=sum(each.compile_seconds for each in done),
    )


def _taylor(
    system: Equations,
    high: Array,
    low: Array,
    times: Array,
    method: Taylor,
    precision: str | int,
    progress: Callable[[float], None],
) -> Samples:
    """Integrate with heyoka and evaluate the steps' own Taylor polynomials at the sample times."""
    from heyoka import taylor_outcome

    compiling = time.perf_counter()
    number = heyoka_number(precision)
    y0 = [Fraction(a) + Fraction(b) for a, b in zip(high.tolist(), low.tolist(), strict=True)]
    grid = np.array([number(Fraction(t)) for t in times.tolist()])
    integrator = taylor_integrator(system, y0, Fraction(float(times[0])), method.tolerance, number)
    compiled = time.perf_counter() - compiling
    rows, steps, started = [integrator.state[np.newaxis].copy()], 0, time.thread_time()
    for part in np.array_split(np.arange(1, len(times)), min(_SLICES, len(times) - 1)):
        outcome, _, _, taken, _, found = integrator.propagate_grid(grid[part[0] - 1 : part[-1] + 1])
        if outcome != taylor_outcome.time_limit or not np.isfinite(found.astype(np.float64)).all():
            raise _lost(float(integrator.time), integrator.state.astype(np.float64), outcome)
        rows.append(found[1:])
        steps += taken
        progress(float(part[-1]) / (len(times) - 1))
    spent = time.thread_time() - started
    found = np.concatenate(rows).T
    y = found.astype(np.float64)
    carried = (found - np.array([[number(Fraction(x)) for x in row] for row in y.tolist()])).astype(
        np.float64
    )
    return Samples(times, y, carried, steps, steps, None, spent, compiled)


def _dop853(
    system: Equations, y0: Array, times: Array, method: DOP853, progress: Callable[[float], None]
) -> Samples:
    """Integrate with SciPy's DOP853 on the compiled right-hand side."""
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
        progress(float((integrator.t - times[0]) / (times[-1] - times[0])))
    spent = time.thread_time() - started
    return Samples(times, states, np.zeros_like(states), steps, integrator.nfev, None, spent, field.seconds)


def _lost(t: float, state: Array, reason: object) -> NonFiniteStateError:
    shown = ", ".join(f"{x:.6g}" for x in state[:8])
    return NonFiniteStateError(
        f"the motion can't be continued after t = {t:.9g} where (q, p) = ({shown}) ({reason}): a "
        "collision or the edge of H's domain; stop earlier",
        t,
        state,
    )
