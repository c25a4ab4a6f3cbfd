"""One run as a value: what to integrate, how, and what to keep; carried out, interrupted, resumed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.adaptive.dop853 import dop853_motion
from canon.flow.adaptive.taylor_motion import taylor_motion
from canon.flow.fixed_step.compiled_loop import compiled_loop
from canon.flow.fixed_step.fixed_steps import fixed_steps
from canon.flow.fixed_step.statistics import watch_for
from canon.flow.method.method import DOP853, FixedStep, Method, Taylor, TimeTransformed
from canon.flow.method.number_formats import fixed_precision
from canon.flow.run.event import Event, prepared
from canon.flow.run.observables_along import measured, warn_of_jumps
from canon.flow.run.sampling_plan import sampling
from canon.flow.trajectory import Array, Interrupted, Samples, Statistics, Trajectory, joined
from canon.flow.transformed.transformed_motion import transformed_motion

if TYPE_CHECKING:
    from collections.abc import Callable
    from fractions import Fraction

    import numpy.typing as npt

    from canon.flow.run.sampling_plan import Plan
    from canon.flow.transformed.extended_hamiltonian import Fictitious
    from canon.kernel.program.hamilton_equations import Equations

__all__ = ["Task"]


@dataclass(frozen=True, eq=False)
class Task:
    """What a run is to do.

    Parameters
    ----------
    system, method, precision
        What to integrate, how, and in which numbers.
    states
        The starting states as sums of two doubles, each of shape (2n, orbits), parameters that vary included.
    single
        Whether one state was given rather than several.
    plan
        Steps and sample times.
    names, nodes
        The observables; H, then they, on the system's graph.
    cadence, events, dense
        As :func:`canon.flow.propagate.propagate` takes them.
    fictitious
        Of a time-transformed method: what the motion in the fictitious time needs.
    """

    system: Equations
    method: Method
    precision: str | int | None
    states: tuple[Array, Array]
    single: bool
    plan: Plan
    names: tuple[str, ...]
    nodes: tuple[int, ...]
    cadence: int | None
    events: tuple[Event, ...]
    dense: bool
    fictitious: Fictitious | None = None

    def trajectory(self, progress: Callable[[float], None], so_far: Samples | None = None) -> Trajectory:
        """Carry the task out, from the start or from what was done before.

        Raises
        ------
        Interrupted
            Ctrl-C; the error has the motion as far as it came.
        NonFiniteStateError
            The motion can't be continued.
        """
        found = self._continued(progress, so_far)
        made = self._made(found)
        if not (self.arrived(found) or made.stopped):
            raise Interrupted(made)
        return made

    def arrived(self, found: Samples) -> bool:
        """Return whether samples reach to the end of what was to be done."""
        if isinstance(self.method, TimeTransformed):
            return found.beyond.arrived
        return len(found.t) == len(self.plan.instants)

    def until(self, end: Fraction, found: Samples, samples: int | None, times: npt.ArrayLike | None) -> Task:
        """Return the task that goes on from the last sample of this one to another end.

        Parameters
        ----------
        end
            The new last time.
        found
            What was done.
        samples, times
            When to keep the state on the new part; as densely as before where not given.

        Raises
        ------
        ValueError
            The end lies behind, or is not a whole number of fixed steps away.
        """
        plan, wanted = self.plan, samples or self.plan.wanted
        if self.plan.wanted:  # its instants were not known before
            plan = replace(plan, instants=found.t, wanted=0)
        last = plan.last(len(found.t) - 1)
        if self.plan.wanted and times is None:
            ends = plan.continued(sampling((last, end), 1, None)).instants[[0, -1]]
            return replace(self, plan=replace(plan, instants=ends, wanted=wanted))
        if samples is None and times is None:
            density = (len(found.t) - 1) / abs(found.t[-1] - found.t[0])
            samples = max(1, round(density * abs(float(end - last))))
        return replace(self, plan=plan.continued(sampling((last, end), samples, times)))

    def samples(self) -> Samples:
        """Carry the task out and return the states alone."""
        return self._continued(lambda _: None, None)

    def _continued(self, progress: Callable[[float], None], so_far: Samples | None) -> Samples:
        """Return all of the motion, what was done before included."""
        if isinstance(self.method, TimeTransformed):
            return transformed_motion(self, progress, so_far)
        return joined(so_far, self._more(progress, so_far))

    def _more(self, progress: Callable[[float], None], so_far: Samples | None) -> Samples:
        """Return the part of the motion that was not done before."""
        states = self.states if so_far is None else (so_far.y[:, -1], so_far.carried[:, -1])
        events, orbits = prepared(self.system, self.events), states[0].shape[1]
        if isinstance(self.method, FixedStep):
            loop = compiled_loop(self.system, self.method, fixed_precision(self.precision), orbits)
            watch = None
            if self.cadence is not None:
                t0 = self.plan.start
                watch = watch_for(self.system, self.nodes, loop, self.states, t0, self.cadence)
            return fixed_steps(
                self.system, loop, self.method, states, self.plan, progress, watch, so_far, events
            )
        if isinstance(self.method, DOP853):
            return dop853_motion(self.system, states[0], self.plan, self.method, progress, so_far)
        assert isinstance(self.method, Taylor)
        precision, dense = self.precision or "double", self.dense
        return taylor_motion(
            self.system, states, self.plan, self.method, precision, progress, so_far, events, dense=dense
        )

    @property
    def precision_name(self) -> str:
        """The precision's keyword."""
        if isinstance(self.method, Taylor | DOP853):
            return str(self.precision or "double")
        return fixed_precision(self.precision).name

    def _made(self, found: Samples) -> Trajectory:
        watched, kept = found.watched, found
        if self.single:
            watched = None if watched is None else watched[..., 0]
            found = replace(found, y=found.y[:, :, 0], carried=found.carried[:, :, 0])
        (energy, change), *rest = measured(self.system, self.nodes, found, self.precision_name)
        rows, names = self.system.rows, ("energy", *self.names)
        all_rows = len(rows) == len(found.y)
        changed = any(met.after is not None for met in found.crossings)
        if self.system.autonomous and not changed:
            warn_of_jumps(self.system, kept, change.reshape(len(change), -1))
        return Trajectory(
            t=found.t,
            y=found.y if all_rows else found.y[rows],
            carried=found.carried if all_rows else found.carried[rows],
            energy=energy,
            energy_change=change,
            method=self.method,
            precision=self.precision_name,
            step=found.step,
            steps=found.steps,
            evaluations=found.evaluations,
            cpu_seconds=found.cpu_seconds,
            compile_seconds=found.compile_seconds,
            autonomous=self.system.autonomous,
            observables=MappingProxyType(dict(zip(self.names, (value for value, _ in rest), strict=True))),
            changes=MappingProxyType(dict(zip(self.names, (each for _, each in rest), strict=True))),
            statistics=MappingProxyType(
                {} if watched is None else {k: Statistics(*v) for k, v in zip(names, watched, strict=True)}
            ),
            events=found.crossings,
            task=self._ended(found),
            samples=kept,
        )

    def _ended(self, found: Samples) -> Task:
        """Return the task with the instants that are known only now, where an event has ended a motion."""
        if not self.plan.wanted or not found.crossings or found.crossings[-1].event.action != "stop":
            return self
        instants = np.append(found.t, self.plan.instants[-1])
        return replace(self, plan=replace(self.plan, instants=instants, wanted=0))
