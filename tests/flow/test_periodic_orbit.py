"""Periodic orbits: closed forms, published orbits and multipliers, families through their bifurcations."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import sympy as sp
from scipy.special import ellipk

from canon import Hamiltonian, Lagrangian, Splitting, coordinates, parameters, propagate
from canon import time as t
from canon.flow import (
    NoPeriodicOrbitError,
    continue_family,
    manifold_starts,
    periodic_orbit,
)
from canon.flow.chaos.floquet import floquet_multipliers

x, y, z = coordinates("x y z")
PENDULUM = Hamiltonian(x.momentum**2 / 2 - sp.cos(x), [x], [x.momentum])


def oscillators(sign: int) -> Hamiltonian:
    kinetic, other = x.momentum**2 + x**2, y.momentum**2 + 2 * y**2
    return Hamiltonian((kinetic + sign * other) / 2, [x, y], [x.momentum, y.momentum])


def restricted(mu: sp.Rational) -> Hamiltonian:
    px, py, pz = x.momentum, y.momentum, z.momentum
    far, near = (sp.sqrt((x + a) ** 2 + y**2 + z**2) for a in (mu, mu - 1))
    H = (px**2 + py**2 + pz**2) / 2 + px * y - py * x - (1 - mu) / far - mu / near
    return Hamiltonian(H, [x, y, z], [px, py, pz])


@pytest.mark.parametrize("amplitude", [0.3, 2.0])
def test_the_period_of_a_pendulum_is_that_of_its_energy(amplitude: float) -> None:
    orbit = periodic_orbit(PENDULUM, [amplitude, 0.0], 7.0, reversal=["p_x"])
    assert orbit.energy == pytest.approx(-np.cos(amplitude), abs=1e-14)
    assert orbit.period == pytest.approx(4 * ellipk(np.sin(amplitude / 2) ** 2), rel=1e-13)
    assert orbit.multipliers.values.size == 0
    assert orbit.multipliers.stable


def test_a_pendulum_that_turns_over_gains_a_turn_in_a_period() -> None:
    orbit = periodic_orbit(PENDULUM, [0.0, 3.0], 2.4, turns={"x": 2 * np.pi})
    m = 4 / (3.0**2)
    assert orbit.period == pytest.approx(2 * np.sqrt(m) * ellipk(m), rel=1e-13)


@pytest.mark.parametrize("sign", [1, -1])
def test_multipliers_of_two_oscillators_and_their_krein_signs(sign: int) -> None:
    orbit = periodic_orbit(oscillators(sign), [1.0, 0.001, 0.0, 0.002], 6.2)
    turn = np.exp(2j * np.pi * np.sqrt(2))
    found = dict(
        zip(orbit.multipliers.values.round(9).tolist(), orbit.multipliers.krein.tolist(), strict=True)
    )
    assert orbit.period == pytest.approx(2 * np.pi, rel=1e-12)
    # e^{iωT} is of the first kind where the oscillation has positive energy.
    assert found == {complex(turn.round(9)): sign, complex(turn.conjugate().round(9)): -sign}
    assert orbit.multipliers.stable
    assert orbit.multipliers.indices.real == pytest.approx([2 * turn.real], abs=1e-12)


def test_a_system_that_depends_on_time_keeps_its_period() -> None:
    clock = sp.Symbol("t", real=True)
    driven = Hamiltonian(x.momentum**2 / 2 + x**2 - x * sp.cos(clock), [x], [x.momentum], clock)
    orbit = periodic_orbit(driven, [0.4, 0.3], 2 * np.pi)
    # ẍ + 2x = cos t is answered by x = cos t; others turn by √2 in the meantime.
    assert orbit.y == pytest.approx([1.0, 0.0], abs=1e-12)
    assert orbit.multipliers.indices.real == pytest.approx([2 * np.cos(2 * np.pi * np.sqrt(2))], abs=1e-11)


def test_a_method_of_fixed_steps_has_periodic_orbits_of_its_own() -> None:
    own = periodic_orbit(
        "henon-heiles", [0, 0.1, 0.4, 0], 6.2, method=Splitting("verlet"), step=0.1, fixed_period=True
    )
    steps = propagate("henon-heiles", (0, own.period), own.y, method=Splitting("verlet"), step=0.1, samples=1)
    assert abs(steps.final - own.y).max() < 1e-13


@pytest.mark.parametrize(
    ("values", "kinds", "stable"),
    [
        (np.diag([2.0, 0.5]), ("hyperbolic",), False),
        (np.diag([-2.0, -0.5]), ("inverse hyperbolic",), False),
        (np.array([[1.0, 1.0], [0.0, 1.0]]), ("parabolic",), None),
        (np.array([[0.0, 1.0], [-1.0, 0.0]]), ("elliptic",), True),
    ],
)
def test_kinds_of_multipliers(values: np.ndarray, kinds: tuple[str, ...], stable: bool | None) -> None:
    found = floquet_multipliers(values, None)
    assert found.kinds == kinds
    assert found.stable is stable


@pytest.mark.parametrize("strength", [10, 10**4, 10**9])
def test_large_multipliers_and_their_indices_are_known_to_their_digits(strength: int) -> None:
    """The small eigenvalue is rounding: an index made of it had half its digits at 10⁴, and was a crash at 10⁹."""
    kick = sp.Matrix([[1 + strength, 1], [strength, 1]]) ** 2
    found = floquet_multipliers(np.array(kick.tolist(), dtype=float), None)
    trace = float(kick.trace())
    assert found.indices.real == pytest.approx([trace], rel=1e-15)
    assert found.values[1].real == pytest.approx(
        2 / (trace + float(sp.sqrt(kick.trace() ** 2 - 4))), rel=1e-14
    )


def test_pairs_that_left_the_circle_are_complex() -> None:
    # The real form of λ = 2 e^{i} with its partners 1/λ and conjugates, in q and p = A⁻ᵀ.
    A = 2 * np.array([[np.cos(1), -np.sin(1)], [np.sin(1), np.cos(1)]])
    found = floquet_multipliers(
        np.block([[A, np.zeros((2, 2))], [np.zeros((2, 2)), np.linalg.inv(A).T]]), None
    )
    assert found.kinds == ("complex", "complex")
    assert (found.krein == 0).all()


def test_what_is_no_periodic_orbit_is_told() -> None:
    free = Hamiltonian(x.momentum**2 / 2, [x], [x.momentum])
    with pytest.raises(NoPeriodicOrbitError, match="no periodic orbit is found") as lost:
        periodic_orbit(free, [0.0, 1.0], 1.0)
    assert lost.value.defect > 0.1
    with pytest.raises(ValueError, match="changing the signs of x does not reverse the motion"):
        periodic_orbit(
            Hamiltonian(x.momentum**2 / 2 + x**4 + x, [x], [x.momentum]), [0.5, 0.0], 3.0, reversal=["x"]
        )
    with pytest.raises(KeyError, match="there is no variable z, the motion has x, y, p_x, p_y"):
        periodic_orbit("henon-heiles", [0, 0.1, 0.4, 0], 6.2, reversal=["z"])
    with pytest.raises(TypeError, match="no Hamiltonian"):
        periodic_orbit(Lagrangian(x.dot**2 / 2, [x], forces=[-x.dot]), [1.0, 0.0], 6.0)
    with pytest.raises(ValueError, match="the period is fixed"):
        periodic_orbit(PENDULUM, [1.0, 0.0], 6.5, energy=0.1, fixed_period=True)


@pytest.mark.parametrize(("step", "goal"), [(0.2, -0.8), (-0.1, -0.95)])
def test_a_family_ends_with_the_first_orbit_beyond_its_energy(step: float, goal: float) -> None:
    first = periodic_orbit(PENDULUM, [0.5, 0.0], 6.4, reversal=["p_x"])
    family = continue_family(first, 40, step, to_energy=goal)
    *short, last = (np.sign(step) * (energy - goal) for energy in family.energies)
    assert max(short) < 0 <= last
    assert family.ended == f"the energy {goal:g} is reached"


@pytest.mark.slow
def test_a_family_passes_its_bifurcation() -> None:
    # On the axis x = 0 of Hénon and Heiles, y¨ = −y + y²: the orbit that passes between the saddle's sides.
    first = periodic_orbit("henon-heiles", [0.0, 0.05, 0.0, 0.0], 6.3, reversal=["p_x", "p_y"])
    family = continue_family(first, 40, 0.05, to_energy=0.16)
    assert (np.diff(family.energies) > 0).all()
    assert family.energies[-1] >= 0.16
    assert family.ended == "the energy 0.16 is reached"
    assert abs(np.array([orbit.y[[0, 2, 3]] for orbit in family.orbits])).max() < 1e-9
    kinds = [orbit.multipliers.kinds[0] for orbit in family.orbits]
    changes = sum(a != b for a, b in itertools.pairwise(kinds))
    assert len(family.bifurcations) >= changes - kinds.count("parabolic") > 0


@pytest.mark.slow
def test_figure_eight_has_the_multipliers_of_simo() -> None:
    """C. Simó (2002), in Celestial Mechanics, Contemp. Math. 292, 209: ν = 0.00842272, 0.29809253."""
    orbit = periodic_orbit("figure-eight", None, 6.3259)
    turns = np.sort(abs(np.angle(orbit.multipliers.values)) / (2 * np.pi))
    assert orbit.period == pytest.approx(6.32591398, abs=1e-7)
    assert turns[-1] == pytest.approx(0.29809253, abs=1e-8)
    assert turns[-3] == pytest.approx(0.00842272, abs=1e-8)
    assert orbit.multipliers.kinds.count("elliptic") == 2
    assert orbit.multipliers.stable is None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("x0", "z0", "rate", "half"),
    [(0.723268, 0.040000, 0.198019, 1.300177), (0.729988, 0.215589, 0.397259, 1.348532)],
)
def test_halo_orbits_of_howell(x0: float, z0: float, rate: float, half: float) -> None:
    """K. C. Howell, Celest. Mech. 32 (1984) 53, Table I, µ = 0.04, doi:10.1007/BF01358403: six decimals."""
    H = restricted(sp.Rational(4, 100))
    guess = [x0 + 1e-4, 0, z0, 0, rate + x0 + 1e-4, 0]
    orbit = periodic_orbit(
        H, guess, 2.01 * half, reversal=("y", "p_x", "p_z"), energy=_energy(H, x0, z0, rate)
    )
    assert orbit.y[0] == pytest.approx(x0, abs=3e-5)
    assert orbit.y[2] == pytest.approx(z0, abs=3e-5)
    assert orbit.period / 2 == pytest.approx(half, abs=3e-6)
    assert "hyperbolic" in orbit.multipliers.kinds


@pytest.mark.slow
@pytest.mark.parametrize(
    ("x0", "z0", "rate", "period"),
    [
        (0.82339081983651485, 9.8941366235910004e-4, 0.12634272983881797, 2.7430007981241529),
        (0.87592140310093525, 0.19175810982939320, 0.23080031482213192, 2.1783120807931518),
        (1.1427323976670050, 0.15915200933380999, -0.22233902828510901, 3.1327035113287223),
        (1.0831337559276397, 0.20231055618100155, -0.20121168055184560, 2.3861839336103214),
    ],
)
def test_halo_orbits_between_earth_and_moon(x0: float, z0: float, rate: float, period: float) -> None:
    """JPL's catalogue of periodic orbits, ssd.jpl.nasa.gov/tools/periodic_orbits.html: two about L₁, two about L₂."""
    H = restricted(sp.Float("0.01215058560962404", 17))
    guess = [x0 + 1e-6, 0, z0, 0, rate + x0 + 1e-6, 0]
    found = periodic_orbit(
        H, guess, period + 1e-4, reversal=("y", "p_x", "p_z"), energy=_energy(H, x0, z0, rate)
    )
    assert found.y[[0, 2, 4]] == pytest.approx([x0, z0, rate + x0], abs=1e-9)
    assert found.period == pytest.approx(period, abs=1e-9)


