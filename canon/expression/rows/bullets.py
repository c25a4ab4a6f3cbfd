r"""Bullets: dashes, stars and dots before the rows of an answer, and dashes behind the words that lead to it.

``- $\ddot\theta = -\frac{g}{l}\sin\theta$`` is a point of a list, and so is each of several rows that begin with one
mark. No sign of an equation stands before it, outside its dollars. ``- x'' = -k x`` alone may begin with a minus, and
is asked about; so is ``we get - x'' = …``. ``Equation of motion - x'' = …`` names what follows.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.prose import WORD, end_of_words, is_prose
from canon.expression.rows.math_zones import formula_at, is_inside
from canon.expression.rows.row_labels import end_of_label
from canon.expression.sentences.known_words import LEADING
from canon.expression.text.tokens import LanguageError

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["without_bullets"]

_ROW = re.compile(
    r"^(?P<lead>(?:[ \t]|[>✅☑✔→⟶⇒⟹∴]|=>|-{1,2}>|\\(?:therefore|Rightarrow|implies)(?![A-Za-z])|#{1,6}[ \t])*"
    r"(?:\(?(?:\d{1,2}|[a-h]|i{1,3})[).][ \t]+)?)(?P<mark>[-–—*•▪‣◦+])(?P<gap>[ \t]*)(?P<rest>\S[^\n]*)$",
    re.MULTILINE,
)
_ROUND = "•▪‣◦"
"""What is a bullet wherever it stands before a row."""
_SIGNS = "-–"
"""What may be a minus."""
_LONGER = re.compile(r"[\s.,;]*(?:\(\w{1,4}\))?[\s.,;]*$")
"""Nothing more behind a formula than its number and a full stop."""
_NUMERAL = re.compile(r"\s*[-+−]?\s*(?:\d+(?:[.,]\d+)?|\\frac\s*\{?\d+\}?\s*\{?\d+\}?|\d+\s*/\s*\d+)\s*")
_RATE_FIRST = re.compile(
    r"\\d?ddot\s*(?:\{\s*)?\\?[A-Za-z]+(?:_\{?\w{1,3}\}?)?\s*\}?(?:_\{?\w{1,3}\}?)?\s*&?="
)
"""One acceleration alone before the sign: books write no minus before it."""
_EQUALS = re.compile(r"(?<![<>!:])=")
_LED = re.compile(
    r"^(?P<words>[ \t>*_#]*[^\W\d_](?:[^\W\d_]|['’.,:*_ \t]|(?<=[^\W\d_])[-–](?=[^\W\d_])){1,120}?)(?<=[\w:.,*])"
    r"(?:[ \t]+|(?<=:))(?P<dash>-{1,3}|[–—])(?:(?P<gap>[ \t]+)|(?=\$|\\[(\[]))(?P<rest>\S[^\n]*)$",
    re.MULTILINE,
)
_NUMBER_FIRST = re.compile(r"^(?P<mark>[ \t]*\d{1,2}[ \t]+[-–])[ \t]+(?P<rest>\S[^\n]*)", re.MULTILINE)
_LABELLED = re.compile(r"\(?(?:\d{1,2}|[a-h]|i{1,3})[).][ \t]+(?=\S)")
_AFTER_ANOTHER = re.compile(r"(?<=[$)\]][,;])(?P<gap>[ \t]+)(?P<mark>[-–—*•])(?=[ \t]+(?P<rest>\S))")
"""A mark behind a formula and a comma."""
_MARKED = re.compile(r"(?P<mark>\*\*|`)[^\n]+(?P=mark)[\s.]*$")
"""Markdown's marks around a whole row."""
_SEEN = 60
"""Characters that are looked at before a row."""
_CONTINUED = re.compile(r"(?:[-+−*/·×=(\[]|\\(?:cdot|times))[\s&]*(?:\\\\)?\s*$")


def without_bullets(text: str, scope: Scope) -> str:
    r"""Return a text with blanks for the bullets of its rows and for dashes behind words, as long as it was.

    Raises
    ------
    LanguageError
        Where a dash may be a minus as well.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> without_bullets("- $x = 1$", Scope()), without_bullets("* x' = p\n* p' = -x", Scope())
    ('  $x = 1$', "  x' = p\n  p' = -x")
    >>> without_bullets("so - $x = 1$", Scope()), without_bullets("$x = - 1$", Scope())
    ('     $x = 1$', '$x = - 1$')
    """
    text = _LED.sub(lambda found: _without_lead(found, scope), text)
    text = _AFTER_ANOTHER.sub(_without_mark, text)
    for found in _NUMBER_FIRST.finditer(text):
        formula = formula_at(text, found.start("rest"))
        if formula is not None and _EQUALS.search(formula[0]):
            raise _asked(found, found["mark"].strip(), "write 1. for the number of an equation")
    rows = [found for found in _ROW.finditer(text) if not is_inside(text, found.start("mark"))]
    if not rows:
        return text
    signs = [*text]
    lines = [line for line in text.split("\n") if line.strip()]
    several = len(rows) > 1 and (len(rows) == len(lines) or _is_heading(lines[0], len(lines) - len(rows)))
    for found in rows:
        if _is_bullet(found, scope, several):
            signs[found.start("mark")] = " "
    return "".join(signs)


