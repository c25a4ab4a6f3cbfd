"""What is gathered inside the loop is what samples at every step would have shown."""

import numpy as np
import pytest

from canon.flow.method.method import RK4, Gauss, Splitting, Taylor
from canon.flow.propagation import propagate
from tests.flow.systems import KEPLER, PENDULUM, kepler_start

x, y, px, py = *KEPLER.q, *KEPLER.p
MOMENTUM = {"L": x * py - y * px, "r2": x**2 + y**2}


@pytest.mark.parametrize("precision", ["double", "compensated"])
@pytest.mark.parametrize("method", [Splitting("verlet"), Splitting("srkn-6b"), RK4(), Gauss(3)], ids=str)
def test_statistics_of_every_step_are_those_of_all_samples(method, precision):
    arguments = {"method": method, "step": 0.05, "precision": precision, "observables": MOMENTUM}
    few = propagate(KEPLER, (0, 20), kepler_start(0.4), samples=4, cadence=1, **arguments)
    every = propagate(KEPLER, (0, 20), kepler_start(0.4), samples=400, **arguments)
    np.testing.assert_array_equal(few.y, every.y[:, ::100])
    assert list(few.statistics) == ["energy", "L", "r2"]
    for name, change in {"energy": every.energy_change, **every.changes}.items():
        blocks, found = change[1:].reshape(4, 100), few.statistics[name]
        for ours, theirs in (
            (found.mean, blocks.mean(axis=1)),
            (found.least, blocks.min(axis=1)),
            (found.greatest, blocks.max(axis=1)),
        ):
            np.testing.assert_allclose(ours, theirs, rtol=1e-13, atol=3e-18)


FLOORS = {"single": 1e-15, "extended": 1e-25, "double-double": 3e-31}
"""Round-off of the evaluation of numbers of size 1 inside the loop."""


@pytest.mark.parametrize("precision", FLOORS)
@pytest.mark.parametrize("orbits", [1, 3])
def test_statistics_in_other_precisions_are_finer_than_the_state(precision, orbits):
    start = np.array(kepler_start(0.4))[:, np.newaxis] * np.linspace(1, 1.1, orbits)
    arguments = {
        "method": Splitting("kahan-li-8"),
        "step": 0.1,
        "precision": precision,
        "observables": MOMENTUM,
    }
    few = propagate(KEPLER, (0, 4), start, samples=2, cadence=1, **arguments)
    every = propagate(KEPLER, (0, 4), start, samples=40, **arguments)
    for name, change in {"energy": every.energy_change, **every.changes}.items():
        blocks, found = change[1:].reshape(2, 20, orbits), few.statistics[name]
        floor = FLOORS[precision] + 1e-15 * abs(blocks).max()
        np.testing.assert_allclose(found.mean, blocks.mean(axis=1), rtol=0, atol=floor)
        np.testing.assert_allclose(found.least, blocks.min(axis=1), rtol=0, atol=floor)
        np.testing.assert_allclose(found.greatest, blocks.max(axis=1), rtol=0, atol=floor)
    assert abs(few.statistics["L"].largest).max() > 0


def test_running_extremes_rise_and_end_at_the_largest_of_all():
    motion = propagate(
        KEPLER, (0, 100), kepler_start(0.4), method=Splitting("verlet"), step=0.05, samples=20, cadence=1
    )
    found = motion.statistics["energy"]
    assert (np.diff(found.running) >= 0).all()
    assert found.running[0] == found.largest[0]
    assert found.running[-1] == max(abs(found.least).max(), abs(found.greatest).max())


