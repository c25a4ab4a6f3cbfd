"""Damaged and foreign results files: cut, mixed, of other studies and programs, on disks that take nothing more."""

from __future__ import annotations

import random
import resource
import shutil
import signal
import sqlite3
from contextlib import closing, contextmanager
from typing import TYPE_CHECKING

from canon.study.cases.run_study import run_study
from canon.study.cases.study import Study

from .bits import _after_mending, _exported, _made
from .count import Count, command

if TYPE_CHECKING:
    from collections.abc import Generator
    from pathlib import Path

OTHER = Study.of(system="kepler", method="verlet", step=0.02, span=20.0, samples=512, parts=4)
PAGE = 4096

DATABASE = (
    "DROP TABLE tags",
    "DROP TABLE records",
    "ALTER TABLE cases ADD COLUMN more TEXT",
    "CREATE TABLE more (x)",
    "CREATE TRIGGER t AFTER INSERT ON records BEGIN DELETE FROM cases; END",
    "CREATE VIEW v AS SELECT * FROM records",
    "PRAGMA user_version = 3",
    "PRAGMA user_version = 99",
    "PRAGMA application_id = 7",
    "PRAGMA journal_mode = WAL",
    "DELETE FROM cases",
    "UPDATE records SET outcome = (SELECT outcome FROM records LIMIT 1)",
    "UPDATE records SET key = 'x' || key",
    "UPDATE checkpoints SET part = part + 1",
    "UPDATE checkpoints SET point = (SELECT max(point) FROM checkpoints)",
    "UPDATE cases SET inputs = replace(inputs, '0.01', '0.02')",
    "UPDATE records SET checksum = ''",
    "UPDATE records SET seconds = 9e999",
    "INSERT INTO records SELECT 'no case', failure, outcome, seconds, finished, checksum FROM records LIMIT 1",
    "INSERT INTO cases VALUES ('k', zeroblob(0) || 'x', 'y')",
)
"""Changes by another program; foreign keys are not looked at."""


def hostile_stores(count: int, folder: Path, seed: int = 1) -> Count:
    """Change a results file, use it, and mend it."""
    found, draw = Count("results files cut, mixed, changed by others or on full disks"), random.Random(seed)
    path, whole, expected = _made(folder)
    run_study(OTHER, folder / "other.sqlite")
    other = (folder / "other.sqlite").read_bytes()
    for number in range(count):
        for old in folder.glob("study.*"):
            shutil.rmtree(old) if old.is_dir() else old.unlink()
        path.write_bytes(whole)
        what = draw.choice((*DATABASE, *CHANGES, "full disk", "rows of another study"))
        if what == "full disk":
            outcome = _on_a_full_disk(path, expected, draw)
        else:
            if what in CHANGES:
                path.write_bytes(CHANGES[what](whole, other, draw))
            elif what == "rows of another study":
                _rows_of_another(path, folder / "other.sqlite")
            else:
                _sql(path, what)
            outcome = _outcome(path, expected)
        found.add(outcome, f"seed {seed}, attack {number}: {what}")
    return found


CHANGES = {
    "cut": lambda whole, _, draw: whole[: draw.randrange(len(whole))],
    "cut to pages": lambda whole, _, draw: whole[: PAGE * draw.randrange(1 + len(whole) // PAGE)],
    "more behind": lambda whole, _, draw: whole + draw.randbytes(draw.randrange(1, 3 * PAGE)),
    "pages exchanged": lambda whole, _, draw: _exchanged(whole, whole, draw),
    "a page of another file": lambda whole, other, draw: _exchanged(whole, other, draw),
    "a page of nothing": lambda whole, _, draw: _exchanged(whole, bytes(len(whole)), draw),
    "noise": lambda whole, _, draw: draw.randbytes(len(whole)),
    "nothing": lambda *_: b"",
    "a text": lambda *_: b"[[study]]\n" * 1000,
    "a header and noise": lambda whole, _, draw: whole[:100] + draw.randbytes(len(whole) - 100),
}


def _exchanged(whole: bytes, other: bytes, draw: random.Random) -> bytes:
    pages = [whole[at : at + PAGE] for at in range(0, len(whole), PAGE)]
    pages[draw.randrange(len(pages))] = other[PAGE * draw.randrange(len(other) // PAGE) :][:PAGE]
    return b"".join(pages)


def _sql(path: Path, *statements: str) -> None:
    with closing(sqlite3.connect(path, isolation_level=None)) as connection:
        for statement in statements:
            try:
                connection.execute(statement)
            except sqlite3.Error:  # what the tables themselves refuse is no attack
                return


def _rows_of_another(path: Path, other: Path) -> None:
    attach = f"ATTACH '{other}' AS other"
    _sql(
        path,
        attach,
        "INSERT INTO cases SELECT * FROM other.cases",
        "INSERT INTO records SELECT * FROM other.records",
    )


def _outcome(path: Path, expected: dict[str, dict[str, str]]) -> str:
    """Return what came of a file: refused, told and mended, or used with the same numbers of the same cases."""
    status, *_ = command("study", "status", path)
    if status is None:
        return "traceback"
    rows = _exported(path)
    if rows is not None and _differ(rows, expected):
        return "other numbers"
    ended, *_ = command("study", "resume", path)
    if ended is None:
        return "traceback"
    rows = _exported(path)
    if rows is not None:
        return "other numbers" if _differ(rows, expected) else "used, the same numbers"
    return _after_mending(path, expected) if _is_mended(path) else "told, restore a copy"


def _is_mended(path: Path) -> bool:
    return command("study", "mend", path)[0] in (0, 3)


def _differ(rows: dict[str, dict[str, str]], expected: dict[str, dict[str, str]]) -> bool:
    """Whether a finished case that both have has other numbers."""
    finished = {key: row for key, row in rows.items() if row["state"] == "finished" and key in expected}
    return any(row != expected[key] for key, row in finished.items())


def _on_a_full_disk(path: Path, expected: dict[str, dict[str, str]], draw: random.Random) -> str:
    with _no_file_beyond(path.stat().st_size + draw.choice((-4096, 0, 100, 5000))):
        status, *_ = command("study", "resume", path)
    if status is None:
        return "traceback"
    if status not in (0, 2):
        return "wrong status"
    status, *_ = command("study", "resume", path)
    return "told, and went on later" if status == 0 and _exported(path) == expected else "other numbers"


@contextmanager
def _no_file_beyond(size: int) -> Generator[None]:
    """Let no file grow beyond a size, as on a full disk."""
    before, handler = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)