def _without_mark(found: re.Match[str]) -> str:
    """Return blanks for a mark before another equation in dollars, on one line with the one before."""
    formula = formula_at(found.string, found.start("rest"))
    apart = formula and _EQUALS.search(formula[0]) and not is_inside(found.string, found.start("mark"))
    return f"{found['gap']} " if apart else found.group()


def _is_heading(line: str, others: int) -> bool:
    """Tell whether the one line without a bullet is words alone, as before a list."""
    return others == 1 and not _EQUALS.search(line) and line.rstrip(" *").endswith(":") and "$" not in line


def _is_bullet(found: re.Match[str], scope: Scope, several: bool) -> bool:
    """Tell whether the mark before a row is a bullet."""
    text, mark = found.string, found["mark"]
    if mark in _ROUND:
        return True
    if _CONTINUED.search(text[max(0, found.start() - _SEEN) : found.start()]):
        return False
    if found["gap"] and end_of_label(found["rest"], scope) > 0:
        return True
    label = _LABELLED.match(found["rest"])
    formula = formula_at(text, found.start("rest") + (label.end() if label else 0))
    if formula is not None:
        return _is_before_formula(found, *formula, several)
    return found["gap"] != "" and _is_before_plain(found, scope, several)


def _is_before_formula(found: re.Match[str], inside: str, end: int, several: bool) -> bool:
    """Tell whether a mark before a formula in dollars is a bullet."""
    mark, doubtful = found["mark"], found["mark"] in _SIGNS
    behind = found.string[end : found.end()]
    if _EQUALS.search(inside):
        if doubtful and not found["gap"]:
            raise _asked(found, "-", "write it inside the formula")
        return True
    goes_on = found.string[: found.start()].strip() and not several
    if not found["gap"] or (goes_on and _EQUALS.search(found.string[: found.start()])):
        return False
    if not doubtful:
        return mark != "+" or _LONGER.match(behind) is not None
    if _LONGER.match(behind) and (several or not _NUMERAL.fullmatch(inside)):
        return True
    raise _asked(found, "-", "write a minus inside the formula")


def _is_before_plain(found: re.Match[str], scope: Scope, several: bool) -> bool:
    """Tell whether a mark and a blank before a row without dollars are a bullet."""
    mark, rest = found["mark"], found["rest"]
    equation = _EQUALS.search(rest) is not None
    if _MARKED.match(rest):
        return True
    if rest[0] in "=+-−*/^":
        if mark in _SIGNS and equation and rest[0] in "-−":
            raise _asked(found, f"- {rest[:1]}", "leave one of the two out")
        return False
    if end_of_words(rest, scope) > 0 or (several and equation):
        return True
    if mark in "*+" or (not equation and not several) or found["gap"] == "":
        return mark == "*" and equation
    is_raw = "\\" in rest
    if is_raw and not _RATE_FIRST.match(rest):  # as SymPy prints a minus in front
        return False
    raise _asked(found, "-", "write the minus without a blank behind it, or leave the dash out")


def _asked(found: re.Match[str], sign: str, remedy: str) -> LanguageError:
    """Return the question whether a dash is a bullet or a minus."""
    shown = found["rest"].strip()[:30]
    reason = f"is {sign} a bullet before {shown}, or a minus: -{shown}?"
    return LanguageError(found.string, found.start("mark") + 1, reason, remedy)


def _without_lead(found: re.Match[str], scope: Scope) -> str:
    """Return a row without the words before a dash, or without the dash; as it was where they are no such words."""
    words = found["words"].strip(" \t*_#>")
    said = re.findall(WORD, words)
    plain = re.sub(WORD, "", words)
    is_words = said and not plain.strip(" .,:") and any(len(word) > 2 for word in said) | (len(said) == 1)
    if not is_words or len(said[0]) < 2 or is_inside(found.string, found.start("dash")):
        return found.group()
    if not is_prose([word for word in said if not _is_known(word)], scope) and not all(map(_is_known, said)):
        return found.group()
    leads = said[-1].lower() in LEADING or words.endswith((":", ","))
    if not _is_punctuation(found, leads=leads, colon=words.endswith(":")):
        return found.group()
    begin = found.start("rest") - found.start()
    return " " * begin + found.group()[begin:]


def _is_known(word: str) -> bool:
    return word in ("EOM", "EoM", "EL", "E-L", "E–L")


def _is_punctuation(found: re.Match[str], *, leads: bool, colon: bool) -> bool:
    """Tell whether a dash behind words parts them from what follows; it may be a minus else, which is asked about."""
    rest = found["rest"]
    equation = _EQUALS.search(rest) is not None
    formula = formula_at(found.string, found.start("rest"))
    if formula is not None:
        inside, end = formula
        whole = _LONGER.match(found.string[end : found.end()]) is not None
        if found["gap"] is None and not _EQUALS.search(inside):
            return False
        apart = found["gap"] is not None or found["dash"] not in _SIGNS
        if apart and (_EQUALS.search(inside) or (whole and not _NUMERAL.fullmatch(inside))):
            return True
    elif found["dash"] == "—" or (equation and not leads):
        return True
    elif colon and not equation:
        return False
    shown = rest.strip()[:30]
    reason = f"does the dash part these words from {shown}, or is it a minus: -{shown}?"
    remedy = "write a colon for the dash, and a minus without a blank behind it"
    raise LanguageError(found.string, found.start("dash") + 1, reason, remedy)
