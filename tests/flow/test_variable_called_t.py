"""A variable that is the symbol of the time: refused, as the rates could not tell which is meant; and the remedies."""

import re

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

from canon import (
    ConstrainedLagrangian,
    Event,
    GeneratingFunction,
    Hamiltonian,
    Lagrangian,
    VectorField,
    coordinates,
    propagate,
)
from canon.flow import HamiltonianMap, lyapunov_spectrum
from canon.mechanics import PoissonSystem
from canon.mechanics.canonical.transformation import CanonicalTransformation
from canon.mechanics.lagrange.quasi_velocity import Kinematics

q, t, p, p_t = sp.symbols("q t p p_t", real=True)
SWUNG = p**2 / 2 + q**2 / 2 - q * sp.cos(t)
SINCE = 0.5


def swung(until):
    """The motion of the driven oscillator from t = 0.5 on, by SciPy."""
    return solve_ivp(
        lambda s, y: [y[1], -y[0] + np.cos(s)],
        (SINCE, SINCE + until),
        [1.0, 0.0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-12,
    ).y[:, -1]


def test_a_symbol_without_assumptions_is_the_time_everywhere():
    bare = sp.Symbol("t")
    free = Hamiltonian(p**2 / 2, [q], [p])
    brackets = [[0, 1], [-1, 0]]
    for clock in (t, bare):
        field = propagate(VectorField([q * clock], [q]), (0, 1), [1.0])
        assert abs(field.final[0] - np.exp(0.5)) < 1e-14
        bent = propagate(PoissonSystem(p**2 / 2 - q * clock, [q, p], brackets), (0, 1), [0.0, 0.0])
        assert abs(bent.final - [1 / 6, 1 / 2]).max() < 1e-15
        motion = propagate(
            free, (0, 4), [0.0, 1.0], events=[Event(q - 2 + clock)], observables={"z": q * clock}
        )
        assert abs(motion.events[0].t - 1) < 1e-14
        assert abs(motion.observables["z"][-1] - 16) < 1e-13
        assert abs(motion[q - clock]).max() < 1e-14
    with pytest.raises(ValueError, match="t moves and is no parameter"):
        propagate(VectorField([q * bare], [q]), (0, 1), [1.0], parameters={"t": 2})


def test_a_variable_without_assumptions_may_have_its_name():
    bare = sp.Symbol("t")
    assert abs(propagate(VectorField([-bare], [bare]), (0, 1), [1.0]).final[0] - np.exp(-1)) < 1e-15
    turned = PoissonSystem(q**2 / 2 + bare**2 / 2, [q, bare], [[0, 1], [-1, 0]])
    assert abs(propagate(turned, (0, 1), [1.0, 0.0]).final - [np.cos(1), -np.sin(1)]).max() < 1e-15
    met = propagate(
        VectorField([-bare], [bare]), (0, 1), [1.0], events=[Event(bare - sp.Rational(1, 2))]
    ).events
    assert abs(met[0].t - np.log(2)) < 1e-14


@pytest.mark.parametrize(
    "made",
    [
        lambda: Hamiltonian(SWUNG + p_t, [q, t], [p, p_t]),
        lambda: Hamiltonian(p**2 / 2, q, t),
        lambda: Hamiltonian(SWUNG + p_t, [q, sp.Symbol("t")], [p, p_t]),
        lambda: Hamiltonian(SWUNG + p_t, [q, p_t], [p, t]),
        lambda: Lagrangian(sp.Symbol("t_dot") ** 2 / 2 - t**2 / 2, [t]),
        lambda: ConstrainedLagrangian(Lagrangian(sp.Symbol("q_dot") ** 2 / 2, [q, t]), [q - t]),
        lambda: PoissonSystem(q**2 / 2 + t**2 / 2, [q, t], [[0, 1], [-1, 0]]),
        lambda: HamiltonianMap(p**2 / 2, sp.cos(t), t, p),
        lambda: Kinematics([q, t]),
        lambda: CanonicalTransformation(t, p, t, p),
        lambda: GeneratingFunction(2, t * p_t, t, p, q, p_t),
    ],
)
def test_the_time_is_no_variable(made):
    with pytest.raises(
        ValueError, match=r"variable t is the symbol of the time too: .* t=Symbol\('s', real=True\)"
    ):
        made()


def test_a_field_holding_the_time_among_its_variables_is_not_integrated():
    field = VectorField([p, -q + sp.cos(t), 1], [q, p, t])
    with pytest.raises(ValueError, match=re.escape("coordinates('t')")):
        propagate(field, (0, 5), [1, 0, SINCE])
    with pytest.raises(ValueError, match=re.escape("coordinates('t')")):
        lyapunov_spectrum(field, (0, 5), [1, 0, SINCE])


@pytest.mark.parametrize("variable", [t, sp.Symbol("t"), coordinates("t")])
def test_extended_phase_space_with_another_time(variable):
    H = SWUNG.subs(t, variable) + p_t
    system = Hamiltonian(H, [q, variable], [p, p_t], t=sp.Symbol("s", real=True))
    motion = propagate(system, (0, 5), [1, SINCE, 0, 0])
    np.testing.assert_allclose(motion.final[[0, 2]], swung(5.0), atol=1e-10)
    np.testing.assert_allclose(motion.final[1], SINCE + 5.0, atol=1e-13)
    np.testing.assert_allclose(motion[variable][-1], SINCE + 5.0, atol=1e-13)
    assert abs(motion.energy_error).max() < 1e-14


@pytest.mark.parametrize("variable", [sp.Symbol("t"), coordinates("t")])
def test_a_field_whose_variable_is_called_t_and_is_another_symbol(variable):
    field = VectorField([p, -q + sp.cos(variable), 1], [q, p, variable])
    motion = propagate(field, (0, 5), [1, 0, SINCE])
    np.testing.assert_allclose(motion.final[:2], swung(5.0), atol=1e-10)
    np.testing.assert_allclose(motion[variable][-1], SINCE + 5.0, atol=1e-13)


def test_a_lagrangian_with_another_time():
    rate = sp.Symbol("t_dot", real=True)
    motion = propagate(Lagrangian(rate**2 / 2 - t**2 / 2, [t], t=sp.Symbol("s", real=True)), (0, 1), [1, 0])
    np.testing.assert_allclose(motion.final, [np.cos(1), -np.sin(1)], atol=1e-13)
    np.testing.assert_allclose(motion[t][-1], np.cos(1), atol=1e-13)