@pytest.mark.parametrize(
    ("x0", "z0", "rate", "period", "index"),
    [
        (0.82339081983651485, 9.8941366235910004e-4, 0.12634272983881797, 2.743, 1180.4065333857600),
        (0.87592140310093525, 0.19175810982939320, 0.23080031482213192, 2.1783, 1.0000000000218601),
    ],
)
def test_halo_orbits_have_the_stability_of_the_catalogue(
    x0: float, z0: float, rate: float, period: float, index: float
) -> None:
    """The catalogue's index is the largest |½(λ + 1/λ)| of the multipliers."""
    H = restricted(sp.Float("0.01215058560962404", 17))
    guess, energy = [x0, 0, z0, 0, rate + x0, 0], _energy(H, x0, z0, rate)
    found = periodic_orbit(H, guess, period, reversal=("y", "p_x", "p_z"), energy=energy)
    largest = abs(found.multipliers.values).max()
    assert (largest + 1 / largest) / 2 == pytest.approx(index, rel=1e-8)


@pytest.mark.parametrize("start", [0.3, 1.0, 2.5])
@pytest.mark.parametrize("off", [0.0, 1e-6, 3e-5, 1e-3, 0.1])
def test_a_guess_may_be_as_near_as_it_likes(start: float, off: float) -> None:
    """At a turning point one of the equations is all rounding."""
    period = 4 * ellipk(np.sin(start / 2) ** 2)
    orbit = periodic_orbit(PENDULUM, [start, 0.0], period + off)
    assert orbit.period == pytest.approx(4 * ellipk((1 + orbit.energy) / 2), rel=1e-12)


