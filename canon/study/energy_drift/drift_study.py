"""Drift study: methods side by side on one motion, how their errors grow and what they cost."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import partial
from inspect import signature
from typing import TYPE_CHECKING, Any, Never, overload

import numpy as np

from canon.display import preformatted
from canon.expression.symbols.user_input import counted
from canon.flow.method.engine import FIXED_STEPS
from canon.flow.method.method import RK4, Gauss, Splitting, Taylor
from canon.flow.method.method_text import method_of
from canon.flow.method.setting import Setting
from canon.flow.propagation import is_separable
from canon.flow.system_request import is_hamiltonian
from canon.study.energy_drift.drift import FEWEST
from canon.study.energy_drift.drift_rows import DriftRow, Run, drift_row, drift_rows
from canon.study.energy_drift.drift_table import drift_table
from canon.study.energy_drift.sample_times import GOLDEN, SAMPLES_PER_PERIOD, usual_samples
from canon.study.errors import StudyError
from canon.study.motion.extended_phase_space import driven
from canon.study.motion.observables import ENERGY, observables_of
from canon.study.motion.studied_motion import Subject, checked_duration, subject_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray
    from sympy import Expr, Symbol

    from canon.flow.method.method import Method
    from canon.flow.method.method_text import MethodGiven
    from canon.flow.run.hamiltonian_system import HamiltonianSystem
    from canon.flow.system.recognised_system import MovableSystem
    from canon.scene.scene import Scene
    from canon.study.motion.extended_phase_space import Driven

__all__ = ["DriftRow", "DriftStudy", "StudyError", "drift_row", "drift_study"]

STEPS_PER_PERIOD = 48.0 + GOLDEN
"""Steps in a period where no step is given: about 50, but never in step with the motion.

