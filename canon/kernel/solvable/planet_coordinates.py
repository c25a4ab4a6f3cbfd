"""Coordinates of planets about a star, as exact matrices: Jacobi's, and democratic heliocentric ones.

Sources: J. Wisdom, M. Holman, Symplectic maps for the N-body problem, Astron. J. 102 (1991) 1528–1538,
doi:10.1086/115978; M. J. Duncan, H. F. Levison, M. H. Lee, A multiple time step symplectic algorithm for integrating
close encounters, Astron. J. 116 (1998) 2067–2077, doi:10.1086/300541.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate

__all__ = ["PlanetCoordinates", "heliocentric_coordinates", "jacobi_coordinates"]

Matrix = Sequence[Sequence[Fraction]]


@dataclass(frozen=True)
class PlanetCoordinates:
    """Places and velocities of planets in terms of those of all bodies, and back.

    Parameters
    ----------
    places, velocities
        A row of weights for each planet, a column for each body, the star first.
    places_back, velocities_back
        A row for each body; the first column belongs to the centre of mass, the others to the planets.
    """

    places: Matrix
    velocities: Matrix
    places_back: Matrix
    velocities_back: Matrix


def jacobi_coordinates(m: Sequence[Fraction]) -> PlanetCoordinates:
    """Return Jacobi's coordinates: each planet's place from the centre of mass of the bodies before it.

    Examples
    --------
    >>> chart = jacobi_coordinates([Fraction(3), Fraction(1), Fraction(1)])
    >>> [[str(x) for x in row] for row in chart.places]
    [['-1', '1', '0'], ['-3/4', '-1/4', '1']]
    """
    total, n, none = list(accumulate(m)), len(m), Fraction(0)
    there = [
        [*(-m[j] / total[i - 1] for j in range(i)), Fraction(1), *[none] * (n - i - 1)] for i in range(1, n)
    ]
    back = list[list[Fraction]]()
    for i in range(n):
        before = [none] * (i - 1) + [total[i - 1] / total[i]] if i else []
        back.append([Fraction(1), *before, *(-m[j] / total[j] for j in range(i + 1, n))])
    return PlanetCoordinates(there, there, back, back)


def heliocentric_coordinates(m: Sequence[Fraction]) -> PlanetCoordinates:
    """Return democratic heliocentric coordinates: places from the star, velocities from the centre of mass.

    Examples
    --------
    >>> chart = heliocentric_coordinates([Fraction(3), Fraction(1), Fraction(1)])
    >>> [[str(x) for x in row] for row in chart.velocities]
    [['-3/5', '4/5', '-1/5'], ['-3/5', '-1/5', '4/5']]
    """
    n, whole = len(m), sum(m)
    unit = [[Fraction(int(i == j)) for j in range(n)] for i in range(n)]
    mean = [mass / whole for mass in m]
    star = [Fraction(1), *(-share for share in mean[1:])]
    slow = [Fraction(1), *(-mass / m[0] for mass in m[1:])]
    return PlanetCoordinates(
        [_difference(row, unit[0]) for row in unit[1:]],
        [_difference(row, mean) for row in unit[1:]],
        [star, *(_difference(row, [-share for share in star]) for row in unit[1:])],
        [slow, *([Fraction(1), *row[1:]] for row in unit[1:])],
    )


def _difference(a: Sequence[Fraction], b: Sequence[Fraction]) -> list[Fraction]:
    return [x - y for x, y in zip(a, b, strict=True)]
