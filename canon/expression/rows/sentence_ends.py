"""Ends of sentences between equations: ``x'' + k x = 0. y'' = -g.`` is two of them, no product of 0. and y''.

A full stop behind figures without a point is that of a decimal as well, as programs print ``2.``: of zero, and of
figures that have a point already, nobody would take a product. Of others it is asked.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.text.tokens import LanguageError

if TYPE_CHECKING:
    from re import Match

__all__ = ["with_sentences_apart"]

_STOP = re.compile(
    r"(?P<before>[=+\-−*/·^({]\s*)(?P<number>\d+(?P<point>\.\d+)?)\.(?P<gap>[ \t]+)"
    r"(?=(?P<next>[^\s=+\-−*/^)][^=;\n]{0,120})=(?!=))"
)


def with_sentences_apart(text: str) -> str:
    """Return a text with ``;`` for the full stop between two equations the first of which ends with a number.

    Raises
    ------
    LanguageError
        Where the number may be a factor of what follows.

    Examples
    --------
    >>> with_sentences_apart("x'' = 0. y'' = -g."), with_sentences_apart("m x'' = 2. k x")
    ("x'' = 0; y'' = -g.", "m x'' = 2. k x")
    """
    return _STOP.sub(_apart, text) if "." in text and text.count("=") > 1 else text


def _apart(found: Match[str]) -> str:
    text, stop = found.string, found.end("number")
    begin = 1 + max(text.rfind(sign, 0, found.end("before")) for sign in ";\n")
    if "=" not in text[begin : found.end("before")]:
        return found.group()
    if not found["point"] and found["number"].strip("0"):
        shown = f"{found['number']}. {found['next'].strip()[:20]}"
        reason = f"is {shown} a product, or does a sentence end behind {found['number']}?"
        raise LanguageError(text, stop + 1, reason, "write ; between two equations, and * for a product")
    return f"{found['before']}{found['number']};{found['gap']}"
