"""Figures by matplotlib: functions that take Axes and return Axes.

Every function draws into the Axes it is given, or into a new figure, and returns the Axes; but ``plot_errors`` draws
panels in a new figure and returns a list of Axes, and ``animate_scene`` writes a file. matplotlib is loaded when the
first picture is asked for.
"""

from __future__ import annotations

from canon.plot.chaos import plot_chaos_map, plot_section
from canon.plot.energy import plot_block_means, plot_energy_error, plot_errors
from canon.plot.ensemble import plot_ensemble_fan
from canon.plot.integral_drift_plot import plot_integral_drift
from canon.plot.phase import plot_phase_portrait, plot_poincare_section
from canon.plot.scene import animate_scene, plot_scene
from canon.plot.study import plot_study_heatmap
from canon.plot.style import COLOURS, GREY, PlotError
from canon.plot.work_precision import plot_drift_by_step, plot_work_precision

__all__ = [
    "COLOURS",
    "GREY",
    "PlotError",
    "animate_scene",
    "plot_block_means",
    "plot_chaos_map",
    "plot_drift_by_step",
    "plot_energy_error",
    "plot_ensemble_fan",
    "plot_errors",
    "plot_integral_drift",
    "plot_phase_portrait",
    "plot_poincare_section",
    "plot_scene",
    "plot_section",
    "plot_study_heatmap",
    "plot_work_precision",
]
