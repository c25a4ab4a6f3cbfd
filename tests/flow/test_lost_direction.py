"""Dry friction in the plane: a puck comes to rest, and is not pushed on by what its friction's series becomes."""

import numpy as np
import pytest
from sympy import Rational, sqrt

from canon import DOP853, Event, Lagrangian, Taylor, coordinates, propagate
from canon.flow import NonFiniteStateError

x, y = coordinates("x y")
SQUARE = x.dot**2 + y.dot**2
FRICTION = [-x.dot / sqrt(SQUARE) / 2, -y.dot / sqrt(SQUARE) / 2]
FREE = Lagrangian(SQUARE / 2, [x, y], forces=FRICTION)
ON_A_SPRING = Lagrangian(SQUARE / 2 - x**2 / 2 - y**2, [x, y], forces=FRICTION)


@pytest.mark.parametrize("method", [Taylor(), DOP853()])
@pytest.mark.parametrize("size", [1.0, 1e-12, 1e12])
def test_a_puck_stops_where_its_energy_is_spent(method, size):
    """|v| = 1 − t/2 in units of the start's speed and that friction, so that it slides for 2 and by 1."""
    system = Lagrangian(SQUARE / 2, [x, y], forces=[each * Rational(size) for each in FRICTION])
    with pytest.raises(NonFiniteStateError, match="a velocity comes to rest") as lost:
        propagate(system, (0, 3), [0, 0, 0.6 * size, 0.8 * size], method=method)
    assert lost.value.time == pytest.approx(2, rel=1e-7)
    assert lost.value.state[:2] == pytest.approx([0.6 * size, 0.8 * size], rel=1e-9)


def test_a_way_that_bends_ends_at_rest_too():
    with pytest.raises(NonFiniteStateError) as taylor:
        propagate(ON_A_SPRING, (0, 10), [1.5, 0, 0.6, 0.8])
    with pytest.raises(NonFiniteStateError) as dop853:
        propagate(ON_A_SPRING, (0, 10), [1.5, 0, 0.6, 0.8], method=DOP853())
    assert taylor.value.time == pytest.approx(dop853.value.time, rel=1e-9)
    assert taylor.value.state[:2] == pytest.approx(dop853.value.state[:2], rel=1e-8)


def test_before_it_and_stopped_by_the_person_all_is_well():
    slow = Event(SQUARE - Rational(1, 10**6), action="stop")
    stopped = propagate(FREE, (0, 3), [0, 0, 0.6, 0.8], events=[slow])
    assert stopped.t[-1] == pytest.approx(2 - 2e-3, rel=1e-13)
    before = propagate(FREE, (0, 1), [0, 0, 0.6, 0.8])
    assert before.final == pytest.approx([0.45, 0.6, 0.3, 0.4], rel=1e-14)
    assert before.events == ()
    with pytest.raises(NonFiniteStateError, match="after t = 2 "):
        before.resume(3)


def test_of_many_pucks_the_first_that_stops_is_named():
    pucks = np.array([[0, 0, 1.2, 1.6], [0, 0, 0.6, 0.8]]).T
    with pytest.raises(NonFiniteStateError, match=r"orbit 1: .* comes to rest"):
        propagate(FREE, (0, 3), pucks)
    assert propagate(FREE, (0, 1), pucks).final[2:, 0] == pytest.approx([0.9, 1.2], rel=1e-14)


def test_what_vanishes_elsewhere_is_no_velocity():
    kepler = propagate("kepler", (0, 10), samples=2, method=Taylor())
    assert kepler.events == ()
    drag = Lagrangian(SQUARE / 2, [x, y], forces=[-x.dot * sqrt(SQUARE), -y.dot * sqrt(SQUARE)])
    assert propagate(drag, (0, 1), [0, 0, 0.6, 0.8]).final[2:] == pytest.approx([0.3, 0.4], rel=1e-14)
