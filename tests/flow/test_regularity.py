"""Verdicts on orbits: what is said where the motion is not the system's, and in which order exponents come."""

import numpy as np
import pytest
from scipy.linalg import expm
from sympy import Symbol, sqrt, symbols

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
    assert long.verdict is Regularity.CHAOTIC
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
    assert repr(one) == "<LyapunovSpectrum: chaotic, 2 ± 0.05, -2 ± 0.05>"
    many = lyapunov_spectrum(saddle, (0, 40), np.array([[1e-9, 2e-9], [0, 0]]), **how)
    assert repr(many) == "<LyapunovSpectrum: 2 exponents of 2 orbits>"


def test_a_frequency_that_moves_a_little_is_neither_regular_nor_chaotic():
    """cos(1.25 t + c t²) has the frequency 1.25 + 2 c t, which moves by 1000 c between the middles of the halves."""
    t = np.linspace(0, 1000, 1001)
    still, little = (frequency_diffusion(t, np.cos(1.25 * t + c * t**2)) for c in (0, 1e-6))
    assert (still.verdict, little.verdict) == (Regularity.REGULAR, Regularity.NOT_KNOWN)
    assert still.second == pytest.approx(still.first, abs=1e-12)
    assert little.second - little.first == pytest.approx(1e-3, rel=1e-3)
