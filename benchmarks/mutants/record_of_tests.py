"""The record of what tests execute: for every line of canon the tests that run it, and how long each of them takes.

Tests are run place by place under coverage.py, so that what is there is used while the rest is still to come. A line
that runs when its module is imported belongs to no test; neither does one in a child process. For those there are the
tests that execute something else of the module, then those of the room.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import defaultdict
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from coverage import CoverageData

from mutants.recording import INTO

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["Record", "places_of_tests", "read_record", "record_place"]

_PATIENCE = 3600.0
"""Seconds for the tests of a place; those of one that has not ended then are told by their names alone."""
_ABOUT_THE_TEXT = ("tests/test_architecture", "tests/test_where_things_are", "tests/test_project_files")
"""Tests that read canon's sources as text: a mutant that they notice has not been noticed by what it does."""


@dataclass
class Record:
    """Who executes what: the tests of each line of each file, and what is known of each test."""

    tests_of: dict[str, dict[int, set[str]]] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
    long: set[str] = field(default_factory=set)
    """Tests that were cut short."""
    unfit: set[str] = field(default_factory=set)
    """Tests that fail without any change."""

    def of_line(self, file: str, line: int) -> list[str]:
        """Return the tests that execute a line, the quickest first, those that take long at the end."""
        return self._in_order(self.tests_of.get(file, {}).get(line, ()))

    def of_file(self, file: str) -> list[str]:
        """Return the tests that execute anything in a module."""
        return self._in_order(set[str]().union(*self.tests_of.get(file, {}).values()))

    def of_room(self, room: str) -> list[str]:
        """Return the tests of a room."""
        folder = f"tests/{room}/" if room != "top level" else "tests/test_"
        return self._in_order(test for test in self.seconds if test.startswith(folder))

    def _in_order(self, tests: Iterable[str]) -> list[str]:
        fit = [t for t in tests if t not in self.unfit and not t.startswith(_ABOUT_THE_TEXT)]
        return sorted(fit, key=lambda test: (test in self.long, self.seconds.get(test, 0.0), test))


def places_of_tests(home: Path) -> dict[str, list[str]]:
    """Return what pytest is given in turn: the tests of each room, those beside the rooms, the examples."""
    rooms = sorted(path.name for path in (home / "tests").iterdir() if any(path.glob("test_*.py")))
    beside = sorted(path.relative_to(home).as_posix() for path in (home / "tests").glob("test_*.py"))
    return {room: [f"tests/{room}"] for room in rooms} | {"top": beside, "doc": ["canon"]}


def record_place(home: Path, place: str, tests: list[str], into: Path) -> None:
    """Run the tests of a place under coverage.py; nothing where that was done before."""
    into.mkdir(parents=True, exist_ok=True)
    coverage, seconds = into / f"{place}.cov", into / f"{place}.dur"
    if coverage.exists():
        return
    seconds.unlink(missing_ok=True)
    config = into / "coveragerc"
    config.write_text("[run]\nsource = canon\ncore = ctrace\n", encoding="utf-8")
    search = os.pathsep.join([str(home), str(Path(__file__).parents[1])])
    known = {"PYTHONPATH": search, INTO: str(seconds), "COVERAGE_FILE": str(coverage), "CI": "true"}
    options = (
        f"-q -p no:cacheprovider -p mutants.recording --cov=canon --cov-config={config} --cov-context=test"
    )
    command = [sys.executable, "-m", "pytest", *options.split(), "--cov-report=", *tests]
    with (into / f"{place}.log").open("w", encoding="utf-8") as log, suppress(subprocess.TimeoutExpired):
        subprocess.run(
            command,
            cwd=home,
            env={**os.environ, **known},
            stdout=log,
            stderr=log,
            check=False,
            timeout=_PATIENCE,
        )


def read_record(into: Path) -> Record:
    """Return what has been recorded so far."""
    record = Record(tests_of=defaultdict(lambda: defaultdict(set)))
    for path in sorted(into.glob("*.dur")):
        _read_seconds(path, record)
    for path in sorted(into.glob("*.cov")):
        data = CoverageData(basename=str(path))
        data.read()
        for measured in data.measured_files():
            lines = record.tests_of["canon/" + measured.rpartition("/canon/")[2]]
            for line, contexts in data.contexts_by_lineno(measured).items():
                lines[line].update(context.partition("|")[0] for context in contexts if context)
    return record


def _read_seconds(path: Path, record: Record) -> None:
    for line in path.read_text(encoding="utf-8").splitlines():
        test, _, outcome, seconds, cut = json.loads(line)
        record.seconds[test] = record.seconds.get(test, 0.0) + seconds
        if cut:
            record.long.add(test)
        elif outcome != "passed":
            record.unfit.add(test)
