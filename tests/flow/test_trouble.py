"""Collisions, domains left and wrong words: an error at once, or a flag, with time and state."""

import math
import warnings
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian
from canon.flow.checked_request import hamilton_equations_of
from canon.flow.method.method import DOP853, RK4, Gauss, Splitting, Taylor
from canon.flow.propagation import propagate
from canon.flow.run.event import Event
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.flow.run.observables_along import AccuracyWarning, size_of_terms
from canon.kernel.schemes.gauss_tableau import gauss_tableau
from tests.flow.systems import KEPLER, PENDULUM, System, kepler_start, x, y

FALL_TIME = math.pi / math.sqrt(8)
"""Two bodies at rest at distance 1 collide after π/√8."""

RADIAL = [1.0, 0.0, 0.0, 0.0]
DISTANCE = sp.sqrt(x**2 + y**2)


@pytest.mark.parametrize("step", [0.05, 0.01, 0.001])
@pytest.mark.parametrize("method", [Splitting("verlet"), Splitting("kahan-li-8"), RK4()], ids=str)
def test_a_step_over_a_collision_is_flagged_with_its_time(method, step):
    with pytest.warns(AccuracyWarning, match="jumped over a collision") as caught:
        propagate(KEPLER, (0, 3), RADIAL, method=method, step=step, samples=300)
    t = float(str(caught[0].message).split("up to t = ")[1].split()[0])
    between_samples = max(step, 3 / 300)
    # The computed fall may end a step before the true one, and the jump is seen at the sample after it.
    assert FALL_TIME - between_samples < t < FALL_TIME + 2 * between_samples


def test_a_jump_over_a_collision_is_flagged_where_the_energy_has_changed_by_half_of_its_terms():
    with pytest.warns(AccuracyWarning, match="jumped over a collision") as caught:
        motion = propagate(KEPLER, (0, 3), RADIAL, method=Splitting("verlet"), step=0.01, samples=300)
    wrong = abs(motion.energy_change) > 0.5  # at the start the terms of H are 0, 0 and 1
    first = int(np.argmax(wrong))
    assert not wrong[:first].any()
    (flag,) = caught
    assert f"changes by {motion.energy_change[first]:.3g} up to t = {motion.t[first]:.9g}" in str(
        flag.message
    )
    assert f"(t = {motion.t[first - 1]:.9g} before that)" in str(flag.message)
    assert flag.filename == __file__  # the line that asked for the motion


def test_the_terms_of_each_orbit_have_the_size_that_they_have_alone() -> None:
    """Released from the horizontal, where they vanish, beside one that begins at the bottom and slows down."""
    system = hamilton_equations_of(PENDULUM, {})
    motion = propagate(PENDULUM, (0, 2), [[np.pi / 2, 0.0], [0.0, 2.0]], samples=20)
    alone = [size_of_terms(system, SimpleNamespace(t=motion.t, y=motion.y[:, :, [k]])) for k in range(2)]
    together = size_of_terms(system, motion)
    np.testing.assert_array_equal(together, np.concatenate(alone))
    assert together[1] == 3
    assert 0.1 < together[0] < 2


@pytest.mark.parametrize("samples", [1, 50])
@pytest.mark.parametrize(
    ("H", "start", "step"),
    [(PENDULUM.H, [1.5697, 0.0], 0.1), (PENDULUM.p[0] ** 2 / 2 - PENDULUM.q[0] ** 2 / 2, [1e-3, 0.0], 0.1)],
    ids=["let go at nearly a right angle", "away from the top"],
)
def test_terms_that_are_small_at_the_start_only_are_no_measure(H, start, step, samples):
    system = System(H, PENDULUM.q, PENDULUM.p)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        motion = propagate(system, (0, 20), start, method=Splitting("verlet"), step=step, samples=samples)
    assert abs(motion.energy_change).max() > 0.5 * abs(motion.energy[0])


def test_steps_that_are_far_too_large_are_told_where_the_terms_are_small_at_the_start():
    """The wrong twin of the pendulum above."""
    with pytest.warns(AccuracyWarning, match="far too large"):
        propagate(PENDULUM, (0, 20), [1.5697, 0.0], method=RK4(), step=2.5, samples=8)


def test_a_motion_that_ends_before_the_collision_is_not_flagged():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        propagate(KEPLER, (0, FALL_TIME - 0.1), RADIAL, method=Splitting("verlet"), step=0.01)


