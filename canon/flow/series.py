"""heyoka's Taylor method: slices, samples, events, and the motion as a function of time."""

from __future__ import annotations

import contextlib
import copy
import os
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.job import NonFiniteStateError, described
from canon.flow.meeting import Meeting
from canon.flow.trajectory import Samples
from canon.kernel.taylor import heyoka_number, taylor_integrator

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Sequence

    from canon.flow.event import Prepared
    from canon.flow.method import Taylor
    from canon.flow.sampling import Plan
    from canon.flow.trajectory import Array
    from canon.kernel.structure import Equations

__all__ = ["taylor_motion"]

_MANY_STEPS, _CREEPING = 50_000, 1e-10
"""Where so many steps pass less than this part of what is left, they shrink towards a singularity."""

_SMALL_PART = 2.0**-30
"""What part of a step is passed without events after one that changed the state."""


def taylor_motion(
    system: Equations,
    states: tuple[Array, Array],
    plan: Plan,
    method: Taylor,
    precision: str | int,
    progress: Callable[[float], None],
    so_far: Samples | None = None,
    events: Sequence[Prepared] = (),
    *,
    dense: bool = False,
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

    Raises
    ------
    NonFiniteStateError
        A state stops being finite, or the step size becomes too small.
    """
    compiling = time.perf_counter()
    number = heyoka_number(precision)
    first = 0 if so_far is None else len(so_far.t) - 1
    grid = np.array([number(Fraction(t)) for t in plan.instants[first:].tolist()])
    meeting = Meeting(system, events, precision, number, forward=plan.forward)
    t0, span = Fraction(float(plan.instants[first])), grid[-1] - grid[0]
    orbits = _orbits(system, states, t0, method, number, meeting, span)
    if so_far is not None:
        for orbit, (state, clock) in zip(orbits, so_far.beyond, strict=True):
            orbit.integrator.state[:], orbit.integrator.dtime = state, clock
    compiled = time.perf_counter() - compiling
    if events and so_far is None and meeting.at_zero(float(plan.instants[0]), *states):
        orbits[0].leave([], None, dense=dense)
    shape = (1, len(states[0]), len(orbits))
    start = [
        np.array([number(Fraction(a) + Fraction(b)) for a, b in zip(h, l, strict=True)])
        for h, l in zip(states[0].T.tolist(), states[1].T.tolist(), strict=True)
    ]
    rows, beyond = [np.stack(start, axis=1).reshape(shape)], _ends(orbits)
    steps = spent = kept = stopped = 0
    with _side_by_side(len(orbits)) as each_in_turn:
        try:
            for begin, end in plan.slices(first):
                part = grid[begin - first : end - first + 1]
                made = list(each_in_turn(lambda orbit, part=part: orbit.advance(part, dense=dense), orbits))
                for orbit, each in zip(orbits, made, strict=True):
                    if each.outcome is not None:
                        raise orbit.lost(each.outcome, system.rows)
                stopped = any(each.stopped for each in made)
                rows.append(np.stack([each.rows for each in made], axis=2))
                steps += sum(each.steps for each in made)
                spent += sum(each.seconds for each in made)
                beyond, kept = _ends(orbits), len(meeting.met)
                if stopped:
                    break
                progress(end / (len(plan.instants) - 1))
        except KeyboardInterrupt:
            del meeting.met[kept:]
    found = np.concatenate(rows).transpose(1, 0, 2)
    y = found.astype(np.float64)
    exact = np.array([number(Fraction(x)) for x in y.ravel().tolist()]).reshape(y.shape)
    t = plan.instants[first : first + y.shape[1]]
    if stopped:
        t = np.append(t[: y.shape[1] - 1], meeting.met[-1].t)
    return Samples(
        t=t,
        y=y,
        carried=(found - exact).astype(np.float64),
        steps=steps,
        evaluations=steps,
        step=None,
        cpu_seconds=spent,
        compile_seconds=compiled,
        beyond=beyond,
        crossings=tuple(meeting.met),
        dense=tuple(Polynomials(tuple(orbit.pieces), number) for orbit in orbits) if dense else (),
    )


@contextlib.contextmanager
def _side_by_side(
    orbits: int,
) -> Generator[Callable[[Callable[[_Orbit], _Slice], list[_Orbit]], Iterable[_Slice]]]:
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
    """

    pieces: tuple[Any, ...]
    number: Callable[[Fraction], Any]

    def __call__(self, t: Array) -> Array:
        """Return the states (2n, times) at times inside the span."""
        found = np.empty((len(self.pieces[0](self.pieces[0].bounds[0])), len(t)))
        for k, instant in enumerate(t.tolist()):
            at = self.number(Fraction(instant))
            piece = next(p for p in self.pieces if min(p.bounds) <= at <= max(p.bounds))
            found[:, k] = np.asarray(piece(at)).astype(np.float64)
        return found


@dataclass(frozen=True)
class _Slice:
    """States reached, shape (times, 2n), and what they cost; ``outcome`` where the motion can't go on."""

    rows: Any
    steps: int
    seconds: float
    outcome: Any
    stopped: bool


@dataclass(eq=False)
class _Orbit:
    """One orbit on its way: heyoka's integrator, and one without events to leave their zeros with."""

    integrator: Any
    meeting: Meeting
    free: Any
    span: Any
    pieces: list[Any] = field(default_factory=list[Any])
    safe: tuple[Any, Any] = (None, None)

    def advance(self, grid: Any, *, dense: bool) -> _Slice:
        """Go from the first time of a grid to its last and return the states at all but the first."""
        started, rows, steps, left = time.thread_time(), list[Any](), 0, list(grid[1:])
        failure, stopped = None, False
        while left:
            steps_taken, found, outcome = self._towards(self.integrator, left, dense=dense)
            steps += steps_taken
            rows += found
            left = left[len(found) :]
            event = self.meeting.event_of(outcome)
            if event is None:
                failure = outcome
                break
            if event.jump is None:
                rows.append(self.integrator.state.copy())
                stopped = True
                break
            self.integrator.state[:] = self.meeting.met_state
            steps_taken, found = self.leave(left, event, dense=dense)
            steps += steps_taken
            rows += found
            left = left[len(found) :]
        made = np.array(rows).reshape(len(rows), len(self.integrator.state))
        if not left and not np.isfinite(made.astype(np.float64)).all():
            failure = "the state is not finite"
        if stopped or (not left and not isinstance(failure, str)):
            failure = None
        return _Slice(made, steps, time.thread_time() - started, failure, stopped)

    def leave(self, left: list[Any], event: Prepared | None, *, dense: bool) -> tuple[int, list[Any]]:
        """Move off an event's zero, by a small part of a step that looks for no events.

        heyoka takes a zero at the very beginning of a step for others of the step too.
        """
        free, own = self.free, self.integrator
        free.state[:], free.dtime = own.state, own.dtime
        before, clock = own.state.copy(), own.dtime
        _, natural = free.step(self.span)
        free.state[:], free.dtime = before, clock
        end = own.time + natural * type(natural)(_SMALL_PART)
        at_once = [before for t in left if t == own.time]
        near = [t for t in left if t != own.time and (t - end) * self.meeting.forward < 0]
        steps, found, _ = self._towards(free, [*near, end], dense=dense)
        if event is not None:
            self.meeting.check_left(event, before, own.time, free.state)
        own.state[:], own.dtime = free.state, free.dtime
        if self.meeting.terminal:
            own.reset_cooldowns()
        return steps, [*at_once, *found[: len(near)]]

    def _towards(self, integrator: Any, times: list[Any], *, dense: bool) -> tuple[int, list[Any], Any]:
        """Return steps taken, the states at the times reached, and the outcome."""
        from heyoka import taylor_outcome

        steps, rows = 0, list[Any]()
        while True:
            self.safe = (integrator.state.copy(), integrator.dtime)
            before, left = integrator.time, times[len(rows) :]
            taken, found, outcome = self._some_steps(integrator, left, dense=dense)
            steps += taken
            rows += found
            passed, ahead = abs(integrator.time - before), abs(times[-1] - integrator.time)
            if outcome != taylor_outcome.step_limit or not passed > ahead * _CREEPING:
                return steps, rows, outcome

    def _some_steps(self, integrator: Any, times: list[Any], *, dense: bool) -> tuple[int, list[Any], Any]:
        limits = {"max_steps": _MANY_STEPS}
        if self.meeting.events:
            limits["max_delta_t"] = abs(self.span)
        if not dense:
            grid = np.array([integrator.time, *times])
            outcome, _, _, steps, _, found = integrator.propagate_grid(grid, **limits)
            return steps, list(found[1:]), outcome
        outcome, _, _, steps, piece, _ = integrator.propagate_until(times[-1], c_output=True, **limits)
        if piece is None:
            return steps, [], outcome
        self.pieces.append(piece)
        first, last = sorted(piece.bounds)
        return steps, [np.array(piece(t)) for t in times if first <= t <= last], outcome

    def lost(self, outcome: object, rows: Sequence[int]) -> NonFiniteStateError:
        """Return the error that says where the motion ended: its last finite step is looked for again."""
        own = self.integrator
        own.state[:], own.dtime = self.safe
        t, state = own.time, own.state.copy()
        for _ in range(_MANY_STEPS):
            own.step(self.span)
            if not np.isfinite(own.state.astype(np.float64)).all() or own.time == t:
                break
            t, state = own.time, own.state.copy()
        y = state.astype(np.float64)[list(rows)]
        return NonFiniteStateError(
            f"the motion can't be continued after {described(float(t), y)} ({outcome}): a collision or the edge of "
            "H's domain; stop earlier",
            float(t),
            y,
        )


def _orbits(
    system: Equations,
    states: tuple[Array, Array],
    t0: Fraction,
    method: Taylor,
    number: Callable[[Fraction], Any],
    meeting: Meeting,
    span: Any,
) -> list[_Orbit]:
    """Compile one integrator and copy it for the other orbits."""
    made, free = list[_Orbit](), None
    for high, low in zip(states[0].T.tolist(), states[1].T.tolist(), strict=True):
        y0 = [Fraction(a) + Fraction(b) for a, b in zip(high, low, strict=True)]
        if not made:
            settings = system, y0, t0, method.tolerance, number
            integrator = taylor_integrator(*settings, meeting.heyoka_events())
            free = taylor_integrator(*settings) if meeting.events else None
        else:
            integrator = copy.deepcopy(made[0].integrator)
            integrator.state[:] = [number(x) for x in y0]
        made.append(_Orbit(integrator, meeting, free, span))
    return made


def _ends(orbits: Sequence[_Orbit]) -> list[tuple[Any, Any]]:
    return [(orbit.integrator.state.copy(), orbit.integrator.dtime) for orbit in orbits]
