"""Student's t distribution, inverses of triangles and whitened noise that drifts are judged by, against SciPy's."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import solve_triangular
from scipy.special import stdtr, stdtrit

from canon.study.energy_drift.growth import _place_of
from canon.study.energy_drift.noise_models import (
    _inverse_triangles,
    fractional,
    local_level,
    returning,
    returning_covariance,
    scatter_covariance,
    walk_covariance,
    wandering,
)
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


@pytest.mark.parametrize("windows", [8, 64])
@pytest.mark.parametrize(
    ("family", "covariance"),
    [
        (local_level, walk_covariance),
        (fractional, walk_covariance),
        (wandering, walk_covariance),
        (returning, returning_covariance),
    ],
)
def test_noise_is_white_to_its_own_member(family, covariance, windows):
    """W C Wᵀ is the unit matrix and 2 ln|W| = −ln|C| for the covariance C of each member, and of no other."""
    found = family(windows)
    whiteners = found.whitened(np.eye(windows - 1))
    scatter = scatter_covariance(windows)
    members = [
        (not np.isinf(ratio)) * scatter + (1 if np.isinf(ratio) else ratio) * covariance(float(h), windows)
        for h, ratio in zip(found.exponent, found.ratio, strict=True)
    ]
    for W, C, determinant in zip(whiteners, members, found.log_determinant, strict=True):
        np.testing.assert_allclose(W @ C @ W.T, np.eye(windows - 1), atol=1e-9)
        assert abs(np.linalg.slogdet(C)[1] - determinant) < 1e-8
    W, C = whiteners[0], members[-1]
    assert np.abs(W @ C @ W.T - np.eye(windows - 1)).max() > 1e-3


@given(st.integers(1, 60), st.floats(1e-5, 0.4))
def test_the_place_where_a_tail_falls_to_a_value_is_found_in_few_looks(freedom, value):
    looks = []

    def tail(t):
        looks.append(t)
        return float(student_tail(freedom, np.array(t)))

    expected = -stdtrit(freedom, value)
    if expected < 900:
        assert abs(_place_of(tail, value) - expected) < 1e-7 * max(1.0, expected)
    assert len(looks) < 25  # halving takes forty
