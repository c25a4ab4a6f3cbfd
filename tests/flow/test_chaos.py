"""Lyapunov exponents and indicators of chaos: closed forms, published values, verdicts on orbits that are known."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from canon import (
    RK4,
    Gauss,
    Hamiltonian,
    Lagrangian,
    Splitting,
    Taylor,
    TimeTransformed,
    VectorField,
    coordinates,
    parameters,
    propagate,
    time,
)
from canon.flow import (
    Regularity,
    fast_lyapunov_indicator,
    gali,
    largest_lyapunov_exponent,
    lyapunov_spectrum,
    megno,
    periodic_orbit,
    sali,
)
from canon.flow.chaos.regularity import judged_growth, mean_megno
from canon.flow.run.non_finite_state import NonFiniteStateError
from tests.flow.systems import (
    DOUBLE_PENDULUM,
    DOUBLE_PENDULUM_START,
    HENON_HEILES,
    KEPLER,
    PENDULUM,
    kepler_start,
)

x, y, z = coordinates("x y z")
KAHAN_LI = {"method": Splitting("kahan-li-8"), "step": 0.2}
REGULAR, CHAOTIC = [0.0, 0.1, 0.3838402445462608, 0.1], [0.0, -0.25, 0.4208127057650866, 0.0]
"""Starts of the scene: energy 1/12 on an invariant curve, energy 1/8 in the chaotic sea."""


def hamiltonian(V, *q):
    return Hamiltonian(sum(s.momentum**2 for s in q) / 2 + V, list(q), [s.momentum for s in q])


def on_the_section(energy, y0, p_y=0.0):
    """Hénon and Heiles's start with x = 0 and p_x > 0."""
    return [0.0, y0, float(np.sqrt(2 * energy - p_y**2 - y0**2 + 2 * y0**3 / 3)), p_y]


def test_exponents_of_two_saddles_are_their_rates():
    saddles = hamiltonian(-(x**2) / 2 - 4 * y**2 / 2, x, y)
    found = lyapunov_spectrum(
        saddles, (0, 60), [1e-9, 0, 0, 1e-9], samples=60, method="kahan-li-8", step=0.05
    )
    np.testing.assert_allclose(found.exponents, [2, 1, -1, -2], atol=1e-6)
    assert found.pairing_defect < 1e-13
    assert found.verdict is Regularity.UNSTABLE
    np.testing.assert_allclose(found.errors, 2 / 60, rtol=1e-6)


@pytest.mark.parametrize("mass", [1e-9, 1.0, 1e6, 1e12])
def test_exponents_do_not_depend_on_the_unit_of_mass(mass):
    """Deviations of which momenta are 10⁹ times the coordinates are not told apart by their plain lengths."""
    m = sp.Rational(mass)
    p, r = x.momentum, y.momentum
    H = Hamiltonian((p**2 + r**2) / (2 * m) - m * x**2 / 2 - 2 * m * y**2, [x, y], [p, r])
    found = lyapunov_spectrum(H, (0, 40), [1e-9, 0, 0, 1e-9 * mass], samples=40)
    np.testing.assert_allclose(found.exponents, [2, 1, -1, -2], atol=1e-2)


def test_a_chaotic_and_a_regular_orbit_are_told_apart_by_every_indicator():
    starts = np.array([REGULAR, CHAOTIC]).T
    wanted = [Regularity.REGULAR, Regularity.CHAOTIC]
    both = lyapunov_spectrum(HENON_HEILES, (0, 3000), starts, **KAHAN_LI)
    assert list(both.verdict) == wanted
    assert (both.pairing_defect < 1e-13).all()
    assert both.largest[0] < both.detection_limit < both.largest[1]
    assert abs(both.largest[1] - 0.05) < 0.02
    for indicator in (megno, fast_lyapunov_indicator, sali):
        assert list(indicator(HENON_HEILES, (0, 3000), starts, **KAHAN_LI).verdict) == wanted
    assert list(gali(HENON_HEILES, (0, 3000), starts, vectors=3, **KAHAN_LI).verdict) == wanted


