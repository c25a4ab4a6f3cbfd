"""Tangent maps beside compiled steps: the orbit is propagate's own, the deviations its exact derivative."""

import numpy as np
import pytest
import sympy as sp

from canon import DOP853, RK4, Gauss, Hamiltonian, Splitting, Taylor, coordinates, propagate
from canon.flow import AverageVectorField
from canon.flow.geometry.flow_jacobian import flow_jacobian, symplecticity_defect
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.tangent import deviation_growth as module
from canon.flow.tangent.compiled_deviations import CompiledDeviations
from canon.flow.tangent.deviation_frame import given_frame, random_frame
from canon.flow.tangent.deviation_growth import DeviationRun, deviation_growth, deviation_task
from canon.flow.tangent.variational_deviations import VariationalDeviations
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
)


def chain(bonds):
    """Fermi, Pasta, Ulam and Tsingou's chain with fixed ends; its loops are rolled where it is long."""
    q = [coordinates(f"q{i}") for i in range(bonds - 1)]
    stretched = [b - a for a, b in zip([0, *q], [*q, 0], strict=True)]
    V = sum(r**2 / 2 + r**3 / 12 for r in stretched)
    return Hamiltonian(sum(x.momentum**2 for x in q) / 2 + V, q, [x.momentum for x in q])


def each_with_each(n):
    """Oscillators of which each is coupled to each, so that no second derivative vanishes."""
    q = [coordinates(f"q{i}") for i in range(n)]
    V = sum(x**2 for x in q) / 2 + sp.cos(sum(q)) + sum(q) ** 4 / 50
    return Hamiltonian(sum(x.momentum**2 for x in q) / 2 + V, q, [x.momentum for x in q])


def start_of(n, seed=5):
    return np.random.default_rng(seed).uniform(-0.4, 0.4, 2 * n)


def task_of(system, y0, method, step, span=2.0, samples=40, **more):
    return deviation_task(
        DeviationRun(
            system,
            (0, span),
            y0,
            method,
            step,
            None,
            more.get("precision"),
            more.get("parameters"),
            samples,
            None,
        )
    )


def moved(system, y0, method, step, span=2.0, frame=None, orthogonal=False, samples=40):
    """Return the tangent map applied to a frame; by its columns, each of which keeps its direction."""
    task = task_of(system, y0, method, step, span, samples)
    unit = np.eye(len(y0)) if frame is None else frame
    going = CompiledDeviations(task, unit, orthogonal=orthogonal)
    log = sum(going.advance() for _ in task.plan.stops[1:])
    return going, going.vectors()[:, :, 0] * np.exp(log[:, 0])


SPLIT = {
    "verlet": (HENON_HEILES, HENON_HEILES_START, Splitting("verlet")),
    "driven": (DRIVEN, DRIVEN_START, Splitting("blanes-moan-4")),
}
LONG = {
    **{f"Hénon–Heiles {name}": (HENON_HEILES, HENON_HEILES_START, Splitting(name)) for name in SCHEMES},
    **{f"pendulum {name}": (PENDULUM, [1.0, 0.3], Splitting(name)) for name in SCHEMES},
    "driven verlet": (DRIVEN, DRIVEN_START, Splitting("verlet")),
    "kepler": (KEPLER, kepler_start(0.3), Splitting("verlet")),
    "chain 8": (chain(9), start_of(8), Splitting("blanes-moan-6")),
    "chain 32, verlet": (chain(33), start_of(32), Splitting("verlet")),
    "chain 32": (chain(33), start_of(32), Splitting("kahan-li-8")),
    "chain 200": (chain(201), start_of(200), Splitting("verlet")),
    "full matrix": (each_with_each(40), start_of(40), Splitting("kahan-li-8")),
}


