"""Work-precision measurement: what each digit of a motion costs with each method."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.display import preformatted
from canon.expression.symbols.user_input import counted
from canon.flow.method.adaptive_methods import Taylor
from canon.flow.method.method_text import method_of
from canon.flow.method.setting import Setting
from canon.flow.request import Request
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.study.energy_drift.drift_table import aligned
from canon.study.errors import StudyError
from canon.study.method_choice.choice_table import duration_in_words
from canon.study.method_choice.resonance import resonant_steps
from canon.study.motion.quiet_run import run_quietly
from canon.study.motion.studied_motion import Subject, checked_duration, subject_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray
    from sympy import Symbol

    from canon.flow.method.method import Method
    from canon.flow.method.method_text import MethodGiven
    from canon.flow.system.recognised_system import MovableSystem
    from canon.flow.trajectory import Trajectory
    from canon.scene.scene import Scene

__all__ = ["WorkPrecision", "WorkRow", "work_precision"]

REFERENCE = Taylor(1e-30)
"""Method of the reference, run in quadruple precision."""

SAMPLES = 1000
"""Samples the largest energy error is taken over."""


@dataclass(frozen=True)
class WorkRow:
    """One run: what it cost and how precise it was.

    Parameters
    ----------
    method
        The method.
    step, tolerance
        What its precision was set by; None for the other.
    cpu_seconds
        Processor time, the least of the repetitions; compilation and keeping samples left out.
    evaluations
        Evaluations of the force (Taylor: of the series).
    energy_error
        Largest abs(E(t) − E(0))/abs(E(0)), or of what is left of E less the work of forces; NaN where no energy is
        known, as of a vector field, or its change is no error, as of an H that depends on t.
    position_error
        Distance of the final coordinates from those of the reference, over the length of the latter.
    resonant
        Whether the step is in resonance with the motion: its energy error is over ten times larger than
        the smaller and the larger step let expect.
    failure
        Why the run failed; empty where it did not.
    precision
        The arithmetic.
    """

    method: Method
    step: float | None
    tolerance: float | None
    cpu_seconds: float = math.nan
    evaluations: int = 0
    energy_error: float = math.nan
    position_error: float = math.nan
    resonant: bool = False
    failure: str = ""
    precision: str = ""

    def __repr__(self) -> str:
        knob = f"step {self.step:.4g}" if self.step is not None else f"tol {self.tolerance:.2g}"
        energy = "" if math.isnan(self.energy_error) else f"energy to {self.energy_error:.1e}, "
        said = self.failure or f"{energy}position to {self.position_error:.1e}"
        return f"<WorkRow: {self.method}, {knob}, {self.precision}: {said}>"


@dataclass(frozen=True)
class WorkPrecision:
    """Rows of all methods on one motion, by method and rising precision.

    Parameters
    ----------
    title
        What was run.
    span
        Duration of the runs.
    rows
        The runs.
    """

    title: str
    span: float
    rows: tuple[WorkRow, ...]

    def __repr__(self) -> str:
        methods = dict.fromkeys(str(row.method) for row in self.rows)
        return f"<WorkPrecision: {counted(len(self.rows), 'run')} by {', '.join(methods)}; {self.title}>"

    def __str__(self) -> str:
        return work_table(self)

    def _repr_html_(self) -> str:
        return preformatted(str(self))


def work_precision(
    system: Scene | MovableSystem,
    span: float,
    y0: ArrayLike | Mapping[Any, Any] | str | None = None,
    *,
    methods: Sequence[MethodGiven],
    steps: Iterable[float] = (),
    tolerances: Iterable[float] = (),
    precision: str | Sequence[str] | None = None,
    parameters: Mapping[Symbol | str, float] | None = None,
    repetitions: int = 3,
    progress: Callable[[float], None] | None = None,
) -> WorkPrecision:
    """Measure cost and precision of methods for a range of steps and tolerances.

    Parameters
    ----------
    system
        A Hamiltonian, a scene or its name, or any other system that :func:`canon.flow.propagation.propagate` takes.
    span
        Duration in units of time; short enough that the motion can be followed to its end.
    y0
        The starting state, or a number for each variable; of a scene also the name of a start, its default one where
        not given.
    methods
        The methods, as values or by name.
    steps, tolerances
        Steps for the methods of fixed step, tolerances for the others.
    precision
        Arithmetic of the methods of fixed step, or several to compare, lowest first.
    parameters
        Values of parameters; those of a scene are its own unless replaced.
    repetitions
        Times that a run is timed; the least processor time counts.
    progress
        Called with the fraction of the runs that is done.

    Returns
    -------
    WorkPrecision
        One row a run; a run that fails is a row with the reason.

    Raises
    ------
    StudyError
        Where the span is no duration, steps or tolerances are missing, or the reference fails.

    Examples
    --------
    >>> from canon import RK4
    >>> from canon.scene import find
    >>> found = work_precision(find("henon-heiles"), 30.0, methods=[RK4()], steps=[0.2, 0.1], repetitions=1)
    >>> round(math.log2(found.rows[0].position_error / found.rows[1].position_error))
    4
    """
    checked_duration(span, y0, "work_precision")
    if repetitions < 1:
        raise StudyError(f"repetitions = {repetitions}: run each method at least once")
    several = (precision,) if precision is None or isinstance(precision, str) else tuple(precision)
    settings = _settings(tuple(map(method_of, methods)), several, tuple(steps), tuple(tolerances))
    subject = subject_of(system, y0, parameters)
    try:
        reference = _run(subject, Setting(REFERENCE, precision="quad"), span, SAMPLES).q[:, -1]
    except (NonFiniteStateError, ValueError) as error:
        raise StudyError(f"the reference could not be run: {error}") from error
    rows: list[WorkRow] = []
    for number, setting in enumerate(settings, 1):
        rows.append(_row(subject, setting, span, repetitions, reference))
        if progress is not None:
            progress(number / len(settings))
    return WorkPrecision(subject.title, span, tuple(_marked(rows)))


def _settings(
    methods: Sequence[Method],
    precisions: Sequence[str | None],
    steps: Sequence[float],
    tolerances: Sequence[float],
) -> list[Setting]:
    """Return what is measured of all methods, of each the precision rising."""
    found: list[Setting] = []
    for method in methods:
        if method.engine.takes_step:
            if not steps:
                raise StudyError(f"{method} takes steps of given sizes: give steps")
            falling = sorted(steps, reverse=True)
            found += [Setting(method, step, precision=each) for each in precisions for step in falling]
        elif not tolerances:
            raise StudyError(f"{method} chooses its steps by a tolerance: give tolerances")
        else:
            found += [Setting(method, tolerance=each) for each in sorted(tolerances, reverse=True)]
    return found


def _run(subject: Subject, setting: Setting, span: float, samples: int) -> Trajectory:
    motion = Request(
        subject.hamiltonian, (0.0, span), subject.state, parameters=subject.values, samples=samples
    )
    return run_quietly(motion.by(setting))


def _row(
    subject: Subject, setting: Setting, span: float, repetitions: int, reference: NDArray[np.float64]
) -> WorkRow:
    """Return what it costs and how far it is off; a run that fails with the reason."""
    try:
        found = _run(subject, setting, span, SAMPLES)
        timed = [_run(subject, setting, span, samples=1) for _ in range(repetitions)]
        return _measured(found, timed, setting.tolerance, reference)
    except (NonFiniteStateError, ValueError) as error:
        return WorkRow(
            setting.method,
            setting.step,
            setting.tolerance,
            failure=str(error),
            precision=setting.arithmetic,
        )


def _measured(
    found: Trajectory, timed: Sequence[Trajectory], tolerance: float | None, reference: NDArray[np.float64]
) -> WorkRow:
    return WorkRow(
        method=found.method,
        step=found.step,
        tolerance=tolerance,
        cpu_seconds=min(each.cpu_seconds for each in timed),
        evaluations=found.evaluations,
        energy_error=float(np.abs(found.energy_error).max()) if _has_energy_error(found) else math.nan,
        position_error=float(np.linalg.norm(found.q[:, -1] - reference) / np.linalg.norm(reference)),
        precision=found.precision,
    )


def _has_energy_error(found: Trajectory) -> bool:
    """Tell whether an energy is known whose change, less the work that was integrated along, is an error."""
    return found.energies is not None and (found.autonomous or found.record.moving is not None)


def _marked(rows: Sequence[WorkRow]) -> list[WorkRow]:
    """Mark the steps that are in resonance with the motion."""
    marked = list(rows)
    steps: dict[tuple[str, str], list[tuple[int, float]]] = {}
    for i, row in enumerate(rows):
        if row.step is not None:
            steps.setdefault((str(row.method), row.precision), []).append((i, row.step))
    for of_method in steps.values():
        errors = [rows[i].energy_error for i, _ in of_method]
        resonant = resonant_steps([step for _, step in of_method], errors)
        for (i, _), is_resonant in zip(of_method, resonant.tolist(), strict=True):
            marked[i] = replace(rows[i], resonant=is_resonant)
    return marked


def work_table(work: WorkPrecision) -> str:
    """Return what each run cost and how precise it was, as a table with a title.

    Examples
    --------
    >>> from canon import RK4, work_precision
    >>> from canon.scene import find
    >>> print(work_table(work_precision(find("henon-heiles"), 5.0, methods=[RK4()], steps=[0.1])).splitlines()[1])
    t = 0 … 5
    """
    head = ("method", "step", "precision", "energy error", "position error", "evaluations", "CPU", "")
    lines = aligned([head, *map(_work_cells, work.rows)], right={1, 3, 4, 5, 6})
    rule = "─" * max(map(len, lines))
    return "\n".join([work.title, f"t = 0 … {work.span:.6g}", "", lines[0], rule, *lines[1:], rule])


def _work_cells(row: WorkRow) -> tuple[str, ...]:
    knob = f"{row.step:.4g}" if row.step is not None else f"tol {row.tolerance:.1e}"
    name = str(row.method).partition("(")[0] if row.step is None else str(row.method)
    if row.failure:
        return (name, knob, row.precision, "", "", "", "", f"failed: {row.failure}")
    return (
        name,
        knob,
        row.precision,
        "–" if math.isnan(row.energy_error) else f"{row.energy_error:.1e}",
        f"{row.position_error:.1e}",
        f"{row.evaluations:,}",
        duration_in_words(row.cpu_seconds),
        "resonant step" if row.resonant else "",
    )
