"""Tables of a study's results file: made in an empty file, completed in an older one, checked in every other.

A file says which program and which version of the tables it is of; one that is of another, or in pieces, is refused.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import sqlite3
    from pathlib import Path

__all__ = ["TABLES", "StoreError", "checked_tables", "how_to_mend"]

APPLICATION = 0x63616E6F
"""Marks the file as one of canon's ("cano")."""

VERSION = 4
"""Version of the tables below."""

TABLES = """
CREATE TABLE cases (
    key TEXT PRIMARY KEY,
    inputs TEXT NOT NULL,
    checksum TEXT NOT NULL
) STRICT;
CREATE TABLE records (
    key TEXT PRIMARY KEY REFERENCES cases (key),
    failure TEXT NOT NULL,
    outcome TEXT NOT NULL,
    seconds REAL NOT NULL,
    finished TEXT NOT NULL,
    checksum TEXT NOT NULL
) STRICT;
CREATE TABLE checkpoints (
    key TEXT PRIMARY KEY REFERENCES cases (key),
    part INTEGER NOT NULL,
    point TEXT NOT NULL,
    checksum TEXT NOT NULL
) STRICT;
CREATE TABLE tags (
    key TEXT NOT NULL REFERENCES cases (key),
    tag TEXT NOT NULL,
    checksum TEXT NOT NULL,
    PRIMARY KEY (key, tag)
) STRICT;
"""

WITHOUT_TAGS = 3
"""Version of files that have all tables but the last, which they are given when they are opened."""


class StoreError(OSError):
    """Raised for a file that can't be read or written as a store of results; its data stay as they are."""


def checked_tables(path: Path, connection: sqlite3.Connection) -> None:
    """Make the tables in an empty file; refuse a file of another kind or version, or in pieces.

    Raises
    ------
    StoreError
        The file is no results file of this version, or it is damaged.
    """
    for is_due, make in ((_is_new, _make), (_is_without_tags, _add_tags_table)):
        if is_due(connection):
            connection.execute("BEGIN IMMEDIATE")
            try:
                make(path, connection)
            finally:
                if connection.in_transaction:
                    connection.execute("ROLLBACK")
    if _pragma(connection, "user_version") != VERSION:
        raise StoreError(f"{path} was written by another version of canon: use that one, or another file")
    found = connection.execute("PRAGMA integrity_check(1)").fetchone()[0]
    made = connection.execute("SELECT sql FROM sqlite_master WHERE sql IS NOT NULL ORDER BY rowid")
    if found == "ok" and [sql for (sql,) in made] != _statements():
        found = "its tables are not those of a study"
    if found != "ok":
        raise StoreError(f"{path} is damaged ({found.splitlines()[-1]}); {how_to_mend(path)}")


def how_to_mend(path: Path) -> str:
    """Return what to do with a damaged file."""
    return f"'canon study mend {path}' keeps what can be read, or restore a copy"


def _make(path: Path, connection: sqlite3.Connection) -> None:
    """Make the tables; another process may have done so since we looked."""
    if not _is_new(connection):
        return
    if connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
        raise StoreError(f"{path} is a database of another program; give another file")
    for statement in _statements():
        connection.execute(statement)
    connection.execute(f"PRAGMA application_id = {APPLICATION}")
    connection.execute(f"PRAGMA user_version = {VERSION}")
    connection.execute("COMMIT")


def _is_new(connection: sqlite3.Connection) -> bool:
    return _pragma(connection, "application_id") != APPLICATION


def _is_without_tags(connection: sqlite3.Connection) -> bool:
    return _pragma(connection, "user_version") == WITHOUT_TAGS


def _add_tags_table(_: Path, connection: sqlite3.Connection) -> None:
    """Make the table that older files lack; another process may have done so since we looked."""
    if _is_without_tags(connection):
        connection.execute(_statements()[-1])
        connection.execute(f"PRAGMA user_version = {VERSION}")
        connection.execute("COMMIT")


def _statements() -> list[str]:
    return [statement.strip() for statement in TABLES.split(";") if statement.strip()]


def _pragma(connection: sqlite3.Connection, name: str) -> int:
    return int(connection.execute(f"PRAGMA {name}").fetchone()[0])
