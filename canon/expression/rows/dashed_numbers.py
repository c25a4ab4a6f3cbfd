r"""Numbers of equations behind a dash, dots or dollars: ``… = 0 -- (1)``, ``… \ldots (i)``, ``$…$ (1)``.

Two or three dashes and a long one never take away what is behind them; one dash does, except from nothing: nobody
writes ``… = 0 - (1)`` of minus one. Elsewhere it is asked about.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.rows.math_zones import is_inside
from canon.expression.text.tokens import LanguageError

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["without_dashed_numbers"]

_NAME = r"(?P<name>[1-9]\d{0,2}(?:\.\d{1,2})?[a-z]?|[a-h]|i{1,3}|iv|v|I{1,3}|IV|V|\*{1,3})"
_END = r"(?=\s*(?:\$\$?|\\\]|\\\))?[\s.,]*(?:$|\n|;|\\\\|\\end\{)|\s*\$?,\s[^,;\n=]{1,200}=)"
_DASHED = re.compile(
    rf"(?<=[\w)\]}}'′″$.²³])[ \t~]*(?:\\q{{1,2}}uad\s?)?(?P<dash>-{{1,3}}|[–—−]|\.{{2,9}}|…|\\[lc]?dots(?![A-Za-z]))"
    rf"[ \t~]*(?P<shown>\({_NAME}\)){_END}"
)
_OUTSIDE = re.compile(rf"(?:\$|\\\]|\\\))[.,]?(?P<all>[ \t~]*\({_NAME}\))(?=[\s.,]*(?:$|\n|;))")
_LONGEST_ROW = 1_000
_MINUS = "-–−"
_BEGINS = re.compile(r"\n|(?<!\\);|\\\\|\\begin\{[a-z*]{3,14}\}")


def without_dashed_numbers(text: str, scope: Scope) -> str:
    r"""Return a text with blanks for the numbers behind its equations that a dash or dollars set apart.

    Raises
    ------
    LanguageError
        Where one dash may take away what is in the brackets.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> without_dashed_numbers("x = 2 -- (1)", Scope()), without_dashed_numbers("$x = 0$ (1)", Scope())
    ('x = 2       ', '$x = 0$    ')
    >>> without_dashed_numbers("x + y = 0 - (1)", Scope()), without_dashed_numbers("x - (1)", Scope())
    ('x + y = 0      ', 'x - (1)')
    """
    if "(" not in text:
        return text
    text = _DASHED.sub(lambda found: _without(found, scope), text)
    return _OUTSIDE.sub(_without_outside, text)


def _without(found: re.Match[str], scope: Scope) -> str:
    """Return blanks for a number, or what stood there."""
    text, dash = found.string, found["dash"]
    before = text[max(0, found.start() - _LONGEST_ROW) : found.start()]
    begins = [each.end() for each in _BEGINS.finditer(before)]
    row = before[begins[-1] if begins else 0 :]
    blank = " " * len(found.group())
    if dash not in _MINUS:
        return blank
    left, equals, right = row.rpartition("=")
    if not equals or not left.strip(" $"):
        return found.group()
    outside = right.rstrip().endswith("$") and is_inside(text, found.start()) is False
    if right.strip(" $&.{}\\,~") == "0" or outside:
        return blank
    name = found["name"]
    if name.isalpha() and name != "i" and not scope.declares(name):
        return blank
    shown = right.strip(" $")[-20:]
    reason = f"is {found['shown']} the number of this equation, or is it taken away: {shown} - {name}?"
    remedy = f"write {found['shown']} without the dash, or - {name} without the brackets"
    raise LanguageError(text, found.start("dash") + 1, reason, remedy)


def _without_outside(found: re.Match[str]) -> str:
    """Return blanks for a number behind dollars that hold an equation."""
    text, end = found.string, found.start("all")
    opened = max(text.rfind(sign, 0, found.start()) for sign in ("$", "\\[", "\\("))
    is_equation = opened >= 0 and "=" in text[opened:end] and not is_inside(text, end)
    return found.group()[: end - found.start()] + " " * len(found["all"]) if is_equation else found.group()
