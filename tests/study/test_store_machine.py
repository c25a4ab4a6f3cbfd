"""Whatever is done to a results file, in whatever order, it holds what a plain dictionary would.

A machine of hypothesis adds cases, saves records and checkpoints, forgets, merges another file, breaks writes off in
mid-transaction, kills a process that writes, damages rows and mends them, runs a small study, breaks it off and resumes
it, and compares with dictionaries each time.
"""

from __future__ import annotations

import json
import math
import os
import sqlite3
import subprocess
import sys
import tempfile
from contextlib import closing, suppress
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)

from canon import Splitting
from canon.study.cases.case import key_of
from canon.study.cases.checkpointed_run import Checkpoint
from canon.study.cases.mend import mend
from canon.study.cases.run_study import resume, run_study
from canon.study.cases.store import DamagedRows, Record, Store
from canon.study.cases.study import Study
from canon.study.errors import StudyError

if TYPE_CHECKING:
    from canon.study.cases.run_study import StudyStatus

NAMES = [f"k{i}" for i in range(6)]
THERE = NAMES[:3]
"""Cases that both files have from the beginning, so that most of what is done concerns the same ones."""
KEYS, KNOWN = st.sampled_from(NAMES), st.sampled_from(THERE)
TEXTS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=12)

PARTS = 3
STUDY = Study.of(
    system="henon-heiles", method=Splitting("verlet"), step=[0.1, 0.05], span=25.6, samples=256, parts=PARTS
)
RUNS = {key_of(case): case.to_text() for case in STUDY.cases}
"""The cases of a study that is run on the files: the only ones there that can be run."""

IN_MEMORY = "/dev/shm" if Path("/dev/shm").is_dir() else None
"""Where nothing waits for a disk."""

KILLED = """
import os, sys
from canon.study.cases.store import Record, Store
store = Store(sys.argv[1])
store.save(Record(sys.argv[2], outcome="never kept"), before=lambda: os.kill(os.getpid(), 9))
"""


class _PowerCut(Exception):
    """Ends a transaction in the middle, or a run between two of its saves."""


def timeless(point: str) -> str:
    """Return a checkpoint of a run without what the clock says."""
    said: dict[str, Any] = json.loads(point)
    return json.dumps({name: value for name, value in said.items() if name != "seconds"})


@cache
def ends_of_runs() -> dict[str, str]:
    """Return the outcome of each case of the study, run in one go."""
    with tempfile.TemporaryDirectory(dir=IN_MEMORY) as folder:
        store = Store(Path(folder) / "whole.sqlite")
        assert run_study(STUDY, store, checkpoint_seconds=math.inf).finished == len(RUNS)
        return {key: record.outcome for key, record in store.records().items()}


@cache
def points_of_runs() -> dict[tuple[str, int], str]:
    """Return the checkpoints of each case by the parts that are done."""
    points: dict[tuple[str, int], str] = {}
    with tempfile.TemporaryDirectory(dir=IN_MEMORY) as folder:
        store = Store(Path(folder) / "points.sqlite")

        def seen(_: StudyStatus) -> None:
            points.update({(key, part): timeless(point) for key, part, point in store.checkpoints()})

        run_study(STUDY, store, progress=seen, checkpoint_seconds=0.0)
    assert len(points) == len(RUNS) * (PARTS - 1)
    return points


class Model:
    """What a file should hold."""

    def __init__(self) -> None:
        self.cases: dict[str, str] = {}
        self.records: dict[str, tuple[str, str]] = {}
        self.points: dict[str, tuple[int, str]] = {}
        self.tags: dict[str, list[str]] = {}

    def save(self, key: str, outcome: str, failure: str) -> None:
        self.records.setdefault(key, (outcome, failure))
        self.points.pop(key, None)

    def checkpoint(self, key: str, part: int, point: str) -> None:
        if key not in self.records and part > self.points.get(key, (-1, ""))[0]:
            self.points[key] = part, point

    def tag(self, key: str, word: str) -> None:
        if word not in self.tags.setdefault(key, []):
            self.tags[key].append(word)

    def run(self, saves: float) -> None:
        """Run the study on, until it has saved so many times."""
        for key in RUNS:
            while saves and key in self.cases and key not in self.records:
                part = self.points.get(key, (0, ""))[0] + 1
                if part < PARTS:
                    self.checkpoint(key, part, points_of_runs()[key, part])
                else:
                    self.save(key, ends_of_runs()[key], "")
                saves -= 1

    def add_from(self, other: Model) -> None:
        for key, inputs in other.cases.items():
            self.cases.setdefault(key, inputs)
        for key, (outcome, failure) in other.records.items():
            self.records.setdefault(key, (outcome, failure))
        for key in self.records:
            self.points.pop(key, None)
        for key, (part, point) in other.points.items():
            self.checkpoint(key, part, point)
        for key, words in other.tags.items():
            for word in words:
                self.tag(key, word)


