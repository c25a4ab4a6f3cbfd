"""Style of canon's pictures: colours, lines, axes, names at the ends of lines."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from canon.expression.symbols.input_in_words import given_kind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

__all__ = [
    "COLOURS",
    "GREY",
    "LINES",
    "MARKERS",
    "PlotError",
    "all_to_draw",
    "label_ends",
    "logarithmic",
    "new_axes",
    "tidy",
    "to_draw",
]

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Distinct for every kind of colour vision: Okabe & Ito, https://jfly.uni-koeln.de/color/."""

LINES = ("-", "--", "-.", (0, (1, 1)), (0, (5, 1, 1, 1, 1, 1)), (0, (8, 2)), (0, (3, 3)))
"""So that lines differ in print as well."""

MARKERS = "osD^vPX"

GREY = "#767676"


class PlotError(ImportError):
    """Raised where the plotting library is not installed."""


def new_axes(ax: Axes | None) -> Axes:
    """Return the Axes given, or those of a new figure.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    TypeError
        Where something else than Axes was given.
    """
    try:
        from matplotlib.axes import Axes as AnyAxes

        from canon.plot.notebook import ShownAxes, ShownFigure
    except ImportError as missing:
        raise PlotError("pictures need matplotlib: pip install canon-mechanics[plot]") from missing
    if ax is not None:
        return given_kind(ax, AnyAxes, "ax", "plt.subplots() makes one; left out, a new figure is drawn")
    return ShownFigure(figsize=(8.0, 5.0), layout="constrained").add_subplot(axes_class=ShownAxes)


def to_draw(of: Any, kinds: type | tuple[type, ...], function: str, instead: str) -> Any:
    """Return what is to be drawn, if it is of one of the kinds that a function draws.

    Parameters
    ----------
    of
        What was given.
    kinds
        What the function draws.
    function
        The function.
    instead
        What to give it.

    Raises
    ------
    TypeError
        It is something else.

    Examples
    --------
    >>> to_draw("x", dict, "plot_poincare_section", "give crossings by name")
    Traceback (most recent call last):
        ...
    TypeError: what plot_poincare_section draws should be a dict, not the text 'x'; give crossings by name
    """
    return given_kind(of, kinds, f"what {function} draws", instead)


def all_to_draw(of: Any, kinds: type | tuple[type, ...], function: str, instead: str) -> list[Any]:
    """Return in a list what is to be drawn, be it one thing or several, each as :func:`to_draw` takes it.

    Examples
    --------
    >>> all_to_draw(1, int, "plot", "give numbers"), all_to_draw([1, 2], int, "plot", "give numbers")
    ([1], [1, 2])
    """
    several = not isinstance(of, (str, *(kinds if isinstance(kinds, tuple) else (kinds,)))) and hasattr(
        of, "__iter__"
    )
    return [to_draw(each, kinds, function, instead) for each in (of if several else [of])]


def logarithmic(axes: Axes) -> None:
    """Make both axes logarithmic."""
    axes.set_xscale("log")
    axes.set_yscale("log")


def label_ends(axes: Axes, ends: Sequence[tuple[float, str, str]]) -> None:
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


def tidy(axes: Axes) -> None:
    """Leave out what says nothing: the box's upper and right side; a faint grid behind the data."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(visible=True, which="major", color="#e5e5e5", linewidth=0.6)
    axes.set_axisbelow(True)
