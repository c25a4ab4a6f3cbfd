"""Write docs/licences.md: what canon rests on, directly or not, and under which licence each of it comes.

Read from the metadata of what is installed beside canon, with all extras: ``python docs/licences.py``.
"""

import re
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PAGE = Path(__file__).parent / "licences.md"
NAME = "canon-mechanics"
TOOLS = ("dev", "docs")
"""Extras for work on canon itself, no part of what is used."""
HEAD = """\
# Licences

canon itself is under the BSD 3-Clause License. What it rests on, with what that rests on in turn, as the metadata
of each package says it; written by `python docs/licences.py` and held against `pyproject.toml` by a test. "core" is
what `pip install canon-mechanics` brings, the other words are extras.

| package | needed by | licence |
|---|---|---|
"""
_CLASSIFIER = re.compile(r"License :: (?:OSI Approved :: )?(.+)")
_LONG = 60
"""Characters beyond which a field holds the text of a licence and not its name."""


def licence(package: Distribution) -> str:
    """The name of a package's licence: its SPDX expression, or what its classifiers or its field say."""
    said = package.metadata
    expression = said.get("License-Expression")
    if expression:
        return expression
    named = [found[1] for entry in said.get_all("Classifier", []) if (found := _CLASSIFIER.fullmatch(entry))]
    field = (said.get("License") or "").strip()
    if field and len(field) <= _LONG:
        return field
    first = field.splitlines()[0].strip() if field else ""
    return ", ".join(named) or (first if first and len(first) <= _LONG else "see its distribution")


def needed(package: Distribution, extra: str = "") -> list[str]:
    """What a package requires here, with an extra or without any."""
    found = []
    for line in package.requires or ():
        requirement = Requirement(line)
        marker = requirement.marker
        bare = marker is None or marker.evaluate({"extra": ""})
        if (not extra and bare) or (extra and not bare and marker.evaluate({"extra": extra})):
            found.append(canonicalize_name(requirement.name))
    return found


def closure(names: list[str]) -> dict[str, Distribution]:
    """All that some packages rest on, themselves included; what is not installed here is not needed here."""
    found: dict[str, Distribution] = {}
    while names:
        name = names.pop()
        if name in found or name == NAME:
            continue
        try:
            found[name] = distribution(name)
        except PackageNotFoundError:
            continue
        names += needed(found[name])
    return found


def table() -> str:
    canon = distribution(NAME)
    by: dict[str, list[str]] = {}
    packages: dict[str, Distribution] = {}
    for extra in ("", *(e for e in canon.metadata.get_all("Provides-Extra", []) if e not in TOOLS)):
        for name, package in closure(needed(canon, extra)).items():
            if "core" not in by.get(name, ()):
                by.setdefault(name, []).append(extra or "core")
            packages[name] = package
    return "".join(f"| {name} | {', '.join(by[name])} | {licence(packages[name])} |\n" for name in sorted(by))


if __name__ == "__main__":
    PAGE.write_text(HEAD + table(), encoding="utf-8")
