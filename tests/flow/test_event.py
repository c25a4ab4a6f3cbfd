"""Events: noticed, located, acted upon, and never where there are none."""

import numpy as np
import pytest
import sympy as sp

from canon.expression.symbols.symbol import time
from canon.flow.method.method import DOP853, RK4, Gauss, Splitting, Taylor
from canon.flow.propagation import propagate
from canon.flow.run.event import Event
from canon.flow.run.non_finite_state import NonFiniteStateError
from tests.flow.systems import (
    DOUBLE_PENDULUM,
    HENON_HEILES,
    HENON_HEILES_START,
    PENDULUM,
    System,
    theta,
    x,
    y,
)

px, py = x.momentum, y.momentum
FALL = System(px**2 / 2 + x, (x,), (px,))
"""x(t) = x0 + p0 t − t²/2, which every method of order 2 follows exactly."""

OSCILLATOR = System((px**2 + x**2) / 2, (x,), (px,))
DRAG = System(sp.sqrt(1 + px**2) + x, (x,), (px,))
VERLET, KL8 = Splitting("verlet"), Splitting("kahan-li-8")
EVERY = [(VERLET, {"step": 0.01}), (Gauss(3), {"step": 0.01}), (RK4(), {"step": 0.01}), (Taylor(), {})]
IDS = ["verlet", "gauss", "rk4", "taylor"]


def times(motion):
    return [met.t for met in motion.events]


def test_what_is_no_variable_is_told_apart():
    def swing(t, y):
        return [y[1], -y[0]]

    met = propagate(swing, (0, 2), [1.0, 0.0], events=[Event(sp.Symbol("y_0", real=True))]).events
    assert abs(met[0].t - np.pi / 2) < 1e-14
    with pytest.raises(
        KeyError, match=r"holds y_0: another symbol than the variable y_0.*Symbol\('y_0', real=True\)"
    ):
        propagate(swing, (0, 2), [1.0, 0.0], events=[Event(sp.Symbol("y_0"))])
    with pytest.raises(
        KeyError, match=r"holds x_dot: velocities are no variables here, write it in x, p_x, t"
    ):
        propagate(OSCILLATOR, (0, 2), [1.0, 0.0], events=[Event(x.dot)])
    with pytest.raises(KeyError, match=r"holds k: give each a number"):
        propagate(OSCILLATOR, (0, 2), [1.0, 0.0], events=[Event(x - sp.Symbol("k"))])


@pytest.mark.parametrize(("method", "how"), EVERY, ids=IDS)
@pytest.mark.parametrize("forward", [1, -1])
def test_a_stop_ends_the_motion_at_the_event(method, how, forward):
    motion = propagate(
        FALL, (0, 6 * forward), [0.5, 0.0], method=method, samples=10, events=[Event(x, -1, "stop")], **how
    )
    assert motion.stopped
    assert times(motion) == [pytest.approx(forward, abs=1e-15)]
    assert motion.t[-1] == motion.events[0].t
    np.testing.assert_allclose(motion.final, [0, -forward], atol=1e-15)
    np.testing.assert_allclose(motion.t, [0, 0.6 * forward, forward], rtol=1e-14)
    assert motion.events[0].rising is False
    assert abs(motion.energy_error).max() < 3e-16
    with pytest.raises(ValueError, match="does not go on"):
        motion.resume(7 * forward)


@pytest.mark.parametrize("below", [50, 54, 58, 60, 62, 70])
@pytest.mark.parametrize("action", ["stop", "record"])
def test_a_stop_within_round_off_of_the_end_of_a_step(below, action):
    """A free body is at 1 − 2⁻ᵏ as the fourth step ends, or the fifth begins."""
    free = System(px**2 / 2, (x,), (px,))
    event = Event(x - 1 + sp.Rational(1, 2**below), +1, action)
    motion = propagate(free, (0, 3), [0.0, 1.0], method=VERLET, step=0.25, events=[event])
    assert motion.stopped == (action == "stop")
    assert times(motion) == pytest.approx([1.0], abs=2e-15)
    assert motion.t[-1] == pytest.approx(1.0 if motion.stopped else 3.0, abs=2e-15)


