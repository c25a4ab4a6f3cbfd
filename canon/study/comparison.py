"""Methods side by side on one motion: what their energy error does, and what they cost."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.method import RK4, FixedStep, Gauss, Splitting, Taylor
from canon.flow.propagate import NonFiniteStateError, is_separable, propagate
from canon.scene.scene import Scene
from canon.study.drift import FEWEST, Drift, drift

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray
    from sympy import Symbol

    from canon.flow.method import Method
    from canon.flow.propagate import HamiltonianSystem
    from canon.flow.trajectory import Trajectory

__all__ = ["DriftRow", "DriftStudy", "StudyError", "drift_row", "drift_study"]

GOLDEN = (1.0 + math.sqrt(5.0)) / 2.0

STEPS_PER_PERIOD = 48.0 + GOLDEN
"""Steps in a period where no step is given: about 50, but never in step with the motion.

A whole number of steps in a period meets the pericentre at nearly the same phase for a long time, and its
slow shift then looks like a drift.
"""

SAMPLES_PER_PERIOD = 14.0 + GOLDEN
"""Samples in a period where no number is given: enough to see its oscillation, and not in step with it."""

MOST_SAMPLES = 2**17
"""Samples that are kept at most unless more are asked for."""

UNIT_ROUND_OFF = {"single": 2.0**-24, "extended": 2.0**-64, "quad": 2.0**-113, "double-double": 2.0**-106}
"""Unit round-off by precision; 2⁻⁵³ for the others."""


TIMED_STEPS = 20_000
"""Steps that are timed without samples."""


class StudyError(ValueError):
    """A study that can't be run as asked."""


@dataclass(frozen=True)
class DriftRow:
    """One method's run.

    Parameters
    ----------
    method
        The method.
    step
        Its step, None where it chooses its own.
    t, error
        The sampled times, and the energy error (E(t) − E(0))/|E(0)|; empty where the run failed.
    relative
        Whether the error is relative; it is E(t) − E(0) where E(0) = 0.
    drift
        How the error grew; None where the run failed.
    failure
        Why the run failed; empty where it did not.
    steps, evaluations
        Steps taken, and evaluations of the force (Taylor: of the series).
    cpu_seconds, compile_seconds
        Processor time of the steps (keeping samples left out), and the time that compiling their loop took.
    precision
        The arithmetic.
    final
        The state at the end, shape (2n,); empty where the run failed.
    """

    method: Method
    step: float | None
    t: NDArray[np.float64]
    error: NDArray[np.float64]
    relative: bool = True
    drift: Drift | None = None
    failure: str = ""
    steps: int = 0
    evaluations: int = 0
    cpu_seconds: float = 0.0
    compile_seconds: float = 0.0
    precision: str = ""
    final: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))


@dataclass(frozen=True)
class DriftStudy:
    """The energy error of several methods on one motion.

    Parameters
    ----------
    title
        What was run.
    span
        Duration of the runs.
    period
        Period that rates are given by; None where none is known.
    time_unit
        Unit of time.
    rows
        One a method, in the order asked for.
    """

    title: str
    span: float
    period: float | None
    time_unit: str
    rows: tuple[DriftRow, ...]


def drift_study(
    system: Scene | HamiltonianSystem,
    y0: ArrayLike | str | None = None,
    *,
    methods: Sequence[Method] | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    periods: float = 1000.0,
    until: float | None = None,
    period: float | None = None,
    precision: str | None = None,
    parameters: Mapping[Symbol | str, float] | None = None,
    samples: int | None = None,
    progress: Callable[[str, float], None] | None = None,
) -> DriftStudy:
    """Run one motion with several methods and judge the energy error of each.

    Parameters
    ----------
    system
        A scene or a Hamiltonian that does not depend on time.
    y0
        Initial state (q, p), shape (2n,), or for a scene the name of a start; a scene's default start if
        left out.
    methods
        The methods. If left out: Kahan & Li's of order 8 and Verlet's where H = T(p) + V(q), else Gauss's of order 8
        and 2; RK4; heyoka's Taylor method.
    step
        Step of the methods of fixed step; about a fiftieth of the period if left out.
    tolerance
        Tolerance of the adaptive methods, in place of their own.
    periods, until
        Duration in periods, or in units of time.
    period
        Period of the motion; the scene's if left out.
    precision
        Arithmetic of the methods of fixed step, ``"compensated"`` or ``"double"``.
    parameters
        Values of parameters by symbol or name; a scene has its own, which these replace.
    samples
        Samples to keep of each run; about 16 a period, at most 131072, if left out.
    progress
        Called with the method's name and the fraction of its run that is done.

    Returns
    -------
    DriftStudy
        One row a method. A run that fails is a row with the reason, never data.

    Raises
    ------
    StudyError
        Where the request makes no sense, or every method failed.

    Examples
    --------
    >>> from canon import RK4, Splitting
    >>> from canon.scene import find
    >>> study = drift_study(find("henon-heiles"), methods=[Splitting("verlet"), RK4()], periods=200)
    >>> [row.drift.verdict.value for row in study.rows]
    ['bounded', 'secular']
    """
    hamiltonian = system.hamiltonian if isinstance(system, Scene) else system
    state, values = _state(system, y0), _parameters(system, parameters)
    chosen = tuple(methods) if methods is not None else _usual_methods(hamiltonian, values)
    if not chosen:
        raise StudyError("no method to study: name at least one")
    known_period = period if period is not None else _period(system)
    span = until if until is not None else _span(periods, known_period)
    if not (math.isfinite(span) and span > 0.0):
        raise StudyError(f"a run over a time of {span} makes no sense: give a positive, finite duration")
    h = step if step is not None else _usual_step(chosen, known_period)
    if h is not None and not (math.isfinite(h) and h > 0.0):
        raise StudyError(f"a step of {h} makes no sense: give a positive, finite one")
    kept = samples if samples is not None else _usual_samples(span, known_period)
    if kept < FEWEST:
        raise StudyError(f"{kept} samples are too few to judge growth: keep at least {FEWEST}")
    rows = tuple(
        drift_row(
            hamiltonian,
            state,
            span,
            method,
            step=h if _is_fixed(method) else None,
            tolerance=None if _is_fixed(method) else tolerance,
            precision=precision if _is_fixed(method) else None,
            parameters=values,
            samples=kept,
            progress=partial(progress, str(method)) if progress is not None else None,
        )
        for method in chosen
    )
    if all(row.failure for row in rows):
        reasons = "; ".join(f"{row.method}: {row.failure}" for row in rows)
        raise StudyError(f"every run failed: {reasons}")
    return DriftStudy(_title(system, y0), span, known_period, _time_unit(system), rows)


