"""SQLite file of a study: finished cases and the checkpoints of the others, each row written in one transaction.

The store knows no mechanics. A case is its key (a hash of everything that determines the result) and its
inputs as text; a record is what came of it, as text too; a checkpoint is where a long run stands, and goes
when the record comes. A record in the file was finished, whatever stopped the program. Journal and commit are
those of SQLite with synchronous=FULL: a commit that returned outlives a power cut. Every row has a checksum over
what it means, which is looked at whenever it is read (:mod:`canon.study.cases.row_checksum`).

Two processes may use one file: a record that is there is never replaced, and cases are pure, so it does
not matter whose it is.
"""

from __future__ import annotations

import sqlite3
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from canon.study.cases.row_checksum import COLUMNS, DamagedRow, checked, with_checksum
from canon.study.cases.store_tables import StoreError, checked_tables, how_to_mend
from canon.study.kept.chunk_file import Chunk, ChunkFolder

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Mapping, Sequence

__all__ = ["DamagedRows", "NoSuchStore", "Record", "Store", "StoreError", "existing_store"]

PATIENCE = 60.0
"""Seconds to wait while another process writes."""

HEADER = b"SQLite format 3\0"
"""What every SQLite file begins with."""

SHOWN = 5
"""Damaged rows that an error names."""

ADD_CASE = "INSERT OR IGNORE INTO cases VALUES (?, ?, ?)"

ADD_TAG = "INSERT OR IGNORE INTO tags VALUES (?, ?, ?)"

ADD_RECORD = "INSERT OR IGNORE INTO records VALUES (?, ?, ?, ?, ?, ?)"

FURTHER = """
INSERT INTO checkpoints SELECT * FROM (SELECT ? AS key, ? AS part, ? AS point, ? AS checksum) AS new
WHERE new.key NOT IN (SELECT key FROM records)
ON CONFLICT (key) DO UPDATE SET part = excluded.part, point = excluded.point, checksum = excluded.checksum
WHERE excluded.part > part
"""
"""Keeps a checkpoint where there is no record, nor one that is further along."""


class NoSuchStore(StoreError, FileNotFoundError):
    """Raised where a study is to be read from a file that is not there, or has nothing in it."""


class DamagedRows(StoreError):
    """Raised where rows of a results file are not what was written; ``rows`` has them."""

    def __init__(self, path: Path, rows: Sequence[DamagedRow]) -> None:
        self.rows = tuple(rows)
        told = ", ".join(map(str, self.rows[:SHOWN])) + (", …" if len(self.rows) > SHOWN else "")
        super().__init__(
            f"{path}: {len(self.rows)} of its rows damaged ({told}); "
            f"'canon study mend {path}' sets them aside, so that they are computed again"
        )


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

    def row(self) -> tuple[str | float, ...]:
        """Return the row that is kept, with the present time and the checksum."""
        now = datetime.now(UTC).isoformat(" ", "seconds")
        return with_checksum("records", self.key, self.failure, self.outcome, float(self.seconds), now)