@pytest.mark.parametrize(("method", "how"), EVERY, ids=IDS)
@pytest.mark.parametrize("action", ["bounce", {px: -px}, {px: -px, x: sp.Integer(0)}], ids=str)
def test_a_bounce_keeps_the_energy_and_its_times(method, how, action):
    motion = propagate(
        FALL, (0, 100), [0.5, 0.0], method=method, samples=100, events=[Event(x, -1, action)], **how
    )
    np.testing.assert_allclose(times(motion), np.arange(1, 100, 2), rtol=1e-14)
    u, missed = 2.0**-53, np.array([abs(met.y[0]) for met in motion.events])
    # At the wall terms of size 2 cancel: a few of their roundings in doubles, none where these are carried along.
    assert missed.max() < (16 * u if method == Taylor() else u / 16)
    # H = p²/2 + x: where the bounce sets x to 0, H forgets as much as x was.
    forgotten = missed.sum() if isinstance(action, dict) and x in action else 0.0
    assert abs(motion.energy_change).max() <= forgotten + u
    assert motion.y[0].min() > -1e-14
    np.testing.assert_allclose(motion.events[3].after, -motion.events[3].y, atol=1e-13)


def test_a_bounce_in_every_precision_is_as_good_as_the_precision():
    floor = {"single": 1e-6, "double": 1e-14, "compensated": 1e-16, "extended": 1e-17, "double-double": 1e-30}
    for precision, bound in floor.items():
        motion = propagate(
            FALL,
            (0, 6),
            [0.5, 0.0],
            method=VERLET,
            step=0.01,
            precision=precision,
            events=[Event(x, -1, "bounce")],
        )
        assert len(motion.events) == 3
        assert abs(motion.energy_error).max() < bound


def test_taylor_refuses_to_change_states_it_would_round():
    with pytest.raises(ValueError, match="'double' and 'extended' only"):
        propagate(FALL, (0, 6), [0.5, 0.0], precision="quad", events=[Event(x, -1, "bounce")])


@pytest.mark.slow
def test_taylor_meets_events_in_higher_precisions():
    extended = propagate(FALL, (0, 6), [0.5, 0.0], precision="extended", events=[Event(x, -1, "bounce")])
    assert len(extended.events) == 3
    assert abs(extended.energy_error).max() < 1e-18
    quad = propagate(FALL, (0, 6), [0.5, 0.0], precision="quad", events=[Event(x, -1, "stop")])
    assert times(quad) == [1.0]


def test_a_circular_billiard_keeps_energy_and_angular_momentum():
    free = System(px**2 / 2 + py**2 / 4, (x, y), (px, py))
    # In the metric of the masses 1 and 2 the wall is a circle in (x, √2 y).
    wall = Event(1 - x**2 - 2 * y**2, -1, "bounce", "wall")
    L = {"L": x * py - 2 * y * px}
    for method, how in ((VERLET, {"step": 0.37}), (Taylor(), {})):
        motion = propagate(
            free,
            (0, 200),
            [0.1, 0.2, 0.7, 1.1],
            method=method,
            samples=50,
            events=[wall],
            observables=L,
            **how,
        )
        assert len(motion.events) > 50
        assert abs(motion.energy_error).max() < 1e-13
        assert abs(motion.changes["L"]).max() < 1e-13
        assert (motion.y[0] ** 2 + 2 * motion.y[1] ** 2).max() < 1 + 1e-12


@pytest.mark.parametrize(
    ("method", "how"), [(KL8, {"step": 0.1}), (Gauss(4), {"step": 0.2})], ids=["kl8", "gauss"]
)
def test_recording_changes_no_bit_and_agrees_with_taylor(method, how):
    arguments = {"y0": HENON_HEILES_START, "t_span": (0, 200), "samples": 40}
    section = [Event(x, 1), Event(py, name="turning")]
    seen = propagate(HENON_HEILES, method=method, events=section, **arguments, **how)
    blind = propagate(HENON_HEILES, method=method, **arguments, **how)
    np.testing.assert_array_equal(seen.y, blind.y)
    true = propagate(HENON_HEILES, events=section, **arguments)
    assert [met.event for met in seen.events] == [met.event for met in true.events]
    assert len(true.events) > 80
    np.testing.assert_allclose(times(seen), times(true), atol=2e-6)
    for met in seen.events:
        assert abs(met.y[0] if met.event.direction else met.y[3]) < 1e-15
        assert met.rising or not met.event.direction
    energies = [
        float(HENON_HEILES.H.subs(dict(zip((x, y, px, py), met.y, strict=True)))) for met in seen.events
    ]
    # A state at an event is the method's own: its energy errs as little as at the steps.
    assert max(abs(np.array(energies) / energies[0] - 1)) < 20 * abs(seen.energy_error).max() + 1e-14


def test_the_located_time_converges_with_the_order_of_the_method():
    def first(step):
        return (
            propagate(PENDULUM, (0, 2), [1.0, 0.0], method=VERLET, step=step, events=[Event(theta)])
            .events[0]
            .t
        )

    true = propagate(PENDULUM, (0, 2), [1.0, 0.0], events=[Event(theta)]).events[0].t
    errors = [abs(first(step) - true) for step in (0.04, 0.02, 0.01)]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.1)


