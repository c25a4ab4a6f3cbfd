"""Resonances of normal forms against sections: the eight orbits of Hénon and Heiles, their stability, their islands."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from canon.flow.chaos.periodic_orbit import periodic_orbit
from canon.flow.chaos.poincare_section import poincare_section
from canon.flow.method.adaptive_methods import Taylor
from canon.flow.propagation import propagate
from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.birkhoff import birkhoff_normal_form
from canon.mechanics.perturbation.gustavson import formal_integral
from canon.mechanics.perturbation.near_identity import near_identity_map
from canon.mechanics.perturbation.resonant.resonant_orbits import NotIsolatedError, resonant_orbits

x, y, px, py = sp.symbols("x y p_x p_y", real=True)
w = sp.Symbol("w", positive=True)
KINETIC = (px**2 + py**2) / 2
HENON_HEILES = Hamiltonian(KINETIC + (x**2 + y**2) / 2 + x**2 * y - y**3 / 3, [x, y], [px, py])
ONE_TO_TWO = Hamiltonian(KINETIC + x**2 / 2 + 2 * y**2 + x**2 * y, [x, y], [px, py])


def test_eight_orbits_of_henon_and_heiles():
    """Π₁ … Π₈ of Churchill, Pecelli and Rod; the first six are told apart by the sixth degree alone."""
    form = birkhoff_normal_form(HENON_HEILES, 6)
    found = resonant_orbits(form, 0.01)
    assert [orbit.is_stable for orbit in found] == [True, True, False, False, False, True, True, True]
    levels = [orbit.level for orbit in found]
    assert np.ptp(levels[:2]) < 1e-12
    assert np.ptp(levels[2:5]) < 1e-12
    assert np.ptp(levels[5:]) < 1e-12
    assert abs(levels[3] - levels[6]) > 1e-7
    twin = replace(form, parts={**form.parts, 6: -form.parts[6]})
    assert straight(found).is_stable
    assert not straight(resonant_orbits(twin, 0.01)).is_stable
    with pytest.raises(NotIsolatedError, match="take a normal form of a higher order"):
        resonant_orbits(replace(form, order=4, parts={d: f for d, f in form.parts.items() if d <= 4}), 0.01)


def straight(orbits):
    """The orbit in which x stays 0."""
    return next(orbit for orbit in orbits if abs(orbit.state[0]) + abs(orbit.state[2]) < 1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("H", "energies"), [(HENON_HEILES, (0.01, 0.02)), (ONE_TO_TWO, (0.005, 0.01))])
def test_predicted_orbits_are_near_those_that_newtons_method_finds(H, energies):
    form = birkhoff_normal_form(H, 8)
    gaps = []
    for energy in energies:
        worst = 0.0
        for predicted in resonant_orbits(form, energy)[:5]:
            met = periodic_orbit(H, list(predicted.state), predicted.period)
            worst = max(worst, abs(met.period - predicted.period))
            stretched = abs(np.exp(predicted.exponent * predicted.period))
            assert abs(max(abs(met.multipliers.values)) - max(stretched, 1 / stretched)) < 2e-3
            assert predicted.is_stable == (max(abs(met.multipliers.values)) < 1 + 1e-6)
        gaps.append(worst)
    assert gaps[0] < 2e-5
    assert gaps[0] < gaps[1]


@pytest.mark.slow
@pytest.mark.parametrize(("energy", "accuracy"), [(0.01, 2e-5), (0.02, 5e-5)])
def test_islands_of_the_section_end_where_the_integral_has_the_level_of_unstable_orbits(energy, accuracy):
    """Orbits on both sides of the predicted border, in the section x = 0: one turns in one sense only, one does not."""
    form = birkhoff_normal_form(HENON_HEILES, 10)
    predicted = resonant_orbits(form, energy)
    loops = [list(orbit.state) for orbit in predicted[:2]]
    centres = [poincare_section(HENON_HEILES, (0, 8), loop, "x", method=Taylor()) for loop in loops]
    centre = next(at for at in centres if at["y"][0] < 0)
    assert abs(centre["p_y"][0]) < 1e-6
    at = float(centre["y"][0])
    integral = formal_integral(form, predicted[0].weights).expression
    level = predicted[3].level

    def start(p):
        return [0.0, at, float(np.sqrt(2 * energy - at**2 + 2 * at**3 / 3 - p**2)), p]

    def excess(p):
        return float(integral.xreplace(dict(zip((x, y, px, py), start(p), strict=True)))) - level

    low, high = 0.0, float(np.sqrt(2 * energy - at**2 + 2 * at**3 / 3)) * 0.999
    assert excess(low) < 0 < excess(high)
    while high - low > 1e-9:
        middle = (low + high) / 2
        low, high = (middle, high) if excess(middle) < 0 else (low, middle)
    assert turns_in_one_sense(start(low - accuracy))
    assert not turns_in_one_sense(start(low + accuracy))


def turns_in_one_sense(start):
    images = near_identity_map(birkhoff_normal_form(HENON_HEILES, 8), to_new=True).transformation.images
    momentum = sp.Poly(images[0] * images[3] - images[1] * images[2], x, y, px, py)
    kept = sp.Add(
        *(c * x**i * y**j * px**k * py**l for (i, j, k, l), c in momentum.terms() if i + j + k + l <= 8)
    )
    run = propagate(HENON_HEILES, (0, 8000), start, method=Taylor(), times=np.linspace(0, 8000, 16001))
    values = np.asarray(run[kept]).ravel()
    return values.min() * values.max() > 0


@pytest.mark.parametrize(
    ("H", "order", "energy", "said"),
    [
        (Hamiltonian(KINETIC + x**2 / 2 + y**2 + x**2 * y, [x, y], [px, py]), 4, 0.01, "no resonant terms"),
        (HENON_HEILES, 6, -0.01, "no motion of the energy"),
        (
            Hamiltonian((px**2 - py**2 + x**2 - y**2) / 2 + x**2 * y, [x, y], [px, py]),
            4,
            0.01,
            "not definite",
        ),
    ],
)
def test_what_has_no_resonant_orbits_is_refused(H, order, energy, said):
    with pytest.raises(ValueError, match=said):
        resonant_orbits(birkhoff_normal_form(H, order), energy)


@pytest.mark.parametrize(
    ("H", "resonances", "said"),
    [
        (Hamiltonian(KINETIC - x**2 / 2 + y**2 + x**2 * y, [x, y], [px, py]), None, "of two elliptic pairs"),
        (Hamiltonian(px**2 / 2 + x**2 / 2 + x**3, x, px), None, "of two elliptic pairs"),
        (
            Hamiltonian(KINETIC + w**2 * (x**2 / 2 + 2 * y**2) + x**2 * y, [x, y], [px, py]),
            None,
            "put numbers for the parameters into H before the normal form",
        ),
        (ONE_TO_TWO, [(1, 0), (0, 1)], "several resonances, and no integral beside itself"),
    ],
)
def test_a_normal_form_without_one_resonance_of_two_frequencies_is_refused(H, resonances, said):
    form = birkhoff_normal_form(H, 4, resonances=resonances)
    with pytest.raises(ValueError, match=said):
        resonant_orbits(form, 0.01)
