"""Error series of a motion: times, what should stay constant and does not, and what rounding alone would do to it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from canon.expression.graph.number_systems import FLOAT64
from canon.expression.symbols.user_input import counted
from canon.flow.method.number_formats import unit_round_off
from canon.study.motion.observables import ENERGY, Observable
from canon.study.motion.term_sizes import TermSizes, error_unit, terms_along

if TYPE_CHECKING:
    from canon.array import Array
    from canon.flow.task import Task
    from canon.flow.trajectory import Trajectory

__all__ = ["ErrorSeries", "error_series", "series_of_parts"]

FAR_ABOVE = 1e3
"""A tolerance so many times above the unit of rounding makes truncation the larger error of a step."""

BY_AN_EVENT = 1e-6
"""A change of the energy by more than this part of it is no rounding of an event's place."""


@dataclass(frozen=True)
class ErrorSeries:
    """The error of what should stay constant along a motion, and what is known of where it comes from.

    Parameters
    ----------
    t, error
        Times since the start, rising, and the error with its sign, shape (times,).
    largest
        Largest size of the error met, between samples too where it was followed inside the loop.
    walk
        Distance that rounding at random makes it walk in the root mean square: u·√n, with u the unit of rounding and n
        the number of steps, times the size of the terms in which the quantity is linear, Σ|y ∂I/∂y|; None where that is
        not known, as of a quantity that begins at zero and has none.
    bias
        Distance that rounding always to one side may take it: u·n times the same.
    resolution
        Error that the numbers of the motion can't tell from none.
    truncated
        Whether a tolerance far above the unit of rounding was asked for: what is beyond a walk is then truncation.
    way
        Method, step or tolerance, and precision, in words; empty where the motion itself is not at hand.
    relative
        Whether the error is relative to the quantity, or to its terms.
    size
        Where it is not: what errors are large beside, in their unit.
    """

    t: Array
    error: Array
    largest: float
    walk: float | None
    bias: float
    resolution: float
    truncated: bool = False
    way: str = ""
    relative: bool = True
    size: float = 1.0


def series_of_parts(
    t: Array, change: Array, unit: float, run: tuple[int, str], *, relative: bool, sizes: TermSizes
) -> ErrorSeries:
    """Return the error series of a run whose samples alone were kept, part by part.

    Parameters
    ----------
    t, change
        Times since the start, and changes since then, shape (times,).
    unit
        What the changes are divided by.
    run
        Its steps and its precision.
    relative
        Whether the error is relative to the quantity, or to its terms at the start.
    sizes
        Of the quantity's terms along the run.
    """
    error, u = change / unit, unit_round_off(run[1])
    return _beside_rounding(
        ErrorSeries(t, error, float(np.abs(error).max()), None, 0.0, u, relative=relative),
        *(sizes, unit, run[0]),
    )


def _beside_rounding(series: ErrorSeries, sizes: TermSizes, unit: float, steps: float) -> ErrorSeries:
    """Return a series, whose resolution is the unit u of rounding as yet, with what rounding would do to it."""
    u, least = series.resolution, 1.0 if series.relative else 0.0
    size = 1.0 if series.relative else sizes.mean / unit or 1.0
    return replace(
        series,
        walk=u * math.sqrt(steps) * max(least, sizes.square / unit) or None,
        bias=u * steps * max(least, sizes.mean / unit),
        resolution=u * size,
        size=size,
    )