def test_several_crossings_in_one_step_are_met_in_their_order():
    events = [Event(x, name="x"), Event(px, name="p"), Event(x + sp.Rational(1, 100), name="lower")]
    motion = propagate(FALL, (0, 3), [-0.125, 0.51], method=VERLET, step=3.0, samples=1, events=events)

    def root(level):
        return 0.51 + np.array([-1, 1]) * np.sqrt(0.51**2 - 2 * (0.125 + level))

    expected = sorted([*root(0), *root(-0.01), 0.51])
    np.testing.assert_allclose(times(motion), expected, rtol=1e-13)
    assert [met.event.name for met in motion.events] == ["lower", "x", "p", "x", "lower"]
    assert [met.rising for met in motion.events] == [True, True, False, False, False]


@pytest.mark.parametrize(("method", "how"), [(VERLET, {"step": 0.3}), (VERLET, {"step": 3.0})])
def test_touching_without_crossing_is_no_event(method, how):
    touching = propagate(FALL, (0, 3), [-0.125, 0.5], method=method, samples=1, events=[Event(x)], **how)
    assert touching.events == ()
    through = propagate(
        FALL, (0, 3), [-0.125 + 1e-9, 0.5], method=method, samples=1, events=[Event(x)], **how
    )
    np.testing.assert_allclose(times(through), 0.5 + np.array([-1, 1]) * np.sqrt(2e-9), rtol=1e-9)


@pytest.mark.parametrize(("method", "how"), EVERY, ids=IDS)
def test_a_start_at_zero_is_no_event_but_what_follows_is(method, how):
    up = propagate(FALL, (0, 3), [0.0, 0.5], method=method, samples=1, events=[Event(x)], **how)
    assert times(up) == [pytest.approx(1, abs=1e-15)]
    down = propagate(
        FALL, (0, 3), [0.0, -0.5], method=method, samples=1, events=[Event(x, -1, "stop")], **how
    )
    assert times(down) == []
    assert not down.stopped


@pytest.mark.parametrize(("method", "how"), EVERY, ids=IDS)
def test_events_that_pile_up_are_an_error_with_time_and_state(method, how):
    with pytest.raises(NonFiniteStateError, match="pile up") as caught:
        propagate(FALL, (0, 9), [0.5, 0.0], method=method, events=[Event(x, -1, {px: -px / 2})], **how)
    assert caught.value.time == pytest.approx(3, abs=1e-5)
    np.testing.assert_allclose(caught.value.state, [0, 0], atol=1e-5)


def test_an_event_that_leaves_its_domain_is_an_error():
    with pytest.raises(NonFiniteStateError, match="domain"):
        propagate(FALL, (0, 9), [0.5, 0.0], method=VERLET, step=0.01, events=[Event(sp.log(x + 2))])


def test_a_driven_systems_events_read_the_clock():
    from canon.expression.symbols.symbol import time

    wall = Event(x - sp.sin(time) / 10, -1, "bounce")
    for method, how in ((VERLET, {"step": 0.01}), (Taylor(), {})):
        motion = propagate(FALL, (0, 10), [0.5, 0.0], method=method, events=[wall], **how)
        for met in motion.events:
            assert met.y[0] == pytest.approx(np.sin(met.t) / 10, abs=1e-14)
            # Reflected in the frame of the wall.
            v = np.cos(met.t) / 10
            assert met.after[1] - v == pytest.approx(v - met.y[1], rel=1e-12)
        assert len(motion.events) > 3


@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"events": [Event(sp.Symbol("w") * x)]}, KeyError, "holds w"),
        ({"events": [Event(sp.Integer(1))]}, ValueError, "does not depend"),
        ({"events": [Event(px, 0, "bounce")]}, ValueError, "no wall"),
        ({"events": [Event(x, 0, {y: y})]}, ValueError, "changes y"),
        ({"events": [Event(x, 0, "stop")], "y0": [[0.5, 0.6], [0.0, 0.0]]}, ValueError, "one by one"),
        ({"events": [Event(x)], "cadence": 1}, ValueError, "cadence"),
    ],
)
def test_events_that_make_no_sense_are_refused(change, error, message):
    right = {"y0": [0.5, 0.0], "t_span": (0, 1), "method": VERLET, "step": 0.1}
    with pytest.raises(error, match=message):
        propagate(FALL, **{**right, **change})


