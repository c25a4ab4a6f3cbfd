"""Average vector field tableaux against the projection that defines them, and their rounded symmetry."""

from fractions import Fraction

import numpy as np
import pytest
from numpy.polynomial import Legendre

from canon.kernel.llvm.number_types import DOUBLE, DOUBLE_DOUBLE, EXTENDED, SINGLE
from canon.kernel.schemes.average_vector_field import average_coefficients, average_tableau
from canon.kernel.schemes.gauss_tableau import gauss_tableau, lanes_for


@pytest.mark.parametrize("s", [1, 2, 4])
def test_with_as_many_points_as_the_degree_it_is_the_gauss_method(s):
    ours, gauss = average_tableau(s, s), gauss_tableau(s)
    for one, other in ((ours.mu, gauss.mu), (ours.prediction, gauss.prediction)):
        pairs = [(a, b) for x, y in zip(one, other, strict=True) for a, b in zip(x, y, strict=True)]
        assert all(abs(a - b) < Fraction(1, 10**52) for a, b in pairs)
    assert abs(average_tableau(s, s + 1).mu[0][0] - average_tableau(s + 1, s + 1).mu[0][0]) > Fraction(
        1, 1000
    )


@pytest.mark.parametrize(("s", "k"), [(1, 3), (2, 5), (3, 4)])
def test_the_stages_are_on_the_polynomial_whose_rate_is_the_projected_field(s, k):
    """u̇ = Σ_l P_l ∫ P_l f: what f at the j-th node does at the i-th, by NumPy's polynomials on [0, 1]."""
    t = average_tableau(s, k)
    c = np.array(t.c, dtype=float)
    basis = [Legendre.basis(n, domain=[0, 1]) * (2 * n + 1) ** 0.5 for n in range(s)]
    found = sum(np.outer(p.integ(lbnd=0)(c), p(c)) for p in basis)
    np.testing.assert_allclose(np.array(t.mu, dtype=float), found, atol=1e-14)
    assert abs(np.array(average_tableau(s + 1, k).mu, dtype=float) - found).max() > 0.01


@pytest.mark.parametrize("number", [SINGLE, DOUBLE, EXTENDED, DOUBLE_DOUBLE])
@pytest.mark.parametrize(("s", "k"), [(1, 2), (2, 3), (3, 5)])
def test_the_rounded_method_is_symmetric_without_error(s, k, number):
    lanes = lanes_for(k)
    read = average_coefficients(s, k, Fraction(1, 10), number)
    columns = [read[(2 + j) * lanes : (2 + j) * lanes + k] for j in range(k)]
    places = [(i, j) for i in range(k) for j in range(k)]
    assert all(columns[j][i] + columns[k - 1 - j][k - 1 - i] == 1 for i, j in places)
    true, unit = average_tableau(s, k).mu, Fraction(1, 2**number.mantissa)
    assert all(abs(columns[j][i] - true[i][j]) <= unit for i, j in places)


@pytest.mark.slow
def test_the_prediction_continues_polynomials_of_degree_seven_at_most():
    t = average_tableau(2, 10)
    for degree, exact in ((7, True), (8, False)):
        old = [b * c**degree for b, c in zip(t.b, t.c, strict=True)]
        missed = [
            abs(float(sum(n * x for n, x in zip(row, old, strict=True)) - b * (1 + c) ** degree))
            for row, b, c in zip(t.prediction, t.b, t.c, strict=True)
        ]
        assert (max(missed) < 1e-45) == exact
