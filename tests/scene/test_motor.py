"""The DC motor: its transfer function from its equations, positive-real and passive."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

from canon.proof.vanish import vanishes
from canon.scene import SceneError, find
from canon.scene.scene_motion import run
from canon.scene.systems.motor import admittance


@pytest.fixture
def motor():
    return find("dc-motor")


def test_the_transfer_function_follows_from_lagranges_equations(motor):
    """With i = I e^(st), φ = Φ e^(st), u = U e^(st) the equations are linear in I, Φ, U."""
    s, (p, I, Phi, U) = motor.symbols, sp.symbols("s I Phi U")
    put = {
        s.q.ddot: p * I, s.q.dot: I, s.phi.ddot: p**2 * Phi, s.phi.dot: p * Phi, s.u: U, s.M: 0,
    }  # fmt: skip
    electric, mechanical = (e.xreplace(put) for e in motor.lagrangian.equations)
    found = sp.solve([electric, mechanical], [I, Phi], dict=True)[0]
    H = admittance(s, p)
    assert vanishes(found[I] / U - H).holds
    assert vanishes(found[I] / U - H * s.K).fails
    T_m, T_a = s.J * s.R / s.K**2, s.L / s.R
    assert vanishes(H - s.J / s.K**2 * p / (1 + T_m * p + T_m * T_a * p**2)).holds


def test_it_is_positive_real(motor):
    """Poles in the left half plane; Re H(iw) = J² R w²/|D(iw)|² ≥ 0; no poles on the axis."""
    s, w = motor.symbols, sp.Symbol("w", real=True)
    H = admittance(s, sp.I * w)
    D = -s.J * s.L * w**2 + s.K**2 + sp.I * s.J * s.R * w
    assert vanishes(
        sp.re(H) - s.J**2 * s.R * w**2 / ((s.K**2 - s.J * s.L * w**2) ** 2 + (s.J * s.R * w) ** 2)
    ).holds
    assert vanishes(sp.denom(H) - D).holds
    p = sp.Symbol("s")
    assert all(
        c.is_positive for c in sp.Poly(sp.denom(admittance(s, p)), p).all_coeffs()
    )  # Hurwitz, degree 2


def test_the_approximation_for_a_fast_armature(motor):
    """1/(1 + T_m s + T_m T_a s²) against 1/((1 + T_m s)(1 + T_a s)): off by T_a/T_m to first order."""
    v = motor.values
    T_m, T_a = v["J"] * v["R"] / v["K"] ** 2, v["L"] / v["R"]
    w = np.geomspace(0.01, 100.0, 50) / T_m
    exact = 1.0 / (1.0 + 1j * T_m * w - T_m * T_a * w**2)
    near = 1.0 / ((1.0 + 1j * T_m * w) * (1.0 + 1j * T_a * w))
    worst = np.abs(near / exact - 1.0).max()
    assert 0.2 * T_a / T_m < worst < 2.0 * T_a / T_m


def test_it_is_passive(motor):
    """What flows in, ∫ u i dt, is at least the energy stored, the load taking none."""
    free = motor.with_parameters(M=0.0)
    motion = run(free, periods=3.0, samples=301)
    s = free.symbols
    supplied = free.values["u"] * motion.observed(s.q)
    stored = motion.observed(s.L * s.q.dot**2 / 2 + s.J * s.phi.dot**2 / 2)
    assert (supplied[1:] > stored[1:]).all()
    lost = motion.observed(s.R * s.q.dot**2)
    heat = np.sum((lost[1:] + lost[:-1]) / 2.0 * np.diff(motion.t))
    assert supplied[-1] - stored[-1] == pytest.approx(heat, rel=1e-3)


def test_a_motor_that_swings_is_refused(motor):
    with pytest.raises(SceneError, match="runs up without swinging"):
        motor.with_parameters(L=0.1)
