"""Mending of a damaged results file: the rows that are as they were written go into a new file, the old one is kept."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from canon.study.cases.chunk_damage import DamagedFile, set_chunks_aside
from canon.study.cases.row_checksum import COLUMNS, DamagedRow, checked, with_checksum
from canon.study.cases.store import PATIENCE, NoSuchStore, Store, StoreError

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Mended", "mend"]

Rows = dict[str, tuple[Any, ...]]


@dataclass(frozen=True)
class Mended:
    """What became of a damaged file.

    Parameters
    ----------
    store
        The file, with what was whole.
    aside
        Where the damaged file is kept; None where nothing was damaged.
    lost
        The damaged rows that could be found: their cases are to be computed again.
    chunks
        The files of what was kept that were damaged, gone, or named by no record; they are set aside in a folder.
    """

    store: Store
    aside: Path | None
    lost: tuple[DamagedRow, ...]
    chunks: tuple[DamagedFile, ...] = ()


def mend(path: str | Path) -> Mended:
    """Set the damaged rows of a results file aside, and keep every row that is as it was written.

    A study may run meanwhile, and waits with what it writes. Only where rows are damaged, and the file is exchanged
    therefore, may a case that is finished at that moment be computed again.

    Parameters
    ----------
    path
        The file. Where something in it is damaged it is renamed, with ``.damaged`` after its name, and a new file
        takes its place.

    Returns
    -------
    Mended
        The file, the one set aside, and the rows that were lost.

    Raises
    ------
    StoreError
        Where nothing in the file can be read as a study, or it can't be renamed.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     Store(Path(folder) / "study.sqlite").add_cases({"k": "inputs"})
    ...     mend(Path(folder) / "study.sqlite").lost
    ()
    """
    file = Path(path)
    if not file.exists():
        raise NoSuchStore(f"there is no file {file} to mend")
    if _is_whole(file):
        return Mended(Store(file), None, (), set_chunks_aside(Store(file)))
    rows, lost = _salvaged(file)
    if not any(rows.values()):
        raise StoreError(
            f"{file}: nothing in it can be read as a study; restore a copy, or start another file"
        )
    aside, beside = _free_name(file, ".damaged"), _free_name(file, ".mended")
    made = Store(beside)
    made.add_rows({table: [with_checksum(table, *row) for row in rows[table].values()] for table in COLUMNS})
    file.rename(aside)
    for ending in ("-journal", "-wal", "-shm"):  # they would be played back into the new file
        if (journal := Path(f"{file}{ending}")).exists():
            journal.rename(f"{aside}{ending}")
    beside.rename(file)
    return Mended(Store(file), aside, lost, set_chunks_aside(Store(file)))


def _is_whole(file: Path) -> bool:
    try:
        return not Store(file).damaged()
    except StoreError:
        return False


def _salvaged(file: Path) -> tuple[dict[str, Rows], tuple[DamagedRow, ...]]:
    """Return by table and key the rows that can be read and are whole, and the others that can be read."""
    found: dict[str, Rows] = {table: {} for table in COLUMNS}
    damaged: dict[DamagedRow, None] = {}
    for table, row in _readable(file):
        if isinstance(row, DamagedRow):
            damaged[row] = None
        else:
            found[table][" ".join(row) if table == "tags" else row[0]] = row
    for table in ("records", "checkpoints", "tags"):
        for name, (key, *_) in list(found[table].items()):
            if key not in found["cases"]:
                del found[table][name]
                damaged[DamagedRow(table, key)] = None
    for key in found["records"]:
        found["checkpoints"].pop(key, None)
    return found, tuple(damaged)


def _readable(file: Path) -> Iterator[tuple[str, tuple[Any, ...] | DamagedRow]]:
    """Yield the rows of each table from its beginning as far as it can be read, then from its end."""
    try:
        with closing(sqlite3.connect(file, timeout=PATIENCE, isolation_level=None)) as connection:
            connection.text_factory = bytes
            for table, columns in COLUMNS.items():
                for order in ("ASC", "DESC"):
                    asked = f"SELECT {', '.join(columns)}, checksum FROM {table} ORDER BY rowid {order}"
                    for row in _until_it_breaks(connection, asked):
                        yield table, checked(table, row)
    except (sqlite3.Error, UnicodeDecodeError) as error:
        raise StoreError(f"{file}: it can't be opened (SQLite says: {error}); restore a copy") from error


def _until_it_breaks(connection: sqlite3.Connection, asked: str) -> Iterator[tuple[Any, ...]]:
    try:
        yield from connection.execute(asked)
    except (sqlite3.DatabaseError, UnicodeDecodeError):
        return  # what stands behind is looked for from the other end


def _free_name(file: Path, ending: str) -> Path:
    """Return a name beside a file that nothing has yet."""
    names = (file.with_name(f"{file.name}{ending}{number or ''}") for number in range(10_000))
    return next(name for name in names if not name.exists())
