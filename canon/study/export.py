"""A study as a table for other programs."""

from __future__ import annotations

import csv
import io
import json
from typing import TYPE_CHECKING, Any

from canon.study.run import finished_rows

if TYPE_CHECKING:
    from canon.study.store import Store

__all__ = ["csv_of"]


def csv_of(store: Store) -> str:
    """Return all cases of a store as CSV: one line a case, pending and failed ones included.

    Floats are written so that they read back exactly; lists and tables are JSON inside their cell.
    """
    rows = finished_rows(store)
    columns = list(dict.fromkeys(name for row in rows for name in row))
    written = io.StringIO()
    table = csv.DictWriter(written, columns, restval="", lineterminator="\n")
    table.writeheader()
    table.writerows({name: _cell(value) for name, value in row.items()} for row in rows)
    return written.getvalue()


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    return json.dumps(value) if isinstance(value, dict | list) else value
