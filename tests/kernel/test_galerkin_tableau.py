"""Galerkin tableaux: quadratures by their degrees, polynomials by NumPy's, the rounded tableau symmetric."""

from fractions import Fraction

import numpy as np
import pytest
from numpy.polynomial import Legendre

from canon.kernel.schemes.galerkin_tableau import galerkin_coefficients, galerkin_tableau

RULES = [(1, "gauss"), (3, "gauss"), (2, "lobatto"), (3, "lobatto"), (6, "lobatto")]


@pytest.mark.parametrize(("points", "quadrature"), RULES)
def test_the_quadrature_is_exact_up_to_its_degree_and_no_further(points, quadrature):
    t = galerkin_tableau(1, points, quadrature)
    highest = 2 * points - (1 if quadrature == "gauss" else 3)
    for power in range(highest + 2):
        missed = abs(sum(b * c**power for b, c in zip(t.b, t.c, strict=True)) - Fraction(1, power + 1))
        assert (missed < Fraction(1, 10**55)) == (power <= highest)


@pytest.mark.parametrize(("degree", "points", "quadrature"), [(2, 3, "lobatto"), (3, 5, "gauss")])
def test_values_and_integrals_are_those_of_legendres_polynomials(degree, points, quadrature):
    t = galerkin_tableau(degree, points, quadrature)
    c = np.array(t.c, dtype=float)
    for k in range(degree):
        basis = Legendre.basis(k, domain=[0, 1])
        np.testing.assert_allclose(np.array(t.values[k], dtype=float), basis(c), atol=1e-15)
        np.testing.assert_allclose(np.array(t.integrals[k], dtype=float), basis.integ(lbnd=0)(c), atol=1e-15)


@pytest.mark.parametrize(
    ("degree", "points", "quadrature"), [(2, 3, "lobatto"), (3, 4, "gauss"), (4, 5, "lobatto")]
)
def test_the_rounded_tableau_is_symmetric_and_continues_polynomials(degree, points, quadrature):
    read = galerkin_coefficients(degree, points, quadrature, Fraction(1))
    rows = [read[1 + k * points : 1 + (k + 1) * points] for k in range(2 + 2 * degree)]
    values, integrals, shares = (
        rows[2 : 2 + degree],
        rows[2 + degree :],
        read[1 + points * (2 + 2 * degree) :],
    )
    for k, (value, integral) in enumerate(zip(values, integrals, strict=True)):
        assert value == [(-1) ** k * x for x in reversed(value)]
        assert integral == [(1 if k == 0 else 0) + (-1) ** (k + 1) * x for x in reversed(integral)]
        assert all(x * 2**53 == int(x * 2**53) for x in (*value, *integral))
    z = np.linspace(-1, 1, 7)
    for m in range(degree):
        found = sum(float(shares[k * degree + m]) * Legendre.basis(k)(z) for k in range(degree))
        np.testing.assert_allclose(found, Legendre.basis(m)(z + 2), atol=1e-12)
