"""docs/sheets.md: every example on the page is judged, and what the page says of it is what canon says."""

import csv
import io
import re
from pathlib import Path

import pytest

import canon
from canon.exercise.report.judgement import Judgement
from canon.exercise.sheet.kind import COMMON
from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.sheet import Sheet, sheet_from
from canon.exercise.sheet_check import check

PAGE = (Path(__file__).parents[2] / "docs" / "sheets.md").read_text("utf-8")
BLOCKS = re.findall(r"^```toml\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
SAID = re.findall(r"^# (holds|fails)(?:: (.*))?\n\[\[claim\]\]\nid = \"(.*)\"", PAGE, re.MULTILINE)
FIRST = (
    "euler-lagrange", "dissipative", "multiplier-holonomic", "nonholonomic", "legendre-hamiltonian",
    "hamilton-equations", "routhian", "gibbs-appell", "poisson-bracket", "lagrange-bracket", "lie-bracket",
    "canonicity", "canonicity-time-dependent", "bilinear-covariant", "generating-F1", "generating-F2",
    "generating-F3", "generating-F4", "transformed-hamiltonian-K", "constant-of-motion",
    "lagrangian-equivalence", "equality-only",
)  # fmt: skip


@pytest.fixture(scope="module")
def judged():
    claims = tuple(claim for block in BLOCKS for claim in sheet_from(block.encode(), toml=True).claims)
    return dict(
        zip((claim.id for claim in claims), check(Sheet("page", claims), jobs=2), strict=True)
    ), claims


def test_what_the_page_says_is_what_canon_says(judged):
    told, claims = judged
    assert [name for _, _, name in SAID] == [claim.id for claim in claims]
    for status, feedback, name in SAID:
        assert told[name].status == status, told[name]
        assert told[name].feedback == feedback


def test_every_kind_has_an_example_and_its_keys_are_named(judged):
    _, claims = judged
    assert {claim.kind for claim in claims} == set(FIRST)
    for kind in FIRST:
        section = next(
            part
            for part in re.split(r"^### ", PAGE, flags=re.MULTILINE)
            if f"`{kind}`" in part.split("\n")[0]
        )
        for key in (*KINDS[kind].required, *KINDS[kind].optional):
            assert f"`{key}`" in section, (kind, key)


def test_common_keys_statuses_and_options_are_named():
    from canon.command.check import add_arguments
    from canon.exercise.report.judgement import MARKS

    for word in (*COMMON, *MARKS, *Judgement.__dataclass_fields__):
        assert f"`{word}`" in PAGE, word
    import argparse

    parser = argparse.ArgumentParser()
    add_arguments(parser)
    options = {word for action in parser._actions for word in action.option_strings if word.startswith("--")}
    for option in options - {"--help"}:
        assert f"`{option}" in PAGE, option


def test_the_recipe_for_moodle_marks_answers():
    (recipe,) = (
        block
        for block in re.findall(r"^```python\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
        if "def marks" in block
    )
    names = {}
    exec(compile(recipe, "docs/sheets.md", "exec"), names)  # noqa: S102 (our own page)
    table = io.StringIO()
    rows = csv.writer(table)
    rows.writerows(
        [["Email address", "Response 1"], ["a@b", "(x + 1)**2"], ["c@d", "(x - 1)**2"], ["e@f", "x +"]]
    )
    table.seek(0)
    claim = {"kind": "equality-only", "rhs": "x**2 + 2*x + 1", "parameters": {"x": "real"}}
    told = names["marks"](table, "Response 1", claim, "lhs")
    assert [(who, mark.points) for who, mark in told] == [("a@b", 1.0), ("c@d", 0.0), ("e@f", None)]
    assert [mark.asks_again for _, mark in told] == [False, False, True]
    assert "column" in told[2][1].sentence


def test_the_example_in_python():
    report = canon.check(sheet_from(BLOCKS[0].encode(), toml=True))
    assert report.counts == {"holds": 1}
