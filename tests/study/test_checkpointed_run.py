"""A run in parts is the run: wherever it stops, it goes on with the same bits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from canon import DOP853, RK4, Gauss, Splitting, Taylor, propagate
from canon.flow.method.method import TimeTransformed
from canon.flow.method.solvable_splitting import WisdomHolman
from canon.study.cases.case import Case, part_count
from canon.study.cases.checkpointed_run import Checkpoint, FailedRun, Outcome, advance, started
from canon.study.energy_drift.drift import Growth, drift
from canon.study.motion.hamiltonian_text import Formula

KEPLER = Case("kepler", Splitting("kahan-li-8"), span=20.0, step=0.02, start="e=0.6", samples=400, parts=7)

QUARTIC = Case(
    Formula("quartic", "p**2/2 + q**4/2", ("q",), ("p",)), Gauss(2), span=2000.0, step=0.1, start=(2.0, 0.0)
)
"""Its error turns 2.7 times in an interval between its samples, if they are even; none of its periods is known."""

CASES = [
    KEPLER,
    replace(KEPLER, precision="single"),
    replace(KEPLER, precision="double"),
    replace(KEPLER, precision="extended", method=Splitting("verlet")),
    replace(KEPLER, precision="double-double", method=Splitting("verlet")),
    replace(KEPLER, method=RK4()),
    replace(KEPLER, method=Gauss(4)),
    replace(KEPLER, method=Taylor(), step=None),
    replace(KEPLER, method=Taylor(), step=None, tolerance=1e-10),
    replace(KEPLER, method=DOP853(), step=None),
    Case("outer-solar-system", WisdomHolman(corrector=7), span=40000.0, step=100.0, samples=300, parts=5),
    replace(KEPLER, method=TimeTransformed(Splitting("verlet")), parts=None),
    Case("double-pendulum", Taylor(), span=40.0, samples=300, parts=5),
    replace(QUARTIC, samples=400, parts=5),
    replace(QUARTIC, samples=400, parts=5, method=Taylor(), step=None),
]


def in_legs(case):
    """Run part by part, each checkpoint once through text."""
    reached, seen = None, []
    while isinstance(reached := advance(case, reached, seconds=0.0), Checkpoint):
        reached = Checkpoint.from_text(reached.to_text())
        seen.append(reached.part)
    assert seen == list(range(1, part_count(case)))
    return reached


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.method}-{case.precision}")
def test_interrupted_after_every_part_it_ends_the_same(case):
    whole, broken = advance(case), in_legs(case)
    assert isinstance(whole, Outcome)
    assert broken.numbers == whole.numbers


def test_a_checkpoint_keeps_what_a_resumed_motion_cannot():
    """DOP853's next step is nowhere kept: a motion resumed has other bits, a case in parts has not."""
    case = replace(KEPLER, method=DOP853(), step=None)
    how = {"method": case.method, "times": np.linspace(0.0, 20.0, 9)}
    whole = propagate(case.hamiltonian, (0.0, 20.0), case.state, parameters=case.values, **how)
    how["times"] = how["times"][:5]
    half = propagate(case.hamiltonian, (0.0, 10.0), case.state, parameters=case.values, **how)
    assert (half.resume(20.0, samples=4).y != whole.y).any()
    assert in_legs(case).numbers == advance(case).numbers


def test_samples_in_step_with_an_oscillation_do_not_make_it_a_drift():
    """Even samples of this run see an oscillation of a fifth of the run, and a drift of 4.4 standard errors."""
    assert advance(QUARTIC).numbers["verdict"] == "bounded"
    motion = propagate(
        QUARTIC.hamiltonian,
        (0.0, QUARTIC.span),
        QUARTIC.state,
        method=Gauss(2),
        step=0.1,
        samples=QUARTIC.samples,
    )
    assert drift(motion.t, motion.energy_error).verdict is not Growth.BOUNDED


@pytest.mark.parametrize("step", [0.1, 0.05, 0.03])
def test_a_drift_is_found_in_scattered_samples_too(step):
    found = advance(replace(QUARTIC, method=RK4(), step=step)).numbers
    dense = advance(replace(QUARTIC, method=RK4(), step=step, samples=2**16)).numbers
    assert found["verdict"] == dense["verdict"] == "secular"
    assert found["slope"] == pytest.approx(dense["slope"], rel=0.02)


@pytest.mark.parametrize("precision", ["single", "double", "compensated", "extended", "double-double"])
@pytest.mark.parametrize("method", [Splitting("blanes-moan-4"), RK4()])
def test_parts_of_fixed_steps_are_the_run_in_one_piece(method, precision):
    """Second route: one call of propagate over the whole span."""
    case = replace(KEPLER, method=method, precision=precision)
    whole = propagate(
        case.hamiltonian,
        (0.0, case.span),
        case.state,
        method=method,
        step=case.step,
        precision=precision,
        parameters=case.values,
        samples=400,
    )
    found = advance(case).numbers
    assert found["final"] == whole.final.tolist()
    assert (found["steps"], found["evaluations"], found["step"]) == (1000, whole.evaluations, whole.step)
    assert found["bound"] == pytest.approx(float(np.abs(whole.energy_error).max()), rel=0.1)


