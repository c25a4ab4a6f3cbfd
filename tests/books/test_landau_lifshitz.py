"""Numbers of Landau & Lifshitz, Mechanics: parametric resonance, a quickly shaken pendulum, large swings."""

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, coordinates, propagate
from canon.flow import Taylor, flow_jacobian

pytestmark = pytest.mark.slow
q = coordinates("q")
t = sp.Symbol("t", real=True)


def _over_a_period(stiffness, frequency):
    """Return the matrix of q̈ = −k(t) q over a period."""
    H = Hamiltonian(q.momentum**2 / 2 + stiffness * q**2 / 2, [q], [q.momentum], t)
    return flow_jacobian(H, (0, 2 * np.pi / frequency), [1, 0], method=Taylor()).M[..., -1]


@pytest.mark.parametrize(
    ("h", "detuning", "factor", "right"),
    [
        (0.1, 0, 1 / 2, True),
        (0.1, 0.04, 1 / 2, True),
        (0.1, -0.04, 1 / 2, True),
        (0.1, 0, 1, False),
        (0.1, 0.04, 1, False),
    ],
)
def test_growth_in_parametric_resonance(h, detuning, factor, right):
    """§ 27: ω² = 1 + h cos(2 + ε)t grows with s = ½√((h/2)² − ε²), to first order in h; twins have no ½ before it."""
    M = _over_a_period(1 + h * sp.cos((2 + detuning) * t), 2 + detuning)
    found = np.log(np.abs(np.linalg.eigvals(M)).max()) * (2 + detuning) / (2 * np.pi)
    printed = factor * np.sqrt((h / 2) ** 2 - detuning**2)
    assert bool(abs(found - printed) < 0.02 * printed) is right


@pytest.mark.parametrize(("width", "right"), [(1 / 2, True), (1 / 4, False), (1, False)])
def test_the_borders_of_parametric_resonance(width, right):
    """§ 27: between ε = −h/2 and h/2: 5 % inside of the border the motion grows, 5 % outside it does not."""
    h = 0.1
    traces = [
        abs(np.trace(_over_a_period(1 + h * sp.cos((2 + e) * t), 2 + e)))
        for e in (0.95 * width * h, 1.05 * width * h)
    ]
    assert bool(traces[0] > 2 > traces[1]) is right


@pytest.mark.parametrize(("limit", "right"), [(2, True), (1, False), (4, False)])
def test_a_quickly_shaken_pendulum_stands(limit, right):
    """§ 30, problem 1: upright it is stable for a²γ² > 2gl; the border by Floquet's multipliers, a = l/50."""
    a = 0.02
    traces = []
    for speed in (0.97 * np.sqrt(limit), 1.03 * np.sqrt(limit)):
        gamma = speed / a
        traces.append(abs(np.trace(_over_a_period(-(1 - a * gamma**2 * sp.cos(gamma * t)), gamma))))
    assert bool(traces[0] > 2 > traces[1]) is right


@pytest.mark.parametrize(
    ("printed", "right"),
    [("4 K(1/2)", True), ("2π(1 + φ²/16)", False), ("2π", False)],
)
def test_the_period_of_a_swing_by_a_right_angle(printed, right):
    """§ 11, problem 1: T = 4√(l/g) K(sin ½φ₀), the modulus squared being the parameter; the series is 2 % short."""
    T = {
        "4 K(1/2)": 4 * float(sp.elliptic_k(sp.Rational(1, 2))),
        "2π(1 + φ²/16)": 2 * np.pi * (1 + np.pi**2 / 64),
        "2π": 2 * np.pi,
    }
    pendulum = Hamiltonian(q.momentum**2 / 2 - sp.cos(q), [q], [q.momentum])
    start = [np.pi / 2, 0]
    assert (
        bool(abs(propagate(pendulum, (0, T[printed]), start, method=Taylor()).final - start).max() < 1e-10)
        is right
    )
