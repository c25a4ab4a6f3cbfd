"""Jacobians of flows and of discrete maps, by three routes; symplectic to round-off where the method is."""

import mpmath
import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, Lagrangian, coordinates
from canon.flow.geometry.flow_jacobian import flow_jacobian, reversal_error, symplecticity_defect
from canon.flow.method.method import DOP853, RK4, Gauss, Splitting, Taylor
from canon.flow.propagation import propagate
from canon.flow.request import Request
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.system_request import any_task
from canon.kernel.schemes.splitting_schemes import SCHEMES
from tests.flow.systems import (
    DOUBLE_PENDULUM,
    DOUBLE_PENDULUM_START,
    DRIVEN,
    DRIVEN_START,
    HENON_HEILES,
    HENON_HEILES_START,
    KEPLER,
    PENDULUM,
    RELATIVISTIC,
    RELATIVISTIC_START,
    kepler_start,
    x,
)
from tests.flow.test_geometry import compiled_jacobian, exact_step, jacobian


@pytest.mark.parametrize("name", ["verlet", "kahan-li-8", "srkn-6b"])
def test_it_is_the_derivative_of_the_discrete_map(name):
    found = flow_jacobian(
        HENON_HEILES, (0, 0.6), HENON_HEILES_START, method=Splitting(name), step=0.3, samples=2
    )
    with mpmath.workdps(60):
        state = [mpmath.mpf(v) for v in HENON_HEILES_START]

        def twice(s):
            for _ in range(2):
                s = exact_step(HENON_HEILES, SCHEMES[name], s, mpmath.mpf(0.3))
            return s

        true = np.array(jacobian(twice, state).tolist(), dtype=float)
    np.testing.assert_allclose(found.final, true, atol=2e-15)
    np.testing.assert_array_equal(found.M[:, :, 0], np.eye(4))
    motion = propagate(
        HENON_HEILES, (0, 0.6), HENON_HEILES_START, method=Splitting(name), step=0.3, samples=2
    )
    np.testing.assert_array_equal(found.y, motion.y)


@pytest.mark.parametrize("method", [Gauss(1), Gauss(4), RK4()], ids=str)
def test_implicit_and_ordinary_methods_too(method):
    found = flow_jacobian(DOUBLE_PENDULUM, (0, 0.2), DOUBLE_PENDULUM_START, method=method, step=0.2)
    np.testing.assert_allclose(
        found.final, compiled_jacobian(DOUBLE_PENDULUM, DOUBLE_PENDULUM_START, method, 0.2), atol=1e-11
    )


SYMPLECTIC = [
    *((HENON_HEILES, HENON_HEILES_START, Splitting(name)) for name in SCHEMES),
    *((DRIVEN, DRIVEN_START, Splitting(name)) for name in SCHEMES if not SCHEMES[name].nystrom),
    *((DOUBLE_PENDULUM, DOUBLE_PENDULUM_START, Gauss(s)) for s in range(1, 9)),
    (RELATIVISTIC, RELATIVISTIC_START, Gauss(3)),
    (DRIVEN, DRIVEN_START, Gauss(2)),
]


@pytest.mark.parametrize(("system", "start", "method"), SYMPLECTIC, ids=str)
def test_symplectic_methods_are_symplectic_to_round_off_at_coarse_steps(system, start, method):
    """The median of many neighbours: the round-off of a single one scatters by a factor of twenty."""
    defects = list[float]()
    for k in range(25):
        near = [x * (1 - k / 250) for x in start]
        found = flow_jacobian(system, (0, 8), near, method=method, step=0.25)
        size = abs(found.final).max()
        assert size > 1
        defects.append(found.symplecticity_defect[-1] / size**2)
    assert np.median(defects) < 10 * 2.0**-53


@pytest.mark.parametrize(("system", "start"), [(HENON_HEILES, HENON_HEILES_START), (DRIVEN, DRIVEN_START)])
def test_runge_kutta_is_not_symplectic(system, start):
    defect = flow_jacobian(system, (0, 8), start, method=RK4(), step=0.25).symplecticity_defect[-1]
    assert defect > 1e-5


def test_double_double_is_symplectic_beyond_doubles():
    found = flow_jacobian(
        KEPLER, (0, 6), kepler_start(0.3), method=Splitting("verlet"), step=0.1, precision="double-double"
    )
    assert 0 < found.symplecticity_defect[-1] < 1e-28
    assert abs(found.low).max() > 0


@pytest.mark.parametrize(("method", "bound"), [(Taylor(), 1e-11), (DOP853(1e-12), 1e-8)], ids=str)
def test_adaptive_methods_give_the_flows_jacobian(method, bound):
    found = flow_jacobian(KEPLER, (0, 6), kepler_start(0.3), method=method, times=[2, 4])
    fine = flow_jacobian(
        KEPLER, (0, 6), kepler_start(0.3), method=Splitting("kahan-li-8"), step=0.005, times=[2, 4]
    )
    assert found.t.tolist() == [0, 2, 4, 6]
    np.testing.assert_allclose(found.M, fine.M, atol=bound)
    assert found.symplecticity_defect.max() < bound * 10


