"""Studies that judge more than the energy: constants by name and formulas, kept with each case."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from canon import RK4, Splitting, Study, Taylor, read_study, run_study
from canon.study.cases.case import Case, key_of
from canon.study.cases.case_observables import followed, observables_from
from canon.study.cases.checkpointed_run import Checkpoint, advance
from canon.study.cases.export import dataset_of, rows_of, write_netcdf
from canon.study.cases.result import results_of
from canon.study.cases.store import Store
from canon.study.energy_drift.drift_study import drift_study
from canon.study.errors import StudyError
from canon.study.motion.hamiltonian_text import Formula

PLANE = Formula(
    "plane", "(p_x**2 + p_y**2)/2 + k*(x**2 + y**2)**2/4", ("x", "y"), ("p_x", "p_y"), (("k", 2.0),)
)
AREA = (("area", "x*p_y - y*p_x"), ("wrong", "x*p_y + y*p_x"))
CASE = Case(PLANE, RK4(), span=200.0, step=0.05, samples=600, start=(1.0, 0.0, 0.1, 0.7), observables=AREA)

FILE = """
[system.plane]
H = "(p_x**2 + p_y**2)/2 + k*(x**2 + y**2)**2/4"
q = "x y"
parameters = { k = 2.0 }
starts = { there = [1.0, 0.0, 0.1, 0.7] }

[[study]]
system = "plane"
method = ["verlet", "taylor"]
step = 0.05
span = 100.0
precision = ["double", "quad"]
observables = ["energy", { area = "x*p_y - y*p_x" }]

[[study]]
system = "kepler"
method = "rk4"
steps_per_period = 80.3
periods = 30
observables = "integrals"
"""


def test_a_formula_is_judged_as_drift_judges_it():
    """Second route: drift_study with the function as an expression."""
    numbers = advance(replace(CASE, parts=1)).numbers["observables"]
    x, y = CASE.hamiltonian.q
    p_x, p_y = CASE.hamiltonian.p
    (row,) = drift_study(
        CASE.hamiltonian,
        CASE.state,
        methods=[RK4()],
        span=200.0,
        step=0.05,
        samples=600,
        parameters={"k": 2.0},
        observables={"area": x * p_y - y * p_x},
    ).rows
    assert numbers["area"]["verdict"] == row.drift.verdict.value == "secular"
    assert numbers["area"]["bound"] == pytest.approx(row.drift.bound, rel=1e-2)
    assert numbers["area"]["slope"] == pytest.approx(row.drift.slope, rel=1e-2)
    assert numbers["wrong"]["bound"] > 0.5


def test_interrupted_it_ends_the_same():
    case = replace(CASE, parts=4)
    reached = None
    while isinstance(reached := advance(case, reached, seconds=0.0), Checkpoint):
        reached = Checkpoint.from_text(reached.to_text())
    assert reached.numbers == advance(case).numbers


def test_cases_survive_writing_and_have_keys_of_their_own():
    again = Case.from_dict(json.loads(json.dumps(CASE.to_dict())))
    assert again == CASE
    others = [replace(CASE, observables=()), replace(CASE, observables=AREA[:1])]
    assert len({key_of(case) for case in (CASE, *others)}) == 3
    assert "observables" not in others[0].to_dict()


def test_a_file_names_observables_and_precisions(tmp_path):
    file = tmp_path / "study.toml"
    file.write_text(FILE)
    study, store = read_study(file), Store(tmp_path / "study.sqlite")
    assert [case.precision for case in study.cases] == ["double", "quad", None, "quad", None]
    status = run_study(study, store)
    assert (status.finished, status.failed) == (4, 1)  # splittings have no quadruple precision
    results = {(str(r.case.method), r.case.precision): r for r in results_of(store)}
    area = {
        key: r.numbers["observables"]["area"]
        for key, r in results.items()
        if r.case.system == study.cases[0].system and r.numbers
    }
    assert area["verlet", "double"]["bound"] < 1e-13
    assert 1e-33 < area["Taylor", "quad"]["bound"] < 1e-28 < area["Taylor", None]["bound"] < 1e-13
    assert set(results["RK4", None].numbers["observables"]) == {
        "angular momentum", "Runge–Lenz vector, x", "Runge–Lenz vector, y",
    }  # fmt: skip
    rows = rows_of(store)
    assert rows[0]["area verdict"] in ("bounded", "round-off")
    assert rows[-1]["angular momentum slope"] < 0.0
    pytest.importorskip("xarray")
    write_netcdf(store, tmp_path / "study.nc")
    assert dataset_of(store)["Runge_Lenz_vector_x_verdict"].values[-1] == "secular"


@pytest.mark.parametrize(
    ("written", "told"),
    [
        ("spin", "there is no observable 'spin'"),
        ("symplecticity", "'canon drift' does"),
        ("momenta", "no momentum is constant"),
        ({"area": "x*p_z"}, "the observable 'area'.*p_z"),
        ({"area": "__import__('os')"}, "the observable 'area'"),
        ({"area": 3}, "is a name or a table"),
    ],
)
def test_what_can_not_be_followed_is_said_before_anything_runs(written, told):
    with pytest.raises(StudyError, match=told):
        Study.of(
            system=PLANE,
            method=Splitting("verlet"),
            start=[[1.0, 0.0, 0.1, 0.7]],
            step=0.1,
            span=10.0,
            observables=written,
        )


def test_the_energy_is_always_judged():
    assert observables_from(["energy"]) == ()
    assert followed(replace(CASE, observables=())) == ()
    assert [of.name for of in followed(CASE)] == ["area", "wrong"]


def test_adaptive_methods_take_no_precision_of_fixed_steps():
    study = Study.of(
        system="kepler", method=Taylor(), precision=["double", "compensated", "extended"], span=1.0
    )
    assert [case.precision for case in study.cases] == [None, "extended"]
