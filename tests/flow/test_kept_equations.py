"""Equations kept from call to call: the same motion to the bit, and nothing of one start or number in another."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy as sp

from canon import Lagrangian, VectorField, coordinates, parameters, propagate
from canon.flow import DOP853, RK4, Event
from canon.flow.request import Request
from canon.flow.system import kept_equations
from canon.flow.system_request import any_task
from canon.mechanics import UnilateralLagrangian
from tests.mechanics.test_articulated import chain

x, y = coordinates("x y")
g, k = parameters("g k", positive=True)
PENDULUM = Lagrangian(x.dot**2 / 2 + g * sp.cos(x), [x], forces=[-k * x.dot])


def equations(system: Any, y0: list[float], **numbers: float) -> Any:
    return any_task(Request(system, (0.0, 1.0), y0, parameters=numbers))[0].system


def end(system: Any, y0: list[float], **numbers: float) -> np.ndarray:
    return propagate(system, (0, 5), y0, method=RK4(), step=0.01, samples=2, parameters=numbers).y[:, -1]


def test_another_call_takes_the_equations_that_are_there() -> None:
    field = VectorField((y, -k * x), (x, y))
    for system, numbers in ((PENDULUM, {"g": 9.81, "k": 0.1}), (field, {"k": 2.0})):
        first = equations(system, [0.3, 0.0], **numbers)
        assert equations(system, [0.31, 0.0], **numbers) is first
        assert equations(system, [0.3, 0.0], **numbers | {"k": 0.2}) is not first


def test_no_motion_hangs_on_what_was_asked_before() -> None:
    kept_equations._kept.cache_clear()
    first = end(PENDULUM, [0.3, 0.0], g=9.81, k=0.1)
    for other in ({"g": 1.5, "k": 0.3}, {"g": 9.81, "k": 0.2}):
        end(PENDULUM, [0.2, 0.1], **other)
    assert (end(PENDULUM, [0.3, 0.0], g=9.81, k=0.1) == first).all()
    kept_equations._kept.cache_clear()
    end(PENDULUM, [1.0, 0.1], g=9.81, k=0.1)  # the equations are those of another start now
    assert (end(PENDULUM, [0.3, 0.0], g=9.81, k=0.1) == first).all()


def test_a_start_without_accelerations_is_refused_after_a_good_one() -> None:
    vanishing = Lagrangian(x**2 * x.dot**2 / 2 - x, [x])
    equations(vanishing, [1.0, 0.0])
    with pytest.raises(ValueError, match="the mass matrix is singular at the start along x_dot"):
        equations(vanishing, [0.0, 0.0])
    root = Lagrangian(sp.sqrt(x) * x.dot**2 / 2, [x])
    equations(root, [1.0, 0.1])
    with pytest.raises(ValueError, match="the mass matrix is not finite at the start"):
        equations(root, [-1.0, 0.1])


def test_contacts_are_closed_or_open_as_the_start_says() -> None:
    """A ball that is thrown up leaves the ground, one that rests stays, whichever was asked for first."""
    ball = UnilateralLagrangian(Lagrangian(y.dot**2 / 2 - g * y, [y]), y, 1)
    for speed in (1, 0, 1):
        motion = propagate(ball, (0, 0.9), [0, speed], parameters={g: 2})
        assert np.abs(motion["y"] - speed * (motion.t - motion.t**2)).max() < 1e-14


def test_a_start_may_ask_for_pivots_of_its_own() -> None:
    """M = ((x, 1), (1, 0)): ẍ = −1 and ÿ = −x + x·1 − ẋ²/2 − … hold from x = 1 and from x = 0, where a pivot is 0."""
    L = Lagrangian(x * x.dot**2 / 2 + x.dot * y.dot - y - x**2 / 2, [x, y])
    regular, singular = equations(L, [1.0, 0.0, 0.0, 0.0]), equations(L, [0.0, 0.0, 0.0, 0.0])
    assert singular is not regular
    assert equations(L, [1.0, 0.0, 0.0, 0.0]) is regular
    assert equations(L, [0.0, 0.0, 0.0, 0.0]) is singular
    for start in ([1.0, 0.2, 0.3, 0.4], [0.0, 0.2, 0.3, 0.4]):
        motion = propagate(L, (0, 0.5), start, samples=2)
        t = 0.5
        assert motion.y[0, -1] == pytest.approx(start[0] + start[2] * t - t**2 / 2, rel=1e-14)


def test_a_chain_of_links_keeps_its_energy_and_bounces() -> None:
    links = chain(7)
    start = [0.4, *[0.1] * 6, *[0.0] * 7]
    motion = propagate(links, (0, 8), start, method=DOP853(), samples=31)
    assert np.abs(motion.energy_error).max() < 1e-10
    wall = Event(links.q[0], action="bounce")
    bounced = propagate(links, (0, 8), start, method=DOP853(), samples=31, events=[wall])
    assert bounced.events
    assert bounced.y[0].min() > -1e-9
    assert motion.y[0].min() < -0.1
    assert np.abs(bounced.energy_error).max() < 1e-10
