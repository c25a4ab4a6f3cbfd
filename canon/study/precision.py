"""Work against precision: what each digit of a motion costs with each method."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from canon.display import preformatted
from canon.expression.given import counted
from canon.flow.method import Stepped, Taylor
from canon.flow.propagate import NonFiniteStateError, propagate
from canon.scene.scene import Scene
from canon.study.errors import StudyError
from canon.study.resonance import resonant_steps

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray
    from sympy import Symbol

    from canon.flow.method import Method
    from canon.flow.propagate import HamiltonianSystem
    from canon.flow.trajectory import Trajectory

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
        Largest abs(E(t) − E(0))/abs(E(0)).
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
        said = self.failure or f"energy to {self.energy_error:.1e}, position to {self.position_error:.1e}"
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
        from canon.study.choose_table import work_table

        return work_table(self)

    def _repr_html_(self) -> str:
        return preformatted(str(self))


def work_precision(
    system: Scene | HamiltonianSystem,
    y0: ArrayLike | str | None,
    span: float,
    methods: Sequence[Method],
    *,
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
    system, y0
        A scene and a start or state (q, p), or a Hamiltonian and a state.
    span
        Duration in units of time; short enough that the motion can be followed to its end.
    methods
        The methods.
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
        Where steps or tolerances are missing, or the reference fails.

    Examples
    --------
    >>> from canon import RK4
    >>> from canon.scene import find
    >>> found = work_precision(find("henon-heiles"), None, 30.0, [RK4()], steps=[0.2, 0.1], repetitions=1)
    >>> round(math.log2(found.rows[0].position_error / found.rows[1].position_error))
    4
    """
    if repetitions < 1:
        raise StudyError(f"repetitions = {repetitions}: run each method at least once")
    given_steps, given_tolerances = tuple(steps), tuple(tolerances)
    several = (precision,) if precision is None or isinstance(precision, str) else tuple(precision)
    cases = [
        (method, *setting, arithmetic)
        for method in methods
        for arithmetic in (several if isinstance(method, Stepped) else (None,))
        for setting in _settings(method, given_steps, given_tolerances)
    ]
    if isinstance(system, Scene):
        given = {str(name): value for name, value in (parameters or {}).items()}
        scene = system.with_parameters(**given)
        values: Mapping[Symbol | str, float] = {**scene.values}
        state = scene.state(y0) if y0 is None or isinstance(y0, str) else np.asarray(y0, dtype=np.float64)
        hamiltonian, title = scene.hamiltonian, scene.title
    else:
        values, state = parameters or {}, np.asarray(y0, dtype=np.float64)
        hamiltonian, title = system, "Hamiltonian"

    def run(
        method: Method,
        step: float | None,
        tolerance: float | None,
        arithmetic: str | None,
        samples: int = SAMPLES,
    ) -> Trajectory:
        return propagate(
            hamiltonian,
            state,
            (0.0, span),
            method=method,
            step=step,
            tolerance=tolerance,
            precision=arithmetic,
            parameters=values,
            samples=samples,
        )

    try:
        reference = run(REFERENCE, None, None, "quad").q[:, -1]
    except (NonFiniteStateError, ValueError) as error:
        raise StudyError(f"the reference could not be run: {error}") from error
    rows: list[WorkRow] = []
    for number, (method, step, tolerance, arithmetic) in enumerate(cases, 1):
        try:
            found = run(method, step, tolerance, arithmetic)
            timed = [run(method, step, tolerance, arithmetic, samples=1) for _ in range(repetitions)]
            rows.append(_measured(found, timed, tolerance, reference))
        except (NonFiniteStateError, ValueError) as error:
            rows.append(WorkRow(method, step, tolerance, failure=str(error), precision=arithmetic or ""))
        if progress is not None:
            progress(number / len(cases))
    return WorkPrecision(title, span, tuple(_marked(rows)))


def _settings(
    method: Method, steps: Iterable[float], tolerances: Iterable[float]
) -> list[tuple[float | None, float | None]]:
    """Return (step, tolerance) pairs, precision rising."""
    if isinstance(method, Stepped):
        if not (ordered := sorted(steps, reverse=True)):
            raise StudyError(f"{method} takes steps of given sizes: give steps")
        return [(step, None) for step in ordered]
    if not (ordered := sorted(tolerances, reverse=True)):
        raise StudyError(f"{method} chooses its steps by a tolerance: give tolerances")
    return [(None, tolerance) for tolerance in ordered]


def _measured(
    found: Trajectory, timed: Sequence[Trajectory], tolerance: float | None, reference: NDArray[np.float64]
) -> WorkRow:
    return WorkRow(
        method=found.method,
        step=found.step,
        tolerance=tolerance,
        cpu_seconds=min(each.cpu_seconds for each in timed),
        evaluations=found.evaluations,
        energy_error=float(np.abs(found.energy_error).max()),
        position_error=float(np.linalg.norm(found.q[:, -1] - reference) / np.linalg.norm(reference)),
        precision=found.precision,
    )


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
