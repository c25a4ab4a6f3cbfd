"""Statements: what stands in one field, taken apart at its equality signs before anything in it is read.

``H = T + V = p**2/(2*m) + k*x**2/2`` is one statement of three sides; ``x' = p/m; p' = -k*x`` are two statements.
Every notation is taken apart into these values, each side still in the notation it was written in and at its column.
Only the question can tell what a side is: the name of the answer, a definition from a book, or a part of the answer.
"""

from __future__ import annotations

import re
from bisect import bisect
from dataclasses import dataclass
from itertools import pairwise

from canon.expression.text.tokens import LanguageError

__all__ = ["NAME_BEFORE_SIGN", "Side", "Statement", "opened", "plain_statements", "unwrapped"]


@dataclass(frozen=True, slots=True)
class Side:
    """One side of an equation as it was written.

    Parameters
    ----------
    text
        The whole field with blanks in place of all but this side, so that every column stays where it was; a side in
        LaTeX has ``$`` in the place of the sign before it.
    said
        The side in plain spelling without blanks, as far as it can be a name: ``H``, ``H(q,p)``, ``F_2``, ``p_r'``,
        ``dp/dt``, ``{L_z,x}``, ``T+V``; empty where it can't be one.
    """

    text: str
    said: str = ""

    @property
    def column(self) -> int:
        """Where the side begins in the field, counted from 1."""
        return len(self.text) - len(self.text.lstrip()) + 1


@dataclass(frozen=True, slots=True)
class Statement:
    """An equation, a chain ``a = b = c`` of them, or one expression: sides with ``=`` between neighbours."""

    sides: tuple[Side, ...]


_OPEN, _CLOSE = "([{⟨", ")]}⟩"
_EQUALS = re.compile(r"(?<![<>!:=≠])(?:==|:=|=|≡|≔)(?![=>])")
_ENDS = re.compile(
    r"[;\n]|[⇒⟹∴⇔⟺]|<=>|=>|(?<=\s)(?:and|where|with|mit|wobei|avec|où|donde)(?=\s)"
    r"|(?<=[,;.]\s)(?:i\.\s?e\.,?|d\.\s?h\.|that is,?|(?:or,? )?equivalently,?|es decir,|c['’]est-à-dire"
    r"|hence|thus|so)(?=\s)"
)
MAX_SIDES = 100
"""Most sides in one field."""
NAME_BEFORE_SIGN = (
    r"(?:(?:where|with)\s)?\s*(?:[2-9]\s?)?\\?[^\W\d]\w{0,11}(?:_\{\w{1,9}\})?\s*(?:\^2|\^\{2\}|\*\*2|²)?\s*"
)
"""A name before ``=``, its square, or a few times it: ``2γ = c/m``."""
_LONGEST_DEFINITION = 150
_IN_BRACKETS = re.compile(
    rf"\s\({NAME_BEFORE_SIGN}=[^=]{{1,90}}(?:[,;](?:\\[,;: ]|\\quad)?{NAME_BEFORE_SIGN}=[^=]{{1,90}}){{0,4}}\)[\s.]*$"
)


def plain_statements(text: str) -> tuple[Statement, ...]:
    """Return the statements of a text that is no LaTeX.

    They are parted by ``;``, new lines, ``and``, ``where``, ``with``, ``i.e.``, ``⇒``, and commas between equations,
    not inside brackets.

    Raises
    ------
    LanguageError
        Where there are more than anyone writes in one field.

    Examples
    --------
    >>> [[side.text.strip() for side in s.sides] for s in plain_statements("x' = p/m, p' = -k*x = F")]
    [["x'", 'p/m'], ["p'", '-k*x', 'F']]
    >>> plain_statements("H(q, p) = p**2/2")[0].sides[0].said
    'H(q,p)'
    """
    text = opened(unwrapped(text))
    depths = _depths(text)
    if depths is None:  # brackets that do not close: the parser says where
        return (Statement((_side(text, 0, len(text)),)),)
    signs = [m for m in _EQUALS.finditer(text) if depths[m.start()] == 0]
    parts = _parts(text, depths, [m.start() for m in signs])
    if len(signs) + len(parts) > MAX_SIDES:
        reason = (
            f"{len(signs) + len(parts)} sides of equations, and at most {MAX_SIDES} are read in one field"
        )
        raise LanguageError(text, 1, reason, "split the claim")
    found: list[Statement] = []
    for start, end in parts:
        equals = [m for m in signs if start <= m.start() < end]
        starts = [start, *(m.end() for m in equals)]
        ends = [*(m.start() for m in equals), end]
        if equals and not text[starts[0] : ends[0]].strip():  # it goes on with what stands before the field
            starts, ends = starts[1:], ends[1:]
        sides = tuple(_side(text, a, b) for a, b in zip(starts, ends, strict=True))
        if len(sides) > 1 or text[start:end].strip():
            found.append(Statement(sides))
    return tuple(found) or (Statement((_side(text, 0, len(text)),)),)


