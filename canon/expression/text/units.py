r"""Units after numbers, which are passed over: ``9.81 m/s^2`` is read as 9.81, and a warning says so.

A unit is passed over only where that changes nothing: it must be made of SI units without prefixes, in which every
law of mechanics has the same form. It stands directly after a number, in square brackets, ``9.81 [m/s^2]``, or bare
where it is one of mechanics, none of its letters is declared and factors can't stand side by side; in LaTeX
upright, ``9.81\,\mathrm{m/s^2}``.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from canon.expression.text.notation import is_latex
from canon.expression.text.tokens import MAX_CHARACTERS, LanguageError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from canon.expression.text.scope import Scope

__all__ = ["Unit", "is_a_unit", "units", "without_units"]

OF_MECHANICS = ("kg", "rad", "Hz", "Pa", "m", "s", "N", "J", "W")
"""Units that may stand without brackets; the other letters are more often a quantity that was not declared."""
COHERENT = (*OF_MECHANICS, "mol", "Wb", "A", "K", "C", "V", "F", "T", "H", "Ω")
_NUMBER = re.compile(r"(?<![\w.\\\]])(?:[0-9]++(?:\.[0-9]*+)?|\.[0-9]++)(?:[eE][+-]?[0-9]++)?(?![\w.])")
_POWER = r"(?:[²³]|⁻[¹²³]|(?:\^|\*\*)(?:[-−]?[0-9]{1,2}|\([-−]?[0-9]{1,2}\)|\{[-−]?[0-9]{1,2}\}))?"


def _symbol(names: tuple[str, ...]) -> str:
    return rf"(?:{'|'.join(names)})(?![A-Za-z0-9_(']){_POWER}"


_SYMBOL, _PLAIN = _symbol(COHERENT), _symbol(OF_MECHANICS)
_BARE = re.compile(rf"[ ]?(?:{_PLAIN})(?:(?:[ ]?[*·/][ ]?|[ ]){_PLAIN})*")
_INSIDE = re.compile(rf"\s*(?:1/)?\(?{_SYMBOL}(?:\s*(?:[*·/]|\s|\\cdot|\\,)\s*\(?{_SYMBOL}\)?)*\)?\s*")
_BRACKET = re.compile(r"\s{0,3}\[([^\[\]]{0,80})\]")
_UPRIGHT = re.compile(
    r"(?:\\[,;: ]|~|\s){0,5}\\(?:mathrm|text|textrm|unit|si)\s?\{([^{}]{0,40}(?:\{[^{}]{0,5}\}[^{}]{0,20}){0,4})\}"
)
_OF_SIUNITX = re.compile(r"(?:\\[,;: ]|~|\s){0,5}\\(?:unit|si)(?![A-Za-z])")
"""What holds nothing but units, so that no letter in it is a factor."""
_ACCELERATION = re.compile(
    r"m(?:\s?/\s?s\s?(?:²|\^\{?2\}?|\*\*2)|(?:\s|[*·⋅]|\\,|\\cdot){1,3}s\s?(?:⁻²|\^(?:[-−]2|\{[-−]2\}|\([-−]2\))|\*\*\(?-2\)?))"
)
_SAID_OF_ACCELERATION = re.compile(
    r"(?:^|[;,\n$&])\s*(?:[A-Za-z](?:_\w{1,9})?(?:''|″|′′|\u0308)|[ẍẅÿ]|\\ddot\s?\{?\s?\\?[A-Za-z]{1,9}\s?\}?(?:_\{?\w{1,9}\}?)?|\w_ddot)\s*&?=\s*[-−+]?\s*$"
)
"""An acceleration by itself before its value."""
_LONGEST_BEFORE = 60
_FACTOR = re.compile(r"\s{0,9}[^\W_]|\s{0,9}[(\[√∛∜]")
_TIMES_A_FACTOR = re.compile(r"\s{0,9}[*·⋅×]\s{0,9}(?:[^\W\d_]|[(\[√∛∜])")
"""After one letter, as in 2 s*x: the letter is more likely a factor that was not declared."""
_LETTERS = re.compile(r"[A-Za-zΩ]+")
_REMEDY = f"SI units without prefixes can stand there: {', '.join(sorted(COHERENT))}; or leave it out"


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit in a text, and where it begins and ends there."""

    text: str
    start: int
    end: int


