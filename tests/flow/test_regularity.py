"""Verdicts on orbits: what is said where the motion is not the system's, and in which order exponents come."""

import numpy as np
import pytest
from sympy import Symbol, sqrt, symbols

from canon import Hamiltonian, Splitting, VectorField, coordinates
from canon.flow import (
    LiePoissonSplitting,
    Regularity,
    largest_lyapunov_exponent,
    lyapunov_spectrum,
    megno,
    sali,
)
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
