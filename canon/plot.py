"""Pictures: Axes in, Axes out.

Every function draws into the Axes it is given, or into a new figure, and returns the Axes. matplotlib is
loaded when the first picture is asked for.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from canon.flow.trajectory import Trajectory
    from canon.study.comparison import DriftRow, DriftStudy
    from canon.study.drift import Drift
    from canon.study.precision import WorkPrecision, WorkRow

    Array = NDArray[np.float64]

__all__ = ["PlotError", "plot_block_means", "plot_energy_error", "plot_phase_portrait", "plot_work_precision"]

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Distinct for every kind of colour vision: Okabe & Ito, https://jfly.uni-koeln.de/color/."""

LINES = ("-", "--", "-.", (0, (1, 1)), (0, (5, 1, 1, 1, 1, 1)), (0, (8, 2)), (0, (3, 3)))
"""So that lines differ in print as well."""

GUIDES = ((0.0, "$t^0$  bounded"), (0.5, "$t^{1/2}$  round-off"), (1.0, "$t^1$  secular"))

GREY = "#767676"


class PlotError(ImportError):
    """The plotting library is not installed."""


def plot_energy_error(
    of: DriftStudy | Trajectory | Sequence[Trajectory], ax: Axes | None = None, *, guides: bool = True
) -> Axes:
    """Draw |ΔE/E| against time, both logarithmic, one line a method.

    The line is the largest error in each of about a hundred intervals of log t, the shade below it reaches down to
    the median. Guides show how a bounded error, round-off and a secular error rise.

    Parameters
    ----------
    of
        A drift study, or one or several trajectories.
    ax
        Where to draw; a new figure if left out.
    guides
        Whether to draw the guides.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    """
    axes = _axes(ax)
    names, series, unit, label, title = _series(of)
    ends: list[tuple[float, str, str]] = []
    curves: list[tuple[Array, Array]] = []
    for index, (name, (t, error)) in enumerate(zip(names, series, strict=True)):
        found = _envelope(t, np.abs(error))
        if found is None:
            continue
        when, largest, median = found
        colour = COLOURS[index % len(COLOURS)]
        axes.fill_between(when, median, largest, color=colour, alpha=0.15, linewidth=0)
        axes.plot(when, largest, color=colour, linestyle=LINES[index % len(LINES)], linewidth=1.8)
        ends.append((float(largest[-1]), name, colour))
        curves.append((when, largest))
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(unit)
    axes.set_ylabel(label)
    if title:
        axes.set_title(title, loc="left", fontsize="medium")
    axes.margins(x=0.0)
    _tidy(axes)
    if curves and guides:
        _draw_guides(axes, curves)
    _label_ends(axes, ends)
    return axes


def plot_block_means(found: Drift, ax: Axes | None = None, *, label: str = "ΔE/E", unit: str = "") -> Axes:
    """Draw the weighted window means of an error with its fitted drift and the drift's standard error.

    Parameters
    ----------
    found
        What :func:`canon.study.drift.drift` returned.
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
    """
    axes = _axes(ax)
    blocks = found.blocks
    middle, level = float(blocks.t.mean()), float(blocks.mean.mean())
    power = math.floor(math.log10(scale)) if (scale := float(np.abs(blocks.mean).max())) > 0.0 else 0
    factor = 10.0**-power
    t = np.linspace(blocks.t[0], blocks.t[-1], 101)
    line = level + found.slope * (t - middle)
    spread = found.slope_error * np.abs(t - middle)
    axes.fill_between(
        t, factor * (line - spread), factor * (line + spread), color=COLOURS[1], alpha=0.2, linewidth=0
    )
    axes.plot(t, factor * line, color=COLOURS[1], linewidth=1.8, label="fitted drift ± standard error")
    axes.plot(blocks.t, factor * blocks.mean, "o", color=COLOURS[0], markersize=4, label="window means")
    axes.set_xlabel(f"time ({unit})" if unit else "time")
    axes.set_ylabel(f"{label}  in units of 1e{power:+03d}")
    axes.set_title(f"{found.verdict.value}: {found.reason}", loc="left", fontsize="small", wrap=True)
    axes.legend(frameon=False, fontsize="small")
    _tidy(axes)
    return axes


def plot_phase_portrait(
    of: Trajectory | Sequence[Trajectory], ax: Axes | None = None, *, degree: int = 0, dots: bool = False
) -> Axes:
    """Draw one coordinate against its momentum along one or several trajectories.

    Parameters
    ----------
    of
        The trajectories.
    ax
        Where to draw; a new figure if left out.
    degree
        Which degree of freedom, counted from 0.
    dots
        Draw the samples as dots instead of a line.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    """
    axes = _axes(ax)
    for index, motion in enumerate(_several(of)):
        n = len(motion.y) // 2
        if not 0 <= degree < n:
            raise ValueError(f"there are degrees of freedom 0 … {n - 1}, not {degree}")
        axes.plot(
            motion.y[degree],
            motion.y[n + degree],
            "." if dots else "-",
            color=COLOURS[index % len(COLOURS)],
            markersize=1.5,
            linewidth=1.0,
        )
    axes.set_xlabel("coordinate" if degree == 0 else f"coordinate {degree + 1}")
    axes.set_ylabel("momentum" if degree == 0 else f"momentum {degree + 1}")
    _tidy(axes)
    return axes


