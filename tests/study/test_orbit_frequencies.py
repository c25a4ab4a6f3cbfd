"""Frequencies of tori against those of integrated orbits, and tori that are not those of the orbit."""

from dataclasses import replace

import pytest
import sympy as sp

from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.integrable.actions import action_variables
from canon.mechanics.integrable.complete_integral import hamilton_jacobi
from canon.study import orbit_frequencies

q, p, x, y, px, py = sp.symbols("q p x y p_x p_y", real=True)
r, theta, m, k = sp.symbols("r theta m k", positive=True)
phi, psi, p_r, p_theta, p_phi, p_psi = sp.symbols("phi psi p_r p_theta p_phi p_psi", real=True)
PENDULUM = Hamiltonian(p**2 / 2 - sp.cos(q), q, p)
KEPLER = Hamiltonian(
    (p_r**2 + p_theta**2 / r**2 + p_phi**2 / (r * sp.sin(theta)) ** 2) / (2 * m) - k / r,
    [r, theta, phi],
    [p_r, p_theta, p_phi],
)
TOP = Hamiltonian(
    p_theta**2 / 2
    + (p_phi - p_psi * sp.cos(theta)) ** 2 / (2 * sp.sin(theta) ** 2)
    + p_psi**2 / 3
    + sp.cos(theta),
    [theta, phi, psi],
    [p_theta, p_phi, p_psi],
)
SPHERE = Hamiltonian(
    (p_theta**2 + p_phi**2 / sp.sin(theta) ** 2) / 2 + sp.cos(theta), [theta, phi], [p_theta, p_phi]
)
LIOUVILLE = Hamiltonian(
    (px**2 + py**2) / (2 * (sp.cos(x) ** 2 + 2 * sp.sinh(y) ** 2 + 1))
    + (sp.cos(x) ** 2 + sp.sinh(y) ** 4) / (sp.cos(x) ** 2 + 2 * sp.sinh(y) ** 2 + 1),
    [x, y],
    [px, py],
)
TWO_CENTRES = Hamiltonian(
    (px**2 + py**2) / 2 - 1 / sp.sqrt((x - 1) ** 2 + y**2) - 1 / (2 * sp.sqrt((x + 1) ** 2 + y**2)),
    [x, y],
    [px, py],
)
CASES = {
    "pendulum, libration": (PENDULUM, {q: 0.25, p: 1.0}, {}),
    "pendulum, rotation": (PENDULUM, {q: 0.25, p: -2.5}, {}),
    "Kepler": (
        KEPLER,
        {r: 1.0, theta: 1.25, phi: 0.5, p_r: 0.25, p_theta: 0.5, p_phi: 0.625},
        {m: 1, k: 1},
    ),
    "Lagrange's top": (TOP, {theta: 1.0, phi: 0.0, psi: 0.0, p_theta: 0.25, p_phi: 2.0, p_psi: 3.0}, {}),
    "spherical pendulum": (SPHERE, {theta: 2.0, phi: 0.0, p_theta: 0.5, p_phi: 0.5}, {}),
    "Liouville": (LIOUVILLE, {x: 0.25, y: 0.5, px: 0.5, py: 0.75}, {}),
    "Morse": (Hamiltonian(p**2 / (2 * m) + 3 * (1 - sp.exp(-q / 2)) ** 2, q, p), {q: 0.25, p: 1.5}, {m: 2}),
    "Pöschl–Teller": (Hamiltonian(p**2 / 2 - 2 / sp.cosh(q) ** 2, q, p), {q: 0.25, p: 1.0}, {}),
    "quartic": (Hamiltonian(p**2 / 2 + q**4, q, p), {q: 0.25, p: 1.5}, {}),
    "cubic wall": (Hamiltonian(p**2 / 2 + sp.Abs(q) ** 3, q, p), {q: 0.25, p: 1.5}, {}),
    "double well, within one": (Hamiltonian(p**2 / 2 - q**2 + q**4, q, p), {q: 0.75, p: 0.25}, {}),
    "double well, over both": (Hamiltonian(p**2 / 2 - q**2 + q**4, q, p), {q: 0.75, p: 1.25}, {}),
    "central cube": (
        Hamiltonian(p_r**2 / 2 + p_phi**2 / (2 * r**2) + r**3, [r, phi], [p_r, p_phi]),
        {r: 1.0, phi: 0.0, p_r: 0.5, p_phi: 1.0},
        {},
    ),
    "isochrone": (
        Hamiltonian(p_r**2 / 2 + p_phi**2 / (2 * r**2) - k / (1 + sp.sqrt(1 + r**2)), [r, phi], [p_r, p_phi]),
        {r: 1.0, phi: 0.0, p_r: 0.25, p_phi: 0.5},
        {k: 1},
    ),
}


