"""docs/explanation/what_counts_as_an_answer.md: every example is judged, and what the page says is what canon says."""

import re
from pathlib import Path

from canon.exercise.sheet.sheet import sheet_from
from canon.exercise.sheet_check import judged

PAGE = (Path(__file__).parents[2] / "docs" / "explanation" / "what_counts_as_an_answer.md").read_text("utf-8")
SAID = re.findall(r"^# (holds|fails)(?:: (.*))?\n\[\[claim\]\]\nid = \"(.*)\"", PAGE, re.MULTILINE)
BLOCKS = re.findall(r"^```toml\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)


def test_what_the_page_says_is_what_canon_says():
    claims = [claim for block in BLOCKS for claim in sheet_from(block.encode(), toml=True).claims]
    told = list(judged(claims, jobs=2))
    assert [(t.status, t.feedback, t.id) for t in told] == SAID


def test_each_rule_has_examples_and_each_wrong_one_a_reason():
    sections = [part for part in re.split(r"^## ", PAGE, flags=re.MULTILINE)[1:] if "```toml" in part]
    assert len(sections) == 6
    assert all("# fails" in section for section in sections)
    assert all("# holds" in section for section in sections[:4])
    assert all(reason for status, reason, _ in SAID if status == "fails")
