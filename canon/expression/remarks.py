r"""Remarks around a formula: the letter or number that it has, words in brackets or the unit of its sides behind it.

``(a) m x'' = -k x``, ``m \ddot x = -k x \quad (2)``, ``m x'' = -k x (harmonic oscillator)``, ``m x'' = -k x [N]``. They
are passed over where nothing in them can be a factor: a wide gap sets them apart, no letter is declared, no word is
made of declared letters, and a unit says nothing that the formula does not say. What may be a factor is asked about.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.prose import is_prose
from canon.expression.text.declared_names import function_name
from canon.expression.text.scope import split
from canon.expression.text.tokens import GREEK, MAX_CHARACTERS, LanguageError
from canon.expression.text.units import is_a_unit

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["says_nothing", "without_remarks"]

_NUMBER = r"[1-9]\d{0,2}(?:\.\d{1,2})?[a-z]?"
_ROMAN = r"i{1,3}|iv|v|I{1,3}|IV|V"
_BLANK = r"[ \t~]|\\[,;:! ]"
_WIDE = r"\\q{1,2}uad(?![A-Za-z])|\\hfill(?![A-Za-z])|\\hspace\*?\{[^{}]{1,12}\}|\.{3,9}|…"
_BEFORE = re.compile(
    rf"(?P<lead>\s*(?:\$\$?|\\\[|\\\()?\s*)(?:[(\[](?P<name>{_NUMBER}|[a-h]|{_ROMAN})[)\]]|(?P<point>[1-9]\d?)\.)"
    rf"(?P<gap>(?:{_BLANK}|{_WIDE}){{1,9}})(?=[^\s=+*/^-])"
)
"""The number or letter of an equation or a part before it."""
_BEHIND = re.compile(
    rf"(?<=[\w)\]}}'′″.,])(?P<gap>(?:{_BLANK}|{_WIDE}){{1,9}})(?:\\(?:text|mathrm)\s?\{{)?\s?"
    rf"[(\[](?P<name>{_NUMBER}|[a-h]|{_ROMAN}|\*{{1,3}})[)\]]\}}?(?=\s*(?:\$\$?|\\\]|\\\))?[\s.,]*(?:$|\\\\))"
)
"""The same behind an equation, at the end of a text or a row."""
_WORDS = re.compile(r"(?<=[\w)\]}'′″$])[ \t]{1,9}\(([^\W\d_](?:[^\W\d_]|['’ -]){2,60})\)[\s.]{0,9}$")
_UPRIGHT = re.compile(
    r"(?:\s|~|\\[,;:! ]|\\q{1,2}uad){0,9}\\(?:text|textrm|textit|mathrm)\s?"
    r"\{\s{0,9}\(([^\W\d_](?:[^\W\d_]|['’ -]){2,60})\)\s{0,9}\}([\s.$]{0,9}|\s*\\[\])]\s*)$"
)
_BEHIND_ROW = re.compile(
    r"(?:~|\\[,;: ]|\\q{1,2}uad){0,9}\\(?:text|textrm|textit|mathrm)\s?"
    r"\{\s{0,9}\(([^\W\d_](?:[^\W\d_]|['’ -]){2,60})\)\s{0,9}\}(?=[\s.,]{0,9}\\\\)"
)
"""The same behind a row that is not the last."""
_UNIT = re.compile(r"(?<=[\w)\]}'′″])[ \t]{1,9}\[([^\[\]]{1,40})\][\s.]{0,9}$")
_LONGEST = 160
"""Characters of a remark that is looked for behind a formula."""
_LONG = 9
"""Letters of a word that is a remark by itself."""
_NAMED = frozenset(("Newton", "Lagrange", "Hamilton", "Hooke", "Kepler", "EOM", "ODE"))
"""Words that are a remark by themselves."""
_FORCES = frozenset((
    "friction", "tension", "drag", "torque", "weight", "reaction", "thrust", "gravity", "normal force",
    "friction force", "force of friction", "string tension", "tension force", "constraint force", "reaction force",
    "contact force", "Reibung", "Haftreibung", "Zwangskraft", "Normalkraft", "Fadenkraft", "Gewichtskraft",
    "frottement", "tension du fil",
))  # fmt: skip
"""What forces and multipliers are called, which says nothing of their value."""


def without_remarks(text: str, scope: Scope) -> str:
    """Return a text with blanks in place of the remarks around its formula.

    Raises
    ------
    LanguageError
        Where a number, a declared letter, or a unit in declared letters may be a factor as well: ``x = … (2)``.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({"x": coordinates("x")})
    >>> without_remarks("(a) x'' = -x (harmonic oscillator)", scope).strip(), without_remarks("x' = 1 (x)", scope)
    ("x'' = -x", "x' = 1 (x)")
    """
    if len(text) > MAX_CHARACTERS or not re.search(r"[(\[]|\\text|\\mathrm|\d\.\s", text):
        return text
    text = _without_number_before(text, scope) if "=" in text else text
    text = _without_numbers_behind(text, scope)
    if "\\\\" in text:
        text = _BEHIND_ROW.sub(lambda found: _blanked(found, scope), text)
    tail = max(0, len(text) - _LONGEST)
    if (remark := _WORDS.search(text, tail)) and says_nothing(remark[1], scope):
        return text[: remark.start()]
    if (
        (remark := _UPRIGHT.search(text, tail))
        and _is_behind(text, remark.start())
        and says_nothing(remark[1], scope)
    ):
        return text[: remark.start()] + remark[2]
    if (unit := _UNIT.search(text, tail)) and "=" in text and is_a_unit(unit[1]):
        letters = re.findall("[A-Za-zΩ]+", unit[1])
        if all(_is_known(letter, scope) for letter in letters):
            reason = f"is [{unit[1]}] a unit, or a factor?"
            raise LanguageError(text, unit.start(1), reason, "leave the unit out, or write * before a factor")
        return text[: unit.start()]
    return text


def _without_number_before(text: str, scope: Scope) -> str:
    found = _BEFORE.match(text)
    if found is None:
        return text
    name, lead = found["name"] or found["point"], found["lead"]
    rest = text[found.end() :]
    if found["point"] and re.search(r"\d\.(?!\d)", rest):  # 2. m x'' + 2. k x, as programs print numbers
        return text
    if not re.search(_WIDE, found["gap"]) and _may_be_a_factor(name, scope):
        shown = text[found.end("lead") : found.start("gap")]
        raise _asked(text, found.end("lead") + 1, shown, f"{shown}*")
    return f"{lead}{' ' * (found.end() - len(lead))}{rest}"


def _without_numbers_behind(text: str, scope: Scope) -> str:
    """Return a text without the numbers behind its rows."""
    pieces: list[str] = []
    at = 0
    for found in _BEHIND.finditer(text):
        before = text[: found.start()].rstrip(" ~.,")
        letters = found["name"].isalpha() and "=" not in text  # m (a)
        if letters or not _is_behind(text, found.start()) or _calls(before, scope):
            continue
        shown = text[found.end("gap") : found.end()].strip()
        if (
            not re.search(_WIDE, found["gap"])
            and _may_be_a_factor(found["name"], scope)
            and not before.endswith("= 0")
        ):
            raise _asked(text, found.end("gap") + 1, shown, f"*{shown}")
        pieces += (text[at : found.start()], " " * (found.end() - found.start()))
        at = found.end()
    return "".join((*pieces, text[at:]))


def _may_be_a_factor(name: str, scope: Scope) -> bool:
    """Tell whether what stands in brackets beside a formula can be multiplied with it and changes it then."""
    letters = name.lstrip("0123456789.")
    if name == letters:
        return scope.declares(name)
    return name != "1" and (not letters or scope.declares(letters))


def _calls(before: str, scope: Scope) -> bool:
    r"""Tell whether a text ends with what takes an argument in brackets: ``sin (2)``, ``2 \cdot (3)``."""
    word = re.search(r"(\\?)([A-Za-z]+)$", before)
    if word is None:
        return False
    if word[1]:
        return word[2] not in GREEK.values() and not word[2].startswith("var")
    return word[2] in scope.functions or function_name(word[2], scope) != ""


def _asked(text: str, column: int, shown: str, factor: str) -> LanguageError:
    reason = f"{shown} may be a factor, or the number of the equation"
    return LanguageError(text, column, reason, f"write {factor} for a factor, or leave it out")


def _is_behind(text: str, start: int) -> bool:
    """Tell whether a remark stands behind a whole formula: no sign before it asks for what follows."""
    return re.search(r"[\w)\]}'′″]$", text[:start].rstrip(" ~.,")) is not None


def _blanked(found: re.Match[str], scope: Scope) -> str:
    """Return blanks for a remark behind a row of a formula."""
    nothing = _is_behind(found.string, found.start()) and says_nothing(found[1], scope)
    return " " * len(found.group()) if nothing else found.group()


def says_nothing(remark: str, scope: Scope) -> bool:
    """Tell whether words in brackets are a remark: several of those that change nothing, or a name known for it."""
    found = remark.split()
    if remark.strip() in _FORCES:
        return not any(_is_known(word, scope) for word in found)
    several = len(found) > 1 or len(remark.strip()) >= _LONG  # a short word may be a product of letters
    return (several and is_prose(found, scope)) or remark.strip() in _NAMED


def _is_known(letters: str, scope: Scope) -> bool:
    """Tell whether the letters of a unit are a declared name, or a product of such."""
    return scope.declares(letters) or split(letters, scope) != ""
