"""Slow times: what happens long after the pilots have ended is seen, or it is said that it is not known."""

from __future__ import annotations

import re
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
import sympy as sp

from canon import RK4, Gauss, Splitting, Taylor, choose, drift
from canon.flow.run.observables_along import AccuracyWarning
from canon.study.errors import StudyError
from canon.study.method_choice import choose as choosing
from canon.study.method_choice import confirm, slow_times
from canon.study.method_choice.choice_question import Question
from canon.study.method_choice.pilot_run import natural_step, pilot
from canon.study.method_choice.slow_times import Outlook, with_outlook
from tests.study.slow_systems import SYSTEMS, SlowSystem, moving_in
from tests.study.unseen_slow_systems import UNSEEN_SYSTEMS

if TYPE_CHECKING:
    from canon.flow.method.method import Method

FEW = (Splitting("kahan-li-8"), Splitting("blanes-moan-6"), Taylor())
NOT_SPLIT = (Gauss(4), Gauss(6), Taylor())
NOT_SEPARABLE = (
    "foucault",
    "magnetic drift",
    "double pendulum",
    "bar that turns",
    "anisotropic trap that turns",
    "spherical pendulum, pulled",
    "swinging atwood",
)
EVERY = SYSTEMS | UNSEEN_SYSTEMS

QUICK: dict[str, tuple[Method, ...]] = {
    "kozai 86": (Taylor(),),
    "1:2": (Splitting("kahan-li-8"),),
    "elastic pendulum": (Splitting("kahan-li-8"),),
    "slow gravity": (Splitting("blanes-moan-6"),),
    "foucault": (Gauss(4),),
    "gravity that changes": (Splitting("kahan-li-8"), Taylor()),
}


def chosen_for(name: str, **options):
    of = EVERY[name]
    methods = NOT_SPLIT if name in NOT_SEPARABLE else FEW
    return choose(
        of.hamiltonian, of.span, np.array(of.y0), accuracy=of.accuracy, **{"methods": methods, **options}
    )


def is_kept_or_not_known(name: str, **options) -> None:
    choice = chosen_for(name, **options)
    assert choice.chosen.keeps or not choice.reached
    if choice.reached:
        assert pilot(choice.question, choice.chosen.setting, choice.span).bound <= choice.accuracy
    else:
        assert str(choice).splitlines()[1].partition(": ")[2].startswith(("not known", "no method"))


