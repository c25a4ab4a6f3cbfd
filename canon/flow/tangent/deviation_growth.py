"""Growth of deviations along a motion: logarithms of lengths at samples, from whatever engine carries the vectors."""

from __future__ import annotations

import os
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.graph.number_systems import FLOAT64
from canon.flow.checked_request import two_ends
from canon.flow.fixed_step.advance import Interruption
from canon.flow.kinked.place import Place
from canon.flow.kinked.regimes import kinks_of
from canon.flow.kinked.saltation import jumps_near
from canon.flow.request import Request
from canon.flow.run.values_at_states import energy_and_rates, size_of_energy
from canon.flow.system_request import any_task, refuse_contacts
from canon.flow.tangent.compiled_deviations import CompiledDeviations
from canon.flow.tangent.growth_without_chaos import rests_or_is_linear
from canon.flow.tangent.tangent_loop import has_tangent_loop
from canon.flow.tangent.variational_deviations import VariationalDeviations
from canon.kernel.llvm.number_types import DOUBLE
from canon.progress import reporting

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from fractions import Fraction

    from sympy import Symbol

    from canon.array import Array
    from canon.flow.method.method_text import MethodGiven
    from canon.flow.task import Task

__all__ = [
    "LEAST_SAMPLES",
    "DeviationGrowth",
    "DeviationRun",
    "check_jumps",
    "deviation_growth",
    "deviation_task",
]


@dataclass(frozen=True)
class DeviationGrowth:
    """How deviations have grown along orbits.

    Parameters
    ----------
    t
        Times, shape (times,), as spans from the start: they rise in either direction of time.
    log
        ln of how each vector has grown since the start, shape (vectors, times, orbits).
    noted
        What was noted of the vectors at each time, shape (times, orbits), or None.
    states
        The last states, shape (2n, orbits).
    left_at
        When each orbit left the finite numbers, shape (orbits,); infinite of those that did not.
    single
        Whether one state was given rather than several.
    method
        What carried the motion, in words.
    energy_error
        How much H has changed at the end, as part of it or of a tenth of its terms, shape (orbits,); 0 where H is no
        constant.
    without_chaos
        Whether an orbit rests, or its system is linear, so that exponential growth is no chaos, shape (orbits,).
    """

    t: Array
    log: Array
    noted: Array | None
    states: Array
    left_at: Array
    single: bool
    method: str
    energy_error: Array
    without_chaos: Array


@dataclass(frozen=True)
class DeviationRun:
    """What the indicators have in common: the arguments of a motion and of its deviations.

    Parameters are those of :func:`canon.flow.chaos.lyapunov.lyapunov_spectrum`.
    """

    system: Any
    t_span: Any
    y0: Any
    method: MethodGiven | None
    step: float | None
    tolerance: float | None
    precision: str | int | None
    parameters: Mapping[Symbol | str, Any] | None
    samples: int | None
    progress: Callable[[float], None] | bool | None


LEAST_SAMPLES = 32
"""Samples below which there is no verdict."""

_CARRIED = (
    "splitting", "solvable", "gauss", "average_vector_field", "rk4", "magnetic", "lie_poisson", "taylor", "dop853",
)  # fmt: skip
"""Families of methods that carry deviations: their steps commute with differentiation."""

_SPREAD, _GOLDEN = 0.8, 0.6180339887498949
"""How far times are moved from even ones, in parts of their distance, by multiples of the golden ratio."""

_SAMPLES, _OF_MANY = 1000, 100
"""Samples of one orbit, and of each of many."""


def deviation_task(run: DeviationRun) -> Task:
    """Return the task of a run whose motion deviations are to follow.

    Raises
    ------
    TypeError, KeyError, ValueError
        As :func:`canon.propagate` documents them; or the system has contacts, or the method has no tangent map here.
    """
    many = np.ndim(run.y0) == 2 or any(np.ndim(value) for value in (run.parameters or {}).values())
    samples = (_OF_MANY if many else _SAMPLES) if run.samples is None else run.samples
    request = Request(
        run.system, run.t_span, run.y0, method=run.method, step=run.step, tolerance=run.tolerance,
        precision=run.precision, parameters=run.parameters,
        times=_uneven(two_ends(run.t_span), samples),
    )  # fmt: skip
    task, moving = any_task(request)
    refuse_contacts(moving, "a tangent map")
    if moving is not None and (moving.residuals or moving.work is not None or task.system.varying):
        raise ValueError(
            "deviations here are those of a Hamiltonian, or of a vector field whose variables are free: make a "
            "Hamiltonian of the system, hamiltonian(L), in coordinates that keep its constraints; of one with forces "
            "write the equations of first order, VectorField([v, force/m], [q, v])"
        )
    if task.system.spare and task.system.lie_poisson is None:
        raise ValueError(
            "an odd number of variables: deviations here are those of an even one, as of (q, p); to a vector field add "
            "one that rests, VectorField([…, 0], [x, y, z, rest]), whose exponent is 0, and a rotating body goes by "
            "LiePoissonSplitting()"
        )
    if task.method.family not in _CARRIED:
        raise ValueError(
            f"{task.method} carries no deviations here: take a splitting of T + V, Splitting('kahan-li-8'), Gauss(6) "
            "or Taylor()"
        )
    check_jumps(task)
    return task


def check_jumps(task: Task) -> None:
    """Refuse steps of one size over jumps of the force: deviations jump there too, by which motion may be chaotic.

    Raises
    ------
    ValueError
        Where there are such.
    """
    kinks = kinks_of(task.system)
    if kinks is None or task.system.kicked or not task.method.engine.takes_step:
        return
    high, low = (part[:, 0] for part in task.states)
    jumps = jumps_near(kinks, Place(DOUBLE, float(task.plan.start), high, low))
    if jumps:
        where = ", ".join(f"{task.system.graph.to_sympy(kinks.functions[k])} = 0" for k in jumps[:4])
        raise ValueError(
            f"{task.method} does not see how deviations jump with the force at {where}, by which alone motion may be "
            "chaotic: take Taylor() or DOP853()"
        )


