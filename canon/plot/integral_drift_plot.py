"""Pictures of the drift of formal integrals: drift against size of the orbit, with the power that theory says."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from canon.plot.style import COLOURS, MARKERS, new_axes, tidy, to_draw

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from canon.study.energy_drift.integral_drift import IntegralDrift

__all__ = ["plot_integral_drift"]


def plot_integral_drift(*drifts: IntegralDrift, ax: Axes | None = None) -> Axes:
    """Draw how formal integrals drift with the size of the orbit, each with a line of its expected power.

    Parameters
    ----------
    drifts
        What :func:`canon.study.integral_drift` returned, one or several.
    ax
        Where to draw; a new figure if left out.

    Raises
    ------
    TypeError
        Where something else is among them.
    """
    from canon.study.energy_drift.integral_drift import IntegralDrift

    instead = "integral_drift(…) returns one; several stand one after another, and the Axes are given as ax="
    for drift in drifts:
        to_draw(drift, IntegralDrift, "plot_integral_drift", instead)
    axes = new_axes(ax)
    for k, drift in enumerate(drifts):
        again, own = divmod(k, len(COLOURS))
        colour, marker = COLOURS[own], MARKERS[again % len(MARKERS)]
        radii, changes = np.array(drift.radii), np.array(drift.drifts)
        seen = "drift below rounding" if drift.slope is None else f"slope {drift.slope:.2f}"
        axes.loglog(
            radii,
            changes,
            marker,
            linestyle="none",
            color=colour,
            label=f"order {drift.expected - 1}: {seen}",
        )
        line = changes[-1] * (radii / radii[-1]) ** drift.expected
        axes.loglog(radii, line, "-", color=colour, linewidth=0.8)
    axes.set_xlabel("distance of the start from the equilibrium, or ε")
    axes.set_ylabel("largest change of the formal integral")
    axes.legend(frameon=False)
    tidy(axes)
    return axes