def unwrapped(text: str) -> str:
    r"""Return a text without the brackets around a whole equation, ``( L = T - V )``, as ``\( \)`` leaves them.

    Examples
    --------
    >>> unwrapped("(x' = p/m)"), unwrapped("(a + b)*(c + d)"), unwrapped("(1, 2)")
    (" x' = p/m ", '(a + b)*(c + d)', '(1, 2)')
    """
    begin, end = len(text) - len(text.lstrip()), len(text.rstrip(" .,\t\n"))
    if text[begin : begin + 1] not in ("(", "[") or text[end - 1 : end] != _CLOSE[_OPEN.index(text[begin])]:
        return text
    depths = _depths(text)
    whole = depths is not None and all(depths[begin + 1 : end - 1])
    if not whole or not any(depths and depths[m.start()] == 1 for m in _EQUALS.finditer(text)):
        return text
    return f"{text[:begin]} {text[begin + 1 : end - 1]} {text[end:]}"


def opened(text: str) -> str:
    """Return a text with a comma in place of the brackets around a definition behind it.

    Examples
    --------
    >>> opened("I θ'' = -k θ (I = m l²)"), opened("x = a (b + c)")
    ("I θ'' = -k θ ,I = m l² ", 'x = a (b + c)')
    """
    found = _IN_BRACKETS.search(text, max(0, len(text) - _LONGEST_DEFINITION))
    if found is None or not text[: found.start()].strip():
        return text
    begin, end = found.start() + 1, text.rindex(")")
    if _depths(text[begin + 1 : end]) is None:
        return text
    comma = " " if re.search(r"\\q?quad\s*$", text[:begin]) else ","  # a wide gap parts statements as well
    return f"{text[:begin]}{comma}{text[begin + 1 : end]} {text[end + 1 :]}"


def _depths(text: str) -> list[int] | None:
    """Return how many brackets are open at each character; None where they do not close."""
    depths: list[int] = []
    depth = 0
    for character in text:
        if character in _CLOSE:
            depth -= 1
        if depth < 0:
            return None
        depths.append(depth)
        if character in _OPEN:
            depth += 1
    return depths if depth == 0 else None


def _parts(text: str, depths: list[int], signs: list[int]) -> list[tuple[int, int]]:
    """Return where each statement begins and ends; a comma ends one where an equation stands on both sides of it."""
    ends = [m for m in _ENDS.finditer(text) if depths[m.start()] == 0 and not _goes_on(text, m)]
    parts: list[tuple[int, int]] = []
    start = 0
    for stop, after in [*((m.start(), m.end()) for m in ends), (len(text), len(text))]:
        inside = signs[bisect(signs, start - 1) : bisect(signs, stop - 1)]
        if inside and (behind := _definition_behind(text, depths, start, inside[0])):
            parts.append((start, behind - 1))
            start = behind
        for left, right in pairwise(inside):
            commas = [i for i in range(left, right) if text[i] == "," and depths[i] == 0]
            if commas:
                parts.append((start, commas[-1]))
                start = commas[-1] + 1
        parts.append((start, stop))
        start = after
    return parts


def _goes_on(text: str, end: re.Match[str]) -> bool:
    """Tell whether a row goes on with the next one, which begins with ``=`` or a sign, or this one ends with one.

    A row with ``-`` before it that is an equation as the one before it, or as little, stands for itself.
    """
    if end.group() != "\n":
        return False
    begin = 1 + max(text.rfind(mark, 0, end.start()) for mark in ";\n")
    before = text[begin : end.start()].strip()
    after = text[end.end() :].partition("\n")[0].partition(";")[0].strip()
    if not before or not after:
        return False
    if re.search(r"(?<![<>!])[-=+−*/·×]$", before) or re.match(r"=(?![=>])", after):
        return True
    equations = [_EQUALS.search(row) is not None for row in (before, after)]
    return not all(equations) and (after[0] == "+" or (after[0] in "-−" and any(equations)))


def _definition_behind(text: str, depths: list[int], start: int, sign: int) -> int:
    """Return where the name before a sign begins, if a comma sets it apart from an expression; 0 if none does.

    ``½ m v², v = x'`` is an expression, and what v stands for.
    """
    commas = [i for i in range(start, sign) if text[i] == "," and depths[i] == 0]
    apart = (
        bool(commas)
        and text[start : commas[-1]].strip() != ""
        and re.fullmatch(NAME_BEFORE_SIGN, text[commas[-1] + 1 : sign].lstrip())
    )
    return commas[-1] + 1 if apart else 0


def _side(text: str, start: int, end: int) -> Side:
    piece = text[start:end]
    return Side(re.sub(r"\S", " ", text[:start]) + piece.rstrip(), re.sub(r"\s+", "", piece))
