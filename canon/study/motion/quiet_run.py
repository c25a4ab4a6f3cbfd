"""Quiet runs: motions whose energy error is judged by whoever runs them, so that no warning tells of it."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.propagate import propagate
from canon.flow.run.observables_along import AccuracyWarning

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from fractions import Fraction

    from numpy.typing import NDArray
    from sympy import Symbol

    from canon.array import Array
    from canon.flow.method.setting import Setting
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.flow.trajectory import Trajectory
    from canon.study.motion.observables import Observable

__all__ = ["run_quietly"]


def run_quietly(
    hamiltonian: HamiltonianSystem,
    t_span: tuple[float | Fraction, float | Fraction],
    y0: NDArray[Any],
    setting: Setting,
    *,
    parameters: Mapping[Symbol | str, float] | None,
    samples: int,
    times: Sequence[float] | Array | None = None,
    along: Iterable[Observable] = (),
    cadence: int | None = None,
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """Return a motion without a warning of its energy error, nor of numbers that overflow on the way.

    Parameters
    ----------
    hamiltonian, t_span, y0, parameters, samples, times, cadence, progress
        As :func:`canon.flow.propagate.propagate` takes them; the times, where there are any, in place of the samples.
    setting
        Method, step or tolerance, and precision.
    along
        Observables to follow beside the energy.
    """
    with warnings.catch_warnings(), np.errstate(over="ignore", invalid="ignore"):
        warnings.simplefilter("ignore", AccuracyWarning)
        return propagate(
            hamiltonian,
            t_span=t_span,  # pyright: ignore[reportArgumentType] - times may be exact
            y0=y0,
            method=setting.method,
            step=setting.step,
            tolerance=setting.tolerance,
            precision=setting.precision,
            parameters=parameters,
            samples=samples if times is None else None,
            times=times,
            cadence=cadence,
            observables={of.name: of.expression for of in along if of.expression is not None},
            progress=progress,
        )
