"""Numbers of equations, ``(1) … ; (2) …`` or ``1. …``: no factors where all equations have them in order."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["without_numbers"]

_BEFORE = re.compile(
    r"\s*(?P<label>(?P<bold>\*\*)?(?:\((?P<a>\d{1,2})\)|(?P<b>\d{1,2})[.)])(?(bold)\*\*))(?=\s)"
)
_BEHIND = re.compile(r"(?<=\s)(?P<label>\((?P<a>\d{1,2})\))(?=\s*\$?\s*[.,]?\s*$)")
_END = re.compile(r"[;\n]")


def without_numbers(texts: Sequence[str]) -> list[str]:
    """Return equations with their numbers blanked, where each has one and they count up.

    Of a single number :mod:`canon.expression.remarks` tells whether it may be a factor as well.

    Examples
    --------
    >>> without_numbers(["(1) x'' = -x", "(2) y'' = -y"])
    ["    x'' = -x", "    y'' = -y"]
    >>> without_numbers(["1. x'' = -x; 2. y'' = -y"])
    ["   x'' = -x;    y'' = -y"]
    >>> without_numbers(["2 x'' = -x"])
    ["2 x'' = -x"]
    """
    for pattern in (_BEFORE, _BEHIND):
        places = [found for text in texts for found in _labels(pattern, text)]
        numbers = [int(found["a"] or found.groupdict().get("b") or 0) for found in places if found]
        if len(places) == len(numbers) > 1 and numbers == [numbers[0] + i for i in range(len(numbers))]:
            return [_blanked(pattern, text) for text in texts]
    return list(texts)


def _labels(pattern: re.Pattern[str], text: str) -> list[re.Match[str] | None]:
    """Return the number of each equation in a text; None where one has none."""
    return [pattern.search(part) if pattern is _BEHIND else pattern.match(part) for part in _parts(text)]


def _parts(text: str) -> list[str]:
    return [part for part in _END.split(text) if part.strip()]


def _blanked(pattern: re.Pattern[str], text: str) -> str:
    """Return a text with blanks for its numbers: columns stay what they are."""
    pieces = re.split(f"({_END.pattern})", text)
    return "".join(
        pattern.sub(lambda found: " " * len(found.group()), piece, count=1) if piece.strip(";\n") else piece
        for piece in pieces
    )