def test_the_jacobian_of_a_linear_flow_is_its_matrix_exponential():
    from tests.flow.systems import System

    oscillator = System(x.momentum**2 / 2 + 2 * x**2, (x,), (x.momentum,))
    found = flow_jacobian(oscillator, (0, 1.3), [0.3, 0.1])
    c, s = np.cos(2.6), np.sin(2.6)
    np.testing.assert_allclose(found.final, [[c, s / 2], [-2 * s, c]], atol=1e-14)


def test_what_has_no_jacobian_is_refused():
    with pytest.raises(ValueError, match="one orbit"):
        flow_jacobian(PENDULUM, (0, 1), [[1.0, 2.0], [0.0, 0.0]])
    for wrong, message in (
        ([[1.0]], "shape"),
        (np.ones((2, 4)), "shape"),
        ([[1.0, np.nan], [0.0, 1.0]], "finite"),
    ):
        with pytest.raises(ValueError, match=message):
            symplecticity_defect(wrong)


def test_the_defect_of_known_matrices():
    J = np.kron([[0, 1], [-1, 0]], np.eye(3))
    assert symplecticity_defect(J) == 0
    assert symplecticity_defect(2 * np.eye(6)) == 3
    random = np.random.default_rng(3).normal(size=(6, 6))
    direct = abs(random.T @ J @ random - J).max()
    assert symplecticity_defect(random) == pytest.approx(direct, rel=1e-13)


@pytest.mark.parametrize("method", [Splitting("kahan-li-6"), Gauss(3)], ids=str)
def test_symmetric_methods_come_back_and_others_do_not(method):
    many = np.array(HENON_HEILES_START)[:, np.newaxis] * np.array([0.5, 1.0, 1.2])
    missed = reversal_error(HENON_HEILES, (2, 30), many, method=method, step=0.1)
    assert missed.shape == (4, 3)
    assert abs(missed).max() < 1e-14
    assert abs(reversal_error(HENON_HEILES, (2, 30), many, method=RK4(), step=0.1)).max() > 1e-7
    lopsided = Splitting(a=["1/4", "3/4"], b=["1/2", "1/2"])
    assert abs(reversal_error(DRIVEN, (2, 30), DRIVEN_START, method=lopsided, step=0.1)).max() > 1e-3
    assert (
        abs(reversal_error(DRIVEN, (2, 30), DRIVEN_START, method=Splitting("verlet"), step=0.1)).max() < 1e-13
    )
    assert abs(reversal_error(HENON_HEILES, (2, 30), many)).max() < 1e-11


def test_the_jacobian_may_be_of_a_hamiltonian_with_parameters():
    k = sp.Symbol("k", positive=True)
    from tests.flow.systems import System

    spring = System(x.momentum**2 / 2 + k * x**2 / 2, (x,), (x.momentum,))
    found = flow_jacobian(spring, (0, 1), [1.0, 0.0], parameters={k: 4})
    np.testing.assert_allclose(
        found.final, [[np.cos(2), np.sin(2) / 2], [-2 * np.sin(2), np.cos(2)]], atol=1e-14
    )


@pytest.mark.parametrize("options", [{}, {"method": "verlet", "step": 0.01}, {"method": "DOP853"}], ids=str)
def test_neighbours_that_part_beyond_all_doubles_are_no_collision(options):
    """At the top of p²/2 − x²/2 it is [[cosh t, sinh t], [sinh t, cosh t]]; verlet's rate is a little less."""
    saddle = Hamiltonian(x.momentum**2 / 2 - x**2 / 2, [x], [x.momentum])
    found = flow_jacobian(saddle, (0, 1000), [0.0, 0.0], times=[100, 500, 1000], **options)
    np.testing.assert_allclose(
        found.log_size[1:] + np.log(2), [100, 500, 1000], rtol=1e-5 if options else 1e-12
    )
    np.testing.assert_allclose(found.M[:, :, -1] / found.M[0, 0, -1], np.ones((2, 2)), rtol=1e-4)
    assert found.exponent == (0, 0, 0, 1442)
    assert found.M[0, 0, 1] == pytest.approx(np.cosh(100), rel=1e-3 if options else 1e-12)
    with pytest.raises(OverflowError, match=r"beyond 1e308.*log_size"):
        _ = found.final
    np.testing.assert_array_equal(found.y, 0)
    with pytest.raises(ValueError, match="look earlier"):
        _ = found.symplecticity_defect


