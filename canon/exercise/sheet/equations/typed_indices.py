"""Typed indices: ``m_i x_i'' = -k x_i, i = 1, 2`` is one equation for each number that is said behind it.

Kronecker's delta with a number is 0 or 1; ``(x_1, x_2) = (x, y)`` says what numbered names stand for. Which numbers an
index takes has to be said, and none is summed over.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.text.declared_names import key_of

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["equations_by_index"]

_LONGEST = 1_000
_NUMBERS = re.compile(
    r"(?:,\s*|\s+|\s*\()(?:(?:for|with|where|für|mit|pour|avec|para|per)\s+)?(?P<index>[a-n])\s?(?:=|∈|in)\s?\{?\s?"
    r"(?P<numbers>1\s?,\s?2(?:\s?,\s?3(?:\s?,\s?4)?)?)\s?\}?\)?(?=\s*(?:[.,;]|$))"
)
_MEANS = re.compile(
    r"[,;]?\s*(?:(?:with|where|mit|wobei|avec)\s+)?\((?P<names>[\w, ]{3,60})\)\s?=\s?\((?P<values>[\w, ]{3,60})\)\s*"
)
_DELTA = re.compile(r"(?:delta|δ)_(?:\{(?P<a>\d)[ ,]?(?P<b>\d)\}|(?P<c>\d)(?P<d>\d))(?!\w)")


def equations_by_index(text: str, scope: Scope) -> str:
    """Return an equation with an index as equations, one for each number, semicolons between; other texts as they are.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({s.name: s for s in (*coordinates("x1 x2"), *parameters("m k"))})
    >>> equations_by_index("m x_i'' = -k x_i, i = 1, 2", scope), equations_by_index("m x_i'' = -k x_i", scope)
    ("m x_1'' = -k x_1; m x_2'' = -k x_2", "m x_i'' = -k x_i")
    """
    found = _NUMBERS.search(text) if len(text) <= _LONGEST and "\\" not in text and "$" not in text else None
    if found is None or scope.declares(found["index"]):
        return text
    rest, index = f"{text[: found.start()]} {text[found.end() :]}", found["index"]
    means = _MEANS.search(rest)
    names: dict[str, str] = {}
    if means:
        left, right = ([each.strip() for each in means[side].split(",")] for side in ("names", "values"))
        known = {key_of(name) for name in scope.spelled}
        if len(left) != len(right) or any(key_of(name) in known for name in left):
            return text
        names = dict(zip(left, right, strict=True))
        rest = f"{rest[: means.start()]} {rest[means.end() :]}"
    equation = re.sub(rf"('{{1,2}})(_\{{?{index}\}}?)(?!\w)", r"\2\1", rest.strip(" .,;"))
    if not _has_index(equation, index):
        return text
    made = [_numbered(equation, index, number.strip()) for number in found["numbers"].split(",")]
    return "; ".join(_named(each, names) for each in made)


def _has_index(equation: str, index: str) -> bool:
    """Tell whether both sides of one equation have the index, nothing is summed, and it is no factor by itself."""
    sides = equation.split("=")
    subscript = rf"_(?:\{{\s?)?{index}(?![A-Za-z_])"
    summed = re.search(r"[∑Σ]|(?<!\w)[Ss]um(?!\w)|;", equation)
    alone = re.search(rf"(?<![\w{{]){index}(?!\w)", equation)
    return (
        len(sides) == 2
        and not summed
        and not alone
        and all(re.search(subscript, side) or _is_zero(side) for side in sides)
    )


def _is_zero(side: str) -> bool:
    return side.strip() == "0"


def _numbered(equation: str, index: str, number: str) -> str:
    """Return an equation with a number for its index, deltas worked out."""
    said = re.sub(rf"_\{{\s?{index}\s?\}}|_{index}(?![A-Za-z0-9_])", f"_{number}", equation)
    said = re.sub(
        rf"(?P<delta>delta|δ)_(?P<brace>\{{?){index}(?=[ ,]?\d)", rf"\g<delta>_\g<brace>{number}", said
    )
    return _DELTA.sub(lambda m: f"({int((m['a'] or m['c']) == (m['b'] or m['d']))}*1)", said)


def _named(equation: str, names: dict[str, str]) -> str:
    for name, value in names.items():
        equation = re.sub(rf"(?<!\w){re.escape(name)}(?!\w)", value, equation)
    return equation
