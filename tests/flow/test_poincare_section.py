"""Poincaré sections: against closed forms, located events, and the bits of single orbits."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from canon import Event, Hamiltonian, Splitting, Taylor, coordinates, parameters, propagate
from canon.flow import NonFiniteStateError, SectionNotMetError, poincare_section, starts_of_energy

KAHAN_LI = {"method": Splitting("kahan-li-8"), "step": 0.2}


def oscillators(ratio: sp.Expr) -> Hamiltonian:
    x, y = coordinates("x y")
    return Hamiltonian(
        (x.momentum**2 + x**2 + y.momentum**2 + ratio**2 * y**2) / 2, [x, y], [x.momentum, y.momentum]
    )


def test_points_of_two_oscillators_turn_by_the_ratio_of_their_frequencies() -> None:
    ratio = np.sqrt(2.0)
    found = poincare_section(
        oscillators(sp.sqrt(2)), (0, 200), [0, 0.5, 1, 0], "x", method="kahan-li-8", step=0.05
    )
    # x = sin t rises through zero at t = 2πk; y = cos(√2 t)/2 there, and p_y = −√2 sin(√2 t)/2.
    t = 2 * np.pi * np.arange(1, 32)
    assert found.t == pytest.approx(t, abs=1e-10)
    assert found["y"] == pytest.approx(np.cos(ratio * t) / 2, abs=1e-10)
    assert found["p_y"] == pytest.approx(-ratio * np.sin(ratio * t) / 2, abs=1e-10)
    assert abs(found["x"]).max() < 1e-13
    assert found.turned == 0


@pytest.mark.parametrize("direction", [1, 0, -1])
@pytest.mark.parametrize("method", ["kahan-li-8", "RK4", "gauss-4"])
def test_places_are_those_of_events(method: str, direction: int) -> None:
    start = starts_of_energy("henon-heiles", 0.125, [0.0, 0.1, 0.0, 0.1], "p_x")
    x = coordinates("x")
    motion = propagate(
        "henon-heiles", (0, 60), start, method=method, step=0.1, samples=1, events=[Event(x, direction)]
    )
    found = poincare_section(
        "henon-heiles", (0, 60), start, "x", direction=direction, method=method, step=0.1
    )
    assert len(found.t) == len(motion.events)
    assert found.t == pytest.approx([met.t for met in motion.events], abs=1e-12)
    states = np.array([met.y for met in motion.events]).T
    assert found.y == pytest.approx(states, abs=1e-13)
    assert not direction or (np.sign(found["x_dot"]) == direction).all()


@pytest.mark.parametrize("precision", ["double", "compensated", "extended", "double-double"])
def test_every_precision_finds_the_same_places(precision: str) -> None:
    start = starts_of_energy("henon-heiles", 0.1, [0.0, 0.2, 0.0, 0.0], "p_x")
    found = poincare_section("henon-heiles", (0, 40), start, "x", precision=precision, **KAHAN_LI)
    usual = poincare_section("henon-heiles", (0, 40), start, "x", **KAHAN_LI)
    assert found.y == pytest.approx(usual.y, abs=1e-12)


def test_backwards_in_time_the_same_surface_is_passed() -> None:
    start = starts_of_energy("henon-heiles", 0.1, [0.0, 0.2, 0.0, 0.0], "p_x")
    there = poincare_section("henon-heiles", (0, 41), start, "x", direction=0, **KAHAN_LI)
    end = propagate("henon-heiles", (0, 41), start, samples=1, **KAHAN_LI).final
    back = poincare_section("henon-heiles", (41, 0), end, "x", direction=0, **KAHAN_LI)
    # The start lies on the surface; on the way back it may be passed or just not.
    count = len(there.t)
    assert back.y[:, :count] == pytest.approx(there.y[:, ::-1], abs=1e-10)
    assert back.t[:count] == pytest.approx(there.t[::-1], abs=1e-10)


@settings(max_examples=50)
@given(orbits=st.integers(1, 40), seed=st.integers(0, 2**32 - 1), points=st.integers(1, 6))
def test_an_ensemble_has_the_bits_of_its_orbits(orbits: int, seed: int, points: int) -> None:
    draw = np.random.default_rng(seed)
    y, py = draw.uniform(-0.2, 0.3, orbits), draw.uniform(-0.2, 0.2, orbits)
    zero = np.zeros(orbits)
    starts = starts_of_energy("henon-heiles", 0.125, np.array([zero, y, zero, py]), "p_x")
    k = int(draw.integers(orbits))
    many = poincare_section("henon-heiles", (0, 100), starts, "x", points=points, **KAHAN_LI)
    one = poincare_section("henon-heiles", (0, 100), starts[:, k], "x", points=points, **KAHAN_LI)
    assert many.counts.tolist() == [points] * orbits
    assert (many.of_orbit(k) == one.y).all()
    assert (many.t[many.orbit == k] == one.t).all()


def test_so_many_points_by_events_too() -> None:
    """Taylor's method locates them as events, and goes on to the end of the span."""
    start = starts_of_energy("henon-heiles", 0.1, [0.0, 0.2, 0.0, 0.0], "p_x")
    all_ = poincare_section("henon-heiles", (0, 60), start, "x", method=Taylor())
    two = poincare_section("henon-heiles", (0, 60), start, "x", points=2, method=Taylor())
    assert all_.counts.tolist() > two.counts.tolist() == [2]
    assert (two.y == all_.y[:, :2]).all()