QUICK = ("pendulum, libration", "pendulum, rotation", "spherical pendulum")
PERIODS = {"Liouville": 50}


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in CASES]
)
def test_orbits_have_the_frequencies_of_their_tori(name):
    H, start, values = CASES[name]
    torus = action_variables(hamilton_jacobi(H), start, values, digits=17)
    seen = orbit_frequencies(torus, PERIODS.get(name, 200))
    assert seen.difference < 1e-12


@pytest.mark.slow
def test_motion_about_two_centres():
    integral = hamilton_jacobi(TWO_CENTRES, "elliptic", focal=sp.S.One)
    (u, v), (pu, pv) = integral.H.q, integral.H.p
    torus = action_variables(integral, {u: 1.0, v: 1.0, pu: 0.125, pv: 2.1875}, digits=17)
    assert orbit_frequencies(torus, 50).difference < 1e-12


def test_another_torus_or_a_wrong_hamiltonian_is_seen():
    integral = hamilton_jacobi(PENDULUM)
    torus = action_variables(integral, {q: 0.25, p: 1.0}, digits=17)
    neighbour = action_variables(integral, {q: 0.25, p: 1.0000001}, digits=17)
    assert orbit_frequencies(replace(neighbour, values=torus.values)).difference > 1e-9
    heavier = replace(integral, H=Hamiltonian(p**2 / 2 - sp.Rational(1001, 1000) * sp.cos(q), q, p))
    assert orbit_frequencies(replace(torus, integral=heavier)).difference > 1e-6


def test_a_time_too_short_is_told():
    torus = action_variables(hamilton_jacobi(PENDULUM), {q: 0.25, p: 1.0}, digits=17)
    with pytest.raises(ValueError, match="more than"):
        orbit_frequencies(torus, 0.01)


@pytest.mark.slow
@pytest.mark.parametrize(
    "start", [[0.318, -0.123, 0.393, -0.109], [0.331, 0.461, -0.236, -0.056], [0.625, -0.351, -0.018, 0.577]]
)
def test_a_satellite_that_nearly_meets_its_centre_has_113_bits(start):
    """Doubles are off by a hundredth after 200 periods, on other tori; the actions are right."""
    integral = hamilton_jacobi(TWO_CENTRES, "elliptic", focal=sp.S.One)
    seen = orbit_frequencies(action_variables(integral, start, digits=17), 30)
    assert seen.energy_error < 1e-12
    assert seen.difference < 1e-12


@pytest.mark.slow
def test_progress_is_told_up_to_the_end():
    integral = hamilton_jacobi(PENDULUM)
    told: list[float] = []
    orbit_frequencies(action_variables(integral, {q: 0, p: 1}, digits=17), 1, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1


def test_an_orbit_that_more_digits_do_not_keep_either_is_read_and_says_so(monkeypatch):
    torus = action_variables(hamilton_jacobi(PENDULUM), {q: 0, p: 1}, digits=17)
    monkeypatch.setattr("canon.study.energy_drift.orbit_frequencies.KEPT", 0.0)
    asked = orbit_frequencies(torus, 20.0)
    assert asked.difference < 1e-12
    assert 0.0 < asked.energy_error < 1e-25
