"""Phase-space pictures: portraits and Poincaré sections."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from canon.plot.style import COLOURS, all_to_draw, new_axes, tidy, to_draw

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from canon.flow.run.event import Crossing
    from canon.flow.trajectory import Trajectory

__all__ = ["plot_phase_portrait", "plot_poincare_section"]


def plot_phase_portrait(
    of: Trajectory | Sequence[Trajectory], ax: Axes | None = None, *, degree: int = 0, dots: bool = False
) -> Axes:
    """Draw one coordinate against its momentum along one or several trajectories.

    Of a motion without momenta, as of a vector field, the variables are drawn that stand in their places.

    Parameters
    ----------
    of
        The trajectories; all orbits of an ensemble are drawn.
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
    TypeError
        Where something else than trajectories is given.
    ValueError
        Where there is no such degree of freedom.
    """
    from canon.flow.trajectory import Trajectory

    motions = all_to_draw(
        of, Trajectory, "plot_phase_portrait", "propagate(…) returns one; give several in a list"
    )
    axes, names = new_axes(ax), set[tuple[str, str]]()
    for index, motion in enumerate(motions):
        q, p, name = _plane_of_motion(motion, degree)
        names.add(name)
        axes.plot(
            q,
            p,
            "." if dots else "-",
            color=COLOURS[index % len(COLOURS)],
            markersize=1.5,
            linewidth=1.0,
        )
    if len(names) == 1:
        across, up = names.pop()
        axes.set_xlabel(across)
        axes.set_ylabel(up)
    else:
        _name_axes(axes, degree)
    tidy(axes)
    return axes


def plot_poincare_section(
    of: Mapping[str, Sequence[Crossing] | ArrayLike],
    ax: Axes | None = None,
    *,
    reference: Sequence[Crossing] | ArrayLike | None = None,
    degree: int = 1,
) -> Axes:
    """Draw where motions cross a surface, a coordinate against its momentum, over the crossings of a reference.

    Parameters
    ----------
    of
        The crossings by name, such as of a method: what ``propagate`` recorded of an event, or the states
        (q, p) there, shape (2n, crossings).
    ax
        Where to draw; a new figure if left out.
    reference
        Crossings of a more precise motion, drawn large and grey below the others.
    degree
        Which degree of freedom, counted from 0.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    TypeError
        Where the crossings are not given by name.
    ValueError
        Where there is no crossing, or no such degree of freedom.

    Examples
    --------
    >>> from canon import Taylor, propagate
    >>> from canon.flow.run.event import Event
    >>> from canon.scene import find
    >>> scene = find("henon-heiles")
    >>> crossing = Event(scene.q[0], 1)
    >>> met = propagate(scene.hamiltonian, (0, 60), scene.state(), method=Taylor(), events=[crossing]).events
    >>> len(plot_poincare_section({"Taylor": met}).lines[0].get_xdata()) == len(met) > 5
    True
    """
    instead = (
        'give crossings by name, {"Taylor": motion.events}; plot_section draws what poincare_section found'
    )
    to_draw(of, Mapping, "plot_poincare_section", instead)
    axes = new_axes(ax)
    if reference is not None:
        q, p = _plane(_crossings(reference, "the reference"), degree)
        axes.plot(q, p, "o", color="#c4c4c4", markersize=6, markeredgewidth=0, label="reference", zorder=1)
    for index, (name, met) in enumerate(of.items()):
        q, p = _plane(_crossings(met, name), degree)
        axes.plot(q, p, ".", color=COLOURS[index % len(COLOURS)], markersize=3, label=name, zorder=2)
    _name_axes(axes, degree)
    axes.legend(frameon=False, fontsize="small", loc="center left", bbox_to_anchor=(1.0, 0.5), markerscale=2)
    tidy(axes)
    return axes


def _crossings(met: Sequence[Crossing] | ArrayLike, name: str) -> NDArray[np.float64]:
    """Return the states at crossings, shape (2n, crossings)."""
    listed = [getattr(each, "y", None) for each in met] if isinstance(met, list | tuple) else []
    found = np.array(listed, dtype=np.float64).T if listed and listed[0] is not None else np.asarray(met)
    if found.ndim != 2 or not found.size or len(found) % 2:
        raise ValueError(f"{name}: no crossings to draw; states at crossings have shape (2n, crossings)")
    return found


def _plane_of_motion(
    motion: Trajectory, degree: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], tuple[str, str]]:
    """Return a coordinate and its momentum with their names; of what has no momenta two variables."""
    names = motion.record.names
    try:
        q, p = motion.q, motion.p
    except AttributeError:  # momenta are not known of this system
        n = len(motion.y) // 2
        return *_plane(motion.y, degree), (names[degree], names[n + degree])
    found = _plane(np.concatenate([q, p]), degree)
    # The state of a Lagrangian is (q, q̇), its momenta are ∂L/∂q̇.
    own = motion.record.moving is None
    return *found, (names[degree], names[len(q) + degree] if own else f"p_{names[degree]}")


def _plane(y: NDArray[np.float64], degree: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    n = len(y) // 2
    if not 0 <= degree < n:
        raise ValueError(f"there are degrees of freedom 0 … {n - 1}, not {degree}")
    return y[degree], y[n + degree]


def _name_axes(axes: Axes, degree: int) -> None:
    axes.set_xlabel("coordinate" if degree == 0 else f"coordinate {degree + 1}")
    axes.set_ylabel("momentum" if degree == 0 else f"momentum {degree + 1}")