def test_more_places_than_there_is_memory_to_note_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    start = starts_of_energy(
        "henon-heiles", 0.1, np.array([[0.0] * 20, np.linspace(0, 0.2, 20), [0] * 20, [0] * 20]), "p_x"
    )
    whole = poincare_section("henon-heiles", (0, 200), start, "x", **KAHAN_LI)
    monkeypatch.setattr("canon.flow.fixed_step.section_search._ROOM", 40)
    parts = poincare_section("henon-heiles", (0, 200), start, "x", **KAHAN_LI)
    assert (parts.y == whole.y).all()
    assert (parts.orbit == whole.orbit).all()


def test_two_passings_within_one_step_are_told() -> None:
    x = coordinates("x")
    oscillator = Hamiltonian((x.momentum**2 + x**2) / 2, [x], [x.momentum])
    # x + 0.995 is below zero for 0.2 of time in each period.
    touching = poincare_section(
        oscillator, (0, 100), [1.0, 0.0], x + sp.Rational(199, 200), method="kahan-li-8", step=0.05
    )
    assert touching.turned == 0
    assert len(touching.t) == 16
    coarse = poincare_section(
        oscillator, (0, 100), [1.0, 0.0], x + sp.Rational(199, 200), method="kahan-li-8", step=0.5
    )
    assert 0 < 16 - len(coarse.t) <= coarse.turned


def test_a_driven_system_at_the_phase_of_its_drive() -> None:
    x, t = coordinates("x"), sp.Symbol("t", real=True)
    driven = Hamiltonian(x.momentum**2 / 2 + x**2 / 2 - x * sp.cos(2 * t), [x], [x.momentum], t)
    found = poincare_section(driven, (0, 20), [0.0, 0.0], sp.sin(2 * t), method="kahan-li-8", step=0.05)
    # ẍ + x = cos 2t from rest: x = (cos t − cos 2t)/3.
    at = np.pi * np.arange(1, 7)
    assert found.t == pytest.approx(at, abs=1e-12)
    assert found["x"] == pytest.approx((np.cos(at) - np.cos(2 * at)) / 3, abs=1e-11)


def test_other_systems_than_hamiltonians_have_sections() -> None:
    found = poincare_section("driven-duffing", (0, 60), None, "x", method="gauss-4", step=0.02)
    exact = poincare_section("driven-duffing", (0, 60), None, "x")
    assert found.y == pytest.approx(exact.y, abs=1e-7)
    assert abs(exact["x"]).max() < 1e-14


@pytest.mark.parametrize("method", ["kahan-li-8", "taylor"])
def test_parameters_by_orbit_are_those_of_each_orbits_points(method: str) -> None:
    x, (k,) = coordinates("x"), parameters("k,", positive=True)
    wells = Hamiltonian(x.momentum**2 / 2 + k * x**2 / 2, [x], [x.momentum])
    how = {"method": method} | ({} if method == "taylor" else {"step": 0.05})
    stiffness = np.array([1.0, 4.0])
    found = poincare_section(
        wells, (0, 30), np.array([[0.5, 0.5], [0.0, 0.0]]), "x", parameters={k: stiffness}, **how
    )
    assert abs(found.energy_change).max() < 1e-10
    assert found[k * x.momentum**2] == pytest.approx(stiffness[found.orbit] ** 2 / 4, abs=1e-9)


