"""The plan of the house agrees with the house."""

import importlib
import inspect
import pkgutil
import re
import runpy
import sys
from pathlib import Path

import canon

DOCS = Path(__file__).parents[1] / "docs"


def test_the_map_of_the_rooms_is_that_of_the_code():
    page = (DOCS / "architecture.md").read_text(encoding="utf-8")
    with_rooms = runpy.run_path(str(DOCS / "rooms.py"))["with_rooms"]
    assert with_rooms(page) == page, "run python docs/rooms.py"


def test_every_module_stands_in_a_room():
    package = DOCS.parent / "canon"
    known = set(runpy.run_path(str(DOCS / "rooms.py"))["ORDER"])
    assert {path.name for path in package.iterdir() if path.is_dir() and path.name != "__pycache__"} == known


def returned_types():
    """The names of canon's classes that public functions and methods say they return."""
    found = set()
    for name in canon.__all__:
        public = getattr(canon, name)
        spoken = vars(public).values() if inspect.isclass(public) else [public]
        for each in spoken:
            said = getattr(each, "fget", each)
            said = getattr(said, "func", said)
            if not getattr(said, "__name__", "_").startswith("_"):
                found |= set(
                    re.findall(r"\b[A-Z]\w+", str(getattr(said, "__annotations__", {}).get("return")))
                )
    return found


def test_what_public_functions_return_has_a_page(monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")  # conf.py sets it, for argparse; put back afterwards
    monkeypatch.setattr(sys, "path", [*sys.path])
    returned = runpy.run_path(str(DOCS / "conf.py"))["RETURNED"]
    paged = {name.rsplit(".", 1)[1] for names in returned.values() for name in names}
    modules = [importlib.import_module(m.name) for m in pkgutil.walk_packages(canon.__path__, "canon.")]
    ours = {
        name
        for m in modules
        for name, x in vars(m).items()
        if inspect.isclass(x) and x.__module__ == m.__name__
    }
    internal = {"Array", "Plan", "Samples", "Task"}
    rooms = (
        "expression",
        "proof",
        "mechanics",
        "kernel",
        "flow",
        "scene",
        "study",
        "exercise",
        "plot",
        "serve",
    )
    doors = {
        name for room in rooms for name in getattr(importlib.import_module(f"canon.{room}"), "__all__", ())
    }
    missing = (returned_types() & ours) - paged - set(canon.__all__) - doors - internal
    assert not missing
    for names in returned.values():
        for name in names:
            module, _, found = f"canon.{name}".rpartition(".")
            assert inspect.isclass(getattr(importlib.import_module(module), found))
