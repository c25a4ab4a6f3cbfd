"""Dimensions of quantities: exact powers of length, mass, time and the rest, read from what a teacher types.

A dimension is typed by names, ``length/time^2``, ``energy``, or by units, ``m/s^2``, ``N m``. Names of dimensions are
words, units are symbols of the SI with or without prefix; both may stand in one text. Angles and numbers have none.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from itertools import zip_longest
from types import MappingProxyType
from typing import TYPE_CHECKING

from canon.exercise.sheet.quantities.measures import measure_of

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["NUMBER", "TIME", "Dimension", "DimensionError", "dimension_from"]

MOST_CHARACTERS = 120
MOST_POWER = 12
"""Largest numerator and denominator of an exponent that is typed."""
MOST_BRACKETS = 8
_BASES = ("length", "mass", "time", "current", "temperature", "amount")


class DimensionError(ValueError):
    """Raised for a text that is no dimension; the message says what to type instead."""


@dataclass(frozen=True)
class Dimension:
    """A dimension by its powers of length, mass, time, current, temperature and amount of substance.

    Examples
    --------
    >>> energy = dimension_from("mass*length^2/time^2")
    >>> print(energy), print(energy / TIME), print(energy ** Fraction(1, 2))
    energy or torque
    power
    length*mass^(1/2)/time
    (None, None, None)
    """

    powers: tuple[Fraction, ...] = (Fraction(0),) * len(_BASES)

    @classmethod
    def of(cls, *powers: int) -> Dimension:
        """Return the dimension of the first few powers, the others being zero."""
        return cls(tuple(Fraction(power) for _, power in zip_longest(_BASES, powers, fillvalue=0)))

    def __mul__(self, other: Dimension) -> Dimension:
        """Return the dimension of a product."""
        return Dimension(tuple(a + b for a, b in zip(self.powers, other.powers, strict=True)))

    def __truediv__(self, other: Dimension) -> Dimension:
        """Return the dimension of a quotient."""
        return self * other ** Fraction(-1)

    def __pow__(self, exponent: Fraction) -> Dimension:
        """Return the dimension of a power."""
        return Dimension(tuple(exponent * power for power in self.powers))

    @property
    def is_number(self) -> bool:
        """Whether this is the dimension of a number."""
        return not any(self.powers)

    @property
    def name(self) -> str:
        """What people call it; empty where it has no name of its own."""
        return _CALLED.get(self, "")

    def __str__(self) -> str:
        above = [_power(base, p) for base, p in zip(_BASES, self.powers, strict=True) if p > 0]
        below = [_power(base, -p) for base, p in zip(_BASES, self.powers, strict=True) if p < 0]
        divisor = below[0] if len(below) == 1 else f"({'*'.join(below)})"
        return self.name or ("*".join(above) or "1") + (f"/{divisor}" if below else "")


def _power(base: str, power: Fraction) -> str:
    if power == 1:
        return base
    return f"{base}^{power}" if power.denominator == 1 else f"{base}^({power})"


NUMBER, TIME = Dimension(), Dimension.of(0, 0, 1)

_NAMED: Mapping[str, Dimension] = MappingProxyType(
    {
        "length": Dimension.of(1), "mass": Dimension.of(0, 1), "time": TIME,
        "current": Dimension.of(0, 0, 0, 1), "temperature": Dimension.of(0, 0, 0, 0, 1),
        "amount": Dimension.of(0, 0, 0, 0, 0, 1),
        "number": NUMBER, "angle": NUMBER, "dimensionless": NUMBER, "none": NUMBER,
        "area": Dimension.of(2), "volume": Dimension.of(3), "density": Dimension.of(-3, 1),
        "velocity": Dimension.of(1, 0, -1), "speed": Dimension.of(1, 0, -1), "acceleration": Dimension.of(1, 0, -2),
        "frequency": Dimension.of(0, 0, -1), "rate": Dimension.of(0, 0, -1),
        "angular velocity": Dimension.of(0, 0, -1), "angular acceleration": Dimension.of(0, 0, -2),
        "momentum": Dimension.of(1, 1, -1), "force": Dimension.of(1, 1, -2), "pressure": Dimension.of(-1, 1, -2),
        "energy": Dimension.of(2, 1, -2), "work": Dimension.of(2, 1, -2), "torque": Dimension.of(2, 1, -2),
        "power": Dimension.of(2, 1, -3), "action": Dimension.of(2, 1, -1),
        "angular momentum": Dimension.of(2, 1, -1), "moment of inertia": Dimension.of(2, 1),
        "stiffness": Dimension.of(0, 1, -2), "spring constant": Dimension.of(0, 1, -2),
        "charge": Dimension.of(0, 0, 1, 1), "voltage": Dimension.of(2, 1, -3, -1),
        "magnetic field": Dimension.of(0, 1, -2, -1), "electric field": Dimension.of(1, 1, -3, -1),
    }
)  # fmt: skip
"""Dimensions that have names."""
_CALLED: Mapping[Dimension, str] = MappingProxyType(
    {
        **{_NAMED[name]: name for name in reversed(_NAMED)},
        NUMBER: "number",
        _NAMED["energy"]: "energy or torque",
        _NAMED["action"]: "action or angular momentum",
        _NAMED["frequency"]: "frequency or angular velocity",
        _NAMED["velocity"]: "velocity",
    }
)
_LONG = {name.replace(" ", "_"): name for name in _NAMED}
_SIGN = re.compile(
    r"(?P<word>[A-Za-z_µμΩ°%]+|1(?![0-9]))"
    r"|(?P<power>(?:\^|\*\*)\s*(?:(?P<plain>[-−]?[0-9]{1,3})|\(\s*(?P<above>[-−]?[0-9]{1,3})\s*(?:/\s*(?P<below>[0-9]{1,3})\s*)?\)))"
    r"|(?P<raised>⁻?[¹²³⁴⁵⁶⁷⁸⁹])|(?P<sign>[*·⋅/()])|(?P<blank>\s+)"
)
_SMALL = str.maketrans("¹²³⁴⁵⁶⁷⁸⁹⁻−", "123456789--")


def dimension_from(text: str) -> Dimension:
    """Return the dimension that a text says.

    Parameters
    ----------
    text
        Names of dimensions or units, with ``*``, ``/``, brackets and powers; ``1`` for what has none.

    Raises
    ------
    DimensionError
        Where it says none.

    Examples
    --------
    >>> dimension_from("length/time^2") == dimension_from("m/s²") == dimension_from("acceleration")
    True
    >>> dimension_from("kg*velocity/length^(1/2)").powers[:3]
    (Fraction(1, 2), Fraction(1, 1), Fraction(-1, 1))
    >>> dimension_from("furlong")
    Traceback (most recent call last):
        ...
    canon.exercise.sheet.quantities.dimension_texts.DimensionError: furlong is no dimension and no unit; write ...
    """
    if len(text) > MOST_CHARACTERS:
        raise DimensionError(f"{len(text)} characters, and at most {MOST_CHARACTERS} are read")
    plain = re.sub(r"\s+", " ", text.strip())
    for short, name in _LONG.items():
        plain = re.sub(rf"\b{name}\b", short, plain, flags=re.IGNORECASE) if " " in name else plain
    return _Reader(plain).whole()


class _Reader:
    """One pass over a text: products and quotients from left to right, brackets inside."""

    def __init__(self, text: str) -> None:
        self.text, self.at, self.depth = text, 0, 0

    def whole(self) -> Dimension:
        found = self._product()
        if self.at < len(self.text):
            self._refuse()
        return found

    def _product(self) -> Dimension:
        found, divided = self._power(), False
        while (sign := self._next("sign", "*·⋅/")) or (not self._ends() and self._beside()):
            if not sign and divided:
                raise DimensionError("what stands below the stroke is not clear; write a/(b*c) or a/b*c")
            divided = sign == "/"
            other = self._power()
            found = found / other if divided else found * other
        return found

    def _power(self) -> Dimension:
        self._next("blank")
        found = self._atom()
        exponent = Fraction(1)
        match = _SIGN.match(self.text, self.at)
        if match and (match["power"] or match["raised"]):
            self.at = match.end()
            above = (match["raised"] or match["plain"] or match["above"]).translate(_SMALL)
            exponent = _fraction(int(above), int(match["below"] or 1))
        self._next("blank")
        return found**exponent

    def _atom(self) -> Dimension:
        if self._next("sign", "("):
            self.depth += 1
            if self.depth > MOST_BRACKETS:
                raise DimensionError(f"more than {MOST_BRACKETS} brackets inside each other")
            found = self._product()
            if not self._next("sign", ")"):
                raise DimensionError("a bracket is not closed")
            self.depth -= 1
            return found
        word = self._next("word")
        if not word:
            self._refuse()
        return _of_word(word)

    def _next(self, group: str, among: str = "") -> str:
        match = _SIGN.match(self.text, self.at)
        if match is None or not match[group] or (among and match[group] not in among):
            return ""
        self.at = match.end()
        return match[group]

    def _ends(self) -> bool:
        return self.at >= len(self.text)

    def _beside(self) -> bool:
        """Whether a factor begins here, with nothing but a blank between it and the one before."""
        match = _SIGN.match(self.text, self.at)
        return match is not None and bool(match["word"] or match["sign"] == "(")

    def _refuse(self) -> None:
        rest = self.text[self.at : self.at + 20]
        where = f"at {rest!r}" if rest else "at its end"
        raise DimensionError(f"this is not read {where}; write names or units such as {_EXAMPLES}")


_EXAMPLES = "length/time^2, mass*length, energy, kg m/s^2, or 1 for a number"


def _fraction(above: int, below: int) -> Fraction:
    if below == 0 or abs(above) > MOST_POWER or below > MOST_POWER:
        raise DimensionError(
            f"the power {above}/{below} is none that anyone means; at most {MOST_POWER} is read"
        )
    return Fraction(above, below)


def _of_word(word: str) -> Dimension:
    named = _NAMED.get(_LONG.get(word.lower(), ""))
    if named is not None:
        return named
    measure = measure_of(word)
    if measure is None:
        raise DimensionError(f"{word} is no dimension and no unit; write names or units such as {_EXAMPLES}")
    return Dimension.of(*measure.powers)