def test_without_what_rounding_took_it_would_end_elsewhere():
    """The wrong twin: a checkpoint that keeps doubles only."""
    first = advance(KEPLER, seconds=0.0)
    assert any(first.carried)
    poorer = replace(first, carried=(0.0,) * len(first.carried))
    assert advance(KEPLER, poorer).numbers["final"] != advance(KEPLER, first).numbers["final"]


def test_a_jump_over_a_collision_is_a_verdict_and_no_warning():
    falling = Formula("falling", "p**2/2 - 1/q", ("q",), ("p",), starts=(("rest", (1.0, 0.0)),))
    case = Case(falling, Splitting("verlet"), span=40.0, step=0.01, samples=400, parts=4)
    assert advance(case).numbers["verdict"] == "diverged"


def test_the_error_is_that_since_the_start_of_the_run():
    case = replace(KEPLER, method=RK4(), parts=4)
    point = started(case)
    while isinstance(found := advance(case, point, seconds=0.0), Checkpoint):
        point = found
    whole = propagate(
        case.hamiltonian,
        (0.0, 15.0),
        case.state,
        method=RK4(),
        step=0.02,
        parameters=case.values,
        samples=300,
    )
    np.testing.assert_allclose(point.t, whole.t, rtol=1e-15)
    np.testing.assert_allclose(point.change, whole.energy_change, rtol=1e-12, atol=1e-15 * abs(point.energy))


def test_the_number_of_parts_follows_from_the_case():
    long = replace(KEPLER, span=1e6, parts=None)
    assert part_count(long) == 48
    assert part_count(replace(KEPLER, parts=None)) == 1
    assert part_count(replace(long, method=Taylor(), step=None, samples=4096)) == 32


def test_a_collision_is_a_failed_run_with_its_reason():
    falling = Formula("falling", "p**2/2 - 1/q", ("q",), ("p",), starts=(("rest", (1.0, 0.0)),))
    case = Case(falling, RK4(), span=40.0, step=0.001, samples=256, parts=4)
    point = advance(replace(case, span=1.0), seconds=0.0)
    assert isinstance(point, Checkpoint)
    taylor = replace(case, method=Taylor(), step=None)
    with pytest.raises(FailedRun, match="collision or the edge of H's domain"):
        advance(taylor)
    with pytest.raises(FailedRun, match="10 steps can't be run in 20 parts"):
        advance(replace(KEPLER, span=0.2, parts=20))


SHAKEN = Formula("shaken", "p**2/2 + q**2/2 - q*cos(2*t)/4", ("q",), ("p",), starts=(("out", (1.0, 0.5)),))
DRIVEN = [
    Case(SHAKEN, Splitting("kahan-li-8"), span=300.0, step=0.05, samples=1200, parts=5),
    Case(SHAKEN, RK4(), span=300.0, step=0.05, samples=1200, parts=5, precision="double"),
    Case(SHAKEN, Taylor(), span=300.0, samples=1200, parts=5),
    Case("parametric-pendulum", Gauss(2), span=200.0, step=0.02, samples=1200, parts=4),
]


@pytest.mark.parametrize("case", DRIVEN, ids=lambda case: str(case.method))
def test_a_motion_driven_in_time_goes_on_where_it_stopped_and_is_where_propagate_takes_it(case):
    stopped: Checkpoint | Outcome = started(case)
    while isinstance(stopped, Checkpoint):
        stopped = advance(case, Checkpoint.from_text(stopped.to_text()), seconds=0.0)
    whole = advance(case)
    assert isinstance(whole, Outcome)
    assert whole.numbers == stopped.numbers
    values, span = {**case.values}, (0.0, case.span)
    found = propagate(
        case.hamiltonian, span, case.state, method=case.method, step=case.step, parameters=values,
        precision=case.precision,
    )  # fmt: skip
    np.testing.assert_allclose(whole.numbers["final"], found.y[:, -1], rtol=1e-9, atol=1e-9)


def test_the_energy_less_the_work_is_judged_where_a_motion_is_driven():
    """Symplectic and Runge–Kutta: the one is bounded, the other is not; the energy itself changes by itself."""
    kept, lost = (
        advance(replace(case, span=3000.0, step=0.1, samples=2**13, parts=None)) for case in DRIVEN[:2]
    )
    assert isinstance(kept, Outcome)
    assert isinstance(lost, Outcome)
    assert kept.numbers["verdict"] in ("bounded", "round-off")
    assert kept.numbers["bound"] < 1e-9
    assert lost.numbers["verdict"] == "secular"
    assert lost.numbers["bound"] > 1e-4


def test_functions_of_the_time_are_followed():
    """For H = p²/2 + t q the momentum p + t²/2 is constant; p + t²/4 is not."""
    falling = Formula("falling", "p**2/2 + t*q", ("q",), ("p",), starts=(("rest", (0.0, 1.0)),))
    written = (("right", "p + t**2/2"), ("wrong", "p + t**2/4"))
    case = Case(falling, Gauss(2), span=10.0, step=0.01, samples=512, parts=3, observables=written)
    found = advance(case)
    assert isinstance(found, Outcome)
    assert found.numbers["observables"]["right"]["bound"] < 1e-12
    assert found.numbers["observables"]["wrong"]["bound"] > 1.0
