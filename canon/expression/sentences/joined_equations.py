"""Joined equations: words, signs and punctuation of other languages between them, made what this language has.

``r'' = a oraz φ'' = b``, ``x'' = 0 & y'' = -g``, ``ｍｘ'' ＝ －ｋｘ、y'' = 0。`` A word is taken for one that joins
only where it is no name of the question and an equality sign stands on either side of it.
"""

from __future__ import annotations

import re
from itertools import accumulate
from typing import TYPE_CHECKING

from canon.expression.sentences.known_words import ALSO, HARMLESS, SO, WHERE
from canon.expression.text.declared_names import key_of
from canon.expression.text.notation import is_latex
from canon.expression.text.scope import split
from canon.expression.text.statement import NAME_BEFORE_SIGN
from canon.expression.text.tokens import MAX_CHARACTERS, LanguageError, tokens

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["plainly_joined"]

_WIDE = {code: chr(code - 0xFEE0) for code in range(0xFF01, 0xFF5F)} | {ord("、"): ",", ord("\u3000"): " "}
"""Full-width letters and signs, as they are typed in Japan and China."""
_STOP = re.compile(r"。(?=\s*(?P<more>\S)?)")
_EQUALS = re.compile(r"(?<![<>!])=|≡")
_ALSO = "|".join(sorted(map(re.escape, ALSO - {"&", "|"}), key=len, reverse=True))
_SO = "|".join(sorted(SO, key=len, reverse=True))
_WHERE = "|".join(sorted(WHERE, key=len, reverse=True))
_EASTERN = "即|亦即|也就是|すなわち|즉"
"""*That is* in Chinese, Japanese and Korean."""
_JOINT = re.compile(
    rf"(?<=\s)(?:{_ALSO}|&|(?<=\s\s)\|(?=\s\s)|resp\.|bzw\.|respektive)(?=\s)|(?<=\s)(?:{_WHERE})(?=[\s,:$])"
    rf"|(?<=[,;.]\s)(?:{_SO})(?=[\s,:$])|(?<=[,;.]\s)(?:{_EASTERN})|(?<=[,;])(?:{_EASTERN})"
)
_UPRIGHT = re.compile(
    rf"\\(?:text|textrm|mbox|mathrm)\s?\{{[\s~]*(?:{_ALSO}|{_WHERE})[\s~]*\}}", re.IGNORECASE
)
_DEFINES = re.compile(
    rf"(?P<words>(?:\s*[^\W\d_]{{2,24}}(?=[\s$])){{0,6}})(?P<name>[\s$]*[2-9]?{NAME_BEFORE_SIGN}(?:=|≡|:=|\\equiv))"
)
"""What an abbreviation begins with, and words before its name: ``with the cyclotron frequency Ω :=``."""
_COLON = re.compile(r"(?<=[\w)\]'′″²³]):(?=\s)")
_DEFINED = re.compile(r"\s*(?P<name>[^\W\d_]{1,9}_?\d{0,2})(?:\^2|²|\*\*2)?\s*:?=(?P<value>[^=:,;<>]{1,60})")
"""A name before its value."""
_MAPLES_END = re.compile(r"(?<=[\w)\]}'′″])\s?:\s*$")
_JOINS = re.compile(r"[\w)\]}'′″˙\u0307\u0308²³.,;:$]\s*$")
"""What may stand before a word that joins: the end of an equation."""
_LONGEST_SIDE = 2_000


