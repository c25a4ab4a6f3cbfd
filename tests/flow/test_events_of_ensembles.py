"""Events of many orbits: each meets its own, the same bits as by itself."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import sympy as sp

from canon import (
    Event,
    Hamiltonian,
    Lagrangian,
    Splitting,
    TimeTransformed,
    coordinates,
    load_motion,
    parameters,
    propagate,
)

if TYPE_CHECKING:
    from pathlib import Path

x, y = coordinates("x y")
p, q = x.momentum, y.momentum
k = parameters("k", positive=True)
henon_heiles = Hamiltonian((p**2 + q**2 + x**2 + y**2) / 2 + x**2 * y - y**3 / 3, [x, y], [p, q])
STARTS = np.array([[0, 0, 0], [0.1, -0.1, 0.2], [0.4, 0.35, 0.3], [0.1, 0, 0.05]])
SECTION = Event(x, 1)

METHODS: list[dict[str, Any]] = [
    {},
    {"precision": "extended"},
    {"method": "DOP853"},
    {"method": "verlet", "step": 0.05},
    {"method": "kahan-li-8", "step": 0.1},
    {"method": "RK4", "step": 0.05},
    {"method": "gauss-6", "step": 0.1},
]


@pytest.mark.parametrize("how", METHODS)
def test_a_section_of_many_orbits_is_that_of_each(how: dict[str, Any]) -> None:
    many = propagate(henon_heiles, (0, 60), STARTS, events=[SECTION], samples=30, **how)
    assert len(many.events) == 3
    for j, start in enumerate(STARTS.T):
        one = propagate(henon_heiles, (0, 60), start, events=[SECTION], samples=30, **how)
        assert (many.y[:, :, j] == one.y).all()
        assert [met.t for met in many.events[j]] == [met.t for met in one.events]
        assert all((a.y == b.y).all() for a, b in zip(many.events[j], one.events, strict=True))
        assert len(one.events) > 5
    assert [len(met) for met in many.events] != [0, 0, 0]
    points = np.array([met.y for met in many.events[1]])
    assert abs(points[:, 0]).max() < 1e-12
    assert points[:, 2].min() > 0


def test_the_section_is_of_the_motion_without_events() -> None:
    with_them = propagate(henon_heiles, (0, 30), STARTS, events=[SECTION], method="verlet", step=0.05)
    without = propagate(henon_heiles, (0, 30), STARTS, method="verlet", step=0.05)
    assert (with_them.y == without.y).all()


def test_events_of_other_systems_with_parameters_by_orbit() -> None:
    spring = Lagrangian(x.dot**2 / 2 - k * x**2 / 2, [x])
    stiffness = np.array([1.0, 4.0, 9.0])
    motion = propagate(spring, (0, 10), [1, 0], parameters={k: stiffness}, events=[Event(x)])
    for w, met in zip(np.sqrt(stiffness), motion.events, strict=True):
        by_hand = (np.arange(20) + 0.5) * np.pi / w
        assert np.abs(np.array([each.t for each in met]) - by_hand[by_hand < 10]).max() < 1e-12


def test_every_orbit_bounces_by_itself() -> None:
    falling = Hamiltonian(p**2 / 2 + x, [x], [p])
    heights = np.array([0.5, 2.0])
    motion = propagate(falling, (0, 9), [heights, [0, 0]], events=[Event(x, -1, "bounce")])
    for h, met in zip(heights, motion.events, strict=True):
        fall = np.sqrt(2 * h)
        times = fall * np.arange(1, 20, 2)
        assert np.abs(np.array([each.t for each in met]) - times[times < 9]).max() < 1e-13
    assert np.abs(motion.energy_error).max() < 1e-14


def test_they_are_resumed_kept_and_their_errors_told(tmp_path: Path) -> None:
    how: dict[str, Any] = {"method": "kahan-li-8", "step": 0.1, "events": [SECTION]}
    half = propagate(henon_heiles, (0, 30), STARTS, samples=30, **how)
    whole = propagate(henon_heiles, (0, 60), STARTS, samples=60, **how)
    half.save(tmp_path / "half.npz")
    for motion in (half, load_motion(tmp_path / "half.npz")):
        on = motion.resume(60)
        assert (on.y == whole.y).all()
        assert [[a.t for a in met] for met in on.events] == [[a.t for a in met] for met in whole.events]
    errors = half.error_estimate().events
    assert errors.shape == (sum(map(len, half.events)),)
    assert errors.max() < 1e-4
    assert half.error_estimate([1]).events.shape == (len(half.events[1]),)


def test_time_transformed_orbits_meet_their_own() -> None:
    r = sp.sqrt(x**2 + y**2)
    kepler = Hamiltonian((p**2 + q**2) / 2 - 1 / r, [x, y], [p, q])
    starts = np.array([[0.5, 0.2], [0, 0], [0, 0], [np.sqrt(3.0), 3.0]])
    chosen: dict[str, Any] = {"method": TimeTransformed(Splitting("kahan-li-8")), "step": 0.01}
    many = propagate(kepler, (0, 10), starts, events=[Event(y, 1)], **chosen)
    for j, start in enumerate(starts.T):
        one = propagate(kepler, (0, 10), start, times=many.t[1:-1], events=[Event(y, 1)], **chosen)
        assert [met.t for met in many.events[j]] == [met.t for met in one.events]


def test_an_event_that_stops_is_refused_with_what_to_do() -> None:
    with pytest.raises(ValueError, match=r"would stop each of many orbits.*action='record'"):
        propagate(henon_heiles, (0, 10), STARTS, events=[Event(x, 1, "stop")])
