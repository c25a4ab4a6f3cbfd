"""The compensated sum of an increment: exact but for the increment's own rounding."""

import ctypes
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from canon.kernel.llvm.loop import compiled_function, increase
from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.llvm.writer import Writer

U = Fraction(1, 2**53)


@pytest.fixture(scope="module")
def compensated_sum():
    """Return what maps (y, e, c, f) to the new (y, e)."""
    w = Writer(DOUBLE)
    increase(w, "%y", "%e", "0", w.load("%c", 0), w.load("%c", 1))
    code = compiled_function(w, "add", "ptr %y, ptr %e, ptr %c", (ctypes.c_void_p,) * 3)

    def call(y, e, c, f):
        arrays = np.array([y]), np.array([e]), np.array([c, f])
        code.call(*(array.ctypes.data for array in arrays))
        return float(arrays[0][0]), float(arrays[1][0])

    return call


def rounded(value):
    return Fraction(float(value))


numbers = st.floats(-4, 4).filter(lambda x: x == 0 or abs(x) > 1e-30)


@given(numbers, st.floats(-1, 1), st.sampled_from([2.0**-k for k in (0, 1, 4, 9, 30, 60)]), numbers)
def test_nothing_is_lost_but_what_the_increment_is_rounded_by(compensated_sum, y, part, c, f):
    e = part * 2.0**-53 * abs(y)
    new, carried = compensated_sum(y, e, c, f)
    d = rounded(Fraction(c) * Fraction(f) + Fraction(e))
    error = Fraction(new) + Fraction(carried) - (Fraction(y) + d)
    assert new == float(Fraction(y) + d)
    if abs(y) >= abs(d):
        assert error == 0
    else:
        assert abs(error) <= U * abs(d) * (1 + 4 * U)


def test_a_sum_of_many_small_increments_is_theirs(compensated_sum):
    y, e, plain, total = 1.0, 0.0, 1.0, Fraction(1)
    for k in range(20_000):
        f = float(np.sin(0.001 * k)) - 0.3
        y, e = compensated_sum(y, e, 1e-3, f)
        plain += 1e-3 * f
        total += Fraction(1e-3) * Fraction(f)
    assert abs(Fraction(y) + Fraction(e) - total) < 200 * U / 1000
    assert abs(Fraction(plain) - total) > 50 * U