A whole number of steps in a period meets the pericentre at nearly the same phase for a long time, and its
slow shift then looks like a drift.
"""

MOST_SAMPLES = 2**17
"""Samples that are kept at most unless more are asked for."""

BLOCKS_KEPT = 2**13
"""Blocks that a run is judged by where the observables are followed inside the loop."""


@dataclass(frozen=True)
class DriftStudy:
    """The errors of several methods on one motion.

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
        One a method and observable, in the order asked for.
    """

    title: str
    span: float
    period: float | None
    time_unit: str
    rows: tuple[DriftRow, ...]

    @property
    def observables(self) -> tuple[str, ...]:
        """What was followed."""
        return tuple(dict.fromkeys(row.observable for row in self.rows))

    def __repr__(self) -> str:
        return f"<DriftStudy: {counted(len(self.rows), 'row')}; {self.title}>"

    def __str__(self) -> str:
        return drift_table(self)

    def _repr_html_(self) -> str:
        return preformatted(str(self))

    def only(self, observable: str) -> DriftStudy:
        """Return the rows of one observable."""
        return replace(self, rows=tuple(row for row in self.rows if row.observable == observable))


def drift_study(
    system: Scene | MovableSystem,
    y0: ArrayLike | Mapping[Any, Any] | str | None = None,
    *more: Never,
    methods: Sequence[MethodGiven] | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    periods: float = 1000.0,
    span: float | None = None,
    period: float | None = None,
    precision: str | None = None,
    parameters: Mapping[Symbol | str, float] | None = None,
    samples: int | None = None,
    observables: Sequence[str] | Mapping[str, Expr] = (ENERGY,),
    orbits: int = 1,
    scatter: float = 1e-3,
    seed: int = 0,
    progress: Callable[[str, float], None] | None = None,
    **unknown: Never,
) -> DriftStudy:
    """Run one motion with several methods and judge how the errors of each grow.

    Parameters
    ----------
    system
        A Hamiltonian, a scene or its name, or any other system that :func:`canon.propagate` takes: its energy is then
        that less the work of the forces; of a vector field, which has none, give ``observables``. Where a Hamiltonian
        depends on the time, "energy" is the energy less the work done from outside, H − ∫ ∂H/∂t dt
        (:mod:`canon.study.motion.extended_phase_space`).
    y0
        Initial state, shape (2n,), or a number for each variable, or for a scene the name of a start; a scene's default
        start if left out.
    *more
        Nothing: the duration is given by name, and what stands behind the start is refused.
    methods
        The methods, as values or by name. If left out: Kahan & Li's of order 8 and Verlet's where H = T(p) + V(q),
        else Gauss's of order 8 and 2; RK4; heyoka's Taylor method.
    step
        Step of the methods of fixed step; about a fiftieth of the period if left out.
    tolerance
        Tolerance of the adaptive methods, in place of their own.
    periods, span
        Duration in periods, or in units of time.
    period
        Period of the motion; the scene's if left out.
    precision
        Arithmetic, as :func:`canon.propagate` takes it; of those meant for fixed steps, adaptive
        methods take none and run in doubles.
    parameters
        Values of parameters by symbol or name; a scene has its own, which these replace.
    samples
        Samples to keep of each run; about 16 a period if left out. Where that is more than 131072, methods of
        fixed step are followed inside their loops instead, 16 times a period.
    observables
        What should stay constant: ``"energy"``, ``"momenta"`` (those of ignorable coordinates), ``"integrals"``
        (a scene's known ones), ``"symplecticity"`` (the bilinear covariant of two variations), any of them by
        name; or functions of (q, p) of your own by name, such as the residual of a constraint.
    orbits
        How many orbits to run: the start, and others near it.
    scatter, seed
        Relative size of the (normal) distances of their starts from it, and the seed they are drawn with.
    progress
        Called with the method's name and the fraction of its run that is done.
    **unknown
        Nothing: what :func:`canon.propagate` calls ``t_span`` is refused, with what to write.

    Returns
    -------
    DriftStudy
        One row a method and observable. A run that fails is a row with the reason, never data.

    Raises
    ------
    StudyError
        Where the request makes no sense, or every method failed.
    TypeError
        Where there is no such argument.

    Examples
    --------
    >>> from canon import RK4, Splitting
    >>> from canon.scene import find
    >>> study = drift_study(find("henon-heiles"), methods=[Splitting("verlet"), RK4()], periods=200)
    >>> [row.drift.verdict.value for row in study.rows]
    ['bounded', 'secular']
    """
    _refuse_other(more, unknown)
    if span is not None:
        checked_duration(span, y0, "drift_study")
    subject = subject_of(system, y0, parameters)
    timed = driven(subject.hamiltonian) if subject.depends_on_time else None
    hamiltonian = subject.hamiltonian if timed is None else timed.hamiltonian
    given = _usual_methods(hamiltonian, subject.values) if methods is None else methods
    chosen = tuple(map(method_of, given))
    if not chosen:
        raise StudyError("no method to study: name at least one")
    known_period = period if period is not None else subject.period
    whole = span if span is not None else _span(periods, known_period)
    span = _checked("run over a time", "duration", whole)
    h = _checked("step", "one", step if step is not None else _usual_step(chosen, known_period))
    kept = (
        samples
        if samples is not None
        else usual_samples(span, known_period, MOST_SAMPLES, unknown=MOST_SAMPLES)
    )
    if kept < FEWEST:
        raise StudyError(f"{kept} samples are too few to judge growth: keep at least {FEWEST}")
    followed = observables_of(subject.system, subject.hamiltonian, observables, subject.state, subject.values)
    starts = _starts(subject.state, orbits, scatter, seed)
    if timed is not None:
        followed, starts = tuple(map(timed.observable, followed)), timed.state(starts)
    inside = samples is None and known_period is not None and kept >= MOST_SAMPLES
    rows: list[DriftRow] = []
    for method in chosen:
        stepped, watched = method.engine.takes_step, inside and method.engine is FIXED_STEPS
        run = Run(
            hamiltonian,
            starts,
            span,
            Setting(
                method,
                step=h if stepped else None,
                tolerance=None if stepped else tolerance,
                precision=method.engine.understood(precision),
            ),
            BLOCKS_KEPT if watched else kept,
            parameters=subject.values,
            cadence=_cadence(h, known_period) if watched else None,
        )
        rows.extend(drift_rows(run, followed, partial(progress, str(method)) if progress else None))
    return _study(subject, timed, rows, span, known_period)


def _refuse_other(more: Sequence[object], unknown: Mapping[str, object]) -> None:
    """Refuse arguments that are none of drift_study; t_span among them, which others take before the start."""
    if more or "t_span" in unknown:
        raise TypeError(
            "drift_study takes the system and the start in this order, and the duration by name: drift_study(system, "
            "y0, span=1000), in units of time, or periods=1000"
        )
    for name in unknown:
        near = get_close_matches(
            name, [each for each in signature(drift_study).parameters if len(each) > 4], n=1
        )
        raise TypeError(
            f"drift_study has no argument {name}=" + (f": did you mean {near[0]}=?" if near else "")
        )


def _study(
    subject: Subject, timed: Driven | None, rows: Sequence[DriftRow], span: float, period: float | None
) -> DriftStudy:
    """Return the study of these rows, its states without the time that was added to them."""
    if all(row.failure for row in rows):
        reasons = "; ".join(f"{row.method}: {row.failure}" for row in rows)
        raise StudyError(f"every run failed: {reasons}")
    title = subject.title
    if timed is not None:
        rows = [replace(row, final=timed.original(row.final)) if row.drift else row for row in rows]
        title += "; energy less the work done from outside"
    return DriftStudy(title, span, period, subject.time_unit, tuple(rows))


@overload
def _checked(what: str, wanted: str, number: float) -> float: ...
@overload
def _checked(what: str, wanted: str, number: float | None) -> float | None: ...
def _checked(what: str, wanted: str, number: float | None) -> float | None:
    if number is not None and not (math.isfinite(number) and number > 0.0):
        raise StudyError(f"a {what} of {number} makes no sense: give a positive, finite {wanted}")
    return number


def _usual_methods(
    hamiltonian: HamiltonianSystem, parameters: Mapping[Symbol | str, float]
) -> tuple[Method, ...]:
    """Return two symplectic methods that apply, an ordinary one and heyoka's."""
    if not is_hamiltonian(hamiltonian):
        return RK4(), Taylor()
    if is_separable(hamiltonian, parameters):
        return Splitting("kahan-li-8"), Splitting("verlet"), RK4(), Taylor()
    return Gauss(4), Gauss(1), RK4(), Taylor()


def _starts(state: NDArray[np.float64], orbits: int, scatter: float, seed: int) -> NDArray[np.float64]:
    """Return the start, or starts scattered about it, shape (2n, orbits), the first one unmoved."""
    if orbits < 1:
        raise StudyError(f"{orbits} orbits: run at least one")
    if orbits == 1:
        return state
    if not (math.isfinite(scatter) and scatter > 0.0):
        raise StudyError(f"a scatter of {scatter} makes no sense: give a positive, finite one")
    n = state.size // 2
    size = np.repeat([np.linalg.norm(half) / math.sqrt(n) for half in (state[:n], state[n:])], n)
    moved = np.random.default_rng(seed).normal(size=(2 * n, orbits - 1)) * (scatter * size)[:, None]
    return state[:, None] + np.concatenate([np.zeros((2 * n, 1)), moved], axis=1)


def _cadence(step: float | None, period: float | None) -> int:
    """Return after how many steps observables are looked at to see a period about 16 times."""
    return max(1, int((period or 1.0) / (step or 1.0) / SAMPLES_PER_PERIOD))


def _span(periods: float, period: float | None) -> float:
    if period is None:
        raise StudyError("a Hamiltonian does not tell its period: give period=, or the duration as span=")
    return periods * period


def _usual_step(methods: Sequence[Method], period: float | None) -> float | None:
    if period is not None:
        return period / STEPS_PER_PERIOD
    stepped = [str(method) for method in methods if method.engine.takes_step]
    if stepped:
        raise StudyError(
            f"{stepped[0]} takes steps of a given size: give step=, or period= to take about a fiftieth of it"
        )
    return None
