"""Unilateral constraints: contacts that open where their force would pull, impacts, and what is refused."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
import sympy as sp

from canon import (
    ConstrainedLagrangian,
    Lagrangian,
    coordinates,
    load_motion,
    parameters,
    propagate,
)
from canon.flow import AccuracyWarning, flow_jacobian, right_hand_side
from canon.flow.equations.contact_regimes import ContactRegime
from canon.flow.run.non_finite_state import PiledUpError
from canon.mechanics import UnilateralLagrangian

x, y, r, theta, phi = coordinates("x y r theta phi")
g, a, m = parameters("g a m", positive=True)
e = parameters("e", nonnegative=True)
t = sp.Symbol("t", real=True)
GRAVITY = 9.81

METHODS: list[tuple[dict[str, Any], float]] = [
    ({}, 1e-13),
    ({"method": "DOP853"}, 1e-10),
    ({"method": "RK4", "step": 0.001}, 1e-9),
    ({"method": "gauss-6", "step": 0.01}, 1e-9),
]

in_plane = Lagrangian(m * (x.dot**2 + y.dot**2) / 2 - m * g * y, [x, y])
falling = Lagrangian(y.dot**2 / 2 - g * y, [y])
VALUES = {g: GRAVITY, a: 1, m: 2}


def _regimes(motion: Any) -> list[tuple[int, ...]]:
    return [each.closed for each in motion.regimes]


@pytest.mark.parametrize(("how", "near"), METHODS)
@pytest.mark.parametrize("speed", [0.0, 1.2])
def test_a_bead_leaves_the_hoop_where_two_thirds_of_its_height_are_left_and_flies_a_parabola(
    how: dict[str, Any], near: float, speed: float
) -> None:
    begin = 0.1
    start = [np.sin(begin), np.cos(begin), speed * np.cos(begin), -speed * np.sin(begin)]
    motion = propagate(
        UnilateralLagrangian(in_plane, x**2 + y**2 - a**2), (0, 1.5), start, parameters=VALUES, **how
    )
    left = motion.events[0]
    # N = m g cos θ − m v²/a = 0 with v² = v₀² + 2 g a (cos θ₀ − cos θ)
    by_hand = (2 * np.cos(begin) + speed**2 / GRAVITY) / 3
    assert abs(left.y[1] - by_hand) < near
    assert _regimes(motion) == [(1,), ()]
    assert motion.regimes[0] == ContactRegime(0.0, left.t, (1,))
    flies = motion.t > left.t
    time = motion.t[flies] - left.t
    assert np.abs(motion["x"][flies] - (left.y[0] + left.y[2] * time)).max() < near
    assert np.abs(motion["y"][flies] - (left.y[1] + left.y[3] * time - GRAVITY * time**2 / 2)).max() < near
    assert np.abs(motion["lambda_1"][flies]).max() == 0
    assert motion["lambda_1"][~flies].min() > 0
    assert np.abs(motion.energy_error).max() < 10 * near


def test_a_ball_leaves_the_sphere_at_two_thirds_whatever_turns_it() -> None:
    # In spherical coordinates, turning about the vertical at rate 0: cos θ = 2/3 from the top.
    L = Lagrangian(
        (r.dot**2 + r**2 * theta.dot**2 + r**2 * sp.sin(theta) ** 2 * phi.dot**2) / 2 - g * r * sp.cos(theta),
        [r, theta, phi],
    )
    motion = propagate(
        UnilateralLagrangian(L, r - a), (0, 12), [1, 1e-3, 0, 0, 0, 0], parameters={g: 1, a: 1}, samples=500
    )
    left = motion.events[0]
    assert abs(np.cos(left.y[1]) - 2 / 3 * np.cos(1e-3)) < 1e-12
    assert motion["r"].min() > 1 - 1e-13
    assert motion["r"][-1] > 1.1
    bound = propagate(
        ConstrainedLagrangian(L, [r - a]), (0, 4), [1, 0.1, 0, 0, 0, 0], parameters={g: 1, a: 1}
    )
    assert abs(bound["r"] - 1).max() < 1e-12  # the twin that holds both ways never leaves


def test_a_block_leaves_a_wedge_whose_acceleration_grows() -> None:
    # The wedge's face y = (b t³/6 … − x) moves to the right with b t; the block's force is N ∝ g cos α − b t sin α
    slope, b = 0.5, 3.0
    face = y + slope * (x + b * t**3 / 6)
    start = [0.0, 0.0, 0.0, 0.0]
    motion = propagate(UnilateralLagrangian(in_plane, face), (0, 8), start, parameters={g: GRAVITY, m: 1})
    left = motion.events[0]
    # f̈ of the free block, −g + slope b t, becomes positive
    assert abs(left.t - GRAVITY / (slope * b)) < 1e-12
    assert _regimes(motion) == [(1,), ()]
    # W = ∫ λ (−∂f/∂t) dt with λ = m (g − slope b t)/(1 + slope²), ∂f/∂t = slope b t²/2
    end = left.t
    work = -slope * b / 2 / (1 + slope**2) * (GRAVITY * end**3 / 3 - slope * b * end**4 / 4)
    assert abs(motion.work[-1] - work) < 1e-10 * abs(work)
    assert np.abs(motion.energy_defect).max() < 1e-11 * np.abs(motion.energy).max()


@pytest.mark.parametrize(("how", "near"), METHODS)
@pytest.mark.parametrize("coefficient", [0.5, 0.9, 1.0])
def test_a_bouncing_ball_meets_the_ground_at_times_of_a_geometric_series(
    how: dict[str, Any], near: float, coefficient: float
) -> None:
    ball = UnilateralLagrangian(falling, y, e)
    motion = propagate(ball, (0, 2.99), [1, 0], parameters={g: 2, e: coefficient}, **how)
    # falls for 1, flies for 2 e, 2 e² … after that
    times = 1 + 2 * np.cumsum([0.0, *(coefficient**k for k in range(1, 40))])
    met = [each.t for each in motion.events]
    assert np.abs(np.array(met) - times[: len(met)]).max() < near
    assert len(met) == (times < 2.99).sum()
    assert motion["y"].min() > -near
    assert abs(motion.energy[-1] - 2 * coefficient ** (2 * len(met))) < near
    assert np.abs(motion.energy_error).max() < 10 * near
    assert _regimes(motion) == [()]


@pytest.mark.parametrize("how", [how for how, _ in METHODS])
def test_impacts_that_pile_up_are_an_error_and_no_hang(how: dict[str, Any]) -> None:
    ball = UnilateralLagrangian(falling, y, sp.Rational(1, 2))
    with pytest.raises(PiledUpError, match=r"restitution=0") as told:
        propagate(ball, (0, 4), [1, 0], parameters={g: 2}, **how)
    assert abs(told.value.time - 3) < 1e-3


@pytest.mark.parametrize(("how", "near"), METHODS)
def test_what_is_not_thrown_back_stays_in_contact(how: dict[str, Any], near: float) -> None:
    # A bead falls into a bowl and slides in it, the speed across gone.
    bowl = UnilateralLagrangian(in_plane, y - x**2 / 2, 0)
    motion = propagate(bowl, (0, 3), [1, 1, 0, 0], parameters={g: GRAVITY, m: 1}, **how)
    fall = np.sqrt(2 * 0.5 / GRAVITY)
    assert abs(motion.events[0].t - fall) < near
    assert _regimes(motion) == [(), (1,)]
    slides = motion.t > motion.events[0].t
    assert np.abs(motion["y"] - motion["x"] ** 2 / 2)[slides].max() < near
    # along the tangent (1, 1)/√2 half the energy of the fall is kept
    lost = GRAVITY * 0.5 / 2
    assert abs(motion.work[-1] + lost) < 10 * near
    assert np.abs(motion.energy_error).max() < 10 * near
    assert motion["lambda_1"][slides].min() > 0


def test_an_impact_without_a_restitution_stops_and_says_where() -> None:
    ball = UnilateralLagrangian(falling, y)
    with pytest.warns(AccuracyWarning, match=r"t = 1, state .*y = 0.*restitution=e"):
        motion = propagate(ball, (0, 4), [1, 0], parameters={g: 2})
    assert motion.stopped
    assert motion.t[-1] == 1
    with pytest.raises(ValueError, match="does not go on"):
        motion.resume(5)


def test_a_block_slides_against_a_wall_and_back_and_falls_over_the_edge_of_nothing() -> None:
    # Two contacts: the table y ≥ 0 keeps carrying the block while the wall 1 − x ≥ 0 throws it back.
    table = UnilateralLagrangian(in_plane, [y, 1 - x], [0, sp.Rational(1, 2)])
    motion = propagate(table, (0, 3), [0, 0, 1, 0], parameters={g: GRAVITY, m: 2})
    assert [each.t for each in motion.events] == [1.0]
    assert _regimes(motion) == [(1,)]
    assert abs(motion["x"][-1] - 0) < 1e-14
    assert abs(motion["lambda_1"] - 2 * GRAVITY).max() < 1e-12


def test_an_impact_beside_a_closed_contact_that_it_pushes_at_stops() -> None:
    ramp = UnilateralLagrangian(in_plane, [y, 1 - x - y], [0, 1])
    with pytest.warns(AccuracyWarning, match="another contact is closed"):
        motion = propagate(ramp, (0, 3), [0, 0, 1, 0], parameters={g: GRAVITY, m: 1})
    assert abs(motion.t[-1] - 1) < 1e-14


@pytest.mark.parametrize(
    ("start", "said"),
    [
        ([-1, 0], "beyond a wall"),
        ([0, -1], "moves into a wall"),
    ],
)
def test_starts_that_no_contact_allows_are_refused(start: list[float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        propagate(UnilateralLagrangian(falling, y, 1), (0, 1), start, parameters={g: 2})


def test_starts_on_a_wall_rest_leave_or_stay() -> None:
    ball = UnilateralLagrangian(falling, y, 1)
    thrown = propagate(ball, (0, 0.9), [0, 1], parameters={g: 2})
    assert np.abs(thrown["y"] - (thrown.t - thrown.t**2)).max() < 1e-14
    assert _regimes(thrown) == [()]
    resting = propagate(ball, (0, 0.9), [0, 0], parameters={g: 2})
    assert _regimes(resting) == [(1,)]
    assert np.abs(resting["lambda_1"] - 2).max() < 1e-14

    up = UnilateralLagrangian(Lagrangian(y.dot**2 / 2 + g * y, [y]), y, 1)
    rising = propagate(up, (0, 0.9), [0, 0], parameters={g: 2})
    assert _regimes(rising) == [()]
    assert np.abs(rising["y"] - rising.t**2).max() < 1e-14


def test_units_of_any_size_give_the_same_motion() -> None:
    hoop = UnilateralLagrangian(in_plane, x**2 + y**2 - a**2)
    for size in (1e-25, 1e-6, 1e12):
        start = [size * np.sin(0.1), size * np.cos(0.1), 0, 0]
        motion = propagate(hoop, (0, 1), start, parameters={g: GRAVITY * size, a: size, m: 1e20})
        assert abs(motion.events[0].y[1] / size - 2 / 3 * np.cos(0.1)) < 1e-12
        assert _regimes(motion) == [(1,), ()]


def test_contact_is_kept_in_files_and_resumed_to_the_same_bits(tmp_path: Any) -> None:
    ball = UnilateralLagrangian(falling, y, sp.Rational(1, 2))
    motion = propagate(ball, (0, 2.1), [1, 0], parameters={g: 2})
    motion.save(tmp_path / "ball.npz")
    again = load_motion(tmp_path / "ball.npz")
    assert again.regimes == motion.regimes
    assert (again.resume(2.6).y == motion.resume(2.6).y).all()
    assert motion.error_estimate().relative[-1] < 1e-14


def test_backward_motion_leaves_too() -> None:
    hoop = UnilateralLagrangian(in_plane, x**2 + y**2 - a**2)
    start = [np.sin(0.1), np.cos(0.1), 0, 0]
    motion = propagate(hoop, (0, -1.5), start, parameters=VALUES)
    assert abs(motion.events[0].y[1] - 2 / 3 * np.cos(0.1)) < 1e-13


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: UnilateralLagrangian(falling, y.dot), "without velocities"),
        (lambda: UnilateralLagrangian(falling, g), "no constraint on the positions"),
        (lambda: UnilateralLagrangian(falling, []), "no unilateral constraint"),
        (lambda: UnilateralLagrangian(falling, y, 2), "not between 0"),
        (lambda: UnilateralLagrangian(falling, y, y), "changes with the motion"),
        (lambda: UnilateralLagrangian(falling, [y], [1, 1]), "2 coefficients"),
    ],
)
def test_what_is_no_contact_is_refused(make: Any, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        make()


def test_ensembles_and_wide_numbers_say_what_to_do() -> None:
    ball = UnilateralLagrangian(falling, y, 1)
    with pytest.raises(ValueError, match="one by one"):
        propagate(ball, (0, 1), [[1, 2], [0, 0]], parameters={g: 2})
    with pytest.raises(ValueError, match="'double' and 'extended' only"):
        propagate(ball, (0, 1), [1, 0], parameters={g: 2}, precision="quad")
    with pytest.raises(AttributeError, match="no unilateral constraints"):
        _ = propagate(falling, (0, 1), [1, 0], parameters={g: 2}).regimes
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        propagate(ball, (0, 0.5), [1, 0], parameters={g: 2}, precision="extended")


def test_what_knows_no_events_refuses_contacts() -> None:
    ball = UnilateralLagrangian(falling, y, 1)
    with pytest.raises(ValueError, match="knows no events"):
        flow_jacobian(ball, (0, 3), [1, 0], parameters={g: 2})
    with pytest.raises(ValueError, match="knows no events"):
        right_hand_side(ball, [1, 0], {g: 2})
    assert right_hand_side(ball.closed(), [1, 0], {g: 2})(0, [1, 0])[1] == -2


@pytest.mark.parametrize("events", [y, [y], lambda t, y: y[0], [lambda t, y: y[0]]])
def test_events_that_are_none_are_refused_with_what_to_write(events: Any) -> None:
    with pytest.raises(TypeError, match="give a list of"):
        propagate(falling, (0, 1), [1, 0], parameters={g: 2}, events=events)


@pytest.mark.parametrize("e", [0, sp.Rational(1, 2)])
def test_impacts_that_lose_energy_are_not_run_backwards(e):
    y = coordinates("y")
    ball = UnilateralLagrangian(Lagrangian(y.dot**2 / 2 - 2 * y, [y]), [y], restitution=e)
    with pytest.raises(
        ValueError, match=r"impacts at y = 0 lose energy .* a span that grows, or restitution=1"
    ):
        propagate(ball, (0, -1.5), [1.0, 0.0])


def test_impacts_that_lose_nothing_are_run_backwards():
    y = coordinates("y")
    ball = UnilateralLagrangian(Lagrangian(y.dot**2 / 2 - 2 * y, [y]), [y], restitution=1)
    there = propagate(ball, (0, 1.7), [1.0, 0.3], samples=1).y[:, -1]
    back = propagate(ball, (1.7, 0), there, samples=1).y[:, -1]
    assert np.abs(back - [1.0, 0.3]).max() < 1e-12
