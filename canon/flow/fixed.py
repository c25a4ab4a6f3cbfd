"""Methods of fixed step size: their compiled loops, their coefficients, and sampling."""

from __future__ import annotations

import functools
import math
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.method import RK4, FixedStep, Gauss
from canon.flow.stepping import run
from canon.flow.trajectory import Array, Samples
from canon.kernel.gauss import gauss_coefficients, gauss_loop
from canon.kernel.loop import Loop, runge_kutta_loop, splitting_loop

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.kernel.structure import Equations

__all__ = ["compiled_loop", "fixed_steps"]

_KEPT = 64
"""Compiled loops kept for the next call."""


def compiled_loop(system: Equations, method: FixedStep, *, compensated: bool) -> Loop:
    """Return the machine code that steps a system with a method, kept from an earlier call if there was one.

    Raises
    ------
    ValueError
        A splitting is asked of a Hamiltonian that does not split, or a Nyström method of one whose kinetic
        energy is not quadratic.
    """
    if isinstance(method, Gauss):
        return _kept_gauss(system, method.stages, compensated=compensated)
    if isinstance(method, RK4):
        return _kept_runge_kutta(system, compensated=compensated)
    if not system.separable:
        raise ValueError(
            "H is not a sum T(p, t) + V(q, t), so it does not split into drifts and kicks; use Gauss(6), which is "
            "symplectic for every H, or Taylor()"
        )
    if method.scheme.nystrom and not system.quadratic_kinetic:
        raise ValueError(
            f"{method} keeps its order only for kinetic energies quadratic in p with constant coefficients; "
            "use Splitting('blanes-moan-6') or Splitting('kahan-li-8')"
        )
    return _kept_splitting(system, len(method.scheme.b), compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def _kept_splitting(system: Equations, stages: int, *, compensated: bool) -> Loop:
    return splitting_loop(system, stages, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def _kept_runge_kutta(system: Equations, *, compensated: bool) -> Loop:
    return runge_kutta_loop(system, compensated=compensated)


@functools.lru_cache(maxsize=_KEPT)
def _kept_gauss(system: Equations, stages: int, *, compensated: bool) -> Loop:
    return gauss_loop(system, stages, compensated=compensated)


def fixed_steps(
    loop: Loop,
    method: FixedStep,
    state: Array,
    span: tuple[Fraction, Fraction],
    step: float | None,
    samples: int,
    progress: Callable[[float], None] | None,
) -> Samples:
    """Step from the first time of a span to the last and sample on the way."""
    start, end = span
    steps = _steps(start, end, step, method)
    h = (end - start) / steps
    stops = np.unique(np.linspace(0, steps, min(samples, steps) + 1).round().astype(np.int64))
    coefficients = np.array([float(start), float(h), *_coefficients(method, h)])
    done = run(loop, state, coefficients, [int(stop) for stop in stops], progress)
    return Samples(
        t=np.array([float(start + int(stop) * h) for stop in stops]),
        y=done.y,
        carried=done.carried if loop.compensated else None,
        steps=steps,
        evaluations=(int(done.memory[0]) if isinstance(method, Gauss) else steps) * method.stages,
        step=float(h),
        cpu_seconds=done.cpu_seconds,
        compile_seconds=loop.code.seconds,
    )


def _steps(start: Fraction, end: Fraction, step: float | None, method: FixedStep) -> int:
    if step is None:
        raise ValueError(f"{method} takes fixed steps: give step=, in the units of time")
    if not (math.isfinite(step) and step > 0):
        raise ValueError(f"step={step}: give a positive number; the direction of time follows from t_span")
    ratio = abs(end - start) / Fraction(step)
    nearest = max(1, round(ratio))
    # A span that is a whole number of steps up to the rounding of its ends and of the step counts as one.
    return nearest if abs(ratio - nearest) <= nearest * Fraction(1, 10**9) else math.ceil(ratio)


def _coefficients(method: FixedStep, h: Fraction) -> list[float]:
    if isinstance(method, Gauss):
        return gauss_coefficients(method.stages, h)
    if isinstance(method, RK4):
        return [float(h / 2), float(h / 6), float(h / 3)]
    a, b = method.scheme.a, method.scheme.b
    return [float(h * c) for pair in zip(a, b, strict=False) for c in pair] + [float(h * a[-1])]
