r"""Prose around a formula: words that lead to it, its heading, and what is said of it behind.

``**Equation of motion:** $m\ddot x + kx = 0$``, ``Die Bewegungsgleichung lautet m x'' = -k x``, ``m x'' = -k x, where k
is the spring constant``. Words are passed over where none of them can stand in a formula of the question and none may
change what it says, as ``not`` and ``approximately`` do.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.symbols.symbol import Coordinate
from canon.expression.text.declared_names import Words, function_name
from canon.expression.text.tokens import GREEK, MAX_CHARACTERS, LanguageError, tokens
from canon.expression.text.vocabulary import CONSTANTS, OTHER_NAMES

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["CHANGING", "SMALL", "is_known", "without_prose"]

SMALL = frozenset((
    "a", "an", "and", "as", "at", "by", "for", "from", "in", "is", "it", "its", "of", "on", "so", "the", "to",
    "we", "all", "da", "das", "der", "die", "es", "im", "la", "le", "el", "lo", "du", "de", "en", "un", "est",
    "que", "por", "se", "los",
))  # fmt: skip
"""Words of few letters that are in no formula."""
CHANGING = frozenset((
    "about", "almost", "approximately", "except", "false", "half", "if", "incorrect", "minus", "never", "no",
    "not", "only", "or", "plus", "roughly", "squared", "times", "twice", "unless", "when", "wrong", "nicht",
    "falsch", "pas", "falso",
))  # fmt: skip
"""Words that may change what the formula says."""
_LEADING = frozenset((
    "also", "are", "becomes", "equals", "find", "follows", "get", "gets", "gives", "have", "hence", "is",
    "obtain", "obtains", "reads", "so", "that", "then", "therefore", "thus", "yields", "using", "from", "leads",
    "to", "lautet", "lauten", "ist", "folgt", "somit", "daher", "dann", "donc", "ainsi", "alors", "est",
    "trouve", "obtient", "tanto", "entonces", "luego", "es", "resulta", "obtenemos", "quindi", "dunque",
))  # fmt: skip
"""Words that a formula may follow."""
_TELLING = (
    "which|where|this|that|as|because|since|for|with|the|it|these|here|wobei|dies|das|où|ce|cela|donde|esto"
)
"""Words that a sentence behind a formula begins with."""
_MARKS = re.compile(r"\s*(?:(?:[>✅☑✔→⟶•▪]|-{1,2}>|<=>|#{1,6}(?=\s))\s*)*(?:\*\*(?=[^\W\d_]{2}))?")
_BULLET = re.compile(r"\s*[-*]\s+")
_WORD = r"(?:[^\W\d_]{2,}(?:['’][^\W\d_]{1,9})?(?:[.-][^\W\d_]+)*|[^\W\d_](?!['’]))"
_HEADING = re.compile(
    rf"(?P<words>{_WORD}(?:[ ,]{{1,3}}{_WORD}){{0,7}})(?: ?\(?\d{{1,2}}\)?)?[*_]{{0,2}}"
    r"(?: ?:(?![=:])[*_]{0,2}(?=[\s$\\(*])|\s*\n)\s*"
)
_LEADING_WORD = re.compile(rf"(?P<word>{_WORD})[,:]?(?:\s+|(?=\$))")
_UPRIGHT = re.compile(
    r"\\(?:text|textrm|textbf|mathrm)\s?\{\s*(?P<words>[^\W\d_][^{}=\\$]{1,60})\}(?:\s|\\q?quad(?![A-Za-z])|\\[,;: ])*"
    r"(?=[^\s=+*/^-])"
)
_SENTENCE = re.compile(
    r"(?:[\s.,;$]|\\\]|\\q?quad(?![A-Za-z])|\\[,;: ]){1,12}(?:\\(?:text|textrm)\s?\{\s*)?"
    rf"(?P<words>(?:{_TELLING})\b[\w\s$'’,.;:()–{{}}\\-]{{2,200}})$",
    re.IGNORECASE,
)
_LONGEST_SENTENCE = 240
"""Characters of a sentence that is looked for behind a formula."""
_MOST_WORDS = 12
_SHORT = 3
"""Letters of the shortest word that is one."""


def without_prose(text: str, scope: Scope) -> str:
    r"""Return a text with blanks in place of the words before and behind its formula.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({"x": coordinates("x")})
    >>> [without_prose(text, scope).strip() for text in ("Bewegungsgleichung: x'' = -x", "x'' = -x for all t")]
    ["x'' = -x", "x'' = -x"]
    >>> without_prose("mass x'' = -x", scope)
    "mass x'' = -x"
    """
    if (
        len(text) > MAX_CHARACTERS
        or not re.search(r"[=+*/^\\\d$'′]", text)
        or not re.search(r"[^\W\d_]{2}|[:>✅☑✔→⟶•▪]", text)
    ):
        return text
    words = Words(text, scope)
    begin = _beginning(text, words)
    end = _end(text, begin, words)
    return text if (begin, end) == (0, len(text)) else " " * begin + text[begin:end]


def _beginning(text: str, words: Words) -> int:
    """Return where the formula begins behind marks, headings and the words that lead to it."""
    marks = _MARKS.match(text)
    begin = marks.end() if marks and marks.group().strip() and text[marks.end() :].strip() else 0
    bullet = _BULLET.match(text, begin)
    if bullet and (behind := _heading_end(text, bullet.end(), words)) > bullet.end():
        begin = behind
    for _ in range(3):
        found = max(step(text, begin, words) for step in (_heading_end, _upright_end, _lead_end))
        if found == begin or not text[found:].strip():
            break
        begin = found
    return begin


def _heading_end(text: str, begin: int, words: Words) -> int:
    """Return the end of ``Equation of motion:`` or of a line of words."""
    marked = re.search(r"#{1,6}\s|\*\*$", text[:begin]) is not None
    begin += len(text[begin:]) - len(text[begin:].lstrip())
    found = _HEADING.match(text, begin)
    if found is None or not (marked or ":" in found.group()):
        return begin
    said = re.findall(_WORD, found["words"])
    coordinates = [word for word in said if isinstance(words.scope.symbol(word), Coordinate)]
    others = [word for word in said if word not in coordinates]
    named = not others and coordinates and "=" in text[found.end() :]  # x: m x'' = …, and not x : 1
    return found.end() if named or _is_prose(others, words) else begin


def _upright_end(text: str, begin: int, words: Words) -> int:
    r"""Return the end of ``\text{Thus, }``."""
    begin += len(text[begin:]) - len(text[begin:].lstrip())
    found = _UPRIGHT.match(text, begin)
    return found.end() if found and _is_prose(re.findall(_WORD, found["words"]), words) else begin


def _lead_end(text: str, begin: int, words: Words) -> int:
    """Return the end of the words that lead to a formula, the last of which says so: ``… lautet``, ``we get``."""
    at = end = begin + len(text[begin:]) - len(text[begin:].lstrip())
    for _ in range(_MOST_WORDS):
        found = _LEADING_WORD.match(text, at)
        if found is None:
            break
        word = re.sub(r"['’]s$", "", found["word"])
        if not _is_prose([word], words) and word.lower() not in SMALL and word != "I":
            break
        at = found.end()
        if word.lower() in _LEADING:
            end = at
    return end if re.match(r"[^=+*/^]", text[end:]) else begin


def _end(text: str, begin: int, words: Words) -> int:
    """Return where a sentence behind the formula begins."""
    found = _SENTENCE.search(text, max(begin, len(text) - _LONGEST_SENTENCE))
    if found is None or not re.search(r"[\w)\]}'′″²³$]$", text[begin : found.start()]):
        return len(text)
    said = [re.sub(r"['’]s$", "", word) for word in re.findall(_WORD, found["words"])]
    short = [word for word in said if len(word) < _SHORT or word in GREEK or word in GREEK.values()]
    others = [word for word in said if word not in short]
    return found.start() if len(said) > 1 and _is_prose(others, words) else len(text)


def _is_prose(said: list[str], words: Words) -> bool:
    """Tell whether none of some words can stand in a formula, and none may change what it says."""
    if not said or CHANGING.intersection(word.lower() for word in said):
        return False
    other = [word for word in said if word.lower() not in SMALL]
    return all(len(word) >= _SHORT and not is_known(word, words) for word in other)


def is_known(word: str, words: Words) -> bool:
    """Tell whether a word, or the letters that it is made of, can stand in a formula."""
    if word in CONSTANTS or word in OTHER_NAMES or word in GREEK.values() or function_name(word, words.scope):
        return True
    try:
        (token, *_) = tokens(word)
        read = words.read(token, bracket=False)
    except LanguageError as error:
        return "can be read as" in error.reason
    parts = [part.text for part in read if part.text != "d"]  # of a differential
    known = (words.declared(part) or part.isdigit() or function_name(part, words.scope) for part in parts)
    return bool(parts) and all(known)
