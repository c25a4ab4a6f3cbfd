"""The plan of the house agrees with the house."""

import ast
import importlib
import inspect
import pkgutil
import re
import runpy
import sys
from collections import Counter
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

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


def modules():
    """Every module of canon by its full name, doors left out."""
    package = DOCS.parent / "canon"
    files = (path for path in package.rglob("*.py") if path.name != "__init__.py")
    return {".".join(path.relative_to(package.parent).with_suffix("").parts): path for path in files}


def imported_by(path, known):
    """The modules that one imports anywhere: at the top, in functions, for type checkers."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            yield from {node.module, *(f"{node.module}.{each.name}" for each in node.names)} & {*known}
        elif isinstance(node, ast.Import):
            yield from {each.name for each in node.names} & {*known}


def test_no_imports_run_in_a_circle():
    known = modules()
    graph = {name: set(imported_by(path, known)) for name, path in known.items()}
    assert len(list(TopologicalSorter(graph).static_order())) == len(known) > 400
    with pytest.raises(CycleError):
        list(TopologicalSorter({"a": {"b"}, "b": {"a"}}).static_order())


def test_a_folder_is_looked_over_at_a_glance_and_a_module_has_its_name_alone():
    """At most 15 modules; commands, plots, judges and systems may have the name of the subject they are about."""
    places = [path for path in modules().values() if path.parent.name != "systems"]
    assert max(Counter(path.parent for path in places).values()) <= 15
    alone = [path.stem for path in places if not {"command", "plot", "judges"} & {*path.parts}]
    assert [name for name, times in Counter(alone).items() if times > 1] == []


def test_time_is_the_last_argument_in_mechanics():
    found = 0
    for path in (path for name, path in modules().items() if name.startswith("canon.mechanics.")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = []
            if isinstance(node, ast.FunctionDef):
                names = [each.arg for each in node.args.args]
            elif isinstance(node, ast.ClassDef):
                names = [each.target.id for each in node.body if isinstance(each, ast.AnnAssign)]
            if "t" in names and not node.name.startswith("_"):
                after = names[names.index("t") + 1 :]
                assert [name for name in after if not name.startswith("_")] == [], f"{path}: {node.name}"
                found += 1
    assert found > 20


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
    # Fraction: Python's is meant, whose name a class of the zero test has too.
    internal = {"Array", "Fraction", "Plan", "Samples", "Task"}
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
