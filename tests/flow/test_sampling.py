"""States at times the user names."""

from dataclasses import astuple

import numpy as np
import pytest

from canon.flow.fixed_step.advance import advance_orbits
from canon.flow.fixed_step.loop_buffers import LoopBuffers
from canon.flow.method.method import DOP853, Gauss, Splitting, Taylor
from canon.flow.propagation import propagate
from tests.flow.systems import HENON_HEILES, HENON_HEILES_START

SPAN = (0, 20)
TIMES = np.array([0.3, 0.7, 1.9, 6.0, 17.24])


@pytest.mark.parametrize("method", [Splitting("kahan-li-8"), Gauss(4)], ids=str)
@pytest.mark.parametrize("direction", [1, -1])
def test_fixed_steps_keep_the_state_after_the_nearest_step(method, direction):
    span = SPAN[::direction]
    times = TIMES[::direction]
    motion = propagate(HENON_HEILES, span, HENON_HEILES_START, method=method, step=0.05, times=times)
    every = propagate(HENON_HEILES, span, HENON_HEILES_START, method=method, step=0.05, samples=400)
    nearest = [0, *(round(abs(t - span[0]) / 0.05) for t in times), 400]
    np.testing.assert_array_equal(motion.t, every.t[nearest])
    np.testing.assert_array_equal(motion.y, every.y[:, nearest])
    assert abs(motion.t[1:-1] - times).max() <= 0.025 + 1e-12


def test_times_nearest_to_one_step_are_kept_once():
    motion = propagate(
        HENON_HEILES,
        (0, 1),
        HENON_HEILES_START,
        method=Splitting("verlet"),
        step=0.1,
        times=[0, 0.49, 0.51, 1],
    )
    np.testing.assert_allclose(motion.t, [0, 0.5, 1])


@pytest.mark.parametrize("method", [Taylor(), DOP853()], ids=str)
def test_adaptive_methods_are_evaluated_at_the_very_times(method):
    motion = propagate(HENON_HEILES, SPAN, HENON_HEILES_START, method=method, times=TIMES)
    np.testing.assert_array_equal(motion.t, [0, *TIMES, 20])
    for k, t in enumerate(TIMES):
        there = propagate(HENON_HEILES, (0, t), HENON_HEILES_START, samples=1).final
        np.testing.assert_allclose(motion.y[:, k + 1], there, atol=1e-12 if method == Taylor() else 1e-9)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"times": [1, 1, 2]}, "sort them"),
        ({"times": [3, 2]}, "sort them"),
        ({"times": [1, 21]}, "outside t_span"),
        ({"times": [-1, 2]}, "outside t_span"),
        ({"times": [1, np.nan]}, "finite"),
        ({"times": []}, "finite"),
        ({"times": [[1, 2]]}, "list"),
        ({"times": [1], "samples": 3}, "one of them"),
        ({"samples": 2.5}, "at least one state"),
    ],
)
def test_times_that_make_no_sense_are_refused(wrong, message):
    with pytest.raises(ValueError, match=message):
        propagate(HENON_HEILES, SPAN, HENON_HEILES_START, method=Splitting("verlet"), step=0.1, **wrong)


@pytest.mark.parametrize("precision", ["double", "compensated", "extended", "double-double", "single"])
@pytest.mark.parametrize(("orbits", "cadence"), [(1, None), (7, None), (1, 1), (7, 1)])
def test_states_kept_in_compiled_code_are_those_kept_one_by_one(precision, orbits, cadence, monkeypatch):
    in_compiled_code, sample = [], LoopBuffers.sample
    monkeypatch.setattr(LoopBuffers, "sample", lambda *a: in_compiled_code.append(a) or sample(*a))
    start = np.array(HENON_HEILES_START)
    if orbits > 1:
        start = start[:, np.newaxis] * np.linspace(0.9, 1.0, orbits)
    for method in (
        (Splitting("kahan-li-8"), Gauss(4)) if precision == "compensated" else (Splitting("verlet"),)
    ):
        found = []
        for many in (2, 10**9):
            monkeypatch.setattr(advance_orbits, "__defaults__", (*advance_orbits.__defaults__[:-1], many))
            for kept in ({"samples": 3000}, {"times": np.sort(np.random.default_rng(1).uniform(0, 30, 500))}):
                motion = propagate(
                    HENON_HEILES,
                    (0, 30),
                    start,
                    method=method,
                    step=0.01,
                    precision=precision,
                    cadence=cadence,
                    **kept,
                )
                watched = [s for found_of in motion.statistics.values() for s in astuple(found_of)]
                assert len(watched) == (0 if cadence is None else 3)
                found.append((motion.t, motion.y, motion.final, *watched))
            assert bool(in_compiled_code) == (many == 2)
            in_compiled_code.clear()
        for compiled, one_by_one in zip(found[:2], found[2:], strict=True):
            for a, b in zip(compiled, one_by_one, strict=True):
                np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("watched", [{}, {"cadence": 1}])
def test_an_interruption_between_slices_keeps_what_lies_before(watched):
    calls = []

    def interrupted(fraction):
        calls.append(fraction)
        if len(calls) == 4:
            raise KeyboardInterrupt

    whole = propagate(
        HENON_HEILES,
        (0, 50),
        HENON_HEILES_START,
        method=Splitting("verlet"),
        step=0.01,
        samples=5000,
        **watched,
    )
    with pytest.raises(KeyboardInterrupt) as caught:
        propagate(
            HENON_HEILES, (0, 50), HENON_HEILES_START, method=Splitting("verlet"), step=0.01, samples=5000,
            progress=interrupted, **watched,
        )  # fmt: skip
    part = caught.value.motion
    assert 64 < len(part.t) < 5001
    np.testing.assert_array_equal(part.y, whole.y[:, : len(part.t)])
    for name, all_of_it in whole.statistics.items():
        np.testing.assert_array_equal(part.statistics[name].mean, all_of_it.mean[: len(part.t) - 1])