def plot_work_precision(
    found: WorkPrecision, ax: Axes | None = None, *, cost: str = "cpu", error: str = "position"
) -> Axes:
    """Draw the error of each run against its cost, both logarithmic, one line a method; rings mark resonant steps.

    Parameters
    ----------
    found
        What :func:`canon.study.precision.work_precision` returned.
    ax
        Where to draw; a new figure if left out.
    cost
        ``"cpu"`` for processor time or ``"evaluations"`` for evaluations of the force.
    error
        ``"position"`` at the end, or the largest in ``"energy"``.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    ValueError
        Where there is no such cost or error.
    """
    if cost not in ("cpu", "evaluations") or error not in ("position", "energy"):
        raise ValueError(f"cost={cost!r}, error={error!r}: there are cpu, evaluations; position, energy")
    axes = _axes(ax)
    names = list(dict.fromkeys(_family(row) for row in found.rows))
    for index, name in enumerate(names):
        rows = [row for row in found.rows if _family(row) == name and not row.failure]
        x = np.array(
            [row.cpu_seconds if cost == "cpu" else row.evaluations for row in rows], dtype=np.float64
        )
        y = np.array([row.position_error if error == "position" else row.energy_error for row in rows])
        drawn = (x > 0.0) & (y > 0.0)
        if not drawn.any():
            continue
        colour = COLOURS[index % len(COLOURS)]
        axes.plot(
            x[drawn],
            y[drawn],
            color=colour,
            linestyle=LINES[index % len(LINES)],
            marker="osD^vPX"[index % 7],
            markersize=4,
            linewidth=1.5,
            label=name,
        )
        resonant = drawn & np.array([row.resonant for row in rows])
        axes.plot(x[resonant], y[resonant], "o", markersize=10, markerfacecolor="none", color=colour)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("processor time (s)" if cost == "cpu" else "evaluations of the force")
    axes.set_ylabel(
        "relative error of the final position"
        if error == "position"
        else "largest relative energy error |ΔE/E|"
    )
    axes.set_title(found.title, loc="left", fontsize="medium")
    if axes.lines:
        axes.legend(frameon=False, fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    _tidy(axes)
    return axes


def _family(row: WorkRow) -> str:
    """Return the name of a method whatever its tolerance."""
    return str(row.method).split("(")[0] if row.tolerance is not None else str(row.method)


def _axes(ax: Axes | None) -> Axes:
    try:
        from matplotlib.figure import Figure
    except ImportError as missing:
        raise PlotError("pictures need matplotlib: pip install canon-mechanics[plot]") from missing
    if ax is not None:
        return ax
    return Figure(figsize=(8.0, 5.0), layout="constrained").add_subplot()


def _several(of: Trajectory | Sequence[Trajectory]) -> Sequence[Trajectory]:
    from canon.flow.trajectory import Trajectory

    return [of] if isinstance(of, Trajectory) else of


def _series(
    of: DriftStudy | Trajectory | Sequence[Trajectory],
) -> tuple[list[str], list[tuple[Array, Array]], str, str, str]:
    """Return names, (time, error) pairs, the label of the time axis, that of the error, and a title."""
    from canon.study.comparison import DriftStudy

    if isinstance(of, DriftStudy):
        rows = [row for row in of.rows if row.drift is not None]
        label = "largest relative energy error |ΔE/E|"
        if not all(row.relative for row in rows):
            label = "largest energy error |ΔE|"
        unit = 1.0 if of.period is None else of.period
        axis = "time" + (f" ({of.time_unit})" if of.time_unit else "")
        return (
            [_name(row) for row in rows],
            [(row.t / unit, row.error) for row in rows],
            axis if of.period is None else "time (periods)",
            label,
            of.title,
        )
    motions = _several(of)
    relative = all(motion.relative for motion in motions)
    label = "largest relative energy error |ΔE/E|" if relative else "largest energy error |ΔE|"
    pairs = [(motion.t - motion.t[0], motion.energy_error) for motion in motions]
    return [str(motion.method) for motion in motions], pairs, "time", label, ""


def _name(row: DriftRow) -> str:
    from canon.study.drift import Growth

    found = row.drift
    if found is None:
        return str(row.method)
    size = f" {found.walk:.0e}" if found.verdict is Growth.ROUND_OFF else ""
    return f"{row.method}: {found.verdict.value}{size}"


def _envelope(t: Array, size: Array) -> tuple[Array, Array, Array] | None:
    """Return time, largest and median size in intervals of log t; nothing where no size is positive.

    The first unit of time of a long run is left out: it shows the first oscillation, not the growth.
    """
    positive = (t >= min(1.0, t[-1] / 50.0)) & (t > 0.0) & (size > 0.0)
    if np.count_nonzero(positive) < 2:
        return None
    when, what = t[positive], size[positive]
    edges = np.geomspace(when[0], when[-1], 101)
    number = np.clip(np.searchsorted(edges, when, side="right") - 1, 0, 99)
    filled = np.unique(number)
    groups = [what[number == k] for k in filled]
    centre = np.sqrt(edges[filled] * edges[filled + 1])
    centre[-1] = when[-1]
    return centre, np.array([g.max() for g in groups]), np.array([np.median(g) for g in groups])


def _draw_guides(axes: Axes, curves: Sequence[tuple[Array, Array]]) -> None:
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


def _label_ends(axes: Axes, ends: Sequence[tuple[float, str, str]]) -> None:
    """Write each line's name at its right end, far enough from one another to be read."""
    low, high = axes.get_ylim()
    least = 0.055
    last = -math.inf
    for value, name, colour in sorted(ends):
        height = math.log(value / low) / math.log(high / low)
        last = max(height, last + least)
        axes.annotate(
            name,
            (1.0, last),
            (6, 0),
            xycoords="axes fraction",
            textcoords="offset points",
            color=colour,
            va="center",
        )


def _tidy(axes: Axes) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(visible=True, which="major", color="#e5e5e5", linewidth=0.6)
    axes.set_axisbelow(True)
