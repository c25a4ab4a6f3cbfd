"""Taylor stretches: orbits with deviations by one integrator of heyoka, from one renormalisation to the next."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.adaptive.taylor_events import TaylorEvents
from canon.flow.adaptive.taylor_orbit import orbits_of
from canon.flow.kinked.regimes import kinks_of

if TYPE_CHECKING:
    from canon.array import Array
    from canon.flow.method.method import Taylor
    from canon.flow.run.sampling_plan import Plan
    from canon.flow.task import Task
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["TaylorStretches"]


class TaylorStretches:
    """One integrator of a motion with its deviations, which goes on from any state and time.

    Parameters
    ----------
    task
        The motion, in doubles.
    larger
        Its equations with those of the deviations.
    method
        The method.
    """

    def __init__(self, task: Task, larger: HamiltonEquations, method: Taylor) -> None:
        self.rows, plan = task.system.rows, task.plan
        events = TaylorEvents(larger, (), "double", float, forward=plan.forward, unit=Fraction(1))
        start = np.zeros((2 * len(larger.q), 1))
        n, vectors = len(task.system.q), len(larger.q) // len(task.system.q)
        start.reshape(2, vectors, n)[:, 0] = task.states[0][:, 0].reshape(2, n)
        span = float(plan.instants[-1] - plan.instants[0])
        self.orbit = orbits_of(
            larger, (start, 0 * start), plan.last(0), method, float, events, span, task.max_step
        )[0]

    @classmethod
    def of(cls, task: Task, larger: HamiltonEquations) -> TaylorStretches | None:
        """Return it where the method is Taylor's in doubles and the system has no kinks, where motions are parted."""
        method: Any = task.method
        if (
            method.family != "taylor"
            or task.precision not in (None, "double")
            or kinks_of(task.system) is not None
        ):
            return None
        return cls(task, larger, method)

    def moved(self, high: Array, low: Array, plan: Plan) -> tuple[Array, Array]:
        """Return where a state high + low comes to along a plan, as such a sum, each of shape (2n,).

        Raises
        ------
        NonFiniteStateError
            The motion can't be continued.
        """
        own = self.orbit.integrator
        own.state[:] = high + low
        own.dtime = float(plan.instants[0]), 0.0
        made = self.orbit.advance(plan.instants, dense=False)
        if made.outcome is not None:
            raise self.orbit.lost(made.outcome, range(len(high)))
        return made.rows[-1].astype(np.float64), np.zeros_like(high)
