"""Average vector field methods as Runge–Kutta methods: matrices that keep H, of order 2s with k nodes of quadrature.

u is a polynomial of degree s over the step, and u̇ the projection of f(u) on polynomials of degree s − 1 in the inner
product of the step, so that ∫ ∇H(u)·u̇ dt = 0. With the integrals by Gauss's quadrature at k nodes c_j, exact where H
is a polynomial of degree up to 2k/s, the stages are Y_i = y + Σ_j a_ij h f(Y_j) with

    a_ij = b_j Σ_{l<s} P_l(c_j) ∫₀^{c_i} P_l,   y′ = y + Σ_j b_j h f(Y_j),

P_l being Legendre's polynomials, orthonormal on [0, 1]. With k = s these are the Gauss methods; the limit of large k is
the average vector field for s = 1.

Sources: G. R. W. Quispel, D. I. McLaren, A new class of energy-preserving numerical integration methods, J. Phys. A 41
(2008) 045206, doi:10.1088/1751-8113/41/4/045206; E. Hairer, Energy-preserving variant of collocation methods, J. Numer.
Anal. Ind. Appl. Math. 5 (2010) 73–84; L. Brugnano, F. Iavernaro, D. Trigiante, Hamiltonian boundary value methods,
ibid. 17–37.
"""

from __future__ import annotations

import functools
from fractions import Fraction
from typing import TYPE_CHECKING

from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.schemes.gauss_tableau import Tableau, coefficient_rows, gauss_tableau
from canon.kernel.schemes.legendre_values import legendre_values

if TYPE_CHECKING:
    from canon.kernel.llvm.number_types import MachineType

__all__ = ["MOST_POINTS", "average_coefficients", "average_tableau"]

MOST_POINTS = 16
"""Nodes of quadrature at most."""

_PREDICTED = 8
"""Legendre's polynomials that predict the next step's stages: more would enlarge rounding."""


@functools.cache
def average_tableau(degree: int, points: int) -> Tableau:
    """Return the method whose u has a degree s, with k nodes, to 60 digits.

    Examples
    --------
    >>> [[round(float(x), 6) for x in row] for row in average_tableau(1, 2).mu]
    [[0.211325, 0.211325], [0.788675, 0.788675]]
    """
    quadrature = gauss_tableau(points)
    at = [list(legendre_values(2 * c - 1, max(degree, points) + 1)) for c in quadrature.c]
    later = [list(legendre_values(2 * c + 1, points)) for c in quadrature.c]
    # ∫₀^c of the l-th, not normalised, is (L_{l+1} − L_{l−1})/(2(2l + 1)).
    mu = [
        [c + sum((own[k + 1] - own[k - 1]) * other[k] / 2 for k in range(1, degree)) for other in at]
        for c, own in zip(quadrature.c, at, strict=True)
    ]
    few = min(points, _PREDICTED)
    prediction = [
        [b * sum((2 * k + 1) * new[k] * old[k] for k in range(few)) for old in at]
        for b, new in zip(quadrature.b, later, strict=True)
    ]
    return Tableau(quadrature.c, quadrature.b, tuple(map(tuple, mu)), tuple(map(tuple, prediction)))


def average_coefficients(
    degree: int, points: int, h: Fraction, number: MachineType = DOUBLE
) -> list[Fraction]:
    """Return what the loop of :mod:`canon.kernel.loops.gauss` reads after t0 and h.

    µ_ij + µ_i′j′ = 1 for the nodes i′, j′ on the other side of the middle, so that the rounded method is symmetric: of
    the two the one with the smaller i is rounded, to a multiple of the unit that numbers below 2 have, and the other is
    what is left of 1, exactly.
    """
    tableau = average_tableau(degree, points)
    unit, mu = 2 ** (number.mantissa - 1), [[Fraction(1, 2)] * points for _ in range(points)]
    for i in range(points):
        for j in range(points):
            if (i, j) < (points - 1 - i, points - 1 - j):
                mu[i][j] = Fraction(round(tableau.mu[i][j] * unit), unit)
                mu[points - 1 - i][points - 1 - j] = 1 - mu[i][j]
    return coefficient_rows(tableau, mu, h, number)
