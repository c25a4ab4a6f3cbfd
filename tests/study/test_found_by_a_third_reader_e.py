"""What a reader of studies, their commands and their files found, each beside what goes on."""

import shlex
from dataclasses import replace

import numpy as np
import pytest

from canon import RK4, Study
from canon.command.drift import EXAMPLES
from canon.command.study import add_arguments, run
from canon.scene import find
from canon.study import StudyError
from canon.study.cases.case import Case, key_of
from canon.study.cases.result import Result, Results, State
from canon.study.kept.keep_choice import chosen_functions


def kept(default):
    def mean_of(motion, window=default):
        return window, motion

    return chosen_functions({"mean_of": mean_of})


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ((0, 10), (10, 20)),
        ([0, 10], [0, 11]),
        ({"low": 0}, {"low": 1}),
        ({1, 2}, {1, 3}),
        ((None, 1), (None, 2)),
        (np.arange(3), np.arange(4)),
        (np.sin, np.cos),
        (1, 2),
    ],
)
def test_functions_with_other_defaults_are_others(one, other):
    assert kept(one) != kept(other)
    assert kept(one) == kept(one)


def test_a_default_that_cannot_be_told_from_another_is_refused():
    with pytest.raises(TypeError, match="can't be told from another"):
        kept(object())
    assert kept(None) == kept(None)


def test_a_scene_that_was_changed_is_not_run_as_the_one_of_its_name():
    pendulum = find("simple-pendulum")
    rest = {"method": "rk4", "step": 0.1, "span": 10.0}
    free = replace(pendulum, L_of=lambda s: s.m * s.l**2 * s.theta.dot**2 / 2, solutions=())
    with pytest.raises(StudyError, match="is not the simple-pendulum"):
        Study.of(system=free, **rest)
    moved = replace(pendulum, starts=(replace(pendulum.starts[0], q=(0.3,)),), solutions=())
    with pytest.raises(StudyError, match="is not the simple-pendulum"):
        Study.of(system=moved, **rest)
    assert Study.of(system=pendulum, **rest).cases == Study.of(system="simple-pendulum", **rest).cases
    retitled = replace(pendulum, title="mine")
    assert Study.of(system=retitled, **rest).cases == Study.of(system="simple-pendulum", **rest).cases


def results():
    cases = [Case("kepler", RK4(), span=10.0, step=h) for h in (0.1, 0.2, 0.3)]
    return Results(tuple(Result(str(i), case, State.PENDING, {}) for i, case in enumerate(cases)))


@pytest.mark.parametrize("steps", [[0.1, 0.2], (0.1, 0.2), {0.1, 0.2}, np.array([0.1, 0.2])])
def test_any_of_several_values_is_asked_for(steps):
    assert len(results().where(step=steps)) == 2
    assert len(results().where(step=0.1)) == 1
    assert len(results().where(step=[])) == 0


def test_a_state_that_is_none_is_told():
    with pytest.raises(ValueError, match="no state is called 'pendingg'; there are"):
        results().where(state="pendingg")
    assert len(results().where(state="pending")) == 3
    assert len(results().where(state=State.PENDING)) == 3


def test_a_whole_number_is_the_same_case():
    one, other = (Case("kepler", RK4(), span=span, step=0.1) for span in (10, 10.0))
    assert one == other
    assert key_of(one) == key_of(other)
    assert key_of(one) != key_of(replace(one, span=11.0))


@pytest.mark.parametrize("lost", [{"step": []}, {"step": 0.1, "parameters": {"mu": []}}])
def test_an_axis_without_values_is_told(lost):
    with pytest.raises(StudyError, match="has no values"):
        Study.of(system="kepler", method="rk4", span=10.0, **lost)


@pytest.mark.parametrize("action", ["report", "export"])
def test_results_are_not_written_over(action, tmp_path, capsys):
    import argparse

    from canon.study.cases.store import Store

    store = tmp_path / "results.csv"
    (case,) = Study.of(system="kepler", method="rk4", step=0.1, span=1.0).cases
    Store(store).add_cases({key_of(case): case.to_text()})
    before = store.read_bytes()
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    assert run(parser.parse_args([action, str(store), f"{tmp_path}/../{tmp_path.name}/results.csv"])) == 2
    assert "holds the results themselves" in capsys.readouterr().err
    assert store.read_bytes() == before
    assert run(parser.parse_args([action, str(store), str(tmp_path / "page.csv")])) == 0


def test_examples_of_the_help_name_starts_that_are_there():
    for line in EXAMPLES.splitlines():
        said = shlex.split(line, comments=False) if "--start" in line else []
        if said:
            assert find(said[2]).start(said[said.index("--start") + 1])
