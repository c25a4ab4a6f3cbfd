"""Splittings by exactly solvable parts: orders in the step and in the perturbation, geometry, and what is refused."""

import numpy as np
import pytest
import sympy as sp

from canon.expression.symbols.symbol import coordinates
from canon.flow.method.method import RK4, Splitting, Taylor
from canon.flow.method.solvable_splitting import SABA, SBAB, WisdomHolman
from canon.flow.propagation import propagate
from canon.kernel.solvable.kepler_terms import UnsolvableError
from tests.flow.systems import (
    DRIVEN,
    HENON_HEILES,
    HENON_HEILES_START,
    KEPLER,
    System,
    kepler_start,
)
from tests.flow.test_geometry import compiled_jacobian, kepler_orbit, there_and_back
from tests.flow.test_order import fitted_order

PLACES = [tuple(coordinates(f"x{i} y{i} z{i}")) for i in range(4)]
RADII = (1.0, 1.8, 3.1)


def planets(epsilon, star=1):
    """A star and three planets of masses ε · m."""
    m = [sp.sympify(star), *(sp.Rational(str(epsilon)) / part for part in (1, 3, 2))]
    kinetic = sum(x.momentum**2 / (2 * mass) for place, mass in zip(PLACES, m, strict=True) for x in place)
    potential = -sum(
        m[i] * m[j] / sp.sqrt(sum((a - b) ** 2 for a, b in zip(PLACES[i], PLACES[j], strict=True)))
        for j in range(4)
        for i in range(j)
    )
    q = tuple(x for place in PLACES for x in place)
    return System(kinetic + potential, q, tuple(x.momentum for x in q)), [float(mass) for mass in m]


def planets_start(masses):
    """Nearly circular, a little inclined; the star moves so that the centre of mass does, slowly."""
    q, p = [[0.0, 0.0, 0.0]], [[0.01, -0.02, 0.005]]
    for k, (r, m) in enumerate(zip(RADII, masses[1:], strict=True)):
        angle, speed = 2.0 * k, r**-0.5 * (1 + 0.04 * (k + 1))
        q.append([r * np.cos(angle), r * np.sin(angle), 0.03 * r])
        p.append([-m * speed * np.sin(angle), m * speed * np.cos(angle), 0.02 * m * speed])
    return [*np.ravel(q), *np.ravel(p)]


def energy_errors(epsilon, method, steps):
    system, masses = planets(epsilon)
    start = planets_start(masses)
    return np.array(
        [
            abs(propagate(system, (0, 60), start, method=method, step=step, samples=200).energy_change).max()
            for step in steps
        ]
    )


def energy_slope(epsilon, method, steps):
    return np.polyfit(np.log(steps), np.log(energy_errors(epsilon, method, steps)), 1)[0]


SHORT, MIDDLE, LONG = (0.12, 0.15, 0.19, 0.24), (0.22, 0.26, 0.31, 0.36), (0.3, 0.38, 0.48, 0.6)


@pytest.mark.parametrize(
    ("method", "epsilon", "steps", "order"),
    [
        (WisdomHolman(), "1e-6", SHORT, 2),
        (SABA(2), "1e-6", SHORT, 4),
        (SBAB(2), "1e-6", SHORT, 4),
        (SABA(3), "1e-6", MIDDLE, 6),
        (SBAB(3), "1e-6", MIDDLE, 6),
        (WisdomHolman(corrector=3), "1e-4", SHORT, 4),
        (WisdomHolman(corrector=5), "1e-6", SHORT, 6),
        (SABA(2, corrector=5), "1e-6", SHORT, 6),
    ],
    ids=str,
)
def test_small_perturbations_show_the_order_of_what_is_linear_in_them(method, epsilon, steps, order):
    assert energy_slope(epsilon, method, steps) == pytest.approx(order, abs=0.6 if order == 6 else 0.1)


@pytest.mark.parametrize(
    ("method", "epsilon"),
    [(SABA(2), "1e-2"), (SABA(3), "1e-4"), (WisdomHolman(corrector=5), "1e-2")],
    ids=str,
)
def test_large_perturbations_show_the_square_of_the_step(method, epsilon):
    assert energy_slope(epsilon, method, SHORT) == pytest.approx(2, abs=0.2)


def test_errors_grow_as_the_perturbation_and_as_its_square():
    # A planet's own energy is ∝ ε: errors ε · ε τ^2n + ε · ε² τ².
    linear = [energy_errors(epsilon, SABA(2), (0.24,))[0] for epsilon in ("1e-6", "1e-5", "1e-4")]
    assert np.diff(np.log10(linear)) == pytest.approx(2, abs=0.02)
    square = [energy_errors(epsilon, SABA(4), (0.2,))[0] for epsilon in ("1e-4", "1e-3")]
    assert np.diff(np.log10(square)) == pytest.approx(3, abs=0.1)


