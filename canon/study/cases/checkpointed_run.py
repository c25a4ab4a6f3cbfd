"""Checkpointed run: a case run in parts, from one exact state to the next, so that an interruption changes no bit.

Every run of a study is made of parts, each of which begins anew with the exact state (high and low part) that the
one before ended with. An uninterrupted run goes through the same parts; therefore a resumed one gives the same
numbers bit for bit, with every method, heyoka's included. Where the clock stops a run is of no consequence.
:meth:`canon.flow.trajectory.Trajectory.resume` is another promise: it goes on inside the engine, as a run in one
would have, which DOP853 cannot do.
"""

from __future__ import annotations

import json
import math
import time
from dataclasses import asdict, dataclass, field, replace
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.flow.method.engine import FICTITIOUS_TIME, FIXED_STEPS
from canon.flow.request import Request
from canon.flow.run.sampling_plan import steps_over
from canon.flow.system.parameter_values import SpareParameters
from canon.flow.system_request import is_hamiltonian
from canon.study.cases.case import part_count
from canon.study.cases.case_numbers import judged_energy, judged_observable
from canon.study.cases.case_observables import followed
from canon.study.cases.kept_of_case import kept_on_the_way, section_of
from canon.study.energy_drift.sample_times import is_resolved, scattered
from canon.study.motion.extended_phase_space import driven
from canon.study.motion.observables import ENERGY, expressions_of
from canon.study.motion.quiet_run import run_quietly
from canon.study.motion.term_sizes import TermSizes, terms_along

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.array import Array
    from canon.flow.run.event import Event
    from canon.flow.trajectory import Trajectory
    from canon.study.cases.case import Case
    from canon.study.motion.extended_phase_space import Driven
    from canon.study.motion.observables import Observable

__all__ = ["Checkpoint", "FailedRun", "Outcome", "advance", "started"]

FEWEST_A_PERIOD = 8.0
"""Samples in a period that are enough to see what happens in it, where the period is known."""

INTERVALS, FINE = 16, 512
"""Intervals between samples that are looked at where it is not, and looks in each."""


class FailedRun(ArithmeticError):
    """The run of a case can't be continued; the reason is a result, and so is the time it took.

    Parameters
    ----------
    seconds
        Processor time up to there.
    """

    def __init__(self, reason: str, seconds: float) -> None:
        super().__init__(reason)
        self.seconds = seconds


@dataclass(frozen=True)
class Checkpoint:
    """A run after some of its parts: all that is needed to go on.

    Parameters
    ----------
    part
        Parts done.
    state, carried
        The state is state + carried, each of length 2n; with time and work where H depends on the
        time (:mod:`canon.study.motion.extended_phase_space`).
    energy
        H at the start of the run, or the unit of what takes its place where no energy is known.
    t, change
        The samples so far: times, and H − H(start), less the work done by forces and from outside.
    steps, evaluations, seconds
        Cost so far; the processor time is that of the steps and of keeping samples.
    step, precision
        As the run has them.
    changes
        The samples of what is followed beside the energy, by name.
    even
        Whether the samples stand at equal distances (:mod:`canon.study.energy_drift.sample_times`).
    kept
        What is to be kept of the parts done (:func:`canon.study.cases.kept_of_case.kept_on_the_way`).
    relative
        Whether the energy is more than rounding, so that its error is relative; None of a run begun by a version that
        did not look, which asks whether it is 0.
    terms
        How large the terms of the energy and of the observables are on the parts done, by name.
    """

    part: int
    state: tuple[float, ...]
    carried: tuple[float, ...]
    energy: float = math.nan
    t: tuple[float, ...] = ()
    change: tuple[float, ...] = ()
    steps: int = 0
    evaluations: int = 0
    seconds: float = 0.0
    step: float | None = None
    precision: str = ""
    changes: Mapping[str, tuple[float, ...]] = field(default_factory=dict[str, tuple[float, ...]])
    even: bool = True
    kept: Mapping[str, tuple[str, ...]] = field(default_factory=dict[str, tuple[str, ...]])
    relative: bool | None = None
    terms: Mapping[str, TermSizes] = field(default_factory=dict[str, TermSizes])

    @property
    def is_relative(self) -> bool:
        """Whether the energy's error is relative."""
        return self.energy != 0.0 if self.relative is None else self.relative

    def to_text(self) -> str:
        """Return the checkpoint as JSON; floats survive exactly."""
        return json.dumps(asdict(self))

    @staticmethod
    def from_text(text: str) -> Checkpoint:
        """Return the checkpoint that :meth:`to_text` wrote."""
        fields: dict[str, Any] = json.loads(text)
        for name in ("state", "carried", "t", "change"):
            fields[name] = tuple(fields[name])
        for name in ("changes", "kept"):
            fields[name] = {of: tuple(x) for of, x in fields.get(name, {}).items()}
        fields["terms"] = {of: TermSizes(**sizes) for of, sizes in fields.get("terms", {}).items()}
        return Checkpoint(**fields)


