"""One expression of a typed answer: the names before it taken away, what a chain says beside it kept as links."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

from canon.exercise.sheet import field_texts
from canon.exercise.sheet.answers.names_asked import NamesAsked
from canon.exercise.sheet.answers.rate_of_constant import without_rate
from canon.exercise.sheet.equations.own_labels import (
    counted_in_words,
    is_rest,
    without_arrow,
    without_own_label,
    without_words_around,
)
from canon.exercise.sheet.equations.program_lists import lists_in, rule_as_equation
from canon.exercise.sheet.equations.told_signs import without_told_sign
from canon.exercise.sheet.left_sides import (
    Quantity,
    is_asked,
    label_of,
)
from canon.exercise.sheet.quantities.given_functions import key_at
from canon.expression.parse import LanguageError, parse_expression
from canon.expression.symbols.symbol import Coordinate, Momentum
from canon.expression.text.declared_names import key_of
from canon.expression.text.statement import Side
from canon.expression.text.vocabulary import CONSTANTS, OTHER_NAMES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from canon.exercise.sheet.equations.sides import Sides
    from canon.exercise.sheet.kind import Kind
    from canon.expression.text.statement import Statement

__all__ = ["Link", "OneExpression"]


class Link(NamedTuple):
    """An equation that stands between two sides of a chain at a place of the claim, and its left side."""

    place: str
    text: str
    left: str


@dataclass(frozen=True)
class OneExpression:
    """Makes expressions of one claim plain.

    Parameters
    ----------
    kind
        Its kind.
    sides
        What is known of the sides of equations in it, and where what is passed over is noted.
    links
        Where equations between the sides of chains are noted.
    """

    kind: Kind
    sides: Sides
    links: list[Link]

    @property
    def names(self) -> NamesAsked:
        """The names of what is asked for."""
        return NamesAsked(self.kind, self.sides)

    def plain(self, place: str, text: Any, asked: Quantity) -> Any:
        """Return the text of one expression without its left sides; what else it says becomes links."""
        if not isinstance(text, str):
            return text
        text = self._in_plain_words(place, text)
        text = text if place == "dof" else self._without_rule(text, asked)
        given, statements = self.sides.given(place), self.sides.statements(place, text)
        if len(statements) > 1:
            statements = [s for s in statements if not given.says_a_momentum(s)] or statements
        if len(statements) > 1:
            raise self._several_said(place, text, statements, asked)
        named = self._without_name_of_bracket(place, next(iter(statements)).sides, asked)
        if is_rest(place, named, asked, self.sides.scope):
            return "0"
        first, *others = self._without_own_label(place, self._without_rate_of_entry(named, asked))
        sides = [first, *(side for side in others if not self.names.is_constant(place, side))]
        sides = self._without_rate_of_constant(place, sides)
        if len(sides) == 1:
            return self._written_out(place, sides[0])
        self.names.refuse_lagrangian(place, text, sides[0])
        if not self.names.is_asked(sides[0], asked) and self.names.is_asked(sides[-1], asked):
            sides = sides[::-1]  # p²/2m = T = H
        if self.names.is_asked(sides[0], asked):
            if place == "H" and sides[0].said.startswith("E"):
                self.sides.passed.append("E in H is read as H, which is asked for")
            sides = sides[1:]
        else:
            self.names.refuse_other_names(place, text, sides[0], asked)
        return self._last_of(place, text, sides, asked)

    def _without_rule(self, text: str, asked: Quantity) -> str:
        """Return ``H -> …`` of Mathematica as an equation; small quantities may tend to something."""
        if asked.bracket or "small" in self.kind.shapes or not re.search("->|[→↦]", text):
            return text
        text = self._list_in(asked.shown, text)
        return rule_as_equation(
            text, lambda name: self.names.is_asked(Side(name, re.sub(r"\s", "", name)), asked)
        )

    def _in_plain_words(self, place: str, text: str) -> str:
        """Return the text of one answer with numbers for words that count, without a sign that is told behind it."""
        if place in ("dof", "factor") or place.endswith(".value"):
            return counted_in_words(without_words_around(place, text, self.sides.scope), self.sides.scope)
        if (variable := self._variable_mapped(place)) is not None:
            return without_arrow(text, variable)
        if place != "energy_rate":
            return text
        try:
            text, told = without_told_sign(text, self.sides.scope)
        except LanguageError as error:
            raise self.sides.fault(place, error.at_home_in(text)) from None
        if told:
            self.sides.passed.append(f"{told} in {place} is passed over: it follows from the rate before it")
        return text

    def _variable_mapped(self, place: str) -> str | None:
        """Return the variable whose image is asked for at a place, ``q`` of ``q ↦ p``; None elsewhere."""
        found = re.fullmatch(r"(?:map\.)?(?P<key>[QP])\[(?P<at>\d+)\]", place)
        names: Any = self.sides.keys.get(found["key"].lower(), []) if found else []
        names = names if isinstance(names, list) else [names]
        return names[int(found["at"])] if found and int(found["at"]) < len(names) else None

    def _without_name_of_bracket(self, place: str, sides: Sequence[Side], asked: Quantity) -> Sequence[Side]:
        """Return sides without a name of the writer's own for the value of a bracket, ``L_z = …``, which is told."""
        label = label_of(sides[0].said)
        one = re.fullmatch(r"[\s$]*\\?[^\W\d_]+(?:_\{?\w{1,4}\}?)?\s*", sides[0].text)
        if not (asked.bracket and len(sides) == 2 and one and label and label.name) or label.rates:
            return sides
        if label.name in CONSTANTS or label.name in OTHER_NAMES or is_asked(label, asked, self.sides.scope):
            return sides
        if key_of(label.name) in {key_of(name) for name in self.sides.scope.spelled}:
            return sides
        self.sides.passed.append(f"{label.name} in {place} is taken for {asked.shown}, which is asked for")
        return sides[1:]

    def _several_said(
        self, place: str, text: str, statements: Sequence[Statement], asked: Quantity
    ) -> Exception:
        """Return the error of several statements where one expression is asked for."""
        named = [s for s in statements if self.names.is_asked(s.sides[0], asked) and s.sides[1:]]
        other = next((s for s in statements if s not in named), statements[-1]).sides[0]
        reason, remedy = f"one expression is asked for: {asked.shown}", "leave the others out"
        if len(named) == 1:
            reason, remedy = f"this is another statement beside {asked.shown}", "put it in, or leave it out"
        return self.sides.told(place, text, other, reason, remedy)

    def _without_own_label(self, place: str, sides: Sequence[Side]) -> Sequence[Side]:
        """Return sides without a free name before what the question has no name for, which is told."""
        rest = without_own_label(place, sides, self.sides.keys, self.sides.scope)
        if rest is not sides:
            self.sides.passed.append(f"{sides[0].text.strip(' $')} in {place} is taken for what is asked for")
        return rest

    def _without_rate_of_constant(self, place: str, sides: list[Side]) -> list[Side]:
        """Return what ``d/dt (m r² φ̇) = 0`` says is kept, where a constant of the motion is asked for."""
        of_motion = place == "I" or place.startswith("conserved")
        kept = without_rate(sides, self.sides.scope) if of_motion else sides
        if len(kept) < len(sides):
            self.sides.passed.append(f"{place} is what stands behind d/dt: its rate is said to be zero")
        return [*kept]

    def _without_rate_of_entry(self, sides: Sequence[Side], asked: Quantity) -> Sequence[Side]:
        """Return sides without ``ṗ`` before ``{p, H}``, which is what it is by Hamilton's equations."""
        label, bracket = label_of(sides[0].said), label_of(sides[1].said) if len(sides) > 2 else None
        if not (asked.bracket and label and bracket and label.rates == 1 and not bracket.name):
            return sides
        by_energy = bracket.arguments[1:] == ("H",) and key_of(label.name) == key_of(asked.bracket[0])
        declared = isinstance(self.sides.scope.symbol(label.name), Coordinate | Momentum)
        return sides[1:] if by_energy and declared and self.names.is_asked(sides[1], asked) else sides

    def _last_of(self, place: str, text: str, sides: list[Side], asked: Quantity) -> str:
        """Return the last side of a chain; those before it are links, or definitions that are passed over."""
        readable: list[Side] = []
        for side in sides[:-1]:
            if self.names.is_asked(side, asked):
                continue
            if (
                self.sides.is_origin(place, side, asked.shown)
                or self.sides.given(place).put_in(side.text) is not None
            ):
                made = self.sides.origin(place, side, sides[-1])
                self.links.extend(Link(place, each, each.partition(" = ")[0]) for each in made)
            else:
                self._read(place, text, side, asked)
                readable.append(side)
        readable.append(sides[-1])
        self.links.extend(self._link(place, a, b) for a, b in pairwise(readable))
        return self._written_out(place, sides[-1])

    def _link(self, place: str, a: Side, b: Side) -> Link:
        """Return the equation between two sides of a chain, H put in where the last is said by it."""
        right = self._written_out(place, b)
        if right == b.text:
            return Link(place, field_texts.equation_between(a, b), a.text)
        return Link(place, f"{parse_expression(a.text, self.sides.scope)} = {right}", a.text)

    def _written_out(self, place: str, side: Side) -> str:
        """Return the text of an answer, with H put in where J, ω or an adiabatic invariant is said by it."""
        if place == "energy_rate" and not self.sides.can_read(side):  # -2F
            said = self.sides.given(place).put_in(side.text)
            return side.text if said is None else str(said)
        if place.endswith(".value") and not self.sides.can_read(side):  # -L_z beside {L_x, L_y}
            said = self.sides.given(place).put_in(side.text)
            return side.text if said is None else str(said)
        by_energy = ("J", "omega", "I")[: 2 + ("slow" in self.kind.shapes)]  # I = H says nothing elsewhere
        known = key_at(place) not in by_energy or not re.search(r"[HE]", side.text)
        if known or self.sides.can_read(side):
            return side.text
        said = self.sides.given(place).put_in(side.text)
        return side.text if said is None else str(said)

    def _read(self, place: str, text: str, side: Side, asked: Quantity) -> None:
        """Refuse a side that is neither a name of the answer nor an expression."""
        try:
            parse_expression(side.text, self.sides.scope)
        except LanguageError as error:
            label = label_of(side.said)
            if label is not None and label.name:
                raise self.names.contradiction(place, text, side, asked) from None
            raise self.sides.fault(place, error.at_home_in(text)) from None

    def _list_in(self, shown: str, text: str) -> str:
        """Return a text with the lists of programs as people write them."""
        try:
            return lists_in(text)
        except LanguageError as error:
            raise self.sides.fault(shown, error) from None
