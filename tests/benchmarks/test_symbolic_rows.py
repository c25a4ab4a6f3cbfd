"""The rows about expressions and systems: none hangs, crashes or is silently wrong."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from extremes.running import rows_of, run_row
from extremes.symbolic import rows as symbolic_rows
from extremes.system import rows as system_rows

QUICK = ("radicals-6-deep", "ramanujan-cube", "domain-empty", "off-far-point", "unicode-cyrillic-a")
ROWS = [("symbolic", row) for row in symbolic_rows()] + [("system", row) for row in system_rows()]


def test_there_are_as_many_as_were_wanted():
    assert len(ROWS) >= 60
    assert len(rows_of("symbolic")) + len(rows_of("system")) == len(ROWS)


@pytest.mark.parametrize("name", QUICK)
def test_some_of_them_at_once(name):
    (row,) = (row for _, row in ROWS if row.name == name)
    assert row.canon().kind in ("result", "said")


@pytest.mark.slow
@pytest.mark.parametrize(("part", "row"), [pytest.param(part, row, id=row.name) for part, row in ROWS])
def test_canon_is_right_or_says_why_not(part, row):
    if row.name == "interrupt-jupyter":
        pytest.importorskip(
            "jupyter_client", reason="a kernel is asked by jupyter_client, of the extra 'docs'"
        )
    (canon,) = run_row(part, replace(row, ordinary={}))
    assert canon["kind"] in ("result", "said"), canon["said"]
