"""heyoka's Taylor method: slices, samples, events, and the motion as a function of time."""

from __future__ import annotations

import copy
import os
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.event import Crossing
from canon.flow.job import NonFiniteStateError, described
from canon.flow.measure import values_in
from canon.flow.trajectory import Samples
from canon.kernel.machine import DOUBLE, DOUBLE_DOUBLE, EXTENDED
from canon.kernel.taylor import heyoka_functions, heyoka_number, taylor_integrator

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.flow.event import Prepared
    from canon.flow.method import Taylor
    from canon.flow.sampling import Plan
    from canon.flow.trajectory import Array
    from canon.kernel.structure import Equations

__all__ = ["taylor_motion"]


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
    meeting = _Meeting(system, events, precision, number, float(plan.instants[0]), forward=plan.forward)
    orbits = _orbits(system, states, Fraction(float(plan.instants[first])), method, number, meeting)
    if so_far is not None:
        for orbit, (state, clock) in zip(orbits, so_far.beyond, strict=True):
            orbit.integrator.state[:], orbit.integrator.dtime = state, clock
    compiled = time.perf_counter() - compiling
    shape = (1, len(states[0]), len(orbits))
    rows, beyond = [np.array([o.integrator.state for o in orbits]).T.reshape(shape).copy()], _ends(orbits)
    steps = spent = kept = stopped = 0
    with ThreadPoolExecutor(min(os.cpu_count() or 1, len(orbits))) as pool:
        try:
            for begin, end in plan.slices(first):
                part = grid[begin - first : end - first + 1]
                made = list(pool.map(lambda orbit, part=part: orbit.advance(part, dense=dense), orbits))
                if meeting.trouble is not None:
                    raise meeting.trouble
                stopped = any(each.stopped for each in made)
                for orbit, each in zip(orbits, made, strict=True):
                    if not each.finite or (each.failed and not stopped):
                        raise orbit.lost(each.outcome, system.rows)
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
    rows: Any
    steps: int
    seconds: float
    outcome: Any
    finite: bool
    failed: bool
    stopped: bool


@dataclass(eq=False)
class _Orbit:
    integrator: Any
    meeting: _Meeting
    pieces: list[Any] = field(default_factory=list[Any])

    def advance(self, grid: Any, *, dense: bool) -> _Slice:
        """Go from the first time of a grid to its last and return the states at all but the first."""
        from heyoka import taylor_outcome

        started = time.thread_time()
        if dense:
            outcome, _, _, steps, piece, _ = self.integrator.propagate_until(grid[-1], c_output=True)
            reached = (
                [] if piece is None else [t for t in grid[1:] if min(piece.bounds) <= t <= max(piece.bounds)]
            )
            if piece is not None:
                self.pieces.append(piece)
            rows = np.array([np.array(piece(t)) for t in reached]).reshape(len(reached), -1)
        else:
            outcome, _, _, steps, _, found = self.integrator.propagate_grid(grid)
            rows = found[1:]
        spent = time.thread_time() - started
        stopped = self.meeting.stopped_by(outcome)
        if stopped:
            state = self.integrator.state.copy()[np.newaxis]
            rows = np.concatenate([rows.reshape(-1, state.shape[1]), state])
        finite = bool(np.isfinite(rows.astype(np.float64)).all())
        return _Slice(rows, steps, spent, outcome, finite, outcome != taylor_outcome.time_limit, stopped)

    def lost(self, outcome: object, rows: Sequence[int]) -> NonFiniteStateError:
        t, state = float(self.integrator.time), self.integrator.state.astype(np.float64)[list(rows)]
        return NonFiniteStateError(
            f"the motion can't be continued after {described(t, state)} ({outcome}): a collision or the edge of "
            "H's domain; stop earlier",
            t,
            state,
        )


