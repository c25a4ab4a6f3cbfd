"""Contacts that close at an impact, or do not, and those that determine no motion."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import sympy as sp

from canon import ConstrainedLagrangian, Event, Lagrangian, coordinates, parameters, propagate
from canon import time as t
from canon.flow.equations.contact_regimes import check_contacts
from canon.flow.run.non_finite_state import PiledUpError
from canon.mechanics import UnilateralLagrangian

x, y, z = coordinates("x y z")
e = parameters("e", nonnegative=True)
PLANE = Lagrangian((x.dot**2 + y.dot**2) / 2 - y, [x, y])
FALLING = Lagrangian(y.dot**2 / 2 - y, [y])
HOOP = UnilateralLagrangian(PLANE, x**2 + y**2 - 1, 0)


def _closed(motion: Any) -> list[tuple[int, ...]]:
    return [each.closed for each in motion.regimes]


def dropped(height: float, place: float, speed: float) -> tuple[float, np.ndarray]:
    """Return when and with which speed a bead, thrown sideways at a height over the hoop, comes onto it."""
    # (p + v t)² + (h − t²/2)² = 1 for the first time
    roots = np.roots([0.25, 0, speed**2 - height, 2 * place * speed, place**2 + height**2 - 1])
    met = min(root.real for root in roots if abs(root.imag) < 1e-9 and root.real > 0)
    return met, np.array([place + speed * met, height - met**2 / 2, speed, -met])


def test_a_bead_that_falls_onto_a_hoop_slides_and_leaves_it_with_what_is_left_of_its_speed() -> None:
    met, (sine, cosine, vx, vy) = dropped(1.2, 0.3, 0.0)
    along = vx * cosine - vy * sine
    beside = Event(x - sp.Rational(1, 2), name="half")
    motion = propagate(HOOP, (0, 2), [0.3, 1.2, 0, 0], events=[beside], method="DOP853")
    assert _closed(motion) == [(), (1,), ()]
    assert [each.event.name for each in motion.events][1] == "half"
    assert motion.regimes[1].begin == pytest.approx(met, abs=1e-10)
    left = motion.events[2]
    # g cos θ = v²/a with v² = v₀² + 2 g a (cos θ₀ − cos θ)
    assert left.t == motion.regimes[1].end
    assert left.y[1] == pytest.approx((2 * cosine + along**2) / 3, abs=1e-9)


def test_a_bead_too_quick_for_the_hoop_loses_its_speed_across_and_flies_on() -> None:
    met, (sine, cosine, vx, vy) = dropped(1.2, -0.6, 1.2)
    along = vx * cosine - vy * sine
    assert along**2 > cosine
    motion = propagate(
        HOOP, (0, 1), [-0.6, 1.2, 1.2, 0], events=[Event(x - sp.Rational(1, 2))], method="DOP853"
    )
    assert _closed(motion) == [()]
    assert motion.events[0].t == pytest.approx(met, abs=1e-10)
    after = 1 - met
    flown = [sine + along * cosine * after, cosine - along * sine * after - after**2 / 2]
    assert motion.final[:2] == pytest.approx(flown, abs=1e-9)


def test_a_coefficient_of_restitution_beyond_one_is_refused() -> None:
    ball = UnilateralLagrangian(FALLING, y, e)
    assert propagate(ball, (0, 2), [0.5, 0], parameters={e: 1}).final == pytest.approx([0.5, 0], abs=1e-12)
    with pytest.raises(ValueError, match=r"the restitution e = 1\.5 is not between 0 and 1"):
        propagate(ball, (0, 2), [0.5, 0], parameters={e: 1.5})


def test_walls_that_leave_no_motion_or_no_number_are_refused() -> None:
    # f ≥ 0 and f ≤ 0 at once, where the first wall rises away from the second.
    pressed = UnilateralLagrangian(FALLING, [y - t**2, -y], 0)
    with pytest.raises(ValueError, match=r"contacts at -t\*\*2 \+ y = 0, -y = 0 do not determine the motion"):
        propagate(pressed, (0, 1), [0.0, 0.0])
    lost = UnilateralLagrangian(FALLING, sp.sqrt(y - 2))
    with pytest.raises(ValueError, match=r"sqrt\(y - 2\) ≥ 0 has no finite value at the start: begin inside"):
        propagate(lost, (0, 1), [1.0, 0.0])


def test_the_same_wall_twice_carries_as_once() -> None:
    twice = UnilateralLagrangian(FALLING, [y, 2 * y], 0)
    motion = propagate(twice, (0, 1), [0.0, 0.0])
    assert abs(motion["y"]).max() < 1e-15
    assert motion["lambda_1"] + 2 * motion["lambda_2"] == pytest.approx(np.ones(len(motion.t)), abs=1e-13)


def test_walls_beside_constraints_that_depend_on_one_another_are_refused() -> None:
    rail = ConstrainedLagrangian(PLANE, [x - y, 2 * x - 2 * y])
    with pytest.raises(
        ValueError, match="constraints that depend on others beside unilateral ones: leave them out"
    ):
        propagate(UnilateralLagrangian(rail, y), (0, 1), [1.0, 1.0, 0.0, 0.0])
    once = ConstrainedLagrangian(PLANE, [x - y])
    motion = propagate(UnilateralLagrangian(once, y), (0, 1), [1.0, 1.0, 0.0, 0.0])
    assert motion.final[:2] == pytest.approx([0.75, 0.75], abs=1e-13)


@pytest.mark.parametrize(
    ("until", "error", "said"),
    [
        (2.9991, PiledUpError, r"y = 0 is met ever faster up to .* go on from there with restitution=0"),
        (1.5, ArithmeticError, r"passes a wall, y = 0, at t = 1\.5: an event was missed .* smaller steps"),
    ],
)
def test_what_is_below_the_ground_was_missed_and_after_many_impacts_they_piled_up(
    until: float, error: type[Exception], said: str
) -> None:
    ball = UnilateralLagrangian(Lagrangian(y.dot**2 / 2 - 2 * y, [y]), y, sp.Rational(1, 2))
    record = propagate(ball, (0, until), [1, 0], samples=40).record
    check_contacts(record.moving, record.samples)
    fallen = record.samples.y.copy()
    fallen[record.task.system.rows[0], -1] = -0.1
    wrong = replace(record.samples, y=fallen)
    with pytest.raises(error, match=said) as told:
        check_contacts(record.moving, wrong)
    assert type(told.value) is error
