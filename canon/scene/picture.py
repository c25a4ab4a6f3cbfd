"""Sketch of a scene as functions of its coordinates: rods, springs, masses, and the ground they stand on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sympy import Expr

__all__ = ["Picture", "Point", "ring", "wheel"]

Point = tuple["Expr | float", ...]
"""A place in the plane or in space, z upwards, as a function of coordinates, parameters and time."""


@dataclass(frozen=True)
class Picture:
    """A sketch made of lines and points, all in the plane or all in space.

    Parameters
    ----------
    masses
        Points drawn as dots; the way they take is drawn too.
    bars
        Polylines that move: rods, strings, rims of wheels.
    springs
        Pairs of points with a spring between them.
    ground
        Polylines at rest: walls, wires, tables.
    """

    masses: tuple[Point, ...] = ()
    bars: tuple[tuple[Point, ...], ...] = ()
    springs: tuple[tuple[Point, Point], ...] = ()
    ground: tuple[tuple[Point, ...], ...] = ()

    @property
    def points(self) -> tuple[Point, ...]:
        """All points, in the order masses, bars, springs, ground."""
        lines = (*self.bars, *self.springs, *self.ground)
        return (*self.masses, *(point for line in lines for point in line))


def ring(
    centre: Point, first: Sequence[Expr | float], second: Sequence[Expr | float], count: int = 36
) -> tuple[Point, ...]:
    """Return a closed polyline around a centre, spanned by two perpendicular radii.

    Examples
    --------
    >>> [tuple(map(round, point)) for point in ring((0, 0), (1, 0), (0, 1), count=4)]
    [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 0)]
    """
    from math import cos, pi, sin

    turns = [2.0 * pi * k / count for k in range(count + 1)]
    return tuple(
        tuple(c + cos(turn) * a + sin(turn) * b for c, a, b in zip(centre, first, second, strict=True))
        for turn in turns
    )


def wheel(centre: Point, radius: Expr | float, angle: Expr) -> tuple[tuple[Point, ...], tuple[Point, ...]]:
    """Return the rim of a wheel in the plane and one of its diameters, which shows how it turns.

    Examples
    --------
    >>> from sympy import Symbol
    >>> rim, diameter = wheel((0, 0), 2, Symbol("phi"))
    >>> diameter[1]
    (2*cos(phi), 2*sin(phi))
    """
    from sympy import cos, sin

    spoke = (radius * cos(angle), radius * sin(angle))
    across = (-spoke[1], spoke[0])
    ends = (
        tuple(c - a for c, a in zip(centre, spoke, strict=True)),
        tuple(c + a for c, a in zip(centre, spoke, strict=True)),
    )
    return ring(centre, spoke, across), ends
