"""Calculations with units inside, ``150 kg · 10 m/s²``, worked out to one number and one unit.

Numbers keep their units through products, quotients, powers and roots; what has different dimensions is not added.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import sympy as sp

from canon.exercise.sheet.quantities.measures import BASE_UNITS, UNIT, Measure, measure_of
from canon.expression.parse import parse_expression
from canon.expression.text.notation import is_latex
from canon.expression.text.tokens import LanguageError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from sympy import Expr

    from canon.expression.text.scope import Scope

    _Quantity = tuple[int, int, str, Measure]

__all__ = ["calculated"]

_TIMES = r"(?:\s?[*·⋅/]\s?|\s)"
_NEXT = rf"(?:{_TIMES}{UNIT}|\s?/\s?\({UNIT}(?:{_TIMES}{UNIT}){{0,3}}\))"
"""One more unit, or several below a stroke, ``/(kg K)``."""
_QUANTITY = re.compile(
    rf"(?<![\w.])(?P<number>[0-9]+(?:\.[0-9]*)?(?:[eE][+-]?[0-9]+)?)\s?"
    rf"(?:(?P<unit>{UNIT}{_NEXT}{{0,4}})|\[(?P<bracket>[^\[\]]{{1,40}})\])(?![\w(])"
)
_LAST = re.compile(rf"{_NEXT}$")
_MOST = 20
"""Quantities in one calculation."""


def calculated(text: str, scope: Scope) -> tuple[str, str] | None:
    """Return number and unit of a calculation; None where at most one unit stands in it, at its end.

    Raises
    ------
    LanguageError
        Where quantities of different dimensions are added, or the unit is none with whole powers.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> calculated("150 kg · 10 m/s²", Scope()), calculated("(20 m) / (2 s)", Scope()), calculated("36 km/h", Scope())
    (('1500', 'm kg s^-2'), ('10', 'm s^-1'), None)
    """
    if is_latex(text):
        return None
    quantities = list(_quantities(text, scope))
    inside = [end for _, end, _, _ in quantities if text[end:].strip(" $.,;")]
    if not inside or len(quantities) > _MOST:
        return None
    bases = {name: sp.Dummy(name, positive=True) for name in BASE_UNITS}
    names, pieces, at = dict[str, sp.Dummy](), list[str](), 0
    put: dict[sp.Dummy, Expr] = {}
    for i, (start, end, number, measure) in enumerate(quantities):
        symbol = names[f"Unit_{i}"] = sp.Dummy(f"Unit_{i}", positive=True)
        powers = zip(bases.values(), measure.powers, strict=False)
        put[symbol] = measure.factor * sp.Mul(*(base**power for base, power in powers))
        pieces += (text[at:start], f"({number}*Unit_{i})")
        at = end
    formula = "".join((*pieces, text[at:]))
    try:
        said = parse_expression(formula, replace(scope, names={**scope.names, **names}))
    except LanguageError:
        _check_without_units(text, quantities, scope)
        raise
    return _in_bases(text, sp.expand(said.xreplace(put)), bases)


def _check_without_units(text: str, quantities: Sequence[_Quantity], scope: Scope) -> None:
    """Raise the error that a text has where a number stands for each quantity, at its column."""
    plain = text
    for start, end, _, _ in quantities:
        plain = f"{plain[:start]}{'1'.rjust(end - start)}{plain[end:]}"
    try:
        parse_expression(plain, scope)
    except LanguageError as error:
        raise error.at_home_in(text) from None


def _in_bases(text: str, value: Expr, bases: dict[str, sp.Dummy]) -> tuple[str, str]:
    """Return the number and the unit of what is a number times powers of base units."""
    number, units = value.as_independent(*bases.values(), as_Add=False)
    powers = units.as_powers_dict()
    named = {base: name for name, base in bases.items()}
    if not all(unit in named or unit == 1 for unit in powers) or number.has(*bases.values()):
        raise LanguageError(text, 1, "quantities of different dimensions are added here", "write one unit")
    if not all(sp.sympify(power, strict=True).is_Integer for power in powers.values()):
        raise LanguageError(text, 1, "this has a unit with a power that is not whole", "write the value")
    written = {named[base]: power for base, power in powers.items() if base != 1}
    unit = " ".join(f"{name}^{written[name]}".removesuffix("^1") for name in BASE_UNITS if name in written)
    return str(number), unit or "1"


def _is_declared(unit: str, scope: Scope) -> bool:
    letters = re.findall(r"[A-Za-zΩµμ]+", unit)
    return any(word in scope.functions or scope.declares(word) for word in letters)


def _quantities(text: str, scope: Scope) -> Iterator[_Quantity]:
    """Yield where each number with a unit begins and ends, the number and what its unit measures."""
    for found in _QUANTITY.finditer(text):
        unit, end = found["unit"] or found["bracket"], found.end()
        measure = measure_of(unit)
        while (
            (measure is None or (unit.endswith(")") and _is_declared(unit, scope)))
            and found["unit"]
            and (shorter := _LAST.sub("", unit)) != unit
        ):
            end -= len(unit) - len(shorter)
            unit, measure = shorter, measure_of(shorter)
        if (
            measure is not None
            and not _is_declared(unit, scope)
            and not measure.hertz
            and not measure.counted_in
        ):
            yield found.start(), end, found["number"], measure
