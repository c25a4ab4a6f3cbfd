"""Rates and names as single programs write them: ``D2x``, ``der(der(x))``, ``df(x,t,2)``, ``D[0](x)(t)``, ``%omega``.

MATLAB's ``dsolve``, Modelica, REDUCE, Sage and Maxima. Each is read of a declared coordinate, where its letters mean
nothing else.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from canon.expression.text.declared_names import Words
from canon.expression.text.notation import is_latex
from canon.expression.text.scope import split
from canon.expression.text.tokens import GREEK, MAX_CHARACTERS
from canon.expression.written_rates import has_rate

if TYPE_CHECKING:
    from canon.expression.text.scope import Scope

__all__ = ["with_rates_of_programs"]

_NAME = r"[^\W\d_]\w{0,15}"
_MATLAB = re.compile(rf"(?<![\w.\\])D(?P<two>2)?(?P<name>{_NAME})(?![\w(\[])")
_MODELICA = re.compile(rf"(?<![\w.\\])der\(\s?(?P<two>der\(\s?)?(?P<name>{_NAME})\s?\)(?(two)\s?\))")
_REDUCE = re.compile(
    rf"(?<![\w.\\])df\(\s?(?P<name>{_NAME})\s?,\s?(?P<clock>{_NAME})\s?(?:,\s?(?P<order>[12])\s?)?\)"
)
_SAGE = re.compile(rf"(?<![\w.\\])D\[(?P<zeros>0(?:,\s?0)?)\]\(\s?(?P<name>{_NAME})\s?\)(?=\()")
_GREEK = re.compile(rf"%(?P<name>{'|'.join(sorted({*GREEK.values()} - {'pi', 'phi', 'gamma'}))})(?!\w)")
"""Maxima's letters; ``%phi`` and ``%gamma`` are numbers there."""
_MATH = re.compile(r"(?<![\w.:])(?:Math\.|std::)(?:(?P<pi>PI(?!\w))|(?P<of>[A-Za-z][a-z0-9]{1,6})(?=\())")
"""JavaScript's and C#'s ``Math.sin``, ``std::sin`` of C++."""
_CONSOLE = re.compile(r"^\s*\[1\](?=[ \t]{1,9}[\w(])")
"""What R prints before a value; as a factor it would be one."""


def with_rates_of_programs(text: str, scope: Scope) -> str:
    """Return a text with the rates that programs write in primes, and without what their consoles print before it.

    Examples
    --------
    >>> from canon import coordinates
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({"x": coordinates("x")})
    >>> with_rates_of_programs("D2x = -Dx", scope), with_rates_of_programs("der(der(x)) = -der(x)", scope)
    ("x'' = -x'", "x'' = -x'")
    >>> with_rates_of_programs("df(x,t,2) = D[0](x)(t)", scope), with_rates_of_programs("[1] 3 * q", scope).strip()
    ("x'' = x'(t)", '3 * q')
    """
    if len(text) > MAX_CHARACTERS or is_latex(text):
        return text
    text = _with_plain_words(text, scope)
    words = Words(text, scope)
    if "D" in text and not (scope.declares("D") or "D" in scope.functions):
        text = _SAGE.sub(lambda found: _primed(found, found["zeros"].count("0"), words), text)
        text = _of_matlab(text, words)
    if "der(" in text and not _is_taken("der", words):
        rates = [*_MODELICA.finditer(text)]
        if any(has_rate(found["name"], words) for found in rates):  # der(v) beside der(x) = v
            text = _MODELICA.sub(lambda found: found["name"] + "'" * found.group().count("der("), text)
    if "df(" in text and not _is_taken("df", words):
        text = _REDUCE.sub(lambda found: _of_time(found, words), text)
    return text


def _with_plain_words(text: str, scope: Scope) -> str:
    """Return a text without ``[1]`` and ``Math.``, and with Maxima's letters as they are declared."""
    text = _CONSOLE.sub(lambda found: " " * len(found.group()), text)
    if "Math." in text or "std::" in text:
        text = _MATH.sub(lambda found: "pi" if found["pi"] else found["of"], text)
    if "%" in text:
        text = _GREEK.sub(
            lambda found: found["name"] if scope.declares(found["name"]) else found.group(), text
        )
    return text


def _is_taken(word: str, words: Words) -> bool:
    """Tell whether a word is declared, or the product of declared letters, or ``d`` of a declared one."""
    declared = bool(words.declared(word)) or split(word, words.scope) != ""
    return declared or (word[0] == "d" and bool(words.declared(word[1:])))


def _primed(found: re.Match[str], order: int, words: Words) -> str:
    name = found["name"]
    of_one = len(words.scope.functions.get(name, ())) == 1
    return name + "'" * order if of_one or has_rate(name, words) else found.group()


def _of_matlab(text: str, words: Words) -> str:
    """Return a text with ``D2x`` in primes, and ``Dx`` beside it."""
    found = [each for each in _MATLAB.finditer(text) if _is_of_matlab(each, words)]
    if not any(each["two"] for each in found):
        return text
    for each in reversed(found):
        text = (
            f"{text[: each.start()]}{each['name']}{chr(39) * (2 if each['two'] else 1)}{text[each.end() :]}"
        )
    return text


def _is_of_matlab(found: re.Match[str], words: Words) -> bool:
    numbered = found["two"] and (words.declared("D2") or words.declared(f"2{found['name']}"))
    return not words.declared(found.group()) and not numbered and has_rate(found["name"], words)


def _of_time(found: re.Match[str], words: Words) -> str:
    if found["clock"] != words.scope.time.name or not has_rate(found["name"], words):
        return found.group()
    return found["name"] + "'" * int(found["order"] or 1)