@dataclass(frozen=True)
class Store:
    """A file of cases and records.

    Parameters
    ----------
    path
        The file; it is made where there is none, or an empty one.

    Raises
    ------
    StoreError
        The file is one of another kind, which stays as it is.

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
        if not _begins_as_sqlite(self.path):
            raise StoreError(
                f"{self.path}: it is no SQLite file; give another file, for this one stays as it is"
            )
        with self._open() as connection:
            checked_tables(self.path, connection)

    def add_cases(self, inputs: dict[str, str]) -> None:
        """Add cases by key with their inputs as text; those that are there already stay."""
        with self._writing() as connection:
            connection.executemany(ADD_CASE, [with_checksum("cases", *each) for each in inputs.items()])

    def add_tags(self, tags: Mapping[str, Iterable[str]]) -> None:
        """Add words to cases by key; those a case has already stay."""
        rows = (with_checksum("tags", key, tag) for key, words in tags.items() for tag in words)
        with self._writing() as connection:
            connection.executemany(ADD_TAG, rows)

    def tags(self) -> dict[str, tuple[str, ...]]:
        """Return by key the words of each case that has any, in the order they were added."""
        found: dict[str, tuple[str, ...]] = {}
        for key, tag in self._rows("tags"):
            found[key] = (*found.get(key, ()), tag)
        return found

    def cases(self) -> dict[str, str]:
        """Return the inputs of all cases by key, in the order they were added."""
        return dict(self._rows("cases"))

    def save(self, record: Record, before: Callable[[], None] = lambda: None) -> None:
        """Keep a record and drop the case's checkpoint, in one transaction; a record that is there already stays.

        Parameters
        ----------
        record
            What came of the case.
        before
            Called before in the same transaction, while nobody else writes: it keeps what the record names.
        """
        with self._writing() as connection:
            before()
            connection.execute(ADD_RECORD, record.row())
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
            connection.execute(FURTHER, with_checksum("checkpoints", key, part, point))

    def checkpoint(self, key: str) -> str | None:
        """Return the checkpoint of a case as text, None where there is none."""
        rows = self._rows("checkpoints", "WHERE key = ?", key)
        return rows[0][2] if rows else None

    def checkpoints(self) -> list[tuple[str, int, str]]:
        """Return key, parts done and text of every checkpoint."""
        return self._rows("checkpoints")

    def parts_done(self) -> dict[str, int]:
        """Return by key how many parts are done of each case that has a checkpoint."""
        return {key: part for key, part, _ in self._rows("checkpoints")}

    def counts(self) -> tuple[int, int, int, int]:
        """Return how many cases finished, failed, are pending, and of the pending ones have a checkpoint.

        Rows are counted and not read; :meth:`damaged` reads them.
        """
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
        return bool(self._rows("records", "WHERE key = ?", key))

    def add_from(self, other: Store) -> None:
        """Add the cases, records and checkpoints of another file, in one transaction, and what was kept before it.

        What is here already stays, but of two checkpoints of a case the one further along.
        """
        rows = {table: [with_checksum(table, *row) for row in other._rows(table)] for table in COLUMNS}
        self.require_intact()
        here, there = ChunkFolder(self.path), ChunkFolder(other.path)
        named = [Chunk.named_by(key, record.outcome) for key, record in other.records().items()]

        def write_chunks() -> None:
            for chunk in named:
                if chunk is not None:
                    here.write(chunk, there.content(chunk))

        self.add_rows(rows, write_chunks)

    def add_rows(
        self, rows: dict[str, list[tuple[str | float, ...]]], before: Callable[[], None] = lambda: None
    ) -> None:
        """Add rows with their checksums, by table, in one transaction, as :meth:`add_from` does.

        Parameters
        ----------
        rows
            By table.
        before
            As in :meth:`save`.
        """
        with self._writing() as connection:
            before()
            connection.executemany(ADD_CASE, rows["cases"])
            connection.executemany(ADD_RECORD, rows["records"])
            connection.execute("DELETE FROM checkpoints WHERE key IN (SELECT key FROM records)")
            connection.executemany(FURTHER, rows["checkpoints"])
            connection.executemany(ADD_TAG, rows.get("tags", []))

    def records(self) -> dict[str, Record]:
        """Return the records of finished cases by key."""
        return {
            key: Record(key, outcome, failure, seconds)
            for key, failure, outcome, seconds, _ in self._rows("records")
        }

    def pending(self) -> tuple[str, ...]:
        """Return the keys of cases without a record, in the order they were added."""
        rows = self._rows("cases", "WHERE key NOT IN (SELECT key FROM records) ORDER BY rowid")
        return tuple(key for key, _ in rows)

    def forget(self, keys: Iterable[str]) -> None:
        """Remove the records of these cases, such as failed ones to be tried again."""
        with self._writing() as connection:
            connection.executemany("DELETE FROM records WHERE key = ?", [(key,) for key in keys])

    @contextmanager
    def while_nobody_writes(self) -> Generator[None]:
        """Keep other processes from writing to the file, for a while shorter than their patience.

        Whoever writes meanwhile waits. What is kept beside the file is written in the same transaction as the record
        that names it, so that while this lasts every such file has its record.
        """
        with self._writing():
            yield

    def damaged(self) -> tuple[DamagedRow, ...]:
        """Return the rows whose checksum is not that of their contents."""
        rows = [row for table in COLUMNS for row in self._checked_rows(table)]
        return tuple(row for row in rows if isinstance(row, DamagedRow))

    def intact_cases(self) -> dict[str, str]:
        """Return the inputs of the cases whose rows are not damaged, by key."""
        return dict(row for row in self._checked_rows("cases") if not isinstance(row, DamagedRow))

    def require_intact(self) -> None:
        """Raise DamagedRows where a row is damaged."""
        if damaged := self.damaged():
            raise DamagedRows(self.path, damaged)

    def _rows(self, table: str, clause: str = "ORDER BY rowid", *given: str) -> list[Any]:
        """Return rows of a table without their checksums; raises DamagedRows where one is not what was written."""
        rows = self._checked_rows(table, clause, *given)
        if damaged := [row for row in rows if isinstance(row, DamagedRow)]:
            raise DamagedRows(self.path, damaged)
        return rows

    def _checked_rows(
        self, table: str, clause: str = "ORDER BY rowid", *given: str
    ) -> list[tuple[Any, ...] | DamagedRow]:
        with self._open() as connection:
            connection.text_factory = bytes  # a damaged text may be no UTF-8
            asked = f"SELECT {', '.join(COLUMNS[table])}, checksum FROM {table} {clause}"
            return [checked(table, row) for row in connection.execute(asked, given)]

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
        except UnicodeDecodeError as error:  # of the words that SQLite quotes from its damaged tables
            raise StoreError(f"{self.path}: it is damaged; {how_to_mend(self.path)}") from error

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

    def _explained(self, error: sqlite3.Error) -> str:
        """Say what happened to which file and what to do."""
        told = str(error)
        remedies = {
            "not a database": "it is no SQLite file; give another file",
            "malformed": f"it is damaged; {how_to_mend(self.path)}",
            "readonly": "it can't be written; check its permissions, or copy it",
            "unable to open": "it can't be opened; check that the folder exists and may be written",
            "disk I/O": "the disk is full or failing; what was finished before is kept: make room and run again",
            "full": "the disk is full; what was finished before is kept: make room and run again",
            "locked": f"another process has been writing for {PATIENCE:.0f} s; wait for it, then run again",
        }
        remedy = next((remedy for sign, remedy in remedies.items() if sign in told), told)
        return f"{self.path}: {remedy} (SQLite says: {told})"


def existing_store(path: str | Path) -> Store:
    """Return the store in a file; reading makes no empty one where a name is mistyped.

    Raises
    ------
    NoSuchStore
        There is no such file, or nothing in it.
    StoreError
        It is no results file.
    """
    file = Path(path)
    if not file.exists():
        raise NoSuchStore(
            f"there is no file {file}; run_study(study, {str(file)!r}), or 'canon study run STUDY.toml', makes one"
        )
    if file.is_file() and not file.stat().st_size:
        raise NoSuchStore(f"the file {file} is empty, and no results of a study; give another file")
    return Store(file)


def _begins_as_sqlite(path: Path) -> bool:
    """Tell whether a file is an SQLite file by its first bytes, or empty; SQLite overwrites one of a single byte.

    What can't be read, SQLite tells of.
    """
    with suppress(OSError), path.open("rb") as file:
        begin = file.read(len(HEADER))
        return begin in (b"", HEADER)
    return True
