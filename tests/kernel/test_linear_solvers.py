"""Linear equations inside compiled loops, full and of bands, beside NumPy's."""

import ctypes
import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from canon.kernel.llvm.loop import compiled_function
from canon.kernel.llvm.number_types import DOUBLE
from canon.kernel.llvm.solvers.band_solver import BandSolver, band_order, is_narrow
from canon.kernel.llvm.solvers.linear_solver import LinearSolver
from canon.kernel.llvm.writer import Writer

SIZES = [(1, 0), (5, 0), (7, 1), (12, 3), (40, 4), (6, 5)]


@functools.cache
def compiled(size, reach):
    """Return the solver of a full matrix, reach None, or of a band, and its machine code."""
    w = Writer(DOUBLE)
    where = (w, size, "%a", "%p")
    solver = LinearSolver(*where) if reach is None else BandSolver(*where, reach)
    solver.factorise()
    solver.solve("%x")
    return solver, compiled_function(w, "solve", "ptr %a, ptr %p, ptr %x", (ctypes.c_void_p,) * 3)


def solved(matrix, right, reach=None):
    """Return the solution of a compiled factorisation."""
    size = len(matrix)
    solver, code = compiled(size, reach)
    entries = np.zeros(solver.length)
    for i, j in zip(*np.nonzero(matrix), strict=True):
        entries[i * size + j if reach is None else i * solver.row_length + reach + j - i] = matrix[i, j]
    x = np.full(solver.right_length, np.nan)
    x[:size] = right
    pivots = np.zeros(size, dtype=np.int64)
    code.call(*(array.ctypes.data for array in (entries, pivots, x)))
    return x[:size]


def drawn(seed, size, reach):
    """Return a band matrix with zeros on its diagonal, so that rows must be exchanged, and a right side."""
    rng = np.random.default_rng(seed)
    matrix = rng.standard_normal((size, size))
    matrix *= abs(np.subtract.outer(np.arange(size), np.arange(size))) <= reach
    if reach:
        np.fill_diagonal(matrix, np.where(rng.random(size) < 0.5, 0.0, matrix.diagonal()))
    return matrix, rng.standard_normal(size)


@pytest.mark.parametrize(("size", "reach"), SIZES)
@settings(max_examples=50)
@given(seed=st.integers(0, 10**6))
def test_solutions_are_those_of_numpy(size, reach, seed):
    matrix, right = drawn(seed, size, reach)
    if np.linalg.cond(matrix) > 1e8:
        return
    expected = np.linalg.solve(matrix, right)
    bound = 1e-13 * np.linalg.cond(matrix) * abs(expected).max()
    assert abs(solved(matrix, right, reach) - expected).max() < bound
    assert abs(solved(matrix, right) - expected).max() < bound


def test_a_singular_matrix_has_no_finite_solution():
    matrix = np.array([[1.0, 2.0, 0.0], [2.0, 4.0, 0.0], [0.0, 1.0, 1.0]])
    for reach in (None, 1):
        assert not np.isfinite(solved(matrix, np.ones(3), reach)).all()


def test_neighbours_stand_beside_each_other():
    """A chain whose sites are numbered at random, positions and momenta apart: its band is narrow again."""
    sites = 50
    rng = np.random.default_rng(3)
    at = rng.permutation(sites)
    places = [(at[i], sites + at[i]) for i in range(sites)]
    places += [(sites + at[i], at[j]) for i in range(sites) for j in (i - 1, i, i + 1) if 0 <= j < sites]
    order, reach = band_order(places, 2 * sites)
    assert sorted(order) == list(range(2 * sites))
    assert reach == max(abs(order[i] - order[j]) for i, j in places) <= 4
    assert is_narrow(6 * sites, 3 * (reach + 1) - 1)


def test_where_all_act_on_all_a_band_does_not_pay():
    order, reach = band_order([(i, j) for i in range(8) for j in range(8)], 8)
    assert (sorted(order), reach) == (list(range(8)), 7)
    assert not is_narrow(8, 7)
    assert band_order([], 3)[1] == 0
