"""Numbers of Lichtenberg & Lieberman, Regular and Chaotic Dynamics: the standard map."""

import numpy as np
import pytest
import sympy as sp
from scipy.special import jv

from canon import coordinates, parameters, propagate
from canon.flow import HamiltonianMap, flow_jacobian, lyapunov_spectrum, periodic_orbit

pytestmark = pytest.mark.slow
theta, K = coordinates("theta"), parameters("K", positive=True)
STANDARD = HamiltonianMap(theta.momentum**2 / 2, K * sp.cos(theta), [theta], [theta.momentum])


@pytest.mark.parametrize("k", [6, 10, 20])
@pytest.mark.parametrize(("printed", "right"), [("ln K/2", True), ("ln K", False)])
def test_the_exponent_of_strong_kicks(k, printed, right):
    """§ 5.3: the Liapunov exponent is ln(K/2) where K is large."""
    found = lyapunov_spectrum(STANDARD, (0, 20_000), [0.1, 0.2], parameters={K: k}).largest
    assert bool(abs(found - np.log(k / 2 if printed == "ln K/2" else k)) < 0.05) is right


@pytest.mark.parametrize(("limit", "right"), [(4, True), (2, False)])
def test_the_fixed_point_loses_its_stability(limit, right):
    """§ 4.1: that at θ = π is stable for K < 4, where cos σ = 1 − K/2 leaves the interval."""
    traces = [
        np.trace(flow_jacobian(STANDARD, (0, 1), [np.pi, 0], parameters={K: k}).M[..., -1])
        for k in (0.99 * limit, 1.01 * limit)
    ]
    assert bool(abs(traces[0]) < 2 < abs(traces[1])) is right


@pytest.mark.parametrize(
    ("q", "p", "k", "right"),
    [
        (5, 3, 0.971635, True),
        (8, 5, 0.971635, True),
        (13, 8, 0.971635, True),
        (5, 3, 0.9, False),
        (8, 5, 0.9, False),
        (5, 3, 1.05, False),
        (8, 5, 1.05, False),
    ],
)
def test_residues_beside_the_last_curve_are_a_quarter(q, p, k, right):
    """§ 4.4, Greene: at K = 0.9716… the residues (2 − Tr M)/4 of the golden mean's convergents come to 0.25."""
    orbit = periodic_orbit(
        STANDARD,
        [np.pi, 2 * np.pi * p / q],
        q,
        fixed_period=True,
        turns={"theta": 2 * np.pi * p},
        parameters={K: k},
    )
    assert orbit.defect < 1e-11
    assert bool(abs((2 - np.trace(orbit.M)) / 4 - 0.25) < 0.01) is right


@pytest.mark.parametrize(("corrected", "right"), [(True, True), (False, False)])
@pytest.mark.parametrize("k", [10, 15, 30])
def test_diffusion_of_the_momentum(k, corrected, right):
    """§ 5.5, Rechester and White: D = (K²/2)(½ − J₂ − J₁² + J₂² + J₃²), not the quasilinear K²/4."""
    kicks, orbits = 60, 20_000
    start = np.random.default_rng(1).uniform(0, 2 * np.pi, (2, orbits))
    end = propagate(STANDARD, (0, kicks), start, parameters={K: k}, samples=1).final
    found = np.mean((end[1] - start[1]) ** 2) / (2 * kicks)
    J1, J2, J3 = (jv(n, k) for n in (1, 2, 3))
    printed = k**2 / 2 * (1 / 2 - J2 - J1**2 + J2**2 + J3**2) if corrected else k**2 / 4
    assert bool(abs(found / printed - 1) < 0.06) is right
