r"""Remarks around a formula: the letter of a part before it, words in brackets or the unit of its sides behind it.

``(a) m x'' = -k x``, ``m x'' = -k x (harmonic oscillator)``, ``m \ddot x = -k x \quad \text{(Newton)}``,
``m x'' = -k x [N]``. They are passed over only where nothing in them can be a factor: no letter is declared, no word is
made of declared letters, and a unit says nothing that the formula does not say.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.text.declared_names import Words, function_name
from canon.expression.text.tokens import GREEK, MAX_CHARACTERS, LanguageError, tokens
from canon.expression.text.units import is_a_unit
from canon.expression.text.vocabulary import CONSTANTS, OTHER_NAMES

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["without_remarks"]

_PART = re.compile(r"\s*\(([a-h]|i{1,3}|iv|v)\)(?=[ \t]{1,9}[^\s=+*/^-])")
_WORDS = re.compile(r"(?<=[\w)\]}'′″])[ \t]{1,9}\(([A-Za-z][A-Za-z'’ -]{2,60})\)[\s.]{0,9}$")
_UPRIGHT = re.compile(
    r"(?:\s|~|\\[,;:! ]|\\q{1,2}uad){0,9}\\(?:text|textrm|textit|mathrm)\s?"
    r"\{\s{0,9}\(?([A-Za-z][A-Za-z'’ -]{2,60})\)?\s{0,9}\}([\s.$]{0,9}|\s*\\[\])]\s*)$"
)
_UNIT = re.compile(r"(?<=[\w)\]}'′″])[ \t]{1,9}\[([^\[\]]{1,40})\][\s.]{0,9}$")
_SMALL = frozenset(
    (
        "a",
        "an",
        "and",
        "as",
        "at",
        "by",
        "for",
        "from",
        "in",
        "is",
        "it",
        "its",
        "of",
        "on",
        "so",
        "the",
        "to",
    )
)
"""Words of few letters that are in no formula."""
_CHANGING = frozenset((
    "about", "almost", "approximately", "except", "half", "if", "minus", "never", "not", "only", "or", "plus",
    "roughly", "squared", "times", "twice", "unless", "when", "wrong",
))  # fmt: skip
"""Words that may change what the formula says."""
_LETTERS_OF_A_WORD = 4
_NAMED = frozenset(("Newton", "Lagrange", "Hamilton", "Hooke", "Kepler", "EOM", "ODE"))
"""Words that are a remark by themselves."""


def without_remarks(text: str, scope: Scope) -> str:
    """Return a text with blanks in place of the remarks around its formula.

    Raises
    ------
    LanguageError
        Where a letter before the formula is declared, or all of a unit: ``x = A cos(w t) [m]`` with a mass m.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({"x": coordinates("x")})
    >>> without_remarks("(a) x'' = -x (harmonic oscillator)", scope).strip(), without_remarks("x' = 1 (x)", scope)
    ("x'' = -x", "x' = 1 (x)")
    """
    if len(text) > MAX_CHARACTERS or not re.search(r"\(|\[|\\text|\\mathrm", text):
        return text
    words = Words(text, scope)
    if (part := _PART.match(text)) and "=" in text:
        if scope.declares(part[1]):
            reason = f"is ({part[1]}) the letter of a part, or a factor?"
            raise LanguageError(
                text, part.start(1), reason, "leave the letter out, or write * behind a factor"
            )
        text = " " * part.end() + text[part.end() :]
    if (remark := _WORDS.search(text)) and _says_nothing(remark[1], words):
        return text[: remark.start()]
    if (remark := _UPRIGHT.search(text)) and _is_behind(text, remark) and _says_nothing(remark[1], words):
        return text[: remark.start()] + remark[2]
    if (unit := _UNIT.search(text)) and "=" in text and is_a_unit(unit[1]):
        letters = re.findall("[A-Za-zΩ]+", unit[1])
        if all(_is_known(letter, words) for letter in letters):
            reason = f"is [{unit[1]}] a unit, or a factor?"
            raise LanguageError(text, unit.start(1), reason, "leave the unit out, or write * before a factor")
        return text[: unit.start()]
    return text


def _is_behind(text: str, remark: re.Match[str]) -> bool:
    """Tell whether a remark stands behind a whole formula: no sign before it asks for what follows."""
    return re.search(r"[\w)\]}'′″]$", text[: remark.start()].rstrip()) is not None


def _says_nothing(remark: str, words: Words) -> bool:
    """Tell whether words in brackets are a remark: several, none of which can be read, or a name known for it."""
    found = re.findall("[A-Za-z]+", remark)
    if _CHANGING.intersection(word.lower() for word in found):
        return False
    long = [word for word in found if word.lower() not in _SMALL]
    if any(
        (len(word) < _LETTERS_OF_A_WORD and word not in _NAMED) or _is_known(word, words) for word in long
    ):
        return False
    return (len(found) > 1 and bool(long)) or remark.strip() in _NAMED


def _is_known(word: str, words: Words) -> bool:
    """Tell whether a word, or the letters that it is made of, can stand in a formula."""
    if word in CONSTANTS or word in OTHER_NAMES or word in GREEK.values() or function_name(word, words.scope):
        return True
    (token, *_) = tokens(word)
    try:
        read = words.read(token, bracket=False)
    except LanguageError:
        return True
    return len(read) > 1 or words.declared(word) != []
