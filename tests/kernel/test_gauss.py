"""Gauss–Legendre tableaux against the simplifying assumptions that define them."""

from fractions import Fraction

import numpy as np
import pytest

from canon.kernel.schemes.gauss_tableau import HIGHEST_STAGES, gauss_coefficients, gauss_tableau

STAGES = range(1, HIGHEST_STAGES + 1)
NEGLIGIBLE = Fraction(1, 10**55)


@pytest.mark.parametrize("s", STAGES)
def test_quadrature_collocation_and_symplecticity(s):
    t = gauss_tableau(s)
    a = [[mu * b for mu, b in zip(row, t.b, strict=True)] for row in t.mu]
    for k in range(1, 2 * s + 1):  # B(2s): order of the quadrature
        assert abs(sum(b * c ** (k - 1) for b, c in zip(t.b, t.c, strict=True)) - Fraction(1, k)) < NEGLIGIBLE
    for row, c in zip(a, t.c, strict=True):  # C(s): collocation
        for k in range(1, s + 1):
            assert (
                abs(sum(x * d ** (k - 1) for x, d in zip(row, t.c, strict=True)) - c**k / k)
                < NEGLIGIBLE * 100
            )
    assert all(abs(t.mu[i][j] + t.mu[j][i] - 1) < NEGLIGIBLE for i in range(s) for j in range(s))


@pytest.mark.parametrize("s", STAGES)
def test_the_prediction_continues_polynomials(s):
    t = gauss_tableau(s)
    for degree in range(s):  # stages L_j = b_j f(c_j) with f(x) = x^degree; the next step sees f(1 + x)
        old = [b * c**degree for b, c in zip(t.b, t.c, strict=True)]
        for row, b, c in zip(t.prediction, t.b, t.c, strict=True):
            assert abs(sum(n * x for n, x in zip(row, old, strict=True)) - b * (1 + c) ** degree) < Fraction(
                1, 10**50
            )


@pytest.mark.parametrize("s", STAGES)
def test_the_rounded_method_is_symplectic_without_error(s):
    rows = np.array([float(x) for x in gauss_coefficients(s, Fraction(1, 10))]).reshape(2 + 2 * s, -1)[:, :s]
    mu = [[Fraction(x) for x in row] for row in rows[2 : 2 + s].T.tolist()]
    assert all(mu[i][j] + mu[j][i] == 1 for i in range(s) for j in range(s))
    true = np.array([[float(x) for x in row] for row in gauss_tableau(s).mu])
    np.testing.assert_allclose(rows[2 : 2 + s].T, true, atol=2.3e-16)
