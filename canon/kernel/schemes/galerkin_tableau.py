"""Galerkin tableaux: Legendre's polynomials and their integrals at the nodes of Gauss's and Lobatto's quadrature.

Sources: J. E. Marsden, M. West, Discrete mechanics and variational integrators, Acta Numerica 10 (2001) 357–514,
§ 2.2.6, doi:10.1017/S096249290100006X; M. Abramowitz, I. A. Stegun, Handbook of Mathematical Functions (1964), 25.4.32.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import sympy as sp
from mpmath import MPContext

from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.schemes.gauss_tableau import gauss_tableau
from canon.kernel.schemes.legendre_values import legendre_values

if TYPE_CHECKING:
    from canon.kernel.llvm.number_types import MachineType

__all__ = ["QUADRATURES", "GalerkinTableau", "galerkin_coefficients", "galerkin_tableau"]

QUADRATURES = "gauss", "lobatto"
"""Gauss's, of order 2r with r points, and Lobatto's, of order 2r − 2, whose first and last nodes are the ends."""

_DIGITS = 10**60


@dataclass(frozen=True)
class GalerkinTableau:
    """Nodes c_j and weights b_j on [0, 1], L_l(2c_j − 1) and ∫₀^{c_j} L_l(2x − 1) dx for l < s, 60 digits."""

    c: tuple[Fraction, ...]
    b: tuple[Fraction, ...]
    values: tuple[tuple[Fraction, ...], ...]
    integrals: tuple[tuple[Fraction, ...], ...]


@functools.cache
def galerkin_tableau(degree: int, points: int, quadrature: str) -> GalerkinTableau:
    """Return the tableau of polynomials of a degree s with a quadrature by its name.

    Examples
    --------
    >>> found = galerkin_tableau(1, 2, "lobatto")
    >>> [float(x) for x in found.c], [float(x) for x in found.b], [float(x) for x in found.integrals[0]]
    ([0.0, 1.0], [0.5, 0.5], [0.0, 1.0])
    """
    gauss = quadrature == QUADRATURES[0]
    c, b = (gauss_tableau(points).c, gauss_tableau(points).b) if gauss else _lobatto(points)
    at = [list(legendre_values(2 * x - 1, degree + 1)) for x in c]
    values = tuple(tuple(row[k] for row in at) for k in range(degree))
    # ∫₀^c L_l(2x − 1) dx = (L_{l+1} − L_{l−1})/(2(2l + 1)), and c for l = 0.
    later = (tuple((row[k + 1] - row[k - 1]) / (4 * k + 2) for row in at) for k in range(1, degree))
    return GalerkinTableau(c, b, values, (c, *later))


def _lobatto(points: int) -> tuple[tuple[Fraction, ...], tuple[Fraction, ...]]:
    """Return Lobatto's nodes, the ends and the zeros of L′_{r−1}, and weights 1/(r(r − 1) L_{r−1}²)."""
    context = MPContext()
    context.dps = 80
    inner: list[Any] = []
    if points > 2:
        slope: Any = sp.legendre_poly(points - 1, polys=True).diff()
        scaled = [int(2 ** (points - 1) * x) for x in slope.all_coeffs()]
        inner = sorted(context.re(zero) for zero in context.polyroots(scaled, maxsteps=200))
    half = (Fraction(int(context.nint((1 + z) / 2 * _DIGITS)), _DIGITS) for z in inner)
    c = (Fraction(0), *half, Fraction(1))
    high = (list(legendre_values(2 * x - 1, points))[-1] for x in c)
    return c, tuple(1 / (points * (points - 1) * value**2) for value in high)


def galerkin_coefficients(
    degree: int, points: int, quadrature: str, h: Fraction, number: MachineType = DOUBLE
) -> list[Fraction]:
    """Return what the loop reads after t0 and h: 1/h, then in rows h c, h b, L_l, ∫L_l, and the prediction.

    L and ∫L are multiples of one unit below 1 and of like size on both sides of the middle, so that the rounded method
    is symmetric, and 1 − c is exact. The prediction's entry l, m is the share of L_l(z) in L_m(z + 2).
    """
    found = galerkin_tableau(degree, points, quadrature)
    unit = 2**number.mantissa

    def mirrored(row: tuple[Fraction, ...], sign: int, about: int = 0) -> list[Fraction]:
        first = [Fraction(round(x * unit), unit) for x in row[: points - points // 2]]
        return [*first, *(about + sign * x for x in reversed(first[: points // 2]))]

    values = [mirrored(row, (-1) ** k) for k, row in enumerate(found.values)]
    integrals = [mirrored(found.integrals[0], -1, 1)]
    integrals += [mirrored(row, (-1) ** (k + 1)) for k, row in enumerate(found.integrals[1:], 1)]
    rows = [[h * c for c in found.c], [h * b for b in found.b], *values, *integrals]
    return [1 / h, *(x for row in rows for x in row), *(x for row in _continued(degree) for x in row)]


@functools.cache
def _continued(degree: int) -> tuple[tuple[Fraction, ...], ...]:
    """Return E with L_m(z + 2) = Σ_l E_lm L_l(z)."""
    nodes = gauss_tableau(degree)
    at = [list(legendre_values(2 * c - 1, degree)) for c in nodes.c]
    later = [list(legendre_values(2 * c + 1, degree)) for c in nodes.c]
    return tuple(
        tuple(
            (2 * k + 1)
            * sum((b * old[k] * new[m] for b, old, new in zip(nodes.b, at, later, strict=True)), Fraction(0))
            for m in range(degree)
        )
        for k in range(degree)
    )
