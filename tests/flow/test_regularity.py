"""Verdicts on orbits: what is said where the motion is not the system's, and in which order exponents come."""

import numpy as np
import pytest
from scipy.linalg import expm
from sympy import Rational, Symbol, cos, sqrt, symbols

from canon import Hamiltonian, Splitting, VectorField, coordinates
from canon.flow import (
    LiePoissonSplitting,
    Regularity,
    frequency_diffusion,
    gali,
    largest_lyapunov_exponent,
    lyapunov_spectrum,
    megno,
    sali,
)
from canon.flow.tangent.deviation_frame import random_vectors
from canon.mechanics import free_body


def test_nothing_is_said_of_an_orbit_whose_energy_is_far_off():
    """Kepler's ellipse e = 0.9 in steps that are too long: the motion is not the system's, and no chaos is its own."""
    x, y = coordinates("x y")
    kepler = Hamiltonian(
        (x.momentum**2 + y.momentum**2) / 2 - 1 / sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
    )
    start = [0.1, 0, 0, 19**0.5]
    for follow in (megno, sali, largest_lyapunov_exponent):
        wrong = follow(kepler, (0, 600), start, method=Splitting("kahan-li-8"), step=0.05)
        assert wrong.verdict is Regularity.NOT_KNOWN
        assert "the energy has changed by" in wrong.reason
    assert (
        megno(kepler, (0, 600), start, method=Splitting("kahan-li-8"), step=0.002).verdict
        is Regularity.REGULAR
    )


def test_nor_of_orbits_with_parameters_of_their_own():
    x, y = coordinates("x y")
    mu = Symbol("mu", positive=True)
    kepler = Hamiltonian(
        (x.momentum**2 + y.momentum**2) / 2 - mu / sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
    )
    start, how = [0.1, 0, 0, 19**0.5], {"method": Splitting("kahan-li-8"), "step": 0.05}
    wrong = megno(kepler, (0, 600), start, parameters={mu: [1.0, 1.0]}, **how)
    assert [*wrong.verdict] == [Regularity.NOT_KNOWN] * 2


def test_exponents_fall():
    """Those of a free body are all zero, and come in no order by themselves."""
    found = lyapunov_spectrum(
        free_body([1, 2, 3]), (0, 500), [0.01, 1, 0.01], method=LiePoissonSplitting(4), step=0.05
    )
    assert (np.diff(found.exponents) <= 0).all()
    assert found.largest == found.exponents[0]


def test_vector_fields_have_exponents():
    """Of a damped oscillator both are −c/2, of van der Pol's one is 0."""
    x, y = symbols("x y", real=True)
    damped = lyapunov_spectrum(VectorField([y, -x - y / 10], [x, y]), (0, 300), [1.0, 0.5])
    assert damped.exponents == pytest.approx([-0.05, -0.05], abs=2e-3)
    assert (
        lyapunov_spectrum(VectorField([y, -x + (1 - x**2) * y], [x, y]), (0, 300), [1.0, 0.5]).exponents[1]
        < -0.5
    )


def test_the_alignment_of_a_linear_field_is_that_of_its_exponential():
    """SALI of x' = A x is that of exp(t A) applied to the first deviations, in the variables' own units."""
    x, y = symbols("x y", real=True)
    A = np.array([[0.1, 1.0], [-1.0, -0.2]])
    found = sali(VectorField([x / 10 + y, -x - y / 5], [x, y]), (0, 8), [1.0, 0.5], samples=32)
    frame = random_vectors(2, 2, 0)
    for t, value in zip(found.t[1:], found.history[1:], strict=True):
        a, b = (column / np.linalg.norm(column) for column in (expm(t * A) @ frame).T)
        assert value == pytest.approx(min(np.linalg.norm(a + b), np.linalg.norm(a - b)), rel=1e-8)


