"""The tests that a mutant meets, in their order: those of its room first, the quickest first, up to a bound of time."""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

from mutants.sampling import Mutant, room_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from mutants.record_of_tests import Record

__all__ = ["quickest", "tests_for", "tests_once_more"]

_OF_THE_LINE, _OF_THE_FILE, _OF_THE_ROOM = 8.0, 2.0, 8.0
"""Seconds of tests that execute the line, others that execute something of the module, and others of the room."""
_LONG_TEST = 5.0
_FIRST, _FILES = 3.0, 3
_ALIKE = 3
"""So many parameters of one test are tried before other tests are; the rest of them follow."""
_FULL_TIME = 10.0


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
    found = dict.fromkeys(first, _LONG_TEST)
    of_line = _of_line(mutant, record, home)
    own, others = _parted([test for test in of_line if test not in record.long], mutant)
    _take(own, 0.6 * _OF_THE_LINE, record, found)
    _take(others, 0.4 * _OF_THE_LINE, record, found)
    own, others = _parted([t for t in record.of_file(mutant.file) if t not in record.long], mutant)
    _take([*own, *others], _OF_THE_FILE, record, found)
    if len(found) < _ALIKE:
        room = [test for test in record.of_room(room_of(mutant.file)) if test not in record.long]
        _take(room, _OF_THE_ROOM, record, found)
    own, others = _parted([test for test in of_line if test in record.long], mutant)
    return found | dict.fromkeys([*own, *others][:1], _LONG_TEST)


def tests_once_more(mutant: Mutant, record: Record, home: Path) -> dict[str, float]:
    """Return the tests for a survivor: with all their parameters, those that take long, and whole files of tests.

    A name without parameters stands for all of them, one of a file for all of its tests. The files are those that name
    something that the module offers, in the mutant's room and among the examples in docstrings.
    """
    own, others = _parted(_of_line(mutant, record, home), mutant)
    found = dict.fromkeys((test.partition("[")[0] for test in own), _FULL_TIME)
    found |= dict.fromkeys(_files_that_name(mutant, home), _FULL_TIME)
    found |= dict.fromkeys((test.partition("[")[0] for test in others), _FULL_TIME)
    return found | dict.fromkeys((test.partition("[")[0] for test in record.of_file(mutant.file)), _FULL_TIME)


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


def _files_that_name(mutant: Mutant, home: Path) -> list[str]:
    """Return the files of tests that import something from the module, or name it, the most of it first.

    Where the module's folder inside its room has a folder of tests too, these follow.
    """
    tree = ast.parse((home / mutant.file).read_text(encoding="utf-8"))
    names = [n.name for n in tree.body if isinstance(n, ast.FunctionDef | ast.ClassDef) and n.name[0] != "_"]
    module = mutant.file.removesuffix(".py").replace("/", ".")
    room = room_of(mutant.file)
    folder = home / "tests" / room
    paths = folder.rglob("test_*.py") if folder.exists() else (home / "tests").glob("test_*.py")
    found = list[tuple[int, str]]()
    for path in sorted(paths):
        text = path.read_text(encoding="utf-8")
        count = 5 * text.count(module) + sum(f"{name}(" in text for name in names)
        found += [(-count, path.relative_to(home).as_posix())] if count else []
    inner = home / "tests" / Path(mutant.file).parent.relative_to("canon")
    while room in inner.parent.parts and not inner.exists():
        inner = inner.parent
    beside = inner.rglob("test_*.py") if inner.exists() and inner != folder else ()
    near = (path.relative_to(home).as_posix() for path in sorted(beside))
    return [*dict.fromkeys([mutant.file, *(path for _, path in sorted(found)), *near])]


def _of_line(mutant: Mutant, record: Record, home: Path) -> list[str]:
    found: dict[str, None] = {}
    for line in _lines(home / mutant.file, mutant.line):
        found |= dict.fromkeys(record.of_line(mutant.file, line))
    return [*found]


def _parted(tests: list[str], mutant: Mutant) -> tuple[list[str], list[str]]:
    """Part tests into those of the mutant's room and module, and others."""
    here = f"tests/{room_of(mutant.file)}/", mutant.file
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
