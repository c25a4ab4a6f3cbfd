"""docs/measured.md: laid out as the recorder does it, every number of a table read from the output folded below it."""

from __future__ import annotations

import json
import re
import runpy
import sys
from pathlib import Path

import pytest

HOME = Path(__file__).parents[2]
PAGE = (HOME / "docs" / "measured.md").read_text("utf-8")
BLOCKS = re.split(r"^(?=## )", PAGE, flags=re.MULTILINE)[1:]
RAN = re.compile(r"^`python benchmarks/(\w+)\.py[^`]*` \((.*?)\)$", re.MULTILINE)
DAY = re.compile(r"20\d\d-\d\d-\d\d")


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


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: block.splitlines()[0])
def test_a_section_has_a_sentence_of_its_own_and_a_table(recorder, block):
    before, _, _ = block.partition("<details>")
    (ran,) = RAN.findall(before)
    assert re.search(r"^\|( ?-+ ?\|)+$", before, re.MULTILINE)
    assert recorder["section_of"]("none").follows not in before
    assert all(table.rows(block.partition("```text\n")[2]) for table in recorder["section_of"](ran[0]).tables)


def keeps_results(script):
    """Whether a benchmark prints what an earlier run has left in benchmarks/results."""
    return '/ "results"' in (HOME / "benchmarks" / f"{script}.py").read_text("utf-8")


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: block.splitlines()[0])
def test_a_stored_result_stands_under_the_days_on_which_it_was_measured(recorder, block):
    ((script, stamp),) = RAN.findall(block)
    assert DAY.search(stamp)
    assert stamp.startswith("measured on ") is keeps_results(script)
    if keeps_results(script):
        assert stamp == recorder["stamp"](block.partition("```text\n")[2])


@pytest.mark.parametrize(
    ("printed", "stamp"),
    [
        ("python benchmarks/x.py --run, 1999-01-02, x86_64\na 1", None),  # no day of this century
        ("measured on 2001-02-03\na 1", "measured on 2001-02-03"),
        ("2001-02-03, x86_64\n  a 1\n2001-02-01, x86_64: b\n  b 1", "measured on 2001-02-01 and 2001-02-03"),
        ("2001-02-01, a; b: 2001-02-02, a; c: 2001-02-03, a", "measured on 2001-02-01 to 2001-02-03"),
        ("an orbit of 2001-02-03 in the middle of a line", None),
    ],
)
def test_what_was_measured_on_another_day_is_not_stamped_with_this_one(recorder, printed, stamp):
    from days import today

    found = recorder["stamp"](printed)
    assert found == stamp if stamp else found.startswith(f"{today()}, ")


def test_laying_out_anew_keeps_the_stamp(recorder):
    title = "## Poincaré sections of ensembles"
    (block,) = (each for each in BLOCKS if each.startswith(title))
    ((_, stamp),) = RAN.findall(block)
    found = {title: block.replace(stamp, "2001-02-03, elsewhere")}
    recorder["laid_out_anew"](found)
    assert RAN.findall(found[title]) == [("sections", "2001-02-03, elsewhere")]


def test_mutants_and_attacks_keep_the_day_of_their_trial(recorder):
    from days import in_words

    results = HOME / "benchmarks" / "results"
    lines = (results / "mutation" / "results-520-1.jsonl").read_text("utf-8").splitlines()
    sorts = json.loads((results / "robustness.json").read_text("utf-8")).values()
    pieces = [piece for sort in sorts for piece in sort["pieces"].values()]
    for title, days in (
        ("Mutants of canon that its tests kill", [json.loads(line)[1]["day"] for line in lines]),
        ("Attacks, counted", [piece["day"] for piece in pieces]),
    ):
        (block,) = (each for each in BLOCKS if each.startswith(f"## {title}"))
        assert RAN.findall(block)[0][1] == f"measured on {in_words(days)}"


def test_a_sentence_without_its_numbers_is_refused(recorder, tmp_path, monkeypatch):
    import measured_page

    monkeypatch.setattr(measured_page, "FIGURES", tmp_path)
    section = recorder["section_of"]("choose")
    printed = "accuracy kept (x): 3 of 3\npredicted: 2 of 2;\nof the search: 1 of 2;"
    assert "3 of 3" in section.page("C", "c", printed, "choose")
    with pytest.raises(ValueError, match="choose: the output does not say"):
        section.page("C", "c", "accuracy lost", "choose")
