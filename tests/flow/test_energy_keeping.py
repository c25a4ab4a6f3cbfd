"""Average vector field methods: the energy kept, orders, reversal, closed forms, no symplecticity, edges, trouble."""

import numpy as np
import pytest
from scipy.optimize import brentq

from canon import Event, Gauss, Lagrangian, choose, flow_jacobian, load_motion, propagate
from canon.flow import AverageVectorField, reversal_error
from canon.flow.method.method import RK4
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.scene import find
from canon.study.errors import StudyError
from canon.study.method_choice.candidate import candidate_methods
from canon.study.method_choice.choice_question import Question
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
    System,
    kepler_start,
    phi,
    theta,
    time,
    x,
    y,
)
from tests.flow.test_order import fitted_order

U = 2.0**-53
SWING = [2.0, 0.3]
TWO = System(
    (x.momentum**2 + 2 * y.momentum**2 + 3 * x**2 + x * y + y**2) / 2, (x, y), (x.momentum, y.momentum)
)


def well(power):
    return System(x.momentum**2 / 2 + x**power / power, (x,), (x.momentum,))


def order_seen(system, start, method, steps, span=6):
    """log₂ of the errors with steps and with steps of half the size."""
    true = propagate(system, (0, span), start).final
    errors = [
        abs(propagate(system, (0, span), start, method=method, step=span / n, samples=1).final - true).max()
        for n in (steps, 2 * steps)
    ]
    return np.log2(errors[0] / errors[1])


@pytest.mark.parametrize(
    ("order", "system", "start", "steps"),
    [
        (2, HENON_HEILES, HENON_HEILES_START, 60),
        (4, PENDULUM, SWING, 40),
    ],
)
def test_halving_the_step_divides_the_error_by_two_to_the_order(order, system, start, steps):
    assert order_seen(system, start, AverageVectorField(order), steps) == pytest.approx(
        order, abs=0.05 * order
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("system", "start"),
    [
        (HENON_HEILES, HENON_HEILES_START),
        (PENDULUM, SWING),
        (RELATIVISTIC, RELATIVISTIC_START),
        (DRIVEN, DRIVEN_START),
    ],
    ids=["hénon-heiles", "pendulum", "relativistic", "driven"],
)
@pytest.mark.parametrize("order", [2, 4, 6, 8])
def test_fitted_order(system, start, order):
    window = (1e-7, 1e-4) if order == 2 else (3e-12, 1e-5)
    assert fitted_order(
        system, start, AverageVectorField(order), window=window, longest=1.0
    ) == pytest.approx(order, abs=0.06 * order)


@pytest.mark.slow
@pytest.mark.parametrize("order", [10, 12, 16])
def test_fitted_order_of_high_orders(order):
    found = fitted_order(
        RELATIVISTIC,
        RELATIVISTIC_START,
        AverageVectorField(order),
        window=(3e-13, 1e-6),
        span=40.0,
        longest=1.0,
    )
    assert found == pytest.approx(order, abs=0.1 * order)