class StoreMachine(RuleBasedStateMachine):
    """Two files and what they should hold."""

    @initialize()
    def start(self) -> None:
        self.folder = tempfile.TemporaryDirectory(dir=IN_MEMORY)
        self.paths = [Path(self.folder.name) / f"{name}.sqlite" for name in "ab"]
        self.models = [Model(), Model()]
        self.damaged: set[tuple[int, str, str]] = set()
        for path, model in zip(self.paths, self.models, strict=True):
            model.cases = {key: f"inputs of {key}" for key in THERE}
            Store(path).add_cases(model.cases)

    def teardown(self) -> None:
        if hasattr(self, "folder"):
            self.folder.cleanup()

    @rule(which=st.integers(0, 1), cases=st.dictionaries(KEYS, TEXTS, max_size=3))
    def add_cases(self, which: int, cases: dict[str, str]) -> None:
        Store(self.paths[which]).add_cases(cases)
        for key, inputs in cases.items():
            self.models[which].cases.setdefault(key, inputs)

    @rule(which=st.integers(0, 1), key=KNOWN, word=TEXTS)
    def add_tag(self, which: int, key: str, word: str) -> None:
        Store(self.paths[which]).add_tags({key: [word]})
        self.models[which].tag(key, word)

    @rule(which=st.integers(0, 1), key=KNOWN, outcome=TEXTS, failure=TEXTS)
    def save(self, which: int, key: str, outcome: str, failure: str) -> None:
        Store(self.paths[which]).save(Record(key, outcome, failure))
        self._healed(which, "checkpoints", key)
        self.models[which].save(key, outcome, failure)

    @rule(which=st.integers(0, 1), key=KNOWN, part=st.integers(0, 5), point=TEXTS)
    def save_checkpoint(self, which: int, key: str, part: int, point: str) -> None:
        if (which, "checkpoints", key) not in self.damaged:
            Store(self.paths[which]).save_checkpoint(key, part, point)
            self.models[which].checkpoint(key, part, point)

    @rule(which=st.integers(0, 1), saves=st.integers(1, len(RUNS) * PARTS))
    def run_a_study(self, which: int, saves: int) -> None:
        """Until it has saved so many times, or to its end where that comes first."""
        if self._is_damaged(which):
            with pytest.raises(DamagedRows, match="mend"):
                run_study(STUDY, self.paths[which])
            return
        left = saves

        def cut(_: StudyStatus) -> None:
            nonlocal left
            left -= 1
            if not left:
                raise _PowerCut

        with suppress(_PowerCut):
            run_study(STUDY, self.paths[which], progress=cut, checkpoint_seconds=0.0)
        for key, inputs in RUNS.items():
            self.models[which].cases.setdefault(key, inputs)
        self.models[which].run(saves)

    @rule(which=st.integers(0, 1), are_done=st.booleans())
    def resume(self, which: int, are_done: bool) -> None:
        """Run what is pending, where it can be run: the others may be done before."""
        if self._is_damaged(which):
            with pytest.raises(DamagedRows, match="mend"):
                resume(self.paths[which])
            return
        model = self.models[which]
        others = [key for key in model.cases if key not in RUNS and key not in model.records]
        if others and not are_done:
            with pytest.raises(StudyError, match="not the inputs of a case"):
                resume(self.paths[which])
            return
        for key in others:
            self.save(which, key, "done", "")
        assert resume(self.paths[which], checkpoint_seconds=math.inf).pending == 0
        model.run(math.inf)

    @rule(which=st.integers(0, 1), key=st.sampled_from([*THERE, *RUNS]))
    def forget(self, which: int, key: str) -> None:
        Store(self.paths[which]).forget([key])
        self._healed(which, "records", key)
        self.models[which].records.pop(key, None)

    @rule(which=st.integers(0, 1), key=KNOWN, outcome=TEXTS)
    def a_write_breaks_off(self, which: int, key: str, outcome: str) -> None:
        def cut() -> None:
            raise _PowerCut

        with pytest.raises(_PowerCut):
            Store(self.paths[which]).save(Record(key, outcome), before=cut)

    @rule(which=st.integers(0, 1))
    def merge(self, which: int) -> None:
        here, there = Store(self.paths[which]), Store(self.paths[1 - which])
        if self.damaged:
            with pytest.raises(DamagedRows):
                here.add_from(there)
            return
        here.add_from(there)
        self.models[which].add_from(self.models[1 - which])

    @rule(which=st.integers(0, 1), table=st.sampled_from(["records", "checkpoints"]), data=st.data())
    def damage(self, which: int, table: str, data: st.DataObject) -> None:
        model = self.models[which]
        rows = sorted(model.records if table == "records" else model.points)
        if not rows:
            return
        key, column = data.draw(st.sampled_from(rows)), "outcome" if table == "records" else "point"
        with closing(sqlite3.connect(self.paths[which])) as connection, connection:
            done = connection.execute(f"UPDATE {table} SET {column} = {column} || '!' WHERE key = ?", (key,))
            assert done.rowcount == 1
        self.damaged.add((which, table, key))

    @rule(which=st.integers(0, 1))
    def mend(self, which: int) -> None:
        hurt = {(table, key) for where, table, key in self.damaged if where == which}
        found = mend(self.paths[which])
        assert {(row.table, row.key) for row in found.lost} == hurt
        assert (found.aside is not None) == bool(hurt)
        for table, key in hurt:
            (self.models[which].records if table == "records" else self.models[which].points).pop(key)
        self.damaged = {each for each in self.damaged if each[0] != which}

    def _is_damaged(self, which: int) -> bool:
        return any(where == which for where, _, _ in self.damaged)

    def _healed(self, which: int, table: str, key: str) -> None:
        """A row that is gone is damaged no more."""
        self.damaged.discard((which, table, key))

    @invariant()
    def the_files_hold_what_they_should(self) -> None:
        if not hasattr(self, "folder"):
            return
        for which, (path, model) in enumerate(zip(self.paths, self.models, strict=True)):
            store = Store(path)
            hurt = {(table, key) for where, table, key in self.damaged if where == which}
            assert {(row.table, row.key) for row in store.damaged()} == hurt
            assert store.cases() == model.cases
            assert list(store.pending()) == [key for key in store.cases() if key not in model.records]
            assert {key: sorted(words) for key, words in store.tags().items()} == {
                key: sorted(words) for key, words in model.tags.items()
            }
            failed = sum(bool(failure) for _, failure in model.records.values())
            counted = (
                len(model.records) - failed,
                failed,
                len(model.cases) - len(model.records),
                len(model.points),
            )
            assert store.counts() == counted
            self._rows_agree(store, model, hurt)

    def _rows_agree(self, store: Store, model: Model, hurt: set[tuple[str, str]]) -> None:
        if any(table == "records" for table, _ in hurt):
            with pytest.raises(DamagedRows, match="mend"):
                store.records()
        else:
            assert {k: (r.outcome, r.failure) for k, r in store.records().items()} == model.records
        if any(table == "checkpoints" for table, _ in hurt):
            with pytest.raises(DamagedRows, match="mend"):
                store.checkpoints()
        else:
            points = {
                key: (part, timeless(point) if key in RUNS else point)
                for key, part, point in store.checkpoints()
            }
            assert points == model.points


