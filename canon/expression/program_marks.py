"""Marks of programs around and inside formulas: comments behind them, and Fortran's ``0.5d0``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.text.declared_names import key_of
from canon.expression.text.notation import is_latex
from canon.expression.text.tokens import MAX_CHARACTERS

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["without_program_marks"]

_COMMENT = re.compile(r"(?<=\S)(?:[ \t]{1,20}#(?![\d#&])|;[ \t]{0,20}%(?=\s))[^\n]*")
"""``# words`` of Python behind a formula, ``; % words`` of MATLAB."""
_DOUBLE = re.compile(
    r"(?<![\w.])(?P<number>\d{1,20}(?:\.\d{0,20})?|\.\d{1,20})(?P<d>[dD])(?P<power>[+-]?\d{1,3})(?![\w.])"
)


def without_program_marks(text: str, scope: Scope) -> str:
    """Return a text with blanks for comments and with ``0.5e0`` for ``0.5d0``, as long as it was.

    Where a name begins as the exponent does, ``d0``, ``d_0`` or ``d``, it is a factor.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> without_program_marks("0.5d0*m  # the kinetic part", Scope()).rstrip()
    '0.5e0*m'
    """
    if len(text) > MAX_CHARACTERS or is_latex(text):
        return text
    text = _COMMENT.sub(lambda found: " " * len(found.group()), text) if "#" in text or "%" in text else text

    def exponent(found: re.Match[str]) -> str:
        as_name = f"{found['d']}{found['power']}"
        spelled = as_name.isalnum() and key_of(as_name) in {key_of(name) for name in scope.spelled}
        taken = spelled or scope.declares(found["d"])
        return found.group() if taken else f"{found['number']}e{found['power']}"

    return _DOUBLE.sub(exponent, text)
