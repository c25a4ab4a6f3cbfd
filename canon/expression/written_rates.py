r"""Rates in notations of their own, ``¨x``, ``ddot x``, ``x_{tt}``, ``ddx``, ``(D@@2)(x)(t)``, made primes or dots.

Dots that a PDF sets before the letter, AsciiMath's words, subscripts of the time, letters as programs write them,
Maple's operator. Each is read of a declared coordinate only, where no other reading is left; a text keeps its length.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.text.declared_names import Words
from canon.expression.text.notation import is_latex
from canon.expression.text.tokens import MAX_CHARACTERS, LanguageError, tokens

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["has_rate", "with_primes"]

_NAME = r"[^\W\d_]\w{0,15}"
_MAPLE = re.compile(rf"\(\s?D\s?@@\s?([1-4])\s?\)\s?\(\s?({_NAME})\s?\)(?=\s?\()")
_DOT_BEFORE = re.compile(rf"(?P<before>{_NAME})?(?P<dots>[¨˙])(?P<letter>[^\W\d_])")
_DOT_APART = re.compile(
    rf"(?P<before>{_NAME}[ ])?(?P<dots>[¨˙])[ ](?P<letter>[^\W\d_](?:_?[0-9₀-₉]{{1,2}})?)(?![^\W²³⁴])"
)
"""The same with blanks on both sides, as some readers of PDF copy it."""
_ABOVE = {"¨": "\u0308", "˙": "\u0307"}
_WORD = re.compile(
    rf"(?<![\w\\])(?P<dots>d?dot)(?:\s?\(\s?(?P<inside>{_NAME})\s?\)|\s{{1,3}}(?P<name>{_NAME}))"
)
_FACTOR_BEFORE = re.compile(r"[\w)\]}'′″]\s*$")
_PREFIXED = re.compile(rf"(?<![\w\\])(?P<d>dd?)(?P<name>{_NAME})(?!\w|\s?/\s?d)")
_OVER = re.compile(r"(?<!\w)d\w*\s?/\s?$")
_SIGN = re.compile(r"@@|[¨˙]|(?<![\w\\])(?:d?dot(?!\w)|dd[^\W\d_])")
"""What only these notations have, beside subscripts of the time."""
_LETTER = r"\\?[^\W\d_]{1,20}"


def with_primes(text: str, scope: Scope) -> str:
    r"""Return a text with the rates of declared coordinates in primes and dots, as long as it was.

    Raises
    ------
    LanguageError
        Where ``dot`` may be a product of two vectors as well.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({"x": coordinates("x")})
    >>> with_primes("ddot x = -x", scope), with_primes("ddx = -dx", scope), with_primes("$x_{tt} = -x$", scope)
    ("   x'' = -x", "x'' = -x'", "$x''    = -x$")
    >>> with_primes("(D@@2)(x)(t)", scope).strip(), len(with_primes("¨x", scope))
    ("x''(t)", 2)
    """
    t = re.escape(scope.time.name)
    if len(text) > MAX_CHARACTERS or not (_SIGN.search(text) or re.search(rf"_\{{?\s?{t}\s?{t}", text)):
        return text
    words = Words(text, scope)
    if "_" in text:
        text = _of_subscripts(text, words)
    if is_latex(text):
        return text
    if "@@" in text:
        text = _MAPLE.sub(lambda found: _primed(found, found[2], int(found[1])), text)
    if "¨" in text or "˙" in text:
        text = _DOT_BEFORE.sub(lambda found: _behind(found, words), text)
        text = _of_dots_apart(text, words)
    if "dot" in text:
        text = _of_words(text, words)
    return _of_letters(text, words) if "dd" in text else text


def has_rate(name: str, words: Words) -> bool:
    """Tell whether a name, as it is typed, is that of one declared coordinate."""
    try:
        plain = tokens(name)[0].text
    except LanguageError:
        return False
    found = words.declared(plain)
    return len(found) == 1 and words.scope.declares(f"{found[0]}_dot")


def _primed(found: re.Match[str], name: str, order: int) -> str:
    return f"{name}{chr(39) * order}".rjust(len(found.group()))


def _of_dots_apart(text: str, words: Words) -> str:
    """Return a text with the dots that stand between blanks on the letters behind them.

    ``r ˙ φ`` is r φ̇ where all dots stand before coordinates, and one of them behind none: ``m ¨ r = m r ˙ φ²``.
    """
    found = [*_DOT_APART.finditer(text)]
    first = any(not _is_own(each, words) for each in found)
    all_before = len(found) == len(re.findall("[¨˙]", text)) and all(
        has_rate(f["letter"], words) for f in found
    )
    return _DOT_APART.sub(lambda each: _behind(each, words, lead=first and all_before), text)


def _is_own(found: re.Match[str], words: Words) -> bool:
    """Tell whether dots may belong to the coordinate before them."""
    before = (found["before"] or "").strip()
    return bool(before) and (has_rate(before, words) or has_rate(before[-1], words))


def _behind(found: re.Match[str], words: Words, *, lead: bool = False) -> str:
    """Return a letter with the dots that stood before it; those behind a coordinate are its own, unless they lead."""
    before, letter = (found["before"] or "").strip(), found["letter"]
    own = not lead and _is_own(found, words)
    if own or (before and not has_rate(letter, words)):
        return found.group()
    dotted = f"{letter[0]}{_ABOVE[found['dots']]}{letter[1:]}"
    return f"{found['before'] or ''}{dotted:>{len(found.group()) - len(found['before'] or '')}}"


def _of_words(text: str, words: Words) -> str:
    """Return a text with AsciiMath's ``dot x`` and ``ddot(theta)`` in primes."""
    if words.declared("dot") or words.declared("ddot"):
        return text
    second = "ddot" in text

    def read(found: re.Match[str]) -> str:
        name = found["inside"] or found["name"]
        if not has_rate(name, words):
            return found.group()
        if not second and _FACTOR_BEFORE.search(found.string[: found.start()]):
            reason = "is dot a product here, or the rate of what follows?"
            raise LanguageError(found.string, found.start() + 1, reason, f"write {name}', or * for a product")
        return _primed(found, name, 2 if found["dots"] == "ddot" else 1)

    return _WORD.sub(read, text)


