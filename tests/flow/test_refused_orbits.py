"""Periodic orbits, their families, what leaves them, starts on a surface of energy: refusals, and ends."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import ellipk

from canon import Hamiltonian, Lagrangian, Splitting, Taylor, TimeTransformed, VectorField, coordinates, time
from canon.flow import (
    SectionNotMetError,
    continue_family,
    manifold_starts,
    periodic_orbit,
    poincare_section,
    starts_of_energy,
)
from canon.flow.chaos import orbit_family

if TYPE_CHECKING:
    from collections.abc import Callable

x, y = coordinates("x y")
ANHARMONIC = Hamiltonian(x.momentum**2 / 2 + x**2 / 2 + x**4 / 4, [x], [x.momentum])
LINEAR = Hamiltonian((x.momentum**2 + x**2 + y.momentum**2 + 2 * y**2) / 2, [x, y], [x.momentum, y.momentum])


def anharmonic(**how: Any) -> Any:
    return periodic_orbit(ANHARMONIC, [0.3, 0.0], 6.2, **how)


def test_starts_of_an_energy_that_make_no_sense_are_refused() -> None:
    still = [0.0, 0.1, 0.0, 0.1]
    with pytest.raises(ValueError, match="sign=0: 1 takes the larger momentum, -1 the smaller"):
        starts_of_energy("henon-heiles", 0.125, still, "p_x", sign=0)
    with pytest.raises(ValueError, match=r"y0 of shape \(3,\): states \(q, p\) have shape \(4, orbits\)"):
        starts_of_energy("henon-heiles", 0.125, still[:3], "p_x")
    driven = Hamiltonian(x.momentum**2 / 2 - x * sp.cos(time), [x], [x.momentum])
    with pytest.raises(ValueError, match="H depends on time, so that its value is no energy"):
        starts_of_energy(driven, 1.0, [0.0, 0.0], "p_x")
    fall: Any = Lagrangian(x.dot**2 / 2 - x, [x])
    with pytest.raises(TypeError, match=r"is no Hamiltonian: give one, such as canon\.hamiltonian\(L\)"):
        starts_of_energy(fall, 1.0, [0.0, 0.0], "p_x")


@pytest.mark.parametrize(
    ("system", "start", "how", "said"),
    [
        (LINEAR, np.eye(4), {}, r"one start at a time: y0 of shape \(2n,\)"),
        (
            LINEAR,
            [1.0, 0, 0, 0],
            {"method": TimeTransformed(Splitting("verlet")), "step": 0.1},
            r"has steps that vary: take Taylor\(\), or a method of fixed steps",
        ),
        (ANHARMONIC, [0.3, 0.0], {"turns": {"x": 1.0}, "reversal": ["p_x"]}, "turns and reversal: give one"),
    ],
)
def test_requests_for_orbits_that_make_no_sense_are_refused(
    system: Any, start: Any, how: dict[str, Any], said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        periodic_orbit(system, start, 6.2, **how)


def test_families_of_no_step_or_of_one_period_are_refused() -> None:
    with pytest.raises(ValueError, match="step=0: give the distance from one orbit to the next"):
        continue_family(anharmonic(), 3, 0.0)
    with pytest.raises(ValueError, match="orbits of a fixed period make no family in energy"):
        continue_family(anharmonic(fixed_period=True), 3, 0.1)


def test_manifolds_of_what_has_none_and_sides_that_are_none_are_refused() -> None:
    orbit = periodic_orbit(LINEAR, [1.0, 0.001, 0.0, 0.002], 6.2)
    wrong: Any = "centre"
    with pytest.raises(ValueError, match="branch='centre': 'unstable' or 'stable'"):
        manifold_starts(orbit, wrong)
    with pytest.raises(ValueError, match="side=0: 1 or -1"):
        manifold_starts(orbit, side=0)
    with pytest.raises(ValueError, match="has no real multiplier but ±1: nothing leaves it"):
        manifold_starts(orbit)


def test_a_step_past_the_period_zero_is_shortened() -> None:
    """The period falls as the amplitude grows: a step of thousands would come to a negative one."""
    family = continue_family(anharmonic(reversal=["p_x"]), 2, 4000.0)
    root = np.sqrt(1 + 4 * family.energies)
    periods = 4 * ellipk((root - 1) / (2 * root)) / np.sqrt(root)
    assert family.energies[1] > 2 * family.energies[0]
    assert family.periods == pytest.approx(periods, rel=1e-11)


def _period(V: Callable[[float], float], energy: float) -> float:
    low, high = (brentq(lambda u: V(u) - energy, *side) for side in ((-3, 0), (0, 1)))
    middle, half = (low + high) / 2, (high - low) / 2

    def part(angle: float) -> float:
        return half * np.cos(angle) / np.sqrt(2 * (energy - V(middle + half * np.sin(angle))))

    return 2 * quad(part, -np.pi / 2, np.pi / 2, epsabs=1e-10, epsrel=1e-10)[0]


def test_a_family_ends_where_the_potential_does(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of V = x²/2 − (1 − x)^(5/2)/10, where no motion starts beyond x = 1: that was an error of a state not given."""
    monkeypatch.setattr(orbit_family, "_LEAST", 1e-2)
    well = Hamiltonian((x.momentum**2 + x**2) / 2 - (1 - x) ** sp.Rational(5, 2) / 10, [x], [x.momentum])
    family = continue_family(periodic_orbit(well, [0.98, 0.0], 8.49, reversal=["p_x"]), 40, 0.05)
    assert family.ended.startswith("no orbit is found beyond: the family ends there")
    assert 0.49 < family.energies[-1] < 0.5
    for energy, period in zip(family.energies, family.periods, strict=True):
        assert period == pytest.approx(_period(lambda u: u**2 / 2 - (1 - u) ** 2.5 / 10, energy), abs=1e-7)


@pytest.mark.parametrize("k", [-1, 2])
def test_a_section_has_no_orbits_but_its_own(k: int) -> None:
    starts = np.array([[0.0, 0.0], [0.5, 0.2], [1.0, 1.0], [0.0, 0.0]])
    found = poincare_section(LINEAR, (0, 20), starts, "x", method="kahan-li-8", step=0.1)
    assert found.of_orbit(1)[1][0] == pytest.approx(0.2 * np.cos(2 * np.pi * np.sqrt(2)), abs=1e-6)
    with pytest.raises(ValueError, match=f"there are orbits 0 … 1, not {k}"):
        found.of_orbit(k)


def test_sections_without_an_energy_and_without_points_are_told() -> None:
    u, v = sp.symbols("u v", real=True)
    found = poincare_section(VectorField([v, -u], [u, v]), (0, 20), [0.0, 1.0], u, method="gauss-4", step=0.1)
    assert found.t == pytest.approx(2 * np.pi * np.arange(1, 4), abs=1e-8)
    with pytest.raises(ValueError, match="the energy at points of a section is told of Hamiltonians only"):
        _ = found.energy_change
    with pytest.raises(SectionNotMetError, match="no orbit passes x - 5 = 0 between t = 0 and t = 20"):
        poincare_section(LINEAR, (0, 20), [1.0, 0, 0, 0], x - 5, method=Taylor())