def test_only_the_orbit_that_jumped_is_named():
    start = np.array([kepler_start(0.2), RADIAL, kepler_start(0.4)]).T
    with pytest.warns(AccuracyWarning, match="of orbit 1 changes"):
        propagate(KEPLER, (0, 3), start, method=Splitting("verlet"), step=0.01)


def verlets_energy_error(e, h):
    """Largest change along Kepler's orbit of H̃ − H = h² (|∇V|²/12 − p·V″p/24), relative to the energy −1/2.

    Drift, kick, drift: E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, § IX.4.
    """
    E = np.linspace(0, 2 * np.pi, 1001)
    r = 1 - e * np.cos(E)
    place = np.array([np.cos(E) - e, math.sqrt(1 - e * e) * np.sin(E)])
    p = np.array([-np.sin(E), math.sqrt(1 - e * e) * np.cos(E)]) / r
    curvature = (p**2).sum(axis=0) / r**3 - 3 * (place * p).sum(axis=0) ** 2 / r**5
    excess = 1 / (12 * r**4) - curvature / 24
    return 2 * h**2 * abs(excess - excess[0]).max()


@pytest.mark.parametrize("step", [0.2, 0.1, 0.05])
def test_large_but_honest_errors_are_not_flagged(step):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        coarse = propagate(KEPLER, (0, 60), kepler_start(0.6), method=Splitting("verlet"), step=step)
    # At the pericentre the planet turns by v h/r = 5 h in a step: the next order is up to (5 h)²/2 as large.
    expected = pytest.approx(verlets_energy_error(0.6, step), rel=(5 * step) ** 2 / 2)
    assert abs(coarse.energy_error).max() == expected


def test_the_energy_of_a_driven_system_may_change_unflagged():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        driven = System(PENDULUM.H * sp.cos(PENDULUM.t), PENDULUM.q, PENDULUM.p)
        propagate(driven, (0, 3), [1.0, 0.5], method=Gauss(3), step=0.1)


@pytest.mark.parametrize(("stages", "step"), [(1, 0.01), (4, 0.02), (6, 0.05)])
def test_gauss_methods_stop_at_the_step_that_does_not_converge(stages, step):
    with pytest.raises(NonFiniteStateError, match="do not converge") as caught:
        propagate(KEPLER, (0, 3), RADIAL, method=Gauss(stages), step=step)
    # The iteration contracts by ρ h √(2/r³), ρ the spectral radius of the method's matrix; a hundred times that must
    # bring changes below 2⁻²⁰, so it fails from 0.87 on. From there the fall takes (√2/3) r^(3/2) still, and the last
    # stage may be a step ahead.
    tableau = gauss_tableau(stages)
    matrix = np.array([[float(m * b) for m, b in zip(row, tableau.b, strict=True)] for row in tableau.mu])
    rest = 2 / 3 * abs(np.linalg.eigvals(matrix)).max() * step / 0.87
    assert FALL_TIME - step - rest < caught.value.time < FALL_TIME
    assert caught.value.state[0] > 0


@pytest.mark.parametrize("method", [Taylor(), DOP853()], ids=str)
def test_adaptive_methods_follow_a_fall_to_the_collision(method):
    with pytest.raises(NonFiniteStateError) as caught:
        propagate(KEPLER, (0, 3), RADIAL, method=method)
    # Steps shrink with the time that is left, down to its rounding; DOP853's steps err by 1e-12 each.
    assert caught.value.time == pytest.approx(FALL_TIME, abs=1e-11)
    assert np.isfinite(caught.value.state).all()
    assert caught.value.state[0] > 0


@pytest.mark.parametrize(
    ("method", "how"),
    [(Splitting("verlet"), {"step": 0.001}), (Gauss(4), {"step": 0.002}), (Taylor(), {})],
    ids=str,
)
def test_an_event_stops_a_motion_before_the_collision(method, how):
    near = Event(DISTANCE - sp.Rational(1, 20), -1, "stop", "too close")
    motion = propagate(KEPLER, (0, 3), RADIAL, method=method, events=[near], **how)
    assert motion.stopped
    assert motion.final[0] == pytest.approx(0.05, abs=1e-12)
    # t = √(r(1 − r)/2) + √½ arccos √r for a fall from rest at distance 1.
    assert motion.t[-1] == pytest.approx(
        (math.sqrt(0.0475) + math.acos(math.sqrt(0.05))) / math.sqrt(2), abs=1e-4
    )


