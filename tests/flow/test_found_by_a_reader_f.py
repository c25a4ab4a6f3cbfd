"""What a careful reader of indicators, sections and periodic orbits found, each beside what must go on working."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, Splitting, Study, Taylor, coordinates, parameters, results_of, run_study
from canon.flow import (
    HamiltonianMap,
    Regularity,
    continue_family,
    gali,
    lyapunov_spectrum,
    periodic_orbit,
    poincare_section,
)
from canon.flow.chaos.alignment_index import _verdict
from canon.scene import find

x, y, z = coordinates("x y z")
px, py, pz = (s.momentum for s in (x, y, z))
oscillator = Hamiltonian(px**2 / 2 + x**2 / 2, [x], [px])
standard = HamiltonianMap(px**2 / 2, sp.Rational(9, 10) * sp.cos(x), [x], [px])
VERLET = {"method": Splitting("verlet"), "step": 0.1}


def test_a_map_has_no_section():
    with pytest.raises(ValueError, match="a map has no states between its iterations"):
        poincare_section(standard, (0, 30), [3.0, 0.05], "p_x")


def test_points_of_a_section_are_a_whole_number():
    for wrong in (2.5, 0, float("nan"), float("inf")):
        with pytest.raises(ValueError, match="a whole number from 1 on"):
            poincare_section(oscillator, (0, 100), [1.0, 0.0], "x", points=wrong, **VERLET)
    assert len(poincare_section(oscillator, (0, 100), [1.0, 0.0], "x", points=2.0, **VERLET).t) == 2


def test_numbers_of_deviations_may_be_floats_that_are_whole():
    how = {"method": Splitting("kahan-li-8"), "step": 0.2}
    found = gali("henon-heiles", (0, 100), "regular", vectors=2.0, **how)
    assert found.name == "GALI_2"
    assert found.value == gali("henon-heiles", (0, 100), "regular", vectors=2, **how).value
    assert len(lyapunov_spectrum("henon-heiles", (0, 100), "regular", vectors=2.0, **how).exponents) == 2
    with pytest.raises(ValueError, match=r"vectors=2\.5"):
        gali("henon-heiles", (0, 100), "regular", vectors=2.5, **how)


def test_periods_are_positive():
    start = [0.01, 0.1, 0.4, 0.1]
    for wrong in (-6.5, 0.0):
        with pytest.raises(ValueError, match=r"give a guess of the time after which the orbit comes back"):
            periodic_orbit("henon-heiles", start, wrong)
    with pytest.raises(ValueError, match="half of an odd period"):
        periodic_orbit(standard, [np.pi, 0.05], 1, reversal=["p_x"])
    assert periodic_orbit("henon-heiles", start, 6.5).period == pytest.approx(6.7467, abs=1e-3)


@pytest.mark.parametrize(
    "how", [{"method": Taylor()}, {"method": Splitting("kahan-li-8"), "step": 0.1}], ids=str
)
def test_the_unit_of_mass_makes_no_orbit_chaotic(how):
    m = sp.Symbol("m", positive=True)
    H = Hamiltonian(
        (px**2 + py**2) / (2 * m) + m * (x**2 + 2 * y**2) / 2 + m * x**2 * y**2 / 10, [x, y], [px, py]
    )
    found = [
        gali(H, (0, 100), [0.1, 0.1, 0, 0], vectors=3, parameters={m: mass}, samples=100, **how)
        for mass in (1.0, 1e8, 1e18)
    ]
    assert [str(each.verdict.value) for each in found] == ["regular"] * 3
    assert all(each.value > 0.01 for each in found)


def test_a_volume_that_falls_before_there_are_samples_says_nothing():
    t, log = np.linspace(0.0, 1e5, 100), np.full(100, -35.0)
    log[0] = 0.0
    verdict, reason = _verdict(t, 8.0, log)
    assert verdict is Regularity.NOT_KNOWN
    assert "take more samples" in reason
    falling = np.maximum(-35.0, -np.linspace(0.0, 100.0, 100))
    assert _verdict(t, 8.0, falling)[0] is Regularity.CHAOTIC


def test_pairs_that_a_symmetry_keeps_at_one_do_not_bifurcate():
    r2 = x**2 + y**2
    H = Hamiltonian((px**2 + py**2) / 2 + r2 / 2 + r2**2 / 4, [x, y], [px, py])
    family = continue_family(periodic_orbit(H, [1.0, 0, 0, 0], 5.0), 10, 0.1)
    assert len(family.orbits) == 10
    assert family.bifurcations == ()


def test_circular_orbits_go_on_to_larger_energies():
    r2 = x**2 + y**2 + z**2
    H = Hamiltonian((px**2 + py**2 + pz**2) / 2 + r2 / 2 + r2**2 / 4, [x, y, z], [px, py, pz])
    first = periodic_orbit(H, [1.0, 0, 0, 0, 2**0.5, 0], 2 * np.pi / 2**0.5)
    up = continue_family(first, 8, 0.1)
    assert up.bifurcations == ()
    assert (np.diff(up.energies) > 0).all()
    radius = np.array([np.linalg.norm(orbit.y[:3]) for orbit in up.orbits])
    np.testing.assert_allclose(up.periods, 2 * np.pi / np.sqrt(1 + radius**2), rtol=1e-9)
    assert (np.diff(continue_family(first, 4, -0.1).energies) < 0).all()


def test_an_orbit_at_a_multiple_of_its_period_says_so():
    once = periodic_orbit("henon-heiles", [0.01, 0.1, 0.4, 0.1], 6.5)
    twice = periodic_orbit("henon-heiles", once.y, 2 * once.period)
    assert once.least_period == once.period
    assert twice.least_period == pytest.approx(once.period, rel=1e-9)
    assert "times" in repr(twice)
    assert "times" not in repr(once)
    four = periodic_orbit(standard, [np.pi + 0.1, 0.05], 4)
    assert (four.period, four.least_period) == (4.0, 1.0)


@pytest.mark.parametrize(("method", "step"), [("verlet", 0.5), ("taylor", None)])
def test_a_kept_section_has_the_passage_at_the_border_of_two_parts(method, step, tmp_path):
    H = Hamiltonian(px**2 / 2, [x], [px])
    starts = [[-200.0, 1.0], [-150.0, 1.0], [200.0, -1.0]]
    for parts in (1, 2, 8):
        study = Study.of(
            system=H, start=starts, method=method, step=step, span=400.0, samples=1000, parts=parts,
            keep={"section": "x"},
        )  # fmt: skip
        run_study(study, file := str(tmp_path / f"{parts}.sqlite"))
        times = [each.kept["section"]["t"] for each in results_of(file)]
        assert [len(t) for t in times] == [1, 1, 1]
        np.testing.assert_allclose(np.concatenate(times), [200.0, 150.0, 200.0], atol=1e-9)


def test_a_start_that_was_made_for_another_parameter_says_so():
    kepler = find("kepler")
    other = kepler.with_parameters(mu=1.0)
    assert other.starts[0].about == "perihelion of an orbit of eccentricity 0.6, made for mu = 39.4769"
    assert other.with_parameters(mu=2.0).starts[0].about == other.starts[0].about
    np.testing.assert_array_equal(other.state(), kepler.state())
    assert kepler.with_parameters(mu=kepler.values["mu"]).starts == kepler.starts
    assert find("simple-pendulum").with_parameters(l=2.0).starts == find("simple-pendulum").starts


def test_deviations_by_taylor_beside_parameters_by_orbit():
    """They are what each orbit has by itself; shapes of arrays were told."""
    m = parameters("m", positive=True)
    H = Hamiltonian((px**2 + py**2) / (2 * m) + (x**2 + y**2) / 2 + x**2 * y - y**3 / 3, [x, y], [px, py])
    start, masses = np.array([[0.0, 0.1], [0.1, -0.2], [0.35, 0.3], [0.0, 0.1]]), np.array([1.0, 1.3])
    how = {"method": Taylor(), "samples": 50}
    several = lyapunov_spectrum(H, (0, 100), start, parameters={m: masses}, **how)
    volumes = gali(H, (0, 100), start, vectors=3, parameters={m: masses}, **how)
    for k, mass in enumerate(masses):
        alone = lyapunov_spectrum(H, (0, 100), start[:, k], parameters={m: mass}, **how)
        np.testing.assert_allclose(several.exponents[:, k], alone.exponents, atol=1e-7)
        one = gali(H, (0, 100), start[:, k], vectors=3, parameters={m: mass}, **how)
        np.testing.assert_allclose(volumes.value[k], one.value, rtol=1e-5)