def error_series(
    motion: Trajectory, observable: str | Observable = ENERGY, orbit: int | None = None
) -> ErrorSeries:
    """Return the error of the energy or an observable along a motion.

    Parameters
    ----------
    motion
        A motion that :func:`canon.flow.propagation.propagate` returned.
    observable
        ``"energy"``, or one of the observables that the motion was asked to follow; one of a study brings the unit of
        its error, which is else its size at the start, or one where that is nothing beside its terms.
    orbit
        Which of many orbits.

    Raises
    ------
    ValueError
        H depends on t or events have changed it, so that its change is no error; there is no such observable; the
        motion has many orbits and none is chosen, or no such orbit.

    Examples
    --------
    >>> from canon import Hamiltonian, Splitting, coordinates, propagate
    >>> x = coordinates("x")
    >>> oscillator = Hamiltonian(x.momentum**2 / 2 + x**2 / 2, [x], [x.momentum])
    >>> verlet = {"method": Splitting("verlet"), "step": 0.1}
    >>> motion = propagate(oscillator, t_span=(0, 300), y0=[1.0, 0.0], samples=300, **verlet)
    >>> series = error_series(motion)
    >>> series.way, bool(series.largest > 1e6 * series.walk)
    ('verlet, step 0.1, compensated', True)
    """
    name = observable if isinstance(observable, str) else observable.name
    change, one = _followed(motion, name), _orbit(motion, orbit)
    many = motion.y.ndim == 3
    terms = terms_along(motion, name, one)
    unit, relative = error_unit(motion, observable, terms, one)
    t, error = abs(motion.t - motion.t[0]), change[:, one] / unit if many else change / unit
    largest = float(np.abs(error).max())
    if name in motion.statistics:
        seen = motion.statistics[name]
        mean, size = (part[:, one] if many else part for part in (seen.mean, seen.largest))
        t, error, largest = (t[1:] + t[:-1]) / 2.0, mean / unit, float(size.max()) / unit
    u, tolerance = unit_round_off(motion.precision), motion.method.tolerance
    truncated = tolerance is not None and tolerance > FAR_ABOVE * u
    series = ErrorSeries(t, error, largest, None, 0.0, u, truncated, _way(motion), relative)
    return _beside_rounding(series, TermSizes().with_part(terms), unit, _steps_of_one(motion))


def _orbit(motion: Trajectory, orbit: int | None) -> int:
    """Return which orbit is meant: the only one where none is chosen."""
    orbits = motion.y.shape[2] if motion.y.ndim == 3 else 1
    if orbit is None and motion.y.ndim == 3:
        raise ValueError(
            f"the motion has {counted(orbits, 'orbit')}: say which one to judge, orbit=0 … {orbits - 1}"
        )
    if orbit is not None and orbit not in range(orbits):
        raise ValueError(
            f"orbit={orbit}: the motion has {counted(orbits, 'orbit')}, counted from 0; choose one of 0 … {orbits - 1}"
        )
    return int(orbit or 0)


def _followed(motion: Trajectory, observable: str) -> Array:
    """Return the changes of a quantity since the start."""
    if observable == ENERGY:
        if motion.record.moving is None and not motion.autonomous:
            raise ValueError(
                "H depends on t, so its change is no error; drift_study(system, …) follows the energy less the work "
                "done from outside, or name an observable that should stay constant"
            )
        _check_events(motion)
        return motion.energy_defect
    if observable not in motion.changes:
        known = ", ".join((ENERGY, *motion.changes))
        raise ValueError(
            f"the motion has not followed {observable!r}, only {known}: propagate(…, observables={{{observable!r}: …}})"
        )
    return motion.changes[observable]


def _check_events(motion: Trajectory) -> None:
    """Refuse a motion whose energy was changed by its events, as by a ball that loses some of it at each bounce.

    Raises
    ------
    ValueError
        Where one has changed it.
    """
    record = motion.record
    if record.moving is not None and record.moving.contacts is not None:
        return  # what impacts take is part of the work
    task, samples = record.task, record.samples
    for orbit, one in enumerate(samples.each or (samples,)):
        for met in one.crossings:
            if met.after is None or not any(met.event is given for given in task.events):
                continue
            before, after = (_energy_at(task, orbit, met.t, y) for y in (met.y, met.after))
            if abs(after - before) > BY_AN_EVENT * max(abs(before), abs(after)):
                raise ValueError(
                    f"{met.event} has changed the energy from {before:.6g} to {after:.6g} at t = {met.t:.6g}, so that "
                    "its change is no error: judge a motion up to there, or an observable that is kept"
                )


def _energy_at(task: Task, orbit: int, t: float, y: Array) -> float:
    """Return H, or the energy less the work up to the start, of a state (q, p) of an orbit."""
    state = task.states[0][:, orbit].copy()
    state[task.system.rows] = y
    point = dict(zip(task.system.inputs, (*state, t), strict=True))
    return float(task.system.graph.evaluate([task.system.hamiltonian], point, FLOAT64)[0])


def _steps_of_one(motion: Trajectory) -> float:
    """Return the steps of one orbit; those of many that choose their own are counted together."""
    together = motion.y.ndim == 3 and not motion.method.engine.takes_step
    return motion.steps / motion.y.shape[2] if together else motion.steps


def _way(motion: Trajectory) -> str:
    step = "" if motion.step is None else f", step {motion.step:.4g}"
    return f"{motion.method}{step}, {motion.precision}"
