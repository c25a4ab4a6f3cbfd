r"""Numbers and units of LaTeX's package siunitx: ``\num{2,5}``, ``\SI{9.81}{\metre\per\second\squared}``, ``\ang{30}``.

A number becomes one in braces, a unit the ``\unit{m/s^{2}}`` that units are passed over in, if they are of the SI and
without prefixes. What can't be read so is left as it is, and told.
"""

from __future__ import annotations

import re

from canon.expression.latex.names import stems
from canon.expression.text.tokens import MAX_CHARACTERS

__all__ = ["without_siunitx"]

_SYMBOLS = {
    "metre": "m", "meter": "m", "second": "s", "kilogram": "kg", "newton": "N", "joule": "J", "watt": "W",
    "radian": "rad", "hertz": "Hz", "pascal": "Pa", "ampere": "A", "kelvin": "K", "coulomb": "C", "volt": "V",
    "tesla": "T", "mole": "mol", "m": "m", "s": "s", "kg": "kg", "N": "N", "J": "J",
}  # fmt: skip
_BRACED = r"\s{0,3}\{(?:[^{}]|\{[^{}]{0,20}\}){1,120}\}"
_OPTIONS = r"(?:\s?\[[^\[\]]{0,80}\])?"
_COMMAND = re.compile(
    rf"\\(?P<name>(?P<two>SI|qty)|num|ang|si|unit)(?![A-Za-z]){_OPTIONS}(?P<first>{_BRACED})(?(two)(?P<unit>{_BRACED}))"
)
_NUMBER = re.compile(
    r"\s*(?P<sign>[-−+]?)\s*(?P<whole>\d{1,20})(?:[.,](?P<rest>\d{1,20}))?(?:[eE](?P<power>[-+]?\d{1,3}))?\s*"
)
_THOUSAND = re.compile(r"\s*[-−]?\s*[1-9]\d{0,2},\d{3}\s*")
"""``1,000`` may be a thousand, or one."""
_WORD = re.compile(r"\s*\\(?P<word>[A-Za-z]+)(?:\s?\{\s?(?P<power>-?\d)\s?\})?")
_SEEN = 60
"""Characters that are looked at before a command."""
_POWERS = {"squared": "2", "cubed": "3"}
_POWERS_BEFORE = {"square": "2", "cubic": "3"}
_BLANK = r"(?:\s|~|\\[,;:! ])"
_FIGURE = re.compile(rf"\d{_BLANK}*$")
_FIGURE_BEHIND = re.compile(rf"{_BLANK}*\d")
_FACTOR = re.compile(rf"(?:(?P<command>\\[A-Za-z]+)|[A-Za-z)}}\]']){_BLANK}*$")


def without_siunitx(text: str) -> str:
    r"""Return a text with the numbers and units of siunitx as other people write them.

    Examples
    --------
    >>> print(without_siunitx(r"\ddot y = -\SI{9.81}{\metre\per\second\squared}"))
    \ddot y = -{9.81\,\unit{m/s^{2}}}
    >>> print(without_siunitx(r"\num{2,5}\,x"), without_siunitx(r"\num{1,000}"), without_siunitx(r"\SI{3}{km}"))
    {2.5}\,x \num{1,000} {3\,\unit{km}}
    """
    if "\\" not in text or len(text) > MAX_CHARACTERS:
        return text
    return _COMMAND.sub(_written, text)


def _written(found: re.Match[str]) -> str:
    """Return a command as other people write it; beside a figure, which it would run into, it is left alone."""
    text, (start, end), name = found.string, found.span(), found["name"]
    first = found["first"].strip()[1:-1]
    if name in ("si", "unit"):
        unit = _unit(first)
        return rf"\unit{{{unit}}}" if unit else found.group()
    number = _number(first)
    before = text[max(0, start - _SEEN) : start]
    if not number or _FIGURE.search(before) or _FIGURE_BEHIND.match(text, end):
        return found.group()
    beside = _FACTOR.search(before)
    times = "\\cdot " if beside and not (beside["command"] and not stems(beside["command"][1:])) else ""
    unit = found["unit"].strip()[1:-1] if found["two"] else ""
    degrees = name == "ang" or unit.strip() in ("\\degree", "\\degrees")
    if name == "num":
        return f"{times}{{{number}}}"
    if degrees or not (unit := _unit(unit)):
        return f"{times}{{{number}^{{\\circ}}}}" if degrees and "(" not in number else found.group()
    return found.group() if "(" in number else rf"{times}{{{number}\,\unit{{{unit}}}}}"


def _number(written: str) -> str:
    """Return a number as LaTeX is read, in brackets where it has a sign; empty where it is none."""
    found = _NUMBER.fullmatch(written)
    if found is None or _THOUSAND.fullmatch(written):
        return ""
    plain = found["whole"] + (f".{found['rest']}" if found["rest"] else "")
    power = rf"\cdot 10^{{{found['power'].lstrip('+')}}}" if found["power"] else ""
    return f"(-{plain}{power})" if found["sign"] in ("-", "−") else f"({plain}{power})" if power else plain


def _unit(written: str) -> str:
    r"""Return ``m/s^{2}`` for ``\metre\per\second\squared`` or ``m/s^2``; empty where a word is not known."""
    if "\\" not in written:
        return re.sub(r"(?<=[A-Za-z\d}])\s?\.\s?(?=[A-Za-z])", " ", written).strip()
    pieces: list[str] = []
    at, per, power = 0, False, ""
    while at < len(written.rstrip()):
        found = _WORD.match(written, at)
        if found is None:
            return ""
        at, word = found.end(), found["word"]
        if word == "per" and not per:
            per = True
        elif word in _POWERS_BEFORE and not power:
            power = f"^{{{_POWERS_BEFORE[word]}}}"
        elif word in _SYMBOLS:
            pieces.append(f"{'/' if per else ' '}{_SYMBOLS[word]}{power}")
            per, power = False, ""
        elif (word in _POWERS or (word == "tothe" and found["power"])) and pieces and not power:
            pieces[-1] += f"^{{{_POWERS.get(word) or found['power']}}}"
        else:
            return ""
    unit = "".join(pieces).strip()
    return "" if per or power else f"1{unit}" if unit.startswith("/") else unit
