"""The tests that a mutant meets, in their order: those of its room first, the quickest first, up to a bound of time."""

from __future__ import annotations

import ast
from collections import Counter
from typing import TYPE_CHECKING

from mutants.sampling import Mutant, room_of

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from mutants.record_of_tests import Record

__all__ = ["quickest", "tests_for"]

_OF_THE_LINE = 15.0
_OF_THE_FILE = 5.0
_OF_THE_ROOM = 8.0
_LONG_TESTS = 2
_SECONDS_OF_LONG_ONES = 5.0
_FIRST, _FILES = 3.0, 3
_ALIKE = 3
"""So many parameters of one test are tried before other tests are; the rest of them follow."""


def tests_for(mutant: Mutant, record: Record, home: Path, first: Iterable[str]) -> dict[str, float]:
    """Return the tests in their order, with the seconds that each took on the record.

    Parameters
    ----------
    mutant
        The change.
    record
        What tests execute.
    home
        The checkout.
    first
        Tests that are known to fail, whether they are on the record or not.
    """
    found = dict.fromkeys(first, 3.0)
    here = f"tests/{room_of(mutant.file)}/", mutant.file
    of_lines: dict[str, None] = {}
    for line in _lines(home / mutant.file, mutant.line):
        of_lines |= dict.fromkeys(record.of_line(mutant.file, line))
    quick = [test for test in of_lines if test not in record.long]
    own, others = _parted(quick, here)
    _take(own, 0.6 * _OF_THE_LINE, record, found)
    _take(others, 0.4 * _OF_THE_LINE, record, found)
    of_file = [test for test in record.of_file(mutant.file) if test not in record.long]
    own, others = _parted(of_file, here)
    _take([*own, *others], _OF_THE_FILE, record, found)
    if len(found) < _ALIKE:
        room = [test for test in record.of_room(room_of(mutant.file)) if test not in record.long]
        _take(room, _OF_THE_ROOM, record, found)
    long = [test for test in of_lines if test in record.long]
    own, others = _parted(long, here)
    return found | dict.fromkeys([*own, *others][:_LONG_TESTS], _SECONDS_OF_LONG_ONES)


def quickest(tests: dict[str, float]) -> dict[str, float]:
    """Return the tests that are tried before any other: a few seconds of those at the beginning, from few files."""
    found: dict[str, float] = {}
    files: set[str] = set()
    for test, seconds in tests.items():
        files.add(test.partition("::")[0])
        if found and (len(files) > _FILES or sum(found.values()) + seconds > _FIRST):
            break
        found[test] = seconds
    return found


def _parted(tests: list[str], here: tuple[str, ...]) -> tuple[list[str], list[str]]:
    own = [test for test in tests if test.startswith(here)]
    return own, [test for test in tests if not test.startswith(here)]


def _take(tests: list[str], seconds: float, record: Record, into: dict[str, float]) -> None:
    """Add tests until their time is over, first a few parameters of each."""
    count = Counter[str]()
    early, late = list[str](), list[str]()
    for test in tests:
        function = test.partition("[")[0]
        (late if count[function] >= _ALIKE else early).append(test)
        count[function] += 1
    for test in [*early, *late]:
        if test not in into:
            seconds -= record.seconds.get(test, 0.0)
            if seconds < 0:
                return
            into[test] = record.seconds.get(test, 0.0)


def _lines(path: Path, line: int) -> range:
    """Return the lines of the smallest statement with a line, of its head where it has a body."""
    around = range(line, line + 1)
    size = float("inf")
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.stmt):
            body = getattr(node, "body", None)
            end = body[0].lineno - 1 if body else node.end_lineno or node.lineno
            if node.lineno <= line <= max(end, node.lineno) and end - node.lineno < size:
                size = end - node.lineno
                around = range(node.lineno, max(end, node.lineno) + 1)
    return around
