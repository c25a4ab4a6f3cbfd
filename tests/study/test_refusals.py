"""What a study does not take is told with what to do instead, and what is given in its place is taken."""

from __future__ import annotations

import math
import sqlite3
from concurrent.futures import Executor, Future

import numpy as np
import pytest
import sympy as sp

from canon import RK4, Hamiltonian, Lagrangian, Splitting, choose, coordinates, propagate
from canon.mechanics import adiabatic_invariants
from canon.scene import find
from canon.study import adiabatic_drift
from canon.study.cases import study as study_
from canon.study.cases.mend import mend
from canon.study.cases.run_study import run_study
from canon.study.cases.store import Record, Store, StoreError
from canon.study.cases.study import Study, read_study
from canon.study.energy_drift.drift import Growth, drift
from canon.study.energy_drift.drift_study import drift_study
from canon.study.energy_drift.drift_table import drift_table, with_error
from canon.study.errors import StudyError
from canon.study.kept.chunk_file import Chunk
from canon.study.kept.keep_choice import chosen_functions
from canon.study.motion.hamiltonian_text import MOST_NAMES, formula_from, formula_of, hamiltonian_of
from canon.study.motion.observables import observables_of
from canon.study.motion.system_table import system_from
from canon.study.motion.system_text import system_text

x, y = coordinates("x y")
QUARTIC = Hamiltonian(x.momentum**2 / 2 + x**4 / 4, [x], [x.momentum])
QUICK = {"system": "henon-heiles", "method": "verlet", "step": 0.1, "span": 40.0, "samples": 300}
MANY = {f"k{i}": 1.0 for i in range(MOST_NAMES)}


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"steps_per_period": 100}, "give step or steps_per_period, and not both"),
        ({"system": formula_of(QUARTIC, "own"), "parameters": {"k": 2.0}}, "own has no parameter 'k'"),
    ],
)
def test_a_study_says_what_does_not_go_together(changed, told):
    with pytest.raises(StudyError, match=told):
        Study.of(**{**QUICK, **changed})


def test_studies_of_one_file_have_so_many_cases_together(tmp_path, monkeypatch):
    file = tmp_path / "study.toml"
    table = "[[study]]\nsystem='kepler'\nmethod='rk4'\nstep={}\nspan=10\n"
    file.write_text(table.format([0.1, 0.2]) + table.format([0.3, 0.4]))
    assert len(read_study(file).cases) == 4
    monkeypatch.setattr(study_, "MOST_CASES", 3)
    with pytest.raises(StudyError, match=r"study.toml: more than .* cases; split the study"):
        read_study(file)


OWN = {"H": "p_q**2/2 + k*q**4/4", "q": "q", "parameters": {"k": 2.0}}


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"parameters": MANY}, f"more than {MOST_NAMES} names; write larger systems in Python"),
        ({"q": "q" * 90}, "is a name of 90 letters"),
        ({"parameters": {"k": math.inf}}, "the parameter k = inf is not a finite number"),
        ({"q": "q-1"}, "names are words, such as theta or x_1, not 'q-1'"),
        ({"q": ["q", 2]}, "names are words"),
        ({"starts": {"near": 0.5}}, "a start is a list of numbers .q, p., not 0.5"),
    ],
)
def test_a_table_of_a_system_says_what_is_wrong_in_it(changed, told):
    assert formula_from("own", OWN).q == ("q",)
    with pytest.raises(StudyError, match=told):
        formula_from("own", {**OWN, **changed})


def test_a_lagrangian_in_a_table_has_so_many_names_too():
    table = {"L": "x_dot**2/2 - k1*x**2/2", "q": "x", "parameters": {"k1": 4.0}}
    assert system_from("spring", table).variables == ("x", "x_dot")
    with pytest.raises(StudyError, match=f"more than {MOST_NAMES} names"):
        system_from("spring", {**table, "parameters": MANY})