def test_alignment_says_what_it_cannot_tell_and_what_has_left():
    x, y = coordinates("x y")
    saddle = Hamiltonian((x.momentum**2 + y.momentum**2 - x**2 + y**2) / 2, [x, y], [x.momentum, y.momentum])
    how = {"method": Splitting("kahan-li-8"), "step": 0.05, "samples": 50}
    # Both deviations come to lie along (1, 0, 1, 0), all others stay: the smaller index falls as exp(−t).
    short, long = (sali(saddle, (0, span), [1e-9, 0.1, 0, 0.1], **how) for span in (16, 40))
    assert short.verdict is Regularity.NOT_KNOWN
    assert "too fast for a regular orbit and not far enough for a chaotic one: run longer" in short.reason
    assert long.verdict is Regularity.UNSTABLE  # the growth of chaos, in a linear system
    henon = Hamiltonian(
        (x.momentum**2 + y.momentum**2 + x**2 + y**2) / 2 + x**2 * y - y**3 / 3,
        [x, y],
        [x.momentum, y.momentum],
    )
    starts = np.array([[0, 0.1, 0.38, 0.1], [0, 2.0, 0, 1.0]]).T
    found = gali(henon, (0, 400), starts, vectors=2, method=Splitting("kahan-li-8"), step=0.2)
    assert [*found.verdict] == [Regularity.REGULAR, Regularity.LEFT]
    assert found.reason[1] == "the orbit left the finite numbers, by escape or collision"


def test_a_spectrum_is_shown_with_its_verdict_and_errors():
    x = coordinates("x")
    saddle = Hamiltonian((x.momentum**2 - 4 * x**2) / 2, [x], [x.momentum])
    how = {"method": Splitting("kahan-li-8"), "step": 0.05, "samples": 40}
    one = lyapunov_spectrum(saddle, (0, 40), [1e-9, 0], **how)
    assert repr(one) == "<LyapunovSpectrum: 2 ± 0.05, -2 ± 0.05; unstable>"
    many = lyapunov_spectrum(saddle, (0, 40), np.array([[1e-9, 2e-9], [0, 0]]), **how)
    assert repr(many) == "<LyapunovSpectrum: 2 exponents of 2 orbits>"


def test_a_frequency_that_moves_a_little_is_neither_regular_nor_chaotic():
    """cos(1.25 t + c t²) has the frequency 1.25 + 2 c t, which moves by 1000 c between the middles of the halves."""
    t = np.linspace(0, 1000, 1001)
    still, little = (frequency_diffusion(t, np.cos(1.25 * t + c * t**2)) for c in (0, 1e-6))
    assert (still.verdict, little.verdict) == (Regularity.REGULAR, Regularity.NOT_KNOWN)
    assert still.second == pytest.approx(still.first, abs=1e-12)
    assert little.second - little.first == pytest.approx(1e-3, rel=1e-3)


def test_beside_rest_and_in_linear_systems_neighbours_part_without_chaos():
    """The exponents are ±1 in all of these; the pendulum at rest below, and a chaotic orbit, are the twins."""
    x, t = coordinates("x"), Symbol("t", real=True)
    u, v = symbols("u v", real=True)
    pendulum = Hamiltonian(x.momentum**2 / 2 - cos(x), x, x.momentum)
    inverted = Hamiltonian(x.momentum**2 / 2 + cos(x), x, x.momentum)
    hill = Hamiltonian(x.momentum**2 / 2 + x**2 * (1 + cos(2 * t) / 2) / 2, x, x.momentum)
    duffing = Hamiltonian(x.momentum**2 / 2 - x**2 / 2 + x**4 / 4 - 3 * x * cos(t) / 10, x, x.momentum)
    saddle = VectorField([u, -v], [u, v])
    assert lyapunov_spectrum(saddle, (0, 50), [1, 1]).verdict is Regularity.UNSTABLE
    at_rest = megno(inverted, (0, 100), [0, 0])
    assert at_rest.verdict is Regularity.UNSTABLE
    assert at_rest.reason.endswith("that is no chaos beside a state of rest or in a linear system")
    assert megno(hill, (0, 200), [1, 0]).verdict is Regularity.UNSTABLE
    assert megno(pendulum, (0, 100), [0, 0]).verdict is Regularity.REGULAR
    assert megno(duffing, (0, 1000), [0.1, 0]).verdict is Regularity.CHAOTIC
    many = megno(inverted, (0, 100), np.array([[0.0, 1.0], [0.0, 0.0]]))
    assert [*many.verdict] == [Regularity.UNSTABLE, Regularity.REGULAR]


def test_a_regular_orbit_stands_with_the_rate_that_would_have_been_seen():
    """Lorenz's system has the exponent 0.9, which five units of time can't show."""
    x, y, z, rest = symbols("x y z rest", real=True)
    lorenz = VectorField([10 * (y - x), x * (28 - z) - y, x * y - Rational(8, 3) * z, 0], [x, y, z, rest])
    short = lyapunov_spectrum(lorenz, (0, 5), [1, 1, 1, 0])
    assert repr(short).endswith("; regular, no rate above 2.4>")
    assert lyapunov_spectrum(lorenz, (0, 100), [1, 1, 1, 0]).verdict is Regularity.CHAOTIC
