"""Alignment indices: SALI and GALI, the volume that deviations span, which vanishes exponentially in chaos."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.chaos.chaos_indicators import ChaosIndicator, indicator_of
from canon.flow.chaos.regularity import Judged, Regularity, quarters
from canon.flow.tangent.deviation_frame import random_vectors
from canon.flow.tangent.deviation_growth import DeviationRun, deviation_growth, deviation_task
from canon.flow.tangent.deviation_units import deviation_units

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from fractions import Fraction

    import numpy.typing as npt
    from sympy import Symbol

    from canon.array import Array
    from canon.flow.method.method_text import MethodGiven
    from canon.flow.system.recognised_system import MovableSystem
    from canon.flow.task import Task

__all__ = ["gali", "sali"]

_FLOOR = float(np.log(1e-12))
"""Below this ln of a volume, rounding decides where two deviations point."""

_CHAOTIC = 8.0
"""ln of the fall from the second quarter of the time down to the floor to the last. A power t⁻ᵖ falls by 0.86 p, an
exponential that reaches the floor by 13.8."""

_OF_A_POWER, _BEYOND = 0.87, 2.0
"""ln of that fall for each unit of a power, and what is beyond it: k deviations beside a torus fall as t⁻ᵏ at most."""

_NOTHING = -745.0
"""ln of the least positive double, in place of that of 0."""


def sali(
    system: MovableSystem,
    t_span: tuple[float | Fraction, float | Fraction],
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None = None,
    *,
    method: MethodGiven | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    precision: str | int | None = None,
    parameters: Mapping[Symbol | str, Any] | None = None,
    samples: int | None = None,
    seed: int = 0,
    progress: Callable[[float], None] | bool | None = None,
) -> ChaosIndicator:
    """Return the smaller alignment index of an orbit, min(‖a + b‖, ‖a − b‖) of two deviations of length 1.

    In chaos it vanishes as exp(−(λ₁ − λ₂) t), beside regular motion in two and more degrees of freedom it stays away
    from 0, and in one it falls as 1/t². The detection limit is one of λ₁ − λ₂.

    Parameters
    ----------
    system, t_span, y0, method, step, tolerance, precision, parameters, samples, seed, progress
        As :func:`canon.flow.lyapunov_spectrum` takes them.

    Raises
    ------
    ValueError, NonFiniteStateError
        As :func:`canon.flow.lyapunov_spectrum`.

    References
    ----------
    Ch. Skokos, Alignment indices: a new, simple method for determining the ordered or chaotic nature of orbits,
    J. Phys. A 34 (2001) 10029–10043, doi:10.1088/0305-4470/34/47/309.

    Examples
    --------
    >>> from canon import Splitting
    >>> how = dict(method=Splitting("kahan-li-8"), step=0.2)
    >>> regular, chaotic = (sali("henon-heiles", (0, 2000), name, **how) for name in ("regular", "chaotic"))
    >>> bool(regular.value > 1e-2), bool(chaotic.value < 1e-8)
    (True, True)
    """
    run = DeviationRun(system, t_span, y0, method, step, tolerance, precision, parameters, samples, progress)
    return _index("SALI", run, 2, seed, _smaller_alignment)


def gali(
    system: MovableSystem,
    t_span: tuple[float | Fraction, float | Fraction],
    y0: Sequence[Any] | npt.NDArray[Any] | Mapping[Any, Any] | str | None = None,
    *,
    vectors: int,
    method: MethodGiven | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    precision: str | int | None = None,
    parameters: Mapping[Symbol | str, Any] | None = None,
    samples: int | None = None,
    seed: int = 0,
    progress: Callable[[float], None] | bool | None = None,
) -> ChaosIndicator:
    """Return the generalised alignment index of an orbit, the volume that k deviations of length 1 span.

    In chaos it vanishes as exp(−[(λ₁ − λ₂) + … + (λ₁ − λ_k)] t). Beside motion on a torus of dimension s it stays away
    from 0 for k ≤ s and falls as a power of time for more: s is the largest k for which it does not fall. The power may
    be as large as k, so that from k = 14 on chaos is not told from it.

    Parameters
    ----------
    system, t_span, y0, method, step, tolerance, precision, parameters, samples, seed, progress
        As :func:`canon.flow.lyapunov_spectrum` takes them.
    vectors
        k = 2 … 2n.

    Raises
    ------
    ValueError, NonFiniteStateError
        As :func:`canon.flow.lyapunov_spectrum`; vectors are not 2 … 2n.

    References
    ----------
    Ch. Skokos, T. C. Bountis, Ch. Antonopoulos, Geometrical properties of local dynamics in Hamiltonian systems: the
    generalized alignment index (GALI) method, Physica D 231 (2007) 30–54, doi:10.1016/j.physd.2007.04.004.

    Examples
    --------
    >>> from canon import Splitting
    >>> found = gali("henon-heiles", (0, 2000), "chaotic", vectors=3, method=Splitting("kahan-li-8"), step=0.2)
    >>> found.verdict
    <Regularity.CHAOTIC: 'chaotic'>
    """
    run = DeviationRun(system, t_span, y0, method, step, tolerance, precision, parameters, samples, progress)
    return _index("GALI_{}", run, vectors, seed, _log_volume)


def _index(
    name: str, run: DeviationRun, vectors: int, seed: int, note: Callable[[Array], Array]
) -> ChaosIndicator:
    task = deviation_task(run)
    size = len(task.system.rows)
    if vectors not in range(2, size + 1):
        raise ValueError(f"vectors={vectors}: an alignment index takes 2 … {size} deviations of this system")
    vectors = int(vectors)
    units = _units(task)
    frame = units * random_vectors(size, vectors, seed)
    frame /= np.linalg.norm(frame, axis=0)

    def noted(frames: Array) -> Array:
        measured = frames / units[:, np.newaxis]
        return note(measured / np.linalg.norm(measured, axis=0))

    growth = deviation_growth(task, frame, orthogonal=False, note=noted, progress=run.progress)
    assert growth.noted is not None
    return indicator_of(
        name.format(vectors), growth, np.exp(growth.noted), _judged(growth.t, growth.noted, vectors)
    )


def _units(task: Task) -> Array:
    """Return the sizes that components of deviations are measured in, shape (2n, 1).

    Where a coordinate's unit is 10⁸ of its momentum's all deviations are parallel but for what rounding leaves.
    """
    system = task.system
    if not system.canonical or task.method.solvable is not None:  # the latter have units of their own
        return np.ones((len(system.rows), 1))
    start = (task.states[0] + task.states[1])[:, 0]
    return deviation_units(system, start, float(task.plan.start))[system.rows, np.newaxis]


def _smaller_alignment(frames: Array) -> Array:
    """Return ln of the smaller alignment index, shape (orbits,)."""
    a, b = frames[:, 0], frames[:, 1]
    closest = np.minimum(np.linalg.norm(a + b, axis=0), np.linalg.norm(a - b, axis=0))
    return _log(closest.astype(np.float64))


def _log_volume(frames: Array) -> Array:
    """Return ln of the volume that deviations span, shape (orbits,); NaN of orbits that have left."""
    known = np.isfinite(frames).all(axis=(0, 1))
    volume = np.full(frames.shape[2], np.nan)
    singular = np.linalg.svd(frames[:, :, known].transpose(2, 0, 1), compute_uv=False)
    volume[known] = _log(singular.astype(np.float64)).sum(axis=1)
    return np.maximum(volume, _NOTHING)


def _log(values: Array) -> Array:
    with np.errstate(divide="ignore"):
        return np.maximum(np.log(values), _NOTHING)


def _judged(t: Array, log: Array, vectors: int) -> Judged:
    """Judge orbits by ln of the volume of so many vectors, shape (times, orbits)."""
    limit = -_FLOOR / t[-1]
    judge = functools.partial(_verdict, t, max(_CHAOTIC, _OF_A_POWER * vectors + _BEYOND))
    found = [judge(column) for column in log.T]
    verdicts = np.array([verdict for verdict, _ in found], dtype=object)
    return Judged(verdicts, limit, tuple(reason for _, reason in found))


def _verdict(t: Array, chaotic: float, log: Array) -> tuple[Regularity, str]:
    if not np.isfinite(log).all():
        return Regularity.LEFT, "the orbit left the finite numbers, by escape or collision"
    below = np.flatnonzero(log < _FLOOR)
    end = int(below[0]) + 1 if below.size else len(t)
    second, last = quarters(t[:end])
    known = log[:end][second].size and log[:end][last].size
    fall = float(log[:end][second].mean() - log[:end][last].mean()) if known else 0.0
    seen = f"the volume fell to {np.exp(log[end - 1]):.2g} by t = {t[end - 1]:.4g}"
    if below.size:
        if fall > chaotic:
            return Regularity.CHAOTIC, f"{seen}, faster than a power of time"
        if not known:
            return Regularity.NOT_KNOWN, f"{seen}, and too few samples before it show how: take more samples"
        return (
            Regularity.NOT_KNOWN,
            f"{seen}, which a power of time may do too: take fewer deviations, or megno",
        )
    if fall < _CHAOTIC / 2:
        return Regularity.REGULAR, f"{seen}, no faster than a power of time"
    return (
        Regularity.NOT_KNOWN,
        f"{seen}, too fast for a regular orbit and not far enough for a chaotic one: run longer",
    )
