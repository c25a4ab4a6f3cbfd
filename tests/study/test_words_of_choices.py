"""What choices and comparisons say at their edges: nothing that follows the motion, resonance, runs that fail."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from canon import RK4, Hamiltonian, choose, coordinates, propagate, work_precision
from canon.flow.method.setting import Setting
from canon.mechanics import PoissonSystem, chain_sum, field_of_function, row_sum, written_out
from canon.scene import find
from canon.study.energy_drift.drift import Growth, drift
from canon.study.energy_drift.drift_rows import DriftRow
from canon.study.energy_drift.drift_table import drift_table
from canon.study.method_choice import candidate
from canon.study.method_choice.candidate import Candidate, candidate_methods
from canon.study.method_choice.choice_question import Question
from canon.study.method_choice.choice_table import answer, choice_table
from canon.study.method_choice.error_law import expected_error
from canon.study.method_choice.pilot_run import Pilot
from canon.study.method_choice.work_precision import work_table
from canon.study.motion.term_sizes import terms_along
from tests.study import series

x = coordinates("x")
FREE = Hamiltonian(x.momentum**2 / 2, [x], [x.momentum])
l1, l2, l3 = L = sp.symbols("l1 l2 l3", real=True)
TURNING = [[0, l3, -l2], [-l3, 0, l1], [l2, -l1, 0]]


def choice(*candidates, observable="energy"):
    return SimpleNamespace(
        title="a motion",
        observable=observable,
        accuracy=1e-6,
        span=100.0,
        unknown="",
        chosen=candidates[0],
        candidates=candidates,
    )


def found(error, *, step=0.1, keeps=False, resonant=False, cost=2.0):
    return Candidate(RK4(), step, None, "double", error, cost, 400.0, keeps, resonant)


def test_a_choice_in_words():
    lost = found(math.inf, step=None, cost=math.inf)
    assert answer(choice(lost)) == "no method can follow the motion so long"
    parting = answer(choice(found(math.inf), observable="position"))
    assert parting == "no method can promise it: neighbouring motions part too fast"
    assert answer(choice(found(1e-3))).startswith("no method keeps it; the best reaches 1.0e-03 in 2 s: RK4")
    assert answer(choice(found(1e-7, keeps=True))) == "RK4, step 0.1 in double precision, error 1.0e-07, 2 s"


def test_a_resonant_step_that_was_avoided_is_remarked():
    rows = choice_table(choice(found(1e-7, keeps=True), found(1e-7, keeps=True, resonant=True), found(1e-3)))
    remarks = [line.partition("2 s")[2].strip() for line in rows.splitlines() if line.startswith("RK4")]
    assert remarks == ["", "resonant step avoided", "does not keep it"]


def test_a_position_that_is_exact_at_first_is_taken_to_be_off_by_the_square_of_the_time():
    off = np.where(series.TIMES < series.SPAN / 3, 0.0, 1e-9)
    pilot = Pilot(Setting(RK4(), step=0.1), series.SPAN, t=series.TIMES, mean=off, largest=off, energy=0.0)
    assert expected_error(pilot, 10 * series.SPAN, "position") == pytest.approx(1e-7)
    assert expected_error(pilot, series.SPAN, "position") == pytest.approx(1e-9)


def offered(H, brackets=TURNING):
    question = Question(PoissonSystem(H, L, brackets), np.array([1.0, 0.2, 0.1]), {}, 1.0)
    return [str(method) for method in candidate_methods(question)]


def test_splittings_are_offered_where_the_parts_of_a_poisson_system_have_known_flows():
    body, bent = l1**2 / 2 + l2**2 / 4 + l3**2 / 6, sp.exp(l1 * l2 + l3)
    assert sum(name.startswith("lie-poisson") for name in offered(body)) == 4
    assert not any(name.startswith("lie-poisson") for name in offered(bent))
    for H in (body, bent):
        assert sum(name.lower().startswith("gauss") for name in offered(H)) >= 3


def test_two_copies_are_held_by_the_fastest_rate_where_there_is_one():
    oscillator = Hamiltonian(FREE.H + 8 * x**2, [x], [x.momentum])
    for system, rate in ((FREE, None), (oscillator, 4.0)):
        methods = candidate._of_two_copies(Question(system, np.array([1.0, 0.5]), {}, 1.0))
        held = [method.omega for method in methods if hasattr(method, "omega")]
        assert held == ([] if rate is None else [pytest.approx(candidate.HELD_BY * rate)] * 3)


def test_a_comparison_says_how_far_it_is_and_which_run_failed():
    seen = []
    work = work_precision(
        find("henon-heiles"), 50.0, methods=[RK4()], steps=[5.0, 0.1], repetitions=1, progress=seen.append
    )
    assert seen == [0.5, 1.0]
    lost, kept = (line for line in work_table(work).splitlines() if line.startswith("RK4"))
    assert "failed: " in lost
    assert "failed" not in kept
    assert work.rows[1].position_error < 1e-2


def test_a_walk_beyond_round_off_is_said_to_wander():
    times = np.linspace(0.0, 100.0, 512)
    still = drift(times, np.zeros(512))
    for found_, said in (
        (replace(still, verdict=Growth.WANDERING, walk=2e-9), "wandering (2e-09 in all)"),
        (replace(still, verdict=Growth.ROUND_OFF, walk=2e-15), "round-off (2e-15 in all)"),
        (still, "bounded (drift < "),
    ):
        row = DriftRow(RK4(), 0.1, times, np.zeros(512), drift=found_)
        study = SimpleNamespace(
            title="", span=100.0, period=None, time_unit="", rows=(row,), observables=("energy",)
        )
        assert said in drift_table(study)


def test_a_vector_field_is_followed_to_a_position_for_long():
    """A spring with little friction: q = exp(−t/2000) (cos w t + sin w t/(2000 w)), w² = 1 − 1/2000²."""

    def spring(_time, state):
        q, p = state
        return [p, -q - p / 1000]

    field, span, accuracy = field_of_function(spring, 2), 6000.0, 1e-2
    made = choose(field, span, [1.0, 0.0], accuracy=accuracy, observable="position", methods=[RK4()])
    assert made.reached
    motion = propagate(field, (0.0, span), [1.0, 0.0], method=RK4(), step=made.step, samples=100)
    rate = math.sqrt(1.0 - 1.0 / 2000.0**2)
    right = np.exp(-motion.t / 2000) * (np.cos(rate * motion.t) + np.sin(rate * motion.t) / (2000 * rate))
    assert np.abs(motion.y[0] - right).max() < accuracy
    assert made.predicted_error <= accuracy


def test_rounding_moves_the_energy_of_a_kept_sum_as_it_moves_what_is_written_out():
    q, p = sp.symbols("q0:90", real=True), sp.symbols("p0:90", real=True)
    kept = row_sum(lambda p: p**2 / 2, p) + chain_sum(lambda a, b: (b - a) ** 2 / 2, [0, *q, 0])
    start = np.concatenate([np.sin(np.arange(90)), np.cos(np.arange(90))])
    sizes = []
    for H in (kept, written_out(kept)):
        motion = propagate(Hamiltonian(H, q, p), (0, 5), start, method=RK4(), step=0.05, samples=50)
        sizes.append(terms_along(motion, "energy"))
    np.testing.assert_allclose(*sizes, rtol=1e-10)
    bonds = np.diff(np.concatenate([[0.0], start[:90], [0.0]]))
    by_hand = np.abs(start[90:] ** 2).sum() + np.abs(start[:90] * (bonds[:-1] - bonds[1:])).sum()
    assert sizes[0][0] == pytest.approx(by_hand)
