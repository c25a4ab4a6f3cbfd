"""Printable text: what strangers wrote, without what would command a terminal or look like a line of canon's own."""

from __future__ import annotations

import re

__all__ = ["in_one_line", "is_printable", "printable"]

_UNPRINTABLE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)
"""What would command a terminal, turn the direction of text, or stand for no character at all."""


def is_printable(text: str) -> bool:
    """Tell whether a text can be shown as it is."""
    return _UNPRINTABLE.search(text) is None


def printable(text: str) -> str:
    r"""Return a stranger's text without what would command a terminal instead of being read.

    Examples
    --------
    >>> printable("\x1b[2Jgone")
    '�[2Jgone'
    """
    return _UNPRINTABLE.sub("�", text)


def in_one_line(text: str) -> str:
    r"""Return the same with blanks for line breaks, so that no part of it looks like a line of its own.

    Examples
    --------
    >>> in_one_line("Answers\n✓ holds  task 1")
    'Answers ✓ holds  task 1'
    """
    return printable(re.sub(r"[\r\n\t]+", " ", text))
