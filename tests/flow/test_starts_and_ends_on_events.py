"""Events on whose zero a motion starts at rest, or a slice of it ends, in closed form."""

import numpy as np
import pytest
import sympy as sp

from canon import Event, Hamiltonian, Lagrangian, coordinates, propagate, time
from canon.flow import poincare_section

x, y = coordinates("x y")
p = x.momentum
oscillator = Hamiltonian(p**2 / 2 + x**2 / 2, [x], [p])
free = Hamiltonian(p**2 / 2, [x], [p])
ball = Lagrangian(y.dot**2 / 2 - 9.81 * y, [y])
EVERY = pytest.mark.parametrize(
    "how",
    [{}, {"precision": "quad"}, {"method": "DOP853"}, {"method": "verlet", "step": 0.01}],
    ids=["taylor", "quad", "DOP853", "verlet"],
)


@EVERY
@pytest.mark.parametrize("way", [1, -1])
def test_a_start_at_rest_on_an_event_is_no_crossing(how, way):
    """Before it comes back to touch the mark within rounding."""
    noted = propagate(oscillator, (0, 3 * way), [1, 0], events=[Event(x - 1), Event(x**2 - 1)], **how)
    assert noted.events == ()
    ended = propagate(oscillator, (0, 3 * way), [1, 0], events=[Event(x - 1, action="stop")], **how)
    assert not ended.stopped


@pytest.mark.parametrize("how", [{}, {"method": "DOP853"}], ids=["taylor", "DOP853"])
def test_a_ball_that_is_released_at_a_mark(how):
    assert propagate(ball, (0, 1), [2, 0], events=[Event(y - 2)], **how).events == ()
    (met,) = propagate(ball, (0, 1), [2, 0], events=[Event(y - 2), Event(y - 1)], **how).events
    assert met.t == pytest.approx((2 / 9.81) ** 0.5, rel=1e-14)
    assert not met.rising


@pytest.mark.parametrize("power", [2, 3])
def test_a_touch_of_higher_order_at_the_start(power):
    """x moves away as t^power, and comes back through the mark where the rest of the force has it turn."""
    pushed = Lagrangian(y.dot**2 / 2 + y * (1 if power == 2 else time) - y * time**2, [y])
    (met,) = propagate(pushed, (0, 5), [2, 0], events=[Event(y - 2)]).events
    back = 6**0.5 if power == 2 else 2.0
    assert met.t == pytest.approx(back, rel=1e-12)


def test_what_is_passed_just_after_such_a_start_is_met():
    mark = 1 - sp.Rational(1, 2**40)
    (met,) = propagate(oscillator, (0, 3), [1, 0], events=[Event(x - 1), Event(x - mark)]).events
    assert met.t == pytest.approx(2.0**-19.5, rel=1e-3)


@EVERY
def test_a_section_from_rest_does_not_count_its_start(how):
    found = poincare_section(oscillator, (0, 20), [1, 0], p, direction=0, **how)
    np.testing.assert_allclose(found.t, np.pi * np.arange(1, 7), rtol=1e-4 if "step" in how else 1e-12)
    above = Hamiltonian(p**2 / 2 + x**2 / 2 - x / 2, [x], [p])
    risen = poincare_section(above, (0, 20), [0, 0], x - sp.Rational(1, 2), direction=0, **how)
    assert len(risen.t) == 6


@pytest.mark.parametrize("samples", [None, 50, 1000])
@pytest.mark.parametrize("begin", [0.5, 0.25])
@pytest.mark.parametrize("kick", [0.8, 0.9, 1.5])
@pytest.mark.parametrize("way", [1, -1])
def test_kicks_at_whole_times_are_the_standard_map(way, kick, begin, samples):
    position, momentum, times = 0.3 + 0.2 * (1 - begin), 0.2, range(1, 13)
    for _ in times:
        momentum += way * kick * np.sin(position)
        position += momentum
    position -= momentum * (1 - begin)
    chosen = {} if samples is None else {"samples": samples}
    event = Event(sp.sin(sp.pi * time), action={p: p + kick * sp.sin(x)})
    span = (begin * way, (begin + 12) * way)
    found = propagate(free, span, [0.3, 0.2 * way], events=[event], **chosen)
    assert [met.t for met in found.events] == pytest.approx([way * t for t in times], abs=1e-13)
    assert found.final == pytest.approx([position, way * momentum], abs=1e-9)


def test_fifty_kicks_and_a_stop_where_slices_end():
    kicked = Event(sp.sin(sp.pi * time), action={p: p + 0.8 * sp.sin(x)})
    whole = propagate(free, (0.5, 50.5), [0.3, 0.2], events=[kicked])
    assert [met.t for met in whole.events] == pytest.approx(range(1, 51), abs=1e-12)
    part = propagate(free, (0.5, 13), [0.3, 0.2], events=[kicked]).resume(25.5)
    assert [met.t for met in part.events] == pytest.approx(range(1, 26), abs=1e-12)
    for end in range(1, 50):
        stopped = propagate(free, (0.5, 50.5), [0, 1], events=[Event(x + 0.5 - end, action="stop")])
        assert stopped.t[-1] == pytest.approx(end, abs=1e-12)


def test_a_start_that_only_touches_an_event_leaves_it_before_the_first_sample_and_the_next_event():
    x, p = coordinates("x"), coordinates("x").momentum
    oscillator = Hamiltonian(p**2 / 2 + x**2 / 2, [x], [p])
    dense = propagate(oscillator, (0, 1), [1.0, 0.0], events=[Event(1 - sp.cos(x - 1))], samples=2000)
    assert len(dense.t) == 2001
    assert dense["x"] == pytest.approx(np.cos(dense.t), abs=1e-14)
    for late in (1e-7, 3e-7, 1e-3):
        found = propagate(oscillator, (0, 1), [1.0, 0.0], events=[Event(x - 1), Event(time - late)])
        assert [met.t for met in found.events] == pytest.approx([late], rel=1e-6)
    stop = [Event(x - 1, action="stop"), Event(p + 1e-7, action="stop")]
    assert propagate(oscillator, (0, 1), [1.0, 0.0], events=stop).t[-1] == pytest.approx(1e-7, rel=1e-6)
