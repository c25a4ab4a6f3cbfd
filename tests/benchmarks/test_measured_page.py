"""docs/measured.md: laid out as the recorder does it, every number of a table read from the output folded below it."""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path

import pytest

HOME = Path(__file__).parents[2]
PAGE = (HOME / "docs" / "measured.md").read_text("utf-8")
BLOCKS = re.split(r"^(?=## )", PAGE, flags=re.MULTILINE)[1:]


@pytest.fixture(scope="module")
def recorder():
    sys.path.insert(0, str(HOME / "benchmarks"))
    try:
        yield runpy.run_path(str(HOME / "benchmarks" / "record.py"))
    finally:
        sys.path.remove(str(HOME / "benchmarks"))


def test_laying_out_anew_changes_nothing(recorder, tmp_path, monkeypatch):
    import measured_page

    monkeypatch.setattr(measured_page, "FIGURES", tmp_path)
    found = {block.splitlines()[0]: block.rstrip() + "\n" for block in BLOCKS}
    again = dict(found)
    recorder["laid_out_anew"](again)
    assert {title: block.rstrip() + "\n" for title, block in again.items()} == found
    assert set(measured_page.SECTIONS) <= set(recorder["BENCHMARKS"])
    drawn = {path.name for path in tmp_path.iterdir()}
    assert drawn == set(re.findall(r"figures/(measured_\w+\.png)", PAGE))
    assert all((HOME / "docs" / "figures" / name).exists() for name in drawn)


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: block.splitlines()[0])
def test_what_stands_in_a_table_was_printed(block):
    tables, _, folded = block.partition("```text\n")
    assert folded, "the output is missing"
    for line in tables.splitlines():
        if line.startswith("| ") and not re.search(r"---|max|[a-z], ms|%", line):
            for number in re.findall(r"\d[\d.e+-]*", line):
                assert number.rstrip(".") in folded


def test_a_sentence_without_its_numbers_is_refused(recorder):
    section = recorder["section_of"]("choose")
    assert "3 of 3" in section.page("C", "c", "accuracy kept (x): 3 of 3\npredicted: 2 of 2;", "choose")
    with pytest.raises(ValueError, match="choose: the output does not say"):
        section.page("C", "c", "accuracy lost", "choose")
