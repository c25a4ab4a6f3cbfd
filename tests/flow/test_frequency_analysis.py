"""Frequency analysis and reversal: lines that are known, frequencies of integrable motion, no tangent maps."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from canon import RK4, Gauss, Splitting, Taylor, propagate
from canon.flow import (
    Regularity,
    frequency_analysis,
    frequency_diffusion,
    reversal_test,
)
from tests.flow.systems import HENON_HEILES, KEPLER, PENDULUM, kepler_start
from tests.flow.test_chaos import CHAOTIC, REGULAR

LINES = np.array([1.0, np.sqrt(2), np.pi / 7, 0.3])
SIZES = np.array([1.0, 0.5, 0.1, 0.01])


def signal(t, phases=(0, 1, 2, 3)):
    return sum(a * np.exp(1j * (w * t + p)) for a, w, p in zip(SIZES, LINES, phases, strict=True))


def test_lines_are_found_to_the_digits_that_are_stated():
    t = np.linspace(10, 510, 4001)
    found = frequency_analysis(t, signal(t), terms=4)
    np.testing.assert_allclose(found.frequencies, LINES, atol=1e-13)
    np.testing.assert_allclose(found.amplitudes, SIZES * np.exp(1j * np.arange(4)), atol=1e-11)
    assert found.residual < 1e-12
    one = frequency_analysis(t, signal(t))
    assert 1e-13 < abs(one.frequencies[0] - 1) < 3 * one.errors[0] < 1e-7
    real = frequency_analysis(t, signal(t).real, terms=4)
    np.testing.assert_allclose(real.frequencies, LINES, atol=1e-9)
    assert (abs(real.frequencies - LINES) < 3 * real.errors + 1e-13).all()
    rebuilt = (real.amplitudes * np.exp(1j * real.frequencies * t[:, np.newaxis])).sum(axis=1).real
    np.testing.assert_allclose(rebuilt, signal(t).real, atol=1e-8)


@settings(max_examples=50)
@given(
    frequency=st.floats(-6, 6),
    size=st.floats(0.05, 20),
    other=st.floats(1, 3),
    phase=st.floats(0, 6),
    part=st.floats(0, 0.3),
)
def test_any_line_is_found_within_its_error(frequency, size, other, phase, part):
    t = np.linspace(0, 100, 801)
    z = size * (np.exp(1j * (frequency * t + phase)) + part * np.exp(1j * (frequency + other) * t))
    found = frequency_analysis(t, z, terms=2)
    assert abs(found.frequencies[0] - frequency) <= 10 * found.errors[0] + 1e-12
    assert abs(abs(found.amplitudes[0]) - size) < 1e-6 * size


def test_a_line_is_not_found_twice():
    t = np.linspace(0, 100, 801)
    for frequency in (3.4e-15, 0.0, 1.25):
        found = frequency_analysis(t, 3.0 * np.exp(1j * (frequency * t + 2)), terms=3)
        assert len(found.frequencies) == 1
        assert abs(abs(found.amplitudes[0]) - 3) < 1e-12


def test_a_higher_window_leaks_less():
    t = np.linspace(0, 300, 3001)
    missed = [abs(frequency_analysis(t, signal(t), window=p).frequencies[0] - 1) for p in (1, 2, 3, 4, 5)]
    assert missed[0] > 10 * missed[1] > 10 * missed[2]
    assert max(missed[3:]) < 1e-10


def test_the_frequency_of_a_pendulum_is_that_of_the_elliptic_integral():
    """ω = π / (2 K(m)) with m = sin²(θ₀/2)."""
    motion = propagate(PENDULUM, (0, 400), [2.0, 0.0], samples=1200)
    found = frequency_analysis(motion.t, motion.y[0], terms=5)
    true = float(mpmath.pi / (2 * mpmath.ellipk(mpmath.sin(1) ** 2)))
    assert abs(found.frequencies[0] - true) < 1e-11
    np.testing.assert_allclose(found.frequencies[1], 3 * true, atol=1e-9)


def test_frequencies_stay_on_a_curve_and_move_in_the_sea():
    how = {"method": Splitting("kahan-li-8"), "step": 0.2, "samples": 5000}
    start = [0.0, 0.25, 0.3, 0.1]
    for y0, wanted in ((start, Regularity.REGULAR), (CHAOTIC, Regularity.CHAOTIC)):
        motion = propagate(HENON_HEILES, (0, 4000), y0, **how)
        found = frequency_diffusion(motion.t, motion.y[1] - 1j * motion.y[3])
        assert found.verdict is wanted
        assert (found.rate > found.detection_limit) is (wanted is Regularity.CHAOTIC)


def test_signals_that_have_no_lines_are_refused():
    t = np.linspace(0, 10, 101)
    with pytest.raises(ValueError, match="not evenly spaced"):
        frequency_analysis(t**1.01, np.sin(t))
    with pytest.raises(ValueError, match="one value at each of at least 16 times"):
        frequency_analysis(t[:10], np.sin(t[:10]))
    with pytest.raises(ValueError, match="not finite"):
        frequency_analysis(t, np.where(t < 5, 1.0, np.nan))
    with pytest.raises(ValueError, match="window of power 1 … 5"):
        frequency_analysis(t, np.sin(t), window=6)
    with pytest.raises(ValueError, match="constant"):
        frequency_diffusion(t, np.ones(101))
    assert frequency_analysis(t, np.ones(101)).frequencies[0] == pytest.approx(0, abs=1e-12)
    assert frequency_analysis(t, np.zeros(101)).amplitudes[0] == 0


def test_rounding_alone_tells_chaos_on_the_way_back():
    starts = np.array([REGULAR, CHAOTIC]).T
    found = reversal_test(HENON_HEILES, (0, 800), starts, method=Splitting("kahan-li-8"), step=0.2)
    assert list(found.verdict) == [Regularity.REGULAR, Regularity.CHAOTIC]
    assert found.value[0] < 1e-11 < 1e-6 < found.value[1]
    assert found.history.shape == (8, 2)
    kepler = reversal_test(KEPLER, (0, 600), kepler_start(0.3), method=Splitting("verlet"), step=0.05)
    assert kepler.verdict is Regularity.REGULAR


def test_methods_that_do_not_return_are_refused():
    lopsided = Splitting(a=["1/3", "2/3"], b=["1/4", "3/4"])
    for method, step in ((RK4(), 0.1), (Taylor(), 0.1), (lopsided, 0.1)):
        with pytest.raises(ValueError, match="is not symmetric"):
            reversal_test(HENON_HEILES, (0, 10), REGULAR, method=method, step=step)
    with pytest.raises(ValueError, match="rounding alone may have turned the whole orbit"):
        reversal_test(HENON_HEILES, (0, 10**9), REGULAR, method=Gauss(2), step=0.1)


def test_a_signal_of_a_motion_back_in_time_has_the_same_lines():
    t = np.linspace(0, 400, 2001)
    for values in (signal(t), np.cos(1.25 * t) + 0.1 * np.cos(3 * t)):
        forward, back = (frequency_analysis(t[::way], values[::way], terms=2) for way in (1, -1))
        np.testing.assert_array_equal(back.frequencies, forward.frequencies)
        np.testing.assert_array_equal(back.amplitudes, forward.amplitudes)
    found = frequency_diffusion(-t, np.cos(1.25 * t))
    assert found.verdict is Regularity.REGULAR
    assert found.rate >= 0


def test_errors_of_noisy_signals_and_of_lines_that_are_near_are_no_accident():
    """Two windows may agree on a wrong place: errors were stated up to a thousand times too small."""
    rng, t = np.random.default_rng(0), np.linspace(0, 500, 1001)
    for _ in range(12):
        w, phases = rng.uniform(0.5, 2), rng.uniform(0, 2 * np.pi, 2)
        noise = rng.normal(size=t.size) * 10 ** rng.uniform(-8, -1)
        noisy = np.cos(w * t + phases[0]) + 0.3 * np.cos(1.618 * w * t) + noise
        near = np.exp(1j * w * t) + 0.5 * np.exp(1j * ((w + rng.uniform(0.04, 0.3)) * t + phases[1]))
        for values in (noisy, near):
            found = frequency_analysis(t, values, terms=2)
            k = np.argmin(abs(found.frequencies - w))
            assert abs(found.frequencies[k] - w) < 4 * found.errors[k]


def test_an_angle_that_turns_is_refused_and_its_sine_is_not():
    t = np.linspace(0, 500, 4001)
    angle = 1.968 * t + 0.3 * np.sin(1.968 * t)
    for follow in (frequency_analysis, frequency_diffusion):
        with pytest.raises(ValueError, match="goes on in one direction"):
            follow(t, angle)
    assert frequency_diffusion(t, np.sin(angle)).first == pytest.approx(1.968, rel=1e-9)
