"""Parameters that differ from orbit to orbit stand in the state, and are no measure of it."""

import numpy as np
import pytest
from sympy import sqrt

from canon import Event, Hamiltonian, Lagrangian, coordinates, parameters, propagate

x, y = coordinates("x y")
mu, w, c = parameters("mu w c", positive=True)
SATELLITE = Hamiltonian(
    (x.momentum**2 + y.momentum**2) / 2 - mu / sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
)
EARTH, START = 3.986004418e14, [7e6, 0, 0, 7.6e3]


def test_a_satellite_in_si_units_is_as_exact_in_an_ensemble():
    alone = propagate(SATELLITE, (0, 86400), START, parameters={mu: EARTH}, samples=4)
    many = propagate(SATELLITE, (0, 86400), START, parameters={mu: [EARTH, EARTH / 2]}, samples=4)
    assert np.abs(many.y[:2, :, 0] - alone.y[:2]).max() < 1e-5
    assert abs(many.energy_error).max() < 1e-13
    assert many.y.shape == (4, 5, 2)


@pytest.mark.parametrize("size", [1e-13, 1.0, 1e13])
def test_small_and_large_motions_with_frequencies_of_their_own(size):
    oscillator = Hamiltonian((x.momentum**2 + w**2 * x**2) / 2, [x], [x.momentum])
    both = propagate(oscillator, (0, 100), [size, 0], parameters={w: [1.0, 2.0]}, samples=10)
    expected = size * np.cos(np.outer(both.t, [1, 2]))
    assert both["x"] == pytest.approx(expected, abs=1e-12 * size)
    half = propagate(oscillator, (0, 50), [size, 0], parameters={w: [1.0, 2.0]}, samples=5)
    assert half.resume(100).final == pytest.approx(both.final, rel=1e-11, abs=1e-12 * size)


def test_events_and_lagrangians_with_parameters_by_orbit():
    damped = Lagrangian(x.dot**2 / 2 - mu * x**2 / 2, [x], forces=[-c * x.dot])
    values = {mu: [1e10, 4e10], c: [1e-9, 1e-9]}
    motion = propagate(
        damped, (0, 1e-4), [1e-8, 0], parameters=values, events=[Event(x - 1e-20 * mu)], samples=3
    )
    assert motion["x"][-1] == pytest.approx(1e-8 * np.cos([10, 20]), abs=1e-20)
    first = [met[0].t for met in motion.events]
    assert first == pytest.approx([np.arccos(1e-2) / 1e5, np.arccos(4e-2) / 2e5], rel=1e-12)