def test_the_schemes_of_blanes_and_others_remove_the_square():
    assert energy_slope("1e-4", SABA("8-6-4"), LONG) > 7
    at = [energy_errors("1e-2", method, (0.3,))[0] for method in (SABA(4), SABA("8-6-4"), SABA("10-6-4"))]
    assert at[1] < at[0] / 1000
    assert at[2] < at[1] * 2


def test_a_hundred_orbits_agree_with_heyoka():
    system, masses = planets("1e-3")
    start, span = planets_start(masses), (0, 200 * np.pi)
    true = propagate(system, span, start, method=Taylor(), precision="extended", samples=1).final
    found = propagate(system, span, start, method=SABA("8-6-4"), step=0.0625, samples=1).final
    scale = np.array([*[3.0] * 12, *[max(m, 1e-3) for m in np.repeat(masses, 3)]])
    # Of 100 orbits; heyoka in doubles is itself off by 8e-12 here.
    assert abs((found - true) / scale).max() < 1e-12


def test_ten_orbits_agree_with_heyoka_to_13_digits():
    system, masses = planets("1e-3")
    start, span = planets_start(masses), (0, 20 * np.pi)
    true = propagate(system, span, start, method=Taylor(), precision="extended", samples=1).final
    found = propagate(system, span, start, method=SABA("8-6-4"), step=0.05, samples=1).final
    scale = np.array([*[3.0] * 12, *[max(m, 1e-3) for m in np.repeat(masses, 3)]])
    assert abs((found - true) / scale).max() < 1e-13


def test_the_centre_of_mass_moves_evenly_and_momentum_is_kept():
    system, masses = planets("1e-2")
    x, p = [place[0] for place in PLACES], [place[0].momentum for place in PLACES]
    centre = sum(sp.Float(m) * a for m, a in zip(masses, x, strict=True))
    motion = propagate(
        system, (0, 50), planets_start(masses), method=WisdomHolman(), step=0.1, samples=50,
        observables={"P": sum(p), "C": centre},
    )  # fmt: skip
    momentum = motion.observables["P"][0]
    assert abs(motion.changes["P"]).max() < 1e-17
    np.testing.assert_allclose(motion.changes["C"], momentum * motion.t, atol=1e-14)


def test_angular_momentum_is_kept():
    system, masses = planets("1e-2")
    total = sum(x * y.momentum - y * x.momentum for x, y, _ in PLACES)
    motion = propagate(
        system,
        (0, 200),
        planets_start(masses),
        method=SABA(1),
        step=0.3,
        samples=50,
        observables={"L": total},
    )
    assert abs(motion.energy_change).max() > 1e-9
    assert abs(motion.changes["L"]).max() < 1e-15