@pytest.mark.parametrize(
    ("H", "start", "more"),
    [
        (PENDULUM, [np.pi, 0.0], {}),
        (PENDULUM, [1.0, 0.0], {"fixed_period": True}),  # no libration is as fast as that
        (oscillators(1), [0.0, 0.0, 0.0, 0.0], {}),
        ("henon-heiles", [0.0, 1.0, 0.0, 0.0], {}),
    ],
)
def test_an_equilibrium_is_no_orbit(H: object, start: list[float], more: dict[str, bool]) -> None:
    with pytest.raises(NoPeriodicOrbitError, match="equilibrium"):
        periodic_orbit(H, start, 6.0, **more)


@pytest.mark.parametrize("turns", [1, 3])
def test_a_drive_may_turn_several_times_in_a_period(turns: int) -> None:
    orbit = periodic_orbit(driven(sp.cos(3 * t)), [0.1, 0.0], turns * 2 * np.pi / 3)
    # ẍ + 2x = cos 3t is answered by x = −cos(3t)/7.
    assert orbit.y == pytest.approx([-1 / 7, 0], abs=1e-13)


@pytest.mark.parametrize(
    ("drive", "period"),
    [
        *itertools.product([sp.cos(t), sp.cos(t) + sp.exp(-t)], [6.28, 6.2831853, 6.0, np.pi]),
        (sp.cos(t) + sp.exp(-t), 2 * np.pi),
        (sp.sign(sp.sin(t)), 6.28),
        (t, 1.0),
    ],
)
def test_a_drive_that_has_another_period_is_told(drive: sp.Expr, period: float) -> None:
    with pytest.raises(
        ValueError, match=rf"H is not the same after {period}: .* multiple of the drive's period"
    ):
        periodic_orbit(driven(drive), [0.2, 0.0], period)


