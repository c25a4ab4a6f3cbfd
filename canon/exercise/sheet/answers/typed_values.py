"""Typed values: what people write where numbers are asked, ``x = ±√2``, ``0.588 m/s``, ``{1, 3}``, one by one.

``±`` is two values, ``≈`` is read as ``=``, and every side of ``x = 10/17 ≈ 0.588`` is a value that must be right. A
comma between figures, ``0,588``, and ``±`` between decimals, which may be an uncertainty, are refused.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from canon.exercise.sheet.equations.own_labels import without_label_of_table
from canon.exercise.sheet.field_texts import entries_of
from canon.exercise.sheet.left_sides import Label, label_of
from canon.exercise.sheet.quantities.calculations import calculated
from canon.exercise.sheet.quantities.measures import DEGREES, measure_of, unit_behind, with_strokes
from canon.expression.parse import parse_expression, statements_of
from canon.expression.text.declared_names import key_of
from canon.expression.text.markup import unmarked
from canon.expression.text.tokens import LanguageError
from canon.expression.text.units import units

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from canon.expression.text.scope import Scope
    from canon.expression.text.statement import Side

    _Fault = Callable[[str, LanguageError], Exception]

__all__ = ["SIGNS", "Value", "both_signs", "signed_tables", "typed_values", "values_under"]

MOST_VALUES = 100
"""Most values in one field."""
_OR = re.compile(
    r"\\(?:text|textrm|mbox|mathrm)\s*\{[\s~]*(?:or|and)[\s~]*\}|\\(?:lor|vee)(?![A-Za-z])|\bor\b|∨|(?<=\s)\|\|(?=\s)"
)
_NEARLY = re.compile(r"\\(?:approx|simeq|in)(?![A-Za-z])|[≈≃≅≐∈]|~=|(?<!\\)(?<=\s)~(?=\s*[-0-9.])|^\s*~")
_IN_BRACKETS = re.compile(r"(?:∈|\\in(?![A-Za-z]))[\s$]*(?:\\left(?![A-Za-z])\s*)?(?=[\[\](])")
_TEN = re.compile(r"(?<=[0-9])\s?([xX])\s?(?=10(?:\^|\*\*|[⁻⁺⁰¹²³⁴-⁹]))")
_DOTS = re.compile(r"(?<=[0-9])(?:\.\.\.+|…|\\(?:dots|ldots|cdots)(?![A-Za-z]))")
_COMMA = re.compile(r"(?<![0-9A-Za-z_.,])[0-9]+,[0-9]+(?![0-9,])")
_GROUPS = re.compile(
    r"(?<![0-9A-Za-z_.,])[0-9]{1,3}"
    r"(?:(?:,[0-9]{3}){2,}(?!,)|(?: [0-9]{3})+|(?:(?:[\u00a0\u2009\u202f]|\\,)[0-9]{3})+)(?![0-9])"
)
"""Figures in groups of three, with gaps as the SI brochure has it (§5.4.4), or with commas."""
_STOP = re.compile(r"(?<=[A-Za-zΩ°²³)}])\s?\.\s*$")
"""The full stop of a sentence, behind a unit."""
SIGNS = re.compile(r"\\pm(?![A-Za-z])|\\mp(?![A-Za-z])|±|∓|\+/[-−]")
_ABOUT = re.compile(r"\b(?:about|approximately|approx\.?|roughly|ca\.|circa)(?=\s*[-0-9.])")
_ARC = re.compile(r"(?i)arc|(?<![a-z])a(?:cos|sin|tan)|(?:cos|sin|tan)(?:⁻¹|\^\{?\(?-1)")
"""Inverse functions, whose values are angles."""
_UNCERTAIN = re.compile(
    r"(?<![0-9.])(?:[0-9]++(?:\.[0-9]*+)?|\.[0-9]++)\s*+(?:±|\\pm|\+/-)\s*+[0-9]*+\.[0-9]++|[0-9]\.[0-9]++\([0-9]+\)"
)


@dataclass(frozen=True)
class Value:
    """One value as it was written, at its columns, and the unit behind it."""

    text: str
    unit: str = ""


def both_signs(text: str) -> tuple[str, ...]:
    r"""Return the two texts that one with ``±`` stands for, or the text itself; ``∓`` has the opposite sign.

    Raises
    ------
    LanguageError
        Where it stands for more than two, or for a measured value.

    Examples
    --------
    >>> both_signs("1 ± sqrt(2)"), both_signs(r"$\mp a$"), both_signs("2")
    (('1 + sqrt(2)', '1 - sqrt(2)'), ('$-   a$', '$+   a$'), ('2',))
    """
    if found := _UNCERTAIN.search(text):
        raise _uncertain(text, found.start(), found.group())
    if found := re.search(r"\+[-−]", text):
        raise LanguageError(text, found.start() + 1, "is this ±, or a minus?", "write ± or -")
    signs = list(SIGNS.finditer(text))
    if not signs:
        return (text,)
    if len([sign for sign in signs if sign.group() not in ("∓", "\\mp")]) > 1:
        told = "is each ± chosen by itself here, or all of them together?"
        raise LanguageError(text, signs[1].start() + 1, told, "write the values one by one")

    def with_sign(plus: str, minus: str) -> str:
        def chosen(sign: re.Match[str]) -> str:
            return (minus if sign.group() in ("∓", "\\mp") else plus).ljust(len(sign.group()))

        return SIGNS.sub(chosen, text)

    return with_sign("+", "-"), with_sign("-", "+")


def typed_values(text: str, scope: Scope, *, measured: bool, name: str = "") -> tuple[list[Value], list[str]]:
    """Return the values that a field says, and what was passed over in reading it.

    Parameters
    ----------
    text
        The field as it was typed.
    scope
        The declared names.
    measured
        Whether units behind the values are taken off, to be turned into another one.
    name
        What is asked for, by its name; where it is not given any name may stand before ``=``.

    Raises
    ------
    LanguageError
        Where it can be read in two ways.

    Examples
    --------
    >>> from canon.expression.text.scope import Scope
    >>> [value.text.strip() for value in typed_values("x = 1 ± sqrt(2) or x = 7/2 = 3.5", Scope(), measured=False)[0]]
    ['1 + sqrt(2)', '1 - sqrt(2)', '7/2', '3.5']
    """
    _refuse_doubtful_figures(text, measured=measured)
    text = _STOP.sub("", _plain_signs(unmarked(_without_groups(text)), scope))
    if text.count(",") + text.count(";") > MOST_VALUES:
        raise LanguageError(text, 1, f"more than {MOST_VALUES} values", "split the claim")
    values: list[Value] = []
    passed: list[str] = []
    for statement in statements_of(text, scope):
        sides = [side for side in statement.sides if side.text.strip(" $.,;")]
        for side in sides:
            if side is sides[-1] or _is_value(side, scope, measured=measured):
                values += _of_side(side, scope, measured=measured)
            elif (label := _label(side)) is not None:
                _refuse_another(text, side, label, name)
            elif side is sides[0] or _holds(side, name or _name_of(sides[0])):
                _refuse_formula(text, side, name)
            else:
                passed.append(side.text.strip().lstrip("$"))
        if len(values) > MOST_VALUES:
            raise LanguageError(text, 1, f"more than {MOST_VALUES} values", "split the claim")
    return values, passed


def values_under(
    key: str, value: Any, keys: Mapping[str, Any], scope: Scope, fault: _Fault, *, answer: bool
) -> tuple[list[Value], list[str]]:
    """Return the values that the fields under a key say, and sentences on what was passed over.

    Parameters
    ----------
    key, value
        The key, and one field or a list of them.
    keys
        The claim, with the unit that is asked for and the name of what is asked.
    scope
        The declared names.
    fault
        Makes the error of a text at a place.
    answer
        Whether the answer stands here.
    """
    values: list[Value] = []
    told: list[str] = []
    for i, text in enumerate(value if isinstance(value, list) else [value]):
        measured, name = "unit" in keys, str(keys.get("name", ""))
        try:
            found, passed = typed_values(str(text), scope, measured=measured, name=name)
        except LanguageError as error:
            raise fault(f"{key}[{i}]", error) from None
        told += [f"{side} in {key} is passed over: it holds names that are not declared" for side in passed]
        if measured and answer:
            found = [_of_angle(one, str(keys["unit"])) for one in found]
            bare = (one.text.strip(" $") for one in found if not one.unit)
            told += [f"{text} is read in {keys['unit']}, the unit that is asked for" for text in bare]
        values += found
    return values, told


def _of_angle(value: Value, asked: str) -> Value:
    """Return an arc cosine without a unit in radians, where an angle is asked for."""
    measure = measure_of(asked)
    angle = measure is not None and measure.counted_in == "angles" and not any(measure.powers)
    return replace(value, unit="rad") if angle and not value.unit and _ARC.search(value.text) else value


def signed_tables(place: str, table: Mapping[str, Any], fault: _Fault) -> list[Mapping[str, Any]]:
    """Return the one or two tables that values with ``±`` stand for."""
    try:
        signed = {
            name: both_signs(without_label_of_table(name, text))
            for name, text in table.items()
            if isinstance(text, str)
        }
    except LanguageError as error:
        raise fault(place, error) from None
    two = [name for name, texts in signed.items() if len(texts) == 2]
    if len(two) > 1:
        text = str(table[two[1]])
        told = f"is ± of {two[0]} and of {two[1]} chosen together, or each by itself?"
        raise fault(place, LanguageError(text, 1, told, "write the tables one by one"))
    plain = {**table, **{name: texts[0] for name, texts in signed.items()}}
    return [{**plain, two[0]: text} for text in signed[two[0]]] if two else [plain]


def _refuse_doubtful_figures(text: str, *, measured: bool) -> None:
    """Refuse a comma that is a decimal point or parts two values, and degrees that do not count from zero.

    So is a range ``x ∈ [1, 3]``, which is all values between the two; ``x ∈ {1, 3}`` is one or the other.
    """
    between = _IN_BRACKETS.search(text)
    if between and (text[between.end()] == "]" or len(entries_of(text[between.end() :])) == 2):
        told = "is this every value between the two, or one or the other of them?"
        raise LanguageError(text, between.end() + 1, told, "write the values in braces, as in {1, 3}")
    found = _COMMA.search(text)
    if found and text.count("{", 0, found.start()) + text.count("(", 0, found.start()) == 0:
        whole, _, part = found.group().partition(",")
        reason = f"is {found.group()} the decimal {whole}.{part}, or two values?"
        raise LanguageError(text, found.start() + 1, reason, f"write {whole}.{part}, or {whole}; {part}")
    if measured and (degrees := DEGREES.search(text)):
        reason = f"{degrees.group()} is no multiple of a unit: it does not count from zero"
        raise LanguageError(text, degrees.start() + 1, reason, "write the temperature in K")


def _without_groups(text: str) -> str:
    r"""Return a text whose figures stand together, ``3600000`` for ``3 600 000``; every column after them is as it was.

    Commas and blanks may part values as well: of ``100 200`` it is asked; no value begins as in ``3 600 000``.

    Examples
    --------
    >>> _without_groups("3,600,000 J"), _without_groups(r"3\,600\,000 J"), _without_groups("3; 600")
    ('3600000   J', '3600000     J', '3; 600')
    """
    for found in _GROUPS.finditer(text):
        groups = re.split("[, ](?=[0-9])", found.group())
        if len(groups) > 1 and not any(group.startswith("0") for group in groups[1:]):
            whole, apart = "".join(groups), "; ".join(groups)
            reason = f"is {found.group()} the number {whole}, or {len(groups)} values?"
            raise LanguageError(text, found.start() + 1, reason, f"write {whole}, or {apart}")
    return _GROUPS.sub(lambda found: re.sub("[^0-9]", "", found.group()).ljust(len(found.group())), text)


def _plain_signs(text: str, scope: Scope) -> str:
    """Return a text with ``=`` for ≈ and ``;`` for or, and figures that go on cut, every column as it was."""
    text = _OR.sub(lambda found: ";".ljust(len(found.group())), text)
    text = _NEARLY.sub(lambda found: "=".rjust(len(found.group())), text)
    text = _ABOUT.sub(lambda found: " " * len(found.group()), text)
    text = _DOTS.sub(lambda found: " " * len(found.group()), text)
    if not scope.declares("x"):
        text = _TEN.sub(lambda found: re.sub("[xX]", "*", found.group()), text)
    return text


def _label(side: Side) -> Label | None:
    """Return the one name that a side is; ``sin x`` is none."""
    label = label_of(side.said)
    words = re.search(r"[^\W\d_]\s+[^\W\d_]", side.text.strip())
    return None if label is None or words else label


def _name_of(side: Side) -> str:
    """Return the name that a side is, empty where it is none."""
    label = _label(side)
    return label.name if label else ""


def _holds(side: Side, name: str) -> bool:
    """Tell whether a formula holds a name."""
    words = re.findall(r"[^\W\d_]+(?:_\w+)?", side.said)
    return bool(name) and any(key_of(word) == key_of(name) for word in words)


def _refuse_formula(text: str, side: Side, name: str) -> None:
    """Refuse an equation for a value, ``v^2 = 10``, which is not the value."""
    shown, asked = side.text.strip().lstrip("$")[:40], name or "a value"
    remedy = f"write {name or 'x'} = … with the value, or only the value"
    raise LanguageError(text, side.column, f"{asked} is asked for here, and this says {shown} = …", remedy)


def _refuse_another(text: str, side: Side, label: Label, name: str) -> None:
    """Refuse the name of another quantity than the one that is asked for, or its rate; figures count its values."""
    said = label.name
    if label.rates:
        _refuse_formula(text, side, name)
    if name and key_of(said.rstrip("0123456789_")) != key_of(name.rstrip("0123456789_")):
        reason = f"{name} is asked for here, and this says {said} = …"
        raise LanguageError(
            text, side.column, reason, f"write {name} = … if that is meant, or only the value"
        )


def _of_side(side: Side, scope: Scope, *, measured: bool) -> Iterator[Value]:
    """Yield the values of one side: the entries of a set, both signs, each without its unit."""
    for entry in entries_of(side.text):
        if measured:
            entry = with_strokes(entry, scope)
            _refuse_uncertainty(entry, scope)
        for one in both_signs(entry):
            value = Value(*(calculated(one, scope) or unit_behind(one, scope))) if measured else Value(one)
            if measured and (inside := units(value.text, scope)):
                reason = f"the unit {inside[0].text} stands inside a calculation"
                raise LanguageError(one, inside[0].start + 1, reason, "write it once, behind the value")
            yield value


def _refuse_uncertainty(text: str, scope: Scope) -> None:
    """Refuse ``5 m/s ± 0.1 m/s``, whose unit stands before ± as well."""
    sign = SIGNS.search(text)
    if sign and unit_behind(text[: sign.start()], scope)[1]:
        raise _uncertain(text, len(text) - len(text.lstrip(" $")), text.strip(" $"))


def _uncertain(text: str, start: int, shown: str) -> LanguageError:
    reason = f"is {shown} two values, or one with its uncertainty?"
    return LanguageError(text, start + 1, reason, "write both values, or leave the uncertainty out")


def _is_value(side: Side, scope: Scope, *, measured: bool) -> bool:
    """Tell whether a side before the last is a value and no name or formula of other quantities."""
    label = label_of(side.said)
    if label is not None and label.name and not scope.declares(label.name):
        return False
    try:
        for value in _of_side(side, scope, measured=measured):
            if parse_expression(value.text, scope).free_symbols and label is not None:
                return False
    except LanguageError:
        return False
    return True