def test_what_is_not_met_or_not_there_is_told() -> None:
    start, x = [0.0, 0.1, 0.45, 0.0], coordinates("x")
    with pytest.raises(
        SectionNotMetError, match=r"no orbit passes x - 5 = 0 between t = 0 and t = 30 rising: take a longer"
    ):
        poincare_section("henon-heiles", (0, 30), start, x - 5, **KAHAN_LI)
    with pytest.raises(KeyError, match="nothing along this motion is called 'z'"):
        poincare_section("henon-heiles", (0, 30), start, "z", **KAHAN_LI)
    with pytest.raises(ValueError, match="does not depend on the motion"):
        poincare_section("henon-heiles", (0, 30), start, sp.Integer(3), **KAHAN_LI)
    with pytest.raises(ValueError, match="points=0"):
        poincare_section("henon-heiles", (0, 30), start, x, points=0, **KAHAN_LI)
    with pytest.raises(NonFiniteStateError, match="of orbit 1"):
        poincare_section("henon-heiles", (0, 3000), np.array([start, [0, 3.0, 1.0, 2.0]]).T, x, **KAHAN_LI)


def test_starts_have_the_energy_that_is_asked() -> None:
    grid = np.array([[0.0] * 3, [0.0, 0.1, 3.0], [7.0] * 3, [0.1] * 3])
    found = starts_of_energy("henon-heiles", 0.125, grid[:, :2], "p_x", sign=-1)
    x, y, px, py = found
    assert (x**2 + y**2 + px**2 + py**2) / 2 + x**2 * y - y**3 / 3 == pytest.approx(0.125, abs=1e-16)
    assert (px < 0).all()
    beyond = np.array([[0.0, 0.0], [0.1, 0.9], [0, 0], [0, 0]])
    assert starts_of_energy("henon-heiles", 0.125, beyond, "p_x", inside_only=True).shape == (4, 1)
    with pytest.raises(ValueError, match=r"no p_x gives the energy 0\.125 at"):
        starts_of_energy("henon-heiles", 0.125, beyond, "p_x")
    with pytest.raises(KeyError, match="there is no momentum p_z, H has p_x, p_y"):
        starts_of_energy("henon-heiles", 0.125, beyond, "p_z")
    x = coordinates("x")
    quartic = Hamiltonian(x.momentum**4 + x**2, [x], [x.momentum])
    with pytest.raises(ValueError, match="H is no square in p_x"):
        starts_of_energy(quartic, 1.0, [0.0, 1.0], "p_x")


def test_a_momentum_whose_square_vanishes_at_a_place_has_one_value_there_or_none():
    x = coordinates("x")
    p = x.momentum
    both = Hamiltonian(x * p**2 / 2 + p + x, [x], [p])
    starts = starts_of_energy(both, 1.0, np.array([[0.0, 0.5, 1e-14], [0.0, 0.0, 0.0]]), p)
    np.testing.assert_allclose(starts[1], [1, np.sqrt(6) - 2, 1], rtol=1e-13)
    square = Hamiltonian(x * p**2 / 2 + x, [x], [p])
    with pytest.raises(ValueError, match="no p_x gives the energy 1"):
        starts_of_energy(square, 1.0, [0.0, 0.0], p)
    grid = np.array([[0.0, 0.5], [0.0, 0.0]])
    np.testing.assert_allclose(
        starts_of_energy(square, 1.0, grid, p, inside_only=True), [[0.5], [np.sqrt(2)]]
    )


def test_poles_of_a_surface_are_no_passings():
    x, y = coordinates("x y")
    rotors = Hamiltonian((x.momentum**2 + y.momentum**2) / 2, [x, y], [x.momentum, y.momentum])
    starts = np.array([[0.1, 0.2], [0, 0], [1, 2], [0, 0]])
    found = poincare_section(
        rotors, (0, 7), starts, sp.tan(x), direction=0, method=Splitting("verlet"), step=0.1
    )
    np.testing.assert_allclose(found.t[found.orbit == 0], np.pi * np.arange(1, 3) - 0.1, atol=1e-13)
    np.testing.assert_allclose(found.t[found.orbit == 1], (np.pi * np.arange(1, 5) - 0.2) / 2, atol=1e-13)