def test_megno_of_growth_that_is_known():
    how = {"method": Splitting("kahan-li-8"), "step": 0.05, "samples": 400}
    assert megno(KEPLER, (0, 3000), kepler_start(0.3), **how).value == pytest.approx(2, abs=0.1)
    # Even samples would see one place of each period, which drifts: the growth of a power was seen as none.
    assert megno("kepler", (0, 1000), method="kahan-li-8", step=0.01).value == pytest.approx(2, abs=0.1)
    linear = hamiltonian(x**2 / 2 + y**2, x, y)
    oscillators = megno(linear, (0, 600), [1, 0.5, 0, 0.2], **how)
    assert abs(oscillators.value) < 0.05
    assert oscillators.verdict is Regularity.REGULAR
    saddle = hamiltonian(-(x**2) / 2, x)
    assert megno(saddle, (0, 60), [1e-9, 0], **how).value == pytest.approx(30, abs=2)


def test_a_deviation_along_the_orbit_shows_nothing():
    E = 1 / 8
    start = on_the_section(E, -0.25)
    force = [start[2], start[3], 0.0, -start[1] + start[1] ** 2]
    along = megno(HENON_HEILES, (0, 200), start, deviation=force, **KAHAN_LI)
    assert abs(along.value) < 0.5
    assert megno(HENON_HEILES, (0, 200), REGULAR, deviation=[1, 0.3, 0.2, 0.1], **KAHAN_LI).value > 1


@pytest.mark.slow
def test_the_volume_of_regular_motion_falls_as_a_power_beyond_the_torus():
    """GALI_k ~ t^(−2(k − n)) of motion on an n-torus in 2n dimensions, Skokos, Bountis and Antonopoulos (2007)."""
    for vectors, power in ((2, 0), (3, -2), (4, -4)):
        found = gali(HENON_HEILES, (0, 20000), REGULAR, vectors=vectors, samples=2000, **KAHAN_LI)
        late, early = found.t[-200:].mean() / found.t[180:220].mean(), np.log(found.history)
        fitted = (early[-200:].mean() - early[180:220].mean()) / np.log(late)
        assert fitted == pytest.approx(power, abs=0.35)


def test_many_deviations_beside_a_torus_are_not_called_chaotic():
    """GALI_10 of five oscillators falls as t⁻¹⁰, by which it looked exponential down to its floor."""
    q = coordinates("q1 q2 q3 q4 q5")
    uncoupled = Hamiltonian(sum(a.momentum**2 / 2 + a**4 / 4 for a in q), list(q), [a.momentum for a in q])
    start = [0.6, 0.8, 1.0, 1.2, 1.4, 0, 0, 0, 0, 0]
    found = gali(uncoupled, (0, 80), start, vectors=10, method=Splitting("kahan-li-8"), step=0.1)
    assert found.value < 1e-13
    assert found.verdict is Regularity.NOT_KNOWN


def test_an_exponential_is_told_from_a_power_with_as_many_deviations_as_there_are() -> None:
    """GALI_6 of three saddles of rates 1, 2 and 3 comes to fall as exp(−18 t)."""
    q = coordinates("q1 q2 q3")
    saddles = hamiltonian(-sum((k + 1) ** 2 * a**2 for k, a in enumerate(q)) / 2, *q)
    found = gali(saddles, (0, 4), [1e-9] * 6, vectors=6, method="kahan-li-8", step=0.01, samples=200)
    assert found.verdict is Regularity.UNSTABLE


KINK = Hamiltonian(
    (x.momentum**2 + y.momentum**2) / 2 + sp.Abs(x - y / 3) + y**2 / 2 + sp.Abs(y + sp.Rational(1, 5)) / 2,
    [x, y],
    [x.momentum, y.momentum],
)


