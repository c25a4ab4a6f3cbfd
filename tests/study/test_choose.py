"""Choices are kept when they are run; laws of growth on series of known growth; what can't be is said."""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

from canon import DOP853, RK4, Gauss, Hamiltonian, Splitting, Taylor, choose, coordinates, propagate
from canon.flow.method.method import TimeTransformed
from canon.flow.method.number_formats import unit_round_off
from canon.flow.method.setting import Setting
from canon.flow.method.solvable_splitting import WisdomHolman
from canon.flow.run.non_finite_state import NonFiniteStateError
from canon.scene import find
from canon.study.errors import StudyError
from canon.study.method_choice import candidate
from canon.study.method_choice.candidate import HOPELESS, by_order, candidate_methods, tried_with
from canon.study.method_choice.choice_question import Question
from canon.study.method_choice.error_law import expected_error
from canon.study.method_choice.pilot_run import Pilot, natural_step, pilot, seconds_per_time
from canon.study.method_choice.resolution import least_error
from canon.study.method_choice.tolerance_search import tolerance_at
from tests.flow.test_tangent_maps import chain
from tests.study import series

FEW = (Splitting("verlet"), Splitting("kahan-li-8"), Taylor())
VERLET = Setting(Splitting("verlet"), step=0.1)
X = coordinates("x")
PENDULUM = Hamiltonian(X.momentum**2 / 2 - sp.cos(X), [X], [X.momentum])
RUNGE_KUTTA = Setting(RK4(), step=0.1)


def made(setting, error):
    return Pilot(setting, series.SPAN, t=series.TIMES, mean=error, largest=np.abs(error), energy=1e-6)


def test_what_oscillates_stays_within_its_bound():
    error = 1e-6 * series.oscillation(np.random.default_rng(1))
    bound = np.abs(error).max()
    assert expected_error(made(VERLET, error), 1e3 * series.SPAN, "energy") == pytest.approx(bound, rel=0.3)


def test_what_drifts_grows_with_the_span():
    error = 1e-8 * series.oscillation(np.random.default_rng(2)) - 1e-6 * series.SHARE
    for setting in (VERLET, RUNGE_KUTTA):
        found = expected_error(made(setting, error), 1e3 * series.SPAN, "energy")
        assert found == pytest.approx(1e-3, rel=0.05)


def test_a_walk_grows_with_the_root_of_the_span():
    """Twice its root-mean-square end, which 95 % of walks stay below."""
    found = [
        expected_error(made(VERLET, 1e-13 * series.walk(random)), 1e4 * series.SPAN, "energy")
        for random in map(np.random.default_rng, range(20))
    ]
    assert np.median(found) == pytest.approx(2e-11, rel=0.25)


@pytest.mark.parametrize(
    ("setting", "power"), [(VERLET, 1.0), (RUNGE_KUTTA, 2.0), (Setting(Taylor(), tolerance=1e-9), 2.0)]
)
def test_positions_go_wrong_by_their_law(setting, power):
    error = 1e-9 * series.SHARE**power
    found = expected_error(made(setting, error), 100.0 * series.SPAN, "position")
    assert found == pytest.approx(1e-9 * 100.0**power, rel=0.2)


def test_positions_that_part_exponentially_can_not_be_promised():
    error = 1e-12 * np.exp(15.0 * series.SHARE)
    assert expected_error(made(VERLET, error), 10.0 * series.SPAN, "position") == math.inf


CASES = [
    ("henon-heiles", None, 3000.0, 1e-7, "energy", None),
    ("kepler", "e=0.6", 500.0, 1e-5, "Runge–Lenz vector, x", [Splitting("kahan-li-8"), Splitting("srkn-6b")]),
    ("spring-pendulum", None, 500.0, 1e-9, "energy", [Gauss(4), Gauss(6), Taylor()]),
    ("harmonic-oscillator", None, 2000.0, 1e-5, "position", [Splitting("blanes-moan-4"), RK4()]),
]