def test_a_drive_that_switches_has_its_period() -> None:
    orbit = periodic_orbit(driven(sp.sign(sp.sin(t))), [0.2, 0.0], 2 * np.pi)
    half, w = np.pi, np.sqrt(2)
    # ẍ + 2x = ±1 and x(t + π) = −x(t): x = ½ + a cos wt + b sin wt with x(0) = −x(π), ẋ(0) = −ẋ(π), so that a = −½.
    b = -np.sin(w * half) / (2 * (1 + np.cos(w * half)))
    assert orbit.y == pytest.approx([0.0, w * b], abs=1e-12)


def driven(force: sp.Expr) -> Hamiltonian:
    return Hamiltonian(x.momentum**2 / 2 + x**2 - x * force, [x], [x.momentum])


UNITS = [
    (1.0, 1.0, 1.0), (1e-6, 1.0, 1.0), (1e-10, 1.0, 1.0), (1.0, 1.0, 1e-25), (1e-5, 1e-7, 2.2e-25), (1e8, 1e5, 1e20),
    (1e-10, 1e5, 1e-25),
]  # fmt: skip
"""Of length, time and mass."""

m, l, a = parameters("m l a", positive=True)


def in_units(V: sp.Expr, *q: sp.Symbol) -> Hamiltonian:
    """Return the Hamiltonian with a potential that is written in the units m, l and a of mass, length and time."""
    own = V.xreplace({s: s / l for s in q}) * m * l**2 / a**2
    return Hamiltonian(sum(s.momentum**2 for s in q) / (2 * m) + own, list(q), [s.momentum for s in q])


