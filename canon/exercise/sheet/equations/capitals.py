"""Capitals that a keyboard made: ``Theta'' + g/l*Sin(Theta) = 0`` where theta is asked, and answers in capitals only.

A capital is read as the small letter only where the whole of the answers leaves nothing else that it could be.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from canon.expression.symbols.symbol import Coordinate
from canon.expression.text.declared_names import function_name, key_of
from canon.expression.text.scope import split
from canon.expression.text.tokens import GREEK, LanguageError, tokens

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.expression.text.scope import Scope
    from canon.expression.text.tokens import Token

__all__ = ["lowered"]

_LONGEST = 2_000
_LABEL = re.compile(r"\s*[A-Z](?:_?\d)?\s?(?:\([^()=]{1,40}\))?\s?=(?!=)")
"""A name of the answer before its sign, which stays as it is."""
_LEAST = 3
"""Names in capitals that an answer has at least, to be one in capitals only."""
_WORDS = frozenset(name.capitalize() for name in GREEK.values())


def lowered(texts: Sequence[str], keys: Mapping[str, Any], scope: Scope) -> Mapping[str, str]:
    """Return the texts of the answers that are to be read in small letters, by what was typed.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({s.name: s for s in (coordinates("theta"), *parameters("g l m"))})
    >>> lowered(["Theta'' = -g/l*Sin(Theta)"], {}, scope)
    {"Theta'' = -g/l*Sin(Theta)": "theta'' = -g/l*Sin(theta)"}
    >>> lowered(["Theta'' = -g/l*sin(theta)"], {}, scope), lowered(["M G L COS(THETA)"], {}, scope)
    ({}, {'M G L COS(THETA)': 'm g l cos(theta)'})
    """
    if not texts or sum(map(len, texts)) > _LONGEST or any("\\" in text or "$" in text for text in texts):
        return {}
    try:
        found = [tokens(re.sub("[;:\n]", ",", text)) for text in texts]
    except LanguageError:
        return {}
    if not any(char.islower() for text in texts for char in text):
        return _all_lowered(texts, keys, scope)
    words = [token for each in found for token in each if token.atoms]
    capitals = {token.text for token in words if _is_coordinate(token, words, scope)}
    capitals = {name for name in capitals if not _is_defined(name, texts)}
    if not capitals:
        return {}
    return {text: _with_small(text, each, capitals) for text, each in zip(texts, found, strict=True)}


def _is_coordinate(token: Token, words: Sequence[Token], scope: Scope) -> bool:
    """Tell whether a rate in capitals can be that of one coordinate only, which is written in no other way."""
    name = token.text.lower()
    if not token.primes or name == token.text or _is_known(token.text, scope):
        return False
    q = [key for key, symbol in scope.names.items() if isinstance(symbol, Coordinate)]
    alone = token.text in _WORDS or (len(token.text) == 1 and len(q) == 1)
    return alone and name in q and not any(name in word.text for word in words)


def _is_defined(name: str, texts: Sequence[str]) -> bool:
    return any(re.search(rf"(?<!\w){name}(?:\(t\))?\s?:?=", text) for text in texts)


def _is_known(name: str, scope: Scope) -> bool:
    known = {key_of(each) for each in scope.spelled}
    return name in scope.functions or key_of(name) in known or split(name, scope) != ""


def _with_small(text: str, found: Sequence[Token], capitals: set[str]) -> str:
    """Return a text with small letters for some names; a Greek capital is spelled in Latin letters then."""
    for token in reversed([token for token in found if token.text in capitals]):
        at = token.column - 1
        end = at + (len(token.text) if text.startswith(token.text, at) else 1)
        text = f"{text[:at]}{token.text.lower()}{text[end:]}"
    return text


def _all_lowered(texts: Sequence[str], keys: Mapping[str, Any], scope: Scope) -> Mapping[str, str]:
    """Return answers in capitals only in small letters, where every name is one of the question then."""
    made: dict[str, str] = {}
    names: set[str] = set()
    for text in texts:
        label = _LABEL.match(text)
        begin = label.end() if label else 0
        said = [token for token in tokens(re.sub("[;:\n]", ",", text[begin:])) if token.atoms]
        if not all(_is_small(token.text, keys, scope) for token in said):
            return {}
        names |= {token.text for token in said}
        made[text] = text[:begin] + text[begin:].lower()
    return made if len(names) >= _LEAST else {}


def _is_small(name: str, keys: Mapping[str, Any], scope: Scope) -> bool:
    """Tell whether a name in capitals is one of the question in small letters, and no other is meant by it."""
    if _is_known(name, scope) or isinstance(keys.get(name), str):
        return False
    small = name.lower()
    return _is_known(small, scope) or function_name(small, scope) != ""
