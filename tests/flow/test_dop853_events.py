"""DOP853 meets events where Taylor's method does, and arguments that are no functions get a sentence."""

import numpy as np
import pytest
import sympy as sp

from canon import Event, Hamiltonian, Lagrangian, coordinates, propagate, time
from canon.flow.run.non_finite_state import NonFiniteStateError, PiledUpError

x = coordinates("x")
p = x.momentum
pendulum = Hamiltonian(p**2 / 2 - sp.cos(x), [x], [p])


def both(events, until=30):
    return [propagate(pendulum, (0, until), [1, 0], method=m, events=events) for m in ("taylor", "DOP853")]


@pytest.mark.parametrize(
    "events",
    [
        [Event(x), Event(p, 1), Event(x**2 - 0.3, -1)],
        [Event(x - 0.7, 1, "bounce"), Event(p)],
        [Event(x, -1, {p: p / 2})],
        [Event(p - x, -1, "stop"), Event(x)],
        [Event((x - 0.999) * 10)],
    ],
    ids=["record", "bounce", "kick", "stop", "twice in a step"],
)
def test_events_are_those_of_taylor(events):
    exact, found = both(events)
    assert [met.event for met in found.events] == [met.event for met in exact.events]
    assert [met.rising for met in found.events] == [met.rising for met in exact.events]
    assert [met.t for met in found.events] == pytest.approx([met.t for met in exact.events], abs=1e-9)
    assert found.final == pytest.approx(exact.final, abs=1e-9)
    assert found.t[-1] == pytest.approx(exact.t[-1], abs=1e-9)


def test_events_leave_the_motion_as_it_is():
    noted = propagate(pendulum, (0, 30), [1, 0], method="DOP853", events=[Event(x)])
    assert (noted.y == propagate(pendulum, (0, 30), [1, 0], method="DOP853").y).all()
    assert abs(np.array([met.y[0] for met in noted.events])).max() < 1e-14


def test_backwards():
    there = propagate(pendulum, (0, 10), [1, 0], method="DOP853", events=[Event(x)])
    back = propagate(pendulum, (10, 0), there.final, method="DOP853", events=[Event(x)])
    assert [met.t for met in back.events] == pytest.approx([met.t for met in there.events][::-1], abs=1e-9)


@pytest.mark.parametrize("system", [pendulum, Lagrangian(x.dot**2 / 2 + sp.cos(x), [x])], ids=["H", "L"])
def test_what_is_no_function_is_told(system):
    assert (propagate(system, (0, 1), [1, 0], observables={"a": 3}, samples=2).observables["a"] == 3).all()
    for wrong, words in [
        ({"a": "x+"}, "the observable 'a' should be an expression, not the text"),
        ({"a": x > 0}, "condition"),
        ([x], "give functions by name"),
    ]:
        with pytest.raises(TypeError, match=words):
            propagate(system, (0, 1), [1, 0], observables=wrong)
    with pytest.raises(TypeError, match="the function of an event should be an expression"):
        Event("x+")


@pytest.mark.parametrize("precision", ["double", "quad", 40])
def test_exponent_that_sympy_took_apart(precision):
    """SymPy writes exp(−(t − 50)/0.001) as 5·10²¹⁷¹⁴ exp(−1000 t), whose digits are too many for Python's text."""
    H = Hamiltonian(p**2 / 2 + x * sp.exp(-(pendulum.t - 50) / 0.001), [x], [p])
    with pytest.raises(ValueError, match="exponents with floats, which SymPy takes apart"):
        propagate(H, (0, 100), [1, 0], precision=precision)


def test_a_passing_where_one_run_ends_and_the_next_begins_is_counted_once():
    """The next run took its start for a zero, and the one before had not come to it."""
    surface = Event(sp.sin(time / 2))
    for method in ("taylor", "DOP853"):
        state, met = [0.5, 0.0], []
        for turn in range(1, 9):
            span = 2 * np.pi * (turn - 1), 2 * np.pi * turn
            run = propagate(pendulum, span, state, method=method, events=[surface], samples=2)
            state, met = run.final, [*met, *(each.t for each in run.events)]
        assert met[:7] == pytest.approx(2 * np.pi * np.arange(1, 8), rel=1e-14)
        assert len(met) <= 8


