"""Contacts met at one instant: determined where the impacts leave one another alone, else an error that says so."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from sympy import Rational

from canon import Lagrangian, coordinates, propagate
from canon.flow import NonFiniteStateError
from canon.mechanics import UnilateralLagrangian

x, y, z = coordinates("x y z")
METHODS: list[dict[str, Any]] = [{}, {"method": "DOP853"}]


def three_balls(masses: tuple[int, int, int], restitution: Any) -> UnilateralLagrangian:
    T = sum(m * s.dot**2 for m, s in zip(masses, (x, y, z), strict=True)) / 2
    return UnilateralLagrangian(Lagrangian(T, [x, y, z]), [y - x - 1, z - y - 1], restitution=restitution)


@pytest.mark.parametrize("how", METHODS)
@pytest.mark.parametrize("masses", [(1, 1, 1), (10, 1, 10), (1, 10, 1), (2, 3, 5)])
@pytest.mark.parametrize("restitution", [0, Rational(1, 2), 1])
def test_two_balls_that_strike_a_third_at_once_are_refused_with_time_and_contacts(masses, restitution, how):
    with pytest.raises(NonFiniteStateError, match="met at one instant") as told:
        propagate(three_balls(masses, restitution), (0, 3), [0, 2, 4, 1, 0, -1], **how)
    assert abs(told.value.time - 1) < 1e-12
    assert np.allclose(told.value.state, [1, 2, 3, 1, 0, -1], atol=1e-12)
    for said in ("-x + y - 1 = 0", "-y + z - 1 = 0", "start a little beside"):
        assert said in str(told.value)


@pytest.mark.parametrize("how", METHODS)
def test_a_little_beside_the_balls_change_their_speeds_one_after_the_other(how):
    """Balls of one mass exchange their speeds, three times in all."""
    final = propagate(three_balls((1, 1, 1), 1), (0, 3), [0, 2, 4.001, 1, 0, -1], **how).final
    assert np.allclose(final[3:], [-1, 0, 1], atol=1e-12)


@pytest.mark.parametrize("how", METHODS)
@pytest.mark.parametrize("restitution", [1, Fraction(1, 2)])
def test_a_corner_with_a_right_angle_is_determined(restitution, how):
    ball = UnilateralLagrangian(
        Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y]), [x, y], restitution=Rational(restitution)
    )
    final = propagate(ball, (0, 3), [1, 2, -1, -2], **how).final
    e = float(restitution)
    assert np.allclose(final, [2 * e, 4 * e, e, 2 * e], atol=1e-12)


def test_a_corner_with_another_angle_is_not():
    ball = UnilateralLagrangian(Lagrangian((x.dot**2 + y.dot**2) / 2, [x, y]), [x + y, y], restitution=1)
    with pytest.raises(NonFiniteStateError, match=r"x \+ y = 0 and at y = 0 are met at one instant, t = 1"):
        propagate(ball, (0, 3), [1, 2, -1, -2])
    with pytest.raises(NonFiniteStateError, match="met at one instant, t = -1"):
        propagate(ball, (0, -3), [1, 2, 1, 2])
