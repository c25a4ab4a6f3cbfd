"""Random Hamiltonians: the true error is within the stated one, or the refusal is clear; heyoka alone is the judge.

Adaptive methods have no reason to refuse motions that go on; methods of fixed steps may where the steps are too large.
"""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, seed, settings
from hypothesis import strategies as st

from canon import AccuracyWarning, propagate
from canon.flow import NonFiniteStateError
from tests.flow.random_motions import RandomMotion, random_motions, reference

ADAPTIVE: dict[str, dict[str, Any]] = {
    "taylor": {},
    "tolerance": {"tolerance": 1e-9},
    "extended": {"precision": "extended"},
    "quad": {"precision": "quad"},
    "dop853": {"method": "DOP853"},
}
STEPPED: dict[str, dict[str, Any]] = {
    "gauss-6": {"method": "gauss-6", "step": 1 / 32},
    "gauss-4": {"method": "gauss-4", "step": 1 / 8},
    "rk4": {"method": "RK4", "step": 1 / 32},
    "verlet": {"method": "verlet", "step": 1 / 32},
    "kahan-li-8": {"method": "kahan-li-8", "step": 1 / 16},
    "blanes-moan-6": {"method": "blanes-moan-6", "step": 1 / 16, "precision": "double-double"},
}
METHODS = ADAPTIVE | STEPPED
FOR_SEPARABLE = ("verlet", "kahan-li-8", "blanes-moan-6")
WIDER = {"extended": "quad", "quad": "more", "blanes-moan-6": "quad", "tolerance": "quad"}


def usual(examples: int) -> settings:
    checks = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much]
    return settings(
        max_examples=examples, deadline=None, database=None, derandomize=True, suppress_health_check=checks
    )


def is_kept_or_refused(case: RandomMotion, name: str) -> None:
    how = dict(METHODS[name])
    if "step" in how:
        how["step"] *= case.scale
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", AccuracyWarning)
            motion = propagate(case.hamiltonian(), case.span, case.y0, samples=8, **how)
    except NonFiniteStateError:
        assert name in STEPPED or not stays(case), "a motion that goes on was refused"
        return
    estimate = motion.error_estimate()
    assert np.isfinite(motion.y).all()
    assert not np.isnan(estimate.error).any()
    if name in ADAPTIVE:
        assert np.isfinite(estimate.error).all() or not stays(case), str(estimate)
    usual_width = (
        "quad" if case.moments else "extended"
    )  # 64 bits of the time say little within a narrow pulse
    true = reference(case, motion.t, WIDER.get(name, usual_width))
    missed = abs(np.frompyfunc(lambda y, x: float(type(x)(float(y)) - x), 2, 1)(motion.y, true))
    known = np.isfinite(missed.astype(float))
    assert known[:, 0].all()
    assert (~known | (missed <= estimate.error)).all(), str(estimate)


def stays(case: RandomMotion) -> bool:
    """Return whether heyoka alone comes to the end of the span."""
    return bool(np.isfinite(reference(case, np.array(case.span)).astype(float)).all())


@usual(5)  # a second each: a motion, and the same in wider numbers
@given(random_motions(), st.sampled_from([name for name in METHODS if name not in ("quad", "extended")]))
def test_what_is_stated_is_kept(case: RandomMotion, name: str) -> None:
    assume(case.separable or name not in FOR_SEPARABLE)
    is_kept_or_refused(case, name)


FEW_STEPS = 5_000
"""Steps in doubles of a motion that is tried in quad."""

PIECES = [
    (name, part, 3 if name == "quad" else 13)
    for name in METHODS
    for part in range(5 if name == "quad" else 4)
]
"""Fifty motions of every method, in pieces of a minute each; fifteen in quad, that takes longest."""


@pytest.mark.slow
@pytest.mark.parametrize(("name", "part", "examples"), PIECES)
def test_what_is_stated_is_kept_fifty_times(name: str, part: int, examples: int) -> None:
    @seed(part)
    @settings(usual(examples), derandomize=False)
    @given(random_motions())
    def each(case: RandomMotion) -> None:
        assume(case.separable or name not in FOR_SEPARABLE)
        assume(name != "quad" or is_short(case))
        is_kept_or_refused(case, name)

    each()


def is_short(case: RandomMotion) -> bool:
    """Tell whether a motion has no millions of steps, as far out where all terms oscillate: hours in quad."""
    try:
        return propagate(case.hamiltonian(), case.span, case.y0, samples=1).steps < FEW_STEPS
    except NonFiniteStateError:
        return True


def test_the_reference_is_the_motion() -> None:
    """By a motion in closed form: a pulse kicks a free particle by its area; without care heyoka passes over it."""
    since = ("mul", ("number", 1024), ("add", ("time",), ("number", -5)))
    pulse = ("exp", ("mul", ("number", -1), ("power", since, 2)))
    free = ("mul", ("number", 0.5), ("power", ("p", 0), 2))
    kicked = RandomMotion(
        tree=("add", free, ("mul", ("number", -1), ("q", 0), pulse)),
        n=1,
        units=(1.0,),
        y0=(0.0, 1.0),
        span=(0.0, 10.0),
        scale=1.0,
        moments=((5.0, 2.0**-10),),
        separable=True,
    )
    kick, ends = np.sqrt(np.pi) / 1024, np.array([0.0, 10.0])
    found = reference(kicked, ends).astype(float)
    np.testing.assert_allclose(found[:, 1], [10 + 5 * kick, 1 + kick], rtol=1e-15)
    blind = reference(replace(kicked, scale=160.0, moments=()), ends).astype(float)
    assert abs(blind[1, 1] - 1 - kick) > 1e-4
