"""Error estimate of a computed motion: its distance from a more exact companion run, and how errors grow.

A method of fixed steps is repeated with half the step in wider numbers; every other one, and one that may have passed
over a pulse or a bump or has passed kinks, is compared with Taylor's method in wider numbers. The difference is the
motion's error, but for what the companion itself errs: a third of it for a method of order 2, less for higher ones. A
second companion starts a little beside the first; how their distance grows says what becomes of every error, of the
start's as of each step's. In a chaotic motion it grows like exp(t/τ) until the two have nothing to do with each other;
from there on no single trajectory means anything, however it is computed, and only averages may.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from canon.display import preformatted
from canon.expression.symbols.user_input import counted
from canon.flow.estimate.companion import BESIDE, companion_tasks, companions
from canon.flow.run.observables_along import energy_rounding, jumped
from canon.flow.run.running_error import rounding_of_rates, sizes_of_rates

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy.typing as npt

    from canon.array import Array
    from canon.flow.run.samples import Samples
    from canon.flow.task import Task
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["ErrorEstimate", "chosen_orbits", "error_estimate"]

_SAFETY = 2.0
"""The error is stated so many times larger than it was found: the companion errs too."""

_SMALLEST_PART = 1e-10
"""A coordinate or momentum smaller than this part of the largest one is measured by that part."""

_MEANINGLESS = 0.1
"""A motion that errs by this part of its size is not the system's."""

_CHAOTIC = math.log(100.0)
"""Growth by less than 100 in the latter half of the time may be that of a regular motion, a power of time."""

_OFTEN = 4
"""Of the latter six eighths of the time so many have growth where it is chaotic; it may pause in the others."""

_RADIANS = 100.0
"""More than a step of Taylor's method passes: about 5 in doubles, 20 in numbers of 50 digits."""

_FEWEST = 8
"""Samples from which growth is judged."""


@dataclass(frozen=True, eq=False)
class ErrorEstimate:
    """What is known of the error of a motion at its samples.

    Parameters
    ----------
    t
        Sample times, shape (times,).
    error
        A bound, not proved, for the size of y's error up to each sample, in the units of y; inf where nothing is
        known. The shape of y.
    relative
        The largest of the errors of a state, each in parts of the largest size that its coordinate or momentum has on
        the way; shape (times,) or (times, orbits).
    condition
        How many times larger a small change of the start has become, at most, up to each sample; NaN where the motion
        has events, or its neighbour leaves H's domain. The shape of ``relative``.
    events
        Bounds for the errors of the events' times, in their order; inf for one that the companion does not meet.
    companion
        What the motion was compared with.
    """

    t: Array
    error: Array
    relative: Array
    condition: Array
    events: Array
    companion: str

    @property
    def digits(self) -> Array:
        """Correct decimal digits left at each sample, 0 … 17."""
        with np.errstate(divide="ignore"):
            return np.clip(-np.log10(self.relative), 0.0, 17.0)

    @property
    def digits_lost(self) -> Array:
        """Decimal digits that the motion itself takes from every number on the way: log₁₀ of the condition."""
        return np.log10(np.maximum(self.condition, 1.0))

    @property
    def meaningful_until(self) -> float | None:
        """The first sample time at which the error is a tenth of the motion's size (of any orbit); None: never."""
        wrong = (self.relative > _MEANINGLESS).reshape(len(self.t), -1).any(axis=1)
        return float(self.t[np.argmax(wrong)]) if wrong.any() else None

    @property
    def lyapunov_time(self) -> float | None:
        """In how long a time errors grow e-fold where they grow exponentially (the fastest orbit); None where not.

        By the least squares line of log(condition) over time until the neighbours have nothing to do with each other.
        """
        columns = self.condition.reshape(len(self.t), -1).T
        found = [x for x in (_e_folding(abs(self.t - self.t[0]), c) for c in columns) if x is not None]
        return min(found) if found else None

    def __repr__(self) -> str:
        return f"<ErrorEstimate: {self._sentences[0]}>"

    def __str__(self) -> str:
        return "; ".join(self._sentences)

    def _repr_html_(self) -> str:
        return preformatted("\n".join(self._sentences))

    @property
    def _sentences(self) -> list[str]:
        worst = float(np.max(self.relative))
        said = [f"relative error up to {worst:.1e} ({-math.log10(worst):.1f} digits)" if 0 < worst < 1 else
                f"relative error up to {worst:.1e}"]  # fmt: skip
        if np.isfinite(self.condition).any():
            said.append(f"small changes grow up to {np.nanmax(self.condition):.1e}-fold")
        if (tau := self.lyapunov_time) is not None:
            said.append(f"e-fold in {tau:.3g} units of time (unstable)")
        if (until := self.meaningful_until) is not None:
            said.append(f"after t = {until:.6g} this single trajectory means nothing")
        return [*said, f"by {self.companion}"]


