"""The derivative of Kepler's flow against differences in 60-digit arithmetic, Hill's equations, and its geometry."""

import ctypes
import functools

import mpmath
import numpy as np
import pytest

from canon.kernel.llvm.formulas import LaneFormulas
from canon.kernel.llvm.loop import compiled_function
from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.llvm.writer import Writer
from canon.kernel.solvable.kepler_derivative import KeplerDerivative
from canon.kernel.solvable.kepler_flow import kepler_flow
from tests.kernel.test_kepler import state, true_increments


@functools.cache
def compiled(lanes, axes):
    w = Writer(DOUBLE)
    v = w.side_by_side(lanes)
    x, u, dx, du = ([v.load("%y", part * axes + axis) for axis in range(axes)] for part in range(4))
    motion = kepler_flow(w, v, x, u, v.load("%m", 0), v.splat(w.load("%t", 0)))
    moved, turned = KeplerDerivative(LaneFormulas(v), x, u, motion).moved(dx, du)
    for i, value in enumerate((*moved, *turned)):
        v.store(value, "%out", i)
    names = ", ".join(f"ptr noalias %{name}" for name in ("y", "m", "t", "out"))
    return compiled_function(w, "tangent", names, (ctypes.c_void_p,) * 4)


def tangent_map(y, mu, t):
    """y: shape (2 axes, lanes); the map, shape (2 axes, 2 axes, lanes)."""
    size, lanes = y.shape
    found = np.empty((size, size, lanes))
    mus, time = np.full(lanes, mu), np.array([t])
    for k in range(size):
        whole, out = np.vstack([y, np.repeat(np.eye(size)[:, k : k + 1], lanes, axis=1)]), np.empty_like(y)
        compiled(lanes, size // 2).call(*(a.ctypes.data for a in (whole, mus, time, out)))
        found[:, k] = out
    return found


def true_map(y, mu, t):
    """Central differences with 25 digits of width in 60 digits."""
    size, small = len(y), mpmath.mpf(10) ** -20
    found = np.empty((size, size))
    with mpmath.workdps(60):
        for k in range(size):
            ends = []
            for sign in (1, -1):
                near = [mpmath.mpf(c) for c in y]
                near[k] += sign * small
                moved = true_increments(near[: size // 2], near[size // 2 :], mu, t)
                ends.append([a + b for a, b in zip(near, moved, strict=True)])
            found[:, k] = [float((a - b) / (2 * small)) for a, b in zip(*ends, strict=True)]
    return found


def check(e, anomaly, t):
    y = np.ravel(state(e, anomaly, mu=2.5))
    found, true = tangent_map(y[:, np.newaxis], 2.5, t)[:, :, 0], true_map(y, 2.5, t)
    # What rounding the state alone changes, beside the rounding of the formulas.
    near = true_map(y * (1 + 2e-16), 2.5, t)
    size = abs(true).max()
    assert abs(found - true).max() < 60 * (2.0**-53 * size + abs(near - true).max())


def test_it_is_the_limit_of_differences():
    check(0.9, 1.2, -11.0)
    check(1.5, -1.1, 0.3)


@pytest.mark.slow
@pytest.mark.parametrize("e", [0.05, 0.9, 0.999, 1, 1.5])
def test_it_is_for_conics_of_all_kinds_and_times_of_all_sizes(e):
    for anomaly, t in ((0.0, 1e-3), (1.2, 0.3), (-1.1, 70.0), (1.2, -11.0)):
        check(e, anomaly, t)
        y = np.ravel(state(e, anomaly, mu=2.5))
        found, other = tangent_map(y[:, np.newaxis], 2.5, 1.01 * t)[:, :, 0], true_map(y, 2.5, t)
        assert abs(found - other).max() > 1e-6 * abs(other).max()


def test_hill_s_equations_about_a_circle():
    # In the turning frame, solved by Clohessy and Wiltshire (1960), after a quarter of a period and after whole ones.
    y = np.array([[1.0], [0.0], [0.0], [1.0]])
    M = tangent_map(y, 1.0, np.pi / 2)[:, :, 0]
    hill = np.array(
        [
            [4.0, 0.0, 1.0, 2.0],
            [6 - 3 * np.pi, 1.0, -2.0, 4 - 3 * np.pi / 2],
            [3.0, 0.0, 0.0, 2.0],
            [-6.0, 0.0, -2.0, -3.0],
        ]
    )
    spin, none = np.array([[0.0, -1.0], [1.0, 0.0]]), np.zeros((2, 2))
    # x = R ξ, v = R (ξ' + ω × ξ), R the identity at the start and a quarter turn at the end.
    into = np.block([[np.eye(2), none], [-spin, np.eye(2)]])
    out = np.block([[spin, none], [spin @ spin, spin]])
    np.testing.assert_allclose(M, out @ hill @ into, atol=1e-14)
    # A whole number N of periods only shears along the orbit: δx = v (3πN) · (δa/a), δa/a = 2 (δr/r + v·δv).
    for turns in (1, 7, -3):
        shear = np.eye(4) - 3 * np.pi * turns * np.outer([0, 1, -1, 0], [2, 0, 0, 2])
        np.testing.assert_allclose(
            tangent_map(y, 1.0, 2 * np.pi * turns)[:, :, 0], shear, atol=2e-14 * abs(shear).max()
        )


@pytest.mark.slow
@pytest.mark.parametrize("t", [0.01, -2.0, 7.0, 40.0])
def test_it_is_symplectic_for_bodies_side_by_side(t):
    rng = np.random.default_rng(1)
    J = np.kron([[0, 1], [-1, 0]], np.eye(3))
    for _ in range(60):
        y = rng.normal(size=(6, 8))
        M = tangent_map(y, 1.0, t)
        defect = np.einsum("jik,jl,lmk->imk", M, J, M) - J[:, :, np.newaxis]
        assert (abs(defect).max(axis=(0, 1)) < 1e-13 * abs(M).max(axis=(0, 1)) ** 2).all()


def test_a_body_at_the_centre_has_no_derivative():
    assert np.isnan(tangent_map(np.array([[0.0], [0.0], [0.3], [1.0]]), 1.0, 1.0)).all()
