"""Hamiltonians that have not the solvable parts that are asked for: what is said, and the nearest that have them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, Splitting, WisdomHolman, coordinates, parameters, propagate, time
from canon.flow import flow_jacobian
from canon.kernel.program.hamilton_equations import equations
from canon.kernel.solvable.kepler_terms import UnsolvableError
from canon.kernel.solvable.solvable_parts import solvable_part

x, y, z, u, v, w = coordinates("x y z u v w")
r = sp.sqrt(x**2 + y**2)
KINETIC = (x.momentum**2 + y.momentum**2) / 2
PARTS = "name other parts"
TWO = r"name two parts, parts=\(H0, H1\)"


def moving(V: Any, *q: Any, masses: Any = None) -> Hamiltonian:
    T = sum(s.momentum**2 / (2 * m) for s, m in zip(q, masses or [1] * len(q), strict=True))
    return Hamiltonian(T + V, list(q), [s.momentum for s in q])


def steps(system: Hamiltonian, method: Any, **how: Any) -> Any:
    start = [1.0, 0.1, 0.4, 0.7, 0.3, 0.8, 0.2, 0.9][: len(system.q)] + [0.1] * len(system.q)
    return propagate(system, (0, 1), start, method=method, step=0.1, **how)


@pytest.mark.parametrize(
    ("V", "first", "said"),
    [
        (
            x**4 / 4,
            KINETIC + x**4 / 4,
            rf"not of second degree in \(q, p\) with constant coefficients; {PARTS}",
        ),
        (x**2 / 2, KINETIC + x, rf"not of second degree in \(q, p\) with constant coefficients; {PARTS}"),
        (
            -1 / r + 1 / (2 + x),
            KINETIC - 1 / r + 1 / (2 + x),
            rf"is not Σ .* motion about centres .*; {PARTS}",
        ),
        (-1 / r, KINETIC + 1 / sp.sqrt(x**2 + 2 * y**2), rf"is not Σ .* motion about centres .*; {PARTS}"),
        (-1 / r, KINETIC + 1 / r, rf"the centre at \(x, y\) repels \(−k/r with k = -1\).*; {PARTS}"),
        (-1 / r, x.momentum**2 / 2, f"a function of q alone, a kick, but it depends on p_y; {PARTS}"),
        (-1 / r, KINETIC - 1 / r + time * x, "."),
    ],
)
def test_first_parts_that_have_no_solution_in_closed_form_are_refused(V: Any, first: Any, said: str) -> None:
    system = moving(V, x, y)
    with pytest.raises(UnsolvableError, match=said):
        steps(system, Splitting("verlet", parts=(first, sp.expand(system.H - first))))


def test_the_parts_beside_those_are_solved() -> None:
    """Where the second part is nothing each step is exact: of an oscillator, and about a centre."""
    swings = moving(x**2 / 2, x, y)
    found = steps(swings, Splitting("verlet", parts=(swings.H, sp.S.Zero)))
    assert found.final == pytest.approx(
        [np.cos(1) + 0.1 * np.sin(1), 0.2, 0.1 * np.cos(1) - np.sin(1), 0.1], abs=1e-14
    )
    centre = moving(-1 / r, x, y)
    exact = propagate(centre, (0, 1), [1.0, 0.1, 0.1, 0.1], samples=1).final
    assert steps(centre, Splitting("verlet", parts=(centre.H, sp.S.Zero))).final == pytest.approx(
        exact, abs=1e-13
    )


@pytest.mark.parametrize(
    "base",
    [
        (x - u) ** 2 + 2 * (y - v) ** 2,
        (x - u) ** 2 + (y - v) ** 2 + 1,
        (x - u) ** 2 + y**2,
        x**2 + u**2 - x * u,
        x**2 + y**2 + u**2 - 2 * x * y - 2 * x * u,
        x**2 - 2 * x * u,
    ],
)
def test_what_is_no_distance_of_two_bodies_is_no_attraction(base: Any) -> None:
    apart = -2 / sp.sqrt((x - u) ** 2 + (y - v) ** 2)
    q, masses = (x, y, u, v), [4, 4, 1, 1]
    assert steps(moving(apart, *q, masses=masses), WisdomHolman()).energy_error.max() < 1e-2
    with pytest.raises(
        UnsolvableError, match=rf"beside kinetic energies and attractions of pairs H holds .*; {TWO}"
    ):
        steps(moving(apart - 1 / sp.sqrt(base), *q, masses=masses), WisdomHolman())


def test_planets_that_nothing_holds_are_refused() -> None:
    def near(a: Any, b: Any) -> Any:
        return -1 / sp.sqrt(sum((c - d) ** 2 for c, d in zip(a, b, strict=True)))

    star, middle, far = (x, y), (z, w), (u, v)
    masses = [9, 9, 2, 2, 1, 1]
    bound = moving(near(star, middle) + near(middle, far), *star, *middle, *far, masses=masses)
    start = [0, 0, 1, 0, 3, 0, 0, -2.1, 0, 1.4, 0, 1.4]
    found = propagate(bound, (0, 1), start, method=WisdomHolman(), step=0.01, samples=1)
    assert found.final == pytest.approx(propagate(bound, (0, 1), start, samples=1).final, abs=1e-4)
    with pytest.raises(
        UnsolvableError, match=f"body 1 is not attracted by the star and the bodies before.*; {TWO}"
    ):
        steps(
            moving(near(star, far) + near(middle, far), *star, *middle, *far, masses=masses), WisdomHolman()
        )
    with pytest.raises(
        UnsolvableError, match=f"attractions of pairs do not group the coordinates into bodies; {TWO}"
    ):
        steps(moving(near(star, far), *star, z, *far), WisdomHolman())


def test_coordinates_without_a_centre_and_bodies_of_different_kinds_are_refused() -> None:
    with pytest.raises(
        UnsolvableError, match=f"every coordinate about one centre: some q are without.*; {PARTS}"
    ):
        steps(moving(-1 / r, x, y, z), WisdomHolman())
    both = -1 / r - 1 / sp.sqrt(z**2 + u**2 + v**2)
    with pytest.raises(
        UnsolvableError, match="the bodies have different numbers of coordinates; give each as many"
    ):
        steps(moving(both, x, y, z, u, v), WisdomHolman())


def test_a_hamiltonian_of_the_time_has_no_solvable_parts() -> None:
    driven = moving(x**2 / 2 - x * sp.cos(time), x)
    known = equations(driven.H, driven.q, driven.p, time, {})
    with pytest.raises(
        UnsolvableError, match=r"H depends on t: splittings by solvable parts are for H\(q, p\)"
    ):
        solvable_part(known)
    with pytest.raises(
        UnsolvableError, match=r"H depends on t: splittings by solvable parts are for H\(q, p\)"
    ):
        steps(driven, WisdomHolman())


def test_parameters_that_differ_by_orbit_are_refused() -> None:
    (k,) = parameters("k,", positive=True)
    with pytest.raises(
        UnsolvableError, match="parameters that differ by orbit: splittings by solvable parts take one"
    ):
        steps(moving(-k / r, x, y), WisdomHolman(), parameters={k: np.array([1.0, 2.0])})


def test_a_step_whose_exponential_is_too_large_is_refused() -> None:
    saddle = moving(-(x**2) / 2, x)
    how = {"method": Splitting("verlet", parts=(saddle.H, sp.S.Zero))}
    found = propagate(saddle, (0, 60), [1e-9, 0.0], step=30, samples=1, **how)
    assert found.final == pytest.approx([1e-9 * np.cosh(60), 1e-9 * np.sinh(60)], rel=1e-13)
    with pytest.raises(
        ArithmeticError, match=r"exp\(tL\) of the quadratic part is not known to 130 bits: take a smaller"
    ):
        propagate(saddle, (0, 600), [1e-9, 0.0], step=300, samples=1, **how)


def test_deviations_of_one_planet_in_heliocentric_coordinates() -> None:
    """By differences of its own steps, and symplectic; no other planet attracts it."""
    V = -3 / sp.sqrt((x - u) ** 2 + (y - v) ** 2)
    system = moving(V, x, y, u, v, masses=[3, 3, 1, 1])
    start = np.array([0.0, 0.0, 1.0, 0.0, 0.1, -1.5, 0.0, 1.6])
    how = {"method": WisdomHolman(coordinates="democratic-heliocentric"), "step": 0.05}
    M = flow_jacobian(system, (0, 1), start, samples=1, **how).final
    J = np.block([[np.zeros((4, 4)), np.eye(4)], [-np.eye(4), np.zeros((4, 4))]])
    np.testing.assert_allclose(M.T @ J @ M, J, atol=1e-12)
    shifts = 1e-5 * np.hstack([np.eye(8), -np.eye(8)])
    ends = propagate(system, (0, 1), start[:, np.newaxis] + shifts, samples=1, **how).final
    assert (ends[:, :8] - ends[:, 8:]) / 2e-5 == pytest.approx(M, abs=1e-8)