def test_a_domain_left_is_an_error_in_every_method_and_precision():
    (edge_x, p) = (x, x.momentum)
    edge = System(p**2 / 2 - sp.sqrt(1 - edge_x**2) - 2 * edge_x, (x,), (p,))
    cases = [
        *(
            (Splitting("verlet"), {"step": 0.001, "precision": name})
            for name in ("single", "extended", "double-double")
        ),
        (RK4(), {"step": 0.001}),
        (Gauss(2), {"step": 0.001}),
        (Taylor(), {}),
        (Taylor(), {"precision": "extended"}),
        (DOP853(), {}),
    ]
    for method, how in cases:
        with pytest.raises(NonFiniteStateError, match="after t = 0") as caught:
            propagate(edge, (0, 10), [0.0, 2.0], method=method, **how)
        assert 0.3 < caught.value.time < 0.6
        assert np.isfinite(caught.value.state).all()
        assert 0.9 < caught.value.state[0] < 1.003


def test_an_observable_outside_its_domain_is_an_error():
    with pytest.raises(ArithmeticError, match="not finite"):
        propagate(
            KEPLER,
            (0, 3),
            kepler_start(0.1),
            method=Splitting("verlet"),
            step=0.1,
            observables={"l": sp.log(x)},
        )
    with pytest.raises(ArithmeticError, match="not finite"):
        propagate(
            KEPLER, (0, 1.7), kepler_start(0.1), method=Splitting("verlet"), step=0.1, samples=1, cadence=1,
            observables={"l": sp.log(x)},
        )  # fmt: skip


NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("wrong", "error", "message"),
    [
        ({"y0": [1.0, NAN]}, ValueError, "not finite"),
        ({"y0": [INF, 0.0]}, ValueError, "not finite"),
        ({"y0": [[1.0, 1.0], [0.0, NAN]]}, ValueError, "not finite"),
        ({"y0": ["1", "nan"]}, ValueError, "component of y0"),
        ({"y0": [1.0, 0.0, 0.0]}, ValueError, r"shape \(3,\)"),
        ({"y0": []}, ValueError, r"shape \(0,\)"),
        ({"y0": np.zeros((2, 0))}, ValueError, r"shape \(2, 0\)"),
        ({"y0": 1.0}, TypeError, "y0 is 1.0: give a number for each variable in a list"),
        ({"y0": [1j, 0]}, ValueError, "component of y0"),
        ({"t_span": (NAN, 1)}, ValueError, "t_span"),
        ({"t_span": (0, 0)}, ValueError, "no length"),
        ({"step": INF}, ValueError, "positive"),
        ({"step": 0}, ValueError, "positive"),
        ({"step": -1e-3}, ValueError, "positive"),
        ({"samples": -3}, ValueError, "at least one"),
        ({"cadence": -1}, ValueError, "1 or more"),
        ({"precision": "half"}, ValueError, "compensated"),
        ({"dense": True}, ValueError, "leave it out: a motion by verlet can be asked at any time"),
    ],
)
def test_wrong_words_are_refused_at_once(wrong, error, message):
    right = {"y0": [1.0, 0.0], "t_span": (0, 1), "method": Splitting("verlet"), "step": 0.1}
    with pytest.raises(error, match=message):
        propagate(PENDULUM, **{**right, **wrong})


@pytest.mark.parametrize("value", [NAN, None, True])
def test_parameters_that_are_no_numbers(value):
    w = sp.Symbol("w", real=True)
    swinging = Hamiltonian(x.momentum**2 / 2 - w * sp.cos(x), [x], [x.momentum])
    with pytest.raises(ValueError, match=f"w = {value!s}"):
        propagate(swinging, (0, 1), [1.0, 0.0], method=Splitting("verlet"), step=0.1, parameters={"w": value})
    with pytest.raises(KeyError, match="the system has no parameter w, it has none"):
        propagate(PENDULUM, (0, 1), [1.0, 0.0], method=Splitting("verlet"), step=0.1, parameters={"w": value})


@pytest.mark.parametrize("tolerance", [0.0, -1e-3, 1.5, NAN])
def test_tolerances_that_make_no_sense(tolerance):
    with pytest.raises(ValueError, match="tolerance"):
        propagate(PENDULUM, (0, 1), [1.0, 0.0], tolerance=tolerance)
