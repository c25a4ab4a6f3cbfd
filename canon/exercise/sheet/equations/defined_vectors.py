r"""Vectors whose components an answer gives behind it: ``m\ddot{\mathbf x} = \mathbf F, \mathbf x = (x, y)``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from canon.exercise.sheet.field_texts import components_of, of_matrix

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["without_defined_vectors"]

_BOLD = r"\\(?:vec|mathbf|boldsymbol|bm)(?![A-Za-z])\s?"
_DEFINITION = re.compile(
    r"(?:[,;.$]|\\q?quad(?![A-Za-z])|(?<=[\w}$)])\s)\s*\$?\s*,?\s*"
    r"(?:(?:\\(?:text|mathrm)\s?\{\s?)?(?:where|with|and|wobei|mit|und|avec|où|et)\s{0,3}:?\s?\}?)?"
    r"(?:\s|\$|\\[,;: ]|\\q?quad(?![A-Za-z])){0,6}"
    rf"{_BOLD}(?:\{{\s?(?P<a>[A-Za-z])\s?\}}|(?P<b>[A-Za-z])(?![A-Za-z]))\s*=(?!=)"
)
_MOST = 3
_OF_THE_PLACE = ("r", "v", "a")


def without_defined_vectors(
    text: str, keys: Mapping[str, Any]
) -> tuple[str, list[tuple[int, int, tuple[str, ...]]]]:
    r"""Return a text without the vectors defined behind it, and where each stands before it, with its components.

    The letter of the place, whose components are the coordinates in their order, is made ``\vec r``. A text stays as
    it is where a definition can't be taken apart or is not used, or gives another meaning to the letters of the place
    and its rates.

    Examples
    --------
    >>> text = r"m\ddot{\mathbf x} = -k\mathbf{x}, \mathbf x = (x, y)"
    >>> without_defined_vectors(text, {"q": ["x", "y"]})[0]
    'm\\ddot{\\vec r} = -k\\vec r'
    >>> without_defined_vectors(r"m\ddot{\vec r} = \vec F, \vec F = (0, -mg)", {"q": ["x", "y"]})
    ('m\\ddot{\\vec r} = \\vec F', [(17, 23, ('0', '-mg'))])
    """
    q = [str(name) for name in keys["q"]] if isinstance(keys.get("q"), list) else []
    bare, values = _apart(text, len(q))
    places = [letter for letter, entries in values.items() if [*entries] == q]
    others = values.keys() - {*places}
    if not all(_of_letter(letter).search(bare) for letter in values):  # it says something beside the equation
        return text, []
    if len(places) > 1 or others & {*_OF_THE_PLACE} or (places and places[0] in _OF_THE_PLACE[1:]):
        return text, []
    if places and places != ["r"]:
        if _of_letter("r").search(bare):
            return text, []
        bare = _of_letter(places[0]).sub(r"\\vec r", bare)
    return bare, [
        (*found.span(), values[letter])
        for letter in sorted(others)
        for found in _of_letter(letter).finditer(bare)
    ]


def _apart(text: str, most: int) -> tuple[str, dict[str, tuple[str, ...]]]:
    """Return a text without the definitions behind it, and the components of each letter; none where one is open."""
    bare, values = text, dict[str, tuple[str, ...]]()
    for _ in range(_MOST):
        last = [*_DEFINITION.finditer(bare)][-1:]
        if not last or "=" not in bare[: last[0].start()]:
            break
        piece = bare[last[0].end() :]
        entries = of_matrix(piece) or components_of(piece)
        letter = last[0]["a"] or last[0]["b"]
        if len(entries) != most or letter in values:
            return text, {}
        values[letter] = tuple(entry.strip(" $") for entry in entries)
        before = bare[: last[0].start()]
        bare = f"{before}{'$' * (before.count('$') % 2)}"
    return bare, values


def _of_letter(letter: str) -> re.Pattern[str]:
    """Return the pattern of a letter in bold type or with an arrow."""
    return re.compile(rf"{_BOLD}(?:\{{\s?{letter}\s?\}}|{letter}(?![A-Za-z]))")
