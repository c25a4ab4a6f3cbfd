"""Study overview: every case a cell, failed and pending ones included."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.symbols.user_input import counted
from canon.plot.case_labels import error_symbol, labels_of
from canon.plot.style import GREY, PlotError, all_to_draw, new_axes
from canon.study.cases.result import Result, State

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes

__all__ = ["plot_study_heatmap"]

NAMED = 60
"""Rows and columns that are named at most; of more, every second, third … is."""


def plot_study_heatmap(results: Sequence[Result], ax: Axes | None = None, *, what: str = "bound") -> Axes:
    """Draw a study as a table of cells: motions × methods and steps, coloured by the error.

    Failed cases are hatched and crossed, pending ones framed in dots with the share that is done; where the study
    has no case there is nothing.

    Parameters
    ----------
    results
        What :func:`canon.study.cases.result.results_of` returned.
    ax
        Where to draw; a new figure, as large as the table needs, if left out.
    what
        ``"bound"`` for the largest ``|ΔE/E|`` (``|ΔE|`` where one is absolute), ``"slope"`` for the drift's size per
        unit of time, ``"seconds"`` for the processor time.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    TypeError
        Where they are no results.
    ValueError
        Where there is no case, or no such quantity.

    Examples
    --------
    >>> import tempfile
    >>> from canon import Study, results_of, run_study
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = f"{folder}/study.sqlite"
    ...     _ = run_study(Study.of(system="henon-heiles", method="rk4", step=[0.1, 0.2], span=100.0), file)
    ...     plot_study_heatmap(results_of(file)).get_title(loc="left")
    '2 cases: 2 finished'
    """
    if what not in ("bound", "slope", "seconds"):
        raise ValueError(f"what={what!r}: there are bound, slope, seconds")
    results = all_to_draw(results, Result, "plot_study_heatmap", "results_of(file) returns all of a study's")
    if not results:
        raise ValueError("there is no case to draw: give results of a study, results_of(file)")
    labels = labels_of(results)
    rows, columns = (list(dict.fromkeys(each)) for each in labels)
    places = [(columns.index(c), rows.index(r)) for r, c in zip(*labels, strict=True)]
    axes = new_axes(ax) if ax is not None else _sized_axes(len(rows), len(columns))
    values = np.full((len(rows), len(columns)), np.nan)
    for result, (x, y) in zip(results, places, strict=True):
        if result.state is State.FINISHED:
            size = result.seconds if what == "seconds" else _size(result.numbers, what)
            values[y, x] = size or np.nan
    if np.isfinite(values).any():
        _colour(axes, values, what, error_symbol(results))
    else:
        axes.set_aspect("auto")
    for result, place in zip(results, places, strict=True):
        _mark(axes, result, *place, empty=bool(np.isnan(values[place[1], place[0]])))
    _name(axes, rows, columns)
    count = {state: sum(result.state is state for result in results) for state in State}
    told = ", ".join(f"{number} {state.value}" for state, number in count.items() if number)
    axes.set_title(f"{counted(len(results), 'case')}: {told}", loc="left", fontsize="medium")
    return axes


def _size(numbers: Mapping[str, Any], what: str) -> float:
    """Return the size of a number; of the drift that of the mean, or of an oscillation that widens faster."""
    widens = what == "slope" and numbers["verdict"] == "secular"
    return max(abs(numbers[what]), abs(numbers["amplitude_slope"]) if widens else 0.0)


def _sized_axes(rows: int, columns: int) -> Axes:
    axes = new_axes(None)
    figure = axes.get_figure(root=True)
    if figure is not None:
        figure.set_size_inches(min(30.0, 5.5 + 0.42 * columns), min(30.0, 3.0 + 0.42 * rows))
    return axes


def _colour(axes: Axes, values: np.ndarray, what: str, error: str) -> None:
    from matplotlib.colors import LogNorm

    low, high = np.nanmin(values), np.nanmax(values)
    norm = LogNorm(low, high if high > low else 10.0 * low)
    image = axes.imshow(values, norm=norm, cmap="viridis_r", aspect="auto", interpolation="nearest")
    figure = axes.get_figure(root=True)
    if figure is None:
        raise PlotError("the Axes belong to no figure; make them with plt.subplots()")
    label = {
        "bound": f"largest |{error}|",
        "slope": f"|drift of {error}| per unit of time",
        "seconds": "processor time (s)",
    }
    figure.colorbar(image, ax=axes, label=label[what], fraction=0.05, pad=0.02)


def _mark(axes: Axes, result: Result, x: int, y: int, *, empty: bool) -> None:
    """Show a case that has no colour."""
    from matplotlib.patches import Rectangle

    corner = (x - 0.5, y - 0.5)
    if result.state is State.FAILED:
        axes.add_patch(
            Rectangle(corner, 1, 1, facecolor="#f6d5d0", edgecolor="#b03a2e", hatch="////", linewidth=0)
        )
        axes.text(x, y, "✕", ha="center", va="center", color="#7b241c", fontweight="bold")
    elif result.state is State.PENDING:
        axes.add_patch(
            Rectangle(
                (x - 0.44, y - 0.44), 0.88, 0.88, fill=False, edgecolor=GREY, linestyle=":", linewidth=1.2
            )
        )
        shown = f"{100 * result.done:.0f} %" if result.done else "…"
        axes.text(x, y, shown, ha="center", va="center", color=GREY, fontsize="x-small")
    elif empty:
        axes.text(x, y, "0", ha="center", va="center", color=GREY)


def _name(axes: Axes, rows: Sequence[str], columns: Sequence[str]) -> None:
    for axis, names in ((axes.xaxis, columns), (axes.yaxis, rows)):
        every = -(-len(names) // NAMED)
        axis.set_ticks(range(0, len(names), every), names[::every], fontsize="small")
        axis.set_tick_params(length=0)
    axes.set_xlim(-0.5, len(columns) - 0.5)
    axes.set_ylim(len(rows) - 0.5, -0.5)
    for label in axes.get_xticklabels():
        label.set(rotation=60, ha="right", rotation_mode="anchor")
    axes.spines[:].set_visible(False)
