"""The covariances of window means, against sums over the path; the tests on them, at their claimed levels."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from canon.study.energy_drift.block_means import PLACES, WIDTH, block_means, bump, window_starts
from canon.study.energy_drift.growth import power_of_time, power_of_wandering, return_of, slope_of, walk_of
from canon.study.energy_drift.noise_models import returning_covariance, scatter_covariance, walk_covariance

WINDOWS = 32
Array = NDArray[np.float64]


def weights_on_a_path(windows: int, per_block: int) -> tuple[Array, Array]:
    """Times (in blocks) of a finely sampled path and the weight of each sample in each window."""
    times = (np.arange((windows + WIDTH) * per_block) + 0.5) / per_block
    weight = bump((times - window_starts(windows)[:, None] / PLACES) / WIDTH)
    return times, weight / weight.sum(axis=1, keepdims=True)


@pytest.mark.parametrize("exponent", [0.25, 0.5, 0.8])
def test_walk_covariance_is_that_of_fractional_brownian_motion(exponent):
    times, weight = weights_on_a_path(12, 60)
    power = 2.0 * exponent
    path = times**power
    motion = 0.5 * (path[:, None] + path - np.abs(times[:, None] - times) ** power)
    of_means = weight @ motion @ weight.T / power
    expected = np.diff(np.diff(of_means, axis=0), axis=1)
    np.testing.assert_allclose(walk_covariance(exponent, 12), expected, atol=2e-3 * expected.max())


def test_scatter_covariance_is_that_of_white_noise():
    _, weight = weights_on_a_path(12, 100)
    of_means = weight @ weight.T
    expected = np.diff(np.diff(of_means / of_means[0, 0], axis=0), axis=1)
    np.testing.assert_allclose(scatter_covariance(12), expected, atol=1e-3)


@pytest.mark.parametrize("memory", [2.0, 10.0])
def test_returning_covariance_is_that_of_ornstein_and_uhlenbecks_process(memory):
    times, weight = weights_on_a_path(12, 60)
    motion = 0.5 * memory * np.exp(-np.abs(times[:, None] - times) / memory)
    expected = np.diff(np.diff(weight @ motion @ weight.T, axis=0), axis=1)
    np.testing.assert_allclose(returning_covariance(memory, 12), expected, atol=3e-3 * expected.max())


def test_a_long_memory_is_a_walk():
    walk = walk_covariance(0.5, 12)
    np.testing.assert_allclose(returning_covariance(1e5, 12), walk, atol=2e-2 * walk.max())


def test_walks_seem_to_return_once_in_a_hundred():
    number = 1000
    alarms = sum(return_of(means).evidence > 5.5 for means in draws(np.inf, number, seed=10, windows=128))
    assert alarms <= at_most(0.01, number)


def draws(ratio: float, number: int, seed: int, windows: int = WINDOWS) -> Array:
    """Window means whose scatter has variance one and whose walk has variance ``ratio`` per block."""
    walk, scatter = walk_covariance(0.5, windows), scatter_covariance(windows)
    covariance = walk if np.isinf(ratio) else scatter + ratio * walk
    random = np.random.default_rng(seed)
    increments = random.normal(size=(number, windows - 1)) @ np.linalg.cholesky(covariance).T
    return np.concatenate([np.zeros((number, 1)), np.cumsum(increments, axis=1)], axis=1)


def at_most(share: float, number: int) -> float:
    """Count that a binomial of this share exceeds less than once in a thousand."""
    return share * number + 3.1 * np.sqrt(share * (1.0 - share) * number)


@pytest.mark.parametrize(
    "ratio", [0.0, 0.3, np.inf, *(pytest.param(ratio, marks=pytest.mark.slow) for ratio in (0.1, 1.0, 10.0))]
)
def test_slope_false_alarms_keep_their_level_for_every_mixture(ratio):
    """At worst, near a ratio of 0.3, they come 1.3 times as often as claimed."""
    number = 1500
    alarms = sum(slope_of(means, 0.01).probability < 0.01 for means in draws(ratio, number, seed=1))
    assert alarms <= at_most(0.013, number)


def test_least_squares_would_not():
    """The twin that must fail: a straight line through a walk is "significant" most of the time."""
    time = window_starts(WINDOWS) / PLACES
    centred = time - time.mean()
    alarms = 0
    for means in draws(np.inf, 300, seed=2):
        slope = centred @ means / (centred @ centred)
        rest = means - means.mean() - slope * centred
        error = np.sqrt(rest @ rest / (WINDOWS - 2) / (centred @ centred))
        alarms += abs(slope / error) > 2.75
    assert alarms > 150


def test_slope_error_is_the_scatter_of_the_slope():
    found = [slope_of(means, 0.01) for means in draws(np.inf, 800, seed=3)]
    spread = np.std([slope.value / slope.error for slope in found])
    assert 0.9 < spread < 1.2


def test_a_slope_is_recovered_with_its_sign():
    time = window_starts(WINDOWS) / PLACES
    found = [slope_of(means - 0.7 * time, 0.01) for means in draws(0.0, 100, seed=4)]
    assert all(abs(slope.value + 0.7) < 5.0 * slope.error for slope in found)
    assert np.median([slope.error for slope in found]) < 0.05
    assert sum(slope.probability < 0.01 for slope in found) >= 99


@pytest.mark.parametrize("ratio", [0.0, np.inf])
def test_a_slope_at_the_detection_limit_is_found(ratio):
    """In 95 % of cases on average; the limit is itself an estimate."""
    time = window_starts(WINDOWS) / PLACES
    number = 400
    found = 0
    for means in draws(ratio, number, seed=5):
        limit = slope_of(means, 0.01).detection_limit
        found += slope_of(means + limit * time, 0.01).probability < 0.01
    assert 0.9 * number < found


def test_walk_false_alarms_come_once_in_a_hundred():
    number = 6000
    alarms = sum(walk_of(means).evidence > 5.4 for means in draws(0.0, number, seed=6))
    assert 0.6e-2 * number < alarms < at_most(0.01, number)


def test_a_pure_walk_is_found_and_measured():
    found = [walk_of(means) for means in draws(np.inf, 400, seed=7)]
    assert np.mean([walk.evidence > 5.4 for walk in found]) > 0.95
    # The slope that is taken out has a share of the walk: 0.935 of 4 000 walks.
    size = np.sqrt(np.mean([walk.size**2 for walk in found]) / (WINDOWS + WIDTH))
    assert 0.90 < size < 0.97


@pytest.mark.parametrize("ratio", [1.0, np.inf])
def test_the_confidence_interval_of_a_walk_holds_one_half(ratio):
    found = [
        power_of_wandering(means, beside_scatter=True) for means in draws(ratio, 150, seed=8, windows=128)
    ]
    covered = np.mean([exponent.low <= 0.5 <= exponent.high for exponent in found])
    assert covered > 0.88
    narrow = np.median([exponent.high - exponent.low for exponent in found])
    assert narrow < (0.45 if np.isinf(ratio) else 0.85)


@pytest.mark.parametrize("power", [1.0, 2.0])
def test_the_confidence_interval_of_a_power_law_holds_its_exponent(power):
    time = (window_starts(WINDOWS) / PLACES + WIDTH / 2.0) / (WINDOWS + WIDTH)
    shape = time**power
    found = [power_of_time(means + 60.0 * shape) for means in draws(0.0, 120, seed=9)]
    covered = np.mean([exponent.low <= power <= exponent.high for exponent in found])
    assert covered > 0.88
    assert np.median([exponent.high - exponent.low for exponent in found]) < 0.5


def test_window_means_remove_an_oscillation_and_keep_a_line():
    t = np.linspace(0.0, 340.0, 8001)
    found = block_means(t, 3.0 + 0.01 * t + np.sin(2.0 * np.pi * 9.3 * t))
    np.testing.assert_allclose(found.mean, 3.0 + 0.01 * found.t, atol=1e-6)
    np.testing.assert_allclose(found.amplitude, np.sqrt(0.5), rtol=1e-3)


def test_uneven_samples_are_refused():
    t = np.concatenate([np.linspace(0.0, 1.0, 4000), np.linspace(1.1, 40.0, 100)])
    with pytest.raises(ValueError, match=r"window \d+ of 32 holds"):
        block_means(t, np.zeros_like(t))
