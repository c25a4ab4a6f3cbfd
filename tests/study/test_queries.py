"""Tags and queries: results found by what they are and what came of them; tags survive files, merging and damage."""

from __future__ import annotations

import csv
import sqlite3
from contextlib import closing

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from canon import RK4, Splitting, Study, Taylor, read_study, results_of, run_study
from canon.cli import main
from canon.study import StudyError, mend
from canon.study.cases.case import Case, key_of
from canon.study.cases.result import Result, Results, State
from canon.study.cases.store import DamagedRows, Store

STUDY = Study.of(
    system=["simple-pendulum", "henon-heiles"],
    method=[Splitting("verlet"), RK4(), Taylor()],
    step=[0.1, 0.05],
    span=30.0,
    samples=256,
    tags=["all", "first"],
)
LONGER = Study.of(system="simple-pendulum", parameters={"l": [1.0, 2.0]}, method="verlet", step=0.1, span=60.0,
                  samples=256, tags="longer")  # fmt: skip


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("queries") / "study.sqlite"
    for study in (STUDY, LONGER):
        run_study(study, path)
    run_study(Study.of(system="double-pendulum", method="verlet", step=0.1, span=50.0), path)
    return path


@pytest.mark.parametrize(
    ("wanted", "count"),
    [
        ({}, 13),
        ({"system": "henon-heiles"}, 5),
        ({"system": ["henon-heiles", "double-pendulum"]}, 6),
        ({"method": "verlet"}, 7),
        ({"method": Splitting}, 7),
        ({"method": [RK4(), "taylor"]}, 6),
        ({"tag": "longer"}, 2),
        ({"tag": lambda tag: tag.startswith("fir")}, 10),
        ({"tag": "none"}, 0),
        ({"step": lambda h: h < 0.1}, 4),
        ({"step": 0.05, "method": "rk4"}, 2),
        ({"l": 2.0}, 1),
        ({"l": 1.0}, 6),
        ({"state": "failed"}, 1),
        ({"state": State.FAILED}, 1),
        ({"span": 60.0, "tag": "longer", "l": lambda l: l > 1}, 1),
        ({"bound": lambda bound: bound < 1e-10, "system": "henon-heiles"}, 1),
    ],
)
def test_results_are_found(path, wanted, count):
    found = results_of(path).where(**wanted)
    assert len(found) == count
    assert all(row in results_of(path).rows for row in found)


def test_a_start_is_asked_for_as_it_was_given(tmp_path):
    numbers = [[0.0, 0.1, 0.3, 0.0], [0.0, 0.2, 0.3, 0.0]]
    study = Study.of(
        system="henon-heiles", start=[*numbers, "chaotic"], method="verlet", step=0.1, span=30.0, samples=256
    )
    run_study(study, tmp_path / "starts.sqlite")
    results = results_of(tmp_path / "starts.sqlite")
    first, second = (tuple(each) for each in numbers)
    for one in (numbers[0], first, np.array(first), [first], {first}, [numbers[0], [9.0, 9.0, 9.0, 9.0]]):
        assert [row.case.start for row in results.where(start=one)] == [first]
    assert [row.case.start for row in results.where(start=numbers)] == [first, second]
    assert [row.case.start for row in results.where(start=[first, "chaotic"])] == [first, "chaotic"]
    assert [row.case.start for row in results.where(start="chaotic")] == ["chaotic"]
    assert [*results.where(start="chaotic")[0].case.state] != list(first)
    for none in ([0.0, 0.1, 0.3, 0.1], "regular", [], 0.1):
        assert len(results.where(start=none)) == 0


def test_what_is_found_is_what_a_loop_finds(path):
    results = results_of(path)
    by_loop = [
        r.key
        for r in results
        if r.state is State.FINISHED and r.numbers["bound"] > 1e-6 and r.case.step == 0.1
    ]
    assert [r.key for r in results.where(step=0.1, bound=lambda bound: bound > 1e-6)] == by_loop
    assert by_loop


def test_a_name_that_nothing_has_is_told(path):
    with pytest.raises(ValueError, match="no result has anything called 'stepp'; did you mean 'step'"):
        results_of(path).where(stepp=0.1)
    with pytest.raises(ValueError, match="there are system, tag"):
        results_of(path).where(zzz=0.1)


def test_results_are_a_sequence(path):
    results = results_of(path)
    assert results[0] == results.rows[0] == next(iter(results))
    assert isinstance(results[2:4], Results)
    assert len(results[2:4]) == 2
    assert repr(results) == "<Results: 13 cases of 5 motions>"


