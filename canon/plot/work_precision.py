"""Work-precision pictures: what precision costs, and how the error depends on the step."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from canon.plot.case_labels import labels_of
from canon.plot.style import (
    COLOURS,
    GREY,
    LINES,
    MARKERS,
    all_to_draw,
    logarithmic,
    new_axes,
    tidy,
    to_draw,
)
from canon.study.method_choice.resonance import resonant_steps

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from canon.study.cases.result import Result
    from canon.study.energy_drift.drift_study import DriftRow
    from canon.study.method_choice.choose import Choice
    from canon.study.method_choice.work_precision import WorkPrecision, WorkRow

__all__ = ["plot_drift_by_step", "plot_work_precision"]

_COSTS = {
    "cpu": ("cpu_seconds", "processor time (s)"),
    "evaluations": ("evaluations", "evaluations of the force"),
}
"""What a run measures as its cost, and the axis of it."""
_ERRORS = {
    "position": "relative error of the final position",
    "energy": "largest relative energy error |ΔE/E|",
}


def plot_work_precision(
    found: WorkPrecision,
    ax: Axes | None = None,
    *,
    cost: str = "cpu",
    error: str = "position",
    chosen: Choice | None = None,
) -> Axes:
    """Draw the error of each run against its cost, both logarithmic, one line a method; rings mark resonant steps.

    Parameters
    ----------
    found
        What :func:`canon.study.method_choice.work_precision.work_precision` returned.
    ax
        Where to draw; a new figure if left out.
    cost
        ``"cpu"`` for processor time or ``"evaluations"`` for evaluations of the force.
    error
        ``"position"`` at the end, or the largest in ``"energy"``.
    chosen
        What :func:`canon.choose` chose for this motion, drawn as a star with the accuracy wanted;
        its cost is taken for as long a run as the others are.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    TypeError
        Where it is nothing that work_precision returned, or the choice is none.
    ValueError
        Where there is no such cost or error, or the choice was made for another error.
    """
    from canon.study.method_choice.choose import Choice
    from canon.study.method_choice.work_precision import WorkPrecision

    to_draw(found, WorkPrecision, "plot_work_precision", "work_precision(…) returns one")
    if chosen is not None:
        to_draw(chosen, Choice, "plot_work_precision as chosen=", "choose(…) returns one")
    if cost not in _COSTS or error not in _ERRORS:
        raise ValueError(f"cost={cost!r}, error={error!r}: there are cpu, evaluations; position, energy")
    if chosen is not None and chosen.observable != error:
        raise ValueError(
            f"the choice keeps the error of the {chosen.observable}; draw error={chosen.observable!r}"
        )
    axes = new_axes(ax)
    measure, label = _COSTS[cost]
    family = _families(found.rows)
    for index, name in enumerate(dict.fromkeys(family.values())):
        rows = [row for k, row in enumerate(found.rows) if family[k] == name and not row.failure]
        x = np.array([getattr(row, measure) for row in rows], dtype=np.float64)
        y = np.array([getattr(row, f"{error}_error") for row in rows])
        drawn = (x > 0.0) & (y > 0.0)
        if not drawn.any():
            continue
        _draw(axes, x[drawn], y[drawn], index, name)
        _ring(axes, x, y, drawn & np.array([row.resonant for row in rows]), index)
    if chosen is not None:
        _draw_choice(axes, chosen, found.span, cost)
    logarithmic(axes)
    axes.set_xlabel(label)
    axes.set_ylabel(_ERRORS[error])
    axes.set_title(found.title, loc="left", fontsize="medium", wrap=True)
    _legend(axes)
    tidy(axes)
    return axes


def plot_drift_by_step(
    of: WorkPrecision | Sequence[DriftRow] | Sequence[Result],
    ax: Axes | None = None,
    *,
    what: str = "bound",
) -> Axes:
    """Draw the energy error or its drift against the step, both logarithmic, one line a method.

    Rings mark steps in resonance with the motion: over ten times worse than their neighbours let expect. Where no
    drift was found, its detection limit is drawn as a downward triangle: the drift is below it.

    Parameters
    ----------
    of
        Work–precision runs, rows of drift studies, or cases of a study, of which each motion has lines
        of its own.
    ax
        Where to draw; a new figure if left out.
    what
        ``"bound"`` for the largest ``|ΔE/E|``, ``"slope"`` for the drift per unit of time (not of work–precision
        runs, which are too short for one): of the mean, or of the oscillation's size where that grows faster.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    TypeError
        Where it is nothing of these.
    ValueError
        Where there is no such quantity.

    Examples
    --------
    >>> from canon import RK4, work_precision
    >>> from canon.scene import find
    >>> found = work_precision(find("henon-heiles"), 20.0, methods=[RK4()], steps=[0.4, 0.2, 0.1], repetitions=1)
    >>> plot_drift_by_step(found).get_xlabel()
    'step (units of time)'
    """
    from canon.study.cases.result import Result
    from canon.study.energy_drift.drift_study import DriftRow
    from canon.study.method_choice.work_precision import WorkPrecision

    instead = (
        "give what work_precision(…) returned, the rows of drift studies, study.rows, or results_of(file)"
    )
    if not isinstance(of, WorkPrecision):
        of = all_to_draw(of, (WorkPrecision, DriftRow, Result), "plot_drift_by_step", instead)
    if what not in ("bound", "slope") or (what == "slope" and isinstance(of, WorkPrecision)):
        raise ValueError(f"what={what!r}: there are bound and, of drift studies, slope")
    axes = new_axes(ax)
    points = _points(of, what)
    limits = False
    for index, name in enumerate(dict.fromkeys(point.name for point in points)):
        own = sorted((point for point in points if point.name == name), key=lambda point: point.step)
        h, size = (np.array([getattr(point, part) for point in own]) for part in ("step", "size"))
        below = np.array([point.limit for point in own])
        _draw(axes, h, size, index, name)
        _ring(axes, h, size, resonant_steps(h, size) & ~below, index)
        if below.any():
            limits = True
            axes.plot(h[below], size[below], "v", markersize=9, markerfacecolor="white", color=_colour(index))
    logarithmic(axes)
    _plain_ticks(axes)
    axes.set_xlabel("step (units of time)")
    axes.set_ylabel(
        "largest relative energy error |ΔE/E|" if what == "bound" else "drift of ΔE/E per unit of time"
    )
    if limits:
        axes.set_title("▽ no drift found: it is below this limit", loc="left", fontsize="small", color=GREY)
    _legend(axes)
    tidy(axes)
    return axes


@dataclass(frozen=True)
class _Point:
    """A step and the size of an error or its drift, or a limit that it is below."""

    name: str
    step: float
    size: float
    limit: bool = False


def _points(of: WorkPrecision | Sequence[DriftRow] | Sequence[Result], what: str) -> list[_Point]:
    from canon.study.method_choice.work_precision import WorkPrecision

    if isinstance(of, WorkPrecision):
        family = _families(of.rows)
        found = [_Point(family[k], row.step or 0.0, row.energy_error) for k, row in enumerate(of.rows)]
    else:
        drawn = [(each, point) for each in of if (point := _point_of_drift(each, what)) is not None]
        motions = _motions([each for each, _ in drawn])
        found = [
            replace(point, name=f"{motion}{point.name}")
            for (_, point), motion in zip(drawn, motions, strict=True)
        ]
    return [point for point in found if point.step > 0.0 and point.size > 0.0]


def _motions(of: Sequence[DriftRow | Result]) -> list[str]:
    """Return what stands before the method of each: its motion, where they are cases of several."""
    from canon.study.cases.result import Result

    results = [each for each in of if isinstance(each, Result)]
    if len(results) < len(of) or len({result.case.what_moves for result in results}) < 2:
        return [""] * len(of)
    return [f"{motion}: " for motion in labels_of(results)[0]]


def _point_of_drift(of: DriftRow | Result, what: str) -> _Point | None:
    from canon.study.energy_drift.drift_study import DriftRow

    if isinstance(of, DriftRow):
        drift = of.drift
        if drift is None:
            return None
        slope = max(abs(drift.slope), abs(drift.amplitude_slope))
        values = (drift.bound, slope, drift.detection_limit, drift.verdict.value)
        return _point(str(of.method), of.step, what, *values)
    if not of.numbers:
        return None
    name = ", ".join(part for part in (str(of.case.method), of.case.precision) if part)
    numbers = of.numbers
    slope = max(abs(numbers["slope"]), abs(numbers["amplitude_slope"]))
    values = (numbers["bound"], slope, numbers["detection_limit"], numbers["verdict"])
    return _point(name, numbers["step"], what, *values)


def _point(
    name: str, step: float | None, what: str, bound: float, slope: float, limit: float, verdict: str
) -> _Point:
    if what == "bound":
        return _Point(name, step or 0.0, bound)
    drifts = verdict in ("secular", "diverged")
    return _Point(name, step or 0.0, slope if drifts else limit, limit=not drifts)


def _draw(axes: Axes, x: np.ndarray, y: np.ndarray, index: int, name: str) -> None:
    axes.plot(
        x,
        y,
        color=_colour(index),
        linestyle=LINES[index % len(LINES)],
        marker=MARKERS[index % len(MARKERS)],
        markersize=4,
        linewidth=1.5,
        label=name,
    )


def _ring(axes: Axes, x: np.ndarray, y: np.ndarray, marked: np.ndarray, index: int) -> None:
    if marked.any():
        axes.plot(x[marked], y[marked], "o", markersize=11, markerfacecolor="none", color=_colour(index))


def _plain_ticks(axes: Axes) -> None:
    """Write steps as 0.02, 0.05, 0.1: they rarely span more than two powers of ten."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda step, _: f"{step:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())


