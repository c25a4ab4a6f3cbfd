"""Flows as polynomials in the deviations of their start: closed forms, fitted orders, a second route, symplecticity."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, Lagrangian, coordinates, flow_jacobian, propagate
from canon import time as t
from canon.flow import HamiltonianMap, NonFiniteStateError, flow_series
from canon.kernel.heyoka_compiled import compiled_integrator
from canon.mechanics.hamilton.vector_field import VectorField
from canon.mechanics.lagrange.unilateral import UnilateralLagrangian
from tests.flow.systems import (
    DOUBLE_PENDULUM,
    DOUBLE_PENDULUM_START,
    DRIVEN,
    DRIVEN_START,
    HENON_HEILES,
    HENON_HEILES_START,
    KEPLER,
    PENDULUM,
    kepler_start,
    x,
)

p = x.momentum
CASES = {
    "pendulum": (PENDULUM, [1.0, 0.5], 10.0),
    "Hénon–Heiles": (HENON_HEILES, HENON_HEILES_START, 6.0),
    "Kepler": (KEPLER, kepler_start(0.3), 3.0),
    "driven": (DRIVEN, DRIVEN_START, 3.0),
}


def test_a_polynomial_flow_is_its_series():
    """q + t (p + p³) of H = p²/2 + p⁴/4."""
    found = flow_series(Hamiltonian(p**2 / 2 + p**4 / 4, [x], [p]), (0, 2), [3.0, 2.0], order=4)
    q = {(0, 0): 23.0, (1, 0): 1.0, (0, 1): 26.0, (0, 2): 12.0, (0, 3): 2.0}
    for row, (first, second) in zip(found.powers.tolist(), found.coefficients.T, strict=True):
        assert first == pytest.approx(q.get(tuple(row), 0.0), abs=1e-13)
        assert second == {(0, 0): 2.0, (0, 1): 1.0}.get(tuple(row), 0.0)


def test_a_linear_flow_has_no_more_than_its_jacobian():
    found = flow_series(Hamiltonian(p**2 / 2 + 2 * x**2, [x], [p]), (0, 1), [1.0, 0.0], order=3)
    c, s = np.cos(2), np.sin(2)
    np.testing.assert_allclose(found.M, [[c, s / 2], [-2 * s, c]], rtol=1e-15)
    assert not found.coefficients[:, 3:].any()
    assert found.reach(1e-9) == np.inf


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("order", [1, 2, 4])
def test_what_is_left_out_is_of_the_next_order(name, order):
    system, start, end = CASES[name]
    found = flow_series(system, (0, end), start, order=order)
    ways = np.random.default_rng(order).standard_normal((len(start), 12))
    ways /= np.linalg.norm(ways, axis=0)
    sizes = found.reach(1e-5) * np.array([0.25, 0.5])
    missed = []
    for size in sizes:
        starts = np.array(start).reshape(-1, 1) + size * ways
        # what is said of a deviation is said of the start that a double is
        deviations = starts - np.array(start).reshape(-1, 1)
        ends = propagate(system, (0, end), starts, samples=1).y[:, -1]
        missed.append(np.linalg.norm(found(deviations) - ends))
    slope = np.log2(missed[1] / missed[0])
    assert slope == pytest.approx(order + 1, abs=0.35)


@pytest.mark.parametrize("name", CASES)
def test_the_linear_part_is_the_jacobian(name):
    system, start, end = CASES[name]
    found, jacobian = flow_series(system, (0, end), start, order=2), flow_jacobian(system, (0, end), start)
    np.testing.assert_allclose(found.M, jacobian.final, atol=1e-12 * abs(jacobian.final).max())
    np.testing.assert_allclose(found.y, jacobian.y[:, -1], atol=1e-13)


def test_second_derivatives_are_those_of_the_jacobian():
    h, start = 2.0**-12, np.array(HENON_HEILES_START)
    found = flow_series(HENON_HEILES, (0, 5), start, order=2)
    for j in range(4):
        step = h * np.eye(4)[j]
        ahead, behind = (flow_jacobian(HENON_HEILES, (0, 5), start + s).final for s in (step, -step))
        second = (ahead - behind) / (2 * h)
        own = [[found.derivative(i, j, k) for k in range(4)] for i in range(4)]
        np.testing.assert_allclose(own, second, atol=1e-5)


def test_terms_are_in_the_order_of_heyoka():
    import heyoka as hy

    a, b, c = hy.make_vars("a", "b", "c")
    equations = hy.var_ode_sys([(a, b), (b, -a * c), (c, -c)], [a, b, c], order=3)
    made = compiled_integrator(equations, [1.0, 0.0, 1.0], compact_mode=True)
    of_first = [row[1:] for row in (made.get_mindex(k) for k in range(len(made.state))) if row[0] == 0]
    decay = coordinates("a b c")
    field = VectorField((decay[1], -decay[0] * decay[2], -decay[2]), decay)
    assert flow_series(field, (0, 1), [1.0, 0.0, 1.0], order=3).powers.tolist() == of_first


@pytest.mark.parametrize("name", [name for name in CASES if name != "driven"])
def test_it_is_symplectic_to_every_order_and_a_wrong_digit_is_seen(name):
    system, start, end = CASES[name]
    found = flow_series(system, (0, end), start, order=4)
    assert found.symplecticity_defect < 1e-12
    changed = found.coefficients.copy()
    of_last_order = np.where(found.powers.sum(axis=1) == 4, abs(changed), 0.0)
    changed[np.unravel_index(np.argmax(of_last_order), changed.shape)] *= 1 + 1e-6
    assert replace(found, coefficients=changed).symplecticity_defect > 1e-9


def test_friction_is_not_symplectic():
    damped = VectorField((p, -sp.sin(x) - p / 10), (x, p))
    assert flow_series(damped, (0, 2), [1.0, 0.0], order=2).symplecticity_defect > 0.01


def test_a_chaotic_motion_keeps_its_digits_beside_large_derivatives():
    start = [2.0, 2.5, 0.0, 0.0]
    found = flow_series("double-pendulum", (0, 10), start, order=2)
    motion = propagate("double-pendulum", (0, 10), start, samples=1)
    assert abs(found.coefficients).max() > 1e3
    assert (abs(found.y - motion.y[:, -1]) <= 4 * motion.error_estimate().error[:, -1] + 1e-13).all()


def test_back_again():
    """The series backwards in time, from the end, takes the deviations back."""
    there = flow_series(PENDULUM, (0, 5), [1.0, 0.5], order=5)
    back = flow_series(PENDULUM, (5, 0), there.y, order=5)
    deviations = 1e-3 * np.random.default_rng(2).standard_normal((2, 10))
    returned = back(there(deviations) - there.y.reshape(2, 1))
    np.testing.assert_allclose(returned, np.array([[1.0], [0.5]]) + deviations, atol=1e-13)


def test_a_lagrangian_is_in_its_own_variables():
    L = Lagrangian(x.dot**2 / 2 + sp.cos(x) + x * sp.cos(t) / 10, [x])
    H = Hamiltonian(p**2 / 2 - sp.cos(x) - x * sp.cos(t) / 10, [x], [p])
    own, canonical = (flow_series(each, (0, 4), [1.0, 0.2], order=3) for each in (L, H))
    np.testing.assert_allclose(own.coefficients, canonical.coefficients, atol=1e-12)


def test_a_scene_and_a_parameter():
    k = sp.Symbol("k", positive=True)
    found = flow_series(
        Hamiltonian(p**2 / 2 + k * x**4 / 4, [x], [p]), (0, 1), [1.0, 0.0], order=2, parameters={"k": 3}
    )
    same = flow_series(Hamiltonian(p**2 / 2 + 3 * x**4 / 4, [x], [p]), (0, 1), [1.0, 0.0], order=2)
    np.testing.assert_array_equal(found.coefficients, same.coefficients)
    assert flow_series("henon-heiles", (0, 1), "regular", order=2).M.shape == (4, 4)


def test_reach_is_where_the_last_terms_are_as_large_as_the_tolerance():
    """q = 2 p³ of H = p⁴/2 … at p = 1: the last terms are 2 δ³."""
    found = flow_series(Hamiltonian(p**4 / 4, [x], [p]), (0, 2), [0.0, 1.0], order=3)
    assert found.reach(2e-3) == pytest.approx(0.1)
    with pytest.raises(ValueError, match="give a positive error"):
        found.reach(0.0)


def test_shapes_of_deviations():
    found = flow_series(PENDULUM, (0, 1), [1.0, 0.5], order=3)
    several = np.array([[0.1, 0.0, -0.1], [0.0, 0.2, 0.1]])
    np.testing.assert_array_equal(found(several)[:, 1], found(several[:, 1]))
    np.testing.assert_array_equal(found([0, 0]), found.y)
    with pytest.raises(ValueError, match=r"give \(2,\) of one start or \(2, orbits\) of several"):
        found([0.1, 0.2, 0.3])
    with pytest.raises(ValueError, match="not finite"):
        found([0.1, np.nan])
    with pytest.raises(ValueError, match="orders up to 3"):
        found.derivative(0, 1, 1, 1, 1)
    with pytest.raises(ValueError, match="components 0 … 1"):
        found.derivative(2, 1)


def test_odd_numbers_of_variables_have_no_symplectic_form():
    field = VectorField((-(x**2),), (x,))
    found = flow_series(field, (0, 1), [1.0], order=3)
    # x/(1 + t x): derivatives (−1)^(k+1) k! tᵏ⁻¹/(1 + t x)^(k+1)
    np.testing.assert_allclose(found.coefficients, [[1 / 2, 1 / 4, -1 / 8, 1 / 16]], rtol=1e-14)
    with pytest.raises(ValueError, match="no coordinates and momenta"):
        _ = found.symplecticity_defect


@pytest.mark.parametrize("order", [0, -1, 2.0, True, "two"])
def test_an_order_is_a_number_from_one_on(order):
    with pytest.raises(ValueError, match="give the highest power of the deviations"):
        flow_series(PENDULUM, (0, 1), [1.0, 0.5], order=order)


def test_what_has_no_series_is_refused():
    with pytest.raises(ValueError, match="kinks, at which a flow has no higher derivatives"):
        flow_series(Hamiltonian(p**2 / 2 + sp.Abs(x), [x], [p]), (0, 1), [1.0, 0.5], order=2)
    with pytest.raises(ValueError, match="a map is no flow"):
        flow_series(HamiltonianMap(p**2 / 2, sp.cos(x), [x], [p]), (0, 1), [1.0, 0.5], order=2)
    with pytest.raises(ValueError, match="one orbit"):
        flow_series(PENDULUM, (0, 1), [[1.0, 0.5], [0.1, 0.2]], order=2)
    with pytest.raises(ValueError, match="equations, more than the"):
        flow_series(DOUBLE_PENDULUM, (0, 1), DOUBLE_PENDULUM_START, order=12)
    with pytest.raises(NonFiniteStateError):
        flow_series(VectorField((x**2,), (x,)), (0, 2), [1.0], order=2)
    falling = UnilateralLagrangian(Lagrangian(x.dot**2 / 2 - x, [x]), [x])
    with pytest.raises(ValueError, match="the series of a flow knows no events"):
        flow_series(falling, (0, 1), [1.0, 0.0], order=2)


def test_it_says_what_it_is():
    assert repr(flow_series(PENDULUM, (0, 1), [1.0, 0.5], order=3)) == (
        "<FlowSeries: 2 variables, order 3, 10 terms each>"
    )
