"""What one found who came with systems of their own: arguments in another form than was meant, and what is said."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np
import pytest
import sympy as sp

import canon.plot
from canon import (
    Event,
    Hamiltonian,
    Lagrangian,
    Study,
    choose,
    coordinates,
    drift,
    drift_study,
    propagate,
    results_of,
    run_study,
    work_precision,
)
from canon.mechanics import (
    VectorField,
    birkhoff_normal_form,
    centre_manifold,
    electric_field,
    generalized_forces,
    generalized_torques,
    is_symmetry,
    noether_charge,
    routhian,
)
from canon.study.cases.mend import mend
from canon.study.cases.run_study import resume
from canon.study.cases.store import Store, StoreError
from canon.study.energy_drift.drift_verdict import Growth
from canon.study.errors import StudyError

if TYPE_CHECKING:
    from pathlib import Path

    from canon.flow.trajectory import Trajectory

TH, PH = coordinates("th ph")
ROTOR = Lagrangian(TH.dot**2 / 2 + sp.sin(TH) ** 2 * PH.dot**2 / 2 + sp.cos(TH), [TH, PH])
X = coordinates("x")
SPRING = Hamiltonian(X.momentum**2 / 2 + X**2 / 2, [X], [X.momentum])


def test_displacements_are_taken_by_coordinate() -> None:
    assert noether_charge(ROTOR, {PH: 1, TH: 0}) == noether_charge(ROTOR, [0, 1]) == ROTOR.momenta[1]
    assert is_symmetry(ROTOR, {PH: 1, TH: 0}).holds
    assert is_symmetry(ROTOR, {"th": 0, "ph": 1}).holds
    assert is_symmetry(ROTOR, {TH: 1, PH: 0}).fails  # the wrong twin: the other coordinate


@pytest.mark.parametrize(
    ("xi", "told"),
    [
        ({PH: 1}, "xi has no entry for th"),
        ({PH: 1, TH: 0, X: 2}, "xi names x, which is none of th, ph"),
        ({0, 1}, "members of a set have no order"),
    ],
)
def test_displacements_that_do_not_say_which_is_whose_are_refused(xi: object, told: str) -> None:
    for ask in (noether_charge, is_symmetry):
        with pytest.raises((TypeError, ValueError), match=told):
            ask(ROTOR, xi)


def test_coordinates_in_dictionaries_and_sets_are_refused() -> None:
    p = X.momentum
    for ask in (
        lambda: Lagrangian(ROTOR.L, {TH: 1, PH: 2}),
        lambda: Lagrangian(ROTOR.L, {TH, PH}),
        lambda: Hamiltonian(p**2, {X: 1}, {p: 0}),
        lambda: routhian(ROTOR, {PH: 0.3}),
        lambda: generalized_torques({X: 1}, {X: 1}, [X]),
        lambda: generalized_forces({X: 1}, [X], [X]),
        lambda: SPRING.has_equations({X: p}, {p: -X}),
        lambda: electric_field({X: 1}, 0, [X]),
    ):
        with pytest.raises(TypeError, match="have no order that says which is whose; give a list"):
            ask()


def test_a_force_is_a_vector() -> None:
    with pytest.raises(
        TypeError, match=r"forces should be a list of vectors.*x stands in the place of a vector"
    ):
        generalized_forces([X], [X], [X])
    with pytest.raises(ValueError, match="positions has 2 entries for 1 forces; give one each"):
        generalized_forces([(1, 0)], [(X, 0), (0, X)], [X])
    with pytest.raises(ValueError, match="angles has 1 entry for 2 torques"):
        generalized_torques([1, 2], [X], [X])
    assert generalized_forces([(3, 0)], [(2 * X, 0)], [X]) == (6,)


def a_study() -> Study:
    return Study.of(system="henon-heiles", method="rk4", step=0.1, span=30.0, samples=256)


def test_results_of_a_file_that_is_not_there_are_not_an_empty_study(tmp_path: Path) -> None:
    missing = tmp_path / "missing.sqlite"
    for ask in (results_of, resume, mend):
        with pytest.raises(FileNotFoundError, match="there is no file"):
            ask(missing)
        assert not missing.exists()
    missing.touch()
    with pytest.raises(FileNotFoundError, match="is empty, and no results of a study"):
        results_of(missing)
    assert not missing.stat().st_size
    run_study(a_study(), missing)  # the twin: an empty file is taken to write to
    assert len(results_of(missing)) == 1


@pytest.mark.parametrize("content", [b"x", b"SQLite format", b"notes of mine\n" * 100])
def test_a_file_of_another_kind_stays_as_it_is(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "notes.txt"
    file.write_bytes(content)
    for ask in (lambda: results_of(file), lambda: run_study(a_study(), file), lambda: Store(file)):
        with pytest.raises(StoreError, match="no SQLite file; give another file, for this one stays"):
            ask()
        assert file.read_bytes() == content


@pytest.fixture(scope="module")
def motion() -> Trajectory:
    return propagate(SPRING, (0, 30), [1, 0], samples=300)


def test_every_plot_says_what_it_draws(motion: Trajectory) -> None:
    pytest.importorskip("matplotlib")
    of_one = [each for each in canon.plot.__all__ if each.startswith("plot_")]
    wrong = {
        "plot_section": lambda f: f(motion, "x", "p_x"),
        "plot_chaos_map": lambda f: f(motion, [0], [0]),
    }
    for name in of_one:
        function = getattr(canon.plot, name)
        with pytest.raises(TypeError, match=r"should be an? .*, not .*; "):
            wrong.get(name, lambda f: f("x"))(function)
    assert len(of_one) == 13
    for name, given, told in (
        (
            "plot_block_means",
            motion,
            r"should be a Drift or a Result, not a Trajectory .*; drift\(motion\) returns one",
        ),
        ("plot_errors", motion, "plot_energy_error draws motions"),
        ("plot_phase_portrait", [motion, 1], "should be a Trajectory, not 1; propagate"),
        ("plot_drift_by_step", [motion], r"study\.rows"),
    ):
        with pytest.raises(TypeError, match=told):
            getattr(canon.plot, name)(given)


def test_axes_are_axes(motion: Trajectory) -> None:
    pyplot = pytest.importorskip("matplotlib.pyplot")
    for ask in (canon.plot.plot_phase_portrait, canon.plot.plot_energy_error):
        with pytest.raises(
            TypeError, match=r"ax should be an Axes, not the text 'z'; plt\.subplots\(\) makes one"
        ):
            ask(motion, "z")
        figure, axes = pyplot.subplots()
        assert ask(motion, axes) is axes  # the twin
        pyplot.close(figure)


def test_motions_drifts_and_crossings_can_be_compared() -> None:
    one, other = (propagate(SPRING, (0, 30), [1, 0], samples=300, events=[Event(X)]) for _ in range(2))
    of_one, of_other = ((m, m.events[0], drift(m), m.error_estimate()) for m in (one, other))
    for a, b in zip(of_one, of_other, strict=True):
        assert a == a
        assert a != b
        assert b not in [a]
        assert b in [a, b]
        assert len({a, b, a}) == 2


def test_an_observable_in_the_place_of_an_energy_is_asked_for_by_name() -> None:
    y = coordinates("y")
    field = VectorField([y, -X], [X, y])
    bare = propagate(field, (0, 30), [1, 0], samples=300)
    followed = propagate(field, (0, 30), [1, 0], samples=300, observables={"E": X**2 + y**2})
    for ask in (drift, lambda m: m.energy_error, canon.plot.plot_energy_error):
        with pytest.raises(
            AttributeError, match=r"observables=\{name: expression\}, and judge that by its name"
        ):
            ask(bare)
        with pytest.raises(
            AttributeError, match=r"has followed E: judge that, drift\(motion, observable='E'\)"
        ):
            ask(followed)
    assert drift(followed, observable="E").verdict.value == "round-off"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (
            ([1, 0], 1000),
            r"span should be a duration, one number, not a list .*before the state y0, {}\(system, 1000",
        ),
        (((0, 1000), [1, 0]), r"span = \(0, 1000\): give a duration, one number.*{}\(system, span, y0\)"),
        (("long", [1, 0]), "span should be a duration, one number, not the text 'long'"),
        ((-1.0, [1, 0]), "a span of -1.0 makes no sense"),
    ],
)
def test_a_duration_is_one_number(arguments: tuple[object, ...], told: str) -> None:
    with pytest.raises(StudyError, match=told.format("choose")):
        choose(SPRING, *arguments, accuracy=1e-6)
    with pytest.raises(StudyError, match=told.format("work_precision")):
        work_precision(SPRING, *arguments, methods=["rk4"], steps=[0.1])


def test_the_duration_of_a_drift_study_has_a_name() -> None:
    told = r"the duration by name: drift_study\(system, y0, span=1000\)"
    with pytest.raises(TypeError, match=told):
        drift_study(SPRING, (0, 1000), [1, 0])
    with pytest.raises(TypeError, match=told):
        drift_study(SPRING, [1, 0], t_span=(0, 1000))
    with pytest.raises(TypeError, match=r"drift_study has no argument method=: did you mean methods=\?"):
        drift_study(SPRING, [1, 0], method="rk4")
    with pytest.raises(StudyError, match=r"span = \(0, 1000\): give a duration"):
        drift_study(SPRING, [1, 0], span=(0, 1000))


K = sp.Symbol("k", positive=True)
BY_RK4 = {"method": "rk4", "step": 0.1, "span": 30.0, "samples": 256}


def springs(k: sp.Symbol) -> tuple[Hamiltonian, Lagrangian]:
    return (
        Hamiltonian(X.momentum**2 / 2 + k * X**2 / 2, [X], [X.momentum]),
        Lagrangian(X.dot**2 / 2 - k * X**2 / 2, [X]),
    )


def test_a_study_takes_what_propagate_takes() -> None:
    p = X.momentum
    plain = Study.of(system=springs(K)[0], start=[[0.5, 0.0]], parameters={"k": [1.0, 1.5, 2.0]}, **BY_RK4)
    for start in ({X: 0.5, p: 0}, [{"p_x": 0, "x": 0.5}], np.array([[0.5, 0.0]]), [np.array([0.5, 0.0])]):
        for parameters in ({K: [1, 1.5, 2]}, {"k": np.linspace(1, 2, 3)}):
            assert Study.of(system=springs(K)[0], start=start, parameters=parameters, **BY_RK4) == plain
    of_scene = Study.of(system="kepler", start={"x": 1, "y": 0, "p_x": 0, "p_y": 0.9}, **BY_RK4)
    assert of_scene.cases[0].start == (1.0, 0.0, 0.0, 0.9)
    of_lagrangian = Study.of(system=springs(K)[1], start={X.dot: 2, X: 1}, parameters={K: 1}, **BY_RK4)
    assert of_lagrangian.cases[0].start == (1.0, 2.0)
    with pytest.raises(StudyError, match=r"start: y0 has no value for p_x"):
        Study.of(system=springs(K)[0], start={X: 0.5}, parameters={K: 1}, **BY_RK4)
    with pytest.raises(StudyError, match="parameters names one twice: k, k"):
        Study.of(system=springs(K)[0], start=[[1, 0]], parameters={K: 1, "k": 2}, **BY_RK4)


@pytest.mark.parametrize("name", [r"\omega_0", "ω₀", "ω_0", r"\omega_{12}", "θ", "λ", "e", "E"])
def test_symbols_of_a_study_have_any_name(tmp_path: Path, name: str) -> None:
    k = sp.Symbol(name, positive=True)
    file = tmp_path / "study.sqlite"
    for system in springs(k):
        study = Study.of(system=system, start=[[1, 0]], parameters={k: [2.0, 3.0]}, **BY_RK4)
        assert study == Study.of(system=system, start=[[1, 0]], parameters={name: [2.0, 3.0]}, **BY_RK4)
        with pytest.raises(StudyError, match=f"holds {re.escape(name)}: give each a value, parameters="):
            Study.of(system=system, start=[[1, 0]], **BY_RK4)
    assert run_study(study, file).finished == 2
    of_hamiltonian = Study.of(system=springs(k)[0], start=[[1, 0]], parameters={k: 2.0}, **BY_RK4)
    run_study(of_hamiltonian, file)
    assert [result.case.values for result in results_of(file).where(system="Hamiltonian")] == [{name: 2.0}]


def test_symbols_that_read_alike_are_refused() -> None:
    first, other = sp.symbols(r"\omega_0 omega_0", positive=True)
    both = Hamiltonian(X.momentum**2 / 2 + first * X**2 + other * X, [X], [X.momentum])
    with pytest.raises(StudyError, match="the expression language has no words for"):
        Study.of(system=both, start=[[1, 0]], parameters={first: 1, other: 2}, **BY_RK4)


@pytest.mark.parametrize(
    ("y0", "told"),
    [
        ("hello", "y0 is the text 'hello': give a number for each variable.*only scenes have starts"),
        ({0.0, 1.0}, "y0 is a set .*a set has no order"),
        ((x for x in (1.0, 0.0)), r"y0 is a generator .*list\(…\) makes a list of it"),
        ({"x": 1}.items(), r"y0 is a dict_items .*leave \.items\(\) out"),
        ({"x": 1}.values(), "y0 is a dict_values .*give the dictionary itself"),
        (5, "y0 is 5: .*a state of one variable is a list of one number"),
        (None, "no start y0 is given: give a number for each variable"),
    ],
)
def test_what_is_no_start_is_named(y0: object, told: str) -> None:
    for system in (SPRING, Lagrangian(X.dot**2 / 2 - X**2 / 2, [X])):
        with pytest.raises((TypeError, ValueError), match=told):
            propagate(system, (0, 1), y0)


def test_dense_is_left_out_where_it_is_not_needed() -> None:
    with pytest.raises(ValueError, match=r"dense=True: leave it out.*motion\(4\.123\)"):
        propagate(SPRING, (0, 10), [1, 0], method="rk4", step=0.1, dense=True)
    assert propagate(SPRING, (0, 10), [1, 0], method="rk4", step=0.1)(4.123).shape == (2,)
    with pytest.raises(
        ValueError, match=r"DOP853.* has no polynomials to keep; Taylor\(\) has, or name the times"
    ):
        propagate(SPRING, (0, 10), [1, 0], method="dop853", dense=True)


def test_a_stopped_motion_says_how_to_go_on() -> None:
    stopped = propagate(SPRING, (0, 10), [1, 0], events=[Event(X, action="stop")])
    told = r"does not go on; start another one there, propagate\(system, \(1\.5708, …\), motion\.final\)"
    with pytest.raises(ValueError, match=told):
        stopped.resume(20)


def test_more_samples_than_any_memory_holds_are_refused() -> None:
    with pytest.raises(ValueError, match="samples=100000000000: their times alone take 800 GB of memory"):
        propagate(SPRING, (0, 10), [1, 0], samples=10**11)
    by_steps = propagate(SPRING, (0, 10), [1, 0], samples=10**11, method="rk4", step=0.1)
    assert len(by_steps.t) == 101  # the twin: no more than there are steps


def test_the_order_of_a_normal_form_is_named() -> None:
    for find in (birkhoff_normal_form, centre_manifold):
        with pytest.raises(ValueError, match=r"the order should be a whole number from 2, not 4\.5"):
            find(SPRING, 4.5)


def test_words_that_no_verdict_has_are_refused(tmp_path: Path) -> None:
    run_study(a_study(), tmp_path / "study.sqlite")
    results = results_of(tmp_path / "study.sqlite")
    with pytest.raises(
        ValueError, match="no verdict is called 'good'; there are bounded, round-off, wandering"
    ):
        results.where(verdict="good")
    assert len(results.where(verdict=[each.value for each in Growth])) == 1
    assert len(results.where(verdict=lambda word: word != "good")) == 1
