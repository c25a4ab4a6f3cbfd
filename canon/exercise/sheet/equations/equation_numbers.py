"""Numbers of equations, ``(1) … ; (2) …`` or ``1. …``: no factors where all equations have them in order."""

from __future__ import annotations

import re
from itertools import accumulate
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["numbers_apart", "without_numbers"]

_BEFORE = re.compile(
    r"\s*(?P<label>(?P<bold>\*\*)?(?:\((?P<a>\d{1,2})\)|(?P<b>\d{1,2})[.)])(?(bold)\*\*))(?=\s)"
)
_BEHIND = re.compile(r"(?<=\s)(?P<label>(?:(?:\.{3,30}|…)\s{0,9})?\((?P<a>\d{1,2})\))(?=\s*\$?\s*[.,]?\s*$)")
_INLINE = re.compile(r"(?<=\s)(?:(?P<number>\d{1,2})|(?P<letter>[a-h]))\)(?=\s)")
"""A number and a bracket that was never opened."""
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


def numbers_apart(text: str) -> str:
    """Return equations that stand in one line as ``1) … 2) …`` with ``;`` between them, and blanks for the numbers.

    Brackets that nothing opens can't hold a factor; before each of them an equation has to stand.

    Examples
    --------
    >>> numbers_apart("1) x'' = -x 2) y'' = -y"), numbers_apart("2 (x + 2) y = 0")
    ("   x'' = -x;   y'' = -y", '2 (x + 2) y = 0')
    """
    if not re.match(r"\s*(?:1|a)\)\s", text) or ";" in text or "\n" in text:
        return text
    depths = [*accumulate((c in "([{") - (c in ")]}") for c in _INLINE.sub(_blank, f" {text}"))]
    places = [found for found in _INLINE.finditer(f" {text}") if depths[found.start()] == 0]
    said = [int(found["number"] or "abcdefgh".index(found["letter"]) + 1) for found in places]
    starts = [found.end() for found in places]
    pieces = [f" {text}"[a:b] for a, b in zip(starts, [*starts[1:], len(text) + 1], strict=True)]
    if len(said) < 2 or said != [*range(1, len(said) + 1)] or not all("=" in piece for piece in pieces):
        return text
    signs = [*f" {text}"]
    for found in places:
        signs[found.start() : found.end()] = _blank(found)
    for found in places[1:]:
        signs[found.start() - 1] = ";"
    return "".join(signs)[1:]


def _blank(found: re.Match[str]) -> str:
    return " " * len(found.group())


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
