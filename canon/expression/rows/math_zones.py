r"""Zones of mathematics in a text: what stands inside ``$…$``, ``\(…\)``, ``\[…\]`` or a display of LaTeX."""

from __future__ import annotations

import functools
import re
from bisect import bisect_left

__all__ = ["formula_at", "is_inside"]

_OPENING = {"$$": "$$", "$": "$", "\\(": "\\)", "\\[": "\\]"}
_MARKS = re.compile(r"\$\$|(?<!\\)\$|(?<!\\)\\[()\[\]]|\\(?:begin|end)\{(?!itemize|enumerate)")
_OPENS = re.compile(r"\$\$|\$|\\[(\[]")


def is_inside(text: str, at: int) -> bool:
    r"""Tell whether a place of a text stands inside a formula that is marked as one.

    Examples
    --------
    >>> is_inside("a $b - c$ - d", 5), is_inside("a $b - c$ - d", 10)
    (True, False)
    """
    places, depths = _changes(text)
    return depths[bisect_left(places, at)]


@functools.lru_cache(maxsize=8)
def _changes(text: str) -> tuple[list[int], list[bool]]:
    """Return where formulas open and close, and whether a formula is open before each of these places."""
    places: list[int] = []
    inside = [False]
    dollars, brackets, displays = False, 0, 0
    for found in _MARKS.finditer(text):
        sign = found.group()
        if sign[0] == "$":
            dollars = not dollars
        elif sign[1] in "([":
            brackets += 1
        elif sign[1] in ")]":
            brackets = max(0, brackets - 1)
        else:
            displays = max(0, displays + (1 if sign.startswith("\\begin") else -1))
        places.append(found.start())
        inside.append(dollars or brackets > 0 or displays > 0)
    return places, inside


def formula_at(text: str, at: int) -> tuple[str, int] | None:
    r"""Return the formula in ``$…$``, ``\(…\)`` or ``\[…\]`` that begins at a place, and where it is over.

    Examples
    --------
    >>> formula_at("- $x = 1$.", 2), formula_at(r"\[a\]", 0), formula_at("x", 0)
    (('x = 1', 9), ('a', 5), None)
    """
    opened = _OPENS.match(text, at)
    if opened is None:
        return None
    closing = _OPENING[opened.group()]
    end = text.find(closing, opened.end())
    return (text[opened.end() : end], end + len(closing)) if end > 0 else None