def error_estimate(
    task: Task, samples: Samples, energy_change: Array, orbits: Sequence[int] | None = None
) -> ErrorEstimate:
    """Return the error of a motion by a companion run; see :meth:`canon.flow.Trajectory.error_estimate`.

    Parameters
    ----------
    task, samples
        What was to be done, and what came out in full.
    energy_change
        H − H(start) at the samples, shape (times,) or (times, orbits).
    orbits
        Which orbits of many to estimate (:func:`chosen_orbits`).

    Raises
    ------
    ValueError
        The motion is that of a map.
    """
    if task.system.kicked:
        raise ValueError(
            "a map has no step that could be made smaller; iterate it in wider numbers and compare, "
            "precision='double-double'"
        )
    single = task.single
    chosen = list(range(samples.y.shape[2])) if orbits is None else list(orbits)
    rows = task.system.rows
    own = samples.y[rows][:, :, chosen]
    scale = _sizes(own)
    states = (task.states[0][:, chosen], task.states[1][:, chosen])
    task = replace(task, states=states, single=False, cadence=None, dense=False)
    away, apart, found, words = np.full(own.shape, np.inf), np.full(own.shape, np.nan), None, "no companion"
    for better in companion_tasks(task, samples):
        made, known = companions(better, samples, own, scale)
        if made is None:
            continue
        before, found, words = found, made, better.words
        away, (apart, rounded) = _compared(own, made.y[rows][:, :known], made.carried[rows][:, :known])
        its_own = np.where(np.isnan(rounded), scale * better.unit, rounded)
        its_own = its_own * _cancelled(task.system, made, scale) + np.minimum(
            better.truncation(scale, made.y[rows]), _between(task.system, made, before, scale)
        )
        at_rest = (own == 0).all(axis=1) & (away[:, -1] <= np.spacing(0.0))
        told = ((its_own[:, -1] <= away[:, -1]) | at_rest).all()
        away = away + its_own
        if told:
            break
    judged = task.system.autonomous and task.system.canonical
    if judged and not any(met.after is not None for met in samples.crossings):
        change = energy_change.reshape(len(samples.t), -1)[:, chosen]
        deluded = _contradicted_by_energy(
            task.system,
            task.precision_name,
            replace(samples, y=samples.y[:, :, chosen]),
            change,
            away / scale,
            scale,
        )
        away = np.where(np.maximum.accumulate(deluded, axis=0), np.inf, away)
    if task.plan.h is not None:  # its states are those of exact times, which t has rounded
        rates = sizes_of_rates(task.system, samples.t, samples.y[:, :, chosen])
        away = (away + rates * np.spacing(abs(samples.t))[:, np.newaxis]).astype(np.float64)
    relative = (away / scale).max(axis=0)
    condition = _growth(apart / scale)
    if single:
        away, relative, condition = away[:, :, 0], relative[:, 0], condition[:, 0]
    events = _event_errors(samples, found)
    return ErrorEstimate(samples.t, away, relative, condition, events, words)


def chosen_orbits(orbits: Sequence[int], many: int) -> list[int]:
    """Return which of many orbits are meant.

    Raises
    ------
    ValueError
        There is no orbit of a number, or the list is empty.
    """
    chosen = list(orbits)
    if not chosen or any(each not in range(many) for each in chosen):
        raise ValueError(
            f"orbits={chosen}: the motion has {counted(many, 'orbit')}, counted from 0; choose some of 0 … {many - 1}"
        )
    return chosen


