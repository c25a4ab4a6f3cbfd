"""Splittings by solvable parts in every precision: steps against 60 digits, and where errors end."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import sympy as sp

from canon.flow.method.method import Taylor
from canon.flow.method.number_formats import FIXED, unit_round_off
from canon.flow.method.solvable_splitting import SABA, WisdomHolman
from canon.flow.propagation import propagate
from canon.kernel.solvable.planet_coordinates import heliocentric_coordinates, jacobi_coordinates
from tests.flow.systems import HENON_HEILES, KEPLER, System, kepler_start
from tests.flow.test_solvable import planets
from tests.kernel.test_kepler import true_increments

DIGITS = 60
FLOORS = {name: unit_round_off(name) for name in FIXED}
STEP = 0.25


def as_single(values):
    """Numbers that every precision holds."""
    return np.float32(values).astype(float).tolist()


def exact_start():
    """A star of mass 1, planets of 1/64, 1/32 and 1/128: exact in every precision."""
    system = planets("1/64", star=1)[0]
    masses = [Fraction(1), Fraction(1, 64), Fraction(1, 192), Fraction(1, 128)]
    places = [[0, 0, 0], [1, 0.125, 0.0625], [-1.5, 0.75, 0.125], [1, -2.5, 0]]
    speeds = [[0.0625, 0, 0], [-0.125, 1, 0], [-0.25, -0.625, 0.125], [0.5, 0.25, -0.0625]]
    momenta = [[float(m) * s for s in row] for m, row in zip(masses, speeds, strict=True)]
    return system, masses, as_single([*np.ravel(places), *np.ravel(momenta)])


def product(matrix, rows):
    return [
        [
            sum(mpmath.mpf(a.numerator) / a.denominator * r[k] for a, r in zip(row, rows, strict=True))
            for k in range(3)
        ]
        for row in matrix
    ]


def kicks(x, mass, coordinates, t):
    """Changes of places and velocities by H₁, written down from the definitions of the coordinates."""
    n = len(mass)
    chart = (jacobi_coordinates if coordinates == "jacobi" else heliocentric_coordinates)(mass)
    m = [mpmath.mpf(a.numerator) / a.denominator for a in mass]
    bodies = product(chart.places_back, [[0, 0, 0], *x])
    first = 0 if coordinates == "jacobi" else 1
    accelerations = [[mpmath.mpf(0)] * 3 for _ in range(n)]
    for i in range(first, n):
        for j in range(first, n):
            if i != j:
                d = [b - a for a, b in zip(bodies[i], bodies[j], strict=True)]
                cube = mpmath.sqrt(sum(a * a for a in d)) ** 3
                accelerations[i] = [a + m[j] * b / cube for a, b in zip(accelerations[i], d, strict=True)]
    if coordinates != "jacobi":
        return [[t * a for a in row] for row in accelerations[1:]]
    changes = product(chart.velocities, accelerations)
    for i in range(1, n):  # what Kepler's motion does already
        total = sum(m[: i + 1])
        cube = mpmath.sqrt(sum(a * a for a in x[i - 1])) ** 3
        changes[i - 1] = [c + total * a / cube for c, a in zip(changes[i - 1], x[i - 1], strict=True)]
    return [[t * a for a in row] for row in changes]


def wisdom_holman_step(q, p, mass, coordinates, h):
    """One step in 60 digits."""
    chart = (jacobi_coordinates if coordinates == "jacobi" else heliocentric_coordinates)(mass)
    m = [mpmath.mpf(a.numerator) / a.denominator for a in mass]
    v = [[a / b for a in row] for row, b in zip(p, m, strict=True)]
    mean = [[a / sum(mass) for a in mass]]
    (centre,), (drift,) = product(mean, q), product(mean, v)
    x, u = product(chart.places, q), product(chart.velocities, v)

    def flow():
        for i in range(len(x)):
            mu = sum(m[: i + 2]) if coordinates == "jacobi" else m[0]
            moved = true_increments(x[i], u[i], mu, h / 2)
            x[i] = [a + b for a, b in zip(x[i], moved[:3], strict=True)]
            u[i] = [a + b for a, b in zip(u[i], moved[3:], strict=True)]

    flow()
    if coordinates != "jacobi":
        jump = [sum(b * row[k] for b, row in zip(m[1:], u, strict=True)) / m[0] for k in range(3)]
        x = [[a + h * b for a, b in zip(row, jump, strict=True)] for row in x]
    u = [
        [a + b for a, b in zip(row, change, strict=True)]
        for row, change in zip(u, kicks(x, mass, coordinates, h), strict=True)
    ]
    flow()
    centre = [a + h * b for a, b in zip(centre, drift, strict=True)]
    q, v = product(chart.places_back, [centre, *x]), product(chart.velocities_back, [drift, *u])
    return q, [[a * b for a in row] for row, b in zip(v, m, strict=True)]


@pytest.mark.parametrize("coordinates", ["jacobi", "democratic-heliocentric"])
def test_steps_of_planets_are_those_of_sixty_digits(coordinates):
    system, mass, start = exact_start()
    with mpmath.workdps(DIGITS):
        numbers = [[mpmath.mpf(a) for a in row] for row in np.reshape(start, (8, 3)).tolist()]
        q, p = numbers[:4], numbers[4:]
        for _ in range(2):
            q, p = wisdom_holman_step(q, p, mass, coordinates, mpmath.mpf(STEP))
        true = [a for row in (*q, *p) for a in row]
        for precision, floor in FLOORS.items():
            found = propagate(
                system, (0, 2 * STEP), start, method=WisdomHolman(coordinates=coordinates), step=STEP,
                precision=precision, samples=1,
            )  # fmt: skip
            ends = zip(found.y[:, -1].tolist(), found.carried[:, -1].tolist(), true, strict=True)
            miss = max(abs(mpmath.mpf(a) + mpmath.mpf(b) - c) for a, b, c in ends)
            assert miss < 30 * floor, precision
            # And not better than the numbers can be: nothing was computed in wider ones by mistake.
            assert miss > floor / 100, precision


@pytest.mark.parametrize("precision", FIXED)
def test_keplers_motion_ends_at_the_round_off_of_each_precision(precision):
    n = 1_000
    motion = propagate(
        KEPLER, (0, n), kepler_start(0.25), method=WisdomHolman(), step=1.0, precision=precision, samples=20
    )
    error, floor = abs(motion.energy_error).max(), FLOORS[precision]
    # Sums and products of pairs of doubles are not rounded to nearest: 0.4 units a step, always to one side.
    assert error < (n if precision == "double-double" else 12 * n**0.5) * floor
    assert error > 0.02 * n**0.5 * floor


@pytest.mark.parametrize("precision", FIXED)
def test_the_harmonic_oscillator_ends_at_the_round_off_of_each_precision(precision):
    x, y = HENON_HEILES.q
    oscillator = System(
        sum(p**2 for p in HENON_HEILES.p) / 2 + x**2 / 2 + 2 * y**2 + x * y / 4, (x, y), HENON_HEILES.p
    )
    n = 1_000
    motion = propagate(
        oscillator, (0, n), [1.0, 0.5, 0.0, 0.25], method=SABA(1), step=1.0, precision=precision, samples=20
    )
    # Rounding is a function of a state that returns: a drift. Compensated, it is carried along in full.
    bound = n**0.5 / 100 if precision == "compensated" else n
    assert abs(motion.energy_error).max() < bound * FLOORS[precision]


@pytest.mark.parametrize("precision", ["extended", "double-double"])
def test_orders_go_on_below_doubles(precision):
    system, _, start = exact_start()
    method = SABA("10-6-4")
    errors = [
        abs(
            propagate(
                system, (0, 2), start, method=method, step=h, precision=precision, samples=8
            ).energy_change
        ).max()
        for h in (1 / 8, 1 / 16)
    ]
    # ε³ τ⁴ is what remains for masses of 1/64.
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.3)
    assert errors[1] < 1e-18


def test_planets_in_extended_numbers_agree_with_heyoka_in_quadruple():
    system, _, start = exact_start()
    true = propagate(system, (0, 2), start, method=Taylor(), precision="quad", samples=1)
    found = propagate(
        system, (0, 2), start, method=SABA("10-6-4"), step=1 / 128, precision="extended", samples=1
    )
    high, low = found.y[:, -1] - true.y[:, -1], found.carried[:, -1] - true.carried[:, -1]
    assert abs(high + low).max() < 2e-18


@pytest.mark.parametrize("precision", ["extended", "double-double", "single"])
def test_the_motion_does_not_depend_on_where_it_is_looked_at(precision):
    system, _, start = exact_start()
    arguments = {"method": WisdomHolman(corrector=5), "step": 0.125, "precision": precision}
    once, often = (propagate(system, (0, 4), start, samples=n, **arguments) for n in (1, 16))
    np.testing.assert_array_equal(once.y[:, -1], often.y[:, -1])
    np.testing.assert_array_equal(once.carried[:, -1], often.carried[:, -1])


def test_an_ensemble_gives_the_bits_of_single_orbits():
    starts = np.array([kepler_start(e) for e in (0.125, 0.5, 0.75)]).T
    arguments = {"method": SABA(2), "step": 0.5, "samples": 1, "precision": "extended"}
    together = propagate(KEPLER, (0, 10), starts, **arguments)
    for k in range(3):
        alone = propagate(KEPLER, (0, 10), starts[:, k], **arguments)
        np.testing.assert_array_equal(together.final[:, k], alone.final)


def test_commutators_in_double_double():
    x, y = HENON_HEILES.q
    small = System(
        HENON_HEILES.H - sp.Rational(63, 64) * (x**2 * y - y**3 / 3), HENON_HEILES.q, HENON_HEILES.p
    )
    errors = [
        abs(
            propagate(
                small, (0, 8), [0.125, 0.25, 0.25, 0.125], method=SABA(8, commutator=True), step=h, samples=16,
                precision="double-double",
            ).energy_change
        ).max()
        for h in (1 / 16, 1 / 32)
    ]  # fmt: skip
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.1)
    assert errors[1] < 1e-12
