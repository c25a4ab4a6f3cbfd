"""Dictation: formulas in English words, ``theta double dot equals minus g over l, times the sine of theta``.

Read is only what is in words from its beginning to its end, each of them known or a declared name, and only where a
listener would hear one formula: ``a plus b over c``, ``sine of theta over two`` are heard as two and left alone.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.expression.text.declared_names import Words
from canon.expression.text.scope import split

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.expression.text.scope import Scope

__all__ = ["written_from_dictation"]

_NUMBERS: Mapping[str, str] = {
    word: str(number)
    for number, word in enumerate(
        (
            "zero",
            "one",
            "two",
            "three",
            "four",
            "five",
            "six",
            "seven",
            "eight",
            "nine",
            "ten",
            "eleven",
            "twelve",
        )
    )
}
_PARTS: Mapping[str, str] = {
    "half": "2",
    "halves": "2",
    "third": "3",
    "thirds": "3",
    "quarter": "4",
    "quarters": "4",
}
_FUNCTIONS: Mapping[str, str] = {
    "sine": "sin", "cosine": "cos", "tangent": "tan", "cotangent": "cot", "exponential": "exp", "sin": "sin",
    "cos": "cos", "tan": "tan",
}  # fmt: skip
_POWERS: Mapping[str, str] = {"squared": "2", "cubed": "3"}
_SIGNS: Mapping[str, str] = {"plus": "+", "minus": "-", "negative": "-"}
_OTHERS = ("equals", "times", "over", "the", "of", "dot", "double", "quantity", "twice")
_SPOKEN = frozenset((*_NUMBERS, *_PARTS, *_FUNCTIONS, *_POWERS, *_SIGNS, *_OTHERS))
_STRONG = frozenset((*_POWERS, *_SIGNS, "equals", "times", "over", "dot", "sine", "cosine"))
"""Words that nobody writes but who dictates."""
_WORD = re.compile(r"[^\W_]\w*|[=,]|\S")
_HYPHEN = re.compile(r"(?<=[^\W_])-(?=[^\W\d_]{3})")
_RATE = re.compile(r"(?<![\w\\])(?P<name>[^\W\d_]\w{0,15})-(?P<two>double-)?dot(?!\w)")
_IS = re.compile(r"(?P<label>\s*[^\W\d_]\w{0,5}\s?\([\w, ]{1,40}\)) (?:is|equals) (?=\w)")
_LABEL = re.compile(r"\s*[^\W\d_]\w{0,5}\s?(?:\([\w, ]{1,40}\))?\s?=(?!=)\s*")
_TIGHT = re.compile(r"(?P<number>[2-9])(?P<name>[^\W\d_]\w{0,9})")
"""A number and a name in one word, ``2m``."""
_LONGEST = 600


class _HeardAsTwoError(Exception):
    """Raised within this module where words are no formula, or more than one."""


def written_from_dictation(text: str, scope: Scope) -> str:
    """Return the formula that a text says in words; a text that is not one is returned as it is.

    Examples
    --------
    >>> from canon import coordinates, parameters
    >>> from canon.expression.text.scope import Scope
    >>> scope = Scope({s.name: s for s in (coordinates("x"), *parameters("c k m"))})
    >>> written_from_dictation("minus one half times c times x dot squared", scope)
    "-(1/2)*c*x'^2"
    >>> written_from_dictation("x-double-dot = -x", scope), written_from_dictation("c plus k over m", scope)
    ("x'' = -x", 'c plus k over m')
    """
    if len(text) > _LONGEST or "\\" in text or "$" in text:
        return text
    words = Words(text, scope)
    text = _with_rates(text, words) if "dot" in text else text
    text = _with_sign_for_is(text, words)
    label = _LABEL.match(text)
    begin = label.end() if label and "(" in label.group() else 0
    heard = [
        word.lower() if word.lower() in _SPOKEN else word
        for word in _WORD.findall(_HYPHEN.sub(" ", text[begin:].rstrip(" .")))
    ]
    spoken = {word for word in heard if word in _SPOKEN}
    alone = spoken == {"times"} and not any(word.isdigit() for word in heard)  # p times P
    if not spoken & _STRONG or not (alone or len(spoken) > 1) or any(words.declared(word) for word in spoken):
        return text
    try:
        return text[:begin] + _Dictated(words).equation(heard)
    except _HeardAsTwoError:
        return text


def _with_sign_for_is(text: str, words: Words) -> str:
    """Return a text with ``=`` for *is* behind a name with arguments at its beginning, ``F4(p, P) is p times P``."""
    found = _IS.match(text)
    if found is None or words.declared("is") or split("is", words.scope):
        return text
    return f"{found['label']} = {text[found.end() :]}"


def _with_rates(text: str, words: Words) -> str:
    """Return a text with primes for ``x-double-dot`` and ``x-dot``."""

    def primed(found: re.Match[str]) -> str:
        known = words.declared(found["name"])
        has_rate = len(known) == 1 and words.scope.declares(f"{known[0]}_dot") and not words.declared("dot")
        has_rate = has_rate and not split("dot", words.scope)
        return f"{found['name']}{chr(39) * (2 if found['two'] else 1)}" if has_rate else found.group()

    return _RATE.sub(primed, text)


@dataclass(frozen=True)
class _Dictated:
    """Writes what is heard, within the declared names."""

    words: Words

    def equation(self, heard: Sequence[str]) -> str:
        """Return the sides of an equation, or one expression; a name alone may stand before ``=``."""
        sides: list[list[str]] = [[]]
        for word in heard:
            if word in ("equals", "="):
                sides.append([])
            else:
                sides[-1].append(word)
        is_label = len(sides) == 2 and len(sides[0]) == 1 and re.fullmatch(r"[^\W\d]\w*", sides[0][0])
        left = [sides[0][0]] if is_label and sides[0][0] not in _SPOKEN else [self.side(sides[0])]
        return " = ".join([*left, *(self.side(side) for side in sides[1:])])

    def side(self, heard: Sequence[str]) -> str:
        """Return one side: what stands before a comma is whole, and goes on with ``times``, ``plus`` or ``minus``."""
        first, *others = _parted(heard, ",")
        made, is_sum = self.sum(first)
        for other in others:
            if not other or other[0] not in ("times", "plus", "minus"):
                raise _HeardAsTwoError
            part, part_is_sum = self.sum(other[1:])
            if other[0] == "times":
                if is_sum or part_is_sum:
                    raise _HeardAsTwoError
                made = f"{made}*{part}"
            else:
                if part_is_sum:
                    raise _HeardAsTwoError
                made, is_sum = f"{made} {_SIGNS[other[0]]} {part}", True
        return made

    def sum(self, heard: Sequence[str]) -> tuple[str, bool]:
        """Return terms with their signs, and whether there are several."""
        if "quantity" in heard:
            return self.with_quantity(heard), False
        terms: list[tuple[str, list[str]]] = [("", [])]
        for word in heard:
            if word not in _SIGNS:
                terms[-1][1].append(word)
            elif terms[-1][1]:
                terms.append((f" {_SIGNS[word]} ", []))
            elif terms[-1][0] == "":
                terms[-1] = (_SIGNS[word], [])
            else:
                raise _HeardAsTwoError
        if len(terms) > 1 and "over" in heard:
            raise _HeardAsTwoError
        return "".join(f"{sign}{self.term(words)}" for sign, words in terms), len(terms) > 1

    def with_quantity(self, heard: Sequence[str]) -> str:
        """Return ``four times the quantity u squared plus v squared``, each term inside squared or none."""
        at = heard.index("quantity")
        before = [word for word in heard[:at] if word != "the"]
        inside = heard[at + 1 :]
        powers = [term[-1:] == ["squared"] for sign in ("plus", "minus") for term in _parted(inside, sign)]
        if before[-1:] == ["times"]:
            before = before[:-1]
        if "over" in heard or "quantity" in inside or "plus" in before or len(set(powers)) > 1 or not inside:
            raise _HeardAsTwoError
        signs = [at for at, word in enumerate(inside) if at and word in ("plus", "minus")]
        if signs and "times" in inside[signs[-1] :]:  # the quantity a plus b times c
            raise _HeardAsTwoError
        made, _ = self.sum(inside)
        factor, is_sum = self.sum(before) if before else ("1", False)
        if is_sum or any(word in _FUNCTIONS for word in inside):
            raise _HeardAsTwoError
        return f"{factor}*({made})"

    def term(self, heard: Sequence[str]) -> str:
        """Return a product, or one over a single factor."""
        above, *below = _parted(heard, "over")
        if not below:
            return self.product(above)
        if len(below) > 1 or any(word in _FUNCTIONS for word in heard):
            raise _HeardAsTwoError
        factor, end = self.factor(below[0], 0)
        if end != len(below[0]):
            raise _HeardAsTwoError
        return f"{self.product(above)}/{factor}"

    def product(self, heard: Sequence[str]) -> str:
        """Return factors with ``times`` or nothing between them."""
        factors: list[str] = []
        at = 0
        while at < len(heard):
            if heard[at] == "times" and factors:
                at += 1
            factor, at = self.factor(heard, at)
            factors.append(factor)
        if not factors:
            raise _HeardAsTwoError
        return "*".join(factors)

    def factor(self, heard: Sequence[str], at: int) -> tuple[str, int]:
        """Return one factor and where it ends: a number, a fraction, a name with dots and a power, a function."""
        if heard[at : at + 1] == ["the"]:
            at += 1
            if heard[at : at + 1] == [] or heard[at] not in _FUNCTIONS:
                raise _HeardAsTwoError
        word = heard[at] if at < len(heard) else ""
        behind = heard[at + 1] if at + 1 < len(heard) else ""
        if word in _FUNCTIONS:
            return self.function(heard, at)
        if word in _NUMBERS or word in ("half", "twice") or word.isdigit():
            if behind in _PARTS:
                return f"({_NUMBERS.get(word, word)}/{_PARTS[behind]})", at + 2
            return {"half": "(1/2)", "twice": "2"}.get(word, _NUMBERS.get(word, word)), at + 1
        return self.name(heard, at)

    def name(self, heard: Sequence[str], at: int) -> tuple[str, int]:
        """Return a declared name with its dots and its power."""
        word = heard[at] if at < len(heard) else ""
        if (tight := _TIGHT.fullmatch(word)) and len(self.words.declared(tight["name"])) == 1:
            return self.tight(heard, at, tight)
        if not word or word in _SPOKEN or len(self.words.declared(word)) != 1:
            raise _HeardAsTwoError
        at += 1
        dots = 2 if heard[at : at + 2] == ["double", "dot"] else 1 if heard[at : at + 1] == ["dot"] else 0
        at += dots
        power = _POWERS.get(heard[at], "") if at < len(heard) else ""
        return f"{word}{chr(39) * dots}{f'^{power}' if power else ''}", at + bool(power)

    def tight(self, heard: Sequence[str], at: int, word: re.Match[str]) -> tuple[str, int]:
        """Return ``2m`` as one factor, which ``over 2m`` divides by; nothing may follow that raises a part of it."""
        if heard[at + 1 : at + 2] and heard[at + 1] in (*_POWERS, "dot", "double"):
            raise _HeardAsTwoError
        return f"({word['number']}*{word['name']})", at + 1

    def function(self, heard: Sequence[str], at: int) -> tuple[str, int]:
        """Return a function of one name, or of a number times one; nothing may follow that could belong to it."""
        name, at = _FUNCTIONS[heard[at]], at + 1
        power = _POWERS.get(heard[at], "") if at < len(heard) else ""
        at += bool(power)
        at += heard[at : at + 1] == ["of"]
        factor = _NUMBERS.get(heard[at], "") if at < len(heard) else ""
        argument, end = self.name(heard, at + bool(factor))
        if end != len(heard) or "^" in argument:
            raise _HeardAsTwoError
        inside = f"{factor}*{argument}" if factor else argument
        return f"{name}({inside}){f'^{power}' if power else ''}", end


def _parted(heard: Sequence[str], sign: str) -> list[list[str]]:
    """Return the words between those that are a sign."""
    parts: list[list[str]] = [[]]
    for word in heard:
        if word == sign:
            parts.append([])
        else:
            parts[-1].append(word)
    return parts
