"""Drag −sign(v) |v|^p with p < 1 brings a body to rest at t = 1/(1 − p), and holds it there."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from sympy import Abs, Expr, Rational, sign

from canon import Event, Lagrangian, coordinates, propagate
from canon.flow import NonFiniteStateError

x, y = coordinates("x y")
METHODS: list[dict[str, Any]] = [{}, {"method": "DOP853"}]
HALF = Rational(1, 2)


def drag(speed: Any, power: Any) -> Expr:
    return -sign(speed) * Abs(speed) ** power


def pulled(*forces: Any, V: Any = 0) -> Lagrangian:
    q = [x, y][: len(forces)]
    return Lagrangian(sum(s.dot**2 for s in q) / 2 - V, q, forces=list(forces))


@pytest.mark.parametrize("how", METHODS)
@pytest.mark.parametrize("power", [Rational(1, 3), HALF, Rational(3, 4), Rational(9, 10)])
def test_the_way_to_rest_has_closed_form(power, how):
    motion = propagate(pulled(drag(x.dot, power)), (0, 12), [0, 1], samples=49, **how)
    p = float(power)
    left = np.maximum(1 - (1 - p) * motion.t, 0)
    assert np.allclose(motion["x_dot"], left ** (1 / (1 - p)), atol=2e-11)
    assert np.allclose(motion["x"], (1 - left ** ((2 - p) / (1 - p))) / (2 - p), atol=2e-11)
    assert motion.final[1] == 0
    assert [met.event.name for met in motion.events] == ["sticks at x_dot = 0"]


@pytest.mark.parametrize("how", METHODS)
def test_a_body_stops_while_another_swings_on(how):
    motion = propagate(pulled(drag(x.dot, HALF), 0, V=y**2 / 2), (0, 5), [0, 1, 1, 0], **how)
    assert np.allclose(motion.final, [2 / 3, np.cos(5), 0, -np.sin(5)], atol=1e-10)


@pytest.mark.parametrize("how", METHODS)
def test_a_body_stays_at_rest_while_another_turns_round_in_its_drag(how):
    system = pulled(drag(x.dot, HALF), drag(y.dot, HALF) / 9, V=y**2 / 2)
    final = propagate(system, (0, 5), [0, 1, 1, 0], **how).final
    true = solve_ivp(
        lambda t, s: [s[1], -s[0] - np.sign(s[1]) * np.sqrt(abs(s[1])) / 9],
        (0, 5), [1, 0], "Radau", rtol=1e-11, atol=1e-13,
    )  # fmt: skip
    assert np.allclose(final, [2 / 3, true.y[0, -1], 0, true.y[1, -1]], atol=1e-8)


@pytest.mark.parametrize("how", METHODS)
def test_two_bodies_that_come_to_rest_are_told(how):
    with pytest.raises(NonFiniteStateError, match="several kinks hold the motion at once") as told:
        propagate(pulled(drag(x.dot, HALF), drag(y.dot, HALF)), (0, 5), [0, 0, 1, 2], **how)
    assert told.value.time == pytest.approx(2 * np.sqrt(2), abs=1e-4)


@pytest.mark.parametrize("how", METHODS)
@pytest.mark.parametrize(("power", "span"), [(HALF, 5), (Rational(3, 2), 5), (Rational(3, 2), -5)])
def test_what_rests_stays_at_rest(power, span, how):
    assert (propagate(pulled(drag(x.dot, power)), (0, span), [2, 0], **how).final == [2, 0]).all()
    assert (propagate(pulled(drag(x.dot, power), V=x**2 / 2), (0, span), [0, 0], **how).final == 0).all()


@pytest.mark.parametrize("how", METHODS)
def test_a_spring_moves_it_from_where_it_turns(how):
    """At the start the speed is 0 and its rate has a root there, but the spring pulls."""
    final = propagate(pulled(drag(x.dot, HALF), V=x**2 / 2), (0, 2), [1, 0], **how).final
    true = solve_ivp(
        lambda t, s: [s[1], -s[0] - np.sign(s[1]) * np.sqrt(abs(s[1]))],
        (0, 2), [1, 0], "Radau", rtol=1e-11, atol=1e-13,
    )  # fmt: skip
    assert np.allclose(final, true.y[:, -1], atol=1e-8)


@pytest.mark.parametrize("how", METHODS)
@pytest.mark.parametrize(
    ("force", "span", "start"),
    [
        (-drag(x.dot, HALF), 1, [0, 0]),  # may start at any time
        (drag(x.dot, HALF), -1, [0, 0]),  # may have come to rest at any time
        (-(Abs(x.dot) ** HALF), 5, [0, 1]),  # leads on beyond rest
    ],
)
def test_a_rest_that_may_end_by_itself_is_told(force, span, start, how):
    with pytest.raises(NonFiniteStateError, match="not determined: it may rest, or leave at any time"):
        propagate(pulled(force), (0, span), start, **how)


@pytest.mark.parametrize("how", METHODS)
def test_a_force_that_is_infinite_at_rest_ends_the_motion(how):
    with pytest.raises(NonFiniteStateError) as told:
        propagate(pulled(drag(x.dot, -HALF)), (0, 5), [0, 1], **how)
    assert told.value.time == pytest.approx(2 / 3, abs=1e-8)


@pytest.mark.parametrize("how", METHODS)
@pytest.mark.parametrize(("force", "end"), [(drag(x.dot, HALF), 2), (-sign(x.dot), 1)])
def test_an_event_of_the_speed_stops_where_the_body_does(force, end, how):
    motion = propagate(pulled(force), (0, 5), [0, 1], events=[Event(x.dot, action="stop")], **how)
    assert motion.stopped
    assert motion.t[-1] == pytest.approx(end, abs=1e-5)