def test_tags_are_no_part_of_a_case(path):
    plain, tagged = (
        Study.of(system="kepler", method="rk4", step=0.1, span=5.0, tags=tags) for tags in ([], ["a"])
    )
    assert plain == tagged
    assert key_of(plain.cases[0]) == key_of(tagged.cases[0])
    before = Store(path).records()
    run_study(
        Study.of(system="henon-heiles", method="rk4", step=0.1, span=30.0, samples=256, tags="again"), path
    )
    assert Store(path).records() == before
    (found,) = results_of(path).where(tag="again")
    assert found.case.tags == ("all", "first", "again")


def test_equal_cases_of_a_file_have_the_tags_of_both(tmp_path):
    one = '[[study]]\nsystem = "kepler"\nmethod = "rk4"\nstep = 0.1\nspan = 5.0\ntags = {}\n'
    file = tmp_path / "s.toml"
    file.write_text(one.format('["a", "b"]') + one.format('"c"'))
    (case,) = read_study(file).cases
    assert case.tags == ("a", "b", "c")


@pytest.mark.parametrize("tags", [5, "", " ", ["a", 3], "line\nbreak", "x" * 101, {"a": 1}, "\x1b[31m"])
def test_what_is_no_tag_is_refused(tags):
    with pytest.raises(StudyError, match="a tag is a text of 1 to 100 printable letters"):
        Study.of(system="kepler", method="rk4", step=0.1, span=5.0, tags=tags)


def test_tags_are_merged(tmp_path, path):
    other = Study.of(system="henon-heiles", method="rk4", step=0.1, span=30.0, samples=256, tags="elsewhere")
    run_study(other, tmp_path / "one.sqlite")
    store = Store(tmp_path / "one.sqlite")
    store.add_from(Store(path))
    assert set(results_of(store).where(tag="elsewhere")[0].case.tags) >= {"elsewhere", "all", "first"}


def test_a_damaged_tag_is_told_and_set_aside(tmp_path):
    store = Store(tmp_path / "s.sqlite")
    store.add_cases({"k": "inputs"})
    store.add_tags({"k": ["paper", "draft"]})
    with closing(sqlite3.connect(store.path)) as connection, connection:
        connection.execute("UPDATE tags SET tag = 'taper' WHERE tag = 'paper'")
    with pytest.raises(DamagedRows, match="a tag of case k"):
        store.tags()
    assert [row.table for row in mend(store.path).lost] == ["tags"]
    assert Store(store.path).tags() == {"k": ("draft",)}


def test_a_file_from_before_tags_is_used(tmp_path):
    store = Store(tmp_path / "s.sqlite")
    store.add_cases({"k": "inputs"})
    with closing(sqlite3.connect(store.path)) as connection, connection:
        connection.execute("DROP TABLE tags")
        connection.execute("PRAGMA user_version = 3")
    old = Store(store.path)
    assert old.tags() == {}
    old.add_tags({"k": ["now"]})
    assert (Store(store.path).cases(), Store(store.path).tags()) == ({"k": "inputs"}, {"k": ("now",)})


@given(st.lists(st.tuples(st.sampled_from([0.1, 0.2, 0.4]), st.lists(st.sampled_from("abc"))), max_size=6))
def test_where_is_a_filter(drawn):
    """Asking twice is asking for both; a list is the union of its parts."""
    rows = Results(
        tuple(
            Result(str(k), Case("kepler", RK4(), 1.0, step=h, tags=tuple(tags)), State.PENDING, {})
            for k, (h, tags) in enumerate(drawn)
        )
    )
    assert rows.where(step=0.1).where(tag="a") == rows.where(tag="a", step=0.1)
    either = {row.key for row in (*rows.where(step=0.1), *rows.where(step=0.2))}
    assert {row.key for row in rows.where(step=[0.1, 0.2])} == either
    assert rows.where(tag="b").rows == tuple(row for row in rows if "b" in row.case.tags)


def test_the_command_exports_and_reports_what_has_a_tag(path, tmp_path, capsys):
    table = tmp_path / "t.csv"
    assert main(["study", "export", str(path), str(table), "--tag", "longer"]) == 0
    with table.open(newline="") as file:
        assert [row["tags"] for row in csv.DictReader(file)] == ["longer"] * 2
    assert main(["study", "report", str(path), str(tmp_path / "t.html"), "--tag", "longer"]) == 0
    assert (tmp_path / "t.html").read_text().count("<tr class=") == 2
    assert main(["study", "export", str(path), str(table), "--tag", "wrong"]) == 2
    assert "no case has the tag 'wrong'; there are all, first" in capsys.readouterr().err
