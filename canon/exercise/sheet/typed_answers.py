"""Typed answers: what people write in one field made into what the keys of a claim hold.

Left sides that name the answer are taken away, chains ``a = b = c`` are kept as links that are judged as well, several
equations in one text become several, components in one bracket a list. Nothing is dropped silently: what is passed over
is told, and what contradicts the question makes the claim invalid.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

from canon.exercise.sheet import field_texts
from canon.exercise.sheet.equations.capitals import lowered
from canon.exercise.sheet.equations.equation_numbers import numbers_apart
from canon.exercise.sheet.equations.matrix_products import components_of_products
from canon.exercise.sheet.equations.own_labels import (
    counted_in_words,
    is_rest,
    without_arrow,
    without_differential,
    without_own_label,
    without_words_before,
)
from canon.exercise.sheet.equations.program_lists import lists_in, rule_as_equation
from canon.exercise.sheet.equations.sides import Sides
from canon.exercise.sheet.equations.told_signs import without_told_sign
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
    has_primes,
    is_asked,
    is_of_another,
    label_of,
)
from canon.exercise.sheet.quantities.given_functions import key_at
from canon.exercise.sheet.quantities.known_vectors import with_angular_momenta
from canon.exercise.sheet.typed_values import signed_tables, values_under
from canon.exercise.sheet.written_answers import WrittenAnswers
from canon.expression.parse import LanguageError, parse_expression
from canon.expression.symbols.symbol import Coordinate, Momentum
from canon.expression.text.declared_names import key_of
from canon.expression.text.statement import Side
from canon.expression.text.vocabulary import CONSTANTS, OTHER_NAMES

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from canon.exercise.sheet.sheet import Claim
    from canon.expression.text.scope import Scope
    from canon.expression.text.statement import Statement

    _Fault = Callable[[str, LanguageError], Exception]

__all__ = ["Link", "TypedAnswers", "typed_answers"]

_EQUATIONS = ("claim", "constraints", "restrict", "equations", "implicit", "leaves", "integrals", "boundary")
_UNTOUCHED = ("domain", "class")


class Link(NamedTuple):
    """An equation that stands between two sides of a chain at a place of the claim, and its left side."""

    place: str
    text: str
    left: str


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
    return _Plain(claim, scope, fault).claim()


class _Plain:
    """Makes one claim plain."""

    def __init__(self, claim: Claim, scope: Scope, fault: _Fault) -> None:
        self.of = claim
        self.scope = scope
        self.fault = fault
        self.kind = kind_of(claim.kind, claim.keys)
        self.found = TypedAnswers()
        self.sides = Sides(claim.keys, scope, fault, self.found.passed)

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
                    name: self.expression(f"{key}.{name}", text, entry_asked(key, name))
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
        return self.expression(key, text, self.quantity(key))

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

    def expression(self, place: str, text: Any, asked: Quantity) -> Any:
        """Return the text of one expression without its left sides; what else it says becomes links."""
        if not isinstance(text, str):
            return text
        text = self.in_plain_words(place, text)
        text = text if place == "dof" else self.without_rule(text, asked)
        given, statements = self.sides.given(place), self.sides.statements(place, text)
        if len(statements) > 1:
            statements = [s for s in statements if not given.says_a_momentum(s)] or statements
        if len(statements) > 1:
            raise self.several_said(place, text, statements, asked)
        named = self.without_name_of_bracket(place, next(iter(statements)).sides, asked)
        if is_rest(place, named, asked, self.scope):
            return "0"
        first, *others = self.without_own_label(place, self.without_rate_of_entry(named, asked))
        sides = [first, *(side for side in others if not self.is_constant(place, side))]
        if len(sides) == 1:
            return self.written_out(place, first)
        self.refuse_lagrangian(place, text, sides[0])
        if not self.is_asked(sides[0], asked) and self.is_asked(sides[-1], asked):
            sides = sides[::-1]  # p²/2m = T = H
        if self.is_asked(sides[0], asked):
            if place == "H" and sides[0].said.startswith("E"):
                self.found.passed.append("E in H is read as H, which is asked for")
            sides = sides[1:]
        else:
            self.refuse_other_names(place, text, sides[0], asked)
        return self.last_of(place, text, sides, asked)

    def without_rule(self, text: str, asked: Quantity) -> str:
        """Return ``H -> …`` of Mathematica as an equation; small quantities may tend to something."""
        if asked.bracket or "small" in self.kind.shapes or not re.search("->|[→↦]", text):
            return text
        text = self.listed(asked.shown, text)
        return rule_as_equation(text, lambda name: self.is_asked(Side(name, re.sub(r"\s", "", name)), asked))

    def in_plain_words(self, place: str, text: str) -> str:
        """Return the text of one answer with numbers for words that count, without a sign that is told behind it."""
        if place in ("dof", "factor") or place.endswith(".value"):
            return counted_in_words(without_words_before(place, text, self.scope), self.scope)
        if (variable := self.variable_mapped(place)) is not None:
            return without_arrow(text, variable)
        if place != "energy_rate":
            return text
        try:
            text, told = without_told_sign(text, self.scope)
        except LanguageError as error:
            raise self.fault(place, error.at_home_in(text)) from None
        if told:
            self.found.passed.append(f"{told} in {place} is passed over: it follows from the rate before it")
        return text

    def variable_mapped(self, place: str) -> str | None:
        """Return the variable whose image is asked for at a place, ``q`` of ``q ↦ p``; None elsewhere."""
        found = re.fullmatch(r"(?:map\.)?(?P<key>[QP])\[(?P<at>\d+)\]", place)
        names: Any = self.of.keys.get(found["key"].lower(), []) if found else []
        names = names if isinstance(names, list) else [names]
        return names[int(found["at"])] if found and int(found["at"]) < len(names) else None

    def without_name_of_bracket(self, place: str, sides: Sequence[Side], asked: Quantity) -> Sequence[Side]:
        """Return sides without a name of the writer's own for the value of a bracket, ``L_z = …``, which is told."""
        label = label_of(sides[0].said)
        one = re.fullmatch(r"[\s$]*\\?[^\W\d_]+(?:_\{?\w{1,4}\}?)?\s*", sides[0].text)
        if not (asked.bracket and len(sides) == 2 and one and label and label.name) or label.rates:
            return sides
        if label.name in CONSTANTS or label.name in OTHER_NAMES or is_asked(label, asked, self.scope):
            return sides
        if key_of(label.name) in {key_of(name) for name in self.scope.spelled}:
            return sides
        self.found.passed.append(f"{label.name} in {place} is taken for {asked.shown}, which is asked for")
        return sides[1:]

    def several_said(
        self, place: str, text: str, statements: Sequence[Statement], asked: Quantity
    ) -> Exception:
        """Return the error of several statements where one expression is asked for."""
        named = [s for s in statements if self.is_asked(s.sides[0], asked) and s.sides[1:]]
        other = next((s for s in statements if s not in named), statements[-1]).sides[0]
        reason, remedy = f"one expression is asked for: {asked.shown}", "leave the others out"
        if len(named) == 1:
            reason, remedy = f"this is another statement beside {asked.shown}", "put it in, or leave it out"
        return self.sides.told(place, text, other, reason, remedy)

    def without_own_label(self, place: str, sides: Sequence[Side]) -> Sequence[Side]:
        """Return sides without a free name before what the question has no name for, which is told."""
        rest = without_own_label(place, sides, self.of.keys, self.scope)
        if rest is not sides:
            self.found.passed.append(f"{sides[0].text.strip(' $')} in {place} is taken for what is asked for")
        return rest

    def without_rate_of_entry(self, sides: Sequence[Side], asked: Quantity) -> Sequence[Side]:
        """Return sides without ``ṗ`` before ``{p, H}``, which is what it is by Hamilton's equations."""
        label, bracket = label_of(sides[0].said), label_of(sides[1].said) if len(sides) > 2 else None
        if not (asked.bracket and label and bracket and label.rates == 1 and not bracket.name):
            return sides
        by_energy = bracket.arguments[1:] == ("H",) and key_of(label.name) == key_of(asked.bracket[0])
        declared = isinstance(self.scope.symbol(label.name), Coordinate | Momentum)
        return sides[1:] if by_energy and declared and self.is_asked(sides[1], asked) else sides

    def last_of(self, place: str, text: str, sides: list[Side], asked: Quantity) -> str:
        """Return the last side of a chain; those before it are links, or definitions that are passed over."""
        readable: list[Side] = []
        for side in sides[:-1]:
            if self.is_asked(side, asked):
                continue
            if (
                self.sides.is_origin(place, side, asked.shown)
                or self.sides.given(place).put_in(side.text) is not None
            ):
                made = self.sides.origin(place, side, sides[-1])
                self.found.links += [Link(place, each, each.partition(" = ")[0]) for each in made]
            else:
                self.read(place, text, side, asked)
                readable.append(side)
        readable.append(sides[-1])
        self.found.links += [self.link(place, a, b) for a, b in pairwise(readable)]
        return self.written_out(place, sides[-1])

    def link(self, place: str, a: Side, b: Side) -> Link:
        """Return the equation between two sides of a chain, H put in where the last is said by it."""
        right = self.written_out(place, b)
        if right == b.text:
            return Link(place, field_texts.equation_between(a, b), a.text)
        return Link(place, f"{parse_expression(a.text, self.scope)} = {right}", a.text)

    def written_out(self, place: str, side: Side) -> str:
        """Return the text of an answer, with H put in where J, ω or an adiabatic invariant is said by it."""
        if place.endswith(".value") and not self.sides.can_read(side):  # -L_z beside {L_x, L_y}
            said = self.sides.given(place).put_in(side.text)
            return side.text if said is None else str(said)
        by_energy = ("J", "omega", "I")[: 2 + ("slow" in self.kind.shapes)]  # I = H says nothing elsewhere
        known = key_at(place) not in by_energy or not re.search(r"[HE]", side.text)
        if known or self.sides.can_read(side):
            return side.text
        said = self.sides.given(place).put_in(side.text)
        return side.text if said is None else str(said)

    def read(self, place: str, text: str, side: Side, asked: Quantity) -> None:
        """Refuse a side that is neither a name of the answer nor an expression."""
        try:
            parse_expression(side.text, self.scope)
        except LanguageError as error:
            label = label_of(side.said)
            if label is not None and label.name:
                raise self.contradiction(place, text, side, asked) from None
            raise self.fault(place, error.at_home_in(text)) from None

    def refuse_other_names(self, place: str, text: str, side: Side, asked: Quantity) -> None:
        """Refuse a left side that is the name of something else."""
        label = label_of(side.said)
        given = self.sides.given(place)
        if self.is_slope_asked(place, side):
            return
        if place.startswith("values.") and asked.shown in re.findall(r"[^\W\d_]+(?:_\w+)?", side.said):
            raise self.contradiction(place, text, side, asked)
        if is_of_another(side.said) and self.sides.is_origin(place, side, asked.shown):
            if given.worked_out(side.said) is None:
                raise self.contradiction(place, text, side, asked)
            return
        if label is None or place in ("lhs", "rhs"):
            return
        worked_out = asked.shown == "I" and given.put_in(side.text) is not None
        if not worked_out and (label.name or asked.bracket):
            raise self.contradiction(place, text, side, asked)

    def is_slope_asked(self, place: str, side: Side) -> bool:
        """Tell whether a side is ``∂W/∂q`` for that component of a gradient."""
        found = re.fullmatch(r"∂[WSF]_?\w{0,2}/∂(\S{1,20})", side.said)
        index = re.fullmatch(r"gradient\[(\d+)\]", place)
        q: Any = self.of.keys.get("q", [])
        q = q if isinstance(q, list) else [q]
        return bool(found and index and key_of(q[int(index[1])]) == key_of(found[1]))

    def contradiction(self, place: str, text: str, side: Side, asked: Quantity) -> Exception:
        """Return the error of a left side that is not what is asked."""
        shown = side.text.strip().strip("$").strip()[:40]
        remedy = f"write {asked.shown} = … if that is meant, or only what stands on the right"
        return self.sides.told(
            place, text, side, f"{asked.shown} is asked for here, and this says {shown} = …", remedy
        )

    def is_asked(self, side: Side, asked: Quantity) -> bool:
        """Tell whether a side is a name of what is asked; of a constant of the motion, any name that is free."""
        label = label_of(side.said)
        if asked.shown == "K" and "angles" in self.kind.shapes and re.fullmatch("⟨H⟩|<H>", side.said):
            return True  # the mean of H, which the averaged Hamiltonian is
        if asked.shown == "I" and label is not None and label.name and not label.rates:
            given = self.scope.declares(label.name) or isinstance(self.of.keys.get(label.name), str)
            asked = asked if given else Quantity("I", ((label.name, 0),))
        if asked.shown == "I" and label is None and self.is_of_free_name(side):
            return True
        rate = label is not None and label.rates > 0 and not has_primes(side.text)
        if rate and asked.shown in OTHER_SPELLINGS:
            return False  # dH/dt and Ḣ are no names of what H' is a name of
        if asked.bracket and label is not None and not label.name:
            known = with_angular_momenta(self.of.keys, self.scope)
            return any(is_asked(label, asked, scope) for scope in (self.scope, known))
        return is_asked(label, asked, self.scope)

    def is_of_free_name(self, side: Side) -> bool:
        """Tell whether a side is a multiple or power of one free name, ``2T`` or ``L²``, constant as that is."""
        found = re.fullmatch(
            r"(?:\d{1,3}\*?)?(?P<name>[^\W\d]\w{0,9})(?:\^?\{?[2-9]\}?|[²³⁴]|\*\*[2-9])?", side.said
        )
        label = label_of(found["name"]) if found else None
        if label is None or not label.name or label.rates or self.sides.can_read(side):
            return False
        vector = re.search(r"\\(?:vec|mathbf|boldsymbol|bm)", side.text) is not None
        given = isinstance(self.of.keys.get(label.name), str) and not vector
        return not (given or self.scope.declares(label.name))

    def refuse_lagrangian(self, place: str, text: str, side: Side) -> None:
        """Refuse ``L = …`` as a constant of the motion where L is the Lagrangian of the claim."""
        said = re.fullmatch(r"\|?L\|?(?:\^?\{?2\}?|\*\*2|²)?", side.said)
        free = side.said != "L" and self.is_of_free_name(side)
        if place == "I" and said and not free and isinstance(self.of.keys.get("L"), str):
            reason = "is L the Lagrangian here, or a name of the constant?"
            raise self.sides.told(
                place, text, side, reason, "write L_z = …, or only what stands on the right"
            )

    def is_constant(self, place: str, side: Side) -> bool:
        """Tell whether a side only says that the others are constant."""
        of_motion = place == "I" or place.startswith("conserved")
        return (
            of_motion
            and not self.scope.declares("const")
            and field_texts.says_constant(side.text, self.scope)
        )

    def bracket(self, place: str, pair: Any) -> Any:
        """Return a bracket whose value is in plain form."""
        if not isinstance(pair, Mapping) or "value" not in pair:
            return pair
        first, second = ("f", "g") if "f" in pair else ("u", "v")
        if not (isinstance(pair.get(first), str) and isinstance(pair.get(second), str)):
            return pair
        asked = Quantity(f"{{{pair[first]}, {pair[second]}}}", (), (pair[first], pair[second]))
        return {**pair, "value": self.expression(f"{place}.value", pair["value"], asked)}

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
            found.append(self.expression(f"{place}[{i}]", text, asked) if isinstance(text, str) else text)
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
        each = [sum(self.is_asked(side, name) for side in leading) for name in names]
        if len(names) < 2 or len(sides) <= len(names) or each != [1] * len(names):
            return []
        return [field_texts.whole_statement(replace(statement, sides=sides[len(names) :]), text)] * len(names)

    def in_order(self, place: str, texts: Sequence[str], names: tuple[Quantity, ...]) -> list[str]:
        """Return components in the order that is asked for, where their left sides say another one."""
        places: list[int] = []
        for i, text in enumerate(texts):
            sides = self.sides.statements(f"{place}[{i}]", text)[0].sides
            named = [j for j, name in enumerate(names) if sides[1:] and self.is_asked(sides[0], name)]
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
