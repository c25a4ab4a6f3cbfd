"""Jacobians of splittings by solvable parts: derivatives of the compiled map, symplectic to round-off."""

import numpy as np
import pytest

from canon.flow.geometry.flow_jacobian import flow_jacobian
from canon.flow.method.method import Splitting
from canon.flow.method.solvable_splitting import SABA, SBAB, WisdomHolman
from canon.flow.propagation import propagate
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.tangent.compiled_deviations import CompiledDeviations
from tests.flow.systems import HENON_HEILES, HENON_HEILES_START, KEPLER, System, kepler_start
from tests.flow.test_solvable import planets, planets_start
from tests.flow.test_tangent_maps import task_of

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
    (SOLAR, SOLAR_START, WisdomHolman(coordinates="democratic-heliocentric")),
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


@pytest.mark.slow
@pytest.mark.parametrize(("system", "start", "method"), CASES, ids=NAMES)
@pytest.mark.parametrize(("precision", "bits"), [("extended", 64), ("double-double", 104)])
def test_it_is_known_and_symplectic_in_wider_numbers_too(system, start, method, precision, bits):
    how = {"method": method, "step": 0.25}
    found = flow_jacobian(system, (0, 10), start, precision=precision, **how)
    narrow = flow_jacobian(system, (0, 10), start, **how)
    size, unit = abs(found.final).max(), 2.0**-bits
    assert abs(narrow.final - found.final).max() < 1e-12 * size
    assert found.symplecticity_defect[-1] < 1000 * unit * size**2


@pytest.mark.slow
@pytest.mark.parametrize(("system", "start", "method"), CASES, ids=NAMES)
def test_differences_in_double_double_agree_with_it_and_not_with_another(system, start, method):
    how, small, slopes = {"method": method, "step": 0.25}, 2.0**-28, np.empty((len(start), len(start)))
    for k in range(len(start)):
        ends = []
        for sign in (1, -1):
            y0 = np.array(start, dtype=np.longdouble)
            y0[k] += sign * small
            end = propagate(system, (0, 2), y0, precision="double-double", samples=1, **how)
            ends.append((end.y[:, -1], end.carried[:, -1]))
        (a, b), (c, d) = ends
        slopes[:, k] = ((a - c) + (b - d)) / (2 * small)
    found = flow_jacobian(system, (0, 2), start, **how).final
    # The third derivative along light planets' momenta is large: p stands with 1/m.
    np.testing.assert_allclose(found, slopes, atol=1e-9 * abs(slopes).max())
    coarser = flow_jacobian(system, (0, 2), start, method=method, step=1.0).final
    assert abs(coarser - slopes).max() > 30 * abs(found - slopes).max()


@pytest.mark.slow
@pytest.mark.parametrize(("system", "start", "method"), CASES, ids=NAMES)
def test_the_orbit_beside_deviations_is_the_one_without(system, start, method):
    task = task_of(system, start, method, 0.25, span=10.0)
    going = CompiledDeviations(task, np.eye(len(start)), orthogonal=True)
    for _ in task.plan.stops[1:]:
        going.advance()
    motion = propagate(system, (0, 10), start, method=method, step=0.25, samples=40)
    np.testing.assert_array_equal(going.states()[:, 0], motion.y[:, -1])
    np.testing.assert_array_equal(going.buffers.states()[1][:, 0], motion.carried[:, -1])


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


def test_neighbours_that_part_beyond_doubles_are_told_in_stretches():
    saddle = System(
        x.momentum**2 / 2 + y.momentum**2 / 2 - 2 * x * x - y * y + x**4 / 1000, KEPLER.q, KEPLER.p
    )
    found = flow_jacobian(saddle, (0, 400), [0.0, 0.0, 0.0, 0.0], method=WisdomHolman(), step=0.1)
    assert found.exponent[-1] > 1023
    assert found.log_size[-1] == pytest.approx(800 + np.log(0.5 * 2), abs=1e-9)


def test_an_orbit_that_leaves_the_finite_numbers_is_told():
    falling = System(x.momentum**2 / 2 + y.momentum**2 / 2 - x**4, KEPLER.q, KEPLER.p)
    with pytest.raises(NonFiniteStateError, match="stops being finite"):
        flow_jacobian(falling, (0, 50), [1.0, 0.0, 1.0, 0.0], method=WisdomHolman(), step=0.1)
