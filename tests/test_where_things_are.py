"""docs/howto/where_things_are.md: every place exists, and what it names is defined there."""

import ast
import re
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "howto" / "where_things_are.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| (.+?) \| `(canon[\w.]*)` \| `([\w.]+)` \|$", PAGE, re.MULTILINE)


def source_of(module):
    path = ROOT.joinpath(*module.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def defined_in(body):
    """What statements define, with the statements inside of it; imported names are not defined here."""
    found = {}
    for node in body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            found[node.name] = node.body
        elif isinstance(node, (ast.Assign, ast.AnnAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            found |= {each.id: [] for each in targets if isinstance(each, ast.Name)}
    return found


@pytest.mark.parametrize(("module", "name"), [row[1:] for row in ROWS], ids=lambda word: word)
def test_the_place_exists(module, name):
    body = ast.parse(source_of(module).read_text(encoding="utf-8")).body
    for part in name.split("."):
        names = defined_in(body)
        assert part in names, f"{module} defines no {name}"
        body = names[part]


def test_an_imported_name_is_not_the_place():
    """The check itself: a module where the name is only imported does not pass."""
    body = ast.parse(source_of("canon.study.cases.case").read_text(encoding="utf-8")).body
    assert "method_from" not in defined_in(body)
    assert "Case" in defined_in(body)


def test_many_things_are_told_each_once():
    lines = [line for line in PAGE.splitlines() if line.startswith("| ")]
    assert len(ROWS) == len(lines) - PAGE.count("| to change |") >= 25
    assert max(Counter(thing for thing, *_ in ROWS).values()) == 1


def test_every_room_has_a_row():
    rooms = {path.parent.name for path in (ROOT / "canon").glob("*/__init__.py")}
    assert rooms <= {module.split(".")[1] for _, module, _ in ROWS}