GAUSS = {
    **{
        f"double pendulum, {s} stages": (DOUBLE_PENDULUM, DOUBLE_PENDULUM_START, Gauss(s))
        for s in range(1, 9)
    },
    "average vector field": (DOUBLE_PENDULUM, DOUBLE_PENDULUM_START, AverageVectorField(4)),
    "average vector field, Newton": (
        HENON_HEILES,
        HENON_HEILES_START,
        AverageVectorField(2, iteration="newton"),
    ),
    "driven": (DRIVEN, DRIVEN_START, Gauss(2)),
    "relativistic": (RELATIVISTIC, RELATIVISTIC_START, Gauss(3)),
    "chain 8": (chain(9), start_of(8), Gauss(4)),
    "Newton's iteration": (DOUBLE_PENDULUM, DOUBLE_PENDULUM_START, Gauss(3, iteration="newton")),
}


@pytest.mark.slow
def test_a_stiff_spring_is_symplectic_at_steps_of_the_slow_motion():
    """A pendulum on a spring of 10⁶, with a step of a hundred of its periods and more, by Newton's iteration."""
    x, y = coordinates("x y")
    r = sp.sqrt(x**2 + y**2)
    spring = Hamiltonian(
        (x.momentum**2 + y.momentum**2) / 2 + y + 10**6 * (r - 1) ** 2 / 2, [x, y], [x.momentum, y.momentum]
    )
    y0, method = [np.sin(0.5), -np.cos(0.5), 0.0, 0.0], Gauss(2, iteration="newton")
    going, M = moved(spring, y0, method, 0.05, span=5.0)
    motion = propagate(spring, (0, 5), y0, method=method, step=0.05, samples=40)
    np.testing.assert_array_equal(going.states()[:, 0], motion.y[:, -1])
    assert symplecticity_defect(M) < 1e-9 * abs(M).max() ** 2
    near = [
        propagate(spring, (0, 5), [y0[0] + d, *y0[1:]], method=method, step=0.05, samples=1).y[:, -1]
        for d in (1e-7, -1e-7)
    ]
    slope = (near[0] - near[1]) / 2e-7
    np.testing.assert_allclose(M[:, 0], slope, atol=1e-4 * abs(slope).max())


def check_tangent_map(system, y0, method):
    going, M = moved(system, y0, method, 0.05)
    motion = propagate(system, (0, 2), y0, method=method, step=0.05, samples=40)
    np.testing.assert_array_equal(going.states()[:, 0], motion.y[:, -1])
    np.testing.assert_array_equal(going.buffers.states()[1][:, 0], motion.carried[:, -1])
    known = flow_jacobian(system, (0, 2), y0, method=method, step=0.05).final
    size = abs(known).max()
    assert abs(M - known).max() < 1e-13 * size
    if method.is_symplectic:
        assert symplecticity_defect(M) < 40 * len(M) * 2.0**-53 * size**2
    _, beside = moved(system, 1.01 * np.array(y0), method, 0.05)
    assert abs(beside - known).max() > 1e-6 * size


@pytest.mark.parametrize(("system", "y0", "method"), SPLIT.values(), ids=SPLIT)
def test_splittings_carry_their_exact_derivative_beside_the_same_orbit(system, y0, method):
    check_tangent_map(system, y0, method)


@pytest.mark.slow
@pytest.mark.parametrize(("system", "y0", "method"), LONG.values(), ids=LONG)
def test_every_splitting_and_large_systems_do(system, y0, method):
    check_tangent_map(system, y0, method)


def test_gauss_methods_differentiate_their_stages():
    check_tangent_map(DOUBLE_PENDULUM, DOUBLE_PENDULUM_START, Gauss(2))


@pytest.mark.slow
@pytest.mark.parametrize(("system", "y0", "method"), GAUSS.values(), ids=GAUSS)
def test_every_gauss_method_does(system, y0, method):
    check_tangent_map(system, y0, method)


def test_steps_too_long_are_told_for_the_orbit_and_for_its_deviations():
    with pytest.raises(NonFiniteStateError, match="the state stops being finite"):
        moved(DOUBLE_PENDULUM, DOUBLE_PENDULUM_START, Gauss(2), 4.0, span=40.0)
    with pytest.raises(NonFiniteStateError, match="the deviations stop being finite"):
        moved(PENDULUM, [0.0, 0.0], Gauss(2), 4.0, span=40.0)  # at rest, so that the orbit converges


