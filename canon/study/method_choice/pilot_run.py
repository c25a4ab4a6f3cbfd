"""Pilot runs: short runs that show what a setting of a method costs and how its error grows."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from canon.cached_property import cached_property
from canon.flow.method.adaptive_methods import Taylor
from canon.flow.method.engine import FICTITIOUS_TIME, FIXED_STEPS, SCIPY
from canon.flow.method.setting import Setting
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.system_request import is_hamiltonian
from canon.study.errors import StudyError
from canon.study.method_choice.choice_question import FINER, PLACES, Question
from canon.study.motion.observables import ENERGY
from canon.study.motion.term_sizes import error_unit, terms_along

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.array import Array
    from canon.flow.method.method import Method
    from canon.flow.trajectory import Trajectory

__all__ = [
    "Pilot",
    "error_seen",
    "natural_step",
    "pilot",
    "pilot_share",
    "require_energy",
    "seconds_per_time",
    "unit_of",
]

WINDOWS = 512
"""Windows a pilot run is looked at in."""

SEEN = 16
"""Samples in each of the windows, at most, of a run whose errors are not seen inside its loop."""

WATCHED = 200_000
"""Steps of a pilot run at which the error is looked at, at most."""

BEFORE_LOST = 0.1
"""Relative energy error from which a run no longer shows the motion that was asked for."""

TIMED_SECONDS = 0.001
"""Processor time over which a step is timed, at least: long beside what a run takes before its first step."""

TIMINGS = 4
"""Timed runs, of which the least counts: other programs only add to it."""

TIMED_STEPS = 20_000
"""Steps of the longer of two runs from which the cost of a method in a fictitious time is told."""


@dataclass(frozen=True)
class Pilot:
    """A short run of a setting.

    Parameters
    ----------
    setting
        What was run.
    span
        Its span.
    steps, evaluations
        Steps taken, and evaluations of the force (Taylor: of the series).
    t
        Middles of the windows (positions: the times of the comparison), shape (windows,).
    mean, largest
        Mean error and largest size of the error in each window; relative where the start is not zero.
    energy
        Largest energy error met.
    failure
        Why the run failed; empty where it did not.
    """

    setting: Setting
    span: float
    steps: int = 0
    evaluations: int = 0
    t: Array = field(default_factory=lambda: np.empty(0))
    mean: Array = field(default_factory=lambda: np.empty(0))
    largest: Array = field(default_factory=lambda: np.empty(0))
    energy: float = math.inf
    failure: str = ""

    @cached_property
    def bound(self) -> float:
        """The largest error met; infinity where the run failed or left the motion."""
        return float(self.largest.max()) if not self.lost else math.inf

    @property
    def lost(self) -> bool:
        """Whether the run failed, or its energy is so wrong that it shows another motion."""
        return bool(self.failure) or not self.energy < BEFORE_LOST


def is_seen_inside(method: Method) -> bool:
    """Tell whether the errors of a method are those inside its loop: steps of one size, and no corrector."""
    return method.engine is FIXED_STEPS and not (method.solvable and method.solvable.corrector)


def pilot(question: Question, setting: Setting, span: float, windows: int = WINDOWS) -> Pilot:
    """Run a setting for a while and keep what its error did; a run that fails is a pilot with the reason."""
    try:
        if question.observable == "position":
            return _against_reference(question, setting, span)
        if is_seen_inside(setting.method) and is_hamiltonian(question.hamiltonian):
            return _watched(question, setting, span, windows)
        return _sampled(question, setting, span, windows)
    except (ArithmeticError, ValueError) as failed:
        return Pilot(setting, span, failure=str(failed))


def seconds_per_time(question: Question, run: Pilot) -> float:
    """Return the processor time of the steps per unit of time, the least of a few runs of a pilot's setting."""
    setting, span = run.setting, run.span
    if setting.method.engine is FICTITIOUS_TIME:
        return _seconds_with_landing(question, run)
    trial = span / 64.0
    found = question.run(setting, trial, 1)
    while found.cpu_seconds < TIMED_SECONDS and trial < question.span:
        longer = min(question.span, 4.0 * trial)
        try:
            found = question.run(setting, longer, 1)
        except NonFiniteStateError:
            if longer <= span:
                raise
            break  # what comes after the pilot is not asked for here
        trial = longer
    again = (question.run(setting, trial, 1).cpu_seconds for _ in range(TIMINGS - 1))
    return min(found.cpu_seconds, *again) / trial


def _seconds_with_landing(question: Question, run: Pilot) -> float:
    """Return the same for a method in a fictitious time, whose stretches and landing take milliseconds of their own."""
    longest = min(question.span, run.span * TIMED_STEPS / run.steps)
    short, long = (
        min(question.run(run.setting, trial, 1).cpu_seconds for _ in range(TIMINGS))
        for trial in (longest / 4.0, longest)
    )
    rate = max(0.0, long - short) / (0.75 * longest)
    return rate + max(0.0, long - rate * longest) / question.span