@pytest.mark.parametrize("name", QUICK)
def test_the_accuracy_is_kept_over_slow_times(name):
    choice = chosen_for(name, methods=QUICK[name])
    assert choice.reached, choice
    whole = pilot(choice.question, choice.chosen.setting, choice.span)
    assert whole.bound <= choice.accuracy
    assert choice.predicted_error / 2.0 < whole.bound < 2.0 * choice.predicted_error


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in EVERY if name not in QUICK])
def test_the_accuracy_is_kept_or_not_known(name):
    is_kept_or_not_known(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", EVERY)
def test_so_it_is_where_nothing_is_looked_at_for_long(name, monkeypatch):
    """What a run too long to be looked at whole leaves: a glimpse ahead of four pilots."""
    monkeypatch.setattr(slow_times, "AHEAD", 0)
    monkeypatch.setattr(confirm, "WHOLE_SECONDS", 0.0)
    monkeypatch.setattr(confirm, "CONFIRMING", 2.0)
    is_kept_or_not_known(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["kozai 86", "elastic pendulum", "weight that is lost"])
def test_all_methods_are_candidates_over_slow_times(name):
    is_kept_or_not_known(name, methods=None)


def blinded(monkeypatch) -> None:
    """Neither is the motion followed ahead nor the whole run looked at."""
    monkeypatch.setattr(choosing, "with_outlook", lambda question, *_: (question, Outlook(question.span)))
    monkeypatch.setattr(confirm, "WHOLE_SECONDS", 0.0)
    monkeypatch.setattr(confirm, "CONFIRMING", 1.0)


def test_pilots_alone_see_nothing_of_kozais_motion_and_the_run_says_so(monkeypatch):
    """The wrong twin: without the look ahead a step is promised with which the motion fails."""
    blinded(monkeypatch)
    choice = chosen_for("kozai 86", methods=[Splitting("kahan-li-8")])
    assert choice.reached
    # In compensated doubles, which timings may choose, the motion comes to a collision and a second warning says so.
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", AccuracyWarning)
        motion = choice.run()
    said = r"energy to 1e-10 was asked .* but the motion shows .* smaller step"
    assert any(re.search(said, str(each.message)) for each in told)
    assert np.abs(motion.energy_error).max() > 1e3 * choice.accuracy


def test_what_is_kept_is_run_in_silence():
    choice = chosen_for("1:2", methods=[Taylor()])
    with warnings.catch_warnings():
        warnings.simplefilter("error", AccuracyWarning)
        motion = choice.run()
    assert np.abs(motion.energy_error).max() <= choice.accuracy


def test_what_is_still_changing_where_the_look_ahead_ends_is_not_known(monkeypatch):
    monkeypatch.setattr(slow_times, "AHEAD", 0)
    monkeypatch.setattr(confirm, "WHOLE_SECONDS", 0.0)
    monkeypatch.setattr(confirm, "CONFIRMING", 1.0)
    choice = chosen_for("slow gravity", methods=[Taylor()])
    assert choice.chosen.keeps
    assert not choice.reached
    assert "still changes at t = " in choice.unknown
    assert "not known: " in str(choice)
    assert choice.run(samples=300).t[-1] == choice.span


def outlook_of(of: SlowSystem) -> Outlook:
    question = Question(of.hamiltonian, np.array(of.y0), {}, of.span)
    natural = natural_step(question)
    return with_outlook(question, min(of.span, 4000.0 * natural), natural)[1]


def test_pilots_run_where_the_motion_is_fastest():
    """Kozai's: where the eccentricity is largest, though it is smallest at the start."""
    of = SYSTEMS["kozai 86"]
    found = outlook_of(of)
    (since, state), *_ = found.elsewhere
    q, p = state[:3], state[3:]
    r = np.linalg.norm(q)
    e = np.linalg.norm(np.cross(p, np.cross(q, p)) - q / r)
    assert since > 0.05 * of.span
    assert e > 0.9
    assert found.seen == of.span
    assert found.unsettled == ""


def test_a_motion_that_does_the_same_for_ever_has_no_slow_times():
    found = outlook_of(replace(SYSTEMS["relativistic"], span=1e6))
    assert found.seen < 1e6
    assert found.elsewhere == ()
    assert found.unsettled == ""


def test_what_is_far_longer_than_what_was_followed_is_not_known():
    """What moves in a plane can change slowly; one degree of freedom repeats itself."""
    found = outlook_of(replace(SYSTEMS["relativistic"], span=3e7))
    assert found.unsettled.startswith("it was followed ahead to t = ")
    assert found.unsettled.endswith("of the span: a slower change was not seen")
    pendulum = moving_in(lambda x: -sp.cos(x), (1.0, 0.0), 1e8)
    assert outlook_of(pendulum).unsettled == ""


def test_energy_less_the_work_of_a_drive_is_kept():
    """K = H − ∫ ∂H/∂t dt: what is stated is what came, and RK4 is told from symplectic methods by it."""
    choice = chosen_for("weight that is lost", methods=[Splitting("kahan-li-8"), RK4()])
    assert choice.reached
    motion = choice.run()
    assert np.abs(motion.energy_error).max() <= choice.accuracy
    assert drift(motion).cause != ""
    x, clock, p, minus_work = motion.y
    assert clock == pytest.approx(motion.t, abs=1e-6)
    energy = p**2 / 2 + (1 + motion.t / 2000) * x**2 / 2
    assert energy + minus_work == pytest.approx(np.full(len(energy), energy[0]), rel=1e-7)
    assert energy[-1] > 2.0 * energy[0]


def test_a_choice_that_nothing_keeps_still_refuses_to_run():
    choice = chosen_for("1:2", methods=[Taylor()])
    worse = replace(choice, chosen=replace(choice.chosen, keeps=False))
    with pytest.raises(StudyError, match="nothing keeps"):
        worse.run()