class KilledStoreMachine(StoreMachine):
    """The same, with processes that are killed in mid-transaction."""

    @precondition(lambda self: hasattr(self, "folder"))
    @rule(which=st.integers(0, 1), key=KNOWN)
    def a_process_is_killed(self, which: int, key: str) -> None:
        done = subprocess.run([sys.executable, "-c", KILLED, str(self.paths[which]), key], check=False)
        assert done.returncode == -9


QUIET = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])


def test_a_file_holds_what_a_dictionary_would() -> None:
    run_state_machine_as_test(StoreMachine, settings=settings(QUIET, max_examples=4, stateful_step_count=15))


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are killed by a signal")
def test_a_file_holds_it_whoever_is_killed() -> None:
    run_state_machine_as_test(
        KilledStoreMachine, settings=settings(QUIET, max_examples=30, stateful_step_count=40)
    )


@pytest.mark.slow
def test_a_file_holds_it_in_long_histories() -> None:
    run_state_machine_as_test(StoreMachine, settings=settings(QUIET, max_examples=50, stateful_step_count=40))


FOUND_OUT = settings(
    QUIET, max_examples=60, stateful_step_count=30, derandomize=True, report_multiple_bugs=False,
    phases=[Phase.generate],
)  # fmt: skip
"""Histories enough for what a wrong twin does to be met."""


def test_a_store_that_replaces_records_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """The wrong twin."""
    from canon.study.cases import store

    monkeypatch.setattr(store, "ADD_RECORD", store.ADD_RECORD.replace("IGNORE", "REPLACE"))
    with pytest.raises(AssertionError):
        run_state_machine_as_test(StoreMachine, settings=FOUND_OUT)


def test_a_run_that_goes_on_without_its_last_digits_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """The wrong twin of resuming: the low part of the state is lost with the checkpoint."""
    whole = Checkpoint.from_text

    def rounded(text: str) -> Checkpoint:
        found = whole(text)
        return replace(found, carried=(0.0,) * len(found.carried))

    monkeypatch.setattr(Checkpoint, "from_text", staticmethod(rounded))
    with pytest.raises(AssertionError):
        run_state_machine_as_test(StoreMachine, settings=FOUND_OUT)
