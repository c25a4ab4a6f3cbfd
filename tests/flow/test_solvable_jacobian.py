"""Jacobians of splittings by solvable parts: derivatives of the compiled map, symplectic to round-off."""

import numpy as np
import pytest

from canon.flow.geometry.flow_jacobian import flow_jacobian
from canon.flow.geometry.kepler_derivative import kepler_derivative
from canon.flow.geometry.solvable_jacobian import _step
from canon.flow.integrate import integrate
from canon.flow.method.method import Splitting
from canon.flow.method.solvable_splitting import SABA, SBAB, SolvableSplitting, WisdomHolman
from canon.flow.propagation import propagate
from canon.flow.request import Request
from canon.flow.system_request import any_task
from canon.kernel.solvable.solvable_parts import named_part, solvable_part
from tests.flow.systems import HENON_HEILES, HENON_HEILES_START, KEPLER, System, kepler_start
from tests.flow.test_solvable import planets, planets_start

x, y = KEPLER.q
SOLAR, MASSES = planets("0.01")
SOLAR_START = planets_start(MASSES)
TIDE = System(KEPLER.H + (x**2 - y**2) / 20, KEPLER.q, KEPLER.p)
PARTS = (KEPLER.H, (x**2 - y**2) / 20)

CASES = [
    (SOLAR, SOLAR_START, WisdomHolman()),
    (SOLAR, SOLAR_START, WisdomHolman(corrector=7)),
    (SOLAR, SOLAR_START, SABA("10-6-4")),
    (SOLAR, SOLAR_START, SBAB(3)),
    (SOLAR, SOLAR_START, SABA(2, commutator=True)),
    (TIDE, kepler_start(0.3), SABA(3)),
    (TIDE, kepler_start(0.3), SABA(3, commutator=True)),
    (TIDE, kepler_start(0.3), Splitting("blanes-moan-4", parts=PARTS)),
    (HENON_HEILES, HENON_HEILES_START, WisdomHolman()),
    (HENON_HEILES, HENON_HEILES_START, SBAB(2, commutator=True)),
]
NAMES = [f"{len(start) // 2} degrees, {method}" for _, start, method in CASES]


def differences(system, start, span, width, **how):
    """Central differences of the motion's end, once extrapolated, by an ensemble."""
    start = np.array(start)[:, np.newaxis]

    def central(d):
        units = d * np.eye(len(start))
        ends = propagate(system, span, np.hstack([start + units, start - units]), samples=1, **how).y[:, -1]
        there, back = np.hsplit(ends, 2)
        return (there - back) / (2 * d)

    return (4 * central(width) - central(2 * width)) / 3


@pytest.mark.parametrize(("system", "start", "method"), CASES, ids=NAMES)
def test_it_is_the_derivative_of_the_compiled_map(system, start, method):
    how = {"method": method, "step": 0.25}
    found = flow_jacobian(system, (0, 10), start, samples=4, **how)
    rough = differences(system, start, (0, 10), 2e-6, **how)
    np.testing.assert_allclose(found.final, rough, atol=5e-9 * abs(rough).max())
    motion = propagate(system, (0, 10), start, samples=4, **how)
    np.testing.assert_array_equal(found.y, motion.y)
    np.testing.assert_array_equal(found.t, motion.t)
    np.testing.assert_array_equal(found.M[:, :, 0], np.eye(len(start)))


@pytest.mark.parametrize(("system", "start", "method"), CASES, ids=NAMES)
def test_it_is_symplectic_to_round_off_at_coarse_steps(system, start, method):
    found = flow_jacobian(system, (0, 10), start, method=method, step=0.5, samples=20)
    assert found.symplecticity_defect.max() < 300 * 2.0**-53 * abs(found.M).max() ** 2


@pytest.mark.parametrize(("system", "start", "method"), CASES, ids=NAMES)
def test_its_steps_are_those_of_the_compiled_loop(system, start, method):
    task, _ = any_task(Request(system, (0, 2), start, method=method, step=0.25, samples=8))
    own = method
    if isinstance(method, Splitting):
        own = SolvableSplitting(method.scheme, parts=method.parts)
    part = named_part(task.system, *own.parts) if own.parts else solvable_part(task.system)
    states, delta = (
        integrate(task).y[:, :, 0],
        np.broadcast_to(np.eye(len(start)), (8, len(start), len(start))),
    )
    moved = states[:, :-1]
    for move in _step(task.system, part, own, task.plan.h).moves:
        moved, delta = move(moved, delta)
    np.testing.assert_allclose(moved, states[:, 1:], atol=2e-14)


