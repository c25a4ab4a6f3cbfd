r"""Printed forms: letters with decorations, conditions of cases, ``\partial_x``, SymPy's special functions."""

from __future__ import annotations

import re

from canon.expression.text.syntax import LanguageError
from canon.expression.text.vocabulary import WHICH_E

__all__ = [
    "CLAUSE",
    "CONDITION",
    "DECORATIONS",
    "OF_SPECIAL_FUNCTIONS",
    "OTHERWISE",
    "PARTIAL",
    "PLAIN",
    "is_printed_call",
    "refuse_open_e",
]

DECORATIONS = {
    **dict.fromkeys(("bar", "overline"), ("bar",)), **dict.fromkeys(("hat", "widehat"), ("hat",)),
    **dict.fromkeys(("tilde", "widetilde"), ("tilde",)), "vec": ("vec",), "mathcal": ("cal",), "mathscr": ("scr",),
    **dict.fromkeys(("mathbf", "boldsymbol", "bm"), ("vec", "bf")),
}  # fmt: skip
CONDITION = re.compile(
    r"\\(?:text|mathrm|textrm|mbox)\s*\{[\s~]*(for|if|when|otherwise|else|wenn|sonst)[\s~:,.]*\}|\\(?:wedge|land|vee|lor)(?![A-Za-z])"
)
"""What stands before a condition in ``cases``, or in its place."""
CLAUSE = re.compile(
    r"\((?:[^()<>=\\]|\\(?!wedge|vee|land|lor|[lgn]eq?)[A-Za-z]*){0,400}?(?:[<>=]|\\(?:leq|geq|neq|le|ge|ne))"
)
"""A bracket in ``cases`` with a relation directly inside it."""
OTHERWISE = ("otherwise", "else", "sonst")
PLAIN = re.compile(
    r"[A-Za-z][A-Za-z0-9]*(?:_[A-Za-z0-9]+)*_(?=[A-Za-z0-9]*[A-Za-z])[A-Za-z0-9]{2,}(?![A-Za-z0-9_])"
)
"""A name as the plain language has it, ``p_theta``, which LaTeX would print otherwise."""
PARTIAL = re.compile(
    r"\\partial\s*(?:\^\s*([2-9])\s*)?_\s*(?:\{([^{}]{1,60})\}|(\\[A-Za-z]+|[A-Za-z]))(?:\s*\^\s*([2-9]))?"
)
OF_SPECIAL_FUNCTIONS = {"W": "LambertW", "K": "elliptic_k", "E": "elliptic_e", "F": "elliptic_f"}
PRINTED_CALL = re.compile(r"(?:\^\{(?:[^{}]|\{(?:[^{}]|\{[^{}]{0,99}+\}){0,99}+\}){1,99}+\})?\\left\(")
r"""How SymPy prints their argument, after a power."""

_TYPED_AROUND_INTEGRALS = re.compile(r"\\[,;!]|/")
"""What SymPy does not print beside Legendre's integrals."""
_TYPED = re.compile(r"\^\s*[^\s{]|(?<!\\left)\(|\S\+|\+\S|\\(?:sin|cos|tan|exp|log|ln)(?!\{\\left\(|\^\{|h)")
_WORD_BEFORE = re.compile(r"(?:(\\[A-Za-z]+)|[A-Za-z'])\s*$")
_BEFORE = ("\\cdot", "\\pi", "\\left", "\\leq", "\\geq", "\\neq", "\\wedge", "\\vee")


def is_printed_call(name: str, text: str, at: int, end: int) -> bool:
    r"""Tell whether a special function of SymPy's print begins behind its name; books write ``K\left(k\right)`` of k.

    Examples
    --------
    >>> is_printed_call("K", r"2 K\left(m\right)", 3, 18), is_printed_call("K", r"4\,K\left(k\right)", 4, 19)
    (True, False)
    """
    if name not in OF_SPECIAL_FUNCTIONS or PRINTED_CALL.match(text, at, end) is None:
        return False
    by_hand = _TYPED.search(text) is not None or _TYPED_AROUND_INTEGRALS.search(text) is not None
    return name == "W" or not by_hand


def refuse_open_e(text: str, column: int) -> None:
    r"""Refuse an ``e`` that need not be Euler's number: it is where SymPy's ``latex()`` prints it, before all symbols.

    What a person types, ``a(1 - e^2)``, may as well be a forgotten eccentricity.

    Raises
    ------
    LanguageError
        With both readings.

    Examples
    --------
    >>> refuse_open_e("e^{2} a", 1)
    >>> refuse_open_e("a (1 - e^2)", 8)
    Traceback (most recent call last):
        ...
    canon.expression.text.tokens.LanguageError: column 8: is e Euler's number, or a name that is not declared, as ...
    """
    word = _WORD_BEFORE.search(text, 0, column - 1)
    upright = text[column - 1 : column] != "e"
    if upright or ((word is None or word[1] in _BEFORE) and _TYPED.search(text) is None):
        return
    raise LanguageError(text, column, WHICH_E, r"write \mathrm{e} for the number; a name is declared")
