"""Error series of a motion: times, what should stay constant and does not, and what rounding alone would do to it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.expression.graph.number_systems import FLOAT64
from canon.flow.method.number_formats import unit_round_off
from canon.study.motion.observables import ENERGY, Observable

if TYPE_CHECKING:
    from canon.array import Array
    from canon.flow.task import Task
    from canon.flow.trajectory import Trajectory
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["ErrorSeries", "error_series", "series_of_parts"]

FAR_ABOVE = 1e3
"""A tolerance so many times above the unit of rounding makes truncation the larger error of a step."""

BY_AN_EVENT = 1e-6
"""A change of the energy by more than this part of it is no rounding of an event's place."""

LOOKED_AT = 64
"""States of a motion at which the size of H's terms is looked at."""


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
        the number of steps, times the size of the terms in which the quantity is linear, Σ|y ∂I/∂y|; None where it is
        not known, as of a quantity that begins at zero.
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
    t: Array, change: Array, unit: float, steps: int, precision: str, *, relative: bool
) -> ErrorSeries:
    """Return the error series of a run whose samples alone were kept, part by part.

    Parameters
    ----------
    t, change
        Times since the start, and changes since then, shape (times,).
    unit
        What the changes are divided by.
    steps, precision
        Of the run.
    relative
        Whether the error is relative; what rounding does to another is not known.
    """
    error, u = change / unit, unit_round_off(precision)
    walk = u * math.sqrt(steps) if relative else None
    return ErrorSeries(t, error, float(np.abs(error).max()), walk, u * steps, u, relative=relative)


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
        its error, which is else its size at the start.
    orbit
        Which of many orbits.

    Raises
    ------
    ValueError
        H depends on t or events have changed it, so that its change is no error; there is no such observable; or the
        motion has many orbits and none is chosen.

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
    change, at_start = _followed(motion, name)
    many = motion.y.ndim == 3
    if many and orbit is None:
        raise ValueError(
            f"the motion has {motion.y.shape[2]} orbits: say which one to judge, orbit=0 … {motion.y.shape[2] - 1}"
        )
    chosen = slice(None) if orbit is None or not many else orbit
    unit, relative = _unit(motion, observable, abs(float(np.atleast_1d(at_start)[orbit or 0])))
    t, error = abs(motion.t - motion.t[0]), change[:, chosen] / unit if many else change / unit
    largest = float(np.abs(error).max())
    if name in motion.statistics:
        seen = motion.statistics[name]
        mean, size = (part[:, chosen] if many else part for part in (seen.mean, seen.largest))
        t, error, largest = (t[1:] + t[:-1]) / 2.0, mean / unit, float(size.max()) / unit
    u = unit_round_off(motion.precision)
    terms = _sizes_of_terms(motion, orbit or 0) / unit if name == ENERGY else np.zeros(1)
    least = 1.0 if relative else 0.0
    steps = _steps_of_one(motion)
    walk = u * math.sqrt(steps) * max(least, float(np.sqrt(np.mean(terms**2))))
    bias = u * steps * max(least, float(np.mean(terms)))
    tolerance = motion.method.tolerance
    truncated = tolerance is not None and tolerance > FAR_ABOVE * u
    size = _size(terms, relative=relative)
    return ErrorSeries(
        t, error, largest, walk or None, bias, u * size, truncated, _way(motion), relative, size
    )


def _followed(motion: Trajectory, observable: str) -> tuple[Array, Array]:
    """Return the changes of a quantity since the start, and its value there."""
    if observable == ENERGY:
        if motion.record.moving is None and not motion.autonomous:
            raise ValueError(
                "H depends on t, so its change is no error; drift_study(system, …) follows the energy less the work "
                "done from outside, or name an observable that should stay constant"
            )
        _check_events(motion)
        return motion.energy_defect, motion.energy[0]
    if observable not in motion.changes:
        known = ", ".join((ENERGY, *motion.changes))
        raise ValueError(
            f"the motion has not followed {observable!r}, only {known}: propagate(…, observables={{{observable!r}: …}})"
        )
    return motion.changes[observable], motion.observables[observable][0]


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


def _unit(motion: Trajectory, observable: str | Observable, at_start: float) -> tuple[float, bool]:
    """Return what changes are divided by, and whether that makes them relative."""
    name = observable if isinstance(observable, str) else observable.name
    if isinstance(observable, Observable) and name != ENERGY:
        return observable.unit, observable.relative
    relative = motion.relative if name == ENERGY else at_start != 0.0
    return at_start if relative else 1.0, relative


def _size(terms: Array, *, relative: bool) -> float:
    """Return what errors that are not relative are large beside, 1 of those that are."""
    return 1.0 if relative else float(np.mean(terms)) or 1.0


def _steps_of_one(motion: Trajectory) -> float:
    """Return the steps of one orbit; those of many that choose their own are counted together."""
    together = motion.y.ndim == 3 and not motion.method.engine.takes_step
    return motion.steps / motion.y.shape[2] if together else motion.steps


def _sizes_of_terms(motion: Trajectory, orbit: int) -> Array:
    """Return Σ|y ∂H/∂y| at some states: what rounding each y by a part u of it does to H, in parts of u.

    Where forces do work, H is the energy less the work W, which is one of the y: it is rounded as they are.
    """
    system, moving, whole = motion.record.task.system, motion.record.moving, motion.record.whole.y
    works = moving is not None and moving.work is not None
    if system.varying > works:
        return np.zeros(1)  # parameters vary from orbit to orbit, and are no part of y
    places = np.unique(np.linspace(0, len(motion.t) - 1, LOOKED_AT).astype(int))
    states = whole[:, places, orbit] if whole.ndim == 3 else whole[:, places]
    point = dict(zip(system.inputs, (*states, motion.t[places]), strict=True))
    slopes = system.graph.evaluate(_slopes_of_energy(system), point, FLOAT64)
    terms = [np.abs(y * np.asarray(slope)) for y, slope in zip(states, slopes, strict=True)]
    return np.sum(terms, axis=0)


def _slopes_of_energy(system: HamiltonEquations) -> tuple[int, ...]:
    """Return the nodes of ∂H/∂y but for signs; Hamilton's equations have them."""
    if system.canonical:
        return (*system.force, *system.velocity)
    return tuple(system.graph.gradient(system.hamiltonian, (*system.q, *system.p)))


def _way(motion: Trajectory) -> str:
    step = "" if motion.step is None else f", step {motion.step:.4g}"
    return f"{motion.method}{step}, {motion.precision}"
