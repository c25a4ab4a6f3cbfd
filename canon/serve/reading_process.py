"""Reading process: a child process that reads texts as a claim would, for people who see what they type."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import Element, SubElement, tostring

from canon.exercise.sheet.answers.typed_answers import typed_answers
from canon.exercise.sheet.key_shapes import faults, with_plain_names
from canon.exercise.sheet.kind import COMMON, Shape
from canon.exercise.sheet.kinds import KINDS
from canon.exercise.sheet.reading import InvalidClaim, Reading
from canon.exercise.sheet.sheet import Claim, ClaimError
from canon.expression.mathml import MAX_CHARACTERS, mathml
from canon.expression.parse import (
    LanguageError,
    parse_condition,
    parse_expression,
    statements_of,
    syntax_of,
)
from canon.expression.text.syntax import Call, Comparison
from canon.frozen_mapping import FrozenMapping
from canon.process import serve

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.expression.text.scope import Scope
    from canon.expression.text.statement import Statement

__all__ = ["how_read", "main"]

MEMORY = 1024**3
LONGEST_PLAIN = 5_000
"""Characters of the plain form that is told."""
_WHERE = ("text", "key", "kind")
"""What is asked, beside the declared names."""


def how_read(asked: Mapping[str, Any]) -> dict[str, Any]:
    """Return how a text is read: its statements as MathML and in plain spelling, or what is wrong and where.

    Parameters
    ----------
    asked
        ``text``; the keys of a claim that declare names (``q``, ``p``, ``x``, ``parameters``, ``functions``, …); and
        where it stands in a claim, the ``kind`` of that and the ``key``. Under a key may stand what does in a claim.

    Examples
    --------
    >>> found = how_read({"text": "theta'' + g*sin(theta) = 0", "q": ["theta"], "parameters": {"g": "real"}})
    >>> [statement["plain"] for statement in found["statements"]]
    ['g*sin(theta) + theta_ddot = 0']
    >>> how_read({"text": "2*z", "q": ["x"]})["error"]["column"]
    3
    """
    try:
        claim = _claim(asked)
        written = Reading(claim)
        scope, key = written.scope, str(asked.get("key", ""))
        plain = typed_answers(claim, scope, written.error) if key else None
        value: Any = plain.keys[key] if plain else asked["text"]
        links = [] if plain is None else plain.links
        shown = [
            statement
            for place, text in (*_texts(key or "text", value), *((link.place, link.text) for link in links))
            for statement in _statements(place, text, written)
        ]
        warnings = [] if plain is None else [*plain.passed, *written.warnings]
    except InvalidClaim as error:
        found = error.error
        told = {"place": found.key, "column": found.column, "reason": found.reason, "caret": found.caret}
        return {"read": False, "error": told}
    return {"read": True, "statements": shown, "warnings": warnings}


def _claim(asked: Mapping[str, Any]) -> Claim:
    """Return a claim of nothing but the declared names, and the text where it stands under a key."""
    declared = {name: value for name, value in asked.items() if name not in _WHERE}
    text, key, kind = asked.get("text"), asked.get("key", ""), asked.get("kind") or _kind_of_names(declared)
    if not isinstance(kind, str) or not isinstance(key, str):
        raise _invalid("kind", "kind and key should be words")
    if not key and not isinstance(text, str):
        raise _invalid("text", "should be a text; what stands under a key of a claim needs kind and key")
    keys = {**declared, **({key: text} if key else {})}
    keys = with_plain_names(kind, keys)
    for place, reason in faults(kind, {"id": "text", "kind": kind, **keys}):
        if place in keys or place in ("kind", "of"):
            raise _invalid(place, reason)
    return Claim("text", kind, FrozenMapping(keys))


def _kind_of_names(declared: Mapping[str, Any]) -> str:
    """Return a kind of claim that declares names by these keys, for a text that stands in none."""
    for kind, said in KINDS.items():
        if all(name in COMMON or said.shapes.get(name) is Shape.NAMES for name in declared):
            return kind
    raise _invalid(
        "kind", f"no kind of claim has names under all of {', '.join(declared)[:200]}; say the kind"
    )


def _invalid(place: str, reason: str) -> InvalidClaim:
    return InvalidClaim(ClaimError("text", place, reason))


def _texts(place: str, value: Any) -> Iterator[tuple[str, str]]:
    """Yield every text of a value with its place."""
    if isinstance(value, Mapping):
        for name, item in value.items():
            yield from _texts(f"{place}.{name}", item)
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from _texts(f"{place}[{i}]", item)
    else:
        yield place, str(value)


def _statements(place: str, text: str, reading: Reading) -> Iterator[dict[str, str]]:
    try:
        scope = reading.scope_of(place)
        for statement in statements_of(text, scope):
            yield {"place": place, **_set(statement, scope)}
    except LanguageError as error:
        raise reading.error(place, error.at_home_in(text)) from None


def _set(statement: Statement, scope: Scope) -> dict[str, str]:
    """Return a statement as MathML, and spelled in the language of canon."""
    row, plain = Element("mrow"), list[str]()
    for side in statement.sides:
        node = syntax_of(side.text, scope)
        if len(row):
            SubElement(row, "mo").text = "="
        row.append(mathml(node))
        condition = isinstance(node, Comparison) or (isinstance(node, Call) and node.function == "Ne")
        plain.append(str((parse_condition if condition else parse_expression)(side.text, scope)))
    math = Element("math", {"display": "block"})
    math.append(row)
    told = " = ".join(plain)
    short = sum(len(side.text.strip()) for side in statement.sides) <= MAX_CHARACTERS
    return {"mathml": tostring(math, encoding="unicode") if short else "", "plain": told[:LONGEST_PLAIN]}


def main() -> None:
    """Read what comes in until the parent closes the pipe."""
    how_read({"text": "$x$", "q": ["x"]})  # LaTeX's grammar is in memory before anybody waits for it

    def answers(message: bytes) -> Iterator[bytes]:
        yield json.dumps(how_read(json.loads(message))).encode()

    serve(answers, MEMORY)
