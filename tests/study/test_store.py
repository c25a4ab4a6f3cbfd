"""The file keeps what is finished, whatever happens to it or to the program."""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
import tempfile
from contextlib import closing
from pathlib import Path

import pytest

from canon.study.cases.store import Record, Store, StoreError
from canon.study.cases.store_tables import _add_tags_table


@pytest.fixture
def store(tmp_path):
    made = Store(tmp_path / "study.sqlite")
    made.add_cases({f"k{i}": f"inputs {i}" for i in range(4)})
    return made


def test_what_is_saved_is_there_in_another_process(store):
    store.save(Record("k1", outcome='{"x": 1}', seconds=0.25))
    store.save(Record("k2", outcome="", failure="collision"))
    again = Store(store.path)
    assert again.records() == {
        "k1": Record("k1", '{"x": 1}', "", 0.25),
        "k2": Record("k2", "", "collision", 0.0),
    }
    assert again.pending() == ("k0", "k3")
    assert list(again.cases()) == ["k0", "k1", "k2", "k3"]


def test_a_record_is_never_replaced(store):
    store.save(Record("k1", outcome="first"))
    store.save(Record("k1", outcome="second"))
    store.add_cases({"k1": "other inputs"})
    assert store.records()["k1"].outcome == "first"
    assert store.cases()["k1"] == "inputs 1"


def test_a_forgotten_record_is_pending_again(store):
    store.save(Record("k1", outcome="", failure="out of memory"))
    store.forget(["k1"])
    assert "k1" in store.pending()
    assert store.records() == {}


def test_a_record_needs_its_case(store):
    with pytest.raises(StoreError, match="FOREIGN KEY"):
        store.save(Record("unknown", outcome="1"))


WRITER = """
import sys
from canon.study.cases.store import Record, Store
store = Store(sys.argv[1])
for i in range(40):
    store.add_cases({f"{i}": "shared", f"{sys.argv[2]}-{i}": "own"})
    store.save(Record(f"{i}", outcome="the same"))
    store.save(Record(f"{sys.argv[2]}-{i}", outcome="own"))
"""


@pytest.mark.slow
def test_two_processes_on_one_new_file(tmp_path):
    path = tmp_path / "shared.sqlite"
    writers = [subprocess.Popen([sys.executable, "-c", WRITER, str(path), name]) for name in "ab"]
    assert [writer.wait() for writer in writers] == [0, 0]
    assert len(Store(path).records()) == 120
    assert Store(path).pending() == ()


def test_a_file_of_another_kind_is_refused_and_left_alone(tmp_path):
    text = tmp_path / "notes.txt"
    text.write_text("these are my notes, " * 100)
    with pytest.raises(StoreError, match="it is no SQLite file; give another file"):
        Store(text)
    assert text.read_text() == "these are my notes, " * 100
    foreign = tmp_path / "other.sqlite"
    with closing(sqlite3.connect(foreign)) as connection:
        connection.execute("CREATE TABLE theirs (x)")
    with pytest.raises(StoreError, match="another program"):
        Store(foreign)
    with closing(sqlite3.connect(foreign)) as connection:
        assert connection.execute("SELECT count(*) FROM sqlite_master").fetchone() == (1,)


def test_a_damaged_file_is_refused(store):
    store.add_cases({f"long {i}": "x" * 500 for i in range(200)})
    damaged = bytearray(store.path.read_bytes())
    damaged[8192:12288] = os.urandom(4096)
    store.path.write_bytes(damaged)
    with pytest.raises(StoreError, match="damaged"):
        Store(store.path)


def test_a_file_of_a_later_version_is_refused(store):
    with closing(sqlite3.connect(store.path)) as connection:
        connection.execute("PRAGMA user_version = 99")
    with pytest.raises(StoreError, match="another version of canon"):
        Store(store.path)


def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(StoreError, match="check that the folder exists"):
        Store(tmp_path / "nowhere" / "study.sqlite")


READ_ONLY = """
import os, sys
from canon.study.cases.store import Record, Store, StoreError
if os.geteuid() == 0:
    os.setegid(65534)
    os.seteuid(65534)
store = Store(sys.argv[1])
assert store.records()["k"].outcome == "kept"
try:
    store.save(Record("l", outcome="new"))
except StoreError as error:
    print(error)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="folders are closed to writing as POSIX does")
def test_a_read_only_file_can_be_read_and_says_so_when_written():
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "study.sqlite"
        store = Store(path)
        store.add_cases({"k": "", "l": ""})
        store.save(Record("k", outcome="kept"))
        path.chmod(0o444)
        Path(folder).chmod(0o555)
        code = [sys.executable, "-c", READ_ONLY, str(path)]
        done = subprocess.run(code, capture_output=True, text=True, check=True, env={**os.environ})
        Path(folder).chmod(0o755)
        assert "it can't be written; check its permissions" in done.stdout
        assert store.pending() == ("l",)


FULL_DISK = """
import resource, sys
from canon.study.cases.store import Record, Store, StoreError
store = Store(sys.argv[1])
limit = store.path.stat().st_size + 40_000
resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
saved = 0
try:
    for i in range(1000):
        store.save(Record(f"{i}", outcome="x" * 1000))
        saved += 1