def test_a_hamiltonian_that_no_text_spells_is_refused():
    assert formula_of(QUARTIC).H == "p_x**2/2 + x**4/4"
    tau, circle = sp.symbols("tau pi", real=True)
    with pytest.raises(StudyError, match="in a study the time is called t, not tau"):
        formula_of(Hamiltonian(QUARTIC.H + x * sp.cos(tau), [x], [x.momentum], tau))
    with pytest.raises(StudyError, match="holds pi: give each a value"):
        formula_of(Hamiltonian(QUARTIC.H + circle * x, [x], [x.momentum]))
    of_circle = formula_of(Hamiltonian(QUARTIC.H + circle * x, [x], [x.momentum]), parameters={"pi": 2.0})
    assert {s.name for s in hamiltonian_of(of_circle).H.free_symbols} == {"x", "p_x", "pi"}
    with pytest.raises(StudyError, match="zeta is not a function of the language"):
        formula_of(Hamiltonian(QUARTIC.H + sp.zeta(x), [x], [x.momentum]))


def test_a_system_of_a_class_of_ones_own_is_not_written():
    class Own(Lagrangian):
        """A Lagrangian with a name of its own."""

    plain = Lagrangian(x.dot**2 / 2 - x**2 / 2, [x])
    assert system_text(plain, "spring").variables == ("x", "x_dot")
    with pytest.raises((StudyError, ValueError), match="Own is nothing that files know"):
        system_text(Own(plain.L, [x]), "spring")


def test_observables_that_there_are_not():
    henon = find("henon-heiles")
    with pytest.raises(StudyError, match="no constant beside the energy is known"):
        observables_of(henon, henon.hamiltonian, ["integrals"], henon.state(), henon.values)
    for pole, told in ((1 / x, "'pole' is not finite at the start: take another start"), (1 / (1 + x), None)):
        if told is None:
            assert observables_of(QUARTIC, QUARTIC, {"pole": pole}, np.array([0.0, 1.0]), {})[0].unit == 1.0
            continue
        with pytest.raises(StudyError, match=told):
            observables_of(QUARTIC, QUARTIC, {"pole": pole}, np.array([0.0, 1.0]), {})
    with pytest.raises(StudyError, match="observable='spin': give the function of the state as integral="):
        choose(QUARTIC, 100.0, [1.0, 0.0], accuracy=1e-6, observable="spin")


@pytest.mark.parametrize("seconds", [-1.0, math.nan])
def test_a_checkpoint_is_not_written_after_less_than_no_time(tmp_path, seconds):
    with pytest.raises(StudyError, match=f"checkpoint_seconds = {seconds}: give a time, 0 or more"):
        run_study(Study.of(**QUICK), tmp_path / "study.sqlite", checkpoint_seconds=seconds)


class GivesBack(Executor):
    """An executor that takes work and gives it back undone, as one does that is shut down."""

    def submit(self, *_args, **_named):
        future = Future()
        future.cancel()
        future.set_running_or_notify_cancel()
        return future


def test_work_that_an_executor_gives_back_is_told(tmp_path):
    with pytest.raises(StudyError, match=r"the executor gave a case back.*run again to go on"):
        run_study(Study.of(**QUICK), tmp_path / "study.sqlite", executor=GivesBack())


def test_files_beside_a_damaged_one_go_aside_with_it(tmp_path):
    file = tmp_path / "study.sqlite"
    store = Store(file)
    store.add_cases({"a": "first", "b": "second"})
    store.save(Record("a", "{}", "", 1.0))
    with sqlite3.connect(file) as connection:
        connection.execute("UPDATE records SET outcome = '[]'")
    connection.close()
    shared = tmp_path / "study.sqlite-shm"
    shared.write_bytes(b"of another time")
    mended = mend(file)
    assert [row.key for row in mended.lost] == ["a"]
    assert not shared.exists()
    assert (tmp_path / f"{mended.aside.name}-shm").read_bytes() == b"of another time"
    assert set(Store(file).cases()) == {"a", "b"}