def _contradicted_by_energy(
    system: HamiltonEquations, precision: str, samples: Samples, change: Array, relative: Array, scale: Array
) -> npt.NDArray[np.bool_]:
    """Return where the energy's error shows that a motion errs by more than it differs from its companion.

    Both may have jumped over the same singularity. An error of size ε in parts of the motion's size changes H by no
    more than ε Σ |∂H/∂y| · size, to first order; beside that stands the rounding of H itself, which is large where slow
    bodies have rest energies.
    """
    slopes = np.roll(sizes_of_rates(system, samples.t, samples.y), len(scale) // 2, axis=0)
    reach = (slopes * scale).sum(axis=0)
    unseen = energy_rounding(system, samples, precision)
    return jumped(system, samples, change) | (abs(change) > relative.max(axis=0) * reach + unseen)


def _cancelled(system: HamiltonEquations, samples: Samples, scale: Array) -> Array:
    """Return how many times more a step's rates are rounded than its states, shape (orbits,); 1 where they are not.

    What rounding does to states is known from a neighbour that starts so far beside the motion. Rates whose terms
    cancel are rounded by more, in parts of the motion's size. Steps are as long as on average, or shorter where rates
    are large: there a step passes no more than some radians of the fastest motion.
    """
    orbits = scale.shape[2]
    y = samples.y[:, :, :orbits]
    rounding = rounding_of_rates(system, samples.t, y)
    average = abs(samples.t[-1] - samples.t[0]) * samples.y.shape[2] / max(1, samples.steps)
    with np.errstate(all="ignore"):
        sizes = np.asarray(sizes_of_rates(system, samples.t, y).max(axis=0), dtype=float)
        fastest = sizes / scale.max(axis=0)
        step = np.fmin(average, _RADIANS / fastest)
        more = (rounding * step / scale).max(axis=(0, 1))
    return np.where(np.isfinite(more), np.maximum(more, 1.0), 1.0)


def _compared(own: Array, y: Array, rest: Array) -> tuple[Array, list[Array]]:
    """Return how far a motion is from its companion so far, and how far that is from both its neighbours."""
    m = own.shape[2]
    away, apart = np.full(own.shape, np.inf), [np.full(own.shape, np.nan), np.full(own.shape, np.nan)]
    known = y.shape[1]
    missed = abs((own[:, :known] - y[:, :, :m]) - rest[:, :, :m])
    away[:, :known] = _SAFETY * np.maximum.accumulate(missed, axis=1) + np.spacing(abs(own[:, :known]))
    for each, begin in zip(apart, range(m, y.shape[2], m), strict=False):
        beside = slice(begin, begin + m)
        distance = (y[:, :, beside] - y[:, :, :m]) + (rest[:, :, beside] - rest[:, :, :m])
        each[:, :known] = np.maximum.accumulate(abs(distance), axis=1)
    return away, apart


def _between(system: HamiltonEquations, made: Samples, before: Samples | None, scale: Array) -> Array:
    """Return how far a companion is from a less exact one, which errs by more, shape (2n, 1, orbits)."""
    if before is None:
        return np.full_like(scale, np.inf)
    known, m = min(len(made.t), len(before.t)), scale.shape[2]
    parts = [(each.y[:, :known, :m], each.carried[:, :known, :m]) for each in (made, before)]
    distance = (parts[0][0] - parts[1][0]) + (parts[0][1] - parts[1][1])
    return abs(distance[system.rows]).max(axis=1, keepdims=True)


def _growth(apart: Array) -> Array:
    """Return how many times larger a distance has become; NaN where it was none, as between the smallest numbers."""
    largest = apart.max(axis=0)
    at_start = np.broadcast_to(largest[0], largest.shape)
    return np.divide(largest, at_start, out=np.full(largest.shape, np.nan), where=at_start > 0)


def _sizes(y: Array) -> Array:
    """Return what each coordinate and momentum is measured by, shape (2n, 1, orbits)."""
    largest = abs(y).max(axis=1, keepdims=True)
    halves = np.array_split(largest, 2)
    blocks = np.concatenate([np.broadcast_to(half.max(axis=0), half.shape) for half in halves])
    sizes = np.maximum(largest, _SMALLEST_PART * blocks)
    return np.where(sizes > 0, sizes, 1.0)


def _event_errors(samples: Samples, found: Samples | None) -> Array:
    errors = np.full(len(samples.crossings), np.inf)
    for k, (mine, other) in enumerate(
        zip(samples.crossings, () if found is None else found.crossings, strict=False)
    ):
        if mine.event is not other.event:
            break
        errors[k] = _SAFETY * abs(mine.t - other.t) + float(np.spacing(abs(mine.t)))
    return errors


def _e_folding(t: Array, condition: Array) -> float | None:
    """Return τ where a condition grows like exp(t/τ) rather than like a power of t.

    A power of t grows by a small factor in the latter half of the time, exp(t/τ) as in the former half.
    """
    used = np.isfinite(condition) & (condition < _MEANINGLESS / BESIDE / 10)
    if used.sum() < _FEWEST:
        return None
    times, logarithm = t[used], np.log(condition[used])
    growth = np.diff(np.interp(times[-1] * np.arange(9) / 8, times, logarithm))
    # A power of t grows in the first quarter of the time, a single close encounter in one or two of the eighths.
    often = (growth[2:] >= logarithm[-1] / 24).sum()
    if growth[4:].sum() < _CHAOTIC or often < _OFTEN:
        return None
    return float(1 / np.polyfit(times, logarithm, 1)[0])
