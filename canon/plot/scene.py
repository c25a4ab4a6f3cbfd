"""Scene pictures: a sketch of one state with the path it takes, and an animation written to a file.

What a scene does not say of its looks is drawn as the point (q1, q2) of its configurations, or (q, p) for one
coordinate. Places in space are seen from above and from the side, in parallel projection.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.expression.symbols.user_input import given_kind
from canon.plot.style import COLOURS, GREY, PlotError, new_axes

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

    from canon.array import Array
    from canon.scene.picture import Picture, Point
    from canon.scene.scene_motion import SceneMotion

__all__ = ["animate_scene", "plot_scene"]

_AZIMUTH, _ELEVATION = math.radians(-60.0), math.radians(20.0)
_COILS = 7


def plot_scene(motion: SceneMotion, ax: Axes | None = None, *, at: int = 0) -> Axes:
    """Draw a scene at one sample of a motion, and the way its masses take.

    Parameters
    ----------
    motion
        What :func:`canon.scene.scene_motion.run` returned.
    ax
        Where to draw; a new figure if left out.
    at
        Which sample; the start unless given.

    Raises
    ------
    PlotError
        Where matplotlib is not installed.
    TypeError
        Where it is no motion of a scene: a trajectory of ``propagate`` does not know how its system looks.

    Examples
    --------
    >>> from canon.scene import find
    >>> from canon.scene.scene_motion import run
    >>> axes = plot_scene(run(find("spring-pendulum"), periods=1, samples=50))
    >>> len(axes.lines)  # the way of the bob, the spring and the bob
    3
    """
    axes = _square(ax)
    drawing = _Drawing(motion)
    _frame(axes, drawing)
    for index, way in enumerate(drawing.ways):
        axes.plot(*way, color=COLOURS[index % len(COLOURS)], linewidth=0.7, alpha=0.6, zorder=1)
    _draw(axes, drawing, at)
    axes.set_title(motion.scene.title, loc="left", fontsize="small", wrap=True)
    return axes


def animate_scene(motion: SceneMotion, file: str | Path, *, seconds: float = 6.0, rate: int = 20) -> None:
    """Write an animation of a motion to a file: ``.gif``, or ``.mp4`` where ffmpeg is installed.

    Parameters
    ----------
    motion
        What :func:`canon.scene.scene_motion.run` returned; all of it is shown.
    file
        Where to write.
    seconds, rate
        How long the animation is, and how many pictures it has a second.

    Raises
    ------
    PlotError
        Where matplotlib or what writes such files is not installed.
    ValueError
        Where the ending of the file is another.
    """
    axes = _square(None)
    from matplotlib import animation

    ending = str(file).rsplit(".", 1)[-1].lower()
    names = {"gif": "pillow", "mp4": "ffmpeg"}
    if ending not in names:
        raise ValueError(f"{file}: animations are written as .gif or .mp4")
    if not animation.writers.is_available(names[ending]):
        raise PlotError(
            f"{names[ending]} is not installed, which writes .{ending}; install it, or write .gif"
        )
    drawing = _Drawing(motion)
    _frame(axes, drawing)
    axes.set_title(motion.scene.title, loc="left", fontsize="small", wrap=True)
    frames = np.linspace(0, len(motion.t) - 1, max(2, round(seconds * rate))).round().astype(int)
    drawn: list[Artist] = []

    def show(at: int) -> list[Artist]:
        for artist in drawn:
            artist.remove()
        tail = slice(max(0, at - len(motion.t) // 5), at + 1)
        drawn[:] = _draw(axes, drawing, at)
        for index, way in enumerate(drawing.ways):
            drawn.extend(
                axes.plot(*way[:, tail], color=COLOURS[index % len(COLOURS)], linewidth=0.9, alpha=0.7)
            )
        return drawn

    figure: Any = axes.get_figure(root=True)
    show(0)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # laying out every frame anew takes most of the time
    made = animation.FuncAnimation(figure, show, frames=frames.tolist(), interval=1000.0 / rate)
    made.save(str(file), writer=names[ending], fps=rate, dpi=80)


class _Drawing:
    """The points of a scene's picture along a motion, projected to the plane."""

    def __init__(self, motion: SceneMotion) -> None:
        from sympy import sympify

        from canon.scene.scene_motion import SceneMotion

        instead = "canon.scene.scene_motion.run(find('kepler'), periods=1) returns one"
        given_kind(motion, SceneMotion, "the motion", instead)
        self.scene = motion.scene
        self.picture = _picture(motion)
        points = self.picture.points
        self.flat = len(points[0]) == 2
        node = motion.equation.node
        nodes = [node(sympify(x, strict=True), "the picture") for point in points for x in point]
        values = motion.values(nodes).astype(np.float64).reshape(len(points), len(points[0]), -1)
        self.places: Array = values if self.flat else np.array([_projected(place) for place in values])

    @property
    def ways(self) -> Array:
        """The ways of the masses, shape (masses, 2, times)."""
        return self.places[: len(self.picture.masses)]

    def lines(self, at: int) -> tuple[list[Array], list[Array], list[Array]]:
        """Return bars, springs and ground as arrays of shape (2, points)."""
        first = len(self.picture.masses)
        found: list[list[Array]] = []
        for kind in (self.picture.bars, self.picture.springs, self.picture.ground):
            found.append([])
            for line in kind:
                found[-1].append(self.places[first : first + len(line), :, at].T)
                first += len(line)
        return found[0], found[1], found[2]