def units(text: str, scope: Scope) -> tuple[Unit, ...]:
    r"""Return the units in a text that are passed over.

    Raises
    ------
    LanguageError
        Where square brackets after a number hold something else than a unit of the SI without prefix, or declared
        names alone, which may be a factor.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> [unit.text for unit in units("9.81 m/s^2 + 2 [kg*m]", Scope())]
    ['m/s^2', 'kg*m']
    """
    return tuple(_units(text, scope)) if len(text) <= MAX_CHARACTERS else ()


def _units(text: str, scope: Scope) -> Iterator[Unit]:
    latex = is_latex(text)
    for number in _NUMBER.finditer(text):
        at = number.end()
        if latex:
            found = _UPRIGHT.match(text, at)
            free = found and (
                _OF_SIUNITX.match(found.group())
                or not _declares(found.group(1), scope)
                or _is_acceleration(found.group(1), text, number, scope)
            )
            if found and free and _INSIDE.fullmatch(found.group(1)):
                yield Unit(found.group(1).strip(), at, found.end())
        elif found := _BRACKET.match(text, at):
            if not _INSIDE.fullmatch(found.group(1)):
                reason = f"{found.group(1)[:40]!r} is not a unit that can be passed over"
                raise LanguageError(text, found.start(1) + 1, reason, _REMEDY)
            if all(_is_declared(letter, scope) for letter in _LETTERS.findall(found.group(1))):
                reason = f"is [{found.group(1).strip()}] a unit, or a factor?"
                remedy = "leave the unit out, or write ( ) around a factor"
                raise LanguageError(text, found.start(1) + 1, reason, remedy)
            yield Unit(found.group(1).strip(), at, found.end())
        elif (bare := _bare(text, number, scope)) is not None:
            yield Unit(bare.group().strip(), at, bare.end())


def _bare(text: str, number: re.Match[str], scope: Scope) -> re.Match[str] | None:
    """Return a unit without brackets: no factor stands beside it, and none of its letters could be one."""
    bare = None if scope.implicit else _BARE.match(text, number.end())
    if bare is None or _FACTOR.match(text, bare.end()):
        return None
    if len(bare.group().strip()) == 1 and _TIMES_A_FACTOR.match(text, bare.end()):
        return None
    if any(_is_bound(name, text) for name in _LETTERS.findall(bare.group())):
        return None
    taken = _declares(bare.group(), scope) and not _is_acceleration(bare.group(), text, number, scope)
    return None if taken else bare


def _is_acceleration(unit: str, text: str, number: re.Match[str], scope: Scope) -> bool:
    """Tell whether a unit is that of the acceleration that a number is said to be, ``y'' = -9.81 m/s²``.

    The mass m may be declared then, for the second is not: read as factors the answer would mean nothing.
    """
    known = _ACCELERATION.fullmatch(unit.strip()) is not None and not scope.declares("s")
    return (
        known
        and _SAID_OF_ACCELERATION.search(text, max(0, number.start() - _LONGEST_BEFORE), number.start())
        is not None
    )


def _declares(unit: str, scope: Scope) -> bool:
    """Whether any letter of a unit is a declared name, so that it could be meant instead."""
    return any(_is_declared(name, scope) for name in _LETTERS.findall(unit))


def _is_declared(name: str, scope: Scope) -> bool:
    return name in scope.functions or scope.symbol(name) is not None


def _is_bound(name: str, text: str) -> bool:
    """Whether a letter is the variable of an integral or a sum in the text."""
    return re.search(rf"[(,]\s*{name}\s*,", text) is not None


def is_a_unit(text: str) -> bool:
    """Tell whether a text is a unit of the SI without prefix.

    Examples
    --------
    >>> is_a_unit("m/s^2"), is_a_unit("cm"), is_a_unit("x, p")
    (True, False, False)
    """
    return _INSIDE.fullmatch(text) is not None


def without_units(text: str, scope: Scope) -> str:
    """Return a text with blanks in place of its units, so that every column stays where it was.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> without_units("9.81 m/s^2*2", Scope())
    '9.81      *2'
    """
    pieces: list[str] = []
    at = 0
    for unit in units(text, scope):
        pieces += (text[at : unit.start], " " * (unit.end - unit.start))
        at = unit.end
    return "".join((*pieces, text[at:]))
