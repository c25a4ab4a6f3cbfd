"""canon tells whether a piece of mechanics is right, whether its simulation stays right, and what that costs.

Every public name is imported from its room when it is first used; ``import canon`` itself loads nothing. The names
stand in ``__init__.pyi``.
"""

from __future__ import annotations

import importlib
from typing import Any

from canon.doors import door
from canon.version import __version__ as __version__

_found, __dir__, __all__ = door(__name__, __file__)

_SUBJECTS = ("exercise", "expression", "flow", "kernel", "mechanics", "plot", "proof", "scene", "study")


def __getattr__(name: str) -> Any:
    if name in __all__:
        return _found(name)
    if name == "time":  # not in __all__: it would shadow the standard library's in ``from canon import *``
        return importlib.import_module("canon.expression").time
    if name in _SUBJECTS:
        return importlib.import_module(f"canon.{name}")
    import difflib

    close = difflib.get_close_matches(name, __all__, n=1)
    raise AttributeError(
        f"canon has no public name {name!r}" + (f", did you mean {close[0]}?" if close else "")
    )
