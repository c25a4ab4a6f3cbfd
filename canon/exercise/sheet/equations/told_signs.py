r"""Told signs: ``dE/dt = -c x'² ≤ 0`` says what the rate is, and besides that the energy decreases.

What is told has to follow from the signs of the names, or the answer contradicts itself.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.parse import parse_expression, statements_of
from canon.expression.text.tokens import MAX_CHARACTERS, LanguageError

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["without_told_sign"]

_TOLD = re.compile(
    r"(?P<sign><=|>=|=<|=>|<|>|≤|≥|⩽|⩾|\\(?:leq?|geq?|leqslant|geqslant|lt|gt)(?![A-Za-z]))\s{0,9}0(?=[\s.,$]*$)"
)
_EQUATION = re.compile(r"(?<![<>!=])=(?![=<>])")
_BELOW = ("<", "=<", "≤", "⩽", "\\l")


def without_told_sign(text: str, scope: Scope) -> tuple[str, str]:
    """Return a rate without ``≤ 0`` behind it, every column where it was, and that; an empty one where there is none.

    Raises
    ------
    LanguageError
        Where the expression before it does not have that sign by the signs of its names.

    Examples
    --------
    >>> from canon import parameters
    >>> from canon.expression.text.scope import Scope
    >>> c, v = parameters("c", positive=True), parameters("v")
    >>> scope = Scope({"c": c, "v": v})
    >>> without_told_sign("W = -c*v**2 <= 0", scope), without_told_sign("-c*v**2 <= 0", scope)
    (('W = -c*v**2     ', '<= 0'), ('-c*v**2 <= 0', ''))
    """
    found = _TOLD.search(text) if len(text) <= MAX_CHARACTERS else None
    if found is None or not _EQUATION.search(text, 0, found.start()):  # an inequality alone is no answer
        return text, ""
    rest = text[: found.start()] + " " * (found.end() - found.start()) + text[found.end() :]
    value = parse_expression(statements_of(rest, scope)[-1].sides[-1].text, scope)
    below = found["sign"].startswith(_BELOW)
    if not (value.is_nonpositive if below else value.is_nonnegative):
        contrary = value.is_nonnegative if below else value.is_nonpositive
        reason = f"{'this is not' if contrary else 'is this'} {found.group()}{'' if contrary else '?'}"
        remedy = "write only the rate, or declare the signs of the names in it"
        raise LanguageError(text, found.start() + 1, reason, "write only the rate" if contrary else remedy)
    return rest, found.group()