@pytest.mark.parametrize(("name", "start", "periods", "accuracy", "observable", "methods"), CASES)
def test_a_choice_is_kept_when_it_is_run(name, start, periods, accuracy, observable, methods):
    scene = find(name)
    choice = choose(
        scene, periods * scene.period, start, accuracy=accuracy, observable=observable, methods=methods
    )
    assert choice.reached
    whole = pilot(choice.question, choice.chosen.setting, choice.span)
    assert whole.bound <= accuracy
    assert choice.predicted_error / 5.0 < whole.bound
    assert choice.chosen.evaluations == pytest.approx(whole.evaluations, rel=0.05)
    if choice.step is not None:
        coarse = choice.chosen.setting.turned(2.5 * choice.step)
        assert pilot(choice.question, coarse, choice.span).bound > accuracy


def test_the_choice_is_the_cheapest_candidate_that_keeps_the_accuracy():
    scene = find("toda")
    choice = choose(scene, 1e3 * scene.period, accuracy=1e-6)
    able = [each for each in choice.candidates if each.keeps]
    assert choice.predicted_cost == min(each.predicted_cost for each in able)
    assert len({str(each.method) for each in choice.candidates}) > 10


DISTURBED = ("wisdom-holman", "wisdom-holman, corrector 7", "saba-4", "aba-8-6-4", "aba-10-6-4")


@pytest.mark.parametrize(
    ("name", "disturbed"),
    [
        ("outer-solar-system", True),
        ("henon-heiles", True),
        ("kepler", False),
        ("simple-pendulum", False),
        ("fput", False),
    ],
)
def test_splittings_by_solvable_parts_are_candidates_where_something_disturbs_them(name, disturbed):
    """Kepler's motion is known and nothing disturbs it; of a pendulum only T(p) is quadratic; 62² is too many."""
    scene = find(name)
    names = {
        str(method)
        for method in candidate_methods(Question(scene.hamiltonian, scene.state(), scene.values, 1.0))
    }
    assert names & set(DISTURBED) == (set(DISTURBED) if disturbed else set())


def test_matrices_that_cost_no_more_than_the_force_are_candidates() -> None:
    """The drift of n oscillators takes n² products, the force of a chain as many as there are bonds."""
    for masses, offered in ((8, set(DISTURBED)), (40, set())):
        H = chain(masses + 1)
        question = Question(H, np.full(2 * masses, 0.1), {}, 1.0)
        assert {str(method) for method in candidate_methods(question)} & set(DISTURBED) == offered


def test_planets_are_cheaper_by_their_keplerian_motions():
    scene = find("outer-solar-system")
    methods = [Splitting("srkn-6b"), "wisdom-holman", "saba-4"]
    choice = choose(scene, 300.0 * scene.period, accuracy=1e-6, methods=methods)
    assert str(choice.method) in DISTURBED
    assert pilot(choice.question, choice.chosen.setting, choice.span).bound <= 1e-6


IN_FICTITIOUS_TIME = {f"{name}, time-transformed" for name in ("verlet", "blanes-moan-6", "kahan-li-8")}


@pytest.mark.parametrize(
    ("name", "singular"),
    [
        ("kepler", True),
        ("figure-eight", True),
        ("henon-heiles", False),
        ("simple-pendulum", False),
        ("toda", False),
    ],
)
def test_steps_that_vary_are_considered_where_the_potential_has_a_singularity(name, singular):
    scene = find(name)
    names = {
        str(method)
        for method in candidate_methods(Question(scene.hamiltonian, scene.state(), scene.values, 1.0))
    }
    assert names & IN_FICTITIOUS_TIME == (IN_FICTITIOUS_TIME if singular else set())


def test_close_encounters_are_followed_by_steps_that_vary():
    scene = find("kepler")
    steady = [Splitting("srkn-6b")]
    varying = [TimeTransformed(method) for method in (Splitting("verlet"), Splitting("kahan-li-8"))]
    choice = choose(scene, 200.0, "e=0.9", accuracy=1e-7, methods=[*steady, *varying])
    assert isinstance(choice.method, TimeTransformed)
    whole = pilot(choice.question, choice.chosen.setting, choice.span)
    assert whole.bound <= 1e-7
    # By either method in a fictitious time, whichever was cheaper where this ran: of order 2, or 8 with 17 stages.
    assert whole.steps > 30 * 200
    assert whole.evaluations > 60 * 200
    steps = {str(each.method): each.evaluations for each in choice.candidates}
    assert steps[str(choice.method)] < 0.2 * min(steps[str(method)] for method in steady)