def test_tables_that_are_not_those_of_a_study_are_no_results_file(tmp_path):
    file = tmp_path / "study.sqlite"
    Store(file).add_cases({"a": "first"})
    with sqlite3.connect(file) as connection:
        connection.execute("CREATE TABLE more (name TEXT)")
    connection.close()
    with pytest.raises(
        StoreError, match=r"is damaged .its tables are not those of a study.; 'canon study mend"
    ):
        Store(file).cases()


def test_a_row_that_names_a_file_strangely_names_none():
    chunk, _ = Chunk.of("case 1", {"t": np.array([0.0, 1.0])})
    row = '{"kept": {"checksum": "%s", "shapes": {"t": [2]}}}'
    assert Chunk.named_by("case 1", row % chunk.checksum) == chunk
    for key, checksum in (("../case", chunk.checksum), ("case 1", "../" + chunk.checksum[3:])):
        assert Chunk.named_by(key, row % checksum) is None


def test_functions_with_other_functions_inside_are_others():
    def first(motion):
        return (lambda values: values[0])(motion.y)

    def second(motion):
        return (lambda values: values[1])(motion.y)

    ((_, one),), ((_, other),) = chosen_functions({"f": first}), chosen_functions({"f": second})
    assert one == chosen_functions({"f": first})[0][1]
    assert one != other


theta = sp.Symbol("theta", real=True)
action, eps = sp.symbols("I epsilon", positive=True)
a, b = sp.symbols("a b", real=True)
SLOW = Hamiltonian(
    (2 + a**2) * action + (a**2 + b**2) / 2 + eps * action * a * sp.cos(theta), [theta, a], [action, b]
)


def test_an_adiabatic_invariant_drifts_with_the_power_after_its_order():
    (found,) = adiabatic_invariants(SLOW, theta, 1, eps, slow_q=a)
    seen = adiabatic_drift(found, [0, 0.5, 1, 0.3], smalls=[0.01, 0.02, 0.04])
    assert abs(seen.slope - seen.expected) < 0.2
    assert adiabatic_drift(found, [0, 0.5, 1, 0.3], smalls=[0.02]).slope is None
    with pytest.raises(ValueError, match="the start should be 4 numbers"):
        adiabatic_drift(found, [0, 0.5])
    for small in (0.0, -0.1, math.inf):
        with pytest.raises(ValueError, match=f"epsilon should be positive numbers, not {small}"):
            adiabatic_drift(found, [0, 0.5, 1, 0.3], smalls=[small])


@pytest.mark.parametrize(
    ("value", "error", "said"),
    [
        (0.0, 0.0, "0 ± 0"),
        (math.inf, 1.0, "inf ± 1"),
        (math.nan, math.nan, "nan ± nan"),
        (2e-3, 1e-4, "(2.00 ± 0.10)e-03"),
    ],
)
def test_a_number_and_its_error_in_words(value, error, said):
    assert with_error(value, error) == said


def test_a_table_names_the_observables_where_there_are_others_than_the_energy():
    lines = {}
    for observables in (["energy"], ["energy", "angular momentum"]):
        study = drift_study(find("kepler"), methods=[RK4()], periods=10.0, observables=observables)
        lines[len(observables)] = drift_table(study).splitlines()
    head, energy, momentum = (
        next(line for line in lines[2] if line.startswith(name))
        for name in ("observable", "energy", "angular momentum")
    )
    assert "max |ΔI/I|" in head
    assert energy.split()[1] == momentum.split()[2] == "RK4"
    assert not any("angular" in line or line.startswith("observable") for line in lines[1])


def test_what_is_at_rest_does_not_drift():
    rest = propagate(QUARTIC, (0, 100), [0.0, 0.0], method=Splitting("verlet"), step=0.1, samples=500)
    found = drift(rest)
    assert (found.verdict, found.bound, found.slope) == (Growth.BOUNDED, 0.0, 0.0)