def _picture(motion: SceneMotion) -> Picture:
    """Return the picture a scene has, or the point of its configuration."""
    from canon.scene.picture import Picture

    scene = motion.scene
    if scene.picture_of is not None:
        return scene.picture_of(scene.symbols)
    first, *others = scene.q
    point: Point = (first, others[0] if others else first.momentum)
    return Picture(masses=(point,))


def _projected(place: Array) -> Array:
    """Return a place in space, shape (3, times), as it is seen from the side and above."""
    x, y, z = place
    right = -math.sin(_AZIMUTH) * x + math.cos(_AZIMUTH) * y
    deep = math.cos(_AZIMUTH) * x + math.sin(_AZIMUTH) * y
    return np.array([right, math.cos(_ELEVATION) * z - math.sin(_ELEVATION) * deep])


def _draw(axes: Axes, drawing: _Drawing, at: int) -> list[Artist]:
    bars, springs, ground = drawing.lines(at)
    drawn: list[Artist] = []
    for line in ground:
        drawn.extend(axes.plot(*line, color=GREY, linewidth=1.2, zorder=1))
    for line in bars:
        drawn.extend(axes.plot(*line, color="black", linewidth=1.6, solid_capstyle="round", zorder=2))
    for ends in springs:
        drawn.extend(axes.plot(*_coil(ends, drawing), color="black", linewidth=1.0, zorder=2))
    for index, place in enumerate(drawing.ways[:, :, at]):
        colour = COLOURS[index % len(COLOURS)]
        drawn.extend(axes.plot(*place[:, np.newaxis], "o", color=colour, markersize=8, zorder=3))
    return drawn


def _coil(ends: Array, drawing: _Drawing) -> Array:
    """Return a zigzag between two points, its width a fiftieth of the picture."""
    width = float(np.ptp(drawing.places[:, 0])) / 50.0 + float(np.ptp(drawing.places[:, 1])) / 50.0
    along = ends[:, 1] - ends[:, 0]
    length = float(np.hypot(*along)) or 1.0
    across = np.array([-along[1], along[0]]) / length * width / 2.0
    fractions = np.concatenate([[0.0, 0.1], np.linspace(0.1, 0.9, 2 * _COILS + 1)[1:-1], [0.9, 1.0]])
    sides = np.zeros_like(fractions)
    sides[2:-2] = np.where(np.arange(len(fractions) - 4) % 2, -1.0, 1.0)
    return ends[:, :1] + np.outer(along, fractions) + np.outer(across, sides)


def _frame(axes: Axes, drawing: _Drawing) -> None:
    """Fit the axes to all places of the motion; lengths in both directions are alike where they are lengths."""
    low, high = drawing.places.min(axis=(0, 2)), drawing.places.max(axis=(0, 2))
    middle, half = (low + high) / 2.0, np.maximum((high - low) * 0.55, 1e-9)
    scene = drawing.scene
    if scene.picture_of is not None:
        half = np.maximum(half, half.max() / 4.0)
        axes.set_aspect("equal", adjustable="box")
        axes.set_axis_off()
    else:
        names = (str(scene.q[0]), str(scene.q[1] if len(scene.q) > 1 else scene.p[0]))
        axes.set_xlabel(names[0])
        axes.set_ylabel(names[1])
        axes.spines[["top", "right"]].set_visible(False)
    axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
    axes.set_ylim(middle[1] - half[1], middle[1] + half[1])


def _square(ax: Axes | None) -> Axes:
    axes = new_axes(ax)
    figure = axes.get_figure(root=True)
    if ax is None and figure is not None:
        figure.set_size_inches(5.0, 4.5)
    return axes