@pytest.mark.slow
@pytest.mark.parametrize("name", ["verlet", "blanes-moan-6"])
def test_differences_in_double_double_agree_with_the_map_and_not_with_another(name):
    _, M = moved(HENON_HEILES, HENON_HEILES_START, Splitting(name), 0.2, span=4.0)
    slopes = np.empty((4, 4))
    small = 2.0**-30
    for k in range(4):
        ends = []
        for sign in (1, -1):
            y0 = np.array(HENON_HEILES_START, dtype=np.longdouble)
            y0[k] += sign * small
            end = propagate(
                HENON_HEILES,
                (0, 4),
                y0,
                method=Splitting(name),
                step=0.2,
                precision="double-double",
                samples=1,
            )
            ends.append((end.y[:, -1], end.carried[:, -1]))
        (a, b), (c, d) = ends
        slopes[:, k] = ((a - c) + (b - d)) / (2 * small)
    np.testing.assert_allclose(M, slopes, atol=3e-15 * abs(slopes).max())
    _, coarser = moved(HENON_HEILES, HENON_HEILES_START, Splitting(name), 0.4, span=4.0)
    assert abs(coarser - slopes).max() > 1e-9


def test_many_orbits_are_the_single_ones_and_lie_side_by_side():
    starts = np.random.default_rng(2).uniform(-0.3, 0.3, (4, 37))
    task = task_of(HENON_HEILES, starts, Splitting("blanes-moan-4"), 0.1)
    together = deviation_growth(task, random_frame(4, 3, 1), orthogonal=True)
    motion = propagate(HENON_HEILES, (0, 2), starts, method=Splitting("blanes-moan-4"), step=0.1, samples=1)
    np.testing.assert_array_equal(together.states, motion.y[:, -1])
    for k in (0, 17, 36):
        alone = task_of(HENON_HEILES, starts[:, k], Splitting("blanes-moan-4"), 0.1)
        found = deviation_growth(alone, random_frame(4, 3, 1), orthogonal=True)
        np.testing.assert_allclose(together.log[:, :, k], found.log[:, :, 0], atol=1e-13)


def test_orbits_on_several_threads_are_those_on_one(monkeypatch):
    task = task_of(
        HENON_HEILES, np.random.default_rng(4).uniform(-0.3, 0.3, (4, 7)), Splitting("verlet"), 0.1
    )
    on_one = deviation_growth(task, random_frame(4, 2, 1), orthogonal=True)
    monkeypatch.setattr(module, "_LEAST", 2)
    monkeypatch.setattr(module.os, "cpu_count", lambda: 3)
    on_three = deviation_growth(task, random_frame(4, 2, 1), orthogonal=True)
    assert on_three.states.shape == (4, 7)
    np.testing.assert_array_equal(on_three.states, on_one.states)
    np.testing.assert_array_equal(on_three.log, on_one.log)
    np.testing.assert_array_equal(on_three.energy_error, on_one.energy_error)


def test_parameters_may_differ_from_orbit_to_orbit():
    x, k = coordinates("x"), sp.Symbol("k", real=True)
    saddle = Hamiltonian(x.momentum**2 / 2 - k**2 * x**2 / 2, [x], [x.momentum])
    values = np.array([0.5, 1.0, 2.0])
    task = task_of(saddle, [1e-3, 0.0], Splitting("kahan-li-8"), 0.05, span=20.0, parameters={k: values})
    found = deviation_growth(task, given_frame([1.0, 0.3], 2), orthogonal=False)
    assert found.states.shape == (2, 3)
    late = (found.log[0, -1] - found.log[0, 20]) / (found.t[-1] - found.t[20])
    np.testing.assert_allclose(late, values, rtol=1e-4)


@pytest.mark.slow
def test_more_vectors_than_stand_side_by_side_are_orthonormal():
    system, y0 = chain(9), start_of(8)
    task = task_of(system, y0, Splitting("verlet"), 0.1, span=40.0)
    going = CompiledDeviations(task, random_frame(16, 13, 3), orthogonal=True)
    for _ in task.plan.stops[1:]:
        going.advance()
    frame = going.vectors()[:, :, 0]
    assert frame.shape == (16, 13)
    np.testing.assert_allclose(frame.T @ frame, np.eye(13), atol=1e-13)


