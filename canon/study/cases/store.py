"""SQLite file of a study: finished cases and the checkpoints of the others, each row written in one transaction.

The store knows no mechanics. A case is its key (a hash of everything that determines the result) and its
inputs as text; a record is what came of it, as text too; a checkpoint is where a long run stands, and goes
when the record comes. A record in the file was finished, whatever stopped the program. Journal and commit are
those of SQLite with synchronous=FULL: a commit that returned outlives a power cut.

Two processes may use one file: a record that is there is never replaced, and cases are pure, so it does
not matter whose it is.
"""

from __future__ import annotations

import sqlite3
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Generator, Iterable

__all__ = ["Record", "Store", "StoreError"]

APPLICATION = 0x63616E6F
"""Marks the file as one of canon's ("cano")."""

VERSION = 2
"""Version of the tables below."""

PATIENCE = 60.0
"""Seconds to wait while another process writes."""

TABLES = """
CREATE TABLE cases (
    key TEXT PRIMARY KEY,
    inputs TEXT NOT NULL
) STRICT;
CREATE TABLE records (
    key TEXT PRIMARY KEY REFERENCES cases (key),
    failure TEXT NOT NULL,
    outcome TEXT NOT NULL,
    seconds REAL NOT NULL,
    finished TEXT NOT NULL DEFAULT (datetime('now'))
) STRICT;
CREATE TABLE checkpoints (
    key TEXT PRIMARY KEY REFERENCES cases (key),
    part INTEGER NOT NULL,
    point TEXT NOT NULL
) STRICT;
"""

FURTHER = """
INSERT INTO checkpoints SELECT ?1, ?2, ?3 WHERE ?1 NOT IN (SELECT key FROM records)
ON CONFLICT (key) DO UPDATE SET part = excluded.part, point = excluded.point WHERE excluded.part > part
"""
"""Keeps a checkpoint where there is no record, nor one that is further along."""


class StoreError(OSError):
    """The file can't be read or written as a store; its data stay as they are."""


@dataclass(frozen=True)
class Record:
    """What came of a case.

    Parameters
    ----------
    key
        Key of the case.
    outcome
        The result as text; empty where the case failed.
    failure
        Why it failed; empty where it did not.
    seconds
        Time it took.
    """

    key: str
    outcome: str
    failure: str = ""
    seconds: float = 0.0