def test_positions_are_compared_at_the_same_instants_whatever_the_steps():
    scene = find("kepler")
    choice = choose(
        scene,
        50.0,
        "e=0.9",
        accuracy=1e-5,
        observable="position",
        methods=[TimeTransformed(Splitting("kahan-li-8"))],
    )
    assert choice.reached
    motion = choice.run(samples=50)
    exact = choose(scene, 50.0, "e=0.9", accuracy=1e-9, observable="position", methods=[Taylor()]).run(
        samples=50
    )
    size = np.linalg.norm(exact.q, axis=0).max()
    assert np.linalg.norm(motion.q[:, -1] - exact.q[:, -1]) <= 1e-5 * size


def test_the_peaks_of_an_error_at_close_passes_are_seen():
    """Between 64 places an error of 1.4e-6 was taken for one of 0.99e-6, and 1e-6 called kept."""
    x, y = coordinates("x y")
    kepler = Hamiltonian(
        (x.momentum**2 + y.momentum**2) / 2 - 1 / sp.sqrt(x**2 + y**2), [x, y], [x.momentum, y.momentum]
    )
    start = [0.5, 0, 0, math.sqrt(3)]
    choice = choose(kepler, 100.0, start, accuracy=1e-6, observable="position", methods=["kahan-li-8"])
    motion = choice.run(samples=2000)
    true = propagate(kepler, (0, 100.0), start, times=motion.t[1:-1])
    away = np.linalg.norm(motion.q - true.q, axis=0).max() / np.linalg.norm(true.q, axis=0).max()
    assert choice.reached
    assert away < 1.1 * choice.predicted_error < 1.1e-6


def test_correctors_are_judged_with_the_corrector():
    """The error with it is far below that of the same steps without."""
    scene = find("outer-solar-system")
    question = Question(scene.hamiltonian, scene.state(), scene.values, 100.0 * scene.period)
    plain, corrected = (
        pilot(question, Setting(WisdomHolman(corrector=order), step=200.0), 100.0 * scene.period).bound
        for order in (0, 7)
    )
    assert corrected < 0.1 * plain


def test_steps_follow_the_order_of_the_method():
    """Bounded errors ∝ h²: an accuracy a hundred times finer takes a tenth of the step."""
    scene = find("henon-heiles")
    steps = [
        choose(scene, 2e3 * scene.period, accuracy=accuracy, methods=[Splitting("verlet")]).step
        for accuracy in (1e-3, 1e-5)
    ]
    assert steps[0] / steps[1] == pytest.approx(10.0, rel=0.15)


def test_steps_of_runge_kutta_follow_the_span():
    """Its energy is lost in proportion to h⁵ t: 32 times the span takes half the step."""
    scene = find("henon-heiles")
    steps = [
        choose(scene, periods * scene.period, accuracy=1e-5, methods=[RK4()]).step
        for periods in (500.0, 16000.0)
    ]
    assert steps[0] / steps[1] == pytest.approx(2.0, rel=0.15)


def test_what_no_method_keeps_is_said():
    scene = find("henon-heiles")
    choice = choose(
        scene,
        3e3 * scene.period,
        "chaotic",
        accuracy=1e-6,
        observable="position",
        methods=[Splitting("kahan-li-8"), Taylor()],
    )
    assert not choice.reached
    assert "no method can promise" in str(choice)
    with pytest.raises(StudyError, match="nothing keeps 1e-06"):
        choice.run()


def test_the_best_that_can_be_reached_is_told():
    scene = find("kepler")
    choice = choose(scene, 300.0 * scene.period, accuracy=1e-6, methods=[RK4()])
    finest = choose(scene, 300.0 * scene.period, accuracy=1e-17, methods=[RK4()])
    assert choice.reached
    assert not finest.reached
    assert "no method keeps it; the best reaches" in str(finest)


