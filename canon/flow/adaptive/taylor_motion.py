"""heyoka's Taylor method: orbits side by side, slices, samples, and the motion as a function of time."""

from __future__ import annotations

import contextlib
import os
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.adaptive.kinked_orbit import KinkedOrbit, kinked_orbits_of
from canon.flow.adaptive.spare_integrators import spare_integrators
from canon.flow.adaptive.state_unit import state_unit
from canon.flow.adaptive.taylor_events import TaylorEvents
from canon.flow.adaptive.taylor_orbit import Slice, TaylorOrbit, numbers_of, orbits_of
from canon.flow.kinked.regimes import kinks_of
from canon.flow.run.samples import Samples
from canon.kernel.heyoka_bridge import heyoka_doubles, heyoka_number

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Sequence

    from canon.array import Array
    from canon.flow.method.method import Taylor
    from canon.flow.run.event import PreparedEvent
    from canon.flow.run.sampling_plan import Plan
    from canon.kernel.program.hamilton_equations import HamiltonEquations

__all__ = ["Polynomials", "taylor_motion"]


def taylor_motion(
    system: HamiltonEquations,
    states: tuple[Array, Array],
    plan: Plan,
    method: Taylor,
    precision: str | int,
    progress: Callable[[float], None],
    so_far: Samples | None = None,
    events: Sequence[PreparedEvent] = (),
    *,
    dense: bool = False,
    max_step: float | None = None,
) -> Samples:
    """Integrate with heyoka, the orbits on threads, and evaluate the steps' own Taylor polynomials.

    Parameters
    ----------
    system, method, precision
        What to integrate and how.
    states
        The states to start from, as sums of two doubles, each of shape (2n, orbits).
    plan
        When to sample.
    progress
        Called between slices with the fraction done.
    so_far
        What was done before, where the motion is resumed.
    events
        Events, of one orbit.
    dense
        Whether to keep all polynomials.
    max_step
        The longest step.

    Raises
    ------
    NonFiniteStateError
        A state stops being finite, or the step size becomes too small.
    """
    compiling = time.perf_counter()
    number = heyoka_number(precision)
    first = 0 if so_far is None else len(so_far.t) - 1
    grid = heyoka_doubles(plan.instants[first:], precision)
    for k in plan.exact.keys() & range(first, len(plan.instants)):
        grid[k - first] = number(plan.exact[k])
    t0, span = plan.last(first), grid[-1] - grid[0]
    unit = state_unit(system, states[0] if so_far is None else so_far.y[:, 0], plan)
    earlier = () if so_far is None else so_far.crossings
    taylor_events = TaylorEvents(
        system, events, precision, number, forward=plan.forward, unit=unit, earlier=earlier
    )
    kinks, smooth = kinks_of(system), list[TaylorOrbit]()
    if kinks is None:
        smooth = orbits_of(system, states, t0, method, number, taylor_events, span, max_step)
        if so_far is None and events and taylor_events.at_zero(float(plan.instants[0]), *states):
            smooth[0].leave_start(grid[1], dense=dense)
        orbits: list[TaylorOrbit] | list[KinkedOrbit] = smooth
    else:
        orbits = kinked_orbits_of(kinks, states, t0, method, number, taylor_events, span, precision, max_step)
    if so_far is not None:
        for orbit, beyond in zip(orbits, so_far.beyond, strict=True):
            orbit.go_on_from(beyond)
    compiled = time.perf_counter() - compiling
    run = _TaylorRun(
        orbits,
        taylor_events,
        [numbers_of(states, number)[np.newaxis]],
        [orbit.beyond for orbit in orbits],
    )
    run.follow(grid, plan, first, progress, system.rows, dense=dense)
    found = np.concatenate(run.rows).transpose(1, 0, 2)
    y = found.astype(np.float64)
    t = plan.instants[first : first + y.shape[1]]
    if events and kinks is None:
        run.settle_ends(t, begins=so_far is None)
    if run.stopped:
        t = np.append(t[: y.shape[1] - 1], taylor_events.crossings[-1].t)
    if events:
        taylor_events.check_domain(t, y[:, :, 0])
    _put_aside(taylor_events, method, number, smooth)
    return Samples(
        t=t,
        y=y,
        carried=(found - heyoka_doubles(y, precision)).astype(np.float64),
        steps=run.steps,
        evaluations=run.steps,
        step=None,
        cpu_seconds=run.seconds,
        compile_seconds=compiled,
        beyond=run.beyond,
        crossings=tuple(taylor_events.crossings),
        dense=tuple(Polynomials(tuple(orbit.pieces), number, unit) for orbit in orbits) if dense else (),
    )


