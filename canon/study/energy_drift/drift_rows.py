"""Rows of a drift study: one method's run, and how each quantity that should stay constant drifted."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from canon.flow.method.engine import FIXED_STEPS
from canon.flow.method.setting import Setting
from canon.flow.request import Request
from canon.study.energy_drift.drift import Growth, judged_series
from canon.study.energy_drift.error_series import error_series
from canon.study.errors import StudyError
from canon.study.motion.observables import ENERGY, SYMPLECTICITY, Observable, expressions_of, tangent_of
from canon.study.motion.quiet_run import run_quietly

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from sympy import Symbol

    from canon.array import Array
    from canon.flow.method.method import Method
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.flow.trajectory import Trajectory
    from canon.study.energy_drift.drift import Drift

__all__ = ["DriftRow", "Run", "drift_row", "drift_rows"]

TIMED_STEPS = 20_000
"""Steps that are timed without samples."""

SEVERITY = (
    Growth.BOUNDED,
    Growth.ROUND_OFF,
    Growth.WANDERING,
    Growth.UNDECIDED,
    Growth.SECULAR,
    Growth.DIVERGED,
)


@dataclass(frozen=True, eq=False)
class DriftRow:
    """One method's run, and one observable along it.

    Parameters
    ----------
    method
        The method.
    step
        Its step, None where it chooses its own.
    t, error
        The sampled times, and the error of the observable: of the energy (E(t) − E(0))/abs(E(0)); empty where the
        run failed. Of many orbits, the one with the largest error.
    relative
        Whether the error is relative; it is E(t) − E(0) where E(0) = 0.
    drift
        How the error grew, of many orbits the worst; None where the run failed.
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
    observable
        What was followed.
    orbits
        How the error of each orbit grew, where there are several.
    """

    method: Method
    step: float | None
    t: Array
    error: Array
    relative: bool = True
    drift: Drift | None = None
    failure: str = ""
    steps: int = 0
    evaluations: int = 0
    cpu_seconds: float = 0.0
    compile_seconds: float = 0.0
    precision: str = ""
    final: Array = field(default_factory=lambda: np.empty(0))
    observable: str = ENERGY
    orbits: tuple[Drift, ...] = ()

    def __repr__(self) -> str:
        came = self.failure if self.drift is None else self.drift.verdict.value
        return f"<DriftRow: {self.observable} by {self.method}, {came}>"


@dataclass(frozen=True)
class Run:
    """A motion and how it is to be run, the way ``propagate`` takes it; y0 has shape (2n,) or (2n, orbits)."""

    hamiltonian: HamiltonianSystem
    y0: Array
    span: float
    setting: Setting
    samples: int
    parameters: Mapping[Symbol | str, float] | None = None
    cadence: int | None = None

    def __call__(
        self,
        span: float,
        samples: int,
        observables: Sequence[Observable] = (),
        cadence: int | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Trajectory:
        """Return a run of that span."""
        motion = Request(
            self.hamiltonian,
            (0.0, span),
            self.y0,
            parameters=self.parameters,
            samples=samples,
            observables=expressions_of(observables),
            cadence=cadence,
        )
        return run_quietly(motion.by(self.setting), progress)


def drift_row(
    hamiltonian: HamiltonianSystem,
    span: float,
    y0: Array,
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

    The parameters are those of :func:`drift_study` and :func:`canon.flow.propagation.propagate`.
    """
    run = Run(hamiltonian, y0, span, Setting(method, step, tolerance, precision), samples, parameters)
    return drift_rows(run, (Observable(ENERGY),), progress)[0]


def drift_rows(
    run: Run, observables: Sequence[Observable], progress: Callable[[float], None] | None = None
) -> list[DriftRow]:
    """Run one method and judge every observable; a run that fails gives rows with the reason.

    With a cadence the observables are followed inside the loop: their block means are judged, and the bound
    is the largest error of all steps looked at.
    """
    along = [each for each in observables if each.name != SYMPLECTICITY]
    rows: dict[str, DriftRow] = {}
    try:
        found = run(run.span, run.samples, along, run.cadence, progress)
        seconds = _seconds_of_steps(found, run)
        for each in along:
            rows[each.name] = _judged(found, each, seconds)
        if len(along) < len(observables):
            rows[SYMPLECTICITY] = _symplecticity(run, found, seconds)
    except (ArithmeticError, ValueError) as failed:
        lost = DriftRow(run.setting.method, run.setting.step, np.empty(0), np.empty(0), failure=str(failed))
        return [replace(lost, observable=each.name) for each in observables]
    return [rows[each.name] for each in observables]


def _judged(found: Trajectory, observable: Observable, seconds: float) -> DriftRow:
    if observable.name == ENERGY and found.energies is None:
        raise StudyError(
            "no energy is known of this system: name what should stay constant, observables={name: function}"
        )
    orbits = range(found.y.shape[2]) if found.y.ndim == 3 else (None,)
    errors = [error_series(found, observable, orbit) for orbit in orbits]
    drifts = [judged_series(series) for series in errors]
    worst = max(range(len(drifts)), key=lambda k: (SEVERITY.index(drifts[k].verdict), drifts[k].bound))
    return DriftRow(
        method=found.method,
        step=found.step,
        t=errors[worst].t,
        error=errors[worst].error,
        relative=errors[worst].relative,
        drift=drifts[worst],
        steps=found.steps,
        evaluations=found.evaluations,
        cpu_seconds=seconds,
        compile_seconds=found.compile_seconds,
        precision=found.precision,
        final=found.final if found.final.ndim == 1 else found.final[:, worst],
        observable=observable.name,
        orbits=tuple(drifts) if len(drifts) > 1 else (),
    )


def _symplecticity(run: Run, found: Trajectory, seconds: float) -> DriftRow:
    """Judge the change of the bilinear covariant of two variations that the method carries along."""
    starts = run.y0 if run.y0.ndim == 2 else run.y0[:, None]
    tangents = [tangent_of(run.hamiltonian, start) for start in starts.T]
    y0 = np.stack([each.y0 for each in tangents], axis=1)
    varied = replace(run, hamiltonian=tangents[0].hamiltonian, y0=y0 if run.y0.ndim == 2 else y0[:, 0])
    seen = Observable(SYMPLECTICITY, tangents[0].covariant)
    row = _judged(varied(run.span, run.samples, [seen], run.cadence), seen, seconds)
    return replace(row, evaluations=found.evaluations, final=found.final)


def _seconds_of_steps(found: Trajectory, run: Run) -> float:
    """Return the processor time of the steps alone.

    Keeping a sample costs a method of fixed step as much as a thousand cheap steps do; so a part of the run is
    timed again without samples. Its steps all cost the same.
    """
    if found.method.engine is not FIXED_STEPS or found.step is None:
        return found.cpu_seconds
    part = min(found.steps, TIMED_STEPS)
    again = min(run(part * found.step, 1).cpu_seconds for _ in range(2))
    return min(found.cpu_seconds, again * found.steps / part)
