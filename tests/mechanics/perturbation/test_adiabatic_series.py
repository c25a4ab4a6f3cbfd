"""Adiabatic invariants to second order: orbits of heyoka, a closed form, and wrong twins."""

from dataclasses import replace

import pytest
import sympy as sp

from canon.mechanics.hamilton.hamiltonian import Hamiltonian
from canon.mechanics.perturbation.averaging import AveragingError, adiabatic_invariant, average
from canon.mechanics.perturbation.secular.adiabatic_series import adiabatic_invariants
from canon.study.energy_drift.integral_drift import adiabatic_drift

theta, phi, tau, x, y = sp.symbols("theta phi tau x y", real=True)
I, J, eps = sp.symbols("I J epsilon", positive=True)
w = sp.Function("omega", positive=True)(tau)
SLOW_PAIR = Hamiltonian((2 + x**2) * I + (x**2 + y**2) / 2 + eps * I * x * sp.cos(theta), [theta, x], [I, y])
TWO_FREQUENCIES = Hamiltonian(
    (2 + x**2) * I + 7 * J + (x**2 + y**2) / 2 + eps * (I * J * sp.cos(theta - phi) + x * I * sp.cos(theta)),
    [theta, phi, x],
    [I, J, y],
)


def oscillator(frequency):
    """ω I + ε (ω′/2ω) I sin 2θ: p²/2 + ω² q²/2 with q = √(2I/ω) sin θ, p = √(2Iω) cos θ."""
    return Hamiltonian(
        frequency * I + eps * I * frequency.diff(tau) / (2 * frequency) * sp.sin(2 * theta), theta, I
    )


def test_the_invariant_of_a_slow_oscillator_is_that_of_lewis():
    """(q²/ρ² + (ρ p − ε ρ′ q)²)/2 with ε² ρ″ + ω² ρ = 1/ρ³, J. Math. Phys. 9, 1976 (1968), ρ expanded in ε."""
    (found,) = adiabatic_invariants(oscillator(w), theta, 2, eps, slow_time=tau)
    first = 1 / sp.sqrt(w)
    rho = first - eps**2 * first.diff(tau, 2) / (4 * w**2)
    q, p = sp.sqrt(2 * I / w) * sp.sin(theta), sp.sqrt(2 * I * w) * sp.cos(theta)
    lewis = (q**2 / rho**2 + (rho * p - eps * rho.diff(tau) * q) ** 2) / 2
    here = (lewis - found.J).subs({theta: 1, I: 2}).subs(w, (2 + tau) ** 2).doit().subs(tau, 1)
    for n in range(3):
        assert abs(here.diff(eps, n).subs(eps, 0).evalf(30)) < 1e-25
    assert abs(here.diff(eps, 4).subs(eps, 0).evalf(30)) > 1e-6
    assert found.is_adiabatic().holds


@pytest.mark.parametrize("H", [SLOW_PAIR, pytest.param(TWO_FREQUENCIES, marks=pytest.mark.slow)])
def test_orbits_drift_with_the_power_that_the_order_says(H):
    fast = H.q[:-1]
    start = [0.3, 0.1, 0.5, 1.0, 0.7, 0.3] if len(fast) > 1 else [0.3, 0.5, 1.0, 0.3]
    for order in (1, 2) if len(fast) > 1 else (2,):
        for found in adiabatic_invariants(H, fast, order, eps, slow_q=x):
            assert found.is_adiabatic().holds
            seen = adiabatic_drift(found, start, [0.01, 0.02, 0.04], slow_span=4.0)
            assert all(seen.above_rounding)
            assert abs(seen.slope - (order + 1)) < 0.15
    wrong = replace(found, terms=(*found.terms[:2], found.terms[2] * 2))
    assert wrong.is_adiabatic().fails
    seen = adiabatic_drift(wrong, start, [0.01, 0.02, 0.04], slow_span=4.0)
    assert abs(seen.slope - 2) < 0.2


def test_each_wrong_term_is_refuted():
    (found,) = adiabatic_invariants(SLOW_PAIR, theta, 2, eps, slow_q=x)
    for n in (1, 2):
        for wrong in (-found.terms[n], sp.S.Zero, found.terms[n] + I**2 * sp.cos(theta)):
            twin = replace(found, terms=(*found.terms[:n], wrong, *found.terms[n + 1 :]))
            assert twin.is_adiabatic().fails
    assert replace(found, slow_q=()).is_adiabatic().fails


def test_without_slow_variables_it_is_the_action_of_the_average():
    H = Hamiltonian(2 * I + eps * I**2 * sp.cos(theta) ** 4 + eps**2 * I * sp.sin(theta), theta, I)
    (found,) = adiabatic_invariants(H, theta, 2, eps)
    due = adiabatic_invariant(average(H, theta, 2, eps))
    assert sp.expand((found.J - due).rewrite(sp.exp)) == 0


@pytest.mark.parametrize(
    ("H", "given", "said"),
    [
        (SLOW_PAIR, {}, "x is neither"),
        (Hamiltonian(I + J + eps * sp.cos(theta - phi), [theta, phi], [I, J]), {}, "divisor k·ω = 0"),
        (Hamiltonian(I * (2 + sp.cos(theta)), theta, I), {}, "depends on the angles"),
    ],
)
def test_what_has_no_invariants_is_refused(H, given, said):
    fast = [z for z in H.q if z != x]
    with pytest.raises(AveragingError, match=said):
        adiabatic_invariants(H, fast, 2, eps, **given)


@pytest.mark.parametrize(
    ("H", "angles", "order", "said"),
    [
        (SLOW_PAIR, theta, 0, "the order should be a whole number from 1, not 0"),
        (SLOW_PAIR, I, 1, "the angles should be among the coordinates theta, x"),
        (SLOW_PAIR, [], 1, "the angles should be among the coordinates theta, x"),
        (
            Hamiltonian(I + eps * I * sp.cos(theta - SLOW_PAIR.t), theta, I),
            theta,
            1,
            "H depends on t; write the slow time as a symbol of its own, slow_time",
        ),
    ],
)
def test_angles_orders_and_times_that_are_none_are_refused_with_what_to_give(H, angles, order, said):
    with pytest.raises(ValueError, match=said):
        adiabatic_invariants(H, angles, order, eps, slow_q=[z for z in H.q if z == x])
