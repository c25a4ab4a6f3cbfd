"""Doors of packages: public names that stand once, in a stub, and are imported when first used.

As scientific Python's SPEC 1 has it; its ``lazy_loader`` would be a package from outside that ``import canon`` loads,
and a file of its name in a folder of strangers' answers would run.
"""

from __future__ import annotations

import importlib
import re
import sys
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    from collections.abc import Callable
    from importlib.abc import FileLoader

__all__ = ["door"]

LINE = re.compile(r"^from \.([\w.]+) import \(?\s*(\w+) as \2\b", re.MULTILINE)


def door(package: str, path: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of a package whose stub says where its names are.

    Parameters
    ----------
    package, path
        Its ``__name__`` and ``__file__``. The stub stands beside the file; each of its lines is
        ``from .module import name as name``.

    Examples
    --------
    >>> import canon.proof
    >>> names = door("canon.proof", canon.proof.__file__)
    >>> names[0]("Domain") is canon.Domain, "Verdict" in names[2]
    (True, True)
    """
    loader = cast("FileLoader", getattr(sys.modules[package].__spec__, "loader", None))
    stub = loader.get_data(f"{path.removesuffix('c').removesuffix('.py')}.pyi").decode()
    homes = {name: f"{package}.{module}" for module, name in LINE.findall(stub)}
    names = sorted(homes)

    def found(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"{package} has no public name {name!r}")
        return getattr(importlib.import_module(homes[name]), name)

    return found, lambda: names, names
