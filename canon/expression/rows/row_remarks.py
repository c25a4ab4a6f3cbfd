"""Remarks around rows: ``Q1:``, ``Ans.`` and ``E–L:`` before one, ``(pendulum)`` and ``(x-direction)`` behind each.

What stands in the brackets is of a list of words that change nothing, or is the name of a direction. None of them is
declared or made of declared letters.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.prose import is_prose
from canon.expression.remarks import says_nothing
from canon.expression.sentences.leading_sentence import is_name
from canon.expression.text.tokens import GREEK

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["without_row_remarks"]

_BEFORE = re.compile(
    r"^(?P<lead>[ \t]*)(?P<name>(?:Q|Question|Ex\.?|Exercise|Problem|Task|Aufgabe|Part)"
    r"\s?\(?\d{1,2}[a-h]?\)?\s?:(?![:=])"
    r"|(?:E\s?[-–]\s?L|Euler\s?[-–]\s?Lagrange)(?:['’]?s?\s(?:equations?|eqn?s?\.?|Gleichung(?:en)?))?\s?:(?![:=])"
    r"|(?:Ans|Answer|Sol|Soln|Solution)\.\s?:?)(?=\s+\S)",
    re.MULTILINE,
)
_BEHIND = re.compile(
    r"(?<=[\w)\]}'′″$²³.])(?P<all>[ \t~]{1,9}\((?P<words>[^\W\d_](?:[^\W\d_]|['’ -]){1,40})\))(?=[\s.,]*(?:$|\n|;))"
)
_REMARKS = frozenset((
    "pendulum", "exact", "nonlinear", "non-linear", "linear", "linearised", "linearized", "nonlinear ODE", "linear ODE",
    "non-linear ODE", "exact solution", "small angles", "for small angles", "small angle", "small oscillations",
    "small-angle approximation", "small angle approximation", "ans", "answer", "final answer", "result", "SHM", "SHO",
    "harmonic oscillator", "oscillator", "conserved energy", "final",
))  # fmt: skip
"""Remarks that restrict nothing of what is written before them: it is judged as it stands."""
_LETTER = rf"(?:[^\W\d_]|{'|'.join(sorted(set(GREEK.values())))})"
_DIRECTION = re.compile(
    rf"(?:in )?(?:the )?{_LETTER}[- ](?:direction|component|axis|equation|Richtung|Komponente)"
    r"|horizontal|vertical|radial|tangential|azimuthal|transverse|angular"
)


def without_row_remarks(text: str, scope: Scope) -> str:
    """Return a text with blanks for names before its rows and remarks in brackets behind them, as long as it was.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> without_row_remarks("Q1: x = 1 (exact)", Scope()), without_row_remarks("x = 1 (not exact)", Scope())
    ('    x = 1        ', 'x = 1 (not exact)')
    """
    text = _BEFORE.sub(lambda found: _without_name(found, scope), text)
    return _BEHIND.sub(lambda found: _without_remark(found, scope), text)


def _without_name(found: re.Match[str], scope: Scope) -> str:
    name = re.sub(r"[\s:().]", "", found["name"])
    return found.group() if is_name(name, scope) else " " * len(found.group())


def _without_remark(found: re.Match[str], scope: Scope) -> str:
    words = found["words"].strip()
    if _DIRECTION.fullmatch(words):
        known = not is_name(re.split("[- ]", words)[-1], scope)
    elif words in _REMARKS:
        known = not any(is_name(word, scope) for word in re.split("[- ]", words))
    else:
        known = says_nothing(words, scope) and is_prose(words.split(), scope)
    return " " * len(found["all"]) if known else found.group()