def test_more_digits_are_taken_where_doubles_do_not_suffice():
    scene = find("henon-heiles")
    choice = choose(scene, 50.0 * scene.period, accuracy=1e-17, methods=[Splitting("kahan-li-8"), Taylor()])
    assert choice.reached
    assert choice.precision in ("extended", "quad", "double-double")


@pytest.mark.parametrize(
    ("accuracy", "precisions"), [(1e-18, ["extended", "double-double"]), (1e-30, ["quad"])]
)
def test_what_comes_is_no_more_than_was_asked_where_doubles_resolve_less(accuracy, precisions):
    """Their errors of 4e-19 in a pilot run are luck: with another last digit of the step 1e-17 came."""
    choice = choose(PENDULUM, 20.0, [0.5, 0.0], accuracy=accuracy, methods=["RK4", "forest-ruth", *FEW])
    assert choice.reached
    assert choice.precision in precisions
    motion = choice.run(samples=100)
    assert np.abs(motion.energy_error).max() <= accuracy
    doubles = [each for each in choice.candidates if each.precision in ("double", "compensated")]
    assert len(doubles) == 2 + len(FEW)
    assert not any(each.keeps for each in doubles)
    assert min(each.predicted_error for each in doubles) >= 2.0**-54


def test_an_accuracy_that_no_numbers_resolve_is_said_to_be_out_of_reach():
    choice = choose(PENDULUM, 20.0, [0.5, 0.0], accuracy=1e-40)
    assert not choice.reached
    assert 1e-35 < choice.predicted_error < 1e-32
    assert "quad numbers resolve no error below 4.8e-35" in str(choice)


@pytest.mark.parametrize("precision", ["single", "compensated", "double", "quad"])
def test_errors_are_promised_down_to_half_a_unit_of_rounding(precision):
    assert least_error(precision) == unit_round_off(precision) / 2.0


def test_the_step_that_the_order_promises_is_no_better_than_its_numbers():
    question = Question(PENDULUM, np.array([0.5, 0.0]), {}, 20.0)
    setting = Setting(Splitting("verlet"), step=1e-2, precision="compensated")
    found = by_order(question, tried_with(question, setting, 20.0), 6e-17)
    assert found.keeps
    assert found.predicted_error == least_error("compensated")


def test_a_choice_runs():
    scene = find("simple-pendulum")
    choice = choose(scene, 300.0 * scene.period, "small", accuracy=1e-6, methods=FEW)
    motion = choice.run(samples=500)
    assert motion.t[-1] == pytest.approx(300.0 * scene.period)
    assert np.abs(motion.energy_error).max() <= 1e-6
    assert str(choice).splitlines()[1].startswith("energy to 1e-06 over t = ")


def test_a_hamiltonian_of_ones_own_with_an_integral():
    x, y = coordinates("x y")
    H = (x.momentum**2 + y.momentum**2 + x**2 + y**2) / 2 + (x**2 + y**2) ** 2 / 8
    motion = Hamiltonian(H, [x, y], [x.momentum, y.momentum])
    spin = x * y.momentum - y * x.momentum
    choice = choose(
        motion, 2000.0, [1.0, 0.0, 0.0, 0.5], accuracy=1e-9, observable="spin", integral=spin, methods=FEW
    )
    assert choice.reached
    assert pilot(choice.question, choice.chosen.setting, 2000.0).bound <= 1e-9


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"span": 0.0}, "positive, finite duration"),
        ({"accuracy": 0.0}, "between 0 and 0.1"),
        ({"accuracy": math.nan}, "between 0 and 0.1"),
        ({"observable": "spin"}, "has no constant 'spin'"),
        ({"methods": []}, "name at least one"),
    ],
)
def test_requests_that_make_no_sense(options, told):
    request = {"span": 100.0, "accuracy": 1e-6, **options}
    with pytest.raises(StudyError, match=told):
        choose(find("kepler"), **request)