def _uneven(ends: tuple[Fraction, Fraction], samples: int) -> Array:
    """Return times at which to keep the growth, unevenly spaced: a period near their distance would beat with it.

    Raises
    ------
    ValueError
        There are fewer than a verdict takes.
    """
    if not LEAST_SAMPLES <= samples < np.inf or samples != int(samples):
        raise ValueError(f"samples={samples}: a verdict takes at least {LEAST_SAMPLES}, better 100 or more")
    k = np.arange(1, int(samples))
    shifts = _SPREAD * ((k * _GOLDEN) % 1.0 - 0.5)
    first, last = map(float, ends)
    return first + (last - first) * np.append(k + shifts, samples) / samples


def deviation_growth(
    task: Task,
    frame: Array,
    *,
    orthogonal: bool,
    note: Callable[[Array], Array] | None = None,
    given: bool = False,
    progress: Callable[[float], None] | bool | None = None,
) -> DeviationGrowth:
    """Return how deviations grow along the motion of a task.

    Parameters
    ----------
    task
        The motion.
    frame
        The deviations at the start, shape (2n, vectors).
    orthogonal
        Whether they are kept orthonormal.
    note
        What to note of the deviations at each sample, from shape (2n, vectors, orbits) to (orbits,).
    given
        Whether the frame is of (q, p), rather than of the coordinates that lengths are measured in.
    progress
        As :func:`canon.propagate` takes it.

    Raises
    ------
    NonFiniteStateError
        The only orbit has left the finite numbers.
    """
    count = task.states[0].shape[1]
    parts = np.array_split(np.arange(count), min(os.cpu_count() or 1, -(-count // _LEAST)))
    made = CompiledDeviations if has_tangent_loop(task.method) else VariationalDeviations
    # One after the other, so that a loop is compiled once.
    going = [made(task, frame, orthogonal=orthogonal, orbits=orbits, given=given) for orbits in parts]
    done, stopped = [0.0] * len(parts), threading.Event()
    with reporting(progress) as report:

        def part(k: int) -> tuple[Array, Array | None, Array]:
            def told(fraction: float) -> None:
                if stopped.is_set():
                    raise Interruption
                done[k] = fraction
                report(min(done))

            return _followed(going[k], len(task.plan.instants), note, told)

        if len(parts) == 1:
            found = [part(0)]
        else:
            with ThreadPoolExecutor(len(parts)) as pool:
                try:
                    found = list(pool.map(part, range(len(parts))))
                finally:
                    stopped.set()
    log = np.concatenate([each[0] for each in found], axis=2)
    noted = (
        None if note is None else np.concatenate([each[1] for each in found if each[1] is not None], axis=1)
    )
    t = np.abs(task.plan.instants - task.plan.instants[0])
    lost = ~np.isfinite(log).all(axis=0)
    left_at = np.where(lost.any(axis=0), t[np.argmax(lost, axis=0)], np.inf)
    states = np.concatenate([each[2] for each in found], axis=1)
    error, plain = _energy_error(task, states), rests_or_is_linear(task)
    return DeviationGrowth(t, log, noted, states, left_at, task.single, str(task.method), error, plain)


def _energy_error(task: Task, last: Array) -> Array:
    system, first = task.system, task.states[0]
    unseen = system.varying and not system.canonical
    of_one_kind = system.autonomous and not (system.kicked or system.spare or unseen)
    if not of_one_kind or system.graph.is_constant(system.hamiltonian):
        return np.zeros(first.shape[1])
    begin, end = (float(task.plan.instants[k]) for k in (0, -1))
    moved, last = last, first.copy()  # parameters by orbit stay what they are
    last[system.rows] = moved[: len(system.rows)] if len(moved) < len(last) else moved[system.rows]
    with np.errstate(all="ignore"):
        before, after = (
            np.asarray(energy_and_rates(system, states, t, FLOAT64)[0])
            for states, t in ((first, begin), (last, end))
        )
        times = np.array([begin, end])
        sizes = size_of_energy(system, np.stack([first, last], axis=1), times)
        size = np.max([np.abs(before), _SHARE * sizes.min(axis=0), _RESOLVED * sizes.max(axis=0)], axis=0)
        return np.nan_to_num(np.abs(after - before) / size) * np.ones(first.shape[1])


_SHARE = 0.1
"""Where H is smaller than this part of its terms, they say what is large."""

_RESOLVED = 1e-6
"""Of terms that cancel nothing finer is looked at."""

_LEAST = 64
"""Orbits that are worth a thread."""


def _followed(
    going: CompiledDeviations | VariationalDeviations,
    samples: int,
    note: Callable[[Array], Array] | None,
    progress: Callable[[float], None],
) -> tuple[Array, Array | None, Array]:
    """Return logarithms, what was noted, and the last states of some orbits."""
    _, vectors, orbits = going.vectors().shape
    log, lack = np.zeros((vectors, samples, orbits)), np.zeros((vectors, orbits))
    noted = None if note is None else np.empty((samples, orbits))
    if noted is not None and note is not None:
        noted[0] = note(going.vectors())
    for k in range(1, samples):
        # Kahan's sum: what the total lacks is added with the next growth.
        new = going.advance() + lack
        log[:, k] = log[:, k - 1] + new
        lack = new - (log[:, k] - log[:, k - 1])
        if noted is not None and note is not None:
            noted[k] = note(going.vectors())
        progress(k / (samples - 1))
    return log, noted, going.states()
