r"""Numbers of equations behind a dash, dots or dollars: ``… = 0 -- (1)``, ``… \ldots (i)``, ``$…$ (1)``.

Two or three dashes and a long one behind an equation never take away what is behind them; one dash does, except from
nothing: nobody writes ``… = 0 - (1)`` of minus one. Elsewhere, and where a letter is declared, it is asked about.
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
_NUMBERS = ("e", "i", "I")
"""Letters that are numbers where they are not declared."""
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
    left, equals, right = row.rpartition("=")
    outside = row.rstrip().endswith("$") and not is_inside(text, found.start())
    name = found["name"]
    if outside or dash[:1] not in _MINUS:
        return blank
    declared = scope.declares(name.lstrip("0123456789."))
    if len(dash) > 1:
        if equals and not declared:
            return blank
        raise _asked(found, f"{dash}{found['shown']}")
    if not equals or not left.strip(" $"):
        return found.group()
    is_zero = right.strip(" $&.{}\\,~") == "0"
    if not declared and (is_zero or (name.isalpha() and name not in _NUMBERS)):
        return blank
    raise _asked(found, f"{right.strip(' $')[-20:]} - {name}")


def _asked(found: re.Match[str], shown: str) -> LanguageError:
    """Return the question whether a number behind a dash is that of the equation."""
    number = found["shown"]
    reason = f"is {number} the number of this equation, or is it taken away: {shown}?"
    remedy = f"write {number} without the dash, or - {found['name']} without the brackets"
    return LanguageError(found.string, found.start("dash") + 1, reason, remedy)


def _without_outside(found: re.Match[str]) -> str:
    """Return blanks for a number behind dollars that hold an equation."""
    text, end = found.string, found.start("all")
    opened = max(text.rfind(sign, 0, found.start()) for sign in ("$", "\\[", "\\("))
    is_equation = opened >= 0 and "=" in text[opened:end] and not is_inside(text, end)
    return found.group()[: end - found.start()] + " " * len(found["all"]) if is_equation else found.group()