ENGINES = {
    "RK4": (DOUBLE_PENDULUM, DOUBLE_PENDULUM_START, RK4(), 0.05),
    "Taylor": (PENDULUM, [1.0, 0.3], Taylor(), None),
    "DOP853": (PENDULUM, [1.0, 0.3], DOP853(1e-13), None),
    "verlet": (HENON_HEILES, HENON_HEILES_START, Splitting("verlet"), 0.05),
}


def test_a_runge_kutta_method_carries_deviations_too():
    task = task_of(PENDULUM, [1.0, 0.3], RK4(), 0.25)
    going = VariationalDeviations(task, np.eye(2), orthogonal=False)
    log = sum(going.advance() for _ in task.plan.instants[1:])
    M = going.vectors()[:, :, 0] * np.exp(log[:, 0])
    known = flow_jacobian(PENDULUM, (0, 2), [1.0, 0.3], method=RK4(), step=0.25)
    np.testing.assert_allclose(M, known.final, atol=1e-11)
    np.testing.assert_allclose(going.states()[:, 0], known.y[:, -1], atol=1e-11)


def test_taylors_method_carries_deviations_too() -> None:
    task = task_of(PENDULUM, [1.0, 0.3], Taylor(), None, samples=32)
    going = VariationalDeviations(task, np.eye(2), orthogonal=False)
    log = sum(going.advance() for _ in task.plan.instants[1:])
    M = going.vectors()[:, :, 0] * np.exp(log[:, 0])
    known = flow_jacobian(PENDULUM, (0, 2), [1.0, 0.3], method=Taylor())
    np.testing.assert_allclose(M, known.final, atol=1e-13)
    np.testing.assert_allclose(going.states()[:, 0], known.y[:, -1], atol=1e-13)


def test_deviations_that_grow_slowly_are_renormalised_ever_more_rarely() -> None:
    x = coordinates("x")
    spring = Hamiltonian((x.momentum**2 + x**2) / 2, [x], [x.momentum])
    task = task_of(spring, [1.0, 0.0], Splitting("verlet"), 0.01, span=400.0)
    going = CompiledDeviations(task, np.eye(2), orthogonal=True)
    stretches = [(going.advance(), going.every)[1] for _ in range(8)]
    assert stretches == sorted(set(stretches))
    assert going.vectors()[:, :, 0].T @ going.vectors()[:, :, 0] == pytest.approx(np.eye(2), abs=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize(("system", "y0", "method", "step"), ENGINES.values(), ids=ENGINES)
def test_other_engines_carry_deviations_too(system, y0, method, step):
    task = task_of(system, y0, method, step)
    going = VariationalDeviations(task, np.eye(len(y0)), orthogonal=False)
    log = sum(going.advance() for _ in task.plan.instants[1:])
    M = going.vectors()[:, :, 0] * np.exp(log[:, 0])
    known = flow_jacobian(system, (0, 2), y0, method=method, step=step)
    np.testing.assert_allclose(M, known.final, atol=1e-11 * abs(known.final).max())
    np.testing.assert_allclose(going.states()[:, 0], known.y[:, -1], atol=1e-11)


def test_deviations_are_of_doubles_and_of_some_length():
    with pytest.raises(ValueError, match="deviations are moved in doubles"):
        CompiledDeviations(
            task_of(HENON_HEILES, HENON_HEILES_START, Splitting("verlet"), 0.1, precision="extended"),
            np.eye(4),
            orthogonal=True,
        )
    with pytest.raises(ValueError, match="deviation vector 0 is zero"):
        given_frame([0.0, 0.0, 0.0, 0.0], 4)
    with pytest.raises(ValueError, match="shape \\(3,\\)"):
        given_frame([1.0, 0.0, 0.0], 4)
    with pytest.raises(ValueError, match="not finite"):
        given_frame([1.0, np.nan, 0.0, 0.0], 4)
