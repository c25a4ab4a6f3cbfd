"""The harness of benchmarks/extremes.py survives rows that hang, die, raise and eat memory, and names them."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from extremes.page import bounded, page, summary
from extremes.row import Outcome
from extremes.running import rows_of, run_row

EXPECTED = {
    "right": ["result", "unknown"],
    "wrong": ["wrong"],
    "refuses": ["said"],
    "hangs": ["result", "hang", "result"],
    "dies": ["crash"],
    "raises": ["crash"],
    "eats": ["crash"],
}


@pytest.fixture(scope="module")
def found():
    return [(row, run_row("harness", row)) for row in rows_of("harness")]


def test_every_row_is_called_what_it_is(found):
    assert {row.name: [piece["kind"] for piece in pieces] for row, pieces in found} == EXPECTED


def test_the_page_counts_them(found):
    assert bounded(found) == (3, 2)
    assert "7 rows: 2 results within their stated error, 1 clear errors or UNDECIDED" in summary(found)
    text = page({"numeric": found}, "here")
    assert text.count("\n| ") == 8
    assert "**hangs**, killed after 1 s" in text


def test_a_part_that_was_not_run_stays_as_it_was(found):
    earlier = page({"numeric": found, "symbolic": found[:1], "system": found[:2]}, "there")
    later = page({"numeric": found[:3], "symbolic": [], "system": found[:3]}, "here", earlier)
    assert [later.count(f"Run on {where}.") for where in ("here", "there")] == [2, 1]
    assert later.split("## Symbolic")[1].split("## ")[0].strip() == (
        earlier.split("## Symbolic")[1].split("## ")[0].strip()
    )
    again = page({"numeric": found, "symbolic": found[:1], "system": found[:2]}, "there", later)
    assert again == earlier


@pytest.mark.parametrize(
    ("outcome", "kind"),
    [
        (Outcome("", error=float("nan"), estimate=1.0), "wrong"),
        (Outcome("", error=1.0, estimate=float("inf")), "result"),
        (Outcome("", right=False), "wrong"),
        (Outcome("", refused=True), "said"),
        (Outcome(""), "unknown"),
    ],
)
def test_kinds(outcome, kind):
    assert outcome.kind == kind