@pytest.mark.parametrize("cadence", [3, 7, 25])
def test_a_cadence_takes_every_so_many_steps_counted_from_the_start(cadence):
    arguments = {"method": Splitting("verlet"), "step": 0.05}
    few = propagate(PENDULUM, (0, 10), [1.0, 0.0], samples=2, cadence=cadence, **arguments)
    every = propagate(PENDULUM, (0, 10), [1.0, 0.0], samples=200, **arguments)
    np.testing.assert_array_equal(few.y[:, -1], every.y[:, -1])
    steps = np.arange(201)
    for k in range(2):
        due = (steps > 100 * k) & (steps <= 100 * (k + 1)) & (steps % cadence == 0)
        np.testing.assert_allclose(
            few.statistics["energy"].mean[k], every.energy_change[due].mean(), rtol=1e-12
        )
        assert few.statistics["energy"].greatest[k] == pytest.approx(
            every.energy_change[due].max(), rel=1e-12
        )


def test_statistics_of_ensembles_are_those_of_each_orbit():
    many = np.array(kepler_start(0.3))[:, np.newaxis] * np.linspace(1, 1.1, 70)
    arguments = {
        "method": Splitting("kahan-li-6"),
        "step": 0.05,
        "samples": 3,
        "cadence": 2,
        "observables": MOMENTUM,
    }
    together = propagate(KEPLER, (0, 6), many, **arguments)
    assert together.statistics["L"].mean.shape == (3, 70)
    for orbit in (0, 33, 69):
        alone = propagate(KEPLER, (0, 6), many[:, orbit], **arguments)
        np.testing.assert_array_equal(together.y[:, :, orbit], alone.y)
        for name in ("energy", "L", "r2"):
            np.testing.assert_array_equal(
                together.statistics[name].mean[:, orbit], alone.statistics[name].mean
            )
            np.testing.assert_array_equal(
                together.statistics[name].least[:, orbit], alone.statistics[name].least
            )


def test_a_long_run_shows_extremes_that_samples_miss():
    motion = propagate(
        KEPLER,
        (0, 200 * np.pi),
        kepler_start(0.6),
        method=Splitting("verlet"),
        step=np.pi / 500,
        samples=100,
        cadence=1,
    )
    # Sampled once an orbit, always at the pericentre, the energy error looks far smaller than it is.
    assert abs(motion.energy_change).max() < 0.2 * abs(motion.statistics["energy"].greatest).max()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"cadence": 0}, "1 or more"),
        ({"cadence": 2.5}, "1 or more"),
        ({"cadence": 11, "samples": 10}, "shortest interval"),
        ({"cadence": 1, "method": Taylor(), "step": None}, "own steps"),
        ({"observables": {"energy": x}}, "another name"),
    ],
)
def test_what_cannot_be_followed_is_refused(arguments, message):
    right = {"method": Splitting("verlet"), "step": 0.1, "samples": 10}
    with pytest.raises(ValueError, match=message):
        propagate(KEPLER, (0, 10), kepler_start(0.1), **{**right, **arguments})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "steps", "a_period"), [("kahan-li-8", 2_000_000, 200), ("gauss", 50_000, 20)]
)
def test_round_off_of_the_energy_is_a_random_walk(method, steps, a_period):
    orbits, u = 32, 2.0**-53
    many = np.array(kepler_start(0.2))[:, np.newaxis] * (1 + 1e-3 * np.arange(orbits))
    chosen = Gauss(8) if method == "gauss" else Splitting(method)
    h = 2 * np.pi / a_period
    motion = propagate(KEPLER, (0, steps * h), many, method=chosen, step=h, samples=64, cadence=steps // 6400)
    end = motion.energy_error[-1]
    assert np.sqrt((end**2).mean()) < (0.5 if method == "gauss" else 0.2) * u * steps**0.5
    assert abs(end.mean()) < 3.5 * end.std() / orbits**0.5
    mean = motion.statistics["energy"].mean / abs(motion.energy[0])
    exponent = np.polyfit(np.log(np.arange(5, 65) - 0.5), np.log(np.sqrt((mean[4:] ** 2).mean(axis=1))), 1)[0]
    assert exponent == pytest.approx(0.5, abs=0.15)
