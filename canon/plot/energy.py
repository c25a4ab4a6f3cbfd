"""Energy errors along runs: their size over time, and the block means that drifts are judged by."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from canon.plot.case_labels import error_symbol, labels_of
from canon.plot.style import (
    COLOURS,
    GREY,
    LINES,
    all_to_draw,
    label_ends,
    logarithmic,
    new_axes,
    tidy,
    to_draw,
)
from canon.study.energy_drift.envelope import envelope_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes

    from canon.array import Array
    from canon.flow.trajectory import Trajectory
    from canon.study.cases.result import Result
    from canon.study.energy_drift.drift import Drift
    from canon.study.energy_drift.drift_study import DriftRow, DriftStudy

__all__ = ["draw_guides", "plot_block_means", "plot_energy_error", "plot_errors"]

GUIDES = ((0.0, "$t^0$  bounded"), (0.5, "$t^{1/2}$  round-off"), (1.0, "$t^1$  secular"))


def plot_energy_error(
    of: DriftStudy | Trajectory | Sequence[Trajectory] | Sequence[Result],
    ax: Axes | None = None,
    *,
    guides: bool = True,
) -> Axes:
    """Draw ``|ΔE/E|``, or the error of what else was followed, against time, both logarithmic, one line a method.

    The line is the largest error in each of about a hundred intervals of log t, the shade below it reaches down to
    the median. Guides show how a bounded error, round-off and a secular error rise. Of many orbits the largest error
    of all counts at each time; a motion back in time is drawn against the time that has passed.

    Parameters
    ----------
    of
        A drift study, one or several trajectories, or cases of a study.
    ax
        Where to draw; a new figure if left out.
    guides
        Whether to draw the guides.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    TypeError
        It is nothing of these.
    """
    axes = new_axes(ax)
    found = _lines(of)
    ends: list[tuple[float, str, str]] = []
    for index, line in enumerate(found.lines):
        colour = COLOURS[index % len(COLOURS)]
        axes.fill_between(line.t, line.median, line.largest, color=colour, alpha=0.15, linewidth=0)
        axes.plot(line.t, line.largest, color=colour, linestyle=LINES[index % len(LINES)], linewidth=1.8)
        ends.append((float(line.largest[-1]), line.name, colour))
    logarithmic(axes)
    axes.set_xlabel(found.time)
    axes.set_ylabel(found.error)
    if found.title:
        axes.set_title(found.title, loc="left", fontsize="medium", wrap=True)
    axes.margins(x=0.0)
    tidy(axes)
    if found.lines and guides:
        draw_guides(axes, [(line.t, line.largest) for line in found.lines])
    label_ends(axes, ends)
    return axes


def plot_errors(study: DriftStudy) -> list[Axes]:
    """Draw the errors of all observables of a drift study in a new figure, one panel each, one above another.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    TypeError
        It is no drift study.
    """
    from canon.study.energy_drift.drift_study import DriftStudy

    instead = "drift_study(…) returns one; plot_energy_error draws motions"
    to_draw(study, DriftStudy, "plot_errors", instead)
    first = new_axes(None)
    names = study.observables
    figure = first.get_figure(root=True)
    if len(names) == 1 or figure is None:
        return [plot_energy_error(study, first)]
    figure.clear()
    figure.set_size_inches(8.0, 1.0 + 3.2 * len(names))
    panels = [figure.add_subplot(len(names), 1, k + 1) for k in range(len(names))]
    figure.suptitle(study.title, fontsize="medium", x=0.02, ha="left")
    for panel, name in zip(panels, names, strict=True):
        plot_energy_error(replace(study.only(name), title=name), panel)
    for panel in panels[:-1]:
        panel.set_xlabel("")
    return panels


def plot_block_means(
    found: Drift | Result, ax: Axes | None = None, *, label: str = "ΔE/E", unit: str = ""
) -> Axes:
    """Draw the weighted window means of an error with its fitted drift and the drift's standard error.

    Parameters
    ----------
    found
        What :func:`canon.study.energy_drift.drift.drift` returned, or a finished case of a study.
    ax
        Where to draw; a new figure if left out.
    label
        Name of the error.
    unit
        Unit of time.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    TypeError
        It is neither.
    """
    from canon.study.cases.result import Result
    from canon.study.energy_drift.drift import Drift

    to_draw(
        found,
        (Drift, Result),
        "plot_block_means",
        "drift(motion) returns one, and results_of(file) holds others",
    )
    axes = new_axes(ax)
    when, mean, slope, slope_error, verdict = _means(found)
    middle, level = float(when.mean()), float(mean.mean())
    power = math.floor(math.log10(scale)) if (scale := float(np.abs(mean).max())) > 0.0 else 0
    factor = 10.0**-power
    t = np.linspace(when[0], when[-1], 101)
    line = level + slope * (t - middle)
    spread = slope_error * np.abs(t - middle)
    axes.fill_between(
        t, factor * (line - spread), factor * (line + spread), color=COLOURS[1], alpha=0.2, linewidth=0
    )
    axes.plot(t, factor * line, color=COLOURS[1], linewidth=1.8, label="fitted drift ± standard error")
    axes.plot(when, factor * mean, "o", color=COLOURS[0], markersize=4, label="window means")
    axes.set_xlabel(_time(unit))
    axes.set_ylabel(f"{label}  in units of 1e{power:+03d}")
    axes.set_title(verdict, loc="left", fontsize="small", wrap=True)
    axes.legend(frameon=False, fontsize="small")
    tidy(axes)
    return axes


def _means(found: Drift | Result) -> tuple[Array, Array, float, float, str]:
    """Return the windows' times and means, the drift with its standard error, and the verdict in words."""
    from canon.study.energy_drift.drift import Drift

    if isinstance(found, Drift):
        verdict = f"{found.verdict.value}: {found.reason}"
        return found.blocks.t, found.blocks.mean, found.slope, found.slope_error, verdict
    if not found.numbers:
        raise ValueError(f"{found.setting} is {found.state.value}: there are no means to draw")
    numbers = found.numbers
    t, mean = (np.array(numbers["means"][name]) for name in ("t", "mean"))
    return t, mean, numbers["slope"], numbers["slope_error"], f"{numbers['verdict']}: {numbers['reason']}"


