"""Checksum of a row in a study's file: over what the row means, so that no flipped bit changes a number unsaid."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["COLUMNS", "DamagedRow", "checked", "with_checksum"]

COLUMNS = {
    "cases": ("key", "inputs"),
    "records": ("key", "failure", "outcome", "seconds", "finished"),
    "checkpoints": ("key", "part", "point"),
    "tags": ("key", "tag"),
}
"""What the checksum of each table's rows is over; it stands in a column after these."""

CALLED = {"cases": "the inputs", "records": "the record", "checkpoints": "the checkpoint", "tags": "a tag"}

DIGITS = 32
"""Hexadecimal digits of SHA-256 that are kept: two rows with one checksum are not met by chance."""


@dataclass(frozen=True)
class DamagedRow:
    """A row whose checksum is not that of its contents.

    Parameters
    ----------
    table
        ``cases``, ``records``, ``checkpoints`` or ``tags``.
    key
        Key of the case as it can be read; it may be what is damaged.
    """

    table: str
    key: str

    def __str__(self) -> str:
        return f"{self.what} of case {self.key[:12]}"

    @property
    def what(self) -> str:
        """What the row is of its case."""
        return CALLED[self.table]


def with_checksum(table: str, *fields: str | float) -> tuple[str | float, ...]:
    """Return the fields of a row, and their checksum after them.

    Examples
    --------
    >>> row = with_checksum("checkpoints", "a key", 3, "a point")
    >>> checked("checkpoints", row)
    ('a key', 3, 'a point')
    >>> checked("checkpoints", (row[0], 4, *row[2:]))
    DamagedRow(table='checkpoints', key='a key')
    """
    return (*fields, _checksum(table, fields))


def checked(table: str, row: Sequence[Any]) -> tuple[Any, ...] | DamagedRow:
    """Return the fields of a row that was read with its checksum, or that it is damaged; texts may be bytes."""
    *fields, kept = (_text(value) for value in row)
    if None not in fields and kept == _checksum(table, fields):
        return tuple(fields)
    return DamagedRow(table, str(fields[0]))


def _checksum(table: str, fields: Sequence[str | float]) -> str:
    """Return the checksum of a row; JSON keeps texts apart and floats exact."""
    return hashlib.sha256(json.dumps([table, *fields]).encode()).hexdigest()[:DIGITS]


def _text(value: Any) -> Any:
    return value.decode("utf-8", errors="replace") if isinstance(value, bytes) else value
