"""Courses: what a run is to do whatever its start, and the task that a start makes of it."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from canon.array import all_finite
from canon.expression.graph.number_systems import FLOAT64, LONGDOUBLE
from canon.flow.kinked.regimes import kinks_of
from canon.flow.method.engine import FIXED_STEPS
from canon.flow.run.event import prepared_events
from canon.flow.run.observables_along import AccuracyWarning, frames_of_canon
from canon.flow.run.range_check import check_magnitudes, is_narrow
from canon.flow.run.sampling_plan import Plan, Sampling, fictitious_plan
from canon.flow.run.values_at_states import energy_and_rates
from canon.flow.system.hamiltonian_map import DRIFT_AND_KICK, KICK_AND_DRIFT
from canon.flow.task import Task

if TYPE_CHECKING:
    from fractions import Fraction

    from canon.array import Array
    from canon.flow.method.method import Method
    from canon.flow.run.event import Event
    from canon.flow.transformed.extended_hamiltonian import ExtendedSystem
    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.repeated.repeated_terms import KeptFunction

__all__ = ["Course"]


@dataclass(frozen=True, eq=False)
class Course:
    """What a run is to do, whatever its start: all of a task that has been checked without one.

    Parameters
    ----------
    system, method, precision
        What to integrate, how, and in which numbers.
    ends, wanted, plan
        The first and the last time, when to keep the state, and the steps for that; None of a time-transformed method.
    names, observed
        The observables, H aside: nodes of the system's graph, or sums where H is kept as such.
    cadence, events, dense, max_step, fictitious
        As :class:`canon.flow.task.Task` has them.
    """

    system: HamiltonEquations
    method: Method
    precision: str | int | None
    ends: tuple[Fraction, Fraction]
    wanted: Sampling
    plan: Plan | None
    names: tuple[str, ...]
    observed: tuple[int | KeptFunction, ...]
    cadence: int | None
    events: tuple[Event, ...]
    dense: bool
    max_step: float | None
    fictitious: ExtendedSystem | None

    def task(self, states: tuple[Array, Array], *, single: bool) -> Task:
        """Return the task of starting states, sums of two doubles, each of shape (2n, orbits).

        Parameters
        ----------
        states
            Parameters that vary from orbit to orbit included.
        single
            Whether one state was given rather than several.

        Raises
        ------
        ValueError
            H or a rate is not finite there, or beyond what numbers hold; or an event is nothing for so many orbits.

        Warns
        -----
        AccuracyWarning
            Steps of one size pass over kinks.
        """
        rates = _rates_at_start(self.system, states, self.ends[0], self.precision)
        if is_narrow(self.precision):
            first = states[0][:, 0]
            check_magnitudes(self.system, first, rates, self.ends, self.method, self.precision)
        named = self.wanted.times is not None or not single
        task = Task(
            system=self.system,
            method=self.method,
            precision=self.precision,
            states=states,
            single=single,
            plan=self.plan or fictitious_plan(self.wanted, named=named),
            names=self.names,
            observed=self.observed,
            cadence=self.cadence,
            events=self.events,
            dense=self.dense,
            fictitious=self.fictitious,
            max_step=self.max_step,
        )
        _check_events(task)
        is_map = self.method in (KICK_AND_DRIFT, DRIFT_AND_KICK)
        kept = bool(self.system.sums)  # sums with kinks are written out
        if self.method.engine.takes_step and not is_map and not kept:
            _warn_of_kinks(self.system, self.method)
        return task


def _rates_at_start(
    system: HamiltonEquations, given: tuple[Array, Array], start: Fraction, precision: str | int | None
) -> Array:
    """Return the rates of change at the first state, and make sure that those at all states are finite."""
    states, low = given
    narrow = is_narrow(precision)
    whole = states if narrow else states.astype(np.longdouble) + low
    # Numbers are quicker than arrays of one number.
    point = whole[:, 0] if whole.shape[1] == 1 else whole
    arithmetic = FLOAT64 if narrow else LONGDOUBLE
    try:
        found = energy_and_rates(system, point, point.dtype.type(float(start)), arithmetic)
    except OverflowError as large:
        raise ValueError(
            "a constant or a parameter of H is beyond 1e308: choose other units; exponents with floats, which SymPy "
            "takes apart, exp(a + b*t) = exp(a)*exp(b*t), keep together with exact numbers, Rational(1, 1000)"
        ) from large
    if not (
        all_finite(np.array(found)) if states.shape[1] == 1 else all(map(all_finite, map(np.asarray, found)))
    ):
        finite = np.logical_and.reduce([np.isfinite(np.broadcast_to(x, states.shape[1:])) for x in found])
        wrong = states[system.rows, np.argmin(finite)]
        raise ValueError(
            f"H or its derivatives are not finite at y0 = {wrong}: start inside H's domain, in units "
            "in which no number on the way is beyond 1e±308"
        )
    if narrow and states.shape[1] == 1:
        return np.array(found[1:])
    with np.errstate(over="ignore"):  # wider numbers may be beyond doubles, which nobody looks at then
        return np.array([np.ravel(rate)[0] for rate in found[1:]], dtype=np.float64)


def _warn_of_kinks(system: HamiltonEquations, method: Method) -> None:
    """Warn where steps of one size pass over kinks."""
    kinks = kinks_of(system)
    if kinks is not None:
        where = ", ".join(f"{system.graph.to_sympy(g)} = 0" for g in kinks.functions[:4])
        warnings.warn(
            f"{method} steps over the kinks at {where}, where its order is lost; Taylor() and DOP853() stop there and "
            "go on beyond",
            AccuracyWarning,
            stacklevel=frames_of_canon(),
        )


def _check_events(task: Task) -> None:
    if task.dense and not task.method.engine.keeps_polynomials:
        if task.method.engine is FIXED_STEPS:
            raise ValueError(
                f"dense=True: leave it out: a motion by {task.method} can be asked at any time, motion(4.123), "
                "which takes shorter steps from a sample; only Taylor() has polynomials to keep"
            )
        raise ValueError(
            f"dense=True: {task.method} has no polynomials to keep; Taylor() has, or name the times, times=[…]"
        )
    if not task.events:
        return
    stops = [event for event in task.events if event.action == "stop"]
    if stops and task.states[0].shape[1] > 1:
        raise ValueError(
            f"the event {stops[0]} would stop each of many orbits at a time of its own, and their states are kept at "
            "common times: record it, action='record', or propagate the orbits one by one"
        )
    if task.cadence is not None:
        raise ValueError("events and cadence: statistics inside the loop do not see events; leave one out")
    prepared_events(task.system, task.events)