def drift_row(
    hamiltonian: HamiltonianSystem,
    y0: NDArray[np.float64],
    span: float,
    method: Method,
    *,
    samples: int,
    step: float | None = None,
    tolerance: float | None = None,
    precision: str | None = None,
    parameters: Mapping[Symbol | str, float] | None = None,
    progress: Callable[[float], None] | None = None,
) -> DriftRow:
    """Run one method and judge its energy error; a run that fails is a row with the reason.

    The parameters are those of :func:`drift_study` and :func:`canon.flow.propagate.propagate`.
    """

    def run(duration: float, kept: int, report: Callable[[float], None] | None = None) -> Trajectory:
        return propagate(
            hamiltonian,
            y0,
            (0.0, duration),
            method=method,
            step=step,
            tolerance=tolerance,
            precision=precision,
            parameters=parameters,
            samples=kept,
            progress=report,
        )

    try:
        found = run(span, samples, progress)
        error = found.energy_error
        unit = UNIT_ROUND_OFF.get(found.precision, 2.0**-53)
        roundoff = unit * math.sqrt(found.steps) if found.relative else None
        judged = drift(found.t, error, roundoff=roundoff, resolution=unit)
    except (NonFiniteStateError, ValueError) as failed:
        return DriftRow(method, step, np.empty(0), np.empty(0), failure=str(failed))
    return DriftRow(
        found.method,
        found.step,
        found.t,
        error,
        relative=found.relative,
        drift=judged,
        steps=found.steps,
        evaluations=found.evaluations,
        cpu_seconds=_seconds_of_steps(found, run),
        compile_seconds=found.compile_seconds,
        precision=found.precision,
        final=found.final,
    )


def _seconds_of_steps(found: Trajectory, run: Callable[[float, int], Trajectory]) -> float:
    """Return the processor time of the steps alone.

    Keeping a sample costs a method of fixed step as much as a thousand cheap steps do; so a part of the run is
    timed again without samples. Its steps all cost the same.
    """
    if found.step is None:
        return found.cpu_seconds
    part = min(found.steps, TIMED_STEPS)
    again = min(run(part * found.step, 1).cpu_seconds for _ in range(2))
    return min(found.cpu_seconds, again * found.steps / part)


def _usual_methods(
    hamiltonian: HamiltonianSystem, parameters: Mapping[Symbol | str, float]
) -> tuple[Method, ...]:
    """Return two symplectic methods that apply, an ordinary one and heyoka's."""
    if is_separable(hamiltonian, parameters):
        return Splitting("kahan-li-8"), Splitting("verlet"), RK4(), Taylor()
    return Gauss(4), Gauss(1), RK4(), Taylor()


def _is_fixed(method: Method) -> bool:
    return isinstance(method, FixedStep)


def _period(system: Scene | HamiltonianSystem) -> float | None:
    return system.period if isinstance(system, Scene) else None


def _span(periods: float, period: float | None) -> float:
    if period is None:
        raise StudyError("a Hamiltonian does not tell its period: give period=, or the duration as until=")
    return periods * period


def _usual_step(methods: Sequence[Method], period: float | None) -> float | None:
    if period is not None:
        return period / STEPS_PER_PERIOD
    fixed = [str(method) for method in methods if _is_fixed(method)]
    if fixed:
        raise StudyError(
            f"{fixed[0]} takes fixed steps: give step=, or period= to take about a fiftieth of it"
        )
    return None


def _usual_samples(span: float, period: float | None) -> int:
    wanted = SAMPLES_PER_PERIOD * span / period if period is not None else math.inf
    return int(min(MOST_SAMPLES, max(16 * FEWEST, wanted)))


def _state(system: Scene | HamiltonianSystem, y0: ArrayLike | str | None) -> NDArray[np.float64]:
    if isinstance(system, Scene) and (y0 is None or isinstance(y0, str)):
        return system.state(y0)
    if y0 is None or isinstance(y0, str):
        raise StudyError("a Hamiltonian has no starts of its own: give the initial state (q, p) as numbers")
    return np.asarray(y0, dtype=np.float64)


def _parameters(
    system: Scene | HamiltonianSystem, parameters: Mapping[Symbol | str, float] | None
) -> Mapping[Symbol | str, float]:
    given = {str(name): value for name, value in (parameters or {}).items()}
    if isinstance(system, Scene):
        return {**system.with_parameters(**given).values}
    return {**given}


def _title(system: Scene | HamiltonianSystem, y0: ArrayLike | str | None) -> str:
    if not isinstance(system, Scene):
        return "Hamiltonian"
    if y0 is not None and not isinstance(y0, str):
        return system.title
    return f"{system.title}; {system.start(y0).about}"


def _time_unit(system: Scene | HamiltonianSystem) -> str:
    return system.time_unit if isinstance(system, Scene) else ""