@dataclass(frozen=True)
class Outcome:
    """What came of a finished run: its numbers, exactly, and the point it ended at with its samples.

    Parameters
    ----------
    numbers
        What depends on the case alone, as JSON can hold it.
    seconds
        Processor time.
    end
        The run after its last part.
    """

    numbers: dict[str, Any]
    seconds: float
    end: Checkpoint


def started(case: Case) -> Checkpoint:
    """Return the checkpoint at the start of a case."""
    timed = _with_time(case)
    state = case.state if timed is None else tuple(timed.state(np.array(case.state)).tolist())
    return Checkpoint(0, state, (0.0,) * len(state))


@lru_cache(maxsize=64)
def _with_time(case: Case) -> Driven | None:
    """Return the motion with its time as a coordinate where H depends on the time, None where it does not."""
    hamiltonian = case.hamiltonian
    if not is_hamiltonian(hamiltonian):
        return None  # the work of forces and of what depends on time is integrated along
    return driven(hamiltonian) if hamiltonian.t in hamiltonian.H.free_symbols else None


def advance(case: Case, reached: Checkpoint | None = None, seconds: float = math.inf) -> Checkpoint | Outcome:
    """Run a case on from a checkpoint, for so many seconds or to its end.

    Parameters
    ----------
    case
        The case.
    reached
        Where to go on; the start if left out.
    seconds
        Time after which the next checkpoint is handed back; at least one part is run.

    Raises
    ------
    FailedRun
        The motion can't be continued, or its error can't be judged.

    Examples
    --------
    >>> from canon import RK4
    >>> from canon.study.cases.case import Case
    >>> case = Case("henon-heiles", RK4(), span=400.0, step=0.1, samples=600, parts=3)
    >>> first = advance(case, seconds=0.0)
    >>> second = advance(case, Checkpoint.from_text(first.to_text()), seconds=0.0)
    >>> advance(case, second).numbers == advance(case).numbers
    True
    """
    now, end = time.monotonic(), part_count(case)
    spent = 0.0 if reached is None else reached.seconds
    try:
        point = started(case) if reached is None else reached
        while point.part < end:
            point = _next(case, point, end)
            spent = point.seconds
            if point.part < end and time.monotonic() - now >= seconds:
                return point
        return Outcome(_numbers(case, point), point.seconds, point)
    except (ArithmeticError, ValueError, RuntimeError) as error:
        raise FailedRun(str(error), spent) from error


def _next(case: Case, point: Checkpoint, end: int) -> Checkpoint:
    """Return the checkpoint after one more part."""
    if point.part == 0:
        point = replace(point, even=_evenly(case))
    found = _part(case, point, end)
    before = point.change[-1] if point.change else 0.0
    first = 0 if point.part == 0 else 1  # the first sample of a part is the last one of the part before
    change = tuple((before + _conserved(case, found)).tolist())
    changes = {
        name: (*(done := point.changes.get(name, ())), *((done[-1] if done else 0.0) + new[first:]).tolist())
        for name, new in found.changes.items()
    }
    energy, relative = _size(case, found) if point.part == 0 else (point.energy, point.relative)
    return replace(
        point,
        part=point.part + 1,
        state=tuple(found.y[:, -1].tolist()),
        carried=tuple(found.carried[:, -1].tolist()),
        energy=energy,
        relative=relative,
        terms=_terms(case, point, found),
        t=point.t + tuple(found.t[first:].tolist()),
        change=point.change + change[first:],
        changes=changes,
        steps=point.steps + found.steps,
        evaluations=point.evaluations + found.evaluations,
        seconds=point.seconds + found.cpu_seconds,
        step=found.step,
        precision=found.precision,
        kept=kept_on_the_way(case, point.kept, found, _with_time(case)),
    )


def _conserved(case: Case, found: Trajectory) -> Array:
    """Return the change of the energy less the work done; where no energy is known, of the first observable."""
    return found.changes[followed(case)[0].name] if found.energies is None else found.energy_defect


def _size(case: Case, found: Trajectory) -> tuple[float, bool]:
    """Return the energy at the start and whether its error is relative, or the unit of what takes its place."""
    if found.energies is not None:
        return float(found.energy[0]), found.relative
    first = followed(case)[0]
    return first.unit, first.relative