def _of_letters(text: str, words: Words) -> str:
    """Return a text with the ``ddx`` of programs in primes, and their ``dx`` beside it, no differential then."""
    found = [each for each in _PREFIXED.finditer(text) if _is_rate_by_letter(each, words)]
    if words.declared("d") or not any(each["d"] == "dd" for each in found):
        return text
    for each in found:
        text = f"{text[: each.start()]}{each['name']}{chr(39) * len(each['d'])}{text[each.end() :]}"
    return text


def _is_rate_by_letter(found: re.Match[str], words: Words) -> bool:
    if _OVER.search(found.string[max(0, found.start() - 20) : found.start()]):  # dr/dphi
        return False
    return not words.declared(found.group()) and has_rate(found["name"], words)


def _of_subscripts(text: str, words: Words) -> str:
    """Return a text with ``x_{tt}`` in primes, and with ``x_t`` beside it."""
    t, bare = re.escape(words.scope.time.name), r"|{}(?!\w)" * (not is_latex(text))
    seconds = re.compile(rf"(?P<name>{_LETTER})_(?:\{{\s?{t}\s?{t}\s?\}}{bare.format(t * 2)})")
    firsts = re.compile(rf"(?P<name>{_LETTER})_(?:\{{\s?{t}\s?\}}|{t}(?!\w))")
    if not any(_has_subscript(found, words, t * 2) for found in seconds.finditer(text)):
        return text
    for pattern, order in ((seconds, 2), (firsts, 1)):
        text = pattern.sub(lambda found, n=order: _lowered(found, words, t * n, n), text)
    return text


def _lowered(found: re.Match[str], words: Words, index: str, order: int) -> str:
    if not _has_subscript(found, words, index):
        return found.group()
    return f"{found['name']}{chr(39) * order}".ljust(len(found.group()))


def _has_subscript(found: re.Match[str], words: Words, index: str) -> bool:
    """Tell whether a name, or the last letter of a run, is a coordinate and is not declared with that subscript."""
    run = found["name"].lstrip("\\")
    names = (run,) if found["name"].startswith("\\") else (run, run[-1])
    return any(has_rate(name, words) and not words.declared(f"{name}_{index}") for name in names)
