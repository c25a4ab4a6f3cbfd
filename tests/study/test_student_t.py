"""Student's t distribution and the inverses of triangles that drifts are judged by, against SciPy's."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import solve_triangular
from scipy.special import stdtr

from canon.study.energy_drift.noise_models import _inverse_triangles
from canon.study.energy_drift.student_t import student_tail

PLACES = np.concatenate([np.linspace(-30, 30, 601), [np.inf, -np.inf, 1e300]])


@pytest.mark.parametrize("freedom", [*range(1, 41), 100, 501])
def test_the_tail_is_scipys(freedom):
    np.testing.assert_allclose(student_tail(freedom, PLACES), stdtr(freedom, -PLACES), rtol=0, atol=2e-14)


def test_one_degree_more_is_noticed():
    assert abs(student_tail(30, PLACES) - stdtr(31, -PLACES)).max() > 1e-4


@given(st.integers(1, 12), st.integers(1, 4), st.integers(0, 2**32 - 1))
def test_inverses_of_triangles(n, members, seed):
    lower = np.tril(np.random.default_rng(seed).normal(size=(members, n, n))) + 4 * np.eye(n)
    for each, found in zip(lower, _inverse_triangles(lower), strict=True):
        np.testing.assert_allclose(found, solve_triangular(each, np.eye(n), lower=True), atol=1e-12)
        np.testing.assert_array_equal(np.triu(found, 1), 0)