@pytest.mark.parametrize("start", [[1, 0], [1, 0.5], [0.5, 0], [0.7, 0.1], [2, 0.3], [3, 1]])
def test_a_ball_that_bounces_ever_lower_does_not_fall_through_the_floor(start):
    ball = Lagrangian(x.dot**2 / 2 - x, [x])
    end = start[1] + 3 * (start[1] ** 2 + 2 * start[0]) ** 0.5
    words = rf"met again at once at t = {end:.9g} where \(x, x_dot\) = "
    with pytest.raises(PiledUpError, match=words):
        propagate(ball, (0, 10), start, method="DOP853", events=[Event(x, -1, {x.dot: -x.dot / 2})])


@pytest.mark.parametrize("force", [0, 1])
@pytest.mark.parametrize("way", [1, -1])
def test_events_that_are_faster_than_the_steps(force, way):
    free = Hamiltonian(p**2 / 2 + force * x, [x], [p])
    span = 0.5 * way, 50.5 * way
    found = propagate(free, span, [0.3, 0.7], method="DOP853", events=[Event(sp.sin(sp.pi * time))])
    assert [met.t for met in found.events] == pytest.approx([way * k for k in range(1, 51)], abs=1e-12)
    fast = propagate(free, span, [0.3, 0.7], method="DOP853", events=[Event(sp.sin(sp.pi * time * 17 / 2))])
    assert [met.t for met in fast.events] == pytest.approx([way * k / 8.5 for k in range(5, 430)], abs=1e-12)


def test_pairs_of_crossings_within_a_step_beside_one_another():
    """sin(π t) is beyond 0.999 for a short while in every second turn."""
    free = Hamiltonian(p**2 / 2, [x], [p])
    found = propagate(
        free, (0, 50), [0, 1], method="DOP853", events=[Event(sp.sin(sp.pi * x) - sp.Rational(999, 1000))]
    )
    half = np.arccos(0.999) / np.pi
    assert [met.t for met in found.events] == pytest.approx(
        [2 * k + 0.5 + side * half for k in range(25) for side in (-1, 1)], abs=1e-9
    )


def test_events_that_can_not_be_followed_are_told():
    free = Hamiltonian(p**2 / 2, [x], [p])
    with pytest.raises(NonFiniteStateError, match=r"sin\(1000000\*t\) = 0 changes too often .* max_step"):
        propagate(free, (0, 50), [0, 1], method="DOP853", events=[Event(sp.sin(10**6 * time))])
    few = propagate(
        free, (0, 0.001), [0, 1], method="DOP853", events=[Event(sp.sin(10**6 * time))], max_step=1e-4
    )
    assert len(few.events) == 318


def test_events_of_what_is_rounding_cost_little():
    """The third coordinate of a plane vanishes all along, and so does the momentum of two alike, but for rounding."""
    y, z = coordinates("y z")
    H = (p**2 + y.momentum**2 + z.momentum**2) / 2 - 1 / sp.sqrt(x**2 + y**2 + z**2)
    kepler = Hamiltonian(H, [x, y, z], [p, y.momentum, z.momentum])
    start = [1, 0.1, 0, 0, 1, 0]
    found = propagate(kepler, (0, 20), start, method="DOP853", events=[Event(z)])
    assert found.final == pytest.approx(propagate(kepler, (0, 20), start).final, abs=1e-9)
    assert found.events == ()
    spring = (p**2 + y.momentum**2) / 2 + sp.cos(x - y) / 3
    pair = Hamiltonian(spring, [x, y], [p, y.momentum])
    told = propagate(pair, (0, 20), [0.3, 0.1, 0.7, -0.7], method="DOP853", events=[Event(p + y.momentum)])
    assert told.steps == propagate(pair, (0, 20), [0.3, 0.1, 0.7, -0.7], method="DOP853").steps


def test_a_pole_and_a_jump_within_long_steps():
    free = Hamiltonian(p**2 / 2, [x], [p])
    found = propagate(free, (0, 30), [-0.3, 1], method="DOP853", events=[Event(sp.tan(x))])
    assert [met.t for met in found.events] == pytest.approx(0.3 + np.pi * np.arange(10), abs=1e-12)
    assert all(met.rising for met in found.events)
