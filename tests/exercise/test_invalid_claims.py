"""Claims that say nothing that could be judged: each is refused, with the place and the reason, and the exit code."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from canon.exercise.claim_verdict import examine
from canon.exercise.sheet.reading import InvalidClaim
from canon.exercise.sheet.sheet import read_sheet

SHEET = Path(__file__).parents[1] / "data" / "invalid_claims.json"
CLAIMS = {claim.id: claim for claim in read_sheet(SHEET).claims}
GOOD = {"id": "good", "kind": "equality-only", "lhs": "1 + 1", "rhs": "2", "expect": "holds"}


def check(*arguments):
    return subprocess.run(
        [sys.executable, "-m", "canon.cli", "check", "--json", *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("name", CLAIMS)
def test_what_is_told(name):
    """The title of each claim of the sheet is what should be told of it."""
    with pytest.raises(InvalidClaim) as refused:
        examine(CLAIMS[name])
    assert refused.value.error.brief.split("\n")[0] == CLAIMS[name].keys["title"]


def test_the_exit_code_and_that_the_others_are_judged(tmp_path):
    claims = json.loads(SHEET.read_text("utf-8"))["claims"]
    sheet = tmp_path / "sheet.json"
    sheet.write_text(json.dumps({"claims": [*claims, GOOD, {**GOOD, "rhs": "3"}]}), "utf-8")
    done = check(sheet)
    statuses = [json.loads(line)["status"] for line in done.stdout.splitlines()]
    assert done.returncode == 2
    assert statuses == ["invalid"] * len(claims) + ["holds", "invalid"]  # the last has an id that was there


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("sheet.json", '{"claims": [{"id": "a", "id": "b"}]}', "stands twice"),
        ("sheet.json", '{"claims": [', "not valid JSON"),
        ("sheet.json", '{"title": "no claims"}', "no claims"),
        ("sheet.json", '{"claims": [], "colour": 1}', "unknown key 'colour'"),
        ("sheet.toml", "[[claim]]\nid = a\n", "not valid TOML"),
        ("sheet.toml", '[[claim]]\nid = "a"\nω = "positive"\n', "not valid TOML"),
    ],
)
def test_files_that_are_no_sheets(tmp_path, name, text, said):
    path = tmp_path / name
    path.write_text(text, "utf-8")
    done = check(path)
    assert done.returncode == 2
    assert said in done.stderr
