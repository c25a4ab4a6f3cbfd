"""Kepler's flow against the same equation solved in 60-digit arithmetic by bisection."""

import ctypes
import functools
import math

import mpmath
import numpy as np
import pytest

from canon.kernel.llvm.loop import compiled_function
from canon.kernel.llvm.number_types import DOUBLE, DOUBLE_DOUBLE, EXTENDED, SINGLE
from canon.kernel.llvm.writer import Writer
from canon.kernel.solvable.kepler_flow import kepler_flow


@functools.cache
def compiled(lanes, axes, number=DOUBLE):
    w = Writer(number)
    v = w.side_by_side(lanes)
    x, u = ([v.load("%y", part * axes + axis) for axis in range(axes)] for part in (0, 1))
    motion = kepler_flow(w, v, x, u, v.load("%m", 0), v.splat(w.load("%t", 0)))
    for i, value in enumerate((*motion.moved, *motion.turned)):
        v.store(value, "%out", i)
    names = ", ".join(f"ptr noalias %{name}" for name in ("y", "m", "t", "out"))
    return compiled_function(w, "flow", names, (ctypes.c_void_p,) * 4)


def increments(x, v, mu, t):
    """x, v: shape (axes,) or (axes, lanes)."""
    y = np.array([*x, *v], dtype=float)
    lanes = 1 if y.ndim == 1 else y.shape[1]
    out, mus, time = np.empty_like(y), np.full(lanes, mu, dtype=float), np.array([t], dtype=float)
    compiled(lanes, len(y) // 2).call(*(a.ctypes.data for a in (y, mus, time, out)))
    return out


def stumpff(k, z):
    if abs(z) < 1e-3:
        return sum((-z) ** j / mpmath.factorial(2 * j + k) for j in range(20))
    s = mpmath.sqrt(abs(z))
    cosine, sine = (mpmath.cos(s), mpmath.sin(s) / s) if z > 0 else (mpmath.cosh(s), mpmath.sinh(s) / s)
    return (cosine, sine, (1 - cosine) / z, (1 - sine) / z)[k]


def true_increments(x, v, mu, t):
    with mpmath.workdps(60):
        x, v = ([mpmath.mpf(c) for c in part] for part in (x, v))
        mu, t = mpmath.mpf(mu), mpmath.mpf(t)
        r0 = mpmath.sqrt(sum(c * c for c in x))
        eta = sum(a * b for a, b in zip(x, v, strict=True))
        beta = 2 * mu / r0 - sum(c * c for c in v)

        def g(k, s):
            return s**k * stumpff(k, beta * s * s)

        def equation(s):
            return r0 * s + eta * g(2, s) + (mu - beta * r0) * g(3, s) - t

        def radius(s):
            return r0 + eta * g(1, s) + (mu - beta * r0) * g(2, s)

        far = mpmath.mpf(1 if t > 0 else -1)
        while equation(far) * far < 0:
            far *= 2
        low, high = sorted((mpmath.mpf(0), far))
        for _ in range(40):
            middle = (low + high) / 2
            low, high = (middle, high) if equation(middle) < 0 else (low, middle)
        for _ in range(8):
            low -= equation(low) / radius(low)
        r = radius(low)
        f, h = -mu * g(2, low) / r0, t - mu * g(3, low)
        f_rate, h_rate = -mu * g(1, low) / (r0 * r), -mu * g(2, low) / r
        moved = [f * a + h * b for a, b in zip(x, v, strict=True)]
        return [*moved, *(f_rate * a + h_rate * b for a, b in zip(x, v, strict=True))]


def state(eccentricity, anomaly, mu=1.0):
    """On the conic with pericentre distance 1."""
    e = eccentricity
    r, h = (1 + e) / (1 + e * math.cos(anomaly)), math.sqrt(mu * (1 + e))
    place = [r * math.cos(anomaly), r * math.sin(anomaly)]
    return place, [-mu / h * math.sin(anomaly), mu / h * (e + math.cos(anomaly))]


ECCENTRICITIES = [0, 0.05, 0.5, 0.9, 0.99, 0.999999, 1 - 1e-12, 1, 1 + 1e-12, 1.000001, 1.5, 3, 30]


@pytest.mark.parametrize("e", ECCENTRICITIES)
def test_conics_of_all_eccentricities_and_steps_of_all_sizes(e):
    widest = 3.0 if e < 1 else 0.9 * math.acos(-1 / e)
    for anomaly in (-widest, 0.0, 1.2):
        x, v = state(e, anomaly, mu=2.5)
        for t in (1e-7, 0.3, -11.0, 70.0):
            found, true = increments(x, v, 2.5, t), true_increments(x, v, 2.5, t)
            moved = true_increments([x[0] * (1 + 1e-15), x[1]], [v[0], v[1] * (1 - 1e-15)], 2.5, t)
            error = max(abs(float(a - b)) for a, b in zip(found, true, strict=True))
            sensitivity = max(abs(float(a - b)) for a, b in zip(moved, true, strict=True))
            turns = abs(t) * max(0.0, 1 - e) ** 1.5
            size = max(abs(float(a)) for a in true)
            assert error < (10 + 10 * turns) * (2e-16 * size + sensitivity)


def wide_increments(x, v, mu, t, number):
    """Of one body in other numbers, as numbers of 60 digits."""
    y, m, time = (number.packed(np.array(a), np.zeros(len(a))) for a in ([*x, *v], [mu], [t]))
    out = np.zeros_like(y)
    compiled(1, len(x), number).call(*(a.ctypes.data for a in (y, m, time, out)))
    high, low = (part.ravel().tolist() for part in number.unpacked(out))
    with mpmath.workdps(60):
        return [mpmath.mpf(a) + mpmath.mpf(b) for a, b in zip(high, low, strict=True)]


@pytest.mark.parametrize(
    "number", [SINGLE, EXTENDED, DOUBLE_DOUBLE], ids=["single", "extended", "double-double"]
)
@pytest.mark.parametrize("e", [0, 0.5, 0.9999, 1, 1.5])
def test_other_numbers_reach_their_own_round_off(e, number):
    unit = mpmath.mpf(2) ** -number.mantissa
    for anomaly in (0.0, -2.0 if e < 1 else -0.9 * math.acos(-1 / e)):
        x, v = (np.float32(part).astype(float).tolist() for part in state(e, anomaly, mu=2.5))
        for t in (2.0**-20, -11.0, 70.0):
            found, true = wide_increments(x, v, 2.5, t, number), true_increments(x, v, 2.5, t)
            with mpmath.workdps(60):
                shifted = [mpmath.mpf(x[0]) * (1 + 8 * unit), x[1]], [v[0], mpmath.mpf(v[1]) * (1 - 8 * unit)]
                moved = true_increments(*shifted, 2.5, t)
                error = max(abs(a - b) for a, b in zip(found, true, strict=True))
                sensitivity = max(abs(a - b) for a, b in zip(moved, true, strict=True))
                turns = abs(t) * max(0.0, 1 - e) ** 1.5
                assert error < (10 + 10 * turns) * (unit * max(abs(a) for a in true) + sensitivity)


def test_many_periods_in_one_step_return():
    x, v = state(0.3, 1.0)
    period = 2 * math.pi * (1 / 0.7) ** 1.5
    assert abs(increments(x, v, 1.0, 1000 * period)).max() < 1e-11


def test_a_radial_fall_and_a_start_at_rest():
    for x, v, t in (
        ([1.0, 0.0], [0.0, 0.0], 1.0),
        ([2.0, 0.0], [1.0, 0.0], 50.0),
        ([0.5, 0.0], [-0.1, 0.0], 0.2),
    ):
        found, true = increments(x, v, 1.0, t), true_increments(x, v, 1.0, t)
        assert max(abs(float(a - b)) for a, b in zip(found, true, strict=True)) < 1e-12


def test_no_time_moves_nothing():
    assert not increments(*state(0.6, 0.4), 1.0, 0.0).any()


@pytest.mark.parametrize("lanes", [2, 8])
def test_lanes_give_the_bits_of_scalars(lanes):
    rng = np.random.default_rng(7)
    y = rng.normal(size=(4, lanes))
    together = increments(y[:2], y[2:], 1.3, 0.7)
    for lane in range(lanes):
        alone = increments(y[:2, lane], y[2:, lane], 1.3, 0.7)
        np.testing.assert_array_equal(together[:, lane], alone)


def test_there_and_back():
    rng = np.random.default_rng(8)
    for _ in range(50):
        y = rng.normal(size=6)
        there = y + increments(y[:3], y[3:], 1.0, 0.9)
        back = there + increments(there[:3], there[3:], 1.0, -0.9)
        r = min(np.linalg.norm(y[:3]), np.linalg.norm(there[:3]))
        assert abs(back - y).max() < 1e-13 * (1 + 1 / r**3)


def test_a_state_that_is_not_finite_gives_nan_and_no_endless_loop():
    assert np.isnan(increments([math.nan, 0.0], [0.0, 1.0], 1.0, 0.1)).any()
    assert np.isnan(increments([0.0, 0.0], [0.0, 1.0], 1.0, 0.1)).any()
