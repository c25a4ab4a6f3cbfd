"""DOP853 follows small states as exactly as large ones, and components that are zero or rounding don't stop it."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from sympy import cos, sin

from canon import Hamiltonian, coordinates, parameters, propagate, time

x, y, z = coordinates("x y z")
px, py, pz = x.momentum, y.momentum, z.momentum
a, m, k = parameters("a m k", positive=True)
QUARTIC = Hamiltonian(px**2 / 2 + x**2 / 2 + x**4 / (4 * a**2), [x], [px])
KEPLER = Hamiltonian((px**2 + py**2) / (2 * m) - k * m / (x**2 + y**2) ** 0.5, [x, y], [px, py])
SPACE = Hamiltonian((px**2 + py**2 + pz**2) / 2 - (x**2 + y**2 + z**2) ** -0.5, [x, y, z], [px, py, pz])


def chain(masses):
    """Return Fermi, Pasta and Ulam's chain between walls."""
    sites = coordinates(f"x1:{masses + 1}")
    springs = zip((0, *sites), (*sites, 0), strict=True)
    tension = sum((b - a) ** 2 / 2 + (b - a) ** 4 / 4 for a, b in springs)
    return Hamiltonian(sum(q.momentum**2 for q in sites) / 2 + tension, sites, [q.momentum for q in sites])


@pytest.mark.parametrize("size", [1e-9, 1e-6, 1e-3, 1, 1e9])
def test_an_amplitude_in_any_unit(size):
    exact = solve_ivp(
        lambda _, q: [q[1], -q[0] - q[0] ** 3], (0, 10), [1, 0], method="DOP853", rtol=1e-13, atol=1e-14
    ).y[:, -1]
    found = propagate(QUARTIC, (0, 10), [size, 0], parameters={a: size}, method="DOP853")
    assert abs(found.final / size - exact).max() < 1e-11
    of_one = propagate(QUARTIC, (0, 10), [1, 0], parameters={a: 1}, method="DOP853")
    assert abs(found.steps - of_one.steps) < 0.3 * of_one.steps


@pytest.mark.parametrize(
    ("radius", "mass", "pull"), [(1, 1, 1), (1e-10, 9.1e-31, 253.0), (1.5e11, 6e24, 1.3e20)]
)
def test_a_circle_in_units_of_atoms_and_of_planets(radius, mass, pull):
    speed = (pull / radius) ** 0.5
    start = [radius, 0, 0, mass * speed]
    turn = 2 * np.pi * radius / speed
    for way in (1, -1):
        found = propagate(KEPLER, (0, way * turn), start, parameters={m: mass, k: pull}, method="DOP853")
        assert abs(found.final - start)[:2].max() < 1e-10 * radius
        assert abs(found.final - start)[2:].max() < 1e-10 * mass * speed


@pytest.mark.parametrize("start", [0, np.pi / 2, np.pi])
def test_an_angle_beside_a_long_length(start):
    """The angle of a circle grows as the time, whatever the radius is measured by."""
    radius, rate = 1e7, 1e-3
    polar = Hamiltonian(px**2 / 2 + py**2 / (2 * x**2) - rate**2 * radius**3 / x, [x, y], [px, py])
    found = propagate(polar, (0, 1e4), [radius, start, 0, rate * radius**2], method="DOP853")
    assert found.final[1] == pytest.approx(start + 10, abs=1e-10)


@pytest.mark.parametrize("middle", [0, 1e-17])
@pytest.mark.parametrize("size", [1, 0.1 + 0.2])
def test_a_mass_held_by_symmetry_costs_no_steps(middle, size):
    found = propagate(chain(3), (0, 20), [size, middle, -size, 0, 0, 0], method="DOP853")
    moved = propagate(chain(3), (0, 20), [size, size / 3, -size, 0, 0, 0], method="DOP853")
    exact = solve_ivp(
        lambda _, q: [q[1], -2 * q[0] - 2 * q[0] ** 3],
        (0, 20),
        [size, 0],
        method="DOP853",
        rtol=1e-13,
        atol=1e-15,
    ).y[:, -1]
    assert found.final[[0, 3]] == pytest.approx(exact, abs=1e-9)
    assert found.steps < 2 * moved.steps


def test_masses_that_a_wave_reaches_late_cost_few_steps():
    one = [1.0] + [0.0] * 61
    assert propagate(chain(31), (0, 20), one, method="DOP853").steps < 600


