"""Measures: units after the numbers of an answer, turned into the unit that the sheet asks for, exactly.

Factors are those of the SI brochure (9th edition, 2019): prefixes are powers of ten, an hour is 3600 s, a degree π/180.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import TYPE_CHECKING

import sympy as sp
from sympy import Expr, Rational

if TYPE_CHECKING:
    from collections.abc import Mapping

    from canon.expression.text.scope import Scope

__all__ = [
    "BASE_UNITS",
    "DEGREES",
    "UNIT",
    "Measure",
    "measure_like",
    "measure_of",
    "unit_behind",
    "with_strokes",
]

_PREFIXES = {"": 0, "T": 12, "G": 9, "M": 6, "k": 3, "h": 2, "d": -1, "c": -2, "m": -3, "µ": -6, "μ": -6, "u": -6,
             "n": -9, "p": -12}  # fmt: skip
BASE_UNITS = ("m", "kg", "s", "A", "K", "mol")
_SCALED: Mapping[str, tuple[Expr, tuple[int, ...]]] = {
    "m": (sp.S.One, (1,)), "g": (Rational(1, 1000), (0, 1)), "s": (sp.S.One, (0, 0, 1)),
    "A": (sp.S.One, (0, 0, 0, 1)), "K": (sp.S.One, (0, 0, 0, 0, 1)), "mol": (sp.S.One, (0, 0, 0, 0, 0, 1)),
    "N": (sp.S.One, (1, 1, -2)), "J": (sp.S.One, (2, 1, -2)), "W": (sp.S.One, (2, 1, -3)),
    "Pa": (sp.S.One, (-1, 1, -2)), "Hz": (sp.S.One, (0, 0, -1)), "C": (sp.S.One, (0, 0, 1, 1)),
    "V": (sp.S.One, (2, 1, -3, -1)), "T": (sp.S.One, (0, 1, -2, -1)), "Wb": (sp.S.One, (2, 1, -2, -1)),
    "H": (sp.S.One, (2, 1, -2, -2)), "F": (sp.S.One, (-2, -1, 4, 2)), "Ω": (sp.S.One, (2, 1, -3, -2)),
    "eV": (Rational(1602176634, 10**28), (2, 1, -2)), "rad": (sp.S.One, ()), "L": (Rational(1, 1000), (3,)),
}  # fmt: skip
"""Units that take prefixes: factor, and powers of metre, kilogram, second, ampere, kelvin, mole."""
_PLAIN: Mapping[str, tuple[Expr, tuple[int, ...]]] = {
    "min": (Rational(60), (0, 0, 1)), "h": (Rational(3600), (0, 0, 1)), "d": (Rational(86400), (0, 0, 1)),
    "°": (sp.pi / 180, ()), "deg": (sp.pi / 180, ()), "%": (Rational(1, 100), ()), "1": (sp.S.One, ()),
    "rev": (2 * sp.pi, ()), "rpm": (sp.pi / 30, (0, 0, -1)), "t": (Rational(1000), (0, 1)),
    "au": (Rational(149597870700), (1,)),
}  # fmt: skip
_BESIDE = ("kg", "kW", "kV", "mA", "Pa", "Hz", "m", "s", "N", "J", "W", "A", "V", "T", "K", "C")
"""Units that are typed without a gap before another one: ``Nm``, ``kgm²``, ``Js``, ``kWh``."""
_WORDS: Mapping[str, str] = {
    "meter": "m", "metre": "m", "second": "s", "sec": "s", "kilogram": "kg", "gram": "g", "newton": "N", "joule": "J",
    "watt": "W", "hertz": "Hz", "pascal": "Pa", "radian": "rad", "degree": "deg", "minute": "min", "hour": "h",
    "hr": "h", "day": "d", "kelvin": "K", "ampere": "A", "volt": "V", "coulomb": "C", "tesla": "T", "ohm": "Ω",
    "revolution": "rev", "turn": "rev", "percent": "%", "sekunde": "s",
    "sekunden": "s", "seconde": "s", "segundo": "s", "secondo": "s", "secondi": "s", "metro": "m", "metri": "m",
    "kilometer": "km", "kilometre": "km", "centimeter": "cm", "centimetre": "cm", "millimeter": "mm",
    "millimetre": "mm", "millisecond": "ms", "kilojoule": "kJ", "kilowatt": "kW",
}  # fmt: skip
"""Units by their names, in singular."""
_COUNTED_IN = {"angles": ("rad", "deg", "°"), "turns": ("rev", "rpm")}
"""Units without a dimension that frequencies are counted in."""
_MOST = 80
"""Characters of a unit."""
_LONGEST = 2_000
"""Characters of an answer in which a unit is looked for."""
_SYMBOL = re.compile(
    r"(?P<name>[A-Za-zµμΩ]+|°|%|1)(?:(?:\^|\*\*)?(?P<power>\([-−]?[0-9]{1,2}\)|\{?[-−]?[0-9]{1,2}\}?)|(?P<raised>⁻?[¹²³⁴⁵⁶]{1,3}))?"
    r"|(?P<sign>.)",
    re.DOTALL,
)
DEGREES = re.compile(r"(?:°|\bdeg)\s?[CFR](?![A-Za-z])")
"""Degrees of Celsius, Fahrenheit, Réaumur, which do not count from zero: no factor leads to kelvins."""
_SMALL = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁻", "0123456789-")
_SIUNITX = re.compile(
    r"\\(?:SI|qty)\s*\{(?P<number>[^{}]{1,60})\}\s*\{(?P<unit>[^{}]{1,80}(?:\{[^{}]{0,5}\}[^{}]{0,20}){0,4})\}\s*\$?\s*$"
)
_MACRO = re.compile(r"\\([A-Za-z]+)\s*")
_MACROS: Mapping[str, str] = {
    **{name: f"{symbol} " for name, symbol in _WORDS.items()},
    "per": "/", "squared": "^2 ", "cubed": "^3 ", "kilo": "k", "milli": "m", "centi": "c", "micro": "µ",
    "mega": "M", "giga": "G", "nano": "n",
}  # fmt: skip
_LATEX = re.compile(
    r"\\(?:mathrm|text|textrm|rm|si|unit|operatorname|,|;|:|!| )|\\(?=%)|[{}$~]|\\[lr]?(?:brack)?(?![A-Za-z])"
)
UNIT = r"(?:[A-Za-zµμΩ]+|°|%)(?:(?:\^|\*\*)?[({]?[-−]?[0-9]{1,2}[)}]?|[⁻¹²³⁴]{1,3})?"
_BEHIND = re.compile(
    rf"(?<=[0-9.)\s°%}}])(?P<unit>\(?{UNIT}\)?(?:\s?[*·⋅/]\s?\(?{UNIT}\)?|\s\(?{UNIT}\)?){{0,5}}|1?/{UNIT})\s*$"
)
_IN_BRACKET = re.compile(r"\[(?P<unit>[^\[\]]{1,80})\]\s*$")
_SPACED = re.compile(
    r"(?:\\[,;:! ]|~|\{?\s*\\rm(?![A-Za-z])\s*\{?\s*){1,5}"
    rf"(?P<unit>{UNIT}(?:(?:\s|\\[,;:! ]|~|\\cdot|/){{1,3}}{UNIT}){{0,4}})\s*\}}?\s*\$?\s*$"
)
_UPRIGHT = re.compile(
    r"(?P<unit>(?:\\(?:mathrm|text|textrm|si|unit)\s?\{[^{}]{0,40}(?:\{[^{}]{0,5}\}[^{}]{0,20}){0,4}\}"
    r"(?:\^\{?-?[0-9]\}?)?(?:\s|\\[,;:! ]|\\cdot|/)*){1,4}|\^\{?\\circ\}?|\\%|\\degree)\s*\$?\s*$"
)
_PART = r"[^{}]{0,40}(?:\{[^{}]{0,20}\}[^{}]{0,20}){0,4}"
_QUOTIENT = re.compile(
    r"(?<=[0-9.)}\s,;:!~])(?P<unit>(?:\\(?:mathrm|text|unit)\s?\{\s*)?"
    rf"\\[dt]?frac\s*\{{(?P<above>{_PART})\}}\s*\{{(?P<below>{_PART})\}}\s*\}}?)\s*\$?\s*$"
)
"""A unit written as a fraction, ``5\\,\\frac{\\mathrm{m}}{\\mathrm{s}}``."""
_PER = re.compile(r"(?<=[A-Za-z²³])\s{1,3}(?:per|pro|par|al)\s{1,3}(?=[A-Za-z])")


@dataclass(frozen=True)
class Measure:
    """A unit by its factor in SI units and its powers of metre, kilogram, second, ampere, kelvin and mole.

    Examples
    --------
    >>> measure_of("km/h").factor, measure_of("km/h").powers == measure_of("m s^-1").powers
    (5/18, True)
    """

    factor: Expr
    powers: tuple[int, ...]
    hertz: int = field(default=0, compare=False)
    """To which power hertz stands in it."""
    counted_in: str = field(default="", compare=False)
    """``"turns"`` where it holds rev or rpm, ``"angles"`` where it holds rad or degrees."""

    def factor_to(self, asked: Measure) -> Expr | None:
        """Return the factor to a unit of the same powers; None between hertz and an angle by the second.

        One hertz is one cycle a second, or one turn; whether a cycle is 2π rad there, only who asks can say.

        Examples
        --------
        >>> measure_of("rpm").factor_to(measure_of("Hz")), measure_of("Hz").factor_to(measure_of("rad/s"))
        (1/60, None)
        """
        factor, cycles = self.factor / asked.factor, self.hertz - asked.hertz
        if not cycles:
            return factor
        others = {self.counted_in, asked.counted_in}
        if "angles" in others:
            return None
        return factor * (2 * sp.pi) ** cycles if "turns" in others else factor


def measure_of(unit: str) -> Measure | None:
    r"""Return what a unit measures; None where it is none.

    Examples
    --------
    >>> measure_of("N m") == measure_of(r"\mathrm{kg\,m^2/s^2}") == measure_of("J"), measure_of("furlong")
    (True, None)
    >>> measure_of("°C") is None  # does not count from zero
    True
    """
    if len(unit) > _MOST:
        return None
    plain = _without_latex(unit)
    written = None if DEGREES.search(plain) else _named_powers(plain)
    if written is None:
        return None
    named = [part for name, power in written for part in _apart(name, power)]
    factor, powers = sp.S.One, [0] * len(BASE_UNITS)
    for name, power in named:
        one = _one(name)
        if one is None:
            return None
        factor *= one[0] ** power
        powers = [p + power * own for p, own in zip_longest(powers, one[1], fillvalue=0)]
    hertz = sum(power for name, power in named if name.endswith("Hz"))
    counted = [what for what, units in _COUNTED_IN.items() if any(name.endswith(units) for name, _ in named)]
    return Measure(factor, tuple(powers), hertz, counted[0] if counted else "")


def measure_like(unit: str, asked: Measure) -> Measure | None:
    """Return what a unit measures, ``ms⁻¹`` being metres a second where such a unit is asked for.

    Examples
    --------
    >>> measure_like("ms^-2", measure_of("m/s^2")) == measure_of("m/s^2"), measure_like("ms", measure_of("s")).factor
    (True, 1/1000)
    """
    found = measure_of(unit)
    if found is None or found.powers == asked.powers:
        return found
    beside = measure_of(re.sub(r"(?<![A-Za-z])ms(?=\s*\}?\s*[\^⁻*({])", "m s", unit))
    return beside if beside is not None and beside.powers == asked.powers else found


def _apart(name: str, power: int) -> list[tuple[str, int]]:
    """Return the units that are typed as one word, each with its power; ``kgm²`` is kg m²."""
    word = name.lower() if len(name) > 3 else name
    name = _WORDS.get(word, _WORDS.get(word.removesuffix("s"), name) if len(name) > 3 else name)
    if _one(name) is not None:
        return [(name, power)]
    for first in _BESIDE:
        rest = name.removeprefix(first)
        if rest != name and rest in (*_BESIDE, "h", "rad"):
            return [(first, 1 if power > 0 else -1), (rest, power)]
    return [(name, power)]


def _without_latex(unit: str) -> str:
    plain = unit.replace(r"\cdot", "*").replace(r"\circ", "°").replace(r"\degree", "°").replace("^°", "°")
    plain = re.sub(r"\\mu(?![A-Za-z])", "µ", plain).replace(r"\Omega", "Ω")
    return re.sub(r"\s*\^\s*", "^", _LATEX.sub(" ", plain)).strip(" []")


def _named_powers(unit: str) -> list[tuple[str, int]] | None:
    """Return the symbols in a product of units, each with its power; None where it is no product.

    Nothing may follow a symbol below a stroke: J/kg K is J/(kg K), or J K/kg.
    """
    found = list[tuple[str, int]]()
    depth, below, complete = 0, False, False
    for symbol in _SYMBOL.finditer(unit):
        sign = symbol["sign"]
        if sign is None:
            if complete or unit[symbol.start() - 1 : symbol.start()].isalnum():
                return None
            found.append((symbol["name"], _power(symbol, below=below)))
            below, complete = below and depth > 0, below and depth == 0
        elif sign in "()":
            depth += 1 if sign == "(" else -1
            below = below and depth > 0
        elif sign == "/":
            below, complete = True, False
        elif sign not in "*·⋅ ":
            return None
    return found if unit and depth == 0 else None


def _power(symbol: re.Match[str], *, below: bool) -> int:
    written = (symbol["raised"] or symbol["power"] or "1").translate(_SMALL)
    power = int(written.strip("(){}").replace("−", "-"))
    return -power if below else power


def _one(name: str) -> tuple[Expr, tuple[int, ...]] | None:
    """Return factor and powers of one unit, with or without a prefix."""
    if name in _PLAIN:
        return _PLAIN[name]
    for prefix, ten in _PREFIXES.items():
        scaled = _SCALED.get(name.removeprefix(prefix)) if name.startswith(prefix) else None
        if scaled is not None:
            return Rational(10) ** ten * scaled[0], scaled[1]
    return None


def _of_macros(unit: str) -> str:
    r"""Return a unit without siunitx's macros, ``\kilo\metre\per\hour`` as ``km /h``.

    Examples
    --------
    >>> _of_macros(r"\kilo\metre\per\second\squared"), _of_macros("m.s^{-2}")
    ('km /s ^2 ', 'm*s^{-2}')
    """
    return _MACRO.sub(lambda found: _MACROS.get(found[1], f"{found[1]} "), unit).replace(".", "*")


def _closed(begins: str, text: str) -> str:
    """Return the beginning of a text with blanks behind it, and the dollar that closes the text."""
    closing = "$" if text.rstrip().endswith("$") else ""
    return begins + " " * (len(text) - len(begins) - len(closing)) + closing


def with_strokes(text: str, scope: Scope) -> str:
    """Return a text with a stroke for ``per`` between units, blanks behind it, and one for ``~`` before a unit.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> with_strokes("5 meters per second", Scope()), with_strokes("5~m/s", Scope())
    ('5 meters/second    ', '5 m/s')
    """
    if "\\" not in text and "$" not in text:
        text = re.sub(r"(?<=[0-9])~(?=[A-Za-z])", " ", text)
    if any(scope.declares(word) for word in ("per", "pro", "par", "al")):
        return text
    return _PER.sub("/", text).ljust(len(text))


def _quotient_behind(text: str, scope: Scope) -> tuple[str, str] | None:
    """Return a text without the fraction of units at its end, and that unit; None where there is none."""
    found = _QUOTIENT.search(text) if len(text) <= _LONGEST else None
    if found is None or not text[: found.start()].strip(" $"):
        return None
    unit = f"{found['above']}/({found['below']})"
    letters = re.findall(r"[A-Za-zΩµμ]+", _without_latex(unit))
    upright = r"\mathrm" in found["unit"] or r"\text" in found["unit"] or r"\unit" in found["unit"]
    declared = any(x in scope.functions or scope.declares(x) for x in letters)
    if not letters or (declared and not upright) or measure_of(unit) is None:
        return None
    blanked = _closed(text[: found.start()], text)
    return re.sub(r"(?:\\[,;:! ]|~)(?=\s*\$?\s*$)", "  ", blanked)[: len(text)], unit


def unit_behind(text: str, scope: Scope) -> tuple[str, str]:
    r"""Return a text with blanks in place of the unit at its end, and that unit; letters that are declared are none.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> unit_behind("36 km/h", Scope()), unit_behind(r"$2\,\mathrm{m}$", Scope()), unit_behind("2*pi", Scope())
    (('36     ', 'km/h'), ('$2           $', '\\mathrm{m}'), ('2*pi', ''))
    """
    if packed := _SIUNITX.search(text):
        inside = text[: packed.start()] + " " * (packed.start("number") - packed.start()) + packed["number"]
        return _closed(inside, text), _of_macros(packed["unit"])
    if quotient := _quotient_behind(text, scope):
        return quotient
    latex = (_SPACED,) if text.lstrip().startswith("$") else ()
    for pattern in (_IN_BRACKET, _UPRIGHT, *latex, _BEHIND) if len(text) <= _LONGEST else ():
        found = pattern.search(text)
        while found is not None and measure_of(found["unit"]) is None:
            found = pattern.search(text, found.start() + 1)
        if found is None:
            continue
        letters = re.findall(r"[A-Za-zΩµμ]+", found["unit"])
        if pattern in (_BEHIND, _SPACED) and any(x in scope.functions or scope.declares(x) for x in letters):
            continue
        if pattern is _SPACED:
            return _closed(text[: found.start()], text), found["unit"].strip()
        blanked = text[: found.start("unit")] + " " * (found.end("unit") - found.start("unit"))
        ending = text[found.end("unit") :].replace("]", " ")
        if pattern is _IN_BRACKET:
            blanked = blanked[: found.start()] + " " * (len(blanked) - found.start())
        return re.sub(r"\\[,;:! ](?=\s*$)", "  ", blanked) + ending, found["unit"].strip()
    return text, ""