def _put_aside(
    taylor_events: TaylorEvents,
    method: Taylor,
    number: Callable[[Fraction], Any],
    orbits: Sequence[TaylorOrbit],
) -> None:
    """Keep the integrators of orbits that have ended for the next motion, where they are of the kind that is kept."""
    if number is float and not taylor_events.events:
        spare = spare_integrators(taylor_events.system, method.tolerance, taylor_events.unit)
        spare.put_aside([orbit.integrator for orbit in orbits])


@dataclass(eq=False)
class _TaylorRun:
    """Orbits side by side on their way: what was reached by all of them, and what it cost."""

    orbits: Sequence[TaylorOrbit | KinkedOrbit]
    taylor_events: TaylorEvents
    rows: list[Any]
    beyond: list[tuple[Any, Any]]
    steps: int = 0
    seconds: float = 0.0
    stopped: bool = False

    def follow(
        self,
        grid: Any,
        plan: Plan,
        first: int,
        progress: Callable[[float], None],
        rows: Sequence[int],
        *,
        dense: bool,
    ) -> None:
        """Go along the plan from a sample on; an interruption ends that where all orbits have arrived."""
        met = 0
        with _side_by_side(len(self.orbits)) as each_in_turn:
            try:
                for begin, end in plan.slices(first):
                    part = grid[begin - first : end - first + 1]
                    state, within = self.orbits[0].beyond[0] / self.taylor_events.size, begin > 0
                    if within:
                        self._begin_slice(part, state)
                    made = list(
                        each_in_turn(lambda orbit, part=part: orbit.advance(part, dense=dense), self.orbits)
                    )
                    for orbit, each in zip(self.orbits, made, strict=True):
                        if each.outcome is not None:
                            raise orbit.lost(each.outcome, rows)
                    self._add(made)
                    if within and isinstance(self.orbits[0], TaylorOrbit):
                        self.taylor_events.settle(part[0], state, part[-1] - part[0], met)
                    met = len(self.taylor_events.crossings)
                    if self.stopped:
                        return
                    progress(end / (len(plan.instants) - 1))
            except KeyboardInterrupt:
                del self.taylor_events.crossings[met:]

    def _begin_slice(self, part: Any, state: Any) -> None:
        """Let an orbit meet the event on which the slice before this one ended."""
        orbit = self.orbits[0]
        if isinstance(orbit, TaylorOrbit) and self.taylor_events.terminal:
            orbit.passed = self.taylor_events.passed_at(part[0], state, part[-1] - part[0])

    def settle_ends(self, t: Array, *, begins: bool) -> None:
        """Count zeros at the ends of these sample times once; at the first where the motion begins there."""
        size = self.taylor_events.size
        begin = (t[0], self.rows[0][0, :, 0] / size) if begins else None
        end = None if self.stopped else (t[-1], self.beyond[0][0] / size)
        self.taylor_events.settle_ends(begin, end, float(t[-1] - t[0]))

    def _add(self, made: Sequence[Slice]) -> None:
        self.stopped = any(each.stopped for each in made)
        found = np.stack([each.rows for each in made], axis=2)
        self.rows.append(found if self.taylor_events.unit == 1 else found * self.taylor_events.size)
        self.steps += sum(each.steps for each in made)
        self.seconds += sum(each.seconds for each in made)
        self.beyond = [orbit.beyond for orbit in self.orbits]


@contextlib.contextmanager
def _side_by_side(
    orbits: int,
) -> Generator[
    Callable[
        [Callable[[TaylorOrbit | KinkedOrbit], Slice], Sequence[TaylorOrbit | KinkedOrbit]], Iterable[Slice]
    ]
]:
    """Yield a map over orbits: on threads where there are several, and in this one where there is one."""
    if orbits == 1:
        yield map
        return
    with ThreadPoolExecutor(min(os.cpu_count() or 1, orbits)) as pool:
        yield pool.map


@dataclass(frozen=True, eq=False)
class Polynomials:
    """One orbit as a function of time: the Taylor polynomials of its steps.

    Parameters
    ----------
    pieces
        heyoka's continuous outputs, one after the other.
    number
        Makes the numbers they are evaluated at.
    unit
        What their values are parts of.
    """

    pieces: tuple[Any, ...]
    number: Callable[[Fraction], Any]
    unit: Fraction = Fraction(1)

    def __call__(self, t: Array) -> Array:
        """Return the states (2n, times) at times inside the span, whose ends doubles may have rounded outwards."""
        found = np.empty((len(self.pieces[0](self.pieces[0].bounds[0])), len(t)))
        first, *_, last = sorted([*self.pieces[0].bounds, *self.pieces[-1].bounds])
        for k, instant in enumerate(t.tolist()):
            at = min(max(self.number(Fraction(instant)), first), last)
            piece = next(p for p in self.pieces if min(p.bounds) <= at <= max(p.bounds))
            found[:, k] = np.asarray(piece(at)).astype(np.float64) * float(self.unit)
        return found
