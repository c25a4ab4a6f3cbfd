"""Pictures of order and chaos: sections of many orbits, maps of an indicator over a plane of starts or parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from canon.flow.chaos.lyapunov import LyapunovSpectrum
from canon.plot.style import COLOURS, new_axes, tidy, to_draw

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray
    from sympy import Expr

    from canon.flow.chaos.chaos_indicators import ChaosIndicator
    from canon.flow.chaos.poincare_section import PoincareSection
    from canon.flow.chaos.regularity import Regularity

__all__ = ["plot_chaos_map", "plot_section"]

_EMPTY = 20
"""Grids have no more than so many places for each orbit."""

_KINDS = {
    "regular": COLOURS[0],
    "chaotic": COLOURS[1],
    "not known yet": COLOURS[2],
    "unstable": COLOURS[3],
    "left": "#a0a0a0",
}


def plot_section(
    section: PoincareSection,
    x: str | Expr,
    y: str | Expr,
    ax: Axes | None = None,
    *,
    verdicts: ArrayLike | None = None,
    size: float = 0.6,
) -> Axes:
    """Draw the points of a section, coloured by orbit, or by what each orbit was found to be.

    Parameters
    ----------
    section
        What :func:`canon.flow.poincare_section` found.
    x, y
        Variables by name, or functions of them: the axes.
    ax
        Where to draw; a new figure if left out.
    verdicts
        A :class:`canon.flow.Regularity` of each orbit, shape (orbits,), as :func:`canon.flow.megno` gives them.
    size
        Of a point, in points of 1/72 inch.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    KeyError
        There is no such variable.
    TypeError
        It is no section.
    ValueError
        There is not one verdict for each orbit.
    """
    from canon.flow.chaos.poincare_section import PoincareSection

    instead = "poincare_section(…) finds one; plot_poincare_section draws the recorded events of a motion"
    to_draw(section, PoincareSection, "plot_section", instead)
    axes, across, up = new_axes(ax), section[x], section[y]
    if verdicts is None:
        axes.scatter(across, up, s=size, c=[COLOURS[k % len(COLOURS)] for k in section.orbit], linewidths=0)
    else:
        found = np.asarray(verdicts, dtype=object)
        if found.shape != (section.orbits,):
            raise ValueError(f"verdicts of shape {found.shape}: one for each of {section.orbits} orbits")
        for kind, colour in _KINDS.items():
            own = np.array([each.value == kind for each in found])[section.orbit]
            if own.any():
                axes.scatter(across[own], up[own], s=size, color=colour, linewidths=0, label=kind)
        axes.legend(
            frameon=False, fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5), markerscale=6
        )
    axes.set_xlabel(str(x))
    axes.set_ylabel(str(y))
    tidy(axes)
    return axes


def plot_chaos_map(
    indicator: ChaosIndicator | LyapunovSpectrum,
    across: ArrayLike,
    up: ArrayLike,
    ax: Axes | None = None,
    *,
    names: Sequence[str] = ("", ""),
    limits: tuple[float, float] | None = None,
) -> Axes:
    """Draw an indicator of many orbits over the plane that their starts or parameters come from.

    Parameters
    ----------
    indicator
        Of many orbits. Those that left are grey, as are places without an orbit.
    across, up
        The place of each orbit, shape (orbits,): a component of its start, or a parameter; on a grid, evenly spaced.
    ax
        Where to draw; a new figure if left out.
    names
        Of the two axes.
    limits
        Values at the ends of the colours; the least and the 98th percentile where not given.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    ValueError
        There is not one place for each orbit, two are the same, or the places are no grid.
    TypeError
        It is no indicator.
    """
    from canon.flow.chaos.chaos_indicators import ChaosIndicator

    instead = "megno(…), sali(…) and lyapunov_spectrum(…) return one"
    to_draw(indicator, (ChaosIndicator, LyapunovSpectrum), "plot_chaos_map", instead)
    axes = new_axes(ax)
    values, verdict = _values(indicator)
    columns, column = _line(across, values.size)
    rows, row = _line(up, values.size)
    if columns.size * rows.size > _EMPTY * values.size:
        raise ValueError(
            f"{values.size} orbits at {columns.size} values across and {rows.size} up are no grid: take the "
            "starts from numpy.meshgrid"
        )
    place, number = np.unique(row * columns.size + column, return_counts=True)
    if number.max(initial=1) > 1:
        again = int(place[np.argmax(number)])
        raise ValueError(
            f"{number.max()} orbits are at one place, {columns[again % columns.size]:g} across and "
            f"{rows[again // columns.size]:g} up, and one would hide the others: give a place for each"
        )
    left = np.array([each.value == "left" for each in np.ravel(np.asarray(verdict, dtype=object))])
    shown = np.ma.masked_all((rows.size, columns.size))
    shown[row, column] = np.ma.masked_array(values, mask=left | ~np.isfinite(values))
    low, high = limits or _limits(shown.compressed())
    axes.set_facecolor("#c8c8c8")
    picture = axes.pcolormesh(columns, rows, shown, cmap="cividis", vmin=low, vmax=high, shading="nearest")
    axes.figure.colorbar(picture, ax=axes, label=_name(indicator), extend="max")
    axes.set_xlabel(names[0])
    axes.set_ylabel(names[1])
    return axes


def _limits(values: NDArray[np.float64]) -> tuple[float, float]:
    """Return the values at the ends of the colours; any where all orbits have left, and the map is grey."""
    return (float(values.min()), float(np.percentile(values, 98))) if values.size else (0.0, 1.0)


def _line(places: ArrayLike, orbits: int) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """Return the different places in order, and which of them each orbit has."""
    given = np.asarray(places, dtype=np.float64)
    if given.shape != (orbits,):
        raise ValueError(f"places of shape {given.shape} for {orbits} orbits: give one for each")
    size = float(np.abs(given).max(initial=0.0)) or 1.0
    _, first, own = np.unique((given / size).round(12), return_index=True, return_inverse=True)
    return given[first], own


def _values(
    indicator: ChaosIndicator | LyapunovSpectrum,
) -> tuple[NDArray[np.float64], Regularity | ArrayLike]:
    found = indicator.largest if isinstance(indicator, LyapunovSpectrum) else indicator.value
    return np.atleast_1d(np.asarray(found, dtype=np.float64)), indicator.verdict


def _name(indicator: ChaosIndicator | LyapunovSpectrum) -> str:
    return "largest exponent" if isinstance(indicator, LyapunovSpectrum) else indicator.name
