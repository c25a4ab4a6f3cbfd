"""Gauss–Legendre quadrature as a Runge–Kutta method: nodes, weights and matrices, to 60 digits and rounded.

A method is symplectic where µ_ij + µ_ji = 1 with µ_ij = a_ij/b_j, which the rounded µ fulfil exactly.

Source: E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration (2nd ed., Springer 2006), § II.1.3, VI.4.1.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from mpmath import MPContext

from canon.expression.graph.number_systems import LONGDOUBLE
from canon.kernel.llvm.number_types import DOUBLE, EXTENDED, MachineType, double_pair

__all__ = [
    "HIGHEST_STAGES",
    "Tableau",
    "coefficient_rows",
    "gauss_coefficients",
    "gauss_tableau",
    "lanes_for",
]

HIGHEST_STAGES = 8


@dataclass(frozen=True)
class Tableau:
    """Nodes and weights of Gauss–Legendre quadrature on [0, 1] and the method's matrices, 60 digits.

    Parameters
    ----------
    c, b
        Nodes and weights.
    mu
        µ_ij = a_ij / b_j; µ_ij + µ_ji = 1 in Gauss methods.
    prediction
        ν_ij: L_i of the next step is about Σ ν_ij L_j, the stages' polynomial continued.
    """

    c: tuple[Fraction, ...]
    b: tuple[Fraction, ...]
    mu: tuple[tuple[Fraction, ...], ...]
    prediction: tuple[tuple[Fraction, ...], ...]


@functools.cache
def gauss_tableau(stages: int) -> Tableau:
    """Return the Gauss–Legendre method with s stages, from its definition.

    The nodes are the zeros of the shifted Legendre polynomial P_s(2c − 1); a_ij and b_j integrate Lagrange's
    polynomials ℓ_j over [0, c_i] and [0, 1].
    """
    context = MPContext()
    context.dps = 80
    legendre: Any = sp.legendre_poly(stages, polys=True)
    zeros = context.polyroots([int(2**stages * x) for x in legendre.all_coeffs()], maxsteps=200)
    c: list[Any] = sorted((1 + context.re(zero)) / 2 for zero in zeros)
    vandermonde = context.matrix([[node**k for node in c] for k in range(stages)])

    def weights(moments: list[Any]) -> list[Any]:
        return list(context.lu_solve(vandermonde, context.matrix(moments)))

    b = weights([context.mpf(1) / (k + 1) for k in range(stages)])
    mu = [
        [
            a / weight
            for a, weight in zip(weights([x ** (k + 1) / (k + 1) for k in range(stages)]), b, strict=True)
        ]
        for x in c
    ]
    prediction = [
        [
            own * ell / weight
            for ell, weight in zip(weights([(1 + x) ** k for k in range(stages)]), b, strict=True)
        ]
        for x, own in zip(c, b, strict=True)
    ]
    digits = context.mpf(10) ** 60

    def exact(values: list[Any]) -> tuple[Fraction, ...]:
        return tuple(Fraction(int(context.nint(value * digits)), 10**60) for value in values)

    return Tableau(exact(c), exact(b), tuple(map(exact, mu)), tuple(map(exact, prediction)))


def gauss_coefficients(stages: int, h: Fraction, number: MachineType = DOUBLE) -> list[Fraction]:
    """Return what the loop reads after t0 and h: h b, h c, the columns of µ, the columns of ν, padded to lanes.

    µ_ij is rounded for i > j, where it lies in [½, 2] so that 1 − µ_ij is a number of the same type as well.
    """
    tableau = gauss_tableau(stages)

    def rounded(value: Fraction) -> Fraction:
        return _rounded(value, number)

    mu = [[Fraction(1, 2)] * stages for _ in range(stages)]
    for i in range(stages):
        for j in range(i):
            mu[i][j] = rounded(tableau.mu[i][j])
            mu[j][i] = 1 - mu[i][j]
    return coefficient_rows(tableau, mu, h, number)


def coefficient_rows(
    tableau: Tableau, mu: list[list[Fraction]], h: Fraction, number: MachineType
) -> list[Fraction]:
    """Return h b, h c, the columns of a µ that is rounded already, the columns of ν, padded to lanes."""

    def rounded(value: Fraction) -> Fraction:
        return _rounded(value, number)

    rows = [
        [rounded(h * b) for b in tableau.b],
        [rounded(h * c) for c in tableau.c],
        *map(list, zip(*mu, strict=True)),
        *([rounded(x) for x in column] for column in zip(*tableau.prediction, strict=True)),
    ]
    empty = [Fraction(0)] * (lanes_for(len(mu)) - len(mu))
    return [x for row in rows for x in (*row, *empty)]


def _rounded(value: Fraction, number: MachineType) -> Fraction:
    """Return a number of a type near an exact one."""
    if number == EXTENDED:
        return Fraction(*LONGDOUBLE.number(value).as_integer_ratio())
    high, low = double_pair(value)
    if number.pair:
        return Fraction(high) + Fraction(low)
    return Fraction(*np.dtype(number.dtype).type(high).as_integer_ratio())


def lanes_for(stages: int) -> int:
    """Return how many SIMD lanes the stages of a method lie in."""
    return 1 << (stages - 1).bit_length()