@pytest.mark.filterwarnings("ignore:kahan-li-8 steps over the kinks")
def test_steps_of_one_size_do_not_judge_motion_whose_chaos_is_in_kinks():
    """They called it regular, as deviations do not part but where the force jumps."""
    for indicator in (megno, largest_lyapunov_exponent):
        with pytest.raises(ValueError, match=r"deviations jump with the force at x - y/3 = 0, y \+ 1/5 = 0"):
            indicator(KINK, (0, 300), [1.0, 0.3, 0.2, 0.1], **KAHAN_LI)
    with pytest.raises(ValueError, match="deviations jump with the force"):
        periodic_orbit(KINK, [1.0, 0.3, 0.2, 0.1], 5.0, **KAHAN_LI)
    # Where the force is continuous, and where time alone makes it jump, they see all there is.
    switched = (x.momentum**2 + y.momentum**2 + x**2 + y**2) / 2 - x * sp.sign(sp.sin(time))
    smooth = (x.momentum**2 + y.momentum**2 + y**2) / 2 + sp.Abs(x - y / 3) ** 3
    for H in (switched, smooth):
        system = Hamiltonian(H, [x, y], [x.momentum, y.momentum])
        found = megno(system, (0, 100), [1.0, 0.3, 0.2, 0.1], samples=100, **KAHAN_LI)
        assert found.verdict is not Regularity.CHAOTIC


@pytest.mark.slow
def test_chaos_that_is_in_kinks_alone():
    found = largest_lyapunov_exponent(KINK, (0, 300), [1.0, 0.3, 0.2, 0.1], samples=100)
    assert found.verdict is Regularity.CHAOTIC
    # Neighbours part by e^{λt}, as far as one pair of them tells.
    starts = np.array([[1.0, 0.3, 0.2, 0.1], [1.0 + 1e-10, 0.3, 0.2, 0.1]]).T
    ends = propagate(KINK, (0, 100), starts, samples=1).final
    assert np.log(np.linalg.norm(ends[:, 1] - ends[:, 0]) / 1e-10) / 100 == pytest.approx(
        found.largest, abs=0.08
    )


def test_orbits_that_leave_are_told():
    beyond = on_the_section(0.3, 0.2)
    with pytest.raises(NonFiniteStateError, match="stops being finite"):
        megno(HENON_HEILES, (0, 3000), beyond, **KAHAN_LI)
    found = megno(HENON_HEILES, (0, 3000), np.array([REGULAR, beyond]).T, **KAHAN_LI)
    assert list(found.verdict) == [Regularity.REGULAR, Regularity.LEFT]
    assert np.isnan(found.value[1])
    assert "1 left" in repr(found)


def test_what_cannot_be_done_is_told():
    with pytest.raises(ValueError, match=r"does not split.*Gauss"):
        megno(DOUBLE_PENDULUM, (0, 10), DOUBLE_PENDULUM_START, **KAHAN_LI)
    with pytest.raises(ValueError, match="vectors=5: the system has exponents 1 … 4"):
        lyapunov_spectrum(HENON_HEILES, (0, 10), REGULAR, vectors=5, **KAHAN_LI)
    with pytest.raises(ValueError, match="an alignment index takes 2 … 4"):
        gali(HENON_HEILES, (0, 10), REGULAR, vectors=1, **KAHAN_LI)
    with pytest.raises(ValueError, match="a verdict takes at least 32"):
        megno(HENON_HEILES, (0, 10), REGULAR, samples=10, **KAHAN_LI)
    with pytest.raises(ValueError, match="deviation vector 0 is zero"):
        megno(HENON_HEILES, (0, 10), REGULAR, deviation=[0, 0, 0, 0], **KAHAN_LI)
    with pytest.raises(ValueError, match="give one vector"):
        megno(HENON_HEILES, (0, 10), REGULAR, deviation=np.eye(4), **KAHAN_LI)
    method = TimeTransformed(Splitting("verlet"))
    with pytest.raises(ValueError, match="carries no deviations here"):
        megno(KEPLER, (0, 10), kepler_start(0.3), method=method, step=0.1)
    damped = Lagrangian(x.dot**2 / 2 - x**2 / 2, [x], forces=[-x.dot / 5])
    with pytest.raises(ValueError, match="make a Hamiltonian of the system"):
        megno(damped, (0, 10), [1, 0], method=RK4(), step=0.1)
    with pytest.raises(ValueError, match="give a longer span or a shorter step"):
        megno(HENON_HEILES, (0, 2), REGULAR, **KAHAN_LI)
    with pytest.raises(ValueError, match="an odd number of variables"):
        lyapunov_spectrum(VectorField([y, -x, x - z], [x, y, z]), (0, 10), [1, 0, 0], method=RK4(), step=0.1)
    with pytest.raises(ValueError, match="whose variables are free"):
        megno("rolling-disc", (0, 10), method=RK4(), step=0.1)
    with pytest.raises(ValueError, match="pairs take the whole spectrum"):
        _ = largest_lyapunov_exponent(HENON_HEILES, (0, 10), REGULAR, **KAHAN_LI).pairing_defect


