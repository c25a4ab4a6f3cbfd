"""Notebook figures: shown as pictures whatever backend the notebook uses."""

from __future__ import annotations

import io

from matplotlib.axes import Axes
from matplotlib.figure import Figure

__all__ = ["ShownAxes", "ShownFigure"]


def _png(figure: Figure) -> bytes:
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png", dpi=100, bbox_inches="tight")
    return drawn.getvalue()


class ShownFigure(Figure):
    """A figure that shows itself where it is the value of a notebook's cell."""

    def _repr_png_(self) -> bytes:
        return _png(self)


class ShownAxes(Axes):
    """Axes that show their figure where they are the value of a notebook's cell."""

    def _repr_png_(self) -> bytes | None:
        return _png(self.figure) if isinstance(self.figure, Figure) else None