def _terms(case: Case, point: Checkpoint, found: Trajectory) -> dict[str, TermSizes]:
    """Return how large the terms of the energy and the observables are after one more part."""
    names = [of.name for of in followed(case)]
    of_energy = names[0] if found.energies is None else ENERGY
    each = {ENERGY: of_energy, **dict(zip(names, names, strict=True))}
    return {
        name: point.terms.get(name, TermSizes()).with_part(terms_along(found, of))
        for name, of in each.items()
    }


def _part(case: Case, point: Checkpoint, end: int) -> Trajectory:
    """Run the part that follows a checkpoint."""
    state = [Fraction(a) + Fraction(b) for a, b in zip(point.state, point.carried, strict=True)]
    edges = np.linspace(0, case.samples, end + 1).round().astype(int)
    samples = max(1, int(edges[point.part + 1] - edges[point.part]))
    if case.method.engine is FIXED_STEPS:
        span, step = _whole_steps(case, point.part, end)
    else:
        ends = np.linspace(0.0, case.span, end + 1)
        span, step = (Fraction(ends[point.part]), Fraction(ends[point.part + 1])), case.step
    times = None if point.even else _between(span, samples, seed=point.part)
    along, timed = followed(case), _with_time(case)
    if timed is not None:
        along = tuple(map(timed.observable, along))
    return _run(case, state, span, step, samples, times, along, section_of(case, timed))


def _run(
    case: Case,
    state: Sequence[Fraction | float],
    span: tuple[Fraction, Fraction],
    step: float | None,
    samples: int,
    times: Sequence[float] | None = None,
    along: Sequence[Observable] = (),
    events: Sequence[Event] = (),
) -> Trajectory:
    timed = _with_time(case)
    motion = Request(
        case.hamiltonian if timed is None else timed.hamiltonian,
        span,
        np.array(state, dtype=object),
        parameters=SpareParameters({**case.values}),
        samples=samples if times is None else None,
        times=times,
        observables=expressions_of(along),
        events=events,
    )
    return run_quietly(motion.by(replace(case.setting, step=step)))


def _evenly(case: Case) -> bool:
    """Tell whether even samples do, from the period where it is known, else from a look at the first few intervals."""
    interval = case.span / case.samples
    if case.method.engine is FICTITIOUS_TIME:
        return True  # even in steps, which vary with the motion; landing at scattered times would cost more than they
    if (period := case.period) is not None and interval * FEWEST_A_PERIOD <= period:
        return True
    every, step = FINE, case.step
    if case.method.engine is FIXED_STEPS:
        _, step = _whole_steps(case, 0, 1)
        every = min(FINE, round(interval / step))
    if every < 2:
        return True
    seen = min(INTERVALS, case.samples)
    found = _run(case, started(case).state, (Fraction(0), Fraction(seen * interval)), step, seen * every)
    return is_resolved(found.y[0] if found.energies is None else found.energy_change, every)


def _between(span: tuple[Fraction, Fraction], samples: int, seed: int) -> list[float]:
    """Return scattered times inside a span."""
    first, last = span
    return [t for t in scattered(float(first), float(last), samples, seed).tolist() if first < t < last]


def _whole_steps(case: Case, part: int, end: int) -> tuple[tuple[Fraction, Fraction], float]:
    """Return first and last time of a part and the step, so that all parts take steps of the same exact size."""
    steps = steps_over(Fraction(0), Fraction(case.span), case.step, case.method)
    if steps < end:
        raise ValueError(f"{steps} steps can't be run in {end} parts: ask for fewer")
    h = Fraction(case.span) / steps
    first, last = (steps * k // end for k in (part, part + 1))
    return (first * h, last * h), float(h)


def _numbers(case: Case, point: Checkpoint) -> dict[str, Any]:
    """Judge a run that reached its end."""
    t, timed, run = np.array(point.t), _with_time(case), (point.steps, point.precision)
    sizes = {name: point.terms.get(name, TermSizes()) for name in (ENERGY, *point.changes)}
    energy = judged_energy(
        *(t, np.array(point.change), point.energy, run), relative=point.is_relative, sizes=sizes[ENERGY]
    )
    others = {
        of.name: judged_observable(t, point.changes[of.name], of, run, sizes[of.name])
        for of in followed(case)
    }
    return {
        **energy,
        "step": point.step,
        "steps": point.steps,
        "evaluations": point.evaluations,
        "precision": point.precision,
        "final": list(point.state) if timed is None else timed.original(np.array(point.state)).tolist(),
        **({"observables": others} if others else {}),
    }
