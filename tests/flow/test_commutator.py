"""Kicks that hold the commutator {H₁, {H₀, H₁}}: what was ε² τ² becomes ε² τ⁴, fitted in the step and in ε."""

import dataclasses

import numpy as np
import pytest
import sympy as sp

from canon.flow.method.solvable_splitting import SABA, SBAB, SolvableSplitting, WisdomHolman
from canon.flow.propagation import propagate
from canon.kernel.schemes.perturbed_schemes import saba, with_commutator
from tests.flow.systems import HENON_HEILES, HENON_HEILES_START, KEPLER, System, kepler_start
from tests.flow.test_geometry import compiled_jacobian, there_and_back
from tests.flow.test_solvable import MIDDLE, SHORT, energy_errors, energy_slope, planets, planets_start

METHODS = [
    SABA(2, commutator=True),
    SABA(4, commutator=True),
    SBAB(2, commutator=True),
    SBAB(3, commutator=True),
    WisdomHolman(corrector=5, commutator=True),
]
FIRST = [*METHODS[:2], *(pytest.param(method, marks=pytest.mark.slow) for method in METHODS[2:])]


def without(method):
    return SolvableSplitting(method.scheme, method.corrector)


@pytest.mark.parametrize(
    ("method", "epsilon", "steps"),
    [
        (SABA(3, commutator=True), "1e-2", SHORT),
        (SABA(4, commutator=True), "1e-2", MIDDLE),
        (SBAB(3, commutator=True), "1e-2", SHORT),
        (WisdomHolman(corrector=7, commutator=True), "1e-2", SHORT),
    ],
    ids=str,
)
def test_what_is_quadratic_in_the_perturbation_has_the_fourth_power_of_the_step(method, epsilon, steps):
    assert energy_slope(epsilon, without(method), steps) == pytest.approx(2, abs=0.2)
    assert energy_slope(epsilon, method, steps) == pytest.approx(4, abs=0.35)


def test_it_remains_quadratic_in_the_perturbation():
    # A planet's own energy is ∝ ε: errors ε · ε² τ⁴, and ε · ε τ^2n where that is larger.
    square = [energy_errors(epsilon, SABA(4, commutator=True), (0.3,))[0] for epsilon in ("1e-4", "1e-3")]
    assert np.diff(np.log10(square)) == pytest.approx(3, abs=0.1)
    linear = [energy_errors(epsilon, SABA(2, commutator=True), (0.24,))[0] for epsilon in ("1e-6", "1e-5")]
    assert np.diff(np.log10(linear)) == pytest.approx(2, abs=0.02)


@pytest.mark.parametrize("method", FIRST, ids=str)
def test_errors_are_smaller_than_without(method):
    with_it, plain = (energy_errors("1e-2", each, (0.12,))[0] for each in (method, without(method)))
    assert with_it < plain / 10


def test_the_wrong_sign_is_noticed():
    right = with_commutator(saba(3))
    wrong = SolvableSplitting(dataclasses.replace(right, commutators=tuple(-c for c in right.commutators)))
    assert energy_slope("1e-2", SolvableSplitting(right), SHORT) == pytest.approx(4, abs=0.35)
    assert energy_slope("1e-2", wrong, SHORT) == pytest.approx(2, abs=0.2)
    # The weight of the map without a corrector does not do for one with.
    uncorrected = SolvableSplitting(with_commutator(saba(1)), corrector=7)
    assert energy_slope("1e-2", uncorrected, SHORT) == pytest.approx(2, abs=0.2)


@pytest.mark.parametrize("method", FIRST, ids=str)
def test_the_discrete_map_is_symplectic(method):
    system, masses = planets("0.5")
    m = compiled_jacobian(system, planets_start(masses), method, 0.2, delta=2.0**-8)
    j = np.kron([[0, 1], [-1, 0]], np.eye(len(m) // 2))
    assert abs(m.T @ j @ m - j).max() < 2e-10


@pytest.mark.parametrize("method", [m for m in METHODS if not m.corrector], ids=str)
def test_time_reversal(method):
    system, masses = planets("1e-2")
    assert there_and_back(system, planets_start(masses), method, 30, 0.2) < 1e-12
    assert there_and_back(HENON_HEILES, HENON_HEILES_START, method, 30, 0.2) < 1e-13


def test_the_motion_does_not_depend_on_where_it_is_looked_at():
    system, masses = planets("1e-2")
    arguments = {"method": SABA(3, commutator=True), "step": 0.1, "t_span": (0, 20)}
    once, often = (propagate(system, y0=planets_start(masses), samples=n, **arguments) for n in (1, 50))
    np.testing.assert_array_equal(once.final, often.final)


def slope(system, start, method, steps, span=30):
    errors = [
        abs(propagate(system, (0, span), start, method=method, step=h, samples=200).energy_change).max()
        for h in steps
    ]
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize("family", [SABA, SBAB])
def test_quadratic_parts_with_a_large_cubic_one(family):
    steps = (0.1, 0.14, 0.2, 0.28)
    assert slope(HENON_HEILES, HENON_HEILES_START, family(3), steps) == pytest.approx(2, abs=0.1)
    assert slope(HENON_HEILES, HENON_HEILES_START, family(3, commutator=True), steps) == pytest.approx(
        4, abs=0.1
    )


def test_quadratic_parts_that_mix_momenta():
    # A = ∂²H₀/∂p² is not diagonal here.
    x, y = HENON_HEILES.q
    mixed = System(HENON_HEILES.H + x.momentum * y.momentum / 3 + x * y.momentum / 5, (x, y), HENON_HEILES.p)
    steps = (0.1, 0.14, 0.2, 0.28)
    assert slope(mixed, HENON_HEILES_START, SABA(3), steps) == pytest.approx(2, abs=0.1)
    assert slope(mixed, HENON_HEILES_START, SABA(3, commutator=True), steps) == pytest.approx(4, abs=0.1)


def test_a_perturbed_centre():
    x, y = KEPLER.q
    mass = 3
    oblate = System(
        (x.momentum**2 + y.momentum**2) / (2 * mass)
        - mass / sp.sqrt(x**2 + y**2)
        - sp.Rational(mass, 100) / sp.sqrt(x**2 + y**2) ** 3,
        (x, y),
        KEPLER.p,
    )
    start = [*kepler_start(0.1)[:2], *(mass * p for p in kepler_start(0.1)[2:])]
    steps = (0.1, 0.14, 0.2, 0.28)
    assert slope(oblate, start, SABA(4), steps) == pytest.approx(2, abs=0.15)
    assert slope(oblate, start, SABA(4, commutator=True), steps) == pytest.approx(4, abs=0.2)


def test_what_has_no_such_commutator_is_refused():
    with pytest.raises(ValueError, match="no ε² τ²"):
        SABA("8-6-4", commutator=True)
    with pytest.raises(ValueError, match="star's momentum"):
        SABA(2, commutator=True, coordinates="democratic-heliocentric")


def test_they_say_what_they_are():
    assert str(SABA(3, commutator=True)) == "saba-3, commutator"
    assert [SABA(3, commutator=True).stages, SBAB(3, commutator=True).stages] == [4, 3]
    assert SABA(3, commutator=True) != SABA(3)
