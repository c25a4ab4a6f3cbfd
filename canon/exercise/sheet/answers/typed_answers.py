"""Typed answers: what people write in one field made into what the keys of a claim hold.

Left sides that name the answer are taken away, chains ``a = b = c`` are kept as links that are judged as well, several
equations in one text become several, components in one bracket a list. Nothing is dropped silently: what is passed over
is told, and what contradicts the question makes the claim invalid.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from canon.exercise.sheet import field_texts
from canon.exercise.sheet.answers.one_expression import Link, OneExpression
from canon.exercise.sheet.answers.typed_values import signed_tables, values_under
from canon.exercise.sheet.answers.written_answers import WrittenAnswers
from canon.exercise.sheet.equations.capitals import lowered
from canon.exercise.sheet.equations.equation_numbers import numbers_apart
from canon.exercise.sheet.equations.matrix_products import components_of_products
from canon.exercise.sheet.equations.own_labels import (
    without_differential,
)
from canon.exercise.sheet.equations.program_lists import lists_in
from canon.exercise.sheet.equations.sides import Sides
from canon.exercise.sheet.equations.typed_equations import typed_equations
from canon.exercise.sheet.equations.typed_indices import equations_by_index
from canon.exercise.sheet.equations.typed_matrices import equations_of_matrices
from canon.exercise.sheet.equations.vector_operators import components_of_operator
from canon.exercise.sheet.equations.virtual_work import forces_of_work
from canon.exercise.sheet.kind import Shape
from canon.exercise.sheet.kinds import kind_of
from canon.exercise.sheet.left_sides import (
    OTHER_SPELLINGS,
    Quantity,
    components_asked,
    entry_asked,
)
from canon.exercise.sheet.quantities.given_functions import with_partial_signs
from canon.expression.parse import LanguageError
from canon.expression.rows.plain_rows import plain_rows
from canon.frozen_mapping import FrozenMapping

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.exercise.sheet.sheet import Claim
    from canon.expression.text.scope import Scope

    _Fault = Callable[[str, LanguageError], Exception]

__all__ = ["TypedAnswers", "typed_answers"]

_EQUATIONS = ("claim", "constraints", "restrict", "equations", "implicit", "leaves", "integrals", "boundary")
_UNTOUCHED = ("domain", "class")


@dataclass
class TypedAnswers:
    """The keys of a claim in plain form, the links of its chains, and what was passed over in reading it.

    Parameters
    ----------
    keys
        Every text one expression or one equation.
    links
        Equations between the sides of chains.
    passed
        Sentences for the warnings.
    units
        The unit behind a value, by its place in the claim.
    """

    keys: dict[str, Any] = field(default_factory=dict[str, Any])
    links: list[Link] = field(default_factory=list[Link])
    passed: list[str] = field(default_factory=list[str])
    units: dict[str, str] = field(default_factory=dict[str, str])


def typed_answers(claim: Claim, scope: Scope, fault: _Fault) -> TypedAnswers:
    """Return what a claim says with every text of it in plain form.

    Parameters
    ----------
    claim
        The claim as written; its form has been checked.
    scope
        Its declared names.
    fault
        Makes the error of a text under a key.

    Raises
    ------
    Exception
        What ``fault`` makes, where a left side contradicts the question or a text holds more than is asked.
    """
    answer = [key for key in kind_of(claim.kind, claim.keys).answer if key not in _UNTOUCHED]
    keys = {
        key: _in_rows(key, value, scope, fault) if key in answer else value
        for key, value in claim.keys.items()
    }
    return _Plain(replace(claim, keys=FrozenMapping(keys)), scope, fault).claim()


def _in_rows(place: str, value: Any, scope: Scope, fault: _Fault) -> Any:
    """Return what stands at a place without the bullets, labels and numbers of its rows."""
    if isinstance(value, Mapping):
        return {name: _in_rows(f"{place}.{name}", item, scope, fault) for name, item in value.items()}
    if isinstance(value, list):
        return [_in_rows(f"{place}[{i}]", item, scope, fault) for i, item in enumerate(value)]
    if not isinstance(value, str):
        return value
    try:
        return plain_rows(value, scope)
    except LanguageError as error:
        raise fault(place, error) from None


class _Plain:
    """Makes one claim plain."""

    def __init__(self, claim: Claim, scope: Scope, fault: _Fault) -> None:
        self.of = claim
        self.scope = scope
        self.fault = fault
        self.kind = kind_of(claim.kind, claim.keys)
        self.found = TypedAnswers()
        self.sides = Sides(claim.keys, scope, fault, self.found.passed)
        self.one = OneExpression(self.kind, self.sides, self.found.links)

    def claim(self) -> TypedAnswers:
        """Return all keys, those with texts in plain form."""
        keys = self.in_small_letters()
        for key, value in keys.items():
            self.found.keys[key] = self.value(key, value)
        return self.found

    def in_small_letters(self) -> Mapping[str, Any]:
        """Return all keys, the answers without capitals that a keyboard made, which is told."""
        answers = {key: value for key, value in self.of.keys.items() if key in self.kind.answer}
        small = lowered([text for _, text in field_texts.texts_in(answers)], self.of.keys, self.scope)
        if not small:
            return self.of.keys
        self.found.passed.append("capitals are read as the small letters of the question")
        return {
            key: field_texts.with_texts(value, small) if key in answers else value
            for key, value in self.of.keys.items()
        }

    def value(self, key: str, value: Any) -> Any:
        """Return what stands under a key in plain form."""
        if key in _UNTOUCHED:
            return value
        if key in self.kind.answer:
            value = self.with_partial_signs(key, value)
            value = value if key in self.kind.several else self.listed(key, value)
            written = WrittenAnswers(self.kind, self.sides, is_list_of_equations=self.has_equations(key))
            value = written.answer(key, value, self.quantity(key))
        if key in self.kind.several:
            return self.several(key, value)
        match self.kind.shapes.get(key):
            case Shape.TEXT:
                return self.of_text(key, value)
            case Shape.TEXTS:
                return (
                    typed_equations(key, value, self.sides)
                    if self.has_equations(key)
                    else self.components(key, value)
                )
            case Shape.EXPRESSIONS if isinstance(value, Mapping):
                return {
                    name: self.one.plain(f"{key}.{name}", text, entry_asked(key, name))
                    for name, text in value.items()
                }
            case Shape.LISTS if isinstance(value, Mapping):
                return {part: self.components(f"{key}.{part}", texts) for part, texts in value.items()}
            case Shape.VALUES:
                places = ((f"{key}[{i}]", table) for i, table in enumerate(_tables(value)))
                return [one for place, table in places for one in signed_tables(place, table, self.fault)]
            case Shape.BRACKETS:
                return [self.bracket(f"{key}[{i}]", pair) for i, pair in enumerate(_tables(value))]
            case _:
                return value

    def with_partial_signs(self, key: str, value: Any) -> Any:
        """Return what stands under a key with ``∂H/∂p`` for ``dH/dp``, where it is nothing else."""
        texts = {text: with_partial_signs(key, text, self.of.keys) for _, text in field_texts.texts_in(value)}
        return field_texts.with_texts(value, {text: made for text, made in texts.items() if made != text})

    def listed(self, key: str, value: Any) -> Any:
        """Return what stands under a key with the lists of programs as people write them."""
        if self.has_equations(key):
            value = numbers_apart(value) if isinstance(value, str) else value
            value = [numbers_apart(value[0])] if _is_one_text(value) else value
        if key == "claim" and self.has_equations(key) and _is_one_text(value):
            value = [equations_of_matrices(equations_by_index(value[0], self.scope), self.scope)]
        try:
            return lists_in(value)
        except LanguageError as error:
            raise self.fault(key, error) from None

    def several(self, key: str, value: Any) -> list[Any]:
        """Return values one by one, each with the unit behind it kept apart."""
        answer = key in self.kind.answer
        values, passed = values_under(key, value, self.of.keys, self.scope, self.fault, answer=answer)
        self.found.passed += passed
        self.found.units |= {f"{key}[{i}]": value.unit for i, value in enumerate(values)}
        return [value.text for value in values]

    def has_equations(self, key: str) -> bool:
        """Tell whether a list holds equations, whose left sides are no names."""
        return key in _EQUATIONS and key not in self.kind.components

    def of_text(self, key: str, value: Any) -> Any:
        """Return the one text under a key in plain form."""
        text = value[0] if isinstance(value, list) else value
        if key == "claim" and isinstance(text, str):
            text = without_differential(text, self.of.keys, self.scope)
        if key in _EQUATIONS:
            equations = typed_equations(key, [text], self.sides)
            return equations[0] if len(equations) == 1 else text
        return self.one.plain(key, text, self.quantity(key))

    def quantity(self, key: str) -> Quantity:
        """Return what a key of one expression asks for, by its names."""
        names = [key, *OTHER_SPELLINGS.get(key, ())]
        if key == "F" and (number := self.kind.implied.get("type")):
            names += [f"F_{number}", f"G_{number}"]
        if key == "H" and not self.scope.declares("E"):
            names.append("E")
        if key == "energy_rate":
            return Quantity("dE/dt", (("E", 1), ("H", 1), ("W", 1)))
        return Quantity(key, tuple((name.rstrip("'"), name.count("'")) for name in names))

    def bracket(self, place: str, pair: Any) -> Any:
        """Return a bracket whose value is in plain form."""
        if not isinstance(pair, Mapping) or "value" not in pair:
            return pair
        first, second = ("f", "g") if "f" in pair else ("u", "v")
        if not (isinstance(pair.get(first), str) and isinstance(pair.get(second), str)):
            return pair
        asked = Quantity(f"{{{pair[first]}, {pair[second]}}}", (), (pair[first], pair[second]))
        return {**pair, "value": self.one.plain(f"{place}.value", pair["value"], asked)}

    def components(self, place: str, value: Any) -> Any:
        """Return a list of components in plain form, in their order where each says which it is."""
        texts: list[Any] = value if isinstance(value, list) else [value]
        names = components_asked(place, self.of.keys, self.scope)
        if len(texts) == 1 and isinstance(texts[0], str):
            apart = self.apart(place, texts[0])
            texts = apart if len(apart) > 1 else self.of_all(place, texts[0], names) or apart
        if len(texts) == len(names) > 1 and all(type(text) is str for text in texts):
            texts = self.in_order(place, texts, names)
        found: list[Any] = []
        for i, text in enumerate(texts):
            free = "I" if place in ("conserved", "not_conserved") else f"component {i + 1}"
            asked = names[i] if i < len(names) else Quantity(free)
            found.append(self.one.plain(f"{place}[{i}]", text, asked) if isinstance(text, str) else text)
        return found if isinstance(value, list) or len(found) > 1 else found[0]

    def apart(self, place: str, text: str) -> list[str]:
        """Return the components that stand in one text: in one bracket, or as several equations."""
        if "work" in self.kind.shapes and (forces := forces_of_work(text, self.of.keys["q"], self.scope)):
            return forces
        if place in ("claim", "X", "Y") and "X" in self.kind.shapes:
            components = components_of_operator(text, self.of.keys.get("x", []), self.scope)
            if components:
                return components
        entries = field_texts.of_matrix(text) or components_of_products(text, self.sides.reads(place, text))
        if entries:
            return entries
        statements = self.sides.statements(place, text)
        if len(statements) > 1:
            return [field_texts.whole_statement(statement, text) for statement in statements]
        return field_texts.components_of(text) or [text]

    def of_all(self, place: str, text: str, names: tuple[Quantity, ...]) -> list[str]:
        """Return a value for each of several components that are said to be equal, ``ω_r = ω_φ = k``."""
        statement = self.sides.statements(place, text)[0]
        leading, sides = statement.sides[: len(names)], statement.sides
        each = [sum(self.one.names.is_asked(side, name) for side in leading) for name in names]
        if len(names) < 2 or len(sides) <= len(names) or each != [1] * len(names):
            return []
        return [field_texts.whole_statement(replace(statement, sides=sides[len(names) :]), text)] * len(names)

    def in_order(self, place: str, texts: Sequence[str], names: tuple[Quantity, ...]) -> list[str]:
        """Return components in the order that is asked for, where their left sides say another one."""
        places: list[int] = []
        for i, text in enumerate(texts):
            sides = self.sides.statements(f"{place}[{i}]", text)[0].sides
            named = [
                j for j, name in enumerate(names) if sides[1:] and self.one.names.is_asked(sides[0], name)
            ]
            if len(named) != 1:
                return list(texts)
            places += named
        if sorted(places) != list(range(len(names))):
            return list(texts)
        return [texts[places.index(j)] for j in range(len(names))]


def _is_one_text(value: Any) -> bool:
    """Tell whether a list holds one text."""
    return isinstance(value, list) and len(value) == 1 and isinstance(value[0], str)


def _tables(value: Any) -> Any:
    """Return a list of tables; one alone is a list of one."""
    return [value] if isinstance(value, Mapping) else value