def _draw_choice(axes: Axes, chosen: Choice, span: float, cost: str) -> None:
    best = chosen.chosen
    price = best.predicted_cost if cost == "cpu" else best.evaluations
    axes.axhline(chosen.accuracy, color=GREY, linewidth=1.0, linestyle=":", zorder=1)
    axes.annotate(
        "accuracy wanted",
        (0.01, chosen.accuracy),
        (0, 3),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        color=GREY,
        fontsize="small",
    )
    setting = f", h = {best.step:.3g}" if best.step is not None else ""
    axes.plot(
        price * span / chosen.span,
        best.predicted_error,
        "*",
        markersize=17,
        color="#F0E442",
        markeredgecolor="black",
        linestyle="none",
        label=f"chosen: {best.method}{setting}" if chosen.reached else "best, but not enough",
        zorder=5,
    )


def _legend(axes: Axes) -> None:
    if axes.lines:
        axes.legend(frameon=False, fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))


def _colour(index: int) -> str:
    return COLOURS[index % len(COLOURS)]


def _families(rows: Sequence[WorkRow]) -> dict[int, str]:
    """Return what each run belongs to: its method whatever the tolerance, and its arithmetic where that differs."""
    methods = [
        str(row.method).split("(")[0] if row.tolerance is not None else str(row.method) for row in rows
    ]
    used: dict[str, set[str]] = {}
    for name, row in zip(methods, rows, strict=True):
        used.setdefault(name, set()).update({row.precision} - {""})
    return {
        k: f"{name}, {row.precision}" if len(used[name]) > 1 and row.precision else name
        for k, (name, row) in enumerate(zip(methods, rows, strict=True))
    }
