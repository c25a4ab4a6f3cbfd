"""The Jacobian of time-transformed motions: that of the discrete map with its landing, by three routes."""

import numpy as np
import pytest
import sympy as sp

from canon.flow.geometry.flow_jacobian import flow_jacobian, reversal_error
from canon.flow.method.method import Gauss, Splitting, TimeTransformed
from canon.flow.propagation import propagate
from canon.flow.run.non_finite_state import NonFiniteStateError
from tests.flow.systems import DRIVEN, DRIVEN_START, KEPLER, System, kepler_start

x, y = KEPLER.q
px, py = KEPLER.p
RADIUS = sp.sqrt(x**2 + y**2)
VERLET = TimeTransformed(Splitting("verlet"))
METHODS = [
    (VERLET, 0.02),
    (TimeTransformed(Splitting("kahan-li-8")), 0.04),
    (TimeTransformed(Gauss(2), RADIUS), 0.04),
]
TIMES = [1.0, 2.0, 6.5]


def differences(system, start, span, width, **how):
    """Central differences of the motion, once extrapolated."""

    def central(d):
        columns = []
        for unit in np.eye(len(start)):
            there, back = (propagate(system, span, start + s * d * unit, **how).y for s in (1, -1))
            columns.append((there - back) / (2 * d))
        return np.stack(columns, axis=1)

    return (4 * central(width) - central(2 * width)) / 3


@pytest.mark.parametrize(("method", "step"), METHODS, ids=str)
def test_it_is_the_derivative_of_what_propagate_computes(method, step):
    start = np.array(kepler_start(0.6))
    found = flow_jacobian(KEPLER, (0, 8), start, method=method, step=step, times=TIMES)
    rough = differences(KEPLER, start, (0, 8), 1e-5, method=method, step=step, times=TIMES)
    np.testing.assert_array_equal(found.t, [0, *TIMES, 8])
    np.testing.assert_array_equal(found.M[:, :, 0], np.eye(4))
    np.testing.assert_allclose(found.M, rough, atol=1e-8 * abs(found.M).max())
    motion = propagate(KEPLER, (0, 8), start, method=method, step=step, times=TIMES)
    np.testing.assert_allclose(found.y, motion.y, atol=1e-13)


def test_the_derivative_of_a_coarse_map_is_not_the_flow_s():
    # So the differences above tell one from the other.
    start = kepler_start(0.6)
    flow = flow_jacobian(KEPLER, (0, 8), start, times=TIMES)
    coarse = flow_jacobian(KEPLER, (0, 8), start, method=VERLET, step=0.02, times=TIMES)
    assert abs(coarse.M - flow.M).max() > 1e-3 * abs(flow.M).max()


@pytest.mark.parametrize(
    ("method", "steps"),
    [(VERLET, [0.01, 0.007, 0.005]), (TimeTransformed(Gauss(2), RADIUS), [0.03, 0.02, 0.014])],
    ids=str,
)
def test_the_order_at_which_it_becomes_the_flow_s_and_symplectic(method, steps):
    start = kepler_start(0.9)
    flow = flow_jacobian(KEPLER, (0, 8), start, times=[2.0, 6.5])
    steps = np.array(steps) / 4
    found = [flow_jacobian(KEPLER, (0, 8), start, method=method, step=h, times=[2.0, 6.5]) for h in steps]
    errors = [abs(each.M - flow.M).max() for each in found]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(method.order, abs=0.3)
    sizes = [abs(each.M).max() ** 2 for each in found]
    assert all(each.symplecticity_defect.max() < 10 * e for each, e in zip(found, errors, strict=True))
    assert found[-1].symplecticity_defect.max() < 1e-6 * sizes[-1]


def test_fine_steps_give_the_flow_s_to_round_off():
    start = kepler_start(0.6)
    flow = flow_jacobian(KEPLER, (0, 8), start, samples=4, precision="extended")
    method = TimeTransformed(Splitting("kahan-li-8"))
    found = flow_jacobian(KEPLER, (0, 8), start, method=method, step=0.02, samples=4)
    np.testing.assert_array_equal(found.t, np.linspace(0, 8, 5))
    np.testing.assert_allclose(found.M, flow.M, atol=1e-14 * abs(flow.M).max())
    assert found.symplecticity_defect.max() < 1e-17 * abs(flow.M).max() ** 2


def test_driven_systems_with_parameters_and_backwards():
    k = sp.Symbol("p_t", real=True)
    tide = System(KEPLER.H - k * (2 + sp.cos(KEPLER.t)) / RADIUS / 20, KEPLER.q, KEPLER.p)
    given = {"times": [-2.0, -3.0], "parameters": {"p_t": 1}}
    true = flow_jacobian(tide, (1, -5), kepler_start(0.5), **given)
    for method in (TimeTransformed(Splitting("kahan-li-8")), TimeTransformed(Gauss(6), RADIUS)):
        found = flow_jacobian(tide, (1, -5), kepler_start(0.5), method=method, step=0.02, **given)
        np.testing.assert_allclose(found.M, true.M, atol=1e-11 * abs(true.M).max())
    swing = TimeTransformed(Gauss(5), 1 / (1 + DRIVEN.p[0] ** 2))
    found = flow_jacobian(DRIVEN, (0, 9), DRIVEN_START, method=swing, step=0.05)
    true = flow_jacobian(DRIVEN, (0, 9), DRIVEN_START)
    np.testing.assert_allclose(found.final, true.final, atol=1e-11)


def test_a_collision_is_told_in_t():
    with pytest.raises(NonFiniteStateError, match=r"not finite after t = 1\.1") as lost:
        flow_jacobian(KEPLER, (0, 2), [1.0, 0, 0, 0], method=TimeTransformed(Gauss(3), RADIUS), step=0.01)
    assert lost.value.state.shape == (4,)
    with pytest.raises(ValueError, match="one orbit"):
        flow_jacobian(KEPLER, (0, 2), np.ones((4, 2)), method=VERLET, step=0.01)


def test_there_and_back_again_misses_by_the_methods_error():
    missed = [
        abs(reversal_error(KEPLER, (0, 8), kepler_start(0.6), method=VERLET, step=h)).max()
        for h in (0.02, 0.005)
    ]
    assert 1e-6 < missed[1] < missed[0] / 4