def test_a_plane_in_space_is_as_the_plane():
    flat = propagate(KEPLER, (0, 20), [1, 0, 0, 1.2], parameters={m: 1, k: 1}, method="DOP853")
    within = propagate(SPACE, (0, 20), [1, 0, 0, 0, 1.2, 0], method="DOP853")
    assert within.final[[0, 1, 3, 4]] == pytest.approx(flat.final, abs=1e-10)
    assert abs(within.steps - flat.steps) < 0.3 * flat.steps
    assert (within.y[[2, 5]] == 0).all()


def test_a_resumed_motion_is_the_whole_one():
    size = 1e-9
    whole = propagate(QUARTIC, (0, 10), [size, 0], parameters={a: size}, method="DOP853")
    half = propagate(QUARTIC, (0, 5), [size, 0], parameters={a: size}, method="DOP853").resume(10)
    assert half.final == pytest.approx(whole.final, rel=1e-10)


def test_what_stands_still_stands():
    found = propagate(QUARTIC, (0, 10), [0, 0], parameters={a: 1}, method="DOP853")
    assert (found.y == 0).all()


@pytest.mark.parametrize("span", [50, 1000, 10_000])
def test_what_is_driven_from_rest_is_followed(span):
    """Where all begins at zero and at rest: x = (3 sin t − sin 3t)/8."""
    x = coordinates("x")
    driven = Hamiltonian(x.momentum**2 / 2 + x**2 / 2 - x * sin(3 * time), [x], [x.momentum])
    found = propagate(driven, (0, span), [0.0, 0.0], method="DOP853")
    assert found["x"] == pytest.approx((3 * np.sin(found.t) - np.sin(3 * found.t)) / 8, abs=1e-12 * span)


def test_a_fast_light_mass_beside_a_slow_heavy_one():
    """Units of the kind that only a part of the state is small in: never worse than the tolerance as it stands."""
    x, y = coordinates("x y")
    both = Hamiltonian(
        x.momentum**2 / 2000 + x**2 / 2000 + 500 * y.momentum**2 + 5 * y**2, [x, y], [x.momentum, y.momentum]
    )
    found = propagate(both, (0, 20), [7e6, 1e-4, 7e6, 0.0], method="DOP853")
    assert found["y"] == pytest.approx(1e-4 * np.cos(100 * found.t), abs=1e-8)


@pytest.mark.parametrize("unit", [2.0**-80, 2.0**-20, 1.0, 2.0**30])
def test_from_rest_at_the_origin_in_any_unit(unit):
    """A body under a constant force on a spring: from nothing to amplitude 1 and back, in units of the force."""
    H = Hamiltonian(px**2 / 2 + x**2 / 2 - a * x, [x], [px])
    found = propagate(H, (0, 50), [0, 0], parameters={a: unit}, method="DOP853", samples=100)
    assert abs(found["x"] / unit - (1 - np.cos(found.t))).max() < 3e-11
    moved = propagate(H, (0, 50), [2 * unit, 0], parameters={a: unit}, method="DOP853", samples=100)
    assert found.steps < 1.2 * moved.steps


def test_an_electron_from_rest_in_crossed_fields():
    """Coordinates and momenta begin at zero and have sizes of 1e-6 m and 1e-24 kg m/s soon after."""
    mass, charge, field, pull = 9.1e-31, -1.6e-19, 1.0, 1e5
    b, e = parameters("b e", real=True)
    H = Hamiltonian((px**2 + (py - e * b * x) ** 2) / (2 * m) - e * k * x, [x, y], [px, py])
    turn = charge * field / mass
    values = {m: mass, e: charge, b: field, k: pull}
    found = propagate(H, (0, 60 / abs(turn)), [0, 0, 0, 0], parameters=values, method="DOP853", samples=60)
    exact = pull / (field * turn) * (1 - np.cos(turn * found.t))
    assert abs(found["x"] - exact).max() < 1e-10 * abs(exact).max()


def test_what_rounding_leaves_of_a_force_is_no_unit():
    """Pendulums that hang after whole turns: the force is what the rounding of 2π leaves, and momenta begin at zero."""
    energy = (px**2 + py**2) / 2 - a * cos(x) - a * cos(x - y)
    found = propagate(
        Hamiltonian(energy, [x, y], [px, py]),
        (0, 50),
        [20 * np.pi, 6 * np.pi, 0, 0],
        parameters={a: 1},
        method="DOP853",
    )
    assert found.steps < 50  # it takes 2884 to follow what rounding left to all its digits
    assert abs(found.final - found.y[:, 0]).max() < 1e-11