@dataclass(frozen=True)
class _Line:
    """The size of an error in intervals of log t, and whose it is."""

    name: str
    t: Array
    largest: Array
    median: Array


@dataclass(frozen=True)
class _Lines:
    """What is drawn, and what the axes are called."""

    lines: list[_Line]
    time: str = "time"
    relative: bool = True
    title: str = ""
    observables: tuple[str, ...] = ("energy",)

    @property
    def error(self) -> str:
        """What the errors are called."""
        if self.observables == ("energy",):
            return f"largest {'relative energy error |ΔE/E|' if self.relative else 'energy error |ΔE|'}"
        return f"largest {'relative error |ΔI/I|' if self.relative else 'error |ΔI|'}"


def _line(name: str, t: Array, error: Array) -> list[_Line]:
    """Return the line of an error, none where it is zero throughout."""
    found = envelope_of(t, error)
    return [] if found is None else [_Line(name, found["t"], found["largest"], found["median"])]


def _lines(of: DriftStudy | Trajectory | Sequence[Trajectory] | Sequence[Result]) -> _Lines:
    from canon.flow.trajectory import Trajectory
    from canon.study.cases.result import Result
    from canon.study.energy_drift.drift_study import DriftStudy

    if isinstance(of, DriftStudy):
        return _lines_of_drifts(of)
    of_study, motions = [], []
    instead = "give a motion, several in a list, a drift study, or results of a study"
    for each in all_to_draw(of, (Trajectory, Result, DriftStudy), "plot_energy_error", instead):
        if isinstance(each, DriftStudy):
            raise TypeError(
                "plot_energy_error draws one drift study at a time: call it with each, into Axes of its own"
            )
        (of_study if isinstance(each, Result) else motions).append(each)
    if of_study:
        drawn = [result for result in of_study if result.numbers.get("curve")]
        symbol, (motions, settings) = error_symbol(drawn), labels_of(drawn)
        several_of = [f"{each}; " for each in motions] if len(set(motions)) > 1 else [""] * len(drawn)
        return _Lines(
            [
                _Line(f"{motion}{setting}: {result.numbers['verdict']}", *_arrays(result.numbers["curve"]))
                for result, motion, setting in zip(drawn, several_of, settings, strict=True)
            ],
            relative="/" in symbol,
            observables=("energy",) if "E" in symbol else (),
        )
    lines = [
        line
        for motion in motions
        for line in _line(
            _name_of_motion(motion), np.abs(motion.t - motion.t[0]), _worst(motion.energy_error)
        )
    ]
    return _Lines(lines, relative=all(motion.relative for motion in motions))


def _worst(error: Array) -> Array:
    """Return an error's largest size over the orbits, shape (times,); of those that are still there."""
    return error if error.ndim == 1 else np.fmax.reduce(np.abs(error), axis=1)


def _name_of_motion(motion: Trajectory) -> str:
    return (
        str(motion.method) if motion.y.ndim == 2 else f"{motion.method}, worst of {motion.y.shape[2]} orbits"
    )


def _lines_of_drifts(study: DriftStudy) -> _Lines:
    rows = [row for row in study.rows if row.drift is not None]
    unit = 1.0 if study.period is None else study.period
    lines = [
        line
        for row in rows
        for line in _line(
            f"{row.observable}, " * (len(study.observables) > 1) + _name(row), row.t / unit, row.error
        )
    ]
    axis = "time (periods)" if study.period is not None else _time(study.time_unit)
    single = study.observables[0] if len(study.observables) == 1 else ""
    title = study.title if single in ("", "energy", study.title) else f"{single}. {study.title}"
    return _Lines(lines, axis, all(row.relative for row in rows), title, study.observables)


def _arrays(curve: Mapping[str, Sequence[float]]) -> tuple[Array, Array, Array]:
    t, largest, median = (np.array(curve[name]) for name in ("t", "largest", "median"))
    return t, largest, median


def _time(unit: str) -> str:
    return f"time ({unit})" if unit else "time"


def _name(row: DriftRow) -> str:
    from canon.study.energy_drift.drift import Growth

    found = row.drift
    if found is None:
        return str(row.method)
    size = f" {found.walk:.0e}" if found.verdict in (Growth.ROUND_OFF, Growth.WANDERING) else ""
    return f"{row.method}: {found.verdict.value}{size}"


def draw_guides(axes: Axes, curves: Sequence[tuple[Array, Array]]) -> None:
    """Draw t⁰, t^½ and t¹ from one point, where the curves leave most room for them."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    start, end = left * (right / left) ** 0.04, left * (right / left) ** 0.45
    levels = sorted({low, high, *(y for x, size in curves for y in size[(x >= start) & (x <= end)])})
    steps = np.diff(np.log(levels))
    widest = int(np.argmax(steps))
    base = levels[widest] * math.exp(steps[widest] * 0.2)
    for power, name in GUIDES:
        rise = base * (end / start) ** power
        axes.plot([start, end], [base, rise], color=GREY, linewidth=0.9, zorder=1)
        axes.annotate(
            name, (end, rise), (4, 0), textcoords="offset points", color=GREY, fontsize="small", va="center"
        )
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
