"""Splittings of two copies of phase space: order, reversal, symplecticity, the copies together, precisions."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian, coordinates, flow_jacobian, parameters, propagate
from canon.flow import reversal_error
from canon.flow.fixed_step.compiled_loop import compiled_loop, steps_between
from canon.flow.fixed_step.partial_step import LoopState
from canon.flow.method.composition import COMPOSITIONS, weights_of_order
from canon.flow.method.method import Splitting
from canon.flow.method.nonseparable_splitting import (
    ExtendedPhaseSpace,
    SemiexplicitSplitting,
)
from canon.flow.method.number_formats import fixed_precision
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.run.sampling_plan import fixed_plan
from canon.kernel.loops.doubled_phase_space import mixing_coefficients, projecting_coefficients
from canon.kernel.program.hamilton_equations import equations
from canon.scene import find
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

METHODS = [
    *(SemiexplicitSplitting(order) for order in COMPOSITIONS),
    *(ExtendedPhaseSpace(order, omega=4) for order in COMPOSITIONS),
]


def slow(method):
    return pytest.param(method, marks=pytest.mark.slow)


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS, ids=str)
def test_fitted_order(method):
    window, longest = (1e-7, 1e-4) if method.order == 2 else (3e-13, 1e-6), 1.0
    if isinstance(method, ExtendedPhaseSpace):
        longest = 0.1
    slope = fitted_order(RELATIVISTIC, RELATIVISTIC_START, method, window=window, span=20.0, longest=longest)
    assert slope == pytest.approx(method.order, abs=0.05 * method.order)
    if method.order < 8:
        assert fitted_order(DRIVEN, DRIVEN_START, method) == pytest.approx(
            method.order, abs=0.05 * method.order
        )


@pytest.mark.parametrize("method", [METHODS[1], METHODS[5]], ids=str)
def test_halving_the_step_divides_the_error_by_two_to_the_order(method):
    true = propagate(DOUBLE_PENDULUM, (0, 6), DOUBLE_PENDULUM_START, samples=1).final
    steps = {2: 200, 4: 200, 6: 100}[method.order]
    errors = [
        abs(
            propagate(
                DOUBLE_PENDULUM, (0, 6), DOUBLE_PENDULUM_START, method=method, step=6 / n, samples=1
            ).final
            - true
        ).max()
        for n in (steps, 2 * steps)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(method.order, abs=0.05 * method.order)


@pytest.mark.parametrize("method", [METHODS[1], *map(slow, (METHODS[0], *METHODS[2:4]))], ids=str)
def test_projected_methods_reverse_and_are_symplectic_in_the_space_itself(method):
    start = {"system": DOUBLE_PENDULUM, "y0": DOUBLE_PENDULUM_START, "method": method}
    assert abs(reversal_error(t_span=(0, 6), step=0.05, **start)).max() < 2e-15
    assert flow_jacobian(t_span=(0, 2), step=0.2, **start).symplecticity_defect[-1] < 2e-14


def state_of_copies(method, h=Fraction(1, 8)):
    """One compiled step as a map of the doubled phase space (q, y, x, p), whose form is dq∧dp + dx∧dy."""
    system = equations(DOUBLE_PENDULUM.H, DOUBLE_PENDULUM.q, DOUBLE_PENDULUM.p, DOUBLE_PENDULUM.t, {})
    loop = compiled_loop(system, method, fixed_precision("double"))
    steps = steps_between(loop, method, fixed_plan(Fraction(0), h, (0, 1)))

    def moved(z, direction=1):
        q, y, x, p = np.split(np.asarray(z, dtype=float), 4)
        mean, apart = np.concatenate([q + x, p + y]) / 2, np.concatenate([x - q, y - p]) / 2
        state = LoopState(mean[:, None], np.zeros((4, 1)), apart[None])
        backwards = replace(steps, h=direction * h)
        found = backwards.whole(state, 0, 1)
        c, d = found.high[:, 0], found.beyond[0]
        return np.concatenate([c[:2] - d[:2], c[2:] + d[2:], c[:2] + d[:2], c[2:] - d[2:]])

    return moved


@pytest.mark.parametrize("method", [METHODS[4], *map(slow, METHODS[5:])], ids=str)
def test_mixed_methods_reverse_and_are_symplectic_in_the_doubled_space(method):
    """Which is tested with copies far apart, where neither copy by itself is."""
    step, delta = state_of_copies(method), 2.0**-9
    z = np.array([1.0, 0.4, -0.3, 0.2, 0.7, 0.6, 0.1, -0.2])
    assert abs(step(step(z), -1) - z).max() < 1e-14
    weights = ((1, 45), (2, -9), (3, 1))
    unit = np.eye(8) * delta
    columns = [sum(w * (step(z + k * e) - step(z - k * e)) for k, w in weights) / (60 * delta) for e in unit]
    M, J = np.array(columns).T, np.zeros((8, 8))
    for i, (a, b) in enumerate(((0, 6), (1, 7), (4, 2), (5, 3))):
        J[a, b], J[b, a] = 1, -1
        assert i < 4
    assert abs(M.T @ J @ M - J).max() < 1e-9
    one_copy = np.ix_([0, 1, 6, 7], [0, 1, 6, 7])
    assert abs((M.T @ J @ M)[one_copy] - (M[one_copy].T @ J[one_copy] @ M[one_copy])).max() > 1e-4


@pytest.mark.slow
def test_quadratic_integrals_are_kept_by_the_projected_method():
    x, y, px, py = *KEPLER.q, *KEPLER.p
    momentum = {"L": x * py - y * px}
    motion = propagate(
        KEPLER,
        (0, 100),
        kepler_start(0.5),
        method=SemiexplicitSplitting(4),
        step=0.05,
        observables=momentum,
    )
    assert abs(motion.energy_error).max() > 1e-6
    assert abs(motion.changes["L"]).max() < 2e-15


@pytest.mark.slow
def test_where_h_splits_the_copies_are_a_splitting_each():
    """With T(p) + V(q) and no rotation worth the name, one copy takes Verlet's steps and the other their dual's."""
    tiny = ExtendedPhaseSpace(2, omega=1e-12)
    found = propagate(KEPLER, (0, 5), kepler_start(0.3), method=tiny, step=0.01, samples=1).final
    drift_first = propagate(
        KEPLER, (0, 5), kepler_start(0.3), method=Splitting("verlet"), step=0.01, samples=1
    ).final
    kick_first = propagate(
        KEPLER, (0, 5), kepler_start(0.3), method=Splitting(a=[0, 1], b=[0.5, 0.5]), step=0.01, samples=1
    ).final
    assert abs(found - (drift_first + kick_first) / 2).max() < 1e-11


@pytest.mark.slow
@pytest.mark.parametrize("method", [SemiexplicitSplitting(4), ExtendedPhaseSpace(4, omega=5)], ids=str)
def test_energy_stays_bounded_in_long_runs_of_the_double_pendulum(method):
    motion = propagate(
        DOUBLE_PENDULUM, (0, 5000), DOUBLE_PENDULUM_START, method=method, step=0.05, samples=500
    )
    error = abs(motion.energy_error)
    assert error.max() < 2e-7
    assert error[-100:].max() < 10 * error[1:101].max()


@pytest.mark.slow
def test_the_restricted_three_body_problem_keeps_jacobis_integral():
    scene = find("restricted-three-body")
    start = np.add(scene.state("tadpole"), [0.01, 0.0, 0.0, 0.0])
    motion = propagate(
        scene, (0, 1000 * scene.period), start, method=SemiexplicitSplitting(4), step=scene.period / 100
    )
    assert abs(motion.y[0] - start[0]).max() > 0.1
    assert abs(motion.energy_error).max() < 1e-8


@pytest.mark.parametrize("method", [SemiexplicitSplitting(6), ExtendedPhaseSpace(6, omega=5)], ids=str)
def test_same_bits_alone_among_others_and_resumed(method):
    arguments = {"method": method, "step": 0.05}
    one = propagate(DOUBLE_PENDULUM, (0, 2), DOUBLE_PENDULUM_START, samples=7, **arguments)
    start = np.array(DOUBLE_PENDULUM_START)[:, None] * [1.0, 1.0, 0.9, 1.1, 1.0]
    many = propagate(DOUBLE_PENDULUM, (0, 2), start, samples=7, **arguments)
    np.testing.assert_array_equal(many.y[:, :, 1], one.y)
    again = propagate(DOUBLE_PENDULUM, (0, 1), DOUBLE_PENDULUM_START, samples=3, **arguments).resume(2)
    np.testing.assert_array_equal(again.final, one.final)


@pytest.mark.slow
@pytest.mark.parametrize("method", [SemiexplicitSplitting(2), ExtendedPhaseSpace(2, omega=5)], ids=str)
def test_precisions_differ_by_their_rounding(method):
    ends = {
        precision: propagate(
            DOUBLE_PENDULUM,
            (0, 1),
            DOUBLE_PENDULUM_START,
            method=method,
            step=0.125,
            samples=1,
            precision=precision,
        )
        for precision in ("single", "double", "compensated", "extended", "double-double")
    }
    true = ends["double-double"]
    for precision, unit in (("single", 2e-6), ("double", 2e-15), ("compensated", 5e-16), ("extended", 3e-18)):
        found = ends[precision]
        assert abs((found.y - true.y) + (found.carried - true.carried)).max() < unit


@pytest.mark.slow
def test_parameters_by_orbit():
    (q,), k = (coordinates("q"),), parameters("k", positive=True)
    spring = Hamiltonian(q.momentum**2 * (1 + q**2 / 10) / 2 + k * q**2 / 2, [q], [q.momentum])
    for method in (SemiexplicitSplitting(4), ExtendedPhaseSpace(4, omega=4)):
        setting = {"method": method, "step": 0.05, "samples": 1}
        both = propagate(spring, (0, 3), [1.0, 0.0], parameters={k: np.array([1.0, 2.0])}, **setting)
        one = propagate(spring, (0, 3), [1.0, 0.0], parameters={k: 2}, **setting)
        assert abs(both.final[:, 1] - one.final).max() < 1e-14


def test_coefficients_are_exact():
    weights, h = weights_of_order(4), Fraction(1, 8)
    halves = projecting_coefficients(weights, h)
    assert sum(halves[::2]) == sum(halves[1::2]) == h / 2
    rows = mixing_coefficients(weights, Fraction(3), h)
    cosine, sine = rows[-2:]
    assert float(cosine) == float(sp.cos(3 * h * weights[0]).evalf(40))
    assert abs(cosine**2 + sine**2 - 1) < Fraction(1, 10**58)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: SemiexplicitSplitting(3), r"SemiexplicitSplitting\(3\): the order is one of 2, 4, 6, 8"),
        (lambda: ExtendedPhaseSpace(4), "give omega, a positive number"),
        (lambda: ExtendedPhaseSpace(4, omega=-1.0), "omega=-1.0"),
        (lambda: ExtendedPhaseSpace(5, omega=1.0), "the order is one of"),
    ],
)
def test_wrong_choices_are_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_a_hamiltonian_that_does_not_split_is_told_of_them():
    with pytest.raises(ValueError, match=r"SemiexplicitSplitting\(4\) or ExtendedPhaseSpace\(4, omega=…\)"):
        propagate(DOUBLE_PENDULUM, (0, 1), DOUBLE_PENDULUM_START, method="verlet", step=0.1)


def test_a_step_that_is_too_large_is_an_error_with_the_state_before_it():
    with pytest.raises(NonFiniteStateError, match=r"do not converge .*smaller") as caught:
        propagate(KEPLER, (0, 100), kepler_start(0.9), method=SemiexplicitSplitting(2), step=1.0)
    assert np.isfinite(caught.value.state).all()


@pytest.mark.slow
def test_a_projection_costs_little_more_than_one_repetition_where_steps_are_small():
    motion = propagate(
        DOUBLE_PENDULUM, (0, 20), DOUBLE_PENDULUM_START, method=SemiexplicitSplitting(8), step=0.02
    )
    assert motion.evaluations < 1.5 * motion.steps * motion.method.stages


@pytest.mark.parametrize("order", [2, 4, 6, 8])
def test_half_steps_that_meet_are_one_stage(order: int) -> None:
    """A half, B, A half: of n such steps side by side, 2n + 1 stages are left; with the turn of the copies 3n."""
    leapfrogs = len(weights_of_order(order))
    assert SemiexplicitSplitting(order).stages == 3 * leapfrogs - (leapfrogs - 1)
    assert ExtendedPhaseSpace(order, omega=1).stages == 3 * leapfrogs


def test_the_way_back_begins_with_both_copies():
    """From their mean alone it missed the start by what the copies are apart."""
    for method in (ExtendedPhaseSpace(4, omega=20), SemiexplicitSplitting(4)):
        starts = np.array(
            [[1.0, 0.5], [0.3, 0.2], [0.0, 0.0], [0.0, 0.0]]
        )  # at rest, where momenta are round-off
        missed = reversal_error(DOUBLE_PENDULUM, (0, 5), starts, method=method, step=0.02)
        assert abs(missed).max() < 1e-14