def _orbits(
    system: Equations,
    states: tuple[Array, Array],
    t0: Fraction,
    method: Taylor,
    number: Callable[[Fraction], Any],
    meeting: _Meeting,
) -> list[_Orbit]:
    """Compile one integrator and copy it for the other orbits."""
    made: list[_Orbit] = []
    for high, low in zip(states[0].T.tolist(), states[1].T.tolist(), strict=True):
        y0 = [Fraction(a) + Fraction(b) for a, b in zip(high, low, strict=True)]
        if not made:
            integrator = taylor_integrator(system, y0, t0, method.tolerance, number, meeting.heyoka_events())
        else:
            integrator = copy.deepcopy(made[0].integrator)
            integrator.state[:] = [number(x) for x in y0]
        made.append(_Orbit(integrator, meeting))
    return made


def _ends(orbits: Sequence[_Orbit]) -> list[tuple[Any, Any]]:
    return [(orbit.integrator.state.copy(), orbit.integrator.dtime) for orbit in orbits]


class _Meeting:
    """Events as heyoka's, and the crossings it calls back for."""

    def __init__(
        self,
        system: Equations,
        events: Sequence[Prepared],
        precision: str | int,
        number: Callable[[Fraction], Any],
        t0: float,
        *,
        forward: int,
    ) -> None:
        self.system, self.number, self.t0, self.forward = system, number, t0, forward
        self.recorded = [event for event in events if event.event.action == "record"]
        self.terminal = [event for event in events if event.event.action != "record"]
        self.met: list[Crossing] = []
        self.trouble: NonFiniteStateError | None = None
        self.wide = {"double": EXTENDED if EXTENDED.available() else DOUBLE}.get(
            str(precision), DOUBLE_DOUBLE
        )
        if precision not in ("double", "extended") and any(event.jump for event in events):
            raise ValueError(
                f"precision={precision!r}: the state is changed at events in 'double' and 'extended' only"
            )

    def heyoka_events(self) -> dict[str, list[Any]]:
        import heyoka as hy

        if not (self.recorded or self.terminal):
            return {}
        kinds = {0: hy.event_direction.any, 1: hy.event_direction.positive, -1: hy.event_direction.negative}

        def of(event: Prepared, make: Any, **options: Any) -> Any:
            direction = kinds[event.event.direction * self.forward]
            (function,) = heyoka_functions(self.system, [event.value], self.number)
            return make(function, direction=direction, fp_type=type(self.number(Fraction(0))), **options)

        return {
            "nt_events": [of(e, hy.nt_event, callback=self._recorder(e)) for e in self.recorded],
            "t_events": [of(e, hy.t_event, callback=self._changer(e)) for e in self.terminal],
        }

    def stopped_by(self, outcome: Any) -> bool:
        """Return whether an outcome is the stop at an event, and not the end of time or a failure."""
        return bool(self.terminal) and -len(self.terminal) <= outcome.value < 0 and self.trouble is None

    def _recorder(self, event: Prepared) -> Callable[[Any, Any, int], None]:
        def recorded(integrator: Any, t: Any, sign: int) -> None:
            if float(t) == self.t0:  # a motion that starts at the zero does not cross it there
                return
            integrator.update_d_output(t)
            self._meet(event, float(t), integrator.d_output, sign, None)

        return recorded

    def _changer(self, event: Prepared) -> Callable[[Any, int], bool]:
        def changed(integrator: Any, sign: int) -> bool:
            t, state = float(integrator.time), integrator.state.copy()
            if event.jump is None:
                self._meet(event, t, state, sign, None)
                return False
            high = state.astype(np.float64)
            low = (state - high).astype(np.float64)
            found = values_in(self.wide, self.system, event.jump, t, high[:, np.newaxis], low[:, np.newaxis])[
                :, 0
            ]
            new = [
                self.number(sum((Fraction(*x.as_integer_ratio()) for x in parts), Fraction(0)))
                for parts in found
            ]
            integrator.state[:] = new
            self._meet(event, t, state, sign, integrator.state.copy())
            return True

        return changed

    def _meet(self, event: Prepared, t: float, state: Any, sign: int, after: Any) -> None:
        rows = self.system.rows
        moved = None if after is None else after.astype(np.float64)[rows]
        y = state.astype(np.float64)[rows]
        self.met.append(Crossing(event.event, t, y, sign * self.forward > 0, moved))
