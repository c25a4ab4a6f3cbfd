"""Gauss methods by Newton's method: stiff springs with steps that the slow motion sets; elsewhere the same motion."""

import itertools

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, Lagrangian, coordinates, flow_jacobian, propagate
from canon.flow import reversal_error
from canon.flow.method.method import Gauss
from canon.flow.run.non_finite_state import NonFiniteStateError
from tests.flow.systems import (
    DOUBLE_PENDULUM,
    DOUBLE_PENDULUM_START,
    DRIVEN,
    DRIVEN_START,
    KEPLER,
    RELATIVISTIC,
    RELATIVISTIC_START,
    kepler_start,
)
from tests.flow.test_order import fitted_order

x, y = coordinates("x y")


def newton(stages):
    return Gauss(stages, iteration="newton")


def spring_pendulum(k):
    """A mass on a spring of rest length 1 whose own period is 2π/√k; it falls from the side at rest."""
    r = sp.sqrt(x**2 + y**2)
    H = (x.momentum**2 + y.momentum**2) / 2 + sp.Integer(k) * (r - 1) ** 2 / 2 + y
    return Hamiltonian(H, [x, y], [x.momentum, y.momentum]), [1.0, 0.0, 0.0, 0.0]


def alternating_springs(k):
    """Stiff linear and soft quartic springs (Hairer, Lubich, Wanner, Geometric Numerical Integration, § I.5.1)."""
    middles, stretches = coordinates("m1 m2 m3"), coordinates("s1 s2 s3")
    ends = zip(middles[1:], stretches[1:], middles, stretches, strict=False)
    soft = (middles[0] - stretches[0]) ** 4 + (middles[2] + stretches[2]) ** 4
    soft += sum((m - s - before - stretch) ** 4 for m, s, before, stretch in ends)
    q = (*middles, *stretches)
    p = [s.momentum for s in q]
    stiff = sp.Integer(k) / 2 * sum(s**2 for s in stretches)
    start = [1.0, 0.0, 0.0, k**-0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0]
    return Hamiltonian(sum(s**2 for s in p) / 2 + stiff + soft / 4, q, p), start