# the rule of the verdicts -------------------------------------------------------------------------------

TIMES = np.linspace(0, 1000, 401)


@given(
    power=st.floats(0, 2),
    start=st.floats(0.1, 20),
    swing=st.floats(0, 1),
    frequency=st.floats(0.05, 3),
    rate=st.floats(0, 0.001),
)
def test_growth_as_a_power_of_time_is_never_called_chaotic(power, start, swing, frequency, rate):
    log = power * np.log1p(TIMES / start) + swing * np.sin(frequency * TIMES) + rate * TIMES
    judged = judged_growth(TIMES, log[:, np.newaxis])
    assert judged.verdicts[0] is not Regularity.CHAOTIC


@given(rate=st.floats(1.1, 100), swing=st.floats(0, 0.5), frequency=st.floats(0.05, 3))
def test_an_exponent_above_the_detection_limit_is_found(rate, swing, frequency):
    limit = judged_growth(TIMES, np.zeros((401, 1))).detection_limit
    log = rate * limit * TIMES + swing * np.sin(frequency * TIMES)
    assert judged_growth(TIMES, log[:, np.newaxis]).verdicts[0] is Regularity.CHAOTIC


def test_one_passage_near_a_saddle_is_not_taken_for_chaos():
    early = np.minimum(TIMES[:, np.newaxis], [10.0, 25.0, 100.0, 240.0])
    assert Regularity.CHAOTIC not in judged_growth(TIMES, early).verdicts
    near = megno(PENDULUM, (0, 200), [np.pi - 1e-9, 0.0], **KAHAN_LI)
    assert near.verdict is not Regularity.CHAOTIC


@given(power=st.floats(0.1, 3))
def test_megno_of_a_power_is_twice_the_power(power):
    t = np.linspace(0, 1, 20001)
    log = power * np.log(np.maximum(t, 1e-5))[:, np.newaxis]
    assert mean_megno(t, log - log[0])[-1, 0] == pytest.approx(2 * power, rel=0.02)


# long runs ----------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("energy", "y0", "published", "about"),
    [(1 / 8, -0.25, 0.045, 0.012), (0.16666, -0.1, 0.128, 0.01)],
    ids=["1/8", "1/6"],
)
def test_published_exponents_of_henon_and_heiles(energy, y0, published, about):
    """G. Benettin, L. Galgani, J.-M. Strelcyn, Phys. Rev. A 14 (1976) 2338–2345, doi:10.1103/PhysRevA.14.2338."""
    found = lyapunov_spectrum(HENON_HEILES, (0, 100_000), on_the_section(energy, y0), **KAHAN_LI)
    assert found.verdict is Regularity.CHAOTIC
    assert abs(found.largest - published) < about + 2 * found.errors[0]
    assert found.pairing_defect < 1e-13
    assert abs(found.exponents[1]) < 3 * found.errors[1]
    assert abs(found.exponents.sum()) < 1e-12


@pytest.mark.slow
def test_methods_agree_on_exponents_within_their_errors():
    """Orbits part, so only the means agree; of a regular orbit the histories do."""
    start = on_the_section(1 / 8, -0.25)
    ways = [KAHAN_LI, {"method": Splitting("blanes-moan-6"), "step": 0.1}, {"method": Gauss(4), "step": 0.2}]
    found = [largest_lyapunov_exponent(HENON_HEILES, (0, 20_000), start, samples=400, **way) for way in ways]
    for one in found[1:]:
        assert abs(one.largest - found[0].largest) < 3 * np.hypot(one.errors[0], found[0].errors[0])
    regular = [
        lyapunov_spectrum(HENON_HEILES, (0, 500), REGULAR, samples=50, **way)
        for way in (*ways, {"method": Taylor()})
    ]
    for one in regular[1:]:
        np.testing.assert_allclose(one.history[:, -1], regular[0].history[:, -1], atol=1e-7)