def test_the_whole_motion_in_one_sample_is_cut_for_its_variations() -> None:
    saddle = Hamiltonian(x.momentum**2 / 2 - x**2 / 2, [x], [x.momentum])
    found = flow_jacobian(saddle, (0, 2000), [0.0, 0.0], samples=1)
    np.testing.assert_allclose(found.log_size[1] + np.log(2), 2000, rtol=1e-12)


def test_so_do_those_of_other_systems():
    held = Lagrangian((x.dot**2 + x**2) / 2, [x], forces=[-x.dot / 10])
    found = flow_jacobian(held, (0, 1000), [0.0, 0.0], samples=2)
    np.testing.assert_allclose(np.diff(found.log_size)[1], 500 * (np.sqrt(1.0025) - 0.05), rtol=1e-12)
    assert found.M.shape == (2, 2, 3)


def test_a_motion_that_ends_itself_is_still_an_error():
    falling = Hamiltonian(x.momentum**2 / 2 - 1 / x, [x], [x.momentum])
    with pytest.raises(NonFiniteStateError, match=r"t = 1\.11"):
        flow_jacobian(falling, (0, 2), [1.0, 0.0])


y = coordinates("y")
KINKED = Hamiltonian(
    (x.momentum**2 + y.momentum**2) / 2 + sp.Abs(x - y / 3) + y**2 / 2 + sp.Abs(y + sp.Rational(1, 5)) / 2,
    [x, y],
    [x.momentum, y.momentum],
)


@pytest.mark.parametrize("how", [{}, {"method": DOP853()}])
@pytest.mark.parametrize("end", [9, -9])
def test_variations_jump_where_the_force_does(how, end):
    """The dispersion of |x| is all in its kink, which the variational equations on both sides do not hold."""
    start = np.array([1.0, 0.3, 0.2, 0.1])
    found = flow_jacobian(KINKED, (0, end), start, **how)
    beside = start[:, np.newaxis] + 1e-6 * np.concatenate([np.eye(4), -np.eye(4)], axis=1)
    ends = propagate(KINKED, (0, end), beside, samples=1, **how).final
    np.testing.assert_allclose(found.final, (ends[:, :4] - ends[:, 4:]) / 2e-6, rtol=1e-7, atol=1e-7)
    assert found.symplecticity_defect[-1] < 1e-10


def test_variations_over_one_kink_are_known_in_closed_form():
    """From (½, −1) the ball comes to 0 after √2 − 1 with the speed √2, and δp jumps by −2 δx/√2."""
    ball = Hamiltonian(x.momentum**2 / 2 + sp.Abs(x), [x], [x.momentum])
    before, after = np.sqrt(2) - 1, 1 - np.sqrt(0.5)
    kick = np.array([[1, 0], [-np.sqrt(2), 1]])
    true = np.array([[1, after], [0, 1]]) @ kick @ np.array([[1, before], [0, 1]])
    for precision, digits in ((None, 1e-15), ("quad", 1e-15)):
        found = flow_jacobian(ball, (0, before + after), [0.5, -1.0], precision=precision)
        np.testing.assert_allclose(found.final, true, atol=4 * digits)


def test_the_derivative_of_a_motion_that_sticks_is_not_given():
    friction = Lagrangian(x.dot**2 / 2 - x**2 / 2, [x], forces=[-sp.sign(x.dot) / 10])
    with pytest.raises(ValueError, match="the motion stays on x_dot = 0"):
        flow_jacobian(friction, (0, 50), [1.0, 0.3])
    step = Hamiltonian(x.momentum**2 / 2 + x**2 / 2 + sp.Heaviside(x) / 10, [x], [x.momentum])
    with pytest.raises(ValueError, match="refracted or reflected"):
        flow_jacobian(step, (0, 5), [1.0, 0.3])


def test_variational_equations_are_made_once():
    """Newton's method asks for Jacobians of one system again and again: the graph is then as large as before."""
    x = coordinates("x")
    H = Hamiltonian(x.momentum**2 / 2 - sp.cos(x), [x], [x.momentum])
    found = [flow_jacobian(H, (0, 3), [1.0, speed]).final for speed in (0.1, 0.2, 0.1)]
    task, _ = any_task(Request(H, (0, 3), [1.0, 0.1]))
    nodes = len(task.system.graph.nodes)
    again = [flow_jacobian(H, (0, 3), [1.0, speed]).final for speed in (0.1, 0.2, 0.1)]
    assert len(task.system.graph.nodes) == nodes
    assert np.array_equal(found, again)
    assert np.array_equal(found[0], found[2])
    assert not np.array_equal(found[0], found[1])


@pytest.mark.parametrize("sizes", [[0, 1], [-1, 1], [float("nan"), 1], [1, 1, 1], [1]])
def test_sizes_of_variations_are_positive_numbers_one_for_each_variable(sizes):
    with pytest.raises(ValueError, match="give a positive number for each of the 2 variables"):
        flow_jacobian("simple-pendulum", (0, 1), [0.5, 0.0], sizes=sizes)
