"""Elementary functions in double-double against 50 digits; the same bits in lanes."""

import ctypes
import dataclasses

import mpmath
import numpy as np
import pytest

from canon.kernel.llvm.double_double_functions import PAIR_FUNCTIONS
from canon.kernel.llvm.loop import compiled_function
from canon.kernel.llvm.number_types import DOUBLE_DOUBLE
from canon.kernel.llvm.writer import Writer

POINTER = (ctypes.c_void_p,) * 3
COUNT = 256
DRAW = np.random.default_rng(5)
NEAR_ZERO = 10.0 ** DRAW.uniform(-12, 0, COUNT // 2) * DRAW.choice([-1, 1], COUNT // 2)


def around_zero(spread):
    return np.concatenate([DRAW.uniform(-spread, spread, COUNT // 2), NEAR_ZERO])


ARGUMENTS = {
    "sin": around_zero(1000),
    "cos": around_zero(1000),
    "tan": around_zero(1.4),
    "exp": around_zero(200),
    "log": 10.0 ** DRAW.uniform(-30, 30, COUNT),
    "pow": DRAW.uniform(0.05, 20, COUNT),
    "atan": around_zero(10),
    "atan2": around_zero(10),
    "asin": np.clip(around_zero(1), -0.999, 0.999),
    "acos": np.clip(around_zero(1), -0.999, 0.999),
    "sinh": around_zero(10),
    "cosh": around_zero(10),
    "tanh": around_zero(10),
    "Abs": around_zero(10),
    "sign": around_zero(10),
}
LOW = 0.37 * 2.0**-54
"""What the arguments are beyond doubles, of their size."""


def evaluated(name, high, second, lanes):
    number = dataclasses.replace(DOUBLE_DOUBLE, lanes=lanes)
    w = Writer(number)
    with w.loop(0, len(high) // lanes) as i:
        operands = [w.load("%x", i)] + ([w.load("%z", i)] if name in ("pow", "atan2") else [])
        w.store(w.operation(name, operands), "%out", i)
    code = compiled_function(w, "evaluate", "ptr %x, ptr %z, ptr %out", POINTER)
    x, z = number.packed(high, high * LOW), number.packed(second, second * LOW)
    out = np.zeros_like(x)
    code.call(x.ctypes.data, z.ctypes.data, out.ctypes.data)
    return [part.ravel() for part in number.unpacked(out)]


@pytest.mark.parametrize("name", PAIR_FUNCTIONS)
def test_functions_are_right_to_31_digits_and_lanes_give_the_same_bits(name):
    high, second = ARGUMENTS[name], DRAW.uniform(-3, 3, COUNT)
    found = evaluated(name, high, second, 1)
    for part, in_lanes in zip(found, evaluated(name, high, second, 8), strict=True):
        np.testing.assert_array_equal(part, in_lanes)
    known = {"pow": mpmath.power, "Abs": abs}.get(name) or getattr(mpmath, name)
    with mpmath.workdps(60):
        for a, b, x, z in zip(*(v.tolist() for v in (*found, high, second)), strict=True):
            arguments = [mpmath.mpf(v) + mpmath.mpf(v * LOW) for v in (x, z)]
            true = known(*arguments[: 2 if name in ("pow", "atan2") else 1])
            error = abs(mpmath.mpf(a) + mpmath.mpf(b) - true)
            assert error < 1.5e-31 * max(1, abs(true)), (name, x)
            assert abs(b) <= 2.0**-53 * abs(a) * 1.01


@pytest.mark.parametrize(
    ("name", "x", "expected"),
    [
        ("sin", 0.0, 0.0), ("cos", 0.0, 1.0), ("exp", 0.0, 1.0), ("exp", 800.0, np.inf), ("exp", -2000.0, 0.0),
        ("log", -1.0, np.nan), ("sin", 1e20, np.nan), ("sin", np.nan, np.nan), ("exp", np.nan, np.nan),
        ("sin", np.inf, np.nan), ("asin", 1.5, np.nan), ("sign", 0.0, 0.0), ("sign", -2.0, -1.0),
        ("sinh", 0.0, 0.0), ("atan", 0.0, 0.0),
    ],
)  # fmt: skip
def test_places_of_their_own(name, x, expected):
    high = evaluated(name, np.array([x]), np.array([1.0]), 1)[0][0]
    if expected == np.inf:
        assert not np.isfinite(high)
    else:
        np.testing.assert_array_equal(high, expected)


def test_angles_have_sines_as_long_as_they_keep_their_place_in_the_period():
    inside, outside = (evaluated("sin", np.array([x * 2.0**45]), np.ones(1), 1) for x in (0.9, 1.1))
    x = 0.9 * 2.0**45
    with mpmath.workdps(60):
        true = mpmath.sin(mpmath.mpf(x) + mpmath.mpf(x * LOW))
        assert abs(sum(mpmath.mpf(part.item()) for part in inside) - true) < 1e-16
    assert np.isnan(outside[0])
