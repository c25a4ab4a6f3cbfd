"""Angles with a cut: what jumps there is told, what does not goes on."""

import numpy as np
import pytest
from sympy import atan2, cos, sin

from canon import DOP853, Hamiltonian, Lagrangian, coordinates, propagate
from canon.flow import NonFiniteStateError

x, y = coordinates("x y")


def servo(_t, state):
    return [state[1], -2 * np.arctan2(np.sin(state[0]), np.cos(state[0])) - 0.1 * state[1]]


def test_a_torque_to_the_nearest_turn_jumps():
    with pytest.raises(NonFiniteStateError, match=r"jumps by 2\*pi there") as lost:
        propagate(servo, (0, 6), [0, 6.0])
    assert lost.value.state[0] == pytest.approx(np.pi, rel=1e-12)
    with pytest.raises(NonFiniteStateError, match=r"orbit 1: .* jumps by"):
        propagate(servo, (0, 6), np.array([[0, 1.0], [0, 6.0]]).T)
    assert propagate(servo, (0, 6), [0, 6.0], method=DOP853()).final == pytest.approx(
        [21.3596, -2.1417], abs=1e-3
    )
    pulled = Lagrangian(x.dot**2 / 2, [x], forces=[-2 * atan2(sin(x), cos(x))])
    with pytest.raises(NonFiniteStateError, match=r"jumps by 2\*pi there"):
        propagate(pulled, (0, 6), [0, 6.0])


def test_what_is_smooth_across_the_cut_goes_on():
    r, angle = x**2 + y**2, atan2(y, x)
    start = [-1.0, 0.3, 0.1, -0.5]
    three, same = (
        Hamiltonian((x.momentum**2 + y.momentum**2) / 2 + r / 2 + V, [x, y], [x.momentum, y.momentum])
        for V in (r**2 * cos(2 * angle) / 10, r * (x**2 - y**2) / 10)
    )
    found = propagate(three, (0, 10), start)
    assert found.final == pytest.approx(propagate(same, (0, 10), start).final, rel=1e-10)
    assert found.events == ()


def test_on_one_side_of_the_cut_all_is_well():
    swing = Hamiltonian(x.momentum**2 / 2 + atan2(sin(x), cos(x)) ** 2 / 2, [x], [x.momentum])
    motion = propagate(swing, (0, 10), [1.0, 0.0])
    assert motion["x"] == pytest.approx(np.cos(motion.t), abs=1e-12)