def found_in(
    units: tuple[float, float, float], H: Hamiltonian, start: list[float], period: float, **how: object
):
    """Return the state, period and energy of an orbit as pure numbers, and what was found."""
    L, T, M = units
    size = np.repeat([L, M * L / T], len(start) // 2)
    found = periodic_orbit(H, size * start, period * T, parameters={m: M, l: L, a: T}, **how)
    return np.array([*found.y / size, found.period / T, found.energy * T**2 / (M * L**2)]), found


def duffing_period(energy: float) -> float:
    """Return the period of ẍ = −x − x³: x = A cn(wt, k²), w² = 1 + A², k² = A²/2w²."""
    square = np.sqrt(1 + 4 * energy) - 1
    return float(4 * ellipk(square / (2 * (1 + square))) / np.sqrt(1 + square))


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("how", [{}, {"reversal": ["p_x"]}])
def test_the_period_of_an_anharmonic_oscillator_in_any_units(
    units: tuple[float, ...], how: dict[str, list[str]]
):
    numbers, _ = found_in(units, in_units(x**2 / 2 + x**4 / 4, x), [1.0, 0.0], 5.0, **how)
    assert numbers[-1] == pytest.approx(0.75, rel=1e-12)
    assert numbers[-2] == pytest.approx(duffing_period(0.75), rel=1e-12)


@pytest.mark.parametrize("units", UNITS)
def test_an_unstable_orbit_and_its_multipliers_are_the_same_in_any_units(units: tuple[float, ...]) -> None:
    H = in_units((x**2 + y**2) / 2 + x**2 * y - y**3 / 3, x, y)
    natural = periodic_orbit("henon-heiles", [0.01, 0.1, 0.4, 0.1], 6.5)
    numbers, orbit = found_in(units, H, [0.01, 0.1, 0.4, 0.1], 6.5)
    assert numbers == pytest.approx([*natural.y, natural.period, natural.energy], abs=1e-9)
    assert orbit.multipliers.indices.real == pytest.approx(natural.multipliers.indices.real, abs=1e-9)
    assert orbit.multipliers.kinds == ("hyperbolic",)


@pytest.mark.parametrize("units", UNITS)
def test_an_equilibrium_is_none_in_any_units(units: tuple[float, ...]) -> None:
    H = in_units((x**2 + y**2) / 2 + x**2 * y - y**3 / 3, x, y)
    for start in ([0.0, 1.0, 0.0, 0.0], [1e-4, 0.9999, 0.0, 0.0]):
        with pytest.raises(NoPeriodicOrbitError, match="equilibrium"):
            found_in(units, H, start, 6.0, fixed_period=True)


@pytest.mark.parametrize("units", UNITS)
def test_an_orbit_has_the_energy_that_is_asked_for(units: tuple[float, ...]) -> None:
    """The start closes by itself, with another energy."""
    energy = 2.0 * units[2] * (units[0] / units[1]) ** 2
    numbers, _ = found_in(units, in_units(x**2 / 2 + y**2, x, y), [1.0, 0, 0, 0], 2 * np.pi, energy=energy)
    assert numbers[-2:] == pytest.approx([2 * np.pi, 2.0], rel=1e-12)


@pytest.mark.parametrize("units", UNITS)
@pytest.mark.parametrize("start", [[1.0, 0.0, 0.0, 2.0], [1.0, 0.0, 0.01, 2.0]])
def test_a_circle_in_polar_coordinates_in_any_units(units: tuple[float, ...], start: list[float]) -> None:
    """Neither r, its momentum nor p_y moves on it: y is an angle here, of another kind than r."""
    L, T, M = units
    V = m * l**2 / a**2 * (x / l) ** 4
    H = Hamiltonian((x.momentum**2 + y.momentum**2 / x**2) / (2 * m) + V, [x, y], [x.momentum, y.momentum])
    size = np.array([L, 1.0, M * L / T, M * L**2 / T])
    circle = periodic_orbit(
        H, size * start, 3.14 * T, parameters={m: M, l: L, a: T}, turns={"y": 2 * np.pi}, fixed_period=True
    )
    # p_y² = 4 r⁶ there, the angle turns at 2r, and r oscillates with the frequency √(3 + 3) times that.
    assert circle.y[0] / L == pytest.approx(np.pi / 3.14, rel=1e-12)
    assert circle.y[3] / size[3] == pytest.approx(2 * (np.pi / 3.14) ** 3, rel=1e-12)
    assert circle.multipliers.indices.real == pytest.approx([2 * np.cos(2 * np.pi * np.sqrt(6))], abs=1e-9)


@pytest.mark.parametrize("units", UNITS)
def test_a_family_is_the_same_in_any_units(units: tuple[float, ...]) -> None:
    L, T, M = units
    _, first = found_in(units, in_units(x**2 / 2 + x**4 / 4, x), [0.3, 0.0], 6.2, reversal=["p_x"])
    family = continue_family(first, 6, 0.1)
    energies, periods = family.energies * T**2 / (M * L**2), family.periods / T
    assert periods == pytest.approx([duffing_period(energy) for energy in energies], rel=1e-11)
    _, ordinary = found_in((1, 1, 1), in_units(x**2 / 2 + x**4 / 4, x), [0.3, 0.0], 6.2, reversal=["p_x"])
    natural = continue_family(ordinary, 6, 0.1)
    assert len(natural.orbits) == 6
    assert energies == pytest.approx(natural.energies, rel=1e-9)


LYAPUNOV = {
    "L1, small": (0.830023864314168, 0.06088309999599009, 3.18515736797775, 2.702881200253821, 1300.72578337944),
    "L1, larger": (0.8007325761918545, 0.35248700747556716, 3.07728036254377, 3.297097386764505, 425.868250560381),
    "L1, large": (0.7076756180347542, 0.621513254358129, 2.94595078958827, 5.709795908302705, 64.0473059678341),
    "L2, small": (1.1599891825364728, -0.023755466801822275, 3.1717305860487, 3.3740716677049702, 724.023759109433),
    "L2, larger": (1.039766165259229, 0.6277452743730177, 3.03331847496241, 4.056819398703425, 164.905262178291),
    "L2, by the Moon": (0.9994950073945017, 1.4487043957010053, 2.93992816431116, 6.275370831496941, 51.8820187401216),
}  # fmt: skip
"""Planar orbits of the catalogue between Earth and Moon: x, dy/dt, Jacobi's constant, period, index of stability."""


@pytest.mark.parametrize("name", LYAPUNOV)
def test_planar_orbits_of_lyapunov_between_earth_and_moon(name: str) -> None:
    x0, rate, jacobi, period, index = LYAPUNOV[name]
    mu = sp.Float("0.01215058560962404", 17)
    H, energy = restricted(mu), -jacobi / 2
    guess = [x0 + 1e-7, 0, 0, 0, rate + x0 + 1e-7, 0]
    found = periodic_orbit(H, guess, period + 1e-5, reversal=("y", "p_x", "p_z"), energy=energy)
    assert found.y[[0, 2, 4]] == pytest.approx([x0, 0, rate + x0], abs=1e-9)
    assert found.period == pytest.approx(period, abs=1e-9)
    largest = abs(found.multipliers.values).max()
    # Of the one that passes the Moon at 0.01, half and whole periods and two tolerances all give 51.882045679.
    assert (largest + 1 / largest) / 2 == pytest.approx(index, rel=1e-6 if "Moon" in name else 1e-7)


def _energy(H: Hamiltonian, x0: float, z0: float, rate: float) -> float:
    start = dict(zip((*H.q, *H.p), (x0, 0, z0, 0, rate + x0, 0), strict=True))
    return float(H.H.subs(start))


@pytest.mark.slow
def test_orbit_of_arenstorf() -> None:
    """Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, (0.1): the period to 27 digits."""
    orbit = periodic_orbit("restricted-three-body", "Arenstorf", 17.07, reversal=("y", "p_x"))
    assert orbit.period == pytest.approx(17.0652165601579625589, abs=1e-11)
    assert orbit.y[0] == pytest.approx(0.994, abs=1e-11)
    whole = periodic_orbit("restricted-three-body", "Arenstorf", 17.0652166)
    assert whole.multipliers.indices.real == pytest.approx(orbit.multipliers.indices.real, rel=1e-6)


@pytest.mark.slow
def test_what_falls_into_a_very_unstable_orbit_does_so_from_every_place() -> None:
    orbit = periodic_orbit("restricted-three-body", "Arenstorf", 17.07, reversal=("y", "p_x"))
    starts = {b: manifold_starts(orbit, b, count=16, distance=1e-7) for b in ("stable", "unstable")}
    for k in (12, 15):  # carried forward what is stable came with parts of what is not
        place = propagate("restricted-three-body", (0, orbit.period * k / 16), orbit.y, samples=1).final
        left = [
            np.linalg.norm(propagate("restricted-three-body", (0, time), y[:, k], samples=1).final - place)
            for time, y in ((orbit.period, starts["stable"]), (-orbit.period, starts["unstable"]))
        ]
        # Mirror images, that fall by the largest multiplier; rounding by the Moon leaves some 1e-11 of them.
        assert left == pytest.approx([1e-7 / abs(orbit.multipliers.values).max()] * 2, rel=0.1)


@pytest.mark.slow
def test_manifolds_leave_an_orbit_and_fall_into_it() -> None:
    orbit = periodic_orbit("henon-heiles", [0.01, 0.1, 0.4, 0.1], 6.5)
    growth = abs(orbit.multipliers.values[0])
    for branch, time in (("unstable", orbit.period), ("stable", -orbit.period)):
        starts = manifold_starts(orbit, branch, count=5, distance=1e-7)
        ends = propagate("henon-heiles", (0, time), starts, samples=1).y[:, -1]
        places = propagate(
            "henon-heiles", (0, orbit.period), orbit.y, times=orbit.period / 5 * np.arange(1, 5)
        ).y[:, :5]
        parted = np.linalg.norm(ends - places, axis=0) / np.linalg.norm(starts - places, axis=0)
        assert parted == pytest.approx(growth, rel=1e-4)
        energies = propagate("henon-heiles", (0, 1), starts, samples=1).energy[0]
        assert energies == pytest.approx(orbit.energy, abs=1e-12)
    with pytest.raises(ValueError, match="no real multiplier"):
        manifold_starts(periodic_orbit(oscillators(1), [1.0, 0.001, 0.0, 0.002], 6.2))


@pytest.mark.parametrize("guess", [6900, 7000, 7050, 7100, 7200])
def test_kepler_where_every_orbit_closes(guess):
    """In metres and seconds and in its own units, to the period 2π √(a³/μ) of the start's energy."""
    x, y = coordinates("x y")
    for mu, r, v, unit in (
        (3.9860044e14, 7e6, 8e3, 1.0),
        (1.0, 1.0, 8e3 * (7e6 / 3.9860044e14) ** 0.5, None),
    ):
        unit = unit or (7e6**3 / 3.9860044e14) ** 0.5
        kepler = Hamiltonian(
            (x.momentum**2 + y.momentum**2) / 2 - mu / sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
        )
        found = periodic_orbit(kepler, [r, 0, 0, v], guess / unit)
        axis = 1 / (2 / r - v**2 / mu)
        assert found.period == pytest.approx(2 * np.pi * (axis**3 / mu) ** 0.5, rel=1e-9)
