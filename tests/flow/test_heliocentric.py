"""Democratic heliocentric coordinates: orders, geometry, crossing orbits, and agreement with Jacobi's and heyoka."""

import itertools

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, coordinates
from canon.flow.method.method import Splitting, Taylor
from canon.flow.method.solvable_splitting import SABA, SBAB, WisdomHolman
from canon.flow.propagation import propagate
from canon.kernel.solvable.kepler_terms import UnsolvableError
from tests.flow.systems import KEPLER, System, kepler_start
from tests.flow.test_geometry import compiled_jacobian, there_and_back
from tests.flow.test_solvable import (
    MIDDLE,
    PLACES,
    SHORT,
    energy_errors,
    energy_slope,
    planets,
    planets_start,
)

DEMOCRATIC = {"coordinates": "democratic-heliocentric"}
METHODS = [
    WisdomHolman(**DEMOCRATIC),
    WisdomHolman(corrector=5, **DEMOCRATIC),
    SABA(3, **DEMOCRATIC),
    SBAB(2, **DEMOCRATIC),
    SABA("8-6-4", **DEMOCRATIC),
]
FIRST = [*METHODS[:2], *(pytest.param(method, marks=pytest.mark.slow) for method in METHODS[2:])]


@pytest.mark.parametrize(
    ("method", "epsilon", "steps", "order"),
    [
        (WisdomHolman(**DEMOCRATIC), "1e-6", SHORT, 2),
        (SABA(2, **DEMOCRATIC), "1e-6", SHORT, 4),
        (SBAB(2, **DEMOCRATIC), "1e-6", SHORT, 4),
        (SABA(3, **DEMOCRATIC), "1e-6", MIDDLE, 6),
        (WisdomHolman(corrector=5, **DEMOCRATIC), "1e-6", SHORT, 6),
        (SABA(3, **DEMOCRATIC), "1e-2", SHORT, 2),
    ],
    ids=str,
)
def test_orders(method, epsilon, steps, order):
    assert energy_slope(epsilon, method, steps) == pytest.approx(order, abs=0.6 if order == 6 else 0.2)


def test_the_schemes_of_blanes_and_others_remove_the_square():
    at = [
        energy_errors("1e-2", method, (0.3,))[0]
        for method in (SABA(4, **DEMOCRATIC), SABA("8-6-4", **DEMOCRATIC))
    ]
    assert at[1] < at[0] / 1000


def test_errors_grow_as_the_perturbation_and_as_its_square():
    linear = [energy_errors(epsilon, SABA(2, **DEMOCRATIC), (0.24,))[0] for epsilon in ("1e-6", "1e-5")]
    assert np.diff(np.log10(linear)) == pytest.approx(2, abs=0.05)
    square = [energy_errors(epsilon, SABA(4, **DEMOCRATIC), (0.2,))[0] for epsilon in ("1e-4", "1e-3")]
    assert np.diff(np.log10(square)) == pytest.approx(3, abs=0.1)


