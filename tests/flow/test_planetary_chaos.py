"""Chaos among planets by the derivative of Wisdom and Holman's steps: MEGNO, exponents in pairs, heyoka's beside."""

import functools

import numpy as np
import pytest
import sympy as sp

from canon import SABA, Hamiltonian, Taylor, WisdomHolman, coordinates, propagate
from canon.flow import (
    Regularity,
    fast_lyapunov_indicator,
    gali,
    largest_lyapunov_exponent,
    lyapunov_spectrum,
    megno,
    sali,
)
from canon.flow.geometry.flow_jacobian import flow_jacobian
from canon.flow.request import Request
from canon.flow.system_request import any_task
from canon.flow.tangent.deviation_growth import deviation_growth
from tests.flow.systems import HENON_HEILES, KEPLER, kepler_start
from tests.flow.test_tangent_maps import task_of

PERIOD = 2 * np.pi
MASSES = (1, sp.Rational(1, 10**4), sp.Rational(1, 10**4))
PLACES = [tuple(coordinates(f"x{i} y{i}")) for i in range(3)]
FLAT = [s for place in PLACES for s in place]


def two_planets():
    """A star and two planets of 10⁻⁴ of its mass, in a plane."""
    kinetic = sum(s.momentum**2 / (2 * m) for place, m in zip(PLACES, MASSES, strict=True) for s in place)
    potential = -sum(
        MASSES[i] * MASSES[j] / sp.sqrt(sum((a - b) ** 2 for a, b in zip(PLACES[i], PLACES[j], strict=True)))
        for j in range(3)
        for i in range(j)
    )
    return Hamiltonian(kinetic + potential, FLAT, [s.momentum for s in FLAT])


def start(second, eccentricity):
    """The first planet at 1, the second at another distance, both at their pericentres, 2.5 rad apart."""
    q, p = [[0.0, 0.0]], [[0.0, 0.0]]
    for m, a, angle in zip(MASSES[1:], (1, second), (0.0, 2.5), strict=True):
        r, m = a * (1 - eccentricity), float(m)
        speed = np.sqrt((1 + m) / a * (1 + eccentricity) / (1 - eccentricity))
        q.append([r * np.cos(angle), r * np.sin(angle)])
        p.append([-m * speed * np.sin(angle), m * speed * np.cos(angle)])
    p[0] = list(-np.sum(p[1:], axis=0))
    return np.array([*np.ravel(q), *np.ravel(p)])


PLANETS = two_planets()
REGULAR, CHAOTIC = start(1.6, 0.02), start(1.25, 0.05)


def test_megno_of_planets_far_apart_is_2_and_grows_where_resonances_overlap():
    """J. Wisdom, Astron. J. 85 (1980) 1122: they overlap up to 1.3 µ^(2/7) = 0.11 of circles, farther of ellipses."""
    both = np.array([REGULAR, CHAOTIC]).T
    found = megno(PLANETS, (0, 5000 * PERIOD), both, method=WisdomHolman(), step=0.2, samples=1000)
    assert list(found.verdict) == [Regularity.REGULAR, Regularity.CHAOTIC]
    assert found.value[0] == pytest.approx(2, abs=0.05)
    assert found.value[1] > 50


def test_a_deviation_along_the_orbit_of_light_planets_shows_nothing() -> None:
    """It is given as one of (q, p); heavy and light bodies are weighed for its length."""
    system = any_task(Request(PLANETS, (0, 1), REGULAR, method=WisdomHolman(), step=0.1))[0].system
    rates = system.graph.evaluate(system.rates, dict(zip(system.inputs, (*REGULAR, 0.0), strict=True)))
    how = {"method": WisdomHolman(), "step": 0.05, "samples": 200}
    along, across = (
        fast_lyapunov_indicator(PLANETS, (0, 20 * PERIOD), REGULAR, deviation=each, **how).value
        for each in (rates, rates[::-1])
    )
    assert along < 0.1
    assert across > 2


@pytest.mark.slow
@pytest.mark.parametrize(
    "method",
    [WisdomHolman(corrector=5), WisdomHolman(coordinates="democratic-heliocentric"), SABA(4), Taylor()],
    ids=str,
)
def test_the_exponent_of_the_chaotic_ones_is_heyoka_s(method):
    how = {} if method == Taylor() else {"step": 0.1}
    found = largest_lyapunov_exponent(PLANETS, (0, 3000 * PERIOD), CHAOTIC, method=method, **how)
    heyoka = largest_lyapunov_exponent(PLANETS, (0, 3000 * PERIOD), start(1.2501, 0.05), method=Taylor())
    assert found.verdict is Regularity.CHAOTIC
    assert abs(found.largest - heyoka.largest) < 2.5 * np.hypot(found.errors[0], heyoka.errors[0])
    assert found.largest > 3 * found.errors[0]