def test_a_coarse_map_s_is_not_the_flow_s_and_a_fine_one_s_is():
    flow = flow_jacobian(TIDE, (0, 8), kepler_start(0.3))
    coarse, fine = (
        flow_jacobian(TIDE, (0, 8), kepler_start(0.3), method=SABA("10-6-4"), step=h) for h in (0.8, 0.0125)
    )
    size = abs(flow.final).max()
    assert abs(coarse.final - flow.final).max() > 1e-6 * size
    assert abs(fine.final - flow.final).max() < 1e-12 * size


def test_the_order_of_the_jacobian():
    flow = flow_jacobian(SOLAR, (0, 6), SOLAR_START).final
    steps = np.array([0.25, 0.2, 0.15])
    errors = [
        abs(flow_jacobian(SOLAR, (0, 6), SOLAR_START, method=WisdomHolman(), step=h).final - flow).max()
        for h in steps
    ]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(2, abs=0.3)


def test_kepler_s_problem_is_its_own_flow_in_one_step():
    flow = flow_jacobian(KEPLER, (0, 20), kepler_start(0.9), precision="extended")
    found = flow_jacobian(KEPLER, (0, 20), kepler_start(0.9), method=WisdomHolman(), step=5.0)
    np.testing.assert_allclose(found.final, flow.final, atol=1e-12 * abs(flow.final).max())


def test_many_steps_go_in_blocks():
    found = flow_jacobian(TIDE, (0, 60), kepler_start(0.3), method=SABA(2), step=0.05, samples=2)
    half = flow_jacobian(TIDE, (0, 30), kepler_start(0.3), method=SABA(2), step=0.05)
    np.testing.assert_allclose(found.M[:, :, 1], half.final, rtol=1e-11, atol=1e-11)
    assert found.symplecticity_defect[-1] < 1e-13 * abs(found.final).max() ** 2


@pytest.mark.parametrize("t", [0.01, -2.0, 7.0, 40.0])
def test_kepler_s_flow_for_ellipses_and_hyperbolas(t):
    rng = np.random.default_rng(1)
    places, velocities = rng.normal(size=(2, 3, 500))
    moved, turned, M = kepler_derivative(places, velocities, 1.0, t)
    J = np.kron([[0, 1], [-1, 0]], np.eye(3))
    defect = np.einsum("jik,jl,lmk->imk", M, J, M) - J[:, :, np.newaxis]
    size = abs(M).max(axis=(0, 1))
    assert (abs(defect).max(axis=(0, 1)) < 2e-13 * size**2).all()
    back = kepler_derivative(moved, turned, 1.0, -t)
    np.testing.assert_allclose(np.vstack(back[:2]), np.vstack([places, velocities]), atol=1e-9)
    if abs(t) < 10:  # over long times what rounds the state after t turns the way back
        inverse = np.einsum("ijk,jlk->ilk", back[2], M)
        assert (abs(inverse - np.eye(6)[:, :, np.newaxis]).max(axis=(0, 1)) < 1e-12 * size**2).all()


def test_kepler_s_derivative_about_a_circle():
    # Hill's equations in the turning frame, solved by Clohessy and Wiltshire (1960), after a quarter of a period.
    *_, M = kepler_derivative(np.array([[1.0], [0.0]]), np.array([[0.0], [1.0]]), 1.0, np.pi / 2)
    hill = np.array(
        [
            [4.0, 0.0, 1.0, 2.0],
            [6 - 3 * np.pi, 1.0, -2.0, 4 - 3 * np.pi / 2],
            [3.0, 0.0, 0.0, 2.0],
            [-6.0, 0.0, -2.0, -3.0],
        ]
    )
    spin, none = np.array([[0.0, -1.0], [1.0, 0.0]]), np.zeros((2, 2))
    # x = R ξ, v = R (ξ' + ω × ξ), R the identity at the start and a quarter turn at the end.
    into = np.block([[np.eye(2), none], [-spin, np.eye(2)]])
    out = np.block([[spin, none], [spin @ spin, spin]])
    np.testing.assert_allclose(M[:, :, 0], out @ hill @ into, atol=1e-14)


def test_what_is_not_known_is_refused():
    with pytest.raises(ArithmeticError, match="not solved"):
        kepler_derivative(np.array([[np.nan], [0.0]]), np.array([[0.0], [1.0]]), 1.0, 1.0)
    heliocentric = WisdomHolman(coordinates="democratic-heliocentric")
    with pytest.raises(ValueError, match="kicks depend on momenta"):
        flow_jacobian(SOLAR, (0, 1), SOLAR_START, method=heliocentric, step=0.25)
