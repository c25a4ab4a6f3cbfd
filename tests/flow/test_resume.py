"""Interrupted and resumed runs give the bits of those that never stopped; motion between samples."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from canon import Hamiltonian
from canon.flow.method.method import DOP853, RK4, Gauss, Splitting
from canon.flow.method.number_formats import unit_round_off
from canon.flow.propagation import Interrupted, propagate
from canon.flow.run.event import Event
from tests.flow.systems import (
    DOUBLE_PENDULUM,
    DOUBLE_PENDULUM_START,
    DRIVEN,
    DRIVEN_START,
    HENON_HEILES,
    HENON_HEILES_START,
    KEPLER,
    kepler_start,
    theta,
    x,
)

CASES = [
    (HENON_HEILES, HENON_HEILES_START, Splitting("kahan-li-8"), {"step": 0.1}),
    (HENON_HEILES, HENON_HEILES_START, Splitting("srkn-6b"), {"step": 0.1, "precision": "double"}),
    (HENON_HEILES, HENON_HEILES_START, Splitting("verlet"), {"step": 0.1, "precision": "single"}),
    (HENON_HEILES, HENON_HEILES_START, Splitting("verlet"), {"step": 0.1, "precision": "extended"}),
    (KEPLER, kepler_start(0.3), Splitting("kahan-li-6"), {"step": 0.1, "precision": "double-double"}),
    (DOUBLE_PENDULUM, DOUBLE_PENDULUM_START, Gauss(6), {"step": 0.1}),
    (DOUBLE_PENDULUM, DOUBLE_PENDULUM_START, Gauss(3), {"step": 0.1, "precision": "single"}),
    (DOUBLE_PENDULUM, DOUBLE_PENDULUM_START, Gauss(5), {"step": 0.1, "precision": "extended"}),
    (DRIVEN, DRIVEN_START, RK4(), {"step": 0.1}),
    (DRIVEN, DRIVEN_START, Splitting("blanes-moan-4"), {"step": 0.1}),
]


def equal(a, b):
    np.testing.assert_array_equal(a.t, b.t)
    np.testing.assert_array_equal(a.y, b.y)
    np.testing.assert_array_equal(a.carried, b.carried)
    np.testing.assert_array_equal(a.energy_change, b.energy_change)
    assert a.steps == b.steps
    assert a.evaluations == b.evaluations
    for name, found in a.statistics.items():
        for part in ("mean", "least", "greatest"):
            np.testing.assert_array_equal(getattr(found, part), getattr(b.statistics[name], part))


@pytest.mark.parametrize(("system", "start", "method", "how"), CASES, ids=lambda c: str(c)[:20])
@pytest.mark.parametrize("span", [(1, 41), (1, -39)])
def test_a_run_resumed_is_the_run_in_one(system, start, method, how, span):
    t0, end = span
    arguments = {"method": method, "cadence": 3, **how}
    whole = propagate(system, span, start, samples=8, **arguments)
    half = propagate(system, (t0, (t0 + end) / 2), start, samples=4, **arguments)
    equal(half.resume(end, samples=4), whole)
    equal(half.resume(end), whole)
    equal(half.resume((t0 + 3 * end) / 4, samples=2).resume(end, samples=2), whole)


def interrupted_at(part, **arguments):
    def impatient(fraction):
        if fraction >= part:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted, match="resume") as caught:
        propagate(progress=impatient, **arguments)
    return caught.value.motion


@pytest.mark.parametrize(("system", "start", "method", "how"), CASES, ids=lambda c: str(c)[:20])
def test_an_interrupted_run_keeps_what_is_done_and_is_completed_bit_by_bit(system, start, method, how):
    arguments = {
        "system": system, "y0": start, "t_span": (0, 200), "method": method, "samples": 20, "cadence": 5, **how,
    }  # fmt: skip
    part = interrupted_at(0.4, **arguments)
    whole = propagate(**arguments)
    kept = len(part.t)
    assert 4 < kept < 15
    np.testing.assert_array_equal(part.y, whole.y[:, :kept])
    assert len(part.statistics["energy"].mean) == kept - 1
    with pytest.raises(ValueError, match="complete the interrupted run"):
        part.resume(300)
    equal(part.resume(), whole)


@pytest.mark.parametrize("precision", ["double", "extended"])
def test_taylor_is_completed_bit_by_bit(precision):
    arguments = {
        "system": HENON_HEILES, "y0": HENON_HEILES_START, "t_span": (0, 100), "samples": 40,
        "precision": precision, "events": [Event(x, 1)],
    }  # fmt: skip
    part = interrupted_at(0.4, **arguments)
    whole = propagate(**arguments)
    assert 10 < len(part.t) < 30
    completed = part.resume()
    equal(completed, whole)
    assert [met.t for met in completed.events] == [met.t for met in whole.events]
    longer = whole.resume(150)
    np.testing.assert_allclose(
        longer.final, propagate(HENON_HEILES, (0, 150), HENON_HEILES_START).final, atol=1e-11
    )


def test_dop853_goes_on_to_its_tolerance():
    arguments = {"system": HENON_HEILES, "y0": HENON_HEILES_START, "t_span": (0, 50), "method": DOP853()}
    part = interrupted_at(0.4, samples=40, **arguments)
    whole = propagate(samples=40, **arguments)
    np.testing.assert_allclose(part.resume().y, whole.y, atol=1e-9)


def test_an_interrupted_ensemble_keeps_what_all_orbits_have_reached():
    start = np.array(HENON_HEILES_START)[:, np.newaxis] * np.linspace(0.5, 1, 150)
    for method in (Splitting("kahan-li-8"), Gauss(2)):
        arguments = {
            "system": HENON_HEILES, "y0": start, "t_span": (0, 200), "samples": 50, "method": method,
            "step": 0.1, "cadence": 4,
        }  # fmt: skip
        part = interrupted_at(0.2, **arguments)
        assert 1 <= len(part.t) < 51
        assert part.y.shape[2] == 150
        equal(part.resume(), propagate(**arguments))


def test_a_run_with_events_is_resumed_with_its_events():
    arguments = {"method": Splitting("kahan-li-8"), "step": 0.1, "events": [Event(x)]}
    whole = propagate(HENON_HEILES, (0, 60), HENON_HEILES_START, samples=6, **arguments)
    half = propagate(HENON_HEILES, (0, 30), HENON_HEILES_START, samples=3, **arguments)
    resumed = half.resume(60)
    equal(resumed, whole)
    assert [met.t for met in resumed.events] == [met.t for met in whole.events]


def test_what_cannot_be_resumed_says_so():
    motion = propagate(HENON_HEILES, (0, 1), HENON_HEILES_START, method=Splitting("verlet"), step=0.1)
    with pytest.raises(ValueError, match="has arrived"):
        motion.resume()
    with pytest.raises(ValueError, match=r"no whole number of steps .* take 1\.2 or 1\.3"):
        motion.resume(1.25)
    with pytest.raises(ValueError, match="lies behind"):
        motion.resume(0.5)
    with pytest.raises(ValueError, match="finite"):
        motion.resume(float("inf"))


# between the samples -------------------------------------------------------------------------------


def test_taylors_dense_output_is_the_motion_to_its_tolerance():
    motion = propagate(HENON_HEILES, (0, 50), HENON_HEILES_START, samples=3, dense=True)
    times = np.linspace(0, 50, 301)
    true = propagate(HENON_HEILES, (0, 50), HENON_HEILES_START, times=times)
    np.testing.assert_allclose(motion(times), true.y, atol=2e-13)
    np.testing.assert_array_equal(motion(motion.t), motion.y)
    assert motion(17.3).shape == (4,)
    back = propagate(HENON_HEILES, (50, 0), motion.final, samples=2, dense=True)
    np.testing.assert_allclose(back(times), true.y, atol=1e-11)
    many = propagate(HENON_HEILES, (0, 9), np.array([HENON_HEILES_START] * 2).T, samples=2, dense=True)
    assert many(np.array([1.0, 2.0, 3.0])).shape == (4, 3, 2)
    np.testing.assert_array_equal(many(4.0)[:, 1], many(4.0)[:, 0])


def test_dense_output_goes_through_bounces():
    motion = propagate(HENON_HEILES, (0, 30), HENON_HEILES_START, dense=True, events=[Event(x, -1, "bounce")])
    assert len(motion.events) > 3
    assert motion(np.linspace(0, 30, 500))[0].min() > -1e-14
    for met in motion.events:
        np.testing.assert_allclose(motion(met.t - 1e-9), met.y, atol=1e-8)
        np.testing.assert_allclose(motion(met.t + 1e-8), met.after, atol=1e-7)


@pytest.mark.parametrize(("system", "start", "method", "how"), CASES, ids=lambda c: str(c)[:20])
def test_fixed_steps_are_taken_again_between_samples(system, start, method, how):
    few = propagate(system, (0, 10), start, method=method, samples=3, **how)
    every = propagate(system, (0, 10), start, method=method, samples=100, **how)
    again = few(every.t)
    if isinstance(method, Gauss):
        # The stages start from others: a little round-off, of doubles at least, for those are compared.
        np.testing.assert_allclose(again, every.y, atol=90 * max(2.0**-53, unit_round_off(every.precision)))
    else:
        np.testing.assert_array_equal(again, every.y)
    halves = propagate(system, (0, 10), start, samples=200).y[:, 1::2]
    middle = few(every.t[:-1] + 0.05)
    assert (
        abs(middle - halves).max()
        < 3 * abs(every.y - propagate(system, (0, 10), start, samples=100).y).max() + 1e-6
    )


def test_ensembles_between_samples_are_their_orbits():
    start = np.array(HENON_HEILES_START)[:, np.newaxis] * np.linspace(0.5, 1, 5)
    arguments = {"method": Splitting("kahan-li-8"), "step": 0.1, "samples": 3}
    together = propagate(HENON_HEILES, (0, 10), start, **arguments)(np.array([0.33, 7.77]))
    for orbit in range(5):
        alone = propagate(HENON_HEILES, (0, 10), start[:, orbit], **arguments)(np.array([0.33, 7.77]))
        np.testing.assert_array_equal(together[:, :, orbit], alone)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "dense=True"),
        ({"method": DOP853()}, "name the times"),
        (
            {"method": Splitting("verlet"), "step": 0.1, "events": [Event(theta, 0, "bounce")]},
            "events changed",
        ),
    ],
)
def test_motion_that_was_not_kept_is_refused(arguments, message):
    from tests.flow.systems import PENDULUM

    motion = propagate(PENDULUM, (0, 10), [1.0, 0.0], **arguments)
    with pytest.raises(ValueError, match=message):
        motion(3.0)
    with pytest.raises(ValueError, match="from t = 0 to 10 only"):
        motion(10.5)


@pytest.mark.parametrize("force", [0.5, 0.5 * sp.sign(1 + x)])
def test_a_motion_that_began_at_rest_in_the_origin_goes_on_over_a_much_longer_span(force):
    """Its numbers are measured by a unit that follows from the span: the state was taken over in the old one."""
    falling = Hamiltonian(x.momentum**2 / 2 - force * (1 + x), [x], [x.momentum])
    motion = propagate(falling, (0, 1), [0, 0], samples=2).resume(1000)
    np.testing.assert_allclose(motion.final, [250_000, 500], rtol=1e-14)


def test_a_motion_kept_as_a_function_of_time_is_so_after_it_went_on():
    spring = Hamiltonian(x.momentum**2 / 2 + x**2 / 2, [x], [x.momentum])
    starts = np.array([[1.0, 2.0], [0.0, 0.0]])
    for end in (20, -20):
        motion = propagate(spring, (0, end / 2), starts, dense=True).resume(end).resume(2 * end)
        times = end * np.array([0, 0.3, 0.5, 0.7, 1, 1.9, 2])
        found = np.array([np.cos(times), -np.sin(times)])
        np.testing.assert_allclose(motion(times), np.stack([found, 2 * found], axis=2), atol=1e-14)


@pytest.mark.parametrize("precision", ["extended", "quad"])
def test_a_motion_is_known_at_ends_that_doubles_round_outwards(precision):
    spring = Hamiltonian(x.momentum**2 / 2 + x**2 / 2, [x], [x.momentum])
    motion = propagate(spring, (Fraction(1, 3), Fraction(13, 3)), [1, 0], dense=True, precision=precision)
    np.testing.assert_allclose(motion(motion.t[0]), [1, 0], atol=1e-15)
    np.testing.assert_allclose(motion(motion.t[-1]), [np.cos(4), -np.sin(4)], atol=2e-15)
