"""Choice of what is kept of a case: motion, section, exponent, whether it is chaotic, results of functions."""

from __future__ import annotations

import hashlib
import reprlib
from collections.abc import Mapping
from types import CodeType, FunctionType, MethodType
from typing import TYPE_CHECKING, Any, cast

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    Function = Callable[..., Any]

__all__ = ["CHAOS", "DIRECTIONS", "EXPONENT", "MOTION", "SECTION", "chosen_functions", "keep_from"]

MOTION, EXPONENT, CHAOS, SECTION = "motion", "exponent", "chaos", "section"

DIRECTIONS = {"both": 0, "rising": 1, "falling": -1}
"""Ways in which the function of a section may pass through zero."""

Choice = tuple[tuple[str, str], ...]
"""What is kept by name, with what says more of it: of a section its direction and function, of a function its code."""


def keep_from(written: Any) -> Choice:
    """Return what a study says is to be kept, as names and texts.

    Parameters
    ----------
    written
        ``"motion"``, ``"exponent"``, ``"chaos"``, a table
        ``{ section = "formula", direction = "rising" }``, or a list of these.

    Raises
    ------
    TypeError, ValueError
        It is none of these, or two sections are asked for.

    Examples
    --------
    >>> keep_from(["motion", {"section": "x", "direction": "rising"}])
    (('motion', ''), ('section', 'rising x'))
    """
    found: dict[str, str] = {}
    for each in written if isinstance(written, list | tuple) else [written]:
        name, text = (SECTION, _section(each)) if isinstance(each, dict) else (each, "")
        if name not in (MOTION, EXPONENT, CHAOS) and not text:
            raise ValueError(f"keep = {reprlib.repr(each)}: {_KNOWN}")
        if name == SECTION and SECTION in found:
            raise ValueError("one section is kept of a case: give the others studies of their own")
        found[name] = text
    return tuple(found.items())


_KNOWN = 'give "motion", "exponent", "chaos", a table { section = "formula", direction = "rising" }, or a list of these'


def _section(table: dict[str, Any]) -> str:
    given = dict(table)
    formula, direction = given.pop(SECTION, None), given.pop("direction", "both")
    if given or not isinstance(formula, str) or not formula.strip():
        raise ValueError(f"keep = {reprlib.repr(table)}: {_KNOWN}")
    if direction not in DIRECTIONS:
        raise ValueError(f"direction = {reprlib.repr(direction)}: give one of {', '.join(DIRECTIONS)}")
    return f"{direction} {formula}"


_OF_NUMPY = ("file", "args", "kwds", "allow_pickle")
"""Names that NumPy's archives keep for themselves."""


def chosen_functions(functions: Mapping[str, Function]) -> Choice:
    """Return the names of functions whose results are kept, each with a digest of its code.

    The digest makes a changed function's results others: a case is run anew. It is over the function's own
    instructions, names and constants, and over the values of its defaults and those it encloses: numbers, texts,
    arrays, and tuples, lists, sets and dicts of them. What it calls, and enclosed values of other kinds, are not looked
    at.

    Raises
    ------
    TypeError, ValueError
        One of them is no function, its name is no name, or a default is of another kind, so that nobody could tell
        later which one the results are of.

    Examples
    --------
    >>> def spread(motion):
    ...     return motion.y.std()
    >>> ((name, text),) = chosen_functions({"spread": spread})
    >>> name, text.startswith("function ")
    ('spread', True)
    """
    found: list[tuple[str, str]] = []
    for name, function in functions.items():
        if not isinstance(function, FunctionType):
            raise TypeError(
                f"keep = {{{name!r}: {reprlib.repr(function)}}}: give a function of a kept motion"
            )
        if not name.isidentifier() or name in (MOTION, EXPONENT, CHAOS, SECTION, *_OF_NUMPY):
            raise ValueError(
                f"what is kept can't be called {name!r}: give letters and digits, and none of canon's names"
            )
        defaults = _defaults(name, function)
        found.append((name, f"function {_digest(function.__code__, f'{defaults}{_enclosed(function)}')}"))
    return tuple(found)


def _defaults(name: str, function: FunctionType) -> str:
    """Return the defaults of a function as text."""
    named = (function.__kwdefaults__ or {}).items()
    texts: list[str] = []
    for key, value in (*enumerate(function.__defaults__ or ()), *sorted(named)):
        text = _said(value)
        if text is None:
            raise TypeError(
                f"keep = {{{name!r}: …}}: the default {reprlib.repr(value)} can't be told from another one later; let "
                "defaults be numbers, texts, arrays or functions, or lists of them"
            )
        texts.append(f"({key!r}, {text})")
    return f"[{', '.join(texts)}]"


def _enclosed(function: FunctionType) -> str:
    """Return the values that a function encloses as text: those that can be told apart, but no functions it calls."""
    texts: list[str] = []
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        try:
            value = cell.cell_contents
        except ValueError:  # a name that has no value yet
            continue
        text = None if callable(value) else _said(value)
        if text is not None:
            texts.append(f"{name} = {text}")
    return "; ".join(texts)


def _said(value: Any) -> str | None:
    """Return a value as text that is the same in every process, and another one's for another value, or None."""
    if value is None or isinstance(value, int | float | complex | str | bytes | np.generic):
        return repr(value)
    if isinstance(value, np.ndarray):
        return None if value.dtype.hasobject else f"{value.dtype} {value.shape} {value.tolist()!r}"
    if isinstance(value, FunctionType):
        return f"function {_digest(value.__code__)}"
    if callable(value):
        return None if isinstance(value, MethodType) else getattr(value, "__name__", None)
    if isinstance(value, Mapping):
        items = _said(list(cast("Mapping[Any, Any]", value).items()))
        return items and f"{type(value).__name__} {items}"
    if not isinstance(value, list | tuple | set | frozenset):
        return None
    parts = [_said(x) for x in cast("list[Any]", value)]
    ordered = parts if isinstance(value, list | tuple) else sorted(map(str, parts))  # sets have no order
    return None if None in parts else f"{type(value).__name__} {ordered}"


def _digest(code: CodeType, defaults: str = "") -> str:
    constants = [defaults, *map(_constant, code.co_consts)]
    names = (code.co_names, code.co_varnames, code.co_freevars)
    return hashlib.sha256(repr((code.co_code, constants, names)).encode()).hexdigest()[:16]


def _constant(each: object) -> str:
    """Return a constant as text that is the same in every process: sets have no order of their own."""
    if isinstance(each, CodeType):
        return _digest(each)
    return repr(sorted(map(repr, each))) if isinstance(each, frozenset) else repr(each)