def _watched(question: Question, setting: Setting, span: float, windows: int) -> Pilot:
    """Follow the error inside the loop: nothing is missed between samples."""
    steps = math.ceil(span / setting.knob)
    cadence = max(1, steps // WATCHED)
    windows = max(1, min(windows, steps // (2 * cadence)))
    found = question.run(setting, span, windows, cadence)
    seen = found.statistics[question.observable]
    unit = unit_of(found, question)
    worst = float(found.statistics["energy"].largest.max())
    return Pilot(
        setting=replace(setting, step=found.step),
        span=span,
        steps=found.steps,
        evaluations=found.evaluations,
        t=(found.t[1:] + found.t[:-1]) / 2.0 - question.since,
        mean=seen.mean / unit,
        largest=seen.largest / unit,
        energy=_energy(found, worst),
    )


def _sampled(question: Question, setting: Setting, span: float, windows: int) -> Pilot:
    """Follow the error from sample to sample: of stepped methods in windows of many."""
    stepped = setting.method.engine.takes_step
    samples = 2 * WINDOWS
    if stepped:
        samples = max(windows, min(SEEN * WINDOWS, math.ceil(span / setting.knob)))
    found = question.run(setting, span, samples)
    error = change_of(found, question)[1:] / unit_of(found, question)
    parts = min(windows, error.size) if stepped else error.size
    ends = (
        np.linspace(0, error.size, parts + 1).round().astype(int)
    )  # to the last sample, where errors are largest
    first, count = ends[:-1], np.diff(ends)
    return Pilot(
        setting=setting if setting.step is None else replace(setting, step=found.step),
        span=span,
        steps=found.steps,
        evaluations=found.evaluations,
        t=np.add.reduceat(found.t[1:] - question.since, first) / count,
        mean=np.add.reduceat(error, first) / count,
        largest=np.maximum.reduceat(np.abs(error), first),
        energy=_energy(found),
    )


def _against_reference(question: Question, setting: Setting, span: float) -> Pilot:
    """Compare coordinates with the reference; a step is adjusted to meet its times."""
    times, places = None, PLACES * FINER
    if (
        setting.method.engine is FICTITIOUS_TIME
    ):  # its samples are even in its own time; to land at others takes longer
        places = 2 * PLACES
        times = question.since + np.linspace(0.0, span, places + 1)[1:]
    elif setting.method.engine is FIXED_STEPS:
        between = _whole_steps(span / setting.knob / PLACES)
        places = PLACES * math.gcd(between, FINER)
        setting = replace(setting, step=span / (PLACES * between))
    true, rest = (
        part[:, :: PLACES * FINER // places] for part in question.positions(span, setting.arithmetic)
    )
    found = question.run(setting, span, places, times=times)
    if found.t.size == places:
        true, rest = true[:, 1:], rest[:, 1:]
    off = (found.q - true) + (found.carried[: len(found.q)] - rest)
    size = float(np.linalg.norm(true, axis=0).max())
    away = np.linalg.norm(off, axis=0)[-places:] / size
    return Pilot(
        setting=setting,
        span=span,
        steps=found.steps,
        evaluations=found.evaluations,
        t=found.t[-places:] - question.since,
        mean=away,
        largest=away,
        energy=_energy(found),
    )


def _whole_steps(wanted: float) -> int:
    """Return how many steps to take between two places, of which many can be looked at and none is much longer."""
    quantum = next((q for q, least in ((8, 32), (4, 6), (2, 3)) if wanted >= least), 1)
    return quantum * max(1, round(wanted / quantum))


def _energy(found: Trajectory, largest: float | None = None) -> float:
    """Return the largest energy error, relative where it is not zero; 0 where H depends on time or is unknown."""
    if found.energies is None or not found.autonomous:
        return 0.0
    if found.record.moving is not None:
        return float(np.abs(found.energy_error).max())
    change = float(np.abs(found.energy_change).max()) if largest is None else largest
    return change / (float(abs(found.energy[0])) if found.relative else 1.0)


def unit_of(found: Trajectory, question: Question) -> float:
    """Return what errors are relative to: the quantity at the start, or one where it is zero but for rounding."""
    if question.unit is not None:
        return question.unit
    if question.integral is None and found.energies is None:
        return 1.0  # positions bring their own
    name = ENERGY if question.integral is None else question.observable
    return error_unit(found, name, terms_along(found, name))[0]


def error_seen(motion: Trajectory, question: Question) -> float | None:
    """Return the largest error that the samples of a motion show; None of positions, which need a reference."""
    if question.observable == "position":
        return None
    return float(np.abs(change_of(motion, question)).max()) / unit_of(motion, question)


def change_of(motion: Trajectory, question: Question) -> Array:
    """Return the change of what should stay constant; where forces do work, of the energy less their work."""
    if question.integral is not None:
        return motion.changes[question.observable]
    if motion.record.moving is None:
        return motion.energy_change
    return motion.energy_error * (np.abs(motion.energy[0]) if motion.relative else 1.0)


def natural_step(question: Question, report: Callable[[float], None] = lambda _: None) -> float:
    """Return the mean step of Taylor's method at the tolerance of round-off: the time scale of the motion.

    Raises
    ------
    StudyError
        Where the motion can't be followed at all.
    """
    span = question.span * 2.0**-20
    try:
        while True:
            found = question.run(Setting(Taylor(), precision="double"), span, 1)
            if found.steps >= 300 or span >= question.span:
                return span / found.steps
            factor = 8.0 if found.steps < 30 else 400.0 / found.steps
            span = min(question.span, factor * span)
            report(0.0)
    except (NonFiniteStateError, ValueError) as failed:
        raise StudyError(f"the motion can't be followed: {failed}") from failed


def require_energy(question: Question) -> None:
    """Refuse to follow the energy of a system that has none.

    Raises
    ------
    StudyError
        Such as of a vector field.
    """
    if (
        question.observable != "energy"
        or question.integral is not None
        or is_hamiltonian(question.hamiltonian)
    ):
        return
    record = question.run(Setting(Taylor(), precision="double"), question.span * 2.0**-20, 1).record
    if record.moving is not None and record.moving.energy is None:
        raise StudyError(
            f'no energy is known of a {record.moving.kind}: ask for observable="position", or give what should stay '
            "constant, observable=name and integral=function"
        )


def pilot_share(method: Method) -> float:
    """Return the part of a pilot's usual span that suffices: less where every step is taken in Python."""
    return 1.0 / 16.0 if method.engine is SCIPY else 1.0