@pytest.mark.parametrize("method", FIRST, ids=str)
def test_the_discrete_map_is_symplectic(method):
    system, masses = planets("0.5")
    m = compiled_jacobian(system, planets_start(masses), method, 0.2, delta=2.0**-8)
    j = np.kron([[0, 1], [-1, 0]], np.eye(len(m) // 2))
    assert abs(m.T @ j @ m - j).max() < 2e-10


@pytest.mark.parametrize("method", FIRST, ids=str)
def test_time_reversal(method):
    system, masses = planets("1e-2")
    bound = 1e-5 if method.corrector else 1e-12
    assert there_and_back(system, planets_start(masses), method, 30, 0.2) < bound


def test_ten_orbits_agree_with_heyoka_to_13_digits():
    system, masses = planets("1e-3")
    start, span = planets_start(masses), (0, 20 * np.pi)
    true = propagate(system, span, start, method=Taylor(), precision="extended", samples=1).final
    found = propagate(system, span, start, method=SABA("8-6-4", **DEMOCRATIC), step=0.05, samples=1).final
    scale = np.array([*[3.0] * 12, *[max(m, 1e-3) for m in np.repeat(masses, 3)]])
    assert abs((found - true) / scale).max() < 1e-13


def test_momentum_angular_momentum_and_the_centre_of_mass():
    system, masses = planets("1e-2")
    x, p = [place[0] for place in PLACES], [place[0].momentum for place in PLACES]
    centre = sum(sp.Float(m) * a for m, a in zip(masses, x, strict=True))
    spin = sum(x * y.momentum - y * x.momentum for x, y, _ in PLACES)
    motion = propagate(
        system, (0, 50), planets_start(masses), method=WisdomHolman(**DEMOCRATIC), step=0.1, samples=50,
        observables={"P": sum(p), "C": centre, "L": spin},
    )  # fmt: skip
    assert abs(motion.energy_change).max() > 1e-9
    assert abs(motion.changes["P"]).max() < 1e-17
    assert abs(motion.changes["L"]).max() < 1e-15
    np.testing.assert_allclose(motion.changes["C"], motion.observables["P"][0] * motion.t, atol=1e-14)


def test_seventeen_planets_fill_no_power_of_two_lanes():
    """Twenty-four lanes hold them; in Jacobi's coordinates, which need no sum over all, they move as well."""
    count = 17
    q = coordinates(" ".join(f"x{k} y{k}" for k in range(count + 1)))
    places, masses = (
        list(zip(q[::2], q[1::2], strict=True)),
        [1, *(sp.Rational(k, 10**8) for k in range(1, 18))],
    )
    pairs = itertools.combinations(zip(places, masses, strict=True), 2)
    H = Hamiltonian(
        sp.Add(
            *((x.momentum**2 + y.momentum**2) / (2 * m) for (x, y), m in zip(places, masses, strict=True)),
            *(-m * n / sp.sqrt((x - u) ** 2 + (y - v) ** 2) for ((x, y), m), ((u, v), n) in pairs),
        ),
        q, [s.momentum for s in q],
    )  # fmt: skip
    r, angle = 1 + 0.5 * np.arange(count), 2.4 * np.arange(count)
    place = r * np.exp(1j * angle)
    momentum = 1j * np.exp(1j * angle) / np.sqrt(r) * np.array(masses[1:], dtype=float)
    start = np.concatenate([[0, 0], place.view(float), [0, 0], momentum.view(float)])
    ends = [
        propagate(H, (0, 10), start, method=WisdomHolman(**how), step=0.05, samples=1).y[: 2 * count + 2, -1]
        for how in ({}, DEMOCRATIC)
    ]
    assert 0 < abs(ends[0] - ends[1]).max() < 1e-9  # of 1e-6, if one planet's share were left out of the sum


def test_the_order_of_the_planets_does_not_matter():
    system, masses = planets("1e-2")
    start = np.reshape(planets_start(masses), (2, 4, 3))
    order = [0, 3, 1, 2]
    turned = System(
        system.H.subs({s: t for a, b in zip(PLACES, order, strict=True) for s, t in zip(a, PLACES[b], strict=True)},
                      simultaneous=True)
        .subs({s.momentum: t.momentum for a, b in zip(PLACES, order, strict=True)
               for s, t in zip(a, PLACES[b], strict=True)}, simultaneous=True),
        system.q, system.p,
    )  # fmt: skip
    place = np.argsort(order)
    # Jacobi's coordinates with the bodies out of order are others, democratic ones the same.
    for method, agree in ((SABA(2, **DEMOCRATIC), True), (SABA(2), False)):
        ends = []
        for H, y in ((system, start), (turned, start[:, place])):
            found = propagate(H, (0, 30), y.ravel(), method=method, step=0.3, samples=1).final.reshape(
                2, 4, 3
            )
            ends.append(found if H is system else found[:, order])
        assert (abs(ends[0] - ends[1]).max() < 1e-13) == agree


@pytest.mark.parametrize("count", [1, 2, 5, 19])
def test_any_number_of_planets_in_both_coordinates(count):
    # Seventeen and more fill registers of 24 lanes, no power of two.
    rng = np.random.default_rng(count)
    places = [sp.symbols(f"x{i} y{i}", real=True) for i in range(count + 1)]
    momenta = [sp.symbols(f"u{i} v{i}", real=True) for i in range(count + 1)]
    m = [sp.Integer(1), *(sp.Rational(int(k), 10**7) for k in rng.integers(1, 100, count))]
    H = sum(p**2 / (2 * a) for a, pair in zip(m, momenta, strict=True) for p in pair) - sum(
        m[i] * m[j] / sp.sqrt(sum((a - b) ** 2 for a, b in zip(places[i], places[j], strict=True)))
        for j in range(count + 1)
        for i in range(j)
    )
    system = System(H, tuple(s for pair in places for s in pair), tuple(s for pair in momenta for s in pair))
    angles, radii = rng.uniform(0, 2 * np.pi, count), 1.5 ** np.arange(count)
    z = radii * np.exp(1j * angles)
    speeds = 1j * radii**-0.5 * np.exp(1j * angles) * np.array([float(a) for a in m[1:]])
    start = [0, 0, *np.ravel([z.real, z.imag], "F"), 0, 0, *np.ravel([speeds.real, speeds.imag], "F")]
    true = propagate(
        system, (0, 1), start, method=Splitting("sofroniou-spaletta-10"), step=1 / 64, samples=1
    ).final
    for chart in ("jacobi", "democratic-heliocentric"):
        method = SABA("10-6-4", coordinates=chart)
        found = propagate(system, (0, 1), start, method=method, step=0.125, samples=1).final
        assert abs(found - true).max() < 3e-13 * abs(true).max()


def test_what_is_no_planetary_system_is_refused():
    with pytest.raises(UnsolvableError, match="planets about a star"):
        propagate(KEPLER, (0, 1), kepler_start(0.1), method=WisdomHolman(**DEMOCRATIC), step=0.1)
    with pytest.raises(ValueError, match="'jacobi' and 'democratic-heliocentric'"):
        WisdomHolman(coordinates="barycentric")


def test_they_say_what_they_are():
    assert str(SABA(2, **DEMOCRATIC)) == "saba-2, democratic-heliocentric"
    assert SABA(2, **DEMOCRATIC) != SABA(2)
    assert "doi:10.1086/300541" in SABA(2, **DEMOCRATIC).citation
    assert "Symplectic correctors" in WisdomHolman(corrector=5).citation
    assert WisdomHolman(commutator=True).citation.count("doi:") == 2
    assert SABA(2, commutator=True).citation == SABA(2).citation