METHODS = [WisdomHolman(), WisdomHolman(corrector=5), SABA(3), SBAB(2), SABA("8-6-4")]


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_the_discrete_map_is_symplectic(method):
    system, masses = planets("0.5")
    m = compiled_jacobian(system, planets_start(masses), method, 0.2, delta=2.0**-8)
    j = np.kron([[0, 1], [-1, 0]], np.eye(len(m) // 2))
    assert abs(m.T @ j @ m - j).max() < 2e-10


def test_a_method_that_is_not_symplectic_is_told_apart():
    system, masses = planets("0.5")
    m = compiled_jacobian(system, planets_start(masses), RK4(), 0.2, delta=2.0**-8)
    j = np.kron([[0, 1], [-1, 0]], np.eye(len(m) // 2))
    assert abs(m.T @ j @ m - j).max() > 1e-6


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_time_reversal(method):
    system, masses = planets("1e-2")
    # A corrector is even in h up to ε² only.
    bound = 1e-5 if method.corrector else 1e-12
    assert there_and_back(system, planets_start(masses), method, 30, 0.2) < bound
    if not method.corrector:
        assert there_and_back(HENON_HEILES, HENON_HEILES_START, method, 30, 0.2) < 1e-13


@pytest.mark.parametrize("method", [WisdomHolman(corrector=7), SBAB(3)], ids=str)
def test_the_motion_does_not_depend_on_where_it_is_looked_at(method):
    system, masses = planets("1e-2")
    arguments = {"method": method, "step": 0.1, "t_span": (0, 20)}
    once = propagate(system, y0=planets_start(masses), samples=1, **arguments)
    often = propagate(system, y0=planets_start(masses), samples=50, **arguments)
    watched = propagate(system, y0=planets_start(masses), samples=10, cadence=3, **arguments)
    np.testing.assert_array_equal(once.final, often.final)
    np.testing.assert_array_equal(once.final, watched.final)
    assert np.isfinite(watched.statistics["energy"].mean).all()


def test_an_ensemble_gives_the_bits_of_single_orbits():
    starts = np.array([kepler_start(e) for e in (0.1, 0.4, 0.7)]).T
    together = propagate(KEPLER, (0, 10), starts, method=SABA(2), step=0.5, samples=1)
    for k in range(3):
        alone = propagate(KEPLER, (0, 10), starts[:, k], method=SABA(2), step=0.5, samples=1)
        np.testing.assert_array_equal(together.final[:, k], alone.final)


# Kepler's motion and quadratic parts -----------------------------------------------------------------


def test_kepler_alone_is_exact_with_long_steps():
    u, n, starts = 2.0**-53, 628, [kepler_start(0.56 + 0.01 * k) for k in range(8)]
    ends = [propagate(KEPLER, (0, n), start, method=WisdomHolman(), step=1.0, samples=1) for start in starts]
    misses = [
        abs(found.final - kepler_orbit(start, n)).max() for found, start in zip(ends, starts, strict=True)
    ]
    # Where a step passes the pericentre rounding counts v² / 2|E| = (1 + e)/(1 − e) times, here four times.
    assert np.sqrt(np.mean(np.square([found.energy_error[-1] for found in ends]))) < 4 * 5 * u * n**0.5
    assert np.median(misses) < 1e-10


def test_round_off_of_keplers_flow_is_a_random_walk():
    u, n = 2.0**-53, 50_000
    ends = [
        propagate(KEPLER, (0, n), kepler_start(0.2 + 1e-3 * k), method=WisdomHolman(), step=1.0, samples=1)
        for k in range(8)
    ]
    ends = [motion.energy_error[-1] for motion in ends]
    # With Stumpff's series in plain double coefficients the mean is 1.6e-12, 60 u √n.
    assert abs(np.mean(ends)) < 3 * u * n**0.5
    assert np.sqrt(np.mean(np.square(ends))) < 5 * u * n**0.5


def test_round_off_of_short_steps_does_not_drift():
    u, n = 2.0**-53, 200_000
    ends = [
        propagate(
            KEPLER, (0, n / 16), kepler_start(0.02 + 1e-3 * k), method=WisdomHolman(), step=1 / 16, samples=1
        )
        for k in range(8)
    ]
    # With G₂ and G₃ rounded twice at the end of Kepler's equation the mean is 0.18 u √n.
    assert abs(np.mean([motion.energy_error[-1] for motion in ends])) < 0.1 * u * n**0.5


@pytest.mark.parametrize("steps_a_period", [2.3, 5.3])
def test_steps_as_long_as_the_orbit_do_not_drift(steps_a_period):
    # With Stumpff's series broken off at a fifth of a rounding unit the mean is 0.06 and 0.006 u a step.
    u, n, step = 2.0**-53, 1_000_000, 2 * np.pi / steps_a_period
    starts = np.array([kepler_start(0.2 + 1e-3 * k) for k in range(16)]).T
    method = WisdomHolman()
    motion = propagate(KEPLER, (0, n * step), starts, method=method, step=step, samples=100)
    increments = np.diff(motion.energy_error / u, axis=0)
    mean, deviation = increments.mean(), increments.std() / np.sqrt(increments.size)
    assert abs(mean) < 4.5 * deviation
    assert deviation * 100 / n < {2.3: 0.06 / 15, 5.3: 0.006 / 5}[steps_a_period]


def test_a_flyby_is_exact():
    start = [-20.0, 3.0, 1.5, 0.0]
    true = propagate(KEPLER, (0, 40), start, method=Taylor(), precision="extended", samples=1).final
    found = propagate(KEPLER, (0, 40), start, method=WisdomHolman(), step=2.0, samples=1).final
    assert abs(found - true).max() < 1e-13


def test_a_perturbed_centre_has_its_order():
    x, y = KEPLER.q
    oblate = System(KEPLER.H - sp.Rational(1, 10**6) / sp.sqrt(x**2 + y**2) ** 3, KEPLER.q, KEPLER.p)
    start = kepler_start(0.3)
    errors = [
        abs(propagate(oblate, (0, 60), start, method=SABA(2), step=h, samples=400).energy_error).max()
        for h in (0.1, 0.05)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.2)


def test_the_harmonic_oscillator_is_exact_for_any_step():
    x, y = HENON_HEILES.q
    oscillator = System(
        sum(p**2 for p in HENON_HEILES.p) / 2 + x**2 / 2 + 2 * y**2 + x * y / 3, (x, y), HENON_HEILES.p
    )
    motion = propagate(oscillator, (0, 10_000), [1.0, 0.5, 0.0, 0.3], method=SABA(1), step=1.0, samples=20)
    # Far below the rounding unit of the state: its round-off is carried along in full.
    assert abs(motion.energy_error).max() < 1e-18
    true = propagate(oscillator, (0, 100), [1.0, 0.5, 0.0, 0.3], precision="extended", samples=1).final
    found = propagate(oscillator, (0, 100), [1.0, 0.5, 0.0, 0.3], method=SABA(1), step=5.0, samples=1).final
    assert abs(found - true).max() < 1e-14


@pytest.mark.parametrize(
    "name",
    [
        "verlet",
        "srkn-6b",
        *(pytest.param(n, marks=pytest.mark.slow) for n in ("blanes-moan-4", "kahan-li-8")),
    ],
)
def test_named_parts_keep_the_order_of_any_splitting(name):
    x, y = HENON_HEILES.q
    cubic = x**2 * y - y**3 / 3
    method = Splitting(name, parts=(HENON_HEILES.H - cubic, cubic))
    assert fitted_order(HENON_HEILES, HENON_HEILES_START, method) == pytest.approx(method.order, abs=0.4)


def test_a_small_cubic_part_makes_saba_better_than_verlet():
    start = [0.01 * a for a in HENON_HEILES_START]
    error = {
        method: abs(
            propagate(HENON_HEILES, (0, 100), start, method=method, step=0.2, samples=100).energy_error
        ).max()
        for method in (Splitting("verlet"), SABA(1))
    }
    assert error[SABA(1)] < error[Splitting("verlet")] / 50


# what is refused -------------------------------------------------------------------------------------

x, y = KEPLER.q
KINETIC = (x.momentum**2 + y.momentum**2) / 2


@pytest.mark.parametrize(
    ("system", "method", "message"),
    [
        (DRIVEN, SABA(2), "depends on t"),
        (KEPLER, SABA(2, parts=(KINETIC, -2 / sp.sqrt(x**2 + y**2))), "is not H"),
        (KEPLER, SABA(2, parts=(KINETIC - 1 / sp.sqrt(x**2 + y**2), x)), "is not H"),
        (KEPLER, SABA(2, parts=(KINETIC, 1 / sp.sqrt(x**2 + y**2))), "is not H"),
        (KEPLER, SABA(2, parts=(-KINETIC, -1 / sp.sqrt(x**2 + y**2))), "is not H"),
        (KEPLER, SABA(2, parts=(-1 / sp.sqrt(x**2 + y**2), KINETIC)), "p_x"),
        (System(KINETIC + 1 / sp.sqrt(x**2 + y**2), (x, y), KEPLER.p), SABA(2), "repels"),
        (
            System(KINETIC - x.momentum**2 * 2 - 1 / sp.sqrt(x**2 + y**2), (x, y), KEPLER.p),
            SABA(2),
            "positive mass",
        ),
        (
            System(KINETIC * (1 + x**2) - 1 / sp.sqrt(x**2 + y**2), (x, y), KEPLER.p),
            SABA(2),
            "mass|depends on p|alone",
        ),
        (planets("-1e-3")[0], WisdomHolman(), "positive mass"),
        (System(sp.exp(x) + sp.cosh(x.momentum), (x,), (x.momentum,)), SABA(2), "no part that canon solves"),
    ],
)
def test_what_has_no_solvable_part_is_refused(system, method, message):
    y0 = [0.5] * (2 * len(system.q)) if len(system.q) < 3 else list(np.linspace(0.1, 2, 24))
    with pytest.raises(UnsolvableError, match=message):
        propagate(system, (0, 1), y0, method=method, step=0.1)


def test_wrong_methods_are_refused():
    with pytest.raises(ValueError, match="8-6-4"):
        SABA("7-7-7")
    with pytest.raises(ValueError, match="odd orders"):
        WisdomHolman(corrector=4)


def test_methods_are_values():
    assert SABA(2) == SABA(2)
    assert hash(SABA(2, corrector=5)) == hash(SABA(2, corrector=5))
    assert str(SABA(2, corrector=5)) == "saba-2, corrector 5"
    assert all("doi:" in method.citation for method in METHODS)
    assert [SABA(4).stages, SBAB(4).stages, WisdomHolman().stages] == [4, 4, 1]
