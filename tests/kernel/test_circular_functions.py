"""Sine and cosine written inline: beside many digits, in lanes, of one angle whatever its size."""

import ctypes

import mpmath
import numpy as np
import pytest

from canon.kernel.llvm.circular_functions import sine_and_cosine
from canon.kernel.llvm.loop import compiled_function
from canon.kernel.llvm.number_types import DOUBLE, SINGLE
from canon.kernel.llvm.writer import Writer


def sines_and_cosines(number, angles):
    w = Writer(number)
    with w.loop(0, len(angles)) as i:
        s, c = sine_and_cosine(w, w.load("%x", i))
        w.store(s, "%s", i)
        w.store(c, "%c", i)
    pointers = (ctypes.c_void_p,) * 3
    code = compiled_function(w, "both", "ptr noalias %x, ptr noalias %s, ptr noalias %c", pointers)
    x = np.array(angles, dtype=number.dtype)
    s, c = np.empty_like(x), np.empty_like(x)
    code.call(x.ctypes.data, s.ctypes.data, c.ctypes.data)
    return x, s, c


@pytest.mark.parametrize(("number", "unit"), [(DOUBLE, 2.0**-53), (SINGLE, 2.0**-24)])
def test_values(number, unit):
    rng = np.random.default_rng(1)
    near = [k * np.pi / 4 + d for k in range(-9, 10) for d in (-1e-9, 0.0, 1e-9)]
    angles = [0.0, -0.0, 1e-300 if number is DOUBLE else 1e-30, *near, *rng.uniform(-30, 30, 300)]
    x, s, c = sines_and_cosines(number, angles)
    with mpmath.workdps(40):
        for angle, sine, cosine in zip(x, s, c, strict=True):
            true = mpmath.sin(mpmath.mpf(float(angle))), mpmath.cos(mpmath.mpf(float(angle)))
            assert abs(mpmath.mpf(float(sine)) - true[0]) < 2 * unit * max(abs(true[0]), unit * 10)
            assert abs(mpmath.mpf(float(cosine)) - true[1]) < 2 * unit * max(abs(true[1]), unit * 10)


def test_both_are_of_one_angle_however_large_and_nothing_is_nothing():
    x, s, c = sines_and_cosines(DOUBLE, [1e6, 1e9, 1e12, -1e14, np.nan, np.inf])
    assert abs(s[:4] ** 2 + c[:4] ** 2 - 1).max() < 1e-15
    np.testing.assert_allclose(s[:2], np.sin(x[:2]), atol=1e-15)
    assert np.isnan(s[4:]).all()
    assert np.isnan(c[4:]).all()
