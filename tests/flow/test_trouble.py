"""Collisions, domains left and wrong words: an error at once, or a flag, with time and state."""

import math
import warnings

import numpy as np
import pytest
import sympy as sp

from canon.flow.event import Event
from canon.flow.measure import AccuracyWarning
from canon.flow.method import DOP853, RK4, Gauss, Splitting, Taylor
from canon.flow.propagate import NonFiniteStateError, propagate
from tests.flow.systems import KEPLER, PENDULUM, System, kepler_start, x, y

FALL_TIME = math.pi / math.sqrt(8)
"""Two bodies at rest at distance 1 collide after π/√8."""

RADIAL = [1.0, 0.0, 0.0, 0.0]
DISTANCE = sp.sqrt(x**2 + y**2)


@pytest.mark.parametrize("step", [0.05, 0.01, 0.001])
@pytest.mark.parametrize("method", [Splitting("verlet"), Splitting("kahan-li-8"), RK4()], ids=str)
def test_a_step_over_a_collision_is_flagged_with_its_time(method, step):
    with pytest.warns(AccuracyWarning, match="jumped over a collision") as caught:
        propagate(KEPLER, RADIAL, (0, 3), method=method, step=step, samples=300)
    t = float(str(caught[0].message).split("up to t = ")[1].split()[0])
    assert FALL_TIME - 0.02 < t < FALL_TIME + 0.05


def test_only_the_orbit_that_jumped_is_named():
    start = np.array([kepler_start(0.2), RADIAL, kepler_start(0.4)]).T
    with pytest.warns(AccuracyWarning, match="of orbit 1 changes"):
        propagate(KEPLER, start, (0, 3), method=Splitting("verlet"), step=0.01)


def test_large_but_honest_errors_are_not_flagged():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        coarse = propagate(KEPLER, kepler_start(0.6), (0, 60), method=Splitting("verlet"), step=0.2)
        assert abs(coarse.energy_error).max() > 0.03
        propagate(KEPLER, RADIAL, (0, 1), method=Splitting("verlet"), step=0.01)
        driven = System(PENDULUM.H * sp.cos(PENDULUM.t), PENDULUM.q, PENDULUM.p)
        propagate(driven, [1.0, 0.5], (0, 3), method=Gauss(3), step=0.1)


@pytest.mark.parametrize(
    ("method", "how"),
    [(Gauss(1), {"step": 0.01}), (Gauss(6), {"step": 0.05}), (Taylor(), {}), (DOP853(), {})],
    ids=str,
)
def test_methods_that_notice_a_collision_stop_before_it(method, how):
    with pytest.raises(NonFiniteStateError) as caught:
        propagate(KEPLER, RADIAL, (0, 3), method=method, **how)
    assert FALL_TIME - 0.06 < caught.value.time <= FALL_TIME + 1e-9
    assert np.isfinite(caught.value.state).all()
    assert caught.value.state[0] > 0


@pytest.mark.parametrize(
    ("method", "how"),
    [(Splitting("verlet"), {"step": 0.001}), (Gauss(4), {"step": 0.002}), (Taylor(), {})],
    ids=str,
)
def test_an_event_stops_a_motion_before_the_collision(method, how):
    near = Event(DISTANCE - sp.Rational(1, 20), -1, "stop", "too close")
    motion = propagate(KEPLER, RADIAL, (0, 3), method=method, events=[near], **how)
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
            propagate(edge, [0.0, 2.0], (0, 10), method=method, **how)
        assert 0.3 < caught.value.time < 0.6
        assert np.isfinite(caught.value.state).all()
        assert 0.9 < caught.value.state[0] < 1.003


def test_an_observable_outside_its_domain_is_an_error():
    with pytest.raises(ArithmeticError, match="not finite"):
        propagate(
            KEPLER,
            kepler_start(0.1),
            (0, 3),
            method=Splitting("verlet"),
            step=0.1,
            observables={"l": sp.log(x)},
        )
    with pytest.raises(ArithmeticError, match="not finite"):
        propagate(
            KEPLER, kepler_start(0.1), (0, 1.7), method=Splitting("verlet"), step=0.1, samples=1, cadence=1,
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
        ({"y0": 1.0}, ValueError, r"shape \(\)"),
        ({"y0": [1j, 0]}, ValueError, "component of y0"),
        ({"t_span": (NAN, 1)}, ValueError, "t_span"),
        ({"t_span": (0, 0)}, ValueError, "no length"),
        ({"step": INF}, ValueError, "positive"),
        ({"step": 0}, ValueError, "positive"),
        ({"step": -1e-3}, ValueError, "positive"),
        ({"samples": -3}, ValueError, "at least one"),
        ({"cadence": -1}, ValueError, "1 or more"),
        ({"precision": "half"}, ValueError, "compensated"),
        ({"dense": True}, ValueError, "no polynomials"),
        ({"parameters": {"w": NAN}}, ValueError, "w = nan"),
        ({"parameters": {"w": None}}, ValueError, "w = None"),
        ({"parameters": {"w": True}}, ValueError, "w = True"),
    ],
)
def test_wrong_words_are_refused_at_once(wrong, error, message):
    right = {"y0": [1.0, 0.0], "t_span": (0, 1), "method": Splitting("verlet"), "step": 0.1}
    with pytest.raises(error, match=message):
        propagate(PENDULUM, **{**right, **wrong})


@pytest.mark.parametrize("tolerance", [0.0, -1e-3, 1.5, NAN])
def test_tolerances_that_make_no_sense(tolerance):
    with pytest.raises(ValueError, match="tolerance"):
        propagate(PENDULUM, [1.0, 0.0], (0, 1), tolerance=tolerance)
