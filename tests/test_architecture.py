"""The plan of the house agrees with the house."""

import runpy
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"


def test_the_map_of_the_rooms_is_that_of_the_code():
    page = (DOCS / "architecture.md").read_text(encoding="utf-8")
    with_rooms = runpy.run_path(str(DOCS / "rooms.py"))["with_rooms"]
    assert with_rooms(page) == page, "run python docs/rooms.py"


def test_every_module_stands_in_a_room():
    package = DOCS.parent / "canon"
    known = set(runpy.run_path(str(DOCS / "rooms.py"))["ORDER"])
    assert {path.name for path in package.iterdir() if path.is_dir() and path.name != "__pycache__"} == known
