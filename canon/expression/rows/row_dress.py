r"""Dress of rows: lists of LaTeX, letters of a whole equation made bold or red, and factors struck out on both sides.

``\begin{enumerate}\item …``, ``\mathbf{\ddot x = -x}``, ``{\color{red} …}``, ``\cancel{m}\ddot x = -\cancel{m}g``;
characters without width, and hyphens that are no minus of the keyboard.
"""

from __future__ import annotations

import re

from canon.expression.text.notation import closing_of

__all__ = ["undressed"]

_WITHOUT_WIDTH = re.compile("[\u200b\u200c\u00ad\u2060\ufeff]")
_HYPHENS = str.maketrans({"\u2010": "-", "\u2011": "-", "\u2012": "-"})
_LIST = re.compile(r"\\(?:begin|end)\s?\{(?:itemize|enumerate|description)\}(?:\[[^\[\]]{0,40}\])?")
_ITEM = re.compile(r"(?:(?<![^\n])[ \t]*[-*•][ \t]*)?\\item(?![A-Za-z])(?:\s?\[[^\[\]=]{0,20}\])?")
_WHOLE = re.compile(
    r"(?P<before>\s*(?:\$\$?|\\\[|\\\()?\s*)(?P<command>\\(?:mathbf|boldsymbol|bm|mathit|textbf)\s?\{|\{\s*\\(?:color\s?\{[^{}]{1,30}\}|bf|boldmath))"
)
_END = re.compile(r"[\s.,]*(?:\$\$?|\\\]|\\\))?[\s.,]*$")
_CANCELLED = re.compile(r"\\(?:b|x)?cancel\s?\{(?P<what>\s?\\?[A-Za-z]{1,9}(?:_\{?\w{1,3}\}?)?\s?)\}")


def undressed(text: str) -> str:
    r"""Return a text without lists of LaTeX, bold or coloured equations and factors struck out on both sides.

    Examples
    --------
    >>> undressed(r"\mathbf{x = 1}"), undressed(r"\mathbf{x} = 1"), undressed(r"\cancel{m}a = -\cancel{m}g")
    ('        x = 1 ', '\\mathbf{x} = 1', '          a = -          g')
    """
    text = _WITHOUT_WIDTH.sub("", text).translate(_HYPHENS)
    if "\\" not in text:
        return text
    if "\\item" in text:
        text = _ITEM.sub(lambda found: "\n".ljust(len(found.group())), _LIST.sub(_blanks, text))
    if whole := _WHOLE.match(text):
        text = _without_command(text, whole)
    return _without_cancelled(text) if "cancel" in text else text


def _blanks(found: re.Match[str]) -> str:
    return " " * len(found.group())


def _without_command(text: str, whole: re.Match[str]) -> str:
    """Return a text without the command around the whole of it, where that is an equation."""
    at = closing_of(text, text.index("{", whole.start("command")))
    if at is None or "=" not in (inside := text[whole.end() : at]) or not _END.fullmatch(text, at + 1):
        return text
    return f"{whole['before']}{' ' * (whole.end() - whole.end('before'))}{inside} {text[at + 1 :]}"


def _without_cancelled(text: str) -> str:
    """Return a text without one factor that is struck out once on either side, each of which is one term."""
    sides = text.split("=")
    struck = [_CANCELLED.findall(side) for side in sides]
    same = len({what.strip() for each in struck for what in each}) == 1
    if len(sides) != 2 or any(len(each) != 1 for each in struck) or not same:
        return text
    for side in sides:
        rest = _CANCELLED.sub("", side)
        if not re.search(r"[A-Za-z0-9]", rest) or re.search(r"[+\-−/^]", rest.strip(" $&")[1:]):
            return text
    return _CANCELLED.sub(_blanks, text)
