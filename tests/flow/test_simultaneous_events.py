"""Several events at one instant, each of which changes the state."""

import numpy as np
import pytest

from canon import DOP853, Event, Hamiltonian, Splitting, Taylor, coordinates, propagate
from canon.flow import NonFiniteStateError

x, y = coordinates("x y")
FREE = Hamiltonian((x.momentum**2 + y.momentum**2) / 2, [x, y], [x.momentum, y.momentum])
BOX = [Event(wall, -1, "bounce") for wall in (x, y, 1 - x, 1 - y)]
METHODS = [{"method": Taylor()}, {"method": Splitting("verlet"), "step": 0.1}]


@pytest.mark.parametrize("how", METHODS)
def test_a_ball_into_the_corners_of_a_box(how):
    motion = propagate(FREE, (0, 50.25), [0.5, 0.5, 1.0, 1.0], events=BOX, samples=3, **how)
    assert len(motion.events) == 100
    assert np.allclose(motion.final[:2], 0.75, atol=1e-13)


@pytest.mark.parametrize("how", METHODS)
@pytest.mark.parametrize("turned", [False, True])
def test_a_bounce_where_another_event_ends_the_motion(how, turned):
    events = [Event(x, -1, "bounce"), Event(y, -1, "stop"), Event(x + y, -1)]
    motion = propagate(
        FREE, (0, 5), [1.0, 1.0, -1.0, -1.0], events=events[::-1] if turned else events, samples=3, **how
    )
    assert motion.stopped
    assert abs(motion.t[-1] - 1) < 1e-15
    assert np.allclose(motion.final[:2], 0, atol=1e-15)


@pytest.mark.parametrize("how", METHODS)
def test_a_bounce_where_another_event_is_noted(how):
    events = [Event(x, -1, "bounce"), Event(y, -1)]
    motion = propagate(FREE, (0, 5), [1.0, 1.0, -1.0, -1.0], events=events, samples=3, **how)
    assert sorted(str(met.event) for met in motion.events) == ["x = 0", "y = 0"]
    assert np.allclose(motion.final, [4, -4, 1, -1], atol=1e-14)


@pytest.mark.parametrize("end", [10, -10])
def test_an_event_that_vanishes_with_its_rate_is_found_or_missed_aloud(end):
    """heyoka's search for roots gives up at some triple ones; the event was then passed without a word."""
    spring = Hamiltonian((x.momentum**2 + x**2) / 2, [x], [x.momentum])
    events = [Event(x), Event(2 * x), Event(x**3)]
    with pytest.raises(NonFiniteStateError, match=r"x\*\*3 = 0 was passed unseen between t = -?1.5"):
        propagate(spring, (0, end), [1, 0], events=events)
    found = propagate(spring, (0, end), [1, 0], events=events, method=DOP853())
    for event in events:
        times = [met.t for met in found.events if met.event is event]
        assert np.allclose(times, np.sign(end) * np.pi * np.array([0.5, 1.5, 2.5]), atol=1e-4)