@pytest.mark.slow
def test_the_double_pendulum_parts_as_its_frequency_says():
    """Of equal links and masses, from 143° and 29°: λ = 0.39 √(g/l), by Gauss and by Taylor, at any g."""
    theta, phi = coordinates("theta phi")
    g, (p, s) = parameters("g", positive=True), (theta.momentum, phi.momentum)
    kinetic = (p**2 + 2 * s**2 - 2 * p * s * sp.cos(theta - phi)) / (2 * (1 + sp.sin(theta - phi) ** 2))
    double = Hamiltonian(kinetic - g * (2 * sp.cos(theta) + sp.cos(phi)), [theta, phi], [p, s])
    ways = [
        (1, 20_000, {"method": Gauss(4), "step": 0.04}),
        (1, 3_000, {"method": Taylor()}),
        (4, 5_000, {"method": Gauss(4), "step": 0.02}),
    ]
    for strength, span, way in ways:
        found = lyapunov_spectrum(
            double, (0, span), [2.5, 0.5, 0, 0], parameters={g: strength}, samples=300, **way
        )
        frequency = strength**0.5
        assert found.verdict is Regularity.CHAOTIC
        assert abs(found.largest / frequency - 0.39) < 0.01 + 3 * found.errors[0] / frequency
        assert found.errors[0] < 0.05 * frequency
        assert abs(found.exponents[1]) < 3 * found.errors[1]
        assert found.pairing_defect < 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("energy", [1.0, 10.0])
def test_the_chain_of_fermi_pasta_ulam_and_tsingou_parts_as_its_curvature_says(energy):
    """L. Casetti, C. Clementi, M. Pettini, Phys. Rev. E 54 (1996) 5969, eqs. for λ of a Gaussian curvature.

    The estimate takes the mean and the fluctuation of ΔV along the motion and no tangent map; it is said to agree for
    many particles. Here are 64, with u = 1/10 as there, and it is 15 to 25 % too large.
    """
    q = [coordinates(f"q{i}") for i in range(64)]
    V = sum((b - a) ** 2 / 2 + (b - a) ** 4 / 40 for a, b in zip(q, [*q[1:], q[0]], strict=True))
    ring = hamiltonian(V, *q)
    p = np.random.default_rng(1).standard_normal(64)
    p -= p.mean()
    start = [*np.zeros(64), *(p * np.sqrt(2 * energy * 64 / (p @ p)))]
    how = {"method": Splitting("blanes-moan-4"), "step": 0.05 / energy**0.25}
    found = largest_lyapunov_exponent(ring, (0, 4000), start, **how)
    curvature = {"K": sum(V.diff(s, 2) for s in q)}
    along = propagate(ring, (0, 1500), start, samples=15000, observables=curvature, **how)["K"][1500:]
    k, s = along.mean() / 64, along.std() / 8
    part = s**2 * np.pi * np.sqrt(k) / (2 * np.sqrt(k * (k + s)) + np.pi * s)
    root = (part + np.sqrt((4 * k / 3) ** 3 + part**2)) ** (1 / 3)
    estimate = (root - 4 * k / (3 * root)) / 2
    assert found.verdict is Regularity.CHAOTIC
    assert 1.0 < estimate / found.largest < 1.35


@pytest.mark.slow
def test_the_pairs_of_a_method_that_is_not_symplectic_part():
    good = lyapunov_spectrum(HENON_HEILES, (0, 2000), CHAOTIC, method=Splitting("verlet"), step=0.1)
    bad = lyapunov_spectrum(HENON_HEILES, (0, 2000), CHAOTIC, samples=100, method=RK4(), step=0.2)
    assert good.pairing_defect < 1e-13 < 1e-8 < bad.pairing_defect