except StoreError as error:
    print(saved, error)
"""


@pytest.mark.skipif(
    sys.platform == "win32", reason="no limit on the size of files stands in for a full disk there"
)
def test_a_full_disk_loses_nothing_that_was_finished(tmp_path):
    """A limit on the size of files stands in for a full disk."""
    store = Store(tmp_path / "study.sqlite")
    store.add_cases({f"{i}": "" for i in range(1000)})
    code = [sys.executable, "-c", FULL_DISK, str(store.path)]
    done = subprocess.run(code, capture_output=True, text=True, check=True)
    saved, message = done.stdout.split(" ", 1)
    assert 5 < int(saved) < 1000
    assert "what was finished before is kept" in message
    again = Store(store.path)
    assert len(again.records()) == int(saved)
    again.save(Record("999", outcome="after making room"))
    assert len(again.pending()) == 999 - int(saved)


def test_a_checkpoint_goes_forward_only_and_leaves_with_the_record(store):
    store.save_checkpoint("k1", 3, "after three")
    store.save_checkpoint("k1", 2, "after two, from a slower process")
    assert (store.checkpoint("k1"), store.parts_done()) == ("after three", {"k1": 3})
    store.save_checkpoint("k1", 5, "after five")
    assert store.checkpoint("k1") == "after five"
    assert store.counts() == (0, 0, 4, 1)
    store.save(Record("k1", outcome="done"))
    store.save_checkpoint("k1", 6, "from a process that did not see it end")
    assert (store.checkpoint("k1"), store.parts_done()) == (None, {})
    assert store.is_finished("k1")
    assert not store.is_finished("k2")
    store.save(Record("k2", outcome="", failure="collision"))
    assert store.counts() == (1, 1, 2, 0)


def test_files_of_several_jobs_become_one(tmp_path, store):
    other = Store(tmp_path / "other.sqlite")
    other.add_cases({"k0": "inputs 0", "k1": "inputs 1", "new": "inputs of another study"})
    other.save(Record("k0", outcome="from there", seconds=1.5))
    other.save(Record("k1", outcome="from there"))
    store.save(Record("k1", outcome="from here"))
    store.save_checkpoint("k0", 1, "on the way")
    store.add_from(other)
    assert {key: record.outcome for key, record in store.records().items()} == {
        "k0": "from there",
        "k1": "from here",
    }
    assert store.records()["k0"].seconds == 1.5
    assert store.pending() == ("k2", "k3", "new")
    assert store.parts_done() == {}
    store.add_from(other)
    assert len(store.cases()) == 5


KILLED = """
import sys
from canon.study.cases.store import Store
store = Store(sys.argv[1])
with store._writing() as connection:
    connection.execute("UPDATE cases SET inputs = 'half done'")
    connection.execute("PRAGMA cache_spill = 1")
    print("writing", flush=True)
    sys.stdin.read()
"""


def test_killed_inside_a_transaction_nothing_of_it_stays(store):
    store.save_checkpoint("k1", 1, "kept")
    code = [sys.executable, "-c", KILLED, str(store.path)]
    with subprocess.Popen(code, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as program:
        assert program.stdout.readline() == b"writing\n"
        program.kill()
        program.wait()
    assert Store(store.path).cases() == {f"k{i}": f"inputs {i}" for i in range(4)}
    assert store.checkpoint("k1") == "kept"


def test_files_joined_keep_what_is_begun_and_of_two_the_further(store, tmp_path):
    other = Store(tmp_path / "other.sqlite")
    other.add_cases({f"k{i}": f"inputs {i}" for i in range(6)})
    for key, part in (("k0", 3), ("k1", 2), ("k2", 5), ("k5", 7)):
        other.save_checkpoint(key, part, f"other at {part}")
    other.save(Record("k4", outcome="done there"))
    store.save(Record("k0", outcome="done here"))
    store.save_checkpoint("k1", 4, "here at 4")
    store.save_checkpoint("k2", 1, "here at 1")
    store.save_checkpoint("k3", 1, "here alone")
    store.add_from(other)
    assert store.parts_done() == {"k1": 4, "k2": 5, "k3": 1, "k5": 7}
    assert [store.checkpoint(f"k{i}") for i in range(6)] == [
        None, "here at 4", "other at 5", "here alone", None, "other at 7",
    ]  # fmt: skip
    assert set(store.records()) == {"k0", "k4"}
    store.add_from(other)
    assert store.parts_done() == {"k1": 4, "k2": 5, "k3": 1, "k5": 7}


def test_an_error_after_sqlite_itself_rolled_back_is_told_as_it_is(tmp_path):
    store = Store(tmp_path / "study.sqlite")
    store.add_cases({"a": "first"})
    with pytest.raises(StoreError, match="UNIQUE constraint failed"), store._writing() as connection:
        connection.execute("INSERT OR ROLLBACK INTO cases SELECT * FROM cases")
    assert set(store.cases()) == {"a"}


def test_a_table_that_another_process_has_made_meanwhile_is_not_made_again(tmp_path):
    store = Store(tmp_path / "study.sqlite")
    store.add_cases({"a": "first"})
    with store._open() as connection:
        _add_tags_table(store.path, connection)
    assert set(store.cases()) == {"a"}
