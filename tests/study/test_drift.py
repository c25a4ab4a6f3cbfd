"""Verdicts on series of known kinds; what is no data is refused."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from canon.study.energy_drift.drift import Growth, drift
from canon.study.energy_drift.growth import slope_of
from tests.study import series

TIMES = series.TIMES


def judged(make, number, seed, **options):
    random = np.random.default_rng(seed)
    return [drift(TIMES, make(random), **options) for _ in range(number)]


def verdicts(found):
    return Counter(each.verdict for each in found)


@pytest.mark.parametrize("name", series.BOUNDED)
def test_bounded_series_are_called_bounded(name):
    """At most 1 % are called secular and 1 % a walk (a little more for the peaks of a pericentre)."""
    found = verdicts(judged(series.BOUNDED[name], 200, seed=11))
    assert found[Growth.SECULAR] + found[Growth.DIVERGED] <= 7
    assert found[Growth.ROUND_OFF] + found[Growth.UNDECIDED] <= 9
    assert found[Growth.BOUNDED] >= 188


@pytest.mark.parametrize("name", series.ROUND_OFF)
def test_walks_are_called_round_off(name):
    found = judged(series.ROUND_OFF[name], 200, seed=12, roundoff=1e-13)
    counts = verdicts(found)
    assert counts[Growth.SECULAR] + counts[Growth.DIVERGED] <= 7
    assert counts[Growth.ROUND_OFF] >= 176
    sizes = [each.walk for each in found if each.verdict is Growth.ROUND_OFF]
    assert 0.7e-13 < np.sqrt(np.mean(np.square(sizes))) < 1.4e-13


@pytest.mark.parametrize(("share", "most"), [(1.0 / 100.0, 3), (1.0 / 41.0, 7)])
def test_bounded_noise_with_a_memory_is_not_called_round_off(share, most):
    """It comes back to its mean; a walk with increments of the same size does not."""
    found = verdicts(judged(lambda random: 1e-8 * series.remembering(random, share), 200, seed=19))
    assert found[Growth.ROUND_OFF] + found[Growth.SECULAR] <= most
    assert found[Growth.BOUNDED] >= 170


def test_the_reason_names_the_memory():
    found = drift(TIMES, 1e-8 * series.remembering(np.random.default_rng(5), 1.0 / 41.0))
    assert found.verdict is Growth.BOUNDED
    assert "returns within a time of about" in found.reason
    assert 8.0 < float(found.reason.split()[-1]) < 50.0
    assert found.walk == 0.0


@pytest.mark.parametrize("name", series.SECULAR)
def test_drifts_are_called_secular(name):
    exponent, make = series.SECULAR[name]
    found = judged(make, 50, seed=13)
    assert verdicts(found)[Growth.SECULAR] >= 49
    assert abs(np.median([each.exponent for each in found]) - exponent) < 0.05
    covered = np.mean([each.exponent_interval[0] <= exponent <= each.exponent_interval[1] for each in found])
    assert covered >= 0.84


def test_the_slope_is_measured_under_an_oscillation_a_hundred_times_larger():
    for found in judged(
        lambda random: 1e-6 * series.oscillation(random, 3, 150.0) - 1e-8 * series.SHARE, 30, 14
    ):
        assert found.verdict is Growth.SECULAR
        assert found.slope == pytest.approx(-1e-11, rel=0.05)
        assert abs(found.slope + 1e-11) < 6.0 * found.slope_error


def test_a_widening_oscillation_is_secular_although_its_mean_is_not():
    found = drift(TIMES, 1e-6 * series.SHARE * np.sin(2.0 * np.pi * 331.7 * series.SHARE))
    assert found.verdict is Growth.SECULAR
    assert abs(found.slope) < 5.0 * found.slope_error
    assert found.amplitude_slope == pytest.approx(1e-6 / series.SPAN / np.sqrt(2.0), rel=1e-3)
    assert "widens" in found.reason


def test_a_mean_that_drifts_and_an_oscillation_that_widens_share_the_false_alarms() -> None:
    size = 1 + np.interp(series.SHARE, np.linspace(0, 1, 41), np.random.default_rng(3).uniform(-0.5, 0.5, 41))
    error = 1e-6 * (1 + series.SHARE) * size * np.sin(2.0 * np.pi * 331.7 * series.SHARE)
    by_chance = slope_of(drift(TIMES, error).blocks.amplitude, 0.01).probability
    assert 0.01 < by_chance < 0.1
    found = [drift(TIMES, error, false_alarm=share * by_chance).verdict for share in (1.9, 2.1)]
    assert found == [Growth.BOUNDED, Growth.SECULAR]


@pytest.mark.parametrize("turns", [1.0, 2.0, 3.0])
def test_a_slow_oscillation_is_not_called_round_off_or_bounded(turns):
    found = drift(TIMES, 1e-6 * np.sin(2.0 * np.pi * turns * series.SHARE + 0.4), roundoff=1e-14)
    assert found.verdict is Growth.UNDECIDED
    assert "slow oscillation" in found.reason


@pytest.mark.parametrize("size", [1e-15, 1e-8, 0.3])
def test_a_series_alone_does_not_tell_rounding_from_truncation(size):
    """A walk of any size is a walk; what makes it walk is known where the steps and the precision are."""
    error = size * series.walk(np.random.default_rng(15))
    found = drift(TIMES, error, resolution=1e-3 * size)
    assert found.verdict is Growth.WANDERING
    assert "drift(motion)" in found.reason
    assert found.cause == ""
    assert drift(TIMES, error, roundoff=size, resolution=1e-3 * size).verdict is Growth.ROUND_OFF


def test_a_walk_far_beyond_round_off_is_not_round_off():
    error = 1e-9 * series.walk(np.random.default_rng(15))
    found = drift(TIMES, error, roundoff=1e-13)
    assert found.verdict is Growth.WANDERING
    assert "far beyond the 1e-13" in found.reason


@pytest.mark.parametrize("rate", [8.0, 12.0, 20.0])
def test_exponential_growth_has_diverged(rate):
    assert drift(TIMES, 1e-14 * np.exp(rate * series.SHARE)).verdict is Growth.DIVERGED


def test_an_error_as_large_as_the_quantity_has_diverged():
    error = 2.0 * series.SHARE
    assert drift(TIMES, error).verdict is Growth.DIVERGED
    assert drift(TIMES, error, diverged=10.0).verdict is Growth.SECULAR


def test_no_error_at_all_is_below_the_resolution():
    found = drift(TIMES, np.zeros_like(TIMES))
    assert found.verdict is Growth.BOUNDED
    assert found.bound == 0.0
    assert found.detection_limit == pytest.approx(2.0**-53 / series.SPAN)
    assert found.exponent_interval == (0.0, 1.0)
    assert (found.slope, found.amplitude_slope, found.exponent, found.walk) == (0.0, 0.0, 0.0, 0.0)


def test_errors_of_a_few_units_in_the_last_place_are_bounded():
    random = np.random.default_rng(16)
    found = drift(TIMES, 2.0**-53 * random.integers(-2, 3, TIMES.size))
    assert found.verdict is Growth.BOUNDED
    assert found.detection_limit >= 2.0**-53 / series.SPAN


def test_scaling_the_error_scales_the_answer_and_keeps_the_verdict():
    error = 1e-6 * (series.oscillation(np.random.default_rng(17)) + 0.3 * series.SHARE)
    one, other = drift(TIMES, error), drift(2.0 * TIMES, -1e-3 * error)
    assert one.verdict is other.verdict is Growth.SECULAR
    assert other.slope == pytest.approx(-0.5e-3 * one.slope, rel=1e-9)
    assert other.slope_error == pytest.approx(0.5e-3 * one.slope_error, rel=1e-9)
    assert other.exponent == one.exponent


def test_a_walk_that_round_off_explains_is_round_off_and_a_larger_one_is_not():
    """Known round-off leaves fewer walks undecided, none that is far larger is called so."""
    walks = [1e-13 * series.walk(np.random.default_rng(seed)) for seed in range(60)]

    def verdicts(roundoff):
        return [drift(TIMES, error, roundoff=roundoff).verdict for error in walks]

    unknown, known = verdicts(None).count(Growth.WANDERING), verdicts(1e-13).count(Growth.ROUND_OFF)
    assert known >= max(unknown, 57)
    assert Growth.ROUND_OFF not in verdicts(None)
    assert Growth.ROUND_OFF not in verdicts(1e-16)


def test_noise_that_returns_is_bounded_whatever_round_off_is_expected():
    noises = [1e-14 * series.remembering(np.random.default_rng(seed), 0.01) for seed in range(40)]
    found = [drift(TIMES, error[: TIMES.size], roundoff=1e-14).verdict for error in noises]
    assert found.count(Growth.BOUNDED) >= 38


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_failed_run_is_never_data(bad):
    error = np.zeros_like(TIMES)
    error[1000] = bad
    with pytest.raises(ValueError, match=r"not finite at sample 1000 .*a failed run is no data"):
        drift(TIMES, error)


def test_what_is_no_series_is_refused():
    with pytest.raises(ValueError, match="at least 256"):
        drift(np.arange(100.0), np.zeros(100))
    with pytest.raises(ValueError, match="increase strictly"):
        drift(TIMES[::-1], np.zeros_like(TIMES))
    with pytest.raises(ValueError, match="one length"):
        drift(TIMES, np.zeros(TIMES.size - 1))


def test_jittered_samples_see_what_even_ones_in_step_miss():
    """Samples in step with an oscillation see a slow one; scattered ones do not."""
    even = np.arange(4096.0)
    turn = 2.0 * np.pi * (1.0 + 1.3 / 4096.0)
    assert drift(even, 1e-6 * np.sin(turn * even)).verdict is not Growth.BOUNDED
    scattered = even + np.random.default_rng(18).uniform(0.0, 1.0, even.size)
    assert drift(scattered, 1e-6 * np.sin(turn * scattered)).verdict is Growth.BOUNDED


def test_the_answer_reads_as_words():
    text = str(drift(TIMES, 1e-6 * np.sin(900.0 * series.SHARE)))
    assert text.startswith("bounded: no growth above the detection limit")
    assert "largest error    1e-06" in text


def test_a_slow_change_of_the_oscillations_size_is_no_growth():
    """What the eccentricity of an orbit does to it; where it doubles, it counts."""
    swing = np.sin(2.0 * np.pi * 331.7 * series.SHARE)
    assert drift(TIMES, 1e-6 * (1.0 + 0.3 * series.SHARE) * swing).verdict is Growth.BOUNDED
    assert drift(TIMES, 1e-6 * (1.0 + series.SHARE) * swing).verdict is Growth.SECULAR


def test_what_slows_down_beneath_an_oscillation_is_undecided():
    """A quarter of a slow oscillation looks so; the same above the oscillation is a loss that is real."""
    arc, swing = np.sin(0.5 * np.pi * series.SHARE) ** 0.6, np.sin(2.0 * np.pi * 331.7 * series.SHARE)
    found = drift(TIMES, 1e-7 * arc + 1e-6 * swing)
    assert found.verdict is Growth.UNDECIDED
    assert "slows down" in found.reason
    assert drift(TIMES, 1e-5 * arc + 1e-6 * swing).verdict is Growth.SECULAR


QUADRUPLING = {
    "steadily": 1.0 + 3.0 * series.SHARE,
    "exponentially": 4.0**series.SHARE,
    "in the middle": np.where(series.SHARE > 0.5, 4.0, 1.0),
    "late": np.where(series.SHARE > 0.8, 4.0, 1.0),
    "at the very end": np.where(series.SHARE > 0.92, 4.0, 1.0),
    "faster and faster": 1.0 + 3.0 * series.SHARE**8,
}


@pytest.mark.parametrize("turns", [12.0, 40.0, 331.7, 1500.0])
@pytest.mark.parametrize("how", QUADRUPLING)
def test_an_oscillation_that_quadruples_is_not_bounded(how, turns):
    swing = 1e-6 * np.sin(2.0 * np.pi * turns * series.SHARE + 0.3)
    assert drift(TIMES, QUADRUPLING[how] * swing).verdict in (Growth.SECULAR, Growth.UNDECIDED)
    assert drift(TIMES, swing).verdict is Growth.BOUNDED


def test_a_modulation_that_comes_back_twice_is_bounded():
    modulation = 1.0 + 1.5 * (1.0 - np.cos(4.0 * np.pi * series.SHARE))
    found = drift(TIMES, 1e-6 * modulation * np.sin(2.0 * np.pi * 331.7 * series.SHARE))
    assert found.verdict is Growth.BOUNDED


def test_complex_series_are_refused():
    """The imaginary part would be dropped, and what grows in it called bounded."""
    t = np.linspace(0.0, 1000.0, 4001)
    for times, error in ((t, 1j * t), (t * (1 + 0j), t)):
        with pytest.raises(ValueError, match="real"):
            drift(times, error)
