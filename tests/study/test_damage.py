"""Flipped bits in a results file: told by case, set aside on request, computed again to the same numbers."""

from __future__ import annotations

import io
import json
import random
import sqlite3
from contextlib import closing, redirect_stderr, redirect_stdout

import pytest

from canon import RK4, Splitting
from canon.cli import main
from canon.study.cases.checkpointed_run import advance
from canon.study.cases.export import rows_of
from canon.study.cases.mend import mend
from canon.study.cases.row_checksum import DamagedRow
from canon.study.cases.run_study import resume, run_study
from canon.study.cases.store import DamagedRows, Record, Store, StoreError
from canon.study.cases.study import Study

STUDY = Study.of(
    system="henon-heiles",
    method=[Splitting("verlet"), RK4()],
    step=[0.1, 0.2],
    span=60.0,
    samples=512,
    parts=4,
)


def numbers(store):
    return {
        row["key"]: {name: x for name, x in row.items() if name not in ("seconds", "done")}
        for row in rows_of(store)
    }


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A file with three records and a checkpoint of the fourth case, and the numbers of all four."""
    store = Store(tmp_path_factory.mktemp("damage") / "whole.sqlite")
    run_study(STUDY, store)
    finished = numbers(store)
    last = STUDY.cases[-1]
    key = list(store.cases())[-1]
    store.forget([key])
    point = advance(last, seconds=0.0)
    store.save_checkpoint(key, point.part, point.to_text())
    return store.path.read_bytes(), finished


@pytest.fixture
def path(tmp_path, whole):
    file = tmp_path / "study.sqlite"
    file.write_bytes(whole[0])
    return file


def changed(path, statement):
    with closing(sqlite3.connect(path)) as connection, connection:
        assert connection.execute(statement).rowcount == 1


def command(*arguments):
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        status = main(["study", *map(str, arguments)])
    return status, out.getvalue(), err.getvalue()


DAMAGE = {
    "records": "UPDATE records SET outcome = replace(outcome, '\"steps\": 600', '\"steps\": 601') WHERE rowid = 1",
    "checkpoints": "UPDATE checkpoints SET point = replace(point, '0.', '0.1')",
    "cases": "UPDATE cases SET inputs = replace(inputs, '\"step\": 0.2', '\"step\": 0.3') WHERE rowid = 2",
}


@pytest.mark.parametrize("table", DAMAGE)
def test_a_damaged_row_is_told_set_aside_and_computed_again(path, whole, table):
    changed(path, DAMAGE[table])
    (damaged,) = Store(path).damaged()
    assert damaged.table == table
    for arguments in (("status", path), ("resume", path), ("export", path, path.with_suffix(".csv"))):
        status, out, err = command(*arguments)
        assert status == 2
        assert "damaged" in err
        assert damaged.key[:12] in err
        assert "canon study mend" in err
        assert "finished" not in out
    assert not path.with_suffix(".csv").exists()
    status, out, _ = command("mend", path)
    assert status == 3
    assert f"kept as {path}.damaged" in out
    assert damaged.what in out
    assert Store(path).damaged() == ()
    assert run_study(STUDY, path).finished == 4
    assert numbers(Store(path)) == whole[1]


def test_the_damaged_case_is_named_in_words(path):
    changed(path, DAMAGE["records"])
    _, out, _ = command("status", path)
    assert out == "  damaged: the record of henon-heiles; verlet, h = 0.1\n"


def test_a_damaged_checkpoint_is_not_gone_on_from(path):
    changed(path, DAMAGE["checkpoints"])
    with pytest.raises(DamagedRows, match="the checkpoint of case"):
        resume(Store(path))
    with pytest.raises(DamagedRows, match="the checkpoint of case"):
        Store(path).checkpoint(list(Store(path).intact_cases())[-1])


def test_text_that_is_no_utf_8_is_damage(path):
    changed(path, "UPDATE records SET outcome = CAST(x'ff' || outcome AS TEXT) WHERE rowid = 1")
    assert [row.table for row in Store(path).damaged()] == ["records"]


def test_damage_in_another_file_is_not_merged(path, tmp_path):
    changed(path, DAMAGE["records"])
    store = Store(tmp_path / "all.sqlite")
    with pytest.raises(DamagedRows, match=r"study\.sqlite"):
        store.add_from(Store(path))
    assert store.cases() == {}


def test_a_whole_file_is_not_mended(path):
    before = path.read_bytes()
    assert (mend(path).aside, mend(path).lost) == (None, ())
    assert path.read_bytes() == before
    assert sorted(each.name for each in path.parent.iterdir()) == ["study.sqlite"]


def test_two_mendings_keep_both_damaged_files(path):
    asides = []
    for rowid in (1, 2):
        changed(
            path,
            f"UPDATE records SET outcome = 'x' WHERE rowid = (SELECT rowid FROM records LIMIT {rowid - 1}, 1)",
        )
        asides.append(mend(path).aside)
    assert [aside.name for aside in asides] == ["study.sqlite.damaged", "study.sqlite.damaged1"]
    assert all(aside.exists() for aside in asides)


def test_a_page_in_pieces_costs_its_rows_only(tmp_path):
    store = Store(tmp_path / "long.sqlite")
    store.add_cases({f"case {i}": "x" * 300 for i in range(100)})
    records = [Record(f"case {i}", outcome="y" * 2000).row() for i in range(100)]
    store.add_rows({"cases": [], "records": records, "checkpoints": []})
    page = 4096
    damaged = bytearray(store.path.read_bytes())
    where = len(damaged) // page // 2 * page
    damaged[where : where + page] = bytes(page)
    store.path.write_bytes(damaged)
    with pytest.raises(StoreError, match=r"is damaged .* 'canon study mend"):
        Store(store.path)
    mended = mend(store.path)
    assert mended.aside.read_bytes() == bytes(damaged)
    assert 50 <= len(mended.store.records()) < 100
    assert mended.store.cases().items() <= {f"case {i}": "x" * 300 for i in range(100)}.items()


def test_damage_that_sqlite_cannot_put_in_words_is_told(path):
    data = path.read_bytes()
    path.write_bytes(data.replace(b"CREATE TABLE records", b"CREATE TABL\xd4 records"))
    for action in ("status", "mend"):
        status, _, err = command(action, path)
        assert status == 2
        assert err.startswith("canon study: ")


def test_a_file_that_is_nothing_is_not_mended(tmp_path):
    file = tmp_path / "notes.sqlite"
    file.write_text("my notes " * 1000)
    with pytest.raises(StoreError):
        mend(file)
    assert [each.name for each in tmp_path.iterdir()] == ["notes.sqlite"]


def test_rows_exchanged_are_damaged(path):
    """Each text is whole, and stands beside the wrong key."""
    with closing(sqlite3.connect(path)) as connection, connection:
        (a, b) = connection.execute("SELECT rowid, outcome FROM records LIMIT 2")
        connection.execute("UPDATE records SET outcome = ? WHERE rowid = ?", (b[1], a[0]))
    assert len(Store(path).damaged()) == 1


def test_what_has_a_checksum_and_is_no_case_is_refused(path):
    Store(path).add_cases({"k": json.dumps({"start": None, "system": "kepler", "method": 5})})
    status, _, err = command("status", path)
    assert status == 2
    assert "these are not the inputs of a case" in err


def test_no_flipped_bit_changes_a_number_unsaid(path, whole):
    """Forty of them; ``benchmarks/robustness.py`` flips thousands."""
    draw, told = random.Random(7), 0
    for _ in range(40):
        damaged = bytearray(whole[0])
        damaged[draw.randrange(len(damaged))] ^= 1 << draw.randrange(8)
        path.write_bytes(damaged)
        try:
            found = numbers(Store(path))
        except StoreError:
            told += 1
        else:
            assert {key: row for key, row in found.items() if row["state"] == "finished"}.items() <= whole[
                1
            ].items()
            assert found.keys() == whole[1].keys()
            assert sum(row["state"] == "finished" for row in found.values()) == 3
    assert told > 10


def test_a_row_says_which_it_is():
    assert str(DamagedRow("checkpoints", "0123456789abcdef")) == "the checkpoint of case 0123456789ab"
