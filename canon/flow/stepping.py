"""Running a compiled loop: in slices, with progress, stopping where the motion stops being finite."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.kernel.loop import Loop

__all__ = ["NonFiniteStateError", "Run", "run"]

Array = npt.NDArray[np.float64]

_SLICE_SECONDS = 0.1
"""Between calls of compiled code Python can handle an interruption and report progress."""


class NonFiniteStateError(ArithmeticError):
    """The motion left the finite numbers: a collision, a domain left, or a step too large.

    Parameters
    ----------
    time
        The time of the last finite state.
    state
        That state (q, p), shape (2n,).
    """

    def __init__(self, message: str, time: float, state: Array) -> None:
        super().__init__(message)
        self.time = time
        self.state = state


@dataclass(frozen=True)
class Run:
    """States at the wanted steps, what compensation carried there, and the processor time.

    Parameters
    ----------
    y, carried
        Shape (2n, times).
    memory
        What else the method kept in its carry at the end.
    cpu_seconds
        Processor time of this thread.
    """

    y: Array
    carried: Array
    memory: Array
    cpu_seconds: float


def run(
    loop: Loop,
    y0: Array,
    coefficients: Array,
    stops: Sequence[int],
    progress: Callable[[float], None] | None = None,
) -> Run:
    """Advance a state step by step and keep it at the wanted step numbers.

    Parameters
    ----------
    loop
        The compiled loop.
    y0
        The state at step 0, shape (2n,).
    coefficients
        t0, h and the method's coefficients times h.
    stops
        Rising step numbers at which to keep the state; the last is the end.
    progress
        Called now and then with the fraction done, 0 … 1.

    Raises
    ------
    NonFiniteStateError
        A state is not finite; the error knows the last finite one.
    """
    y, e = y0.copy(), np.zeros(loop.carry)
    kept, kept_e = np.empty((len(y), len(stops))), np.empty((len(y), len(stops)))
    started, done, slice_steps = time.thread_time(), 0, 64
    for sample, stop in enumerate(stops):
        while done < stop:
            steps = min(slice_steps, stop - done)
            before = y.copy(), e.copy()
            clock = time.perf_counter()
            _advance(loop, y, e, coefficients, done, steps)
            spent = time.perf_counter() - clock
            if not np.isfinite(y).all():
                raise _last_finite(loop, *before, coefficients, done, steps)
            done += steps
            if steps == slice_steps and spent < _SLICE_SECONDS / 2:
                slice_steps *= 2
            elif spent > _SLICE_SECONDS and slice_steps > 1:
                slice_steps //= 2
            if progress is not None:
                progress(done / stops[-1])
        kept[:, sample], kept_e[:, sample] = y, e[: len(y)]
    return Run(kept, kept_e, e[len(y) :], time.thread_time() - started)


def _advance(loop: Loop, y: Array, e: Array, coefficients: Array, first: int, steps: int) -> None:
    loop.code.call(y.ctypes.data, e.ctypes.data, coefficients.ctypes.data, first, steps)


def _last_finite(
    loop: Loop, y: Array, e: Array, coefficients: Array, first: int, steps: int
) -> NonFiniteStateError:
    """Find the last step with a finite state by halving the slice in which it was lost."""
    while steps > 1:
        half, half_e = y.copy(), e.copy()
        _advance(loop, half, half_e, coefficients, first, steps // 2)
        if np.isfinite(half).all():
            y, e, first, steps = half, half_e, first + steps // 2, steps - steps // 2
        else:
            steps //= 2
    after = e.copy()
    _advance(loop, y.copy(), after, coefficients, first, 1)
    if loop.implicit and after[len(y) + 1]:
        what = f"the stages of step {first + 1} do not converge (last change {after[len(y) + 1]:.2g})"
        why = "the step is too large for the iteration; take a smaller one, or Taylor()"
    else:
        what = f"the state stops being finite in step {first + 1}"
        why = "a collision or the edge of H's domain; stop earlier, or take a smaller step or Taylor()"
    t = float(coefficients[0] + first * coefficients[1])
    state = ", ".join(f"{x:.6g}" for x in y[:8]) + (", …" if len(y) > 8 else "")
    return NonFiniteStateError(f"{what}, after t = {t:.9g} where (q, p) = ({state}): {why}", t, y)
