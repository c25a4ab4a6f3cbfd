"""Labels of a writer's own before an answer that has no name in the question, and answers in words.

``c = 1/2`` where a factor is asked, ``C = a² + b²`` of a Casimir function, ``df = …`` of a differential, ``α = 2`` in
the table of α, ``p_φ = const`` for its rate, ``two`` degrees of freedom.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from canon.exercise.sheet.field_texts import says_constant
from canon.exercise.sheet.left_sides import Quantity, is_asked, label_of
from canon.exercise.sheet.quantities.given_functions import key_at
from canon.expression.text.declared_names import key_of
from canon.expression.text.vocabulary import CONSTANTS, OTHER_NAMES

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from canon.expression.text.scope import Scope
    from canon.expression.text.statement import Side

__all__ = [
    "counted_in_words",
    "is_rest",
    "without_arrow",
    "without_differential",
    "without_label_of_table",
    "without_own_label",
    "without_words_around",
]

_NUMBERS: Mapping[str, str] = {
    word: str(number)
    for number, words in enumerate(
        (
            "zero null zéro cero", "one eins un uno", "two zwei deux dos due два dwa", "three drei trois tres tre три",
            "four vier quatre cuatro quattro четыре", "five fünf cinq cinco cinque пять", "six sechs seis sei шесть",
            "seven sieben sept siete sette семь", "eight acht huit ocho otto", "nine neun neuf nueve nove",
        )
    )
    for word in words.split()
}  # fmt: skip
_MINUS = re.compile(r"(?:minus|negative|moins|menos|meno|минус)\s+")
_FACTOR_IS = re.compile(
    r"\s*(?:(?:the|der|le|il|el|o)\s)?(?:(?:common|constant|gemeinsame)\s)?(?:factor|faktor|facteur|fattore|fator|činitel"
    r"|czynnik|множитель|коэффициент|multiplier|valence)"
    r"(?:\s*[:=]\s*|\s(?:is|equals|ist|lautet|est|vaut|es|vale|è|é|je|jest|равен)\s+)(?=[-−\d$])",
    re.IGNORECASE,
)
_ARROW = re.compile(
    r"\s*\$?\s*(?P<name>\\?[^\W\d_]\w{0,15}(?:_\{\w{1,5}\})?)\s*(?:↦|⟼|\|->|\\(?:long)?mapsto(?![A-Za-z]))"
)
_OF_FREEDOM = re.compile(
    r"(?<=[\w$}])\s+(?:independent\s)?(?:degrees?\sof\sfreedom|d\.?o\.?f\.?s?|Freiheitsgrade?|degrés?\sde\sliberté"
    r"|grados?\sde\slibertad|grad[oi]\sdi\slibertà)(?=[\s.]*$)",
    re.IGNORECASE,
)
_DIFFERENTIAL = re.compile(
    r"\s*\$?\s*(?:\\(?:mathrm|text|operatorname)\s?\{\s?d\s?\}|\\mathrm\s?d|d)\s*f\s*=(?!=)"
)
_ONE_NAME = re.compile(r"[\s$]*\\?[^\W\d_]+(?:_\{?\w{1,4}\}?)?(?:\s?\([^()=]{1,40}\))?\s*")
_OF_TABLE = re.compile(r"(?P<name>[\s$]*\\?[^\W\d]\w{0,15}(?:_\{\w{1,5}\})?)\s*=(?=[^=]*$)")


def without_own_label(
    place: str, sides: Sequence[Side], keys: Mapping[str, Any], scope: Scope
) -> Sequence[Side]:
    """Return sides without a free name before what the question has no name for: a factor, Casimirs, an expansion."""
    exact = keys.get("exact")
    alone = isinstance(exact, str) or (isinstance(exact, list) and len(exact) == 1)
    nameless = place == "factor" or key_at(place) == "casimirs" or (key_at(place) == "claim" and alone)
    label = label_of(sides[0].said)
    if not (nameless and len(sides) > 1 and label and label.name and _ONE_NAME.fullmatch(sides[0].text)):
        return sides
    known = {key_of(name) for name in scope.spelled}
    taken = key_of(label.name) in known or isinstance(keys.get(label.name), str)
    is_constant = label.name in CONSTANTS or label.name in OTHER_NAMES
    return sides if taken or label.rates or is_constant else sides[1:]


def is_rest(place: str, sides: Sequence[Side], asked: Quantity, scope: Scope) -> bool:
    """Tell whether ``p_φ = const`` says that a rate that is asked for is zero."""
    if key_at(place) not in ("p_dot", "q_dot") or len(sides) < 2 or not says_constant(sides[-1].text, scope):
        return False
    still = Quantity(asked.shown, tuple((name, rates - 1) for name, rates in asked.names if rates == 1))
    return len(sides) == 2 and not scope.declares("const") and is_asked(label_of(sides[0].said), still, scope)


def without_differential(text: str, keys: Mapping[str, Any], scope: Scope) -> str:
    """Return a differential without ``df =`` before it, where f is given and no name is spelled so.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> without_differential("df = p dq", {"f": "q*p"}, Scope()).strip()
    'p dq'
    """
    found = _DIFFERENTIAL.match(text) if isinstance(keys.get("f"), str) else None
    if found is None or any(scope.declares(name) for name in ("d", "f", "df")):
        return text
    dollar = "$" if "$" in found.group() else " "
    return " " * (found.end() - 1) + dollar + text[found.end() :]


def without_label_of_table(name: str, text: str) -> str:
    """Return a value without the name that its table has for it.

    Examples
    --------
    >>> without_label_of_table("alpha", "α = 2"), without_label_of_table("alpha", "β = 2")
    ('    2', 'β = 2')
    """
    found = _OF_TABLE.match(text)
    label = label_of(found["name"].strip(" $").lstrip("\\")) if found else None
    if found is None or label is None or label.rates or key_of(label.name) != key_of(name):
        return text
    dollar = "$" if "$" in found.group() else " "
    return " " * (found.end() - 1) + dollar + text[found.end() :]


def counted_in_words(text: str, scope: Scope) -> str:
    """Return a number for a word that says it, as degrees of freedom are counted.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> counted_in_words("two", Scope()), counted_in_words("not two", Scope())
    ('2', 'not two')
    """
    word = text.strip(" .").lower()
    minus = _MINUS.match(word)
    bare = word[minus.end() :] if minus else word
    if bare not in _NUMBERS or any(scope.declares(each) for each in (bare, *word.split())):
        return text
    return f"{'-' if minus else ''}{_NUMBERS[bare]}"


def without_words_around(place: str, text: str, scope: Scope) -> str:
    """Return a factor or a number without the words that say what it is, ``the factor is 6``, ``1 degree of freedom``.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> without_words_around("factor", "the factor is 6", Scope()).strip()
    '6'
    >>> without_words_around("factor", "the factor is not 6", Scope())
    'the factor is not 6'
    >>> without_words_around("dof", "two degrees of freedom", Scope()).strip()
    'two'
    """
    if place == "dof" and (behind := _OF_FREEDOM.search(text)):
        return text[: behind.start()] + " " * (behind.end() - behind.start()) + text[behind.end() :]
    found = _FACTOR_IS.match(text) if place == "factor" else None
    if found is None or any(scope.declares(word) for word in found.group().split()):
        return text
    return " " * found.end() + text[found.end() :]


def without_arrow(text: str, variable: str) -> str:
    """Return an image without the variable before it, ``q ↦ p``.

    Examples
    --------
    >>> without_arrow("q ↦ p", "q"), without_arrow("q ↦ p", "x")
    ('    p', 'q ↦ p')
    """
    found = _ARROW.match(text)
    label = label_of(found["name"].lstrip("\\")) if found else None
    if found is None or label is None or label.rates or key_of(label.name) != key_of(variable):
        return text
    dollar = "$" if "$" in found.group() else " "
    return " " * (found.end() - 1) + dollar + text[found.end() :]
