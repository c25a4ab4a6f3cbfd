"""Export of a study as a table for other programs: CSV, Parquet, and xarray datasets for NetCDF files."""

from __future__ import annotations

import csv
import io
import json
import math
import re
from typing import TYPE_CHECKING, Any

import numpy as np

from canon.study.cases.result import Results, results_of
from canon.study.errors import StudyError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    import xarray
    from numpy.typing import NDArray

    from canon.study.cases.result import Result
    from canon.study.cases.store import Store

__all__ = ["ExportError", "csv_of", "dataset_of", "rows_of", "write_kept", "write_netcdf", "write_parquet"]

TEXTS = (
    "key",
    "state",
    "system",
    "start",
    "method",
    "precision",
    "tags",
    "verdict",
    "reason",
    "failure",
    "inputs",
)
"""Columns of text."""


INPUTS = ("key", "system", "start", "method", "step", "tolerance", "precision", "span", "samples")
"""Columns that say which case it is: coordinates of a dataset, to choose and to group by."""


OF_OBSERVABLES = ("verdict", "bound", "slope", "slope_error", "detection_limit", "exponent", "walk")
"""What there is a column for of each observable beside the energy: ``NAME verdict`` and so on."""


_SERIES = (
    ("means", "t", "block"), ("means", "mean", "block"),
    ("curve", "t", "point"), ("curve", "largest", "point"), ("curve", "median", "point"),
)  # fmt: skip
"""Series of numbers that are kept of each case, and the dimension that they lie along."""

_TAKEN = ("final", *(f"{group}_{name}" for group, name, _ in _SERIES))
"""Variables of a dataset that are no columns of the table."""

LARGEST_VARIABLE = 2**31 - 4
"""Bytes of a variable in a NetCDF file of version 3."""

FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""What spreadsheets take a text for a formula by."""


class ExportError(ImportError):
    """Raised where the library that writes a format is not installed."""


def rows_of(given: Store | Results) -> list[dict[str, Any]]:
    """Return one flat row a case of a file or of results, pending and failed ones too; None where there is no number.

    Columns are the inputs (a column ``parameter NAME`` each changed parameter), the numbers of
    :class:`canon.study.Drift`, the cost, ``final`` (the last state), ``failure``, and all inputs with the
    versions as JSON in ``inputs``.

    Examples
    --------
    >>> import tempfile
    >>> from canon import Study, run_study
    >>> from canon.study.cases.store import Store
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     store = Store(f"{folder}/study.sqlite")
    ...     _ = run_study(Study.of(system="henon-heiles", method="rk4", step=[0.1, 0.2], span=200.0), store)
    ...     [(row["method"], row["steps"], row["verdict"]) for row in rows_of(store)]
    [('RK4', 2000, 'secular'), ('RK4', 1000, 'secular')]
    """
    return [_row(result) for result in _results(given)]


def _results(given: Store | Results) -> Results:
    return given if isinstance(given, Results) else results_of(given)


def csv_of(given: Store | Results) -> str:
    """Return all cases of a file or of results as CSV: one line a case, pending and failed ones included.

    Floats are written so that they read back exactly; lists are JSON inside their cell. A text that a spreadsheet
    would take for a formula (``=cmd|…``) has an apostrophe before it.
    """
    rows = rows_of(given)
    written = io.StringIO()
    columns = _columns(rows)
    table = csv.writer(written, lineterminator="\n")
    table.writerow(map(_cell, columns))
    table.writerows([_cell(row.get(name)) for name in columns] for row in rows)
    return written.getvalue()


def write_parquet(given: Store | Results, path: Path) -> None:
    """Write all cases of a file or of results as a Parquet file, with the types of the columns and lists as lists.

    Raises
    ------
    ExportError
        Where pyarrow is not installed.
    """
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as missing:
        raise ExportError("Parquet needs pyarrow: pip install canon-mechanics[export]") from missing
    rows = rows_of(given)
    table = pyarrow.table(
        {
            name: pyarrow.array([row.get(name) for row in rows], _arrow_type(name, pyarrow))
            for name in _columns(rows)
        }
    )
    pyarrow.parquet.write_table(table, path)


def dataset_of(given: Store | Results) -> xarray.Dataset:
    """Return a study as an xarray dataset along ``case``, block means along ``block``, curves along ``point``.

    Missing numbers are NaN, as NetCDF has it; ``state`` and ``failure`` say why they are missing. Names have the
    letters that NetCDF files have; of columns that would have one name then, ``L-z bound`` and ``L z bound``, the
    second is ``L_z_bound_2``.

    Raises
    ------
    ExportError
        Where xarray is not installed.
    """
    try:
        import xarray
    except ImportError as missing:
        raise ExportError("NetCDF needs xarray: pip install canon-mechanics[export]") from missing
    rows, results = rows_of(given), _results(given)
    columns = [name for name in _columns(rows) if name != "final"]
    variables: dict[str, Any] = {
        plain: ("case", _values(name, [row.get(name) for row in rows]))
        for name, plain in zip(columns, _plain_names(columns, _TAKEN), strict=True)
    }
    variables["final"] = (("case", "component"), _table([row.get("final") or [] for row in rows]))
    for group, name, dimension in _SERIES:
        series = [result.numbers.get(group, {}).get(name, []) for result in results]
        variables[f"{group}_{name}"] = (("case", dimension), _table(series))
    inputs = [name for name in variables if name in INPUTS or name.startswith("parameter_")]
    return xarray.Dataset(variables).set_coords(inputs)


def _values(column: str, values: Sequence[Any]) -> list[str] | list[float]:
    if _is_text(column):
        return [value or "" for value in values]
    return [math.nan if v is None else float(v) for v in values]


def write_netcdf(given: Store | Results, path: Path) -> None:
    """Write a study as a NetCDF file of version 3, which every reader knows; see :func:`dataset_of`."""
    dataset_of(given).to_netcdf(path, engine="scipy")


def write_kept(results: Results, name: str, path: Path) -> None:
    """Write what was kept of cases under a name as a NetCDF file of version 3; see :meth:`Results.to_xarray`.

    Raises
    ------
    ExportError
        Where xarray is not installed.
    StudyError
        Nothing of that name was kept, or an array is larger than such files hold.
    """
    try:
        found = results.to_xarray(name)
    except ImportError as missing:
        raise ExportError(str(missing)) from missing
    except (KeyError, ValueError) as error:
        raise StudyError(str(error.args[0])) from error
    for each, variable in found.data_vars.items():
        if variable.size * 8 > LARGEST_VARIABLE:
            raise StudyError(
                f"{each} of all cases has {variable.size * 8:.2g} bytes, and NetCDF files of version 3 hold "
                f"{LARGEST_VARIABLE:.2g}: write fewer cases a file, by their tags"
            )
    names = list(map(str, found.variables))
    found.rename(dict(zip(names, _plain_names(names), strict=True))).to_netcdf(path, engine="scipy")


def _row(result: Result) -> dict[str, Any]:
    case, numbers = result.case, dict(result.numbers)
    numbers.pop("means", None)
    numbers.pop("curve", None)
    low, high = numbers.pop("exponent_interval", (None, None))
    others = numbers.pop("observables", {})
    start = json.dumps(list(case.start)) if isinstance(case.start, tuple) else case.start
    return {
        "key": result.key,
        "state": result.state.value,
        "system": case.system_name,
        "start": start or "",
        **{f"parameter {name}": value for name, value in case.parameters},
        "method": str(case.method),
        "step": case.step,
        "tolerance": case.tolerance,
        "precision": case.precision or "",
        "span": case.span,
        "samples": case.samples,
        "tags": "; ".join(case.tags),
        **numbers,
        "exponent_low": low,
        "exponent_high": high,
        **{f"{name} {part}": found[part] for name, found in others.items() for part in OF_OBSERVABLES},
        "seconds": result.seconds,
        "done": result.done,
        "failure": result.failure,
        "inputs": json.dumps({**case.to_dict(), "versions": dict(result.versions)}, ensure_ascii=False),
    }


def _plain(name: str) -> str:
    """Return a name in the letters that NetCDF files of version 3 have."""
    return re.sub(r"[^0-9A-Za-z_]+", "_", name)


def _plain_names(names: Sequence[str], taken: Sequence[str] = ()) -> list[str]:
    """Return names in those letters; of several that would be one, all but the first have a number."""
    found: list[str] = []
    for name in names:
        plain, number = _plain(name), 1
        while (each := plain if number == 1 else f"{plain}_{number}") in (*taken, *found):
            number += 1
        found.append(each)
    return found


def _is_text(name: str) -> bool:
    return name in TEXTS or name.endswith(" verdict")


def _columns(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return every column that a row has, in the order of the fullest row."""
    fullest = max(rows, key=len, default={})
    return list(dict.fromkeys([*fullest, *(name for row in rows for name in row)]))


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    if isinstance(value, str):
        return f"'{value}" if value.startswith(FORMULA) else value
    return json.dumps(value) if isinstance(value, dict | list) else value


def _arrow_type(name: str, pyarrow: Any) -> Any:
    if _is_text(name):
        return pyarrow.string()
    if name == "final":
        return pyarrow.list_(pyarrow.float64())
    if name == "relative":
        return pyarrow.bool_()
    return pyarrow.int64() if name in ("samples", "steps", "evaluations") else pyarrow.float64()


def _table(rows: Sequence[Sequence[float]]) -> NDArray[np.float64]:
    """Return rows of one length, the short ones filled up with NaN."""
    found = np.full((len(rows), max(map(len, rows), default=0)), np.nan)
    for k, row in enumerate(rows):
        found[k, : len(row)] = row
    return found