@pytest.mark.parametrize(
    ("system", "start"),
    [(HENON_HEILES, [0, 0.1, 0.4, 0]), (PENDULUM, SWING)],
    ids=["hénon-heiles", "pendulum"],
)
@pytest.mark.parametrize("order", [4, *(pytest.param(s, marks=pytest.mark.slow) for s in (2, 8))])
def test_ten_thousand_long_steps_keep_the_energy_to_round_off(system, start, order):
    how = {"t_span": (0, 5000), "y0": start, "step": 0.5, "samples": 500}
    kept = propagate(system, method=AverageVectorField(order), **how)
    assert kept.steps == 10**4
    assert abs(kept.energy_error).max() < 4 * U * 100
    symplectic = propagate(system, method=Gauss(order // 2), **how)
    assert abs(symplectic.energy_error).max() > 1e6 * U


@pytest.mark.slow
@pytest.mark.parametrize("iteration", ["fixed-point", "newton"])
@pytest.mark.parametrize(("system", "start"), [(HENON_HEILES, [0, 0.1, 0.4, 0]), (PENDULUM, SWING)])
def test_a_million_steps_do_too(system, start, iteration):
    method = AverageVectorField(4, iteration=iteration)
    motion = propagate(system, (0, 500_000), start, method=method, step=0.5, samples=500)
    assert abs(motion.energy_error).max() < 4 * U * 1000


MORE = [pytest.param(*each, marks=pytest.mark.slow) for each in ((1, 2, 4), (1, 3, 6), (2, 4, 4), (3, 5, 3))]


@pytest.mark.parametrize(("s", "points", "power"), [(2, 3, 3), *MORE])
def test_as_many_points_as_a_polynomial_takes_and_no_fewer(s, points, power):
    """Of degree 2k/s at most; with one point less the energy changes. In double-double, that nothing is by chance."""
    how = {"t_span": (0, 3), "y0": ["0.9", "0.4"], "step": 0.5, "precision": "double-double", "samples": 6}
    usual = propagate(well(power), method=AverageVectorField(2 * s), **how)
    assert usual.method == AverageVectorField(2 * s, points=points)
    assert abs(usual.energy_error).max() < 1e-27
    fewer = propagate(well(power), method=AverageVectorField(2 * s, points=points - 1), **how)
    assert abs(fewer.energy_error).max() > 1e-9


def test_for_a_particle_in_a_potential_it_is_the_discrete_gradient():
    """x′ = x + h (p + p′)/2 and p′ = p − h (V(x′) − V(x))/(x′ − x), solved by SciPy."""
    h, motion = 0.25, propagate(PENDULUM, (0, 5), SWING, method=AverageVectorField(2), step=0.25, samples=20)
    for (q, p), (later, then) in zip(motion.y.T[:-1], motion.y.T[1:], strict=True):

        def missed(d, q=q, p=p):
            quotient = np.sin(q + d / 2) * np.sinc(d / (2 * np.pi))  # (cos q − cos(q + d))/d
            return d - h * (p - h * quotient / 2)

        d = brentq(missed, -2, 2, xtol=1e-15, rtol=1e-15)
        assert later == pytest.approx(q + d, abs=2e-15)
        assert then == pytest.approx(2 * d / h - p, abs=2e-14)
        assert abs(h * (p - h * np.sin(q + d / 2) / 2) - d) > 1e-6 * abs(d)  # the midpoint's force


def test_on_quadratic_hamiltonians_it_is_the_implicit_midpoint_rule():
    how = {"t_span": (0, 20), "step": 0.2, "samples": 20}
    start = [1.0, 0.5, 0.0, -0.3]
    for method in (AverageVectorField(2), AverageVectorField(2, points=2)):
        one, other = (propagate(TWO, y0=start, method=each, **how) for each in (method, Gauss(1)))
        assert abs(one.y - other.y).max() < 1e-13
    one, other = (
        propagate(HENON_HEILES, y0=HENON_HEILES_START, method=each, **how)
        for each in (AverageVectorField(2), Gauss(1))
    )
    assert abs(one.y - other.y).max() > 1e-5


@pytest.mark.parametrize(
    "method",
    [AverageVectorField(2), pytest.param(AverageVectorField(4, iteration="newton"), marks=pytest.mark.slow)],
    ids=str,
)
def test_time_reversal(method):
    how = {"t_span": (0, 10), "y0": DOUBLE_PENDULUM_START, "step": 0.05}
    assert abs(reversal_error(DOUBLE_PENDULUM, method=method, **how)).max() < 1e-14
    assert abs(reversal_error(DOUBLE_PENDULUM, method=RK4(), **how)).max() > 1e-8


def test_it_is_not_symplectic_keeps_no_volume_and_no_angular_momentum():
    assert not AverageVectorField(4).is_symplectic
    for order, least in ((2, 1e-3), (4, 1e-6)):
        lost = flow_jacobian(PENDULUM, (0, 1), SWING, method=AverageVectorField(order), step=0.5)
        assert lost.symplecticity_defect[-1] > least
        assert abs(np.linalg.det(lost.final) - 1) > least
        exact = flow_jacobian(PENDULUM, (0, 1), SWING, method=Gauss(order // 2), step=0.5)
        assert exact.symplecticity_defect[-1] < 1e-14
    moment = {"L": KEPLER.q[0] * KEPLER.p[1] - KEPLER.q[1] * KEPLER.p[0]}
    how = {"t_span": (0, 20), "y0": kepler_start(0.5), "step": 0.1, "observables": moment}
    motion = propagate(KEPLER, method=AverageVectorField(2), **how)
    assert abs(motion.changes["L"]).max() > 1e-4
    assert abs(motion.energy_error).max() < 1e-14
    assert abs(propagate(KEPLER, method=Gauss(1), **how).changes["L"]).max() < 1e-14


@pytest.mark.slow
def test_of_a_driven_system_the_energy_less_the_work_is_kept():
    """Of H(q, p, τ) + E with τ̇ = 1 the step is that of H(q, p, t), and the sum is kept."""
    tau, energy = phi, phi.momentum
    more = System(DRIVEN.H.subs(time, tau) + energy, (x, tau), (x.momentum, energy))
    how = {"t_span": (0, 50), "method": AverageVectorField(4), "step": 0.25, "samples": 50}
    whole = propagate(more, y0=[DRIVEN_START[0], 0.0, DRIVEN_START[1], 0.0], **how)
    driven = propagate(DRIVEN, y0=DRIVEN_START, **how)
    assert abs(whole.y[[0, 2]] - driven.y).max() < 1e-12
    assert abs(whole.energy_error).max() < 1e-14
    assert abs(whole.y[3]).max() > 0.1


@pytest.mark.slow
@pytest.mark.parametrize("method", [AverageVectorField(2), AverageVectorField(4)], ids=str)
def test_jacobians_are_the_derivatives_of_the_steps(method):
    start = np.array(DOUBLE_PENDULUM_START)
    how = {"t_span": (0, 1), "method": method, "step": 0.125}
    found, weights, delta = (
        flow_jacobian(DOUBLE_PENDULUM, y0=start, **how).final,
        {1: 45, 2: -9, 3: 1},
        2.0**-9,
    )
    for i, column in enumerate(found.T):
        ends = {
            k: propagate(DOUBLE_PENDULUM, y0=start + k * delta * np.eye(4)[i], samples=1, **how).final
            for k in (-3, -2, -1, 1, 2, 3)
        }
        slope = sum(w * (ends[k] - ends[-k]) for k, w in weights.items()) / (60 * delta)
        np.testing.assert_allclose(slope, column, atol=1e-10)


def test_events_times_between_and_resuming(tmp_path):
    how = {"method": AverageVectorField(6), "step": 0.25}
    motion = propagate(PENDULUM, (0, 20), SWING, events=[Event(theta)], **how)
    true = propagate(PENDULUM, (0, 20), SWING, events=[Event(theta)])
    assert len(motion.events) == len(true.events) > 4
    for one, other in zip(motion.events, true.events, strict=True):
        assert one.t == pytest.approx(other.t, abs=2e-3)
    whole = propagate(PENDULUM, (0, 10), SWING, **how)
    np.testing.assert_array_equal(propagate(PENDULUM, (0, 5), SWING, **how).resume(10).final, whole.final)
    assert abs(whole(3.1) - propagate(PENDULUM, (0, 3.1), SWING).final).max() < 1e-4
    whole.save(tmp_path / "kept")
    again = load_motion(tmp_path / "kept")
    assert again.method == AverageVectorField(6, points=8)
    np.testing.assert_array_equal(again.resume(15).final, whole.resume(15).final)


@pytest.mark.slow
def test_precisions_and_orbits():
    how = {"t_span": (0, 20), "method": AverageVectorField(4), "step": 0.25, "samples": 4}
    true = propagate(HENON_HEILES, y0=HENON_HEILES_START, precision="double-double", **how).final
    units = {"single": 2.0**-23, "double": 2.0**-52, "extended": 2.0**-62, "double-double": 1e-31}
    for precision, unit in units.items():
        motion = propagate(HENON_HEILES, y0=HENON_HEILES_START, precision=precision, **how)
        assert abs(motion.energy_error).max() < 30 * unit
        assert abs(motion.final - true).max() < max(200 * unit, 1e-15)
    starts = np.array([HENON_HEILES_START, [0.2, 0.1, 0.1, 0.3]]).T
    many = propagate(HENON_HEILES, y0=starts, **how)
    for k, start in enumerate(starts.T):
        np.testing.assert_array_equal(many.y[:, :, k], propagate(HENON_HEILES, y0=start, **how).y)


def test_it_is_chosen_where_it_is_named_and_never_by_the_energy():
    system = find("double-pendulum")
    question = Question(system.hamiltonian, DOUBLE_PENDULUM_START, system.values, 10.0)
    assert not any(isinstance(each, AverageVectorField) for each in candidate_methods(question))
    named = {"methods": ["avf-4"], "accuracy": 1e-4}
    with pytest.raises(StudyError, match=r"avf-4: the energy is kept at every step.*observable='position'"):
        choose("henon-heiles", 20.0, **named)
    found = choose("henon-heiles", 20.0, observable="position", **named)
    assert found.method == AverageVectorField(4)
    assert found.predicted_error < 1e-4


def test_what_it_is_not_for_is_told():
    for order in (3, 0, 18, True, 2.0, "4"):
        with pytest.raises(ValueError, match="the order is 2, 4, … or 16"):
            AverageVectorField(order)
    for points in (1, 17, 2.5):
        with pytest.raises(ValueError, match="the points of the quadrature are 2 … 16"):
            AverageVectorField(4, points=points)
    with pytest.raises(ValueError, match="there are 'fixed-point' and 'newton'"):
        AverageVectorField(2, iteration="secant")
    damped = Lagrangian(x.dot**2 / 2 - x**2 / 2, [x], forces=[-x.dot])
    with pytest.raises(ValueError, match="avf-2 is made for a Hamiltonian"):
        propagate(damped, (0, 1), [1, 0], method="avf-2", step=0.1)
    steep = well(20)
    with pytest.raises(
        ValueError, match=r"degree 20, .* takes 20 points .*take AverageVectorField\(2\), or Aver"
    ):
        propagate(steep, (0, 1), [0.5, 0], method="avf-4", step=0.1)
    with pytest.raises(ValueError, match=r"takes 17 points .*take AverageVectorField\(2, points=16\), which"):
        propagate(well(34), (0, 1), [0.5, 0], method="avf-2", step=0.1)
    assert propagate(steep, (0, 1), [0.5, 0], method="avf-2", step=0.1).method.points == 10
    with pytest.raises(NonFiniteStateError, match=r"do not converge .*iteration='newton'"):
        propagate(KEPLER, (0, 100), kepler_start(0.6), method="avf-2", step=1.5)
