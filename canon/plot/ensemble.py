"""Ensemble figures: how the error spreads over many orbits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from canon.plot.style import COLOURS, logarithmic, new_axes, tidy, to_draw

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from canon.flow.trajectory import Trajectory

__all__ = ["plot_ensemble_fan"]

FAN = ((0.0, 1.0, 0.12), (0.05, 0.95, 0.2), (0.25, 0.75, 0.3))
"""Lower and upper quantile of each shade and how dark it is."""


def plot_ensemble_fan(of: Trajectory, ax: Axes | None = None, *, intervals: int = 60) -> Axes:
    """Draw how ``|ΔE/E|`` spreads over the orbits of an ensemble: the median, and shades between quantiles.

    Of each orbit the largest error in each interval of log t counts.

    Parameters
    ----------
    of
        A trajectory of many orbits.
    ax
        Where to draw; a new figure if left out.
    intervals
        Intervals of log t at most.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    TypeError
        Where it is no trajectory.
    ValueError
        Where there are not at least four orbits, or no error at all.

    Examples
    --------
    >>> import numpy as np
    >>> from canon import Splitting, propagate
    >>> from canon.scene import find
    >>> scene = find("henon-heiles")
    >>> starts = np.outer(scene.state(), np.linspace(0.9, 1.1, 8))
    >>> motion = propagate(scene.hamiltonian, (0, 50), starts, method=Splitting("verlet"), step=0.1)
    >>> plot_ensemble_fan(motion).get_title(loc="left")
    'verlet, 8 orbits'
    """
    from canon.flow.trajectory import Trajectory

    to_draw(of, Trajectory, "plot_ensemble_fan", "propagate(…) returns one, of starts of shape (2n, orbits)")
    if of.y.ndim != 3 or of.y.shape[2] < 4:
        raise ValueError(
            "a fan shows the spread over orbits: propagate four or more, states of shape (2n, orbits)"
        )
    when, largest = _largest(np.abs(of.t - of.t[0]), np.abs(of.energy_error), intervals)
    if not largest.any():
        raise ValueError("the error is zero throughout: there is nothing to draw on a logarithmic axis")
    least = largest[largest > 0.0].min()
    axes = new_axes(ax)
    for low, high, alpha in FAN:
        lower, upper = (np.maximum(np.quantile(largest, q, axis=1), least) for q in (low, high))
        label = "all orbits" if high == 1.0 else f"{100 * (high - low):.0f} % of them"
        axes.fill_between(when, lower, upper, color=COLOURS[0], alpha=alpha, linewidth=0, label=label)
    median = np.maximum(np.median(largest, axis=1), least)
    axes.plot(when, median, color=COLOURS[0], linewidth=1.8, label="median")
    logarithmic(axes)
    axes.margins(x=0.0)
    axes.set_xlabel("time")
    axes.set_ylabel(f"largest {'relative energy error |ΔE/E|' if of.relative else 'energy error |ΔE|'}")
    axes.set_title(f"{of.method}, {of.y.shape[2]} orbits", loc="left", fontsize="medium")
    axes.legend(frameon=False, fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5))
    tidy(axes)
    return axes


def _largest(
    t: NDArray[np.float64], size: NDArray[np.float64], intervals: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the ends of intervals of log t and the largest size in each, shape (intervals, orbits)."""
    edges = np.geomspace(t[1], t[-1], intervals + 1)
    number = np.clip(np.searchsorted(edges, t[1:], side="left") - 1, 0, intervals - 1)
    filled, first = np.unique(number, return_index=True)
    return edges[filled + 1], np.maximum.reduceat(size[1:], first, axis=0)
