"""Typed dots: rates by full stops behind a letter, ``x.. + 2 beta x. + omega^2 x = 0``, as nothing else is at hand.

Two of them say that dots are meant in a text; one alone may end a sentence.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.text.declared_names import Words
from canon.expression.text.notation import is_latex
from canon.expression.text.scope import split
from canon.expression.text.tokens import MAX_CHARACTERS, LanguageError
from canon.expression.written_rates import has_rate

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["with_typed_dots"]

_NAME = r"(?<![\w.\\])(?P<name>[^\W\d_]\w{0,15})"
_TWO = re.compile(rf"{_NAME}\.\.(?=\s?[-+−=)*/^²,;·]|\s[\w(])")
_ONE = re.compile(rf"{_NAME}\.(?=\s?[-+−=)*/^²·]|[,;])")
_LAST = re.compile(rf"{_NAME}\.{{1,2}}\s*$")


def with_typed_dots(text: str, scope: Scope) -> str:
    """Return a text with primes for the dots that are typed behind coordinates, as long as it was.

    Raises
    ------
    LanguageError
        Where the last dot of such a text may be a full stop as well.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({"x": coordinates("x")})
    >>> with_typed_dots("x.. + 2 x. + x = 0", scope), with_typed_dots("x' = x. + 1", scope)
    ("x'' + 2 x' + x = 0", "x' = x. + 1")
    """
    if ".." not in text or len(text) > MAX_CHARACTERS or is_latex(text):
        return text
    words = Words(text, scope)
    if not any(_is_rate(found["name"], words) for found in _TWO.finditer(text)):
        return text
    for pattern, primes in ((_TWO, "''"), (_ONE, "'")):
        text = pattern.sub(
            lambda found, primes=primes: (
                found["name"] + primes if _is_rate(found["name"], words) else found.group()
            ),
            text,
        )
    last = _LAST.search(text)
    if last and _is_rate(last["name"], words):
        reason = "is the last dot a rate, or the end of the sentence?"
        raise LanguageError(text, last.end("name") + 1, reason, f"write {last['name']}' for the rate")
    return text


def _is_rate(run: str, words: Words) -> bool:
    """Tell whether a run of letters is a coordinate, or ends with one behind factors."""
    return has_rate(run, words) or (has_rate(run[-1], words) and split(run[:-1], words.scope) != "")
