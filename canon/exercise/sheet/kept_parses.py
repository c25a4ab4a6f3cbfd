"""Kept parses: a text is read once for all that is tried on an answer, and what is asked once for a whole class."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    from canon.expression.text.scope import Scope

__all__ = ["parsed"]

_LONGEST_KEPT = 600
"""Characters of a text whose parse is kept, so that a process that judges for weeks stays small."""


def parsed(parse: Callable[[str, Scope], Any], text: str, scope: Scope) -> Any:
    """Return what a text says, as a function of the text and the declared names reads it.

    Raises
    ------
    LanguageError
        Where it can't be read.

    Examples
    --------
    >>> from canon import parameters
    >>> from canon.expression.parse import parse_expression
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({"x": parameters("x")})
    >>> parsed(parse_expression, "x + x", scope) is parsed(parse_expression, "x + x", scope)
    True
    """
    return (_kept if len(text) <= _LONGEST_KEPT else _anew)(parse, text, scope)


def _anew(parse: Callable[[str, Scope], Any], text: str, scope: Scope) -> Any:
    return parse(text, scope)


_kept = functools.lru_cache(maxsize=1024)(_anew)