def test_a_bounce_asks_for_a_quadratic_kinetic_energy():
    with pytest.raises(ValueError, match="not quadratic"):
        propagate(DRAG, (0, 1), [0.5, 0.0], method=VERLET, step=0.1, events=[Event(x, -1, "bounce")])
    moved = propagate(DRAG, (0, 3), [0.5, 0.0], method=KL8, step=0.01, events=[Event(x, -1, {px: -px})])
    assert len(moved.events) == 1
    assert abs(moved.energy_error).max() < 1e-14
    theta_wall = Event(DOUBLE_PENDULUM.q[0], 0, "bounce")
    swung = propagate(
        DOUBLE_PENDULUM, (0, 20), [1.0, 0.4, 0.1, -0.2], method=Gauss(6), step=0.05, events=[theta_wall]
    )
    assert len(swung.events) > 5
    assert abs(swung.energy_error).max() < 1e-11


@pytest.mark.parametrize(("direction", "action"), [(2, "record"), (0, "jump")])
def test_words_that_are_no_direction_or_action(direction, action):
    with pytest.raises(ValueError, match=r"direction=|action="):
        Event(x, direction, action)


@pytest.mark.parametrize("turns", [20, -20, 40, 80, 160])
@pytest.mark.parametrize("direction", [0, 1])
def test_a_zero_where_a_slice_ends_is_met_once(turns, direction):
    """Slices end at multiples of π, where sin t is zero but for the rounding of t, on one side or the other."""
    asked = Event(sp.sin(time), direction=direction)
    motion = propagate(OSCILLATOR, (0, turns * np.pi), [1.0, 0.0], events=[asked])
    met = np.array([round(crossing.t / np.pi) for crossing in motion.events])
    within = met[np.abs(met) < abs(turns)]  # at the end itself rounding decides
    every = np.sign(turns) * np.arange(1, abs(turns))
    rises = {
        n: (n % 2 == 0) == (turns > 0) for n in range(-abs(turns), abs(turns) + 1)
    }  # in the order of passing
    assert list(within) == [n for n in every if direction == 0 or rises[n]]
    assert all(crossing.rising == rises[n] for crossing, n in zip(motion.events, met, strict=True))


def test_a_zero_where_a_motion_is_resumed_is_met_once():
    motion = propagate(OSCILLATOR, (0, 3 * np.pi), [1.0, 0.0], events=[Event(sp.sin(time))])
    for turns in range(4, 12):
        motion = motion.resume(turns * np.pi)
    met = [round(crossing.t / np.pi) for crossing in motion.events]
    assert met[:10] == list(range(1, 11))
    assert met[10:] in ([], [11])


@pytest.mark.parametrize(("method", "how"), [*EVERY, (DOP853(), {})], ids=[*IDS, "dop853"])
@pytest.mark.parametrize("way", [1, -1])
def test_an_angle_is_taken_back_by_whole_turns(method, how, way):
    """A change that leads away from the zero is no piling up, and the function's side is where it leads to."""
    over = Event(theta - way * sp.pi, way, {theta: theta - 2 * way * sp.pi})
    motion = propagate(PENDULUM, (0, way * 10), [0, 3], method=method, events=[over], samples=50, **how)
    free = propagate(PENDULUM, (0, way * 10), [0, 3], method=method, samples=50, **how)
    assert len(motion.events) == round(abs(free.final[0]) / (2 * np.pi))
    assert abs(motion.y[0]).max() < np.pi + 1e-12
    turns = (motion.y[0] - free.y[0]) / (2 * np.pi)
    assert turns == pytest.approx(turns.round(), abs=1e-5)
    # Both directions: going over and being put back is met once a turn.
    saw = Event(theta - way, 0, {theta: 0})
    rotor = System(theta.momentum**2 / 2, (theta,), (theta.momentum,))
    teeth = propagate(rotor, (0, way * 9.5), [0, 1], method=method, events=[saw], **how)
    assert times(teeth) == pytest.approx(way * np.arange(1, 10), abs=1e-13)


@pytest.mark.parametrize(("method", "how"), [*EVERY, (DOP853(), {})], ids=[*IDS, "dop853"])
@pytest.mark.parametrize("way", [1, -1])
def test_a_jump_and_a_pole_are_no_zeros(method, how, way):
    """tan θ changes its sign at its poles too, and atan2 at π, where DOP853 told of the next zero twice."""
    rotor = System(theta.momentum**2 / 2, (theta,), (theta.momentum,))
    turned = sp.atan2(sp.sin(theta), sp.cos(theta))
    for function, zeros in ((turned, [2 * np.pi]), (sp.tan(theta), [np.pi, 2 * np.pi])):
        run = {"method": method, "events": [Event(function)], "samples": 50, **how}
        if method == Taylor() and function != turned:
            with pytest.raises(NonFiniteStateError, match="or of that of an event"):
                propagate(rotor, (0, way * 7), [0.1 * way, 1], **run)
            continue
        met = times(propagate(rotor, (0, way * 7), [0.1 * way, 1], **run))
        assert met == pytest.approx([way * (zero - 0.1) for zero in zeros], abs=1e-12)