def chain(sites, k, *, ring=False):
    """Masses between walls, or in a ring, by quartic springs of which every other one is stiff too."""
    q = coordinates(" ".join(f"x{i}" for i in range(sites)))
    ends = [(q[-1], q[0])] if ring else [(0, q[0]), (q[-1], 0)]
    stretches = [b - a for a, b in [*ends[:1], *itertools.pairwise(q), *ends[1:]]]
    V = sum((k if i % 2 else 1) * s**2 / 2 + s**4 / 4 for i, s in enumerate(stretches))
    pairs = np.repeat(0.2 * np.sin(np.arange((sites + 1) // 2)), 2)[:sites]  # stiff springs are not stretched
    H = Hamiltonian(sum(s.momentum**2 for s in q) / 2 + V, q, [s.momentum for s in q])
    return H, [*pairs, *np.zeros(sites)]


@pytest.mark.parametrize(("sites", "ring"), [(24, False), (25, True)])
def test_a_long_chain_moves_by_the_band_of_its_neighbours(sites, ring):
    """The other iteration, which knows no matrix, solves the same equations where the springs are soft."""
    soft, start = chain(sites, 2, ring=ring)
    arguments = {"t_span": (0, 10), "y0": start, "step": 0.1, "samples": 5}
    one, other = (propagate(soft, method=method, **arguments) for method in (newton(3), Gauss(3)))
    assert abs(one.y - other.y).max() < 1e-14
    assert abs(one.y[:, -1] - one.y[:, 0]).max() > 0.1


@pytest.mark.slow
@pytest.mark.parametrize("k", [10**4, 10**10])
def test_a_long_stiff_chain_keeps_its_energy(k):
    system, start = chain(64, k)
    motion = propagate(system, (0, 500), start, method=newton(3), step=0.05, samples=500)
    error = abs(motion.energy_error)
    assert error.max() < 1e-9
    assert error[-100:].max() < 3 * error[1:101].max()


@pytest.mark.parametrize("k", [10**4, pytest.param(10**8, marks=pytest.mark.slow), 10**10])
def test_a_stiff_pendulum_is_the_rigid_one(k):
    """The slow motion has 300 steps a turn; the spring's own period is up to 300 times shorter than a step."""
    system, start = spring_pendulum(k)
    found = propagate(system, (0, 50), start, method=newton(6), step=0.02, samples=200)
    theta = coordinates("theta")
    rigid = propagate(
        Lagrangian(theta.dot**2 / 2 - sp.sin(theta), [theta]), (0, 50), [0, 0], times=found.t[1:-1]
    )
    assert abs(found.energy_error).max() < 1e-12
    place = np.array([np.cos(rigid["theta"]), np.sin(rigid["theta"])])
    assert abs(found.q - place).max() < 150 / k + 1e-12
    # At the lowest point weight and centrifugal force, 1 + 2, stretch the spring by 3/k.
    stretch = np.hypot(*found.q).max() - 1
    assert stretch == pytest.approx(3 / k, rel=0.01)


def test_where_the_stages_do_not_converge_by_themselves_the_error_names_newtons_method():
    system, start = spring_pendulum(10**8)
    with pytest.raises(NonFiniteStateError, match="iteration='newton'"):
        propagate(system, (0, 1), start, method=Gauss(6), step=0.02)


@pytest.mark.parametrize("k", [10**4, pytest.param(10**8, marks=pytest.mark.slow), 10**12])
def test_energy_stays_bounded_however_stiff_the_springs(k):
    system, start = alternating_springs(k)
    motion = propagate(system, (0, 1000), start, method=newton(2), step=0.1, samples=500)
    error = abs(motion.energy_error)
    assert error.max() < 3e-4
    assert error[-100:].max() < 3 * error[1:101].max()


@pytest.mark.slow
@pytest.mark.parametrize("k", [10**8, 10**12])
def test_energy_stays_bounded_over_a_million_steps(k):
    system, start = alternating_springs(k)
    motion = propagate(system, (0, 100_000), start, method=newton(2), step=0.1, samples=1000)
    error = abs(motion.energy_error)
    assert motion.steps == 10**6
    assert error[-100:].max() < 3 * error[1:101].max()


@pytest.mark.parametrize("stages", [2, *(pytest.param(s, marks=pytest.mark.slow) for s in (1, 3, 5, 8))])
def test_the_motion_is_that_of_the_other_iteration_and_reverses(stages):
    arguments = {"t_span": (0, 5), "y0": DOUBLE_PENDULUM_START, "step": 0.05}
    one, other = (
        propagate(DOUBLE_PENDULUM, method=method, samples=5, **arguments)
        for method in (newton(stages), Gauss(stages))
    )
    assert abs(one.y - other.y).max() < 1e-15
    assert one.evaluations < other.evaluations
    assert abs(reversal_error(DOUBLE_PENDULUM, method=newton(stages), **arguments)).max() < 1e-15


@pytest.mark.slow
@pytest.mark.parametrize("stages", range(1, 9))
def test_fitted_order_and_symplecticity(stages):
    window = (1e-7, 1e-4) if stages == 1 else (3e-13, 1e-6)
    slope = fitted_order(
        RELATIVISTIC, RELATIVISTIC_START, newton(stages), window=window, span=40.0, longest=1.0
    )
    assert slope == pytest.approx(2 * stages, abs=0.1 * stages)
    jacobian = flow_jacobian(DOUBLE_PENDULUM, (0, 1), DOUBLE_PENDULUM_START, method=newton(stages), step=0.2)
    assert jacobian.symplecticity_defect[-1] < 1e-14


@pytest.mark.slow
def test_other_systems_and_precisions():
    assert fitted_order(DRIVEN, DRIVEN_START, newton(2)) == pytest.approx(4, abs=0.1)
    damped = Lagrangian(x.dot**2 / 2 - 5000 * x**2, [x], forces=[-x.dot])
    one, other = (
        propagate(damped, (0, 1), [1, 0], method=method, step=step, samples=1).final
        for method, step in ((newton(6), 0.01), (Gauss(6), 0.001))
    )
    assert abs(one - other).max() < 1e-9
    ends = {
        precision: propagate(
            KEPLER, (0, 3), kepler_start(0.3), method=newton(3), step=0.1, samples=1, precision=precision
        )
        for precision in ("single", "double", "extended", "double-double")
    }
    true = ends["double-double"]
    for precision, unit in (("single", 1e-5), ("double", 1e-14), ("extended", 5e-18)):
        found = ends[precision]
        assert abs((found.y - true.y) + (found.carried - true.carried)).max() < unit


def test_the_same_bits_again_and_resumed():
    system, start = spring_pendulum(10**6)
    arguments = {"method": newton(4), "step": 0.02}
    whole = propagate(system, (0, 2), start, samples=7, **arguments).final
    np.testing.assert_array_equal(propagate(system, (0, 2), start, samples=1, **arguments).final, whole)
    np.testing.assert_array_equal(propagate(system, (0, 1), start, **arguments).resume(2).final, whole)


def test_a_step_that_is_too_large_for_newtons_method_too_is_told_with_the_state():
    with pytest.raises(NonFiniteStateError, match=r"do not converge .*Newton's method") as caught:
        propagate(KEPLER, (0, 100), kepler_start(0.6), method=newton(2), step=3.0)
    assert np.isfinite(caught.value.state).all()


def test_there_are_two_iterations():
    with pytest.raises(ValueError, match="there are 'fixed-point' and 'newton'"):
        Gauss(4, iteration="secant")