@pytest.mark.slow
@pytest.mark.parametrize("y0", [REGULAR, CHAOTIC], ids=["regular", "chaotic"])
def test_deviations_grow_as_heyoka_has_it(y0):
    deviation = np.random.default_rng(4).normal(size=12) * [*[1.0] * 6, *[1e-4] * 6]
    ends = []
    for method, how in ((SABA(4), {"step": 0.005}), (Taylor(), {})):
        M = flow_jacobian(PLANETS, (0, 30 * PERIOD), y0, method=method, **how).final
        ends.append(M @ deviation)
    np.testing.assert_allclose(ends[0], ends[1], rtol=1e-6, atol=1e-6 * abs(ends[1]).max())


@pytest.mark.slow
def test_exponents_come_in_pairs_and_many_orbits_are_the_single_ones():
    how = {"method": WisdomHolman(), "step": 0.1, "samples": 100}
    found = lyapunov_spectrum(PLANETS, (0, 500 * PERIOD), CHAOTIC, **how)
    assert found.pairing_defect < 1e-12
    # The centre of mass, two values of it in the plane, the energy and the angular momentum: eight that vanish.
    assert abs(found.exponents[2:10]).max() < 0.1 * found.largest
    both = lyapunov_spectrum(PLANETS, (0, 500 * PERIOD), np.array([REGULAR, CHAOTIC]).T, **how)
    np.testing.assert_allclose(both.exponents[:2, 1], found.exponents[:2], rtol=1e-3)
    assert both.largest[0] < 0.1 * both.largest[1]


@pytest.mark.slow
def test_the_orbit_is_propagate_s_and_the_direction_may_be_given():
    how = {"method": SABA(2), "step": 0.1}
    deviation = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, *[0.0] * 6]
    task = task_of(PLANETS, CHAOTIC, SABA(2), 0.1, span=40.0)
    grown = deviation_growth(task, np.array(deviation)[:, np.newaxis], orthogonal=False, given=True)
    motion = propagate(PLANETS, (0, 40), CHAOTIC, samples=1, **how)
    np.testing.assert_array_equal(grown.states[:, 0], motion.y[:, -1])
    M = flow_jacobian(PLANETS, (0, 40), CHAOTIC, **how).final
    # √(mω) nearly, as powers of 2, ω a radian in three steps.
    roots = 2.0 ** np.round(np.log2(np.repeat([float(m) for m in MASSES], 2) / 0.3) / 2)
    weights = np.array([*roots, *1 / roots])
    length = np.linalg.norm(weights * (M @ deviation)) / np.linalg.norm(weights * deviation)
    assert grown.log[0, -1, 0] == pytest.approx(np.log(length), abs=1e-12)


@pytest.mark.slow
def test_alignment_tells_the_two_apart():
    how = {"method": WisdomHolman(), "step": 0.2, "samples": 200}
    both = np.array([REGULAR, CHAOTIC]).T
    for indicator in (sali, functools.partial(gali, vectors=3)):
        found = indicator(PLANETS, (0, 3000 * PERIOD), both, **how)
        assert list(found.verdict) == [Regularity.REGULAR, Regularity.CHAOTIC]


@pytest.mark.slow
def test_other_solvable_parts_carry_deviations_too():
    how = {"method": SABA(4), "step": 0.2}
    for start_of, verdict in (([0, 0.1, 0.38384, 0.1], "regular"), ([0, -0.25, 0.42081, 0], "chaotic")):
        assert megno(HENON_HEILES, (0, 3000), start_of, **how).verdict.value == verdict
    kepler = megno(KEPLER, (0, 3000), kepler_start(0.3), method=WisdomHolman(), step=1.0)
    assert kepler.verdict is Regularity.REGULAR
    assert kepler.value == pytest.approx(2, abs=0.1)


def test_what_is_given_wrong_is_told():
    how = {"method": WisdomHolman(), "step": 0.1}
    with pytest.raises(ValueError, match="deviations are moved in doubles"):
        megno(PLANETS, (0, 100), REGULAR, precision="extended", **how)
    with pytest.raises(ValueError, match="deviation vector 0 is zero"):
        megno(PLANETS, (0, 100), REGULAR, deviation=[0.0] * 12, **how)
    with pytest.raises(ValueError, match="vectors=13: the system has exponents 1 … 12"):
        lyapunov_spectrum(PLANETS, (0, 100), REGULAR, vectors=13, **how)
