"""Choice of what is kept of a case: motion, section, exponent, whether it is chaotic, results of functions."""

from __future__ import annotations

import hashlib
import reprlib
from numbers import Number
from types import CodeType, FunctionType
from typing import TYPE_CHECKING, Any, cast

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

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
    instructions, names, constants and the defaults of its arguments; what it calls or encloses is not looked at.

    Raises
    ------
    TypeError, ValueError
        One of them is no function, its name is no name, or a default is of a kind that has no digest.

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
        found.append((name, f"function {_digest(function.__code__, _defaults(name, function))}"))
    return tuple(found)


def _defaults(name: str, function: FunctionType) -> str:
    """Return the defaults of a function as text that is the same in every process."""
    named = (function.__kwdefaults__ or {}).items()
    given = (*enumerate(function.__defaults__ or ()), *sorted(named))
    try:
        return repr([(place, _told(value)) for place, value in given])
    except TypeError as reason:
        raise TypeError(f"keep = {{{name!r}: …}}: a default of the function is {reason}") from None


def _told(value: Any) -> object:
    """Return what a value is, in numbers, texts and tuples; of a function, class or module its name."""
    if value is None or isinstance(value, Number | str | bytes | range | slice):
        return value
    if isinstance(value, np.ndarray):
        return ("array", value.dtype.str, value.shape, _told(value.tolist()))
    if isinstance(value, list | tuple):
        return (type(value).__name__, *map(_told, cast("Sequence[Any]", value)))
    if isinstance(value, set | frozenset):
        return ("set", *sorted(repr(_told(each)) for each in cast("Iterable[Any]", value)))
    if isinstance(value, dict):
        return ("dict", *sorted(repr((_told(k), _told(v))) for k, v in cast("dict[Any, Any]", value).items()))
    if isinstance(name := getattr(value, "__qualname__", getattr(value, "__name__", None)), str):
        return ("named", name)
    raise TypeError(
        f"a {type(value).__name__}, which can't be told from another: give numbers, texts or lists of such"
    )


def _digest(code: CodeType, defaults: str = "") -> str:
    constants = [defaults, *map(_constant, code.co_consts)]
    names = (code.co_names, code.co_varnames, code.co_freevars)
    return hashlib.sha256(repr((code.co_code, constants, names)).encode()).hexdigest()[:16]


def _constant(each: object) -> str:
    """Return a constant as text that is the same in every process: sets have no order of their own."""
    if isinstance(each, CodeType):
        return _digest(each)
    return repr(sorted(map(repr, each))) if isinstance(each, frozenset) else repr(each)
