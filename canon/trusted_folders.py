"""Trusted folders: where a child process finds what canon rests on, and never where one works.

A file beside the answers that is called as a package is would else be imported, and so run, in its place.
"""

from __future__ import annotations

import importlib.util
import os
import site
import sys
from contextlib import contextmanager
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Generator

__all__ = ["RESTS_ON", "safe_path", "trusted_folders"]

RESTS_ON = ("sympy", "mpmath", "numpy", "flint", "lark")
"""What proofs and judgements import beside the standard library."""


def trusted_folders() -> list[str]:
    """Return the folders from which a child imports what canon rests on.

    Examples
    --------
    >>> import sympy
    >>> str(Path(sympy.__file__).parents[1]) in trusted_folders()
    True
    """
    trusted = [entry for entry in sys.path if entry and not _is_worked_in(entry)]
    found = (_folder(name, trusted) for name in RESTS_ON)
    return list(dict.fromkeys(folder for folder in found if folder))


def _folder(name: str, trusted: list[str]) -> str:
    """Return the folder of a package: that of the one in use, if it is not what lies where one works."""
    loaded = sys.modules.get(name)
    in_use = _place(loaded.__spec__) if loaded is not None else ""
    if in_use and not _is_worked_in(in_use):
        return in_use
    return _place(PathFinder.find_spec(name, trusted)) or in_use or _place(importlib.util.find_spec(name))


def _place(found: ModuleSpec | None) -> str:
    if found is None or not found.origin or not found.has_location:
        return ""
    module = Path(found.origin)
    return str(module.parents[1] if found.submodule_search_locations is not None else module.parent)


def _is_worked_in(folder: str) -> bool:
    """Whether a folder is on the path because it is worked in, or has the script, and not for its packages."""
    if sys.flags.no_site:  # a child like these, whose path was chosen
        return False
    script: str = getattr(sys.modules.get("__main__"), "__file__", None) or ""
    worked_in = (Path(), Path(script).parent)
    installed = (*site.getsitepackages(), site.getusersitepackages())
    return any(_same(folder, other) for other in worked_in) and not any(
        _same(folder, other) for other in installed
    )


def _same(folder: str, other: str | Path) -> bool:
    try:
        return Path(folder).samefile(other)
    except OSError:  # one of them is not there
        return False


@contextmanager
def safe_path() -> Generator[None]:
    """Let the interpreters that are started meanwhile, those of a pool for one, leave out the working folder.

    Examples
    --------
    >>> with safe_path():
    ...     os.environ["PYTHONSAFEPATH"]
    '1'
    """
    before = os.environ.get("PYTHONSAFEPATH")
    os.environ["PYTHONSAFEPATH"] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ["PYTHONSAFEPATH"]
        else:
            os.environ["PYTHONSAFEPATH"] = before
