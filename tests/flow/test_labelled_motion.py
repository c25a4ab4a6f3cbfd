"""Motions as xarray datasets and pandas frames."""

import numpy as np
import pytest
import sympy as sp

from canon import Lagrangian, coordinates, propagate
from canon.scene import find

xarray = pytest.importorskip("xarray")
pandas = pytest.importorskip("pandas")

X = coordinates("x")


def test_a_motion_keeps_its_names():
    damped = Lagrangian(X.dot**2 / 2 - X**2 / 2, [X], forces=[-X.dot / 10])
    motion = propagate(damped, (0, 5), [1, 0], samples=10, observables={"square": X**2})
    data = motion.to_xarray()
    assert list(data) == ["x", "x_dot", "energy", "square"]
    assert np.array_equal(data["x"].sel(t=5.0), motion["x"][-1])
    assert np.array_equal(data["square"], data["x"] ** 2)
    frame = motion.to_pandas()
    assert list(frame.columns) == list(data)
    assert np.array_equal(frame.index, motion.t)
    assert np.array_equal(frame["energy"], motion.energy)


def test_many_orbits_have_an_axis():
    star = find("henon-heiles")
    starts = np.array(star.state())[:, None] * np.linspace(0.9, 1, 3)
    motion = propagate(star.hamiltonian, (0, 5), starts, method="verlet", step=0.1, samples=10)
    data = motion.to_xarray()
    assert dict(data.sizes) == {"t": len(motion.t), "orbit": 3}
    assert np.array_equal(data["y"], motion.y[1])
    assert len(motion.to_pandas()) == 3 * len(motion.t)


def test_a_column_of_sympy_is_one_start():
    body = Lagrangian(X.dot**2 / 2 - X**2 / 2, [X])
    column = propagate(body, (0, 5), sp.Matrix([1, sp.Rational(1, 2)]), samples=10)
    assert np.array_equal(column.y, propagate(body, (0, 5), [1, 0.5], samples=10).y)
    several = propagate(body, (0, 5), sp.Matrix([[1, 2], [0, 0]]), samples=10)
    assert several.y.shape == (2, 11, 2)