def test_a_driven_motion_is_chosen_for_by_its_position():
    from canon import time

    x = coordinates("x")
    H = x.momentum**2 / 2 + x**2 / 2 - x * sp.cos(time / 3) / 4
    driven = Hamiltonian(H, [x], [x.momentum])
    choice = choose(
        driven,
        300.0,
        [1.0, 0.0],
        accuracy=1e-6,
        observable="position",
        methods=[Splitting("srkn-6b"), Taylor()],
    )
    motion = choice.run(samples=200)
    # x″ + x = cos(t/3)/4 has the solution (9/32) cos(t/3) + (23/32) cos t.
    exact = 9.0 / 32.0 * np.cos(motion.t / 3.0) + 23.0 / 32.0 * np.cos(motion.t)
    assert np.abs(motion.q[0] - exact).max() <= 1e-6


def test_a_motion_that_can_not_be_followed():
    x = coordinates("x")
    falling = Hamiltonian(x.momentum**2 / 2 - 1 / x, [x], [x.momentum])
    with pytest.raises(StudyError, match="the motion can't be followed"):
        choose(falling, 10.0, [1.0, 0.0], accuracy=1e-6)


@pytest.mark.parametrize("rung", range(3, 19))
def test_rungs_of_tolerance_are_orders(rung):
    assert Taylor(tolerance_at(rung)).order == rung + 1


def test_what_is_taken_step_by_step_in_python_is_tried_where_it_may_be_the_cheapest():
    kepler = find("kepler")
    span = 200 * kepler.time_scale(kepler.values)
    alone = choose(kepler, span, accuracy=1e-6, methods=[DOP853()])
    assert alone.reached
    assert alone.chosen.tolerance is not None
    beside = choose(kepler, span, accuracy=1e-6, methods=[Taylor(), DOP853()])
    (left_out,) = [each for each in beside.candidates if each.method.family == "dop853"]
    assert left_out.note == "dearer at any tolerance"
    # It was right to: what it costs where it is tried.
    assert alone.predicted_cost > HOPELESS * beside.predicted_cost


@dataclass(frozen=True)
class _Timed:
    """A question whose runs take thirty microseconds and one for each unit of time, and end at a time."""

    span: float
    ends: float = math.inf

    def run(self, setting, span, samples):
        if span > self.ends:
            raise NonFiniteStateError("it ends", self.ends, np.zeros(2))
        return SimpleNamespace(cpu_seconds=3e-5 + 1e-6 * span)


def test_what_a_run_takes_before_its_first_step_is_not_taken_for_steps():
    seen = Pilot(Setting(Splitting("verlet"), 0.1), 10.0)
    assert seconds_per_time(_Timed(1e6), seen) == pytest.approx(1e-6, rel=0.05)
    # Where the whole motion is short, so are its runs; what follows a pilot need not be there.
    assert seconds_per_time(_Timed(20.0), seen) == pytest.approx(2.5e-6)
    assert seconds_per_time(_Timed(1e6, ends=50.0), seen) == pytest.approx(1.75e-6)
    with pytest.raises(NonFiniteStateError):
        seconds_per_time(_Timed(1e6, ends=5.0), seen)


def test_only_the_first_step_of_a_method_is_timed(monkeypatch):
    timed = []
    own = candidate.seconds_per_time
    monkeypatch.setattr(candidate, "seconds_per_time", lambda *given: timed.append(given) or own(*given))
    pendulum = find("simple-pendulum")
    question = Question(pendulum.hamiltonian, pendulum.state("wide"), pendulum.values, 4000.0)
    first = candidate.tried_with(question, Setting(Splitting("kahan-li-8"), 0.1), 200.0)
    second = candidate.tried_with(question, Setting(Splitting("kahan-li-8"), 0.05), 200.0, first)
    assert len(timed) == 1
    assert second.cost == pytest.approx(2 * first.cost, rel=0.01)
    # So it is where it is timed.
    assert 0.4 < candidate.tried_with(question, second.pilot.setting, 200.0).cost / second.cost < 2.5


def test_a_first_run_grows_by_eight_until_it_tells_how_long_four_hundred_steps_are():
    spans, steps = [], iter((29, 30, 300))

    def run(setting, span, samples):
        spans.append(span)
        return SimpleNamespace(steps=next(steps))

    assert natural_step(SimpleNamespace(span=2.0**20, run=run)) == spans[-1] / 300
    assert spans == [1.0, 8.0, pytest.approx(8.0 * 400 / 30)]