def plainly_joined(text: str, scope: Scope) -> str:
    """Return a text whose equations are parted by ``;`` where words of other languages part them, as long as it was.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({"x": coordinates("x"), "z": coordinates("z")})
    >>> plainly_joined("x'' = 0 oraz z'' = 1", scope), plainly_joined("ｘ'' ＝ ０、z'' = 1。", scope)
    ("x'' = 0 ;    z'' = 1", "x'' = 0,z'' = 1.")
    >>> plainly_joined("x'' = 0 lub z'' = 1", scope)
    "x'' = 0 lub z'' = 1"
    """
    if len(text) > MAX_CHARACTERS:
        return text
    text = _STOP.sub(lambda found: ";" if found["more"] else ".", text.translate(_WIDE))
    text = _MAPLES_END.sub(lambda found: " " * len(found.group()), text)
    if len(text) > _LONGEST_SIDE or not _EQUALS.search(text):
        return text
    if not is_latex(text):
        return _with_semicolons(_without_colon(text, scope), scope)
    return _with_semicolons(_UPRIGHT.sub(lambda found: _upright(found, scope), text), scope)


def _without_colon(text: str, scope: Scope) -> str:
    """Return a text with ``;`` for the colon behind definitions of names that are used behind it.

    ``z1 = θ, z2 = θ': z1' = z2`` is read; in ``k = 0: x'' = 0`` what stands before the colon is a case.
    """
    colons = [*_COLON.finditer(text)]
    if len(colons) != 1 or "=" not in text[colons[0].end() :]:
        return text
    before, behind = text[: colons[0].start()], text[colons[0].end() :]
    defined = [_DEFINED.fullmatch(part) for part in re.split("[,;]", before)]
    return f"{before};{behind}" if all(each and _defines(each, behind, scope) for each in defined) else text


def _defines(found: re.Match[str], behind: str, scope: Scope) -> bool:
    """Tell whether a name is new, its value one of declared names, and used behind it."""
    known = {key_of(name) for name in scope.spelled}
    of_known = any(key_of(word) in known for word in _words(found["value"]))
    return of_known and found["name"] in _words(behind) and not _is_name(found["name"], scope)


def _words(text: str) -> list[str]:
    """Return the names in a text in plain spelling; none of what has signs of another language."""
    try:
        return [token.text for token in tokens(re.sub("[;:\n]", ",", text)) if token.kind == "name"]
    except LanguageError:
        return []


def _with_semicolons(text: str, scope: Scope) -> str:
    r"""Return a text with ``;`` for the words that join two equations, or an equation and a definition."""
    depths = [*accumulate((sign in "([{") - (sign in ")]}") for sign in text)]
    equals = [found.start() for found in _EQUALS.finditer(text) if depths[found.start()] == 0]
    signs = [*text]
    for found in _JOINT.finditer(text):
        begin, end = found.span()
        between = equals and equals[0] < begin and end < equals[-1] and _JOINS.search(text[:begin])
        if depths[begin] != 0 or not between or _is_name(found.group(), scope):
            continue
        if found.group().lower() in WHERE:
            end = _start_of_definition(text, end, scope)
        elif (found.group() == "|" and text.count("|") > 1) or (found.group() == "&" and is_latex(text)):
            continue
        if end > begin:
            signs[begin:end] = ";".ljust(end - begin)
    return "".join(signs)


def _start_of_definition(text: str, at: int, scope: Scope) -> int:
    """Return where the name begins that is defined behind ``where``, known words before it; 0 if none is."""
    found = _DEFINES.match(text, at)
    if found is None:
        return 0
    words = found["words"].split()
    return (
        found.end("words")
        if all(word.lower() in HARMLESS and not _is_name(word, scope) for word in words)
        else 0
    )


def _upright(found: re.Match[str], scope: Scope) -> str:
    r"""Return ``;`` for ``\text{ und }`` between equations."""
    word = re.sub(r"^.*\{[\s~]*|[\s~]*\}$", "", found.group())
    before, behind = found.string[: found.start()], found.string[found.end() :]
    joins = "=" in before and "=" in behind and not _is_name(word, scope)
    return ";".ljust(len(found.group())) if joins else found.group()


def _is_name(word: str, scope: Scope) -> bool:
    """Tell whether a word is declared, or spells declared names."""
    if word in ("&", "|"):
        return False
    known = {key_of(name) for name in scope.spelled}
    return (
        word in scope.functions
        or scope.declares(word)
        or (key_of(word) and key_of(word) in known)
        or split(word, scope) != ""
    )