@dataclass(frozen=True)
class Store:
    """A file of cases and records.

    Parameters
    ----------
    path
        The file; it is made where there is none.

    Examples
    --------
    >>> import tempfile
    >>> folder = tempfile.TemporaryDirectory()
    >>> store = Store(Path(folder.name) / "study.sqlite")
    >>> store.add_cases({"k1": "inputs of one", "k2": "inputs of another"})
    >>> store.save(Record("k1", outcome="42"))
    >>> store.pending(), store.records()["k1"].outcome
    (('k2',), '42')
    >>> folder.cleanup()
    """

    path: Path

    def __post_init__(self) -> None:
        object.__setattr__(self, "path", Path(self.path))
        with self._open() as connection:
            self._check(connection)

    def add_cases(self, inputs: dict[str, str]) -> None:
        """Add cases by key with their inputs as text; those that are there already stay."""
        with self._writing() as connection:
            connection.executemany("INSERT OR IGNORE INTO cases VALUES (?, ?)", inputs.items())

    def cases(self) -> dict[str, str]:
        """Return the inputs of all cases by key, in the order they were added."""
        with self._open() as connection:
            return dict(connection.execute("SELECT key, inputs FROM cases ORDER BY rowid"))

    def save(self, record: Record) -> None:
        """Keep a record and drop the case's checkpoint, in one transaction; a record that is there already stays."""
        with self._writing() as connection:
            connection.execute(
                "INSERT OR IGNORE INTO records (key, failure, outcome, seconds) VALUES (?, ?, ?, ?)",
                (record.key, record.failure, record.outcome, record.seconds),
            )
            connection.execute("DELETE FROM checkpoints WHERE key = ?", (record.key,))

    def save_checkpoint(self, key: str, part: int, point: str) -> None:
        """Keep how far a case is, in one transaction; one that is further along, or a record, already stays.

        Parameters
        ----------
        key
            Key of the case.
        part
            Parts of the run that are done.
        point
            All that is needed to go on, as text.
        """
        with self._writing() as connection:
            connection.execute(FURTHER, (key, part, point))

    def checkpoint(self, key: str) -> str | None:
        """Return the checkpoint of a case as text, None where there is none."""
        with self._open() as connection:
            row = connection.execute("SELECT point FROM checkpoints WHERE key = ?", (key,)).fetchone()
            return None if row is None else str(row[0])

    def checkpoints(self) -> list[tuple[str, int, str]]:
        """Return key, parts done and text of every checkpoint."""
        with self._open() as connection:
            return connection.execute("SELECT key, part, point FROM checkpoints ORDER BY rowid").fetchall()

    def parts_done(self) -> dict[str, int]:
        """Return by key how many parts are done of each case that has a checkpoint."""
        with self._open() as connection:
            return dict(connection.execute("SELECT key, part FROM checkpoints"))

    def counts(self) -> tuple[int, int, int, int]:
        """Return how many cases finished, failed, are pending, and of the pending ones have a checkpoint."""
        with self._open() as connection:
            row = connection.execute(
                "SELECT (SELECT count(*) FROM records WHERE failure = ''), "
                "(SELECT count(*) FROM records WHERE failure != ''), "
                "(SELECT count(*) FROM cases), (SELECT count(*) FROM checkpoints)"
            ).fetchone()
        finished, failed, cases, begun = map(int, row)
        return finished, failed, cases - finished - failed, begun

    def is_finished(self, key: str) -> bool:
        """Tell whether a case has a record, be it from another process."""
        with self._open() as connection:
            return connection.execute("SELECT 1 FROM records WHERE key = ?", (key,)).fetchone() is not None

    def add_from(self, other: Store) -> None:
        """Add the cases, records and checkpoints of another file, in one transaction.

        What is here already stays, but of two checkpoints of a case the one further along.
        """
        cases, checkpoints, records = other.cases(), other.checkpoints(), other.records()
        with self._writing() as connection:
            connection.executemany("INSERT OR IGNORE INTO cases VALUES (?, ?)", cases.items())
            connection.executemany(
                "INSERT OR IGNORE INTO records (key, failure, outcome, seconds) VALUES (?, ?, ?, ?)",
                [(each.key, each.failure, each.outcome, each.seconds) for each in records.values()],
            )
            connection.execute("DELETE FROM checkpoints WHERE key IN (SELECT key FROM records)")
            connection.executemany(FURTHER, checkpoints)

    def records(self) -> dict[str, Record]:
        """Return the records of finished cases by key."""
        with self._open() as connection:
            rows = connection.execute("SELECT key, outcome, failure, seconds FROM records ORDER BY rowid")
            return {key: Record(key, outcome, failure, seconds) for key, outcome, failure, seconds in rows}

    def pending(self) -> tuple[str, ...]:
        """Return the keys of cases without a record, in the order they were added."""
        with self._open() as connection:
            rows = connection.execute(
                "SELECT key FROM cases WHERE key NOT IN (SELECT key FROM records) ORDER BY rowid"
            )
            return tuple(key for (key,) in rows)

    def forget(self, keys: Iterable[str]) -> None:
        """Remove the records of these cases, such as failed ones to be tried again."""
        with self._writing() as connection:
            connection.executemany("DELETE FROM records WHERE key = ?", [(key,) for key in keys])

    @contextmanager
    def _open(self) -> Generator[sqlite3.Connection]:
        """Open the file for one piece of work; connections are not kept, so that a store can be sent anywhere."""
        try:
            connection = sqlite3.connect(self.path, timeout=PATIENCE, isolation_level=None)
            try:
                connection.execute("PRAGMA synchronous = FULL")
                connection.execute("PRAGMA foreign_keys = ON")
                yield connection
            finally:
                connection.close()
        except sqlite3.Error as error:
            raise StoreError(self._explained(error)) from error

    @contextmanager
    def _writing(self) -> Generator[sqlite3.Connection]:
        with self._open() as connection:
            connection.execute("BEGIN IMMEDIATE")
            try:
                yield connection
                connection.execute("COMMIT")
            except BaseException:
                if connection.in_transaction:  # SQLite itself may have rolled back, as on a full disk
                    connection.execute("ROLLBACK")
                raise

    def _check(self, connection: sqlite3.Connection) -> None:
        """Make the tables in an empty file; refuse a file of another kind, version, or in pieces."""
        if _pragma(connection, "application_id") != APPLICATION:
            connection.execute("BEGIN IMMEDIATE")
            try:
                self._make(connection)
            finally:
                if connection.in_transaction:
                    connection.execute("ROLLBACK")
        if _pragma(connection, "user_version") != VERSION:
            raise StoreError(
                f"{self.path} was written by another version of canon: use that one, or another file"
            )
        found = connection.execute("PRAGMA quick_check(1)").fetchone()[0]
        if found != "ok":
            raise StoreError(f"{self.path} is damaged ({found}); restore a copy, or start another file")

    def _make(self, connection: sqlite3.Connection) -> None:
        """Make the tables; another process may have done so since we looked."""
        if _pragma(connection, "application_id") == APPLICATION:
            return
        if connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
            raise StoreError(f"{self.path} is a database of another program; give another file")
        for statement in TABLES.split(";"):
            connection.execute(statement)
        connection.execute(f"PRAGMA application_id = {APPLICATION}")
        connection.execute(f"PRAGMA user_version = {VERSION}")
        connection.execute("COMMIT")

    def _explained(self, error: sqlite3.Error) -> str:
        """Say what happened to which file and what to do."""
        told = str(error)
        remedies = {
            "not a database": "it is no SQLite file; give another file",
            "malformed": "it is damaged; restore a copy, or start another file",
            "readonly": "it can't be written; check its permissions, or copy it",
            "unable to open": "it can't be opened; check that the folder exists and may be written",
            "disk I/O": "the disk is full or failing; what was finished before is kept: make room and run again",
            "full": "the disk is full; what was finished before is kept: make room and run again",
            "locked": f"another process has been writing for {PATIENCE:.0f} s; wait for it, then run again",
        }
        remedy = next((remedy for sign, remedy in remedies.items() if sign in told), told)
        return f"{self.path}: {remedy} (SQLite says: {told})"


def _pragma(connection: sqlite3.Connection, name: str) -> int:
    return int(connection.execute(f"PRAGMA {name}").fetchone()[0])
