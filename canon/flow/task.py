"""Tasks: what to integrate, with which method, and what to keep of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.method.number_formats import fixed_precision
from canon.flow.run.sampling_plan import sampling

if TYPE_CHECKING:
    from fractions import Fraction

    import numpy.typing as npt

    from canon.array import Array
    from canon.flow.method.method import Method
    from canon.flow.run.event import Event
    from canon.flow.run.samples import Samples
    from canon.flow.run.sampling_plan import Plan
    from canon.flow.transformed.extended_hamiltonian import ExtendedSystem
    from canon.kernel.program.hamilton_equations import HamiltonEquations
    from canon.kernel.program.repeated.repeated_terms import KeptFunction

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
    names, observed
        The observables, H aside: nodes of the system's graph, or sums where H is kept as such.
    cadence, events, dense
        As :func:`canon.flow.propagation.propagate` takes them.
    fictitious
        Of a time-transformed method: what the motion in the fictitious time needs.
    max_step
        The longest step of an adaptive method.
    """

    system: HamiltonEquations
    method: Method
    precision: str | int | None
    states: tuple[Array, Array]
    single: bool
    plan: Plan
    names: tuple[str, ...]
    observed: tuple[int | KeptFunction, ...]
    cadence: int | None
    events: tuple[Event, ...]
    dense: bool
    fictitious: ExtendedSystem | None = None
    max_step: float | None = None

    def arrived(self, found: Samples) -> bool:
        """Return whether samples reach to the end of what was to be done."""
        if found.each:
            return all(map(self.arrived, found.each))
        if self.fictitious is not None:
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
        plan = self.plan
        if self.plan.wanted:  # its instants were not known before
            plan = replace(plan, instants=found.t, wanted=0)
        last = plan.last(len(found.t) - 1)
        if self.plan.wanted and times is None:
            more = sampling((last, end), self.plan.wanted if samples is None else samples, None)
            ends = plan.continued(replace(more, samples=1)).instants[[0, -1]]
            return replace(self, plan=replace(plan, instants=ends, wanted=more.samples))
        if samples is None and times is None:
            density = (len(found.t) - 1) / abs(found.t[-1] - found.t[0])
            samples = max(1, round(density * abs(float(end - last))))
        return replace(self, plan=plan.continued(sampling((last, end), samples, times)))

    @property
    def precision_name(self) -> str:
        """The precision's keyword."""
        if self.method.engine.takes_step:
            return fixed_precision(self.precision).name
        return str(self.precision or self.method.engine.usual_precision)

    def ended(self, found: Samples) -> Task:
        """Return the task with the instants that are known only now, where an event has ended a motion."""
        if not self.plan.wanted or not found.crossings or found.crossings[-1].event.action != "stop":
            return self
        instants = np.append(found.t, self.plan.instants[-1])
        return replace(self, plan=replace(self.plan, instants=instants, wanted=0))
