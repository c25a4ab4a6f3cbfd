"""Names of variables before names of what every motion has, and starts whose numbers have labels."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from canon import Hamiltonian, Lagrangian, choose, coordinates, propagate

x = coordinates("x")
OSCILLATOR = Hamiltonian(x.momentum**2 / 2 + x**2 / 2, [x], [x.momentum])


@pytest.mark.parametrize("name", ["energy", "work", "t"])
def test_a_coordinate_comes_before_what_every_motion_has(name):
    q = coordinates(name)
    motion = propagate(Lagrangian(q.dot**2 / 2, [q]), (0, 2), [5, 1])
    np.testing.assert_allclose(motion[name][[0, -1]], [5.0, 7.0])
    np.testing.assert_array_equal(motion[name], motion[q])
    np.testing.assert_allclose(motion.energy, 0.5)
    np.testing.assert_array_equal(motion.work, 0.0)
    np.testing.assert_allclose(motion.t[[0, -1]], [0.0, 2.0])


def test_a_coordinate_called_energy_is_exported_as_itself():
    q = coordinates("energy")
    frame = propagate(Lagrangian(q.dot**2 / 2, [q]), (0, 2), [5, 1]).to_pandas()
    np.testing.assert_allclose(frame["energy"].iloc[-1], 7.0)


@pytest.mark.parametrize(
    "start",
    [
        pd.Series({"p_x": 0.0, "x": 1.0}),
        pd.Series([0.0, 1.0], index=[x.momentum, x]),
        pd.Series([1.0, 0.0]),
        xr.DataArray([0.0, 1.0], coords={"of": ["p_x", "x"]}, dims="of"),
        xr.DataArray([1.0, 0.0], dims="of"),
    ],
)
@pytest.mark.parametrize("system", [OSCILLATOR, Lagrangian(x.dot**2 / 2 - x**2 / 2, [x])])
def test_labels_are_read(start, system):
    if isinstance(system, Lagrangian) and isinstance(start, pd.Series):
        start = start.rename({"p_x": "x_dot", x.momentum: x.dot})
    elif isinstance(system, Lagrangian) and "of" in start.coords:
        start = start.assign_coords(of=["x_dot", "x"])
    motion = propagate(system, (0, 1), start)
    assert motion.y.shape[0] == motion.y.ndim == 2
    np.testing.assert_array_equal(motion.y[:, 0], [1.0, 0.0])


@pytest.mark.parametrize(
    "starts",
    [
        pd.DataFrame({"p_x": [0.0, 3.0], "x": [1.0, 2.0]}),
        pd.DataFrame([[0.0, 3.0], [1.0, 2.0]], index=["p_x", "x"]),
        pd.DataFrame([[1.0, 2.0], [0.0, 3.0]]),
        xr.DataArray([[0.0, 3.0], [1.0, 2.0]], coords={"of": ["p_x", "x"]}, dims=["of", "orbit"]),
    ],
)
def test_tables_hold_an_orbit_a_row_or_a_column(starts):
    np.testing.assert_array_equal(propagate(OSCILLATOR, (0, 1), starts).y[:, 0], [[1.0, 2.0], [0.0, 3.0]])


def test_labels_that_are_neither_names_nor_an_order():
    with pytest.raises(ValueError, match="labels 1, 0, which are neither names of variables nor their order"):
        propagate(OSCILLATOR, (0, 1), pd.Series([0.0, 1.0], index=[1, 0]))
    with pytest.raises(KeyError, match="no value for p_x"):
        propagate(OSCILLATOR, (0, 1), pd.Series({"x": 1.0}))


def test_functions_take_numbers_in_order_only():
    def rates(t, y):
        return [y[1], -y[0]]

    np.testing.assert_array_equal(propagate(rates, (0, 1), pd.Series([1.0, 0.0])).y[:, 0], [1.0, 0.0])
    with pytest.raises(ValueError, match="numbers in order"):
        propagate(rates, (0, 1), pd.Series({"v": 0.0, "x": 1.0}))


def test_a_choice_reads_labels_too():
    assert choose(OSCILLATOR, 5.0, pd.Series({"p_x": 0.0, "x": 1.0}), accuracy=1e-6).question.y0.tolist() == [
        1.0,
        0.0,
    ]


@pytest.mark.parametrize("kind", ["momentum", "ddot"])
def test_a_force_in_momenta_or_accelerations_is_refused_with_what_to_write(kind):
    """With a number for it, as for a parameter, the motion would be that under a constant force."""
    (q,) = (coordinates("x"),)
    held = getattr(q, kind)
    system = Lagrangian(q.dot**2 / 2, [q], forces=[-held])
    for given in ({}, {held: 1.0}, {held.name: 1.0}):
        with pytest.raises(ValueError, match=f"the system holds {held}, which is no parameter"):
            propagate(system, (0, 1), [1, 1], parameters=given)
